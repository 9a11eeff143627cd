"""What a written report is: its place, pages, sections and hash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


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
