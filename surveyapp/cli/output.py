"""How results are printed: one JSON object, or plain tables that fit a terminal of 80 columns."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Mapping, Sequence
from typing import Any, Final

from surveyapp.languages import shown
from surveyapp.report.blocks import Table
from surveyapp.report.in_words import in_words
from surveyapp.report.text import display_width, filled, table_text

WIDTH: Final = 80
"""Columns of a terminal; a table that is wider has its texts wrapped."""

_NARROWEST: Final = 8
"""Columns below which no text is squeezed."""

_GAP: Final = 2
_UNSEEN: Final = re.compile("[\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ufeff]")
"""What JSON may hold as it is and a terminal may not."""


def print_json(value: Mapping[str, Any]) -> None:
    """Print one JSON object; NaN is a fault and raises.

    What the encoding of standard output cannot hold is escaped.
    """
    encoding = (getattr(sys.stdout, "encoding", None) or "utf-8").lower().replace("-", "")
    text = json.dumps(value, ensure_ascii=encoding != "utf8", indent=2, allow_nan=False)
    text = _UNSEEN.sub(lambda match: f"\\u{ord(match[0]):04x}", text)
    print(text.encode("utf-8", "backslashreplace").decode("utf-8"))


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, indent: int = 2) -> str:
    """A plain table: columns as wide as needed, numbers to the right, long texts wrapped."""
    align = "".join(
        "r" if all(_is_number(row[i]) for row in rows) else "l" for i in range(len(head))
    )
    block = Table(tuple(head), tuple(tuple(row) for row in rows), align)
    return table_text(in_words(block), WIDTH, indent=indent)


def columns(text: str) -> int:
    """Columns of a terminal that a text takes: Chinese and the like take two each."""
    return display_width(text)


def _is_number(cell: str) -> bool:
    return not cell or cell.lstrip("+-±")[:1].isdigit() or cell == "-"


def paragraph(text: str, *, indent: int = 2, hanging: int = 2) -> str:
    """A text wrapped to the terminal, its further lines indented by ``hanging`` more."""
    return filled(" " * indent + shown(text), WIDTH, set_in=" " * (indent + hanging))


def number(value: float | None, decimals: int = 1, *, sign: bool = False) -> str:
    """A number with fixed decimals, ``-`` where it is not determined."""
    if value is None:
        return "-"
    return f"{value:+.{decimals}f}" if sign else f"{value:.{decimals}f}"


def heading(text: str) -> str:
    """A heading with a rule below."""
    text = shown(text)
    return f"{text}\n{'-' * min(columns(text), WIDTH)}"
