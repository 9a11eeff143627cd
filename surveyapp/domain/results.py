"""Results of an orientation: what ``orient`` prints, what the record shows, what scripts read.

Plain numbers in radians; ``to_dict`` gives the JSON of design.md section 5 (decimal degrees, small
quantities in arc-seconds, None where something is not determined, never NaN). Angles, sessions and
constants have modules of their own; this one has the names of all.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from surveyapp.domain.angle_result import AngleResult, Reference, finite, to_arcsec, to_degrees
from surveyapp.domain.combined_result import CombinedPart, CombinedResult
from surveyapp.domain.constant_result import ConstantResult, Determination, LineConstant
from surveyapp.domain.records import Cell, Recorded, rows_of
from surveyapp.domain.session_result import (
    PointResult,
    SessionResult,
    TapeZeroResult,
    TargetResult,
)
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning

__all__ = [
    "Reference",
    "finite",
    "to_degrees",
    "to_arcsec",
    "AngleResult",
    "PointResult",
    "TapeZeroResult",
    "TargetResult",
    "SessionResult",
    "LineConstant",
    "Determination",
    "ConstantResult",
    "Check",
    "Subject",
    "Verdicts",
    "BudgetLine",
    "LineResult",
    "CombinedPart",
    "CombinedResult",
    "OrientationResult",
]


ResultTable = Literal["lines", "sessions", "constants", "combined", "checks", "warnings"]


LOUD = {"fit": "lack_of_fit", "constant": "constant_unstable", "line": "rounds_disagree"}
"""A run that the model does not fit, a constant that moved: codes of the warnings, by family."""


@dataclass(frozen=True, slots=True)
class Check:
    """One limit or test, applied.

    Parameters
    ----------
    rule : str
        Id of the limit or test.
    clause : str
        Where it comes from.
    value, limit : float or None
        In ``unit``; None where it cannot be answered.
    confirmed : bool
        False: the limit is not confirmed in a source, it only warns.
    passed : bool or None
        None where the project's data cannot answer.
    where : str
        Session, line or instrument in words, for people only.
    text : str
        One sentence in the trade's words.
    subject : Subject
        What it is about: who belongs to a session or a line is told by this alone.
    """

    rule: str
    clause: str
    value: float | None
    limit: float | None
    confirmed: bool
    passed: bool | None
    unit: str = ""
    where: str = ""
    text: str = ""
    subject: Subject = field(kw_only=True)

    @property
    def family(self) -> str:
        """What the rule belongs to: of ``constant.lines`` ``constant``, of a rule book its id."""
        return self.rule.partition(".")[0]

    @property
    def is_part(self) -> bool:
        """Whether it is one of the tests behind the test of fit, which tells it."""
        return self.family == "fit" and self.rule != self.family

    @property
    def warning_code(self) -> str:
        """Code of the warning that tells it again where it is not met; empty where none does."""
        return "" if self.passed is not False or self.is_part else LOUD.get(self.family, "")

    @property
    def verdict(self) -> str:
        """The verdict as a word: met, NOT MET, warning (an unconfirmed limit), open."""
        if self.passed is None:
            return "open"
        if self.passed:
            return "met"
        return "NOT MET" if self.confirmed else "warning"

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "rule": self.rule,
            "clause": self.clause,
            "value": finite(self.value),
            "limit": finite(self.limit),
            "unit": self.unit,
            "confirmed": self.confirmed,
            "pass": self.passed,
            "where": self.where,
            "text": self.text,
            "subject": self.subject.to_dict(),
        }


@dataclass(frozen=True, slots=True)
class Verdicts:
    """Every check of a project, in order; a sequence of checks.

    Parameters
    ----------
    checks : tuple of Check
    warnings : tuple of ResultWarning
        Those of the orientation, and a record on the disk that is out of date.
    """

    checks: tuple[Check, ...]
    warnings: tuple[ResultWarning, ...] = ()

    def __iter__(self) -> Iterator[Check]:
        return iter(self.checks)

    def __len__(self) -> int:
        return len(self.checks)

    def __getitem__(self, place: int) -> Check:
        return self.checks[place]

    @property
    def passed(self) -> bool:
        """Whether every confirmed limit and test is met."""
        return not any(check.confirmed and check.passed is False for check in self.checks)

    def rows(self) -> list[dict[str, Cell]]:
        """One flat record a check."""
        return rows_of(self.checks)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.check/1``."""
        return {
            "schema": "surveyapp.check/1",
            "checks": [check.to_dict() for check in self.checks],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }


@dataclass(frozen=True, slots=True)
class BudgetLine:
    """Share of one source in the variance of an azimuth.

    ``source`` is for people; what it is about is told by ``name``, and by ``at_calibration`` where
    it came in with the sessions of the instrument constant.
    """

    source: str
    sigma: float
    share: float
    origin: str = ""
    name: str = ""
    at_calibration: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "source": self.source,
            "sigma_arcsec": to_arcsec(self.sigma),
            "share": finite(self.share),
            "origin": self.origin,
        }


@dataclass(frozen=True, slots=True)
class LineResult:
    """The oriented line: what the whole program is for.

    ``if_drifting`` is the half-width of the 95 % interval of its constant if the instrument drifts
    [rad], None where the determinations are not far from the line in time.
    """

    station: str
    target: str
    instrument: str
    rounds: int
    sessions: tuple[str, ...]
    gyro_azimuth: AngleResult
    constant: float | None
    constant_sigma: float | None
    constant_choice: str | None
    true_azimuth: AngleResult | None
    deflection: float
    convergence: float | None
    arc_to_chord: float | None
    grid_azimuth: AngleResult | None
    direction_from_south: float | None
    budget: tuple[BudgetLine, ...]
    existing_azimuth: float | None = None
    distance_m: float | None = None
    levelling: float | None = None
    if_drifting: float | None = None

    @property
    def subject(self) -> Subject:
        """The line as a value: its two stations and the instrument."""
        return Subject.line(self.station, self.target, self.instrument)

    @property
    def constant_arcsec(self) -> float | None:
        """Instrument constant in arc-seconds, None where there is none."""
        return to_arcsec(self.constant)

    @property
    def constant_sigma_arcsec(self) -> float | None:
        """Its standard deviation in arc-seconds."""
        return to_arcsec(self.constant_sigma)

    @property
    def deflection_arcsec(self) -> float | None:
        """Deflection term in arc-seconds; it is subtracted."""
        return to_arcsec(self.deflection)

    @property
    def convergence_arcsec(self) -> float | None:
        """Meridian convergence in arc-seconds; it is subtracted."""
        return to_arcsec(self.convergence)

    @property
    def arc_to_chord_arcsec(self) -> float | None:
        """Arc-to-chord correction in arc-seconds; it is subtracted."""
        return to_arcsec(self.arc_to_chord)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        constant = None
        if self.constant is not None:
            constant = {
                "arcsec": to_arcsec(self.constant),
                "sigma_arcsec": to_arcsec(self.constant_sigma),
                "choice": self.constant_choice,
                "if_drifting_interval95_arcsec": to_arcsec(self.if_drifting),
            }
        return {
            "station": self.station,
            "target": self.target,
            "instrument": self.instrument,
            "rounds": self.rounds,
            "sessions": list(self.sessions),
            "gyro_azimuth": self.gyro_azimuth.to_dict(),
            "constant": constant,
            "true_azimuth": None if self.true_azimuth is None else self.true_azimuth.to_dict(),
            "deflection_arcsec": to_arcsec(self.deflection),
            "convergence_arcsec": to_arcsec(self.convergence),
            "arc_to_chord_arcsec": to_arcsec(self.arc_to_chord),
            "levelling_correction_arcsec": to_arcsec(self.levelling),
            "grid_azimuth": None if self.grid_azimuth is None else self.grid_azimuth.to_dict(),
            "direction_from_south": to_degrees(self.direction_from_south),
            "existing_azimuth_deg": to_degrees(self.existing_azimuth),
            "distance_m": finite(self.distance_m),
            "budget": [line.to_dict() for line in self.budget],
        }


@dataclass(frozen=True, slots=True)
class OrientationResult:
    """Everything that ``orient`` finds in a project."""

    project: str
    software: str
    input_sha256: str
    sessions: tuple[SessionResult, ...]
    constants: tuple[ConstantResult, ...]
    lines: tuple[LineResult, ...]
    checks: tuple[Check, ...]
    warnings: tuple[ResultWarning, ...] = field(default=())
    combined: tuple[CombinedResult, ...] = field(default=())

    @property
    def passed(self) -> bool:
        """Whether every confirmed limit and test is met."""
        return not any(check.confirmed and check.passed is False for check in self.checks)

    def rows(self, table: ResultTable = "lines") -> list[dict[str, Cell]]:
        """One flat record a line, session, constant, side, check or warning."""
        tables: dict[ResultTable, Sequence[Recorded]] = {
            "lines": self.lines,
            "sessions": self.sessions,
            "constants": self.constants,
            "combined": self.combined,
            "checks": self.checks,
            "warnings": self.warnings,
        }
        return rows_of(tables[table])

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.orient/1``."""
        return {
            "schema": "surveyapp.orient/1",
            "project": self.project,
            "software": self.software,
            "input_sha256": self.input_sha256,
            "sessions": [session.to_dict() for session in self.sessions],
            "constants": [constant.to_dict() for constant in self.constants],
            "lines": [line.to_dict() for line in self.lines],
            "combined": [side.to_dict() for side in self.combined],
            "checks": [check.to_dict() for check in self.checks],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }
