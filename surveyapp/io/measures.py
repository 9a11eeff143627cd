"""What a number in a book can mean: beyond these sizes its square leaves the range of a float."""

from __future__ import annotations

from typing import Final

LARGEST_MEASURE: Final = 1e12
SMALLEST_MEASURE: Final = 1e-12
MEASURES: Final = f"{SMALLEST_MEASURE:g} to {LARGEST_MEASURE:g}, or 0"
"""What was expected, in words."""


def is_measure(value: float) -> bool:
    """Whether an instrument can have read this, in any unit; NaN is none."""
    return value == 0.0 or SMALLEST_MEASURE <= abs(value) <= LARGEST_MEASURE
