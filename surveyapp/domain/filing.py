"""What an office does with projects, as values: closing, exporting, comparing, batches."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from surveyapp.domain.results import finite
from surveyapp.domain.warning import ResultWarning

Part = Literal["input", "software", "card", "rule_book", "result"]
Status = Literal["good", "limit", "failed"]


@dataclass(frozen=True, slots=True)
class ClosingResult:
    """A closing or reopening that stands in the ledger.

    Parameters
    ----------
    action : str
        closing | reopening.
    scope, session : str
        ``project``, or ``session`` and its id.
    at, by, reason : str
    seal : str
        Head of the hash chain; empty for a reopening.
    files : int
        Number of sealed files.
    found : tuple of str
        What had been changed when it was reopened.
    entry : int
        Number of the ledger entry.
    head : str
        Of the ledger's chain, 20 characters in groups: what ``check --seal`` verifies.
    signature : str
        File of the signature with a key, relative to the folder; empty without a key.
    """

    action: str
    scope: str
    session: str
    at: str
    by: str
    reason: str
    seal: str
    files: int
    found: tuple[str, ...]
    entry: int
    head: str = ""
    signature: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.closing/1``."""
        return {
            "schema": "surveyapp.closing/1",
            "action": self.action,
            "scope": self.scope,
            "session": self.session or None,
            "at": self.at,
            "by": self.by,
            "reason": self.reason,
            "seal": self.seal or None,
            "head": self.head or None,
            "files": self.files,
            "found": list(self.found),
            "entry": self.entry,
            "signature": self.signature or None,
        }


@dataclass(frozen=True, slots=True)
class ExportResult:
    """A file that was written for somebody else."""

    format: str
    path: str
    items: int
    sha256: str
    warnings: tuple[ResultWarning, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.export/1``."""
        return {
            "schema": "surveyapp.export/1",
            "format": self.format,
            "path": self.path,
            "items": self.items,
            "sha256": self.sha256,
            "warnings": [item.to_dict() for item in self.warnings],
        }


@dataclass(frozen=True, slots=True)
class MadeProject:
    """A project folder that was made; whatever takes a path takes it.

    Parameters
    ----------
    path : str
    to_enter : tuple of str
        What only the owner of its instrument knows, and the card does not state.
    """

    path: str
    to_enter: tuple[str, ...] = ()

    def __fspath__(self) -> str:
        return self.path

    def __str__(self) -> str:
        return self.path

    def __truediv__(self, name: str) -> Path:
        return Path(self.path) / name

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.new/1``."""
        return {
            "schema": "surveyapp.new/1",
            "path": self.path,
            "to_enter": [str(value) for value in self.to_enter],
        }


@dataclass(frozen=True, slots=True)
class Difference:
    """One thing that differs between two results.

    Parameters
    ----------
    part : str
        input | software | card | rule_book | result.
    name : str
        File and line, key, or path of a number in the result.
    a, b : str
        What stands on either side; empty where it does not exist.
    change : float or None
        b minus a where both are numbers.
    """

    part: Part
    name: str
    a: str
    b: str
    change: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "part": self.part,
            "name": self.name,
            "a": self.a,
            "b": self.b,
            "change": finite(self.change),
        }


@dataclass(frozen=True, slots=True)
class ComparisonResult:
    """What changed between two results.

    Parameters
    ----------
    a, b : str
        Names of the two sides.
    differences : tuple of Difference
    unknown : tuple of str
        Parts that one side does not tell.
    """

    a: str
    b: str
    differences: tuple[Difference, ...]
    unknown: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.compare/1``."""
        return {
            "schema": "surveyapp.compare/1",
            "a": self.a,
            "b": self.b,
            "changed": sorted({item.part for item in self.differences}),
            "unknown": list(self.unknown),
            "differences": [item.to_dict() for item in self.differences],
        }


@dataclass(frozen=True, slots=True)
class BatchRow:
    """One project of a batch.

    Parameters
    ----------
    path : str
    status : str
        good; limit: a confirmed limit or test is not met; failed: it could not be computed.
    name : str
    sessions, lines : int
    azimuths : str
        Every oriented line with its azimuth and sigma [deg, arcsec].
    met, not_met, unanswered, warnings : int
        Numbers of checks and warnings.
    problem : str
        What was wrong; empty otherwise.
    input_sha256 : str
    """

    path: str
    status: Status
    name: str = ""
    sessions: int = 0
    lines: int = 0
    azimuths: str = ""
    met: int = 0
    not_met: int = 0
    unanswered: int = 0
    warnings: int = 0
    problem: str = ""
    input_sha256: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Columns of the table."""
        return {name: getattr(self, name) for name in BATCH_COLUMNS}


BATCH_COLUMNS = (
    "path",
    "status",
    "name",
    "sessions",
    "lines",
    "azimuths",
    "met",
    "not_met",
    "unanswered",
    "warnings",
    "problem",
    "input_sha256",
)
"""Columns of a batch, in order."""


@dataclass(frozen=True, slots=True)
class BatchResult:
    """A batch that was run.

    Parameters
    ----------
    path : str
        Table that was written.
    good, limit, failed : int
        Numbers of projects.
    failures : tuple of (path, problem)
    """

    path: str
    good: int
    limit: int
    failed: int
    failures: tuple[tuple[str, str], ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.batch/1``."""
        return {
            "schema": "surveyapp.batch/1",
            "path": self.path,
            "projects": self.good + self.limit + self.failed,
            "good": self.good,
            "limit": self.limit,
            "failed": self.failed,
            "failures": [{"path": path, "problem": text} for path, text in self.failures],
        }
