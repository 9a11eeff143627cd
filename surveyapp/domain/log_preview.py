"""What was understood of a sensor log before it is taken into a project."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from surveyapp.domain.warning import ResultWarning


@dataclass(frozen=True, slots=True)
class PreviewedColumn:
    """One column of a log.

    Parameters
    ----------
    name : str
        In the file.
    canonical : str or None
        What it was taken for; None = it is not one of the known columns.
    unit : str
        In which its values are held.
    stated : bool
        Whether the unit was stated, by an option or by the name of the column.
    factor : float
        From a cell to a value.
    first : tuple of str
        First cells as they stand in the file.
    low, high : float or None
        Of the whole column, in its unit; None for words and where the log cannot be read.
    """

    name: str
    canonical: str | None
    unit: str
    stated: bool
    factor: float
    first: tuple[str, ...] = ()
    low: float | None = None
    high: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "canonical": self.canonical,
            "unit": self.unit,
            "stated": self.stated,
            "factor": self.factor,
            "first": list(self.first),
            "low": self.low,
            "high": self.high,
        }


@dataclass(frozen=True, slots=True)
class LogPreview:
    """A log as it would be read, schema ``surveyapp.log_preview/1``.

    Parameters
    ----------
    path : str
    columns : tuple of PreviewedColumn
    rows : int
    rate_hz : float or None
    problems : tuple of str
        In words; the log can be taken when there are none.
    warnings : tuple of ResultWarning
    written : str or None
        Where the log stands in the project once it was taken.
    """

    path: str
    columns: tuple[PreviewedColumn, ...]
    rows: int
    rate_hz: float | None = None
    problems: tuple[str, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
    written: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": "surveyapp.log_preview/1",
            "path": self.path,
            "columns": [column.to_dict() for column in self.columns],
            "rows": self.rows,
            "rate_hz": self.rate_hz,
            "problems": list(self.problems),
            "warnings": [warning.to_dict() for warning in self.warnings],
            "written": self.written,
        }
