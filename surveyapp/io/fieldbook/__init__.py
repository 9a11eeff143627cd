"""The field book, the one place to import from: read it, parse its text, append a row.

How rows are parsed, strikes resolved, sides found and lines written is told in the modules behind.
"""

from __future__ import annotations

from surveyapp.domain.readings import COLUMNS
from surveyapp.io.fieldbook.appending import append_row, book_columns
from surveyapp.io.fieldbook.reading import Judged, judge, parse_field_book, read_field_book

__all__ = [
    "COLUMNS",
    "Judged",
    "append_row",
    "book_columns",
    "judge",
    "parse_field_book",
    "read_field_book",
]
