"""The predicted miss and everything that belongs to it: what ``predict`` prints.

Metres and radians; ``to_dict`` gives the JSON of penetration.md section 5, schema
``surveyapp.predict/1``: None for what is not determined, never NaN.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal

from surveyapp.domain.angle_result import finite
from surveyapp.domain.penetration import STEP_TITLES, ProcedureStep
from surveyapp.domain.placement import PlacementPlan
from surveyapp.domain.warning import ResultWarning

Verdict = Literal["consistent", "not_separable", "explained"]


@dataclass(frozen=True, slots=True)
class MissSigma:
    """1 sigma of the miss [m]; None: not determined."""

    lateral_m: float | None
    longitudinal_m: float | None
    vertical_m: float | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "lateral_m": finite(self.lateral_m),
            "longitudinal_m": finite(self.longitudinal_m),
            "vertical_m": finite(self.vertical_m),
        }

    def components(self) -> tuple[float | None, float | None, float | None]:
        """Lateral, longitudinal, vertical."""
        return self.lateral_m, self.longitudinal_m, self.vertical_m


@dataclass(frozen=True, slots=True)
class SimulatedSigma:
    """1 sigma of the miss over simulated surveys."""

    sigma: MissSigma
    runs: int
    seed: int

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {**self.sigma.to_dict(), "runs": self.runs, "seed": self.seed}


@dataclass(frozen=True, slots=True)
class SectionedSigma:
    """Lateral 1 sigma by the sectioned formula.

    Parameters
    ----------
    lateral_m : float or None
    valid : bool
    why : str
        Why it is not valid; empty where it is.
    """

    lateral_m: float | None
    valid: bool
    why: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "lateral_m": finite(self.lateral_m),
            "valid": self.valid,
            "why": self.why or None,
        }


@dataclass(frozen=True, slots=True)
class Tolerance:
    """What is allowed at the meeting point [m].

    Parameters
    ----------
    lateral_m, longitudinal_m, vertical_m : float or None
    source : str
    confirmed : bool
        Whether every one of them is.
    confirmed_parts : tuple of bool
        In the order lateral, longitudinal, vertical.
    """

    lateral_m: float | None
    longitudinal_m: float | None
    vertical_m: float | None
    source: str
    confirmed: bool
    confirmed_parts: tuple[bool, bool, bool] = (True, True, True)

    def components(self) -> tuple[float | None, float | None, float | None]:
        """Lateral, longitudinal, vertical."""
        return self.lateral_m, self.longitudinal_m, self.vertical_m

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "lateral_m": finite(self.lateral_m),
            "longitudinal_m": finite(self.longitudinal_m),
            "vertical_m": finite(self.vertical_m),
            "source": self.source,
            "confirmed": self.confirmed,
        }


@dataclass(frozen=True, slots=True)
class MissCause:
    """One row of the budget: what one cause does to the miss, 1 sigma."""

    source: str
    heading: str | None
    lateral_m: float
    longitudinal_m: float
    vertical_m: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "source": self.source,
            "heading": self.heading,
            "lateral_m": finite(self.lateral_m),
            "longitudinal_m": finite(self.longitudinal_m),
            "vertical_m": finite(self.vertical_m),
        }


@dataclass(frozen=True, slots=True)
class MissCandidate:
    """What one cause alone would have to be to make the measured miss.

    Parameters
    ----------
    effect : str
    needed : float
        In ``unit``.
    unit : str
    sigmas : float or None
        Size in declared sigmas; None where none is declared.
    component : str
        lateral | longitudinal.
    subject : str
        Instrument or heading; empty: the whole mine.
    """

    effect: str
    needed: float
    unit: str
    sigmas: float | None
    component: str
    subject: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "effect": self.effect,
            "needed": finite(self.needed),
            "unit": self.unit,
            "sigmas": finite(self.sigmas),
            "component": self.component,
            "subject": self.subject or None,
        }


@dataclass(frozen=True, slots=True)
class HeadingShare:
    """By how much the end of a heading moves when the miss is distributed: right, along, up [m]."""

    heading: str
    lateral_m: float | None
    longitudinal_m: float | None
    vertical_m: float | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "heading": self.heading,
            "lateral_m": finite(self.lateral_m),
            "longitudinal_m": finite(self.longitudinal_m),
            "vertical_m": finite(self.vertical_m),
        }


@dataclass(frozen=True, slots=True)
class ResidualVerdict:
    """What the diagnosis of a heading's traverse says of its residuals."""

    traverse: str
    verdict: str
    effects: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"traverse": self.traverse, "verdict": self.verdict, "effects": list(self.effects)}


@dataclass(frozen=True, slots=True)
class MissTest:
    """The measured miss against its prediction.

    Parameters
    ----------
    t : tuple of float or None
        Miss divided by sigma: lateral, longitudinal, vertical.
    chi2, p : float
    consistent : bool
    verdict : str
    candidates : tuple of MissCandidate
    distribution : tuple of HeadingShare
    text : str
        What it means, in the trade's words.
    residuals : tuple of ResidualVerdict
        What the residuals of the traverses say.
    """

    t: tuple[float | None, float | None, float | None]
    chi2: float
    p: float
    consistent: bool
    verdict: Verdict
    candidates: tuple[MissCandidate, ...]
    distribution: tuple[HeadingShare, ...] = ()
    text: str = ""
    residuals: tuple[ResidualVerdict, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "t_lateral": finite(self.t[0]),
            "t_longitudinal": finite(self.t[1]),
            "t_vertical": finite(self.t[2]),
            "chi2": finite(self.chi2),
            "p": finite(self.p),
            "consistent": self.consistent,
            "verdict": self.verdict,
            "candidates": [item.to_dict() for item in self.candidates],
            "distribution": [item.to_dict() for item in self.distribution],
            "residuals": [item.to_dict() for item in self.residuals],
            "text": self.text,
        }


@dataclass(frozen=True, slots=True)
class MeetingEllipse:
    """Standard ellipse of the miss in the plane.

    Parameters
    ----------
    a_m, b_m : float
        Half axes [m].
    azimuth : float
        Of the longer one [rad].
    """

    a_m: float
    b_m: float
    azimuth: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "a_m": self.a_m,
            "b_m": self.b_m,
            "azimuth_deg": math.degrees(self.azimuth),
        }


@dataclass(frozen=True, slots=True)
class MineDrawing:
    """What a plan of the mine shows, east and north [m].

    Parameters
    ----------
    names : tuple of str
        Headings.
    routes : tuple of tuple of (east, north)
        Stations of each heading, carried on to the meeting point.
    gyro : tuple of pairs
        Ends of the gyro sides.
    meeting : (east, north)
    axis_azimuth : float
        [rad].
    """

    names: tuple[str, ...]
    routes: tuple[tuple[tuple[float, float], ...], ...]
    gyro: tuple[tuple[tuple[float, float], tuple[float, float]], ...]
    meeting: tuple[float, float]
    axis_azimuth: float


@dataclass(frozen=True, slots=True)
class Prediction:
    """Everything that ``predict`` finds."""

    project: str
    software: str
    input_sha256: str
    sigma: MissSigma
    factor: float
    factor_source: str
    tolerance: Tolerance | None
    passed: bool | None
    failed_confirmed: bool
    sectioned: SectionedSigma
    simulated: SimulatedSigma | None
    budget: tuple[MissCause, ...]
    ellipse: MeetingEllipse
    plan: PlacementPlan = field(default_factory=PlacementPlan)
    measured: MissTest | None = None
    steps: tuple[ProcedureStep, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
    drawing: MineDrawing | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.predict/1``; the drawing is not in it."""
        return {
            "schema": "surveyapp.predict/1",
            "project": self.project,
            "software": self.software,
            "input_sha256": self.input_sha256,
            **self.sigma.to_dict(),
            "factor": self.factor,
            "factor_source": self.factor_source,
            "tolerance": None if self.tolerance is None else self.tolerance.to_dict(),
            "pass": self.passed,
            "routes": {
                "covariance": self.sigma.to_dict(),
                "sectioned": self.sectioned.to_dict(),
                "monte_carlo": None if self.simulated is None else self.simulated.to_dict(),
            },
            "budget": [cause.to_dict() for cause in self.budget],
            "ellipse": self.ellipse.to_dict(),
            "plan": [item.to_dict() for item in self.plan.placements],
            "least_programme": None if self.plan.least is None else self.plan.least.to_dict(),
            "why": self.plan.why or None,
            "measures": [item.to_dict() for item in self.plan.measures],
            "measured": None if self.measured is None else self.measured.to_dict(),
            "steps": [step for number in range(1, 7) for step in self._steps(number)],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }

    def _steps(self, number: int) -> list[dict[str, Any]]:
        """Entries of one step; one without entries is not done."""
        entries = [step for step in self.steps if step.id == number]
        return [step_dict(step) for step in entries or [ProcedureStep(number)]]


def step_dict(step: ProcedureStep) -> dict[str, Any]:
    """Keys of one step in the JSON."""
    return {
        "id": step.id,
        "title": STEP_TITLES[step.id - 1],
        "done": bool(step.done_at),
        "done_at": step.done_at or None,
        "by": step.by or None,
        "note": step.note or None,
        "file": step.file or None,
        "centre_line_mm": step.centre_line_mm,
        "waist_line_mm": step.waist_line_mm,
    }
