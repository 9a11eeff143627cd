"""Results as CSV: one table of lines, sessions, constants or checks, or every value in one."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any, Final

from surveyapp.core.differences import label, leaves
from surveyapp.domain.records import flat, not_a_formula
from surveyapp.domain.results import OrientationResult

TABLES: Final = ("lines", "sessions", "constants", "checks", "all")
_LONG: Final = ("table", "row", "quantity", "value")


def results_csv(result: OrientationResult, table: str) -> tuple[str, int]:
    """CSV text (UTF-8, comma, point) of a table of results, and the number of its rows.

    Parameters
    ----------
    result : OrientationResult
    table : str
        One of ``TABLES``; ``all`` has one row a value.
    """
    data = result.to_dict()
    if table == "all":
        rows = [
            {"table": name, "row": label(item), "quantity": path, "value": _cell(value)}
            for name in TABLES[:-1]
            for item in data[name]
            for path, value in leaves(item)
        ]
        return _text(_LONG, rows), len(rows)
    rows = [_flat(item) for item in data[table]]
    columns = tuple(dict.fromkeys(key for row in rows for key in row))
    return _text(columns, rows), len(rows)


def _flat(item: Mapping[str, Any]) -> dict[str, str]:
    """Columns of one row."""
    return {key: _cell(value) for key, value in flat(item).items()}


def _cell(value: object) -> str:
    """Text of a cell; one that a spreadsheet would take for a formula is quoted."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    return not_a_formula(str(value))


def _text(columns: Sequence[str], rows: Sequence[Mapping[str, str]]) -> str:
    stream = io.StringIO()
    writer = csv.DictWriter(stream, columns, lineterminator="\n", restval="")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()
