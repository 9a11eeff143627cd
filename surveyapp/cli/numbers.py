"""Numbers as typed on the command line."""

from __future__ import annotations

import math
from typing import Final

LARGEST: Final = 1e15
"""No option means more: whole numbers stay exact, and squares stay within the range of a float."""


def finite(text: str) -> float | None:
    """The number that a text means; None for text, NaN, infinity and what no option can mean."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and abs(value) <= LARGEST else None
