"""How results are printed: one JSON object, or plain tables that fit a terminal."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from typing import Any


def print_json(value: Mapping[str, Any]) -> None:
    """Print one JSON object; NaN is a fault and raises."""
    json.dump(value, sys.stdout, ensure_ascii=False, indent=2, allow_nan=False)
    sys.stdout.write("\n")


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, indent: int = 2) -> str:
    """A plain table: columns as wide as needed, numbers to the right."""
    widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    numeric = [all(_is_number(row[i]) for row in rows) for i in range(len(head))]
    lines = []
    for row in [head, *rows]:
        cells = [
            cell.rjust(width) if right else cell.ljust(width)
            for cell, width, right in zip(row, widths, numeric, strict=True)
        ]
        lines.append((" " * indent + "  ".join(cells)).rstrip())
    return "\n".join(lines)


def _is_number(cell: str) -> bool:
    return not cell or cell.lstrip("+-±")[:1].isdigit() or cell == "-"


def number(value: float | None, decimals: int = 1, *, sign: bool = False) -> str:
    """A number with fixed decimals, ``-`` where it is not determined."""
    if value is None:
        return "-"
    return f"{value:+.{decimals}f}" if sign else f"{value:.{decimals}f}"


def heading(text: str) -> str:
    """A heading with a rule below."""
    return f"{text}\n{'-' * len(text)}"
