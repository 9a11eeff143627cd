"""What a written report is: its place, pages, sections and hash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class SheetsResult:
    """Sheets that were written beside a record.

    Parameters
    ----------
    paths : tuple of str
    problems : tuple of str
        Why a traverse has no sheet.
    """

    paths: tuple[str, ...]
    problems: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys that ``report --sheets`` adds to its JSON."""
        return {"sheets": list(self.paths), "without_sheet": list(self.problems)}


@dataclass(frozen=True, slots=True)
class ReportResult:
    """A report that was written.

    Parameters
    ----------
    path : str
    pages : int
    sections : tuple of str
        Ids in order.
    sha256 : str
        Of the file.
    """

    path: str
    pages: int
    sections: tuple[str, ...]
    sha256: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.report/1``."""
        return {
            "schema": "surveyapp.report/1",
            "path": self.path,
            "pages": self.pages,
            "sections": list(self.sections),
            "sha256": self.sha256,
        }
