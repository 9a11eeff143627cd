"""Results of an orientation: what ``orient`` prints, what the record shows, what scripts read.

Plain numbers in radians; ``to_dict`` gives the JSON of design.md section 5 (decimal degrees, small
quantities in arc-seconds, None where something is not determined, never NaN).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal

from surveyapp.domain.project import ResultWarning
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi, wrap_two_pi

Reference = Literal["GYRO", "ASTRONOMIC", "GEODETIC", "GRID", "MAGNETIC"]


def finite(value: float | None) -> float | None:
    """Replace what is not a finite number by None."""
    return value if value is not None and math.isfinite(value) else None


def to_degrees(angle: float | None) -> float | None:
    """Decimal degrees in [0, 360) of an angle [rad]."""
    if finite(angle) is None or angle is None:
        return None
    degrees = math.degrees(wrap_two_pi(angle))
    return 0.0 if degrees >= 360.0 else degrees


def to_arcsec(angle: float | None) -> float | None:
    """Arc-seconds of an angle [rad], None where it is not determined."""
    return None if finite(angle) is None or angle is None else angle * RHO_ARCSEC


@dataclass(frozen=True, slots=True)
class AngleResult:
    """A direction with its sigma.

    Parameters
    ----------
    value : float
        [rad] in [0, 2 pi).
    sigma, interval95 : float
        One standard deviation; half-width of the 95 % interval [rad]. Infinite where nothing tells.
    dof : float
        Effective degrees of freedom.
    reference : str or None
        What the azimuth refers to; None for a circle reading.
    """

    value: float
    sigma: float
    interval95: float
    dof: float = math.inf
    reference: Reference | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        result: dict[str, Any] = {
            "deg": to_degrees(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "interval95_arcsec": to_arcsec(self.interval95),
        }
        if self.reference is not None:
            result["reference"] = self.reference
        return result


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
        Session, line or instrument.
    text : str
        One sentence in the trade's words.
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
        }


@dataclass(frozen=True, slots=True)
class PointResult:
    """One turning point (or round) of a session beside its fit.

    ``observed`` and ``fitted`` [rad] or, for scale readings, [div]; ``struck_seq`` etc. stay in
    the field book.
    """

    seq: int
    index: int
    side: str
    observed: float
    fitted: float | None
    residual: float | None
    elapsed_s: float | None = None


@dataclass(frozen=True, slots=True)
class TapeZeroResult:
    """Tape zero of a session [div] and its correction [rad]."""

    before_div: float | None
    after_div: float | None
    value_div: float
    interpolation: str
    coefficient: float | None
    coefficient_origin: str
    correction: float | None
    schuler_before_div: tuple[float, ...] = ()
    schuler_after_div: tuple[float, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "before_div": self.before_div,
            "after_div": self.after_div,
            "value_div": self.value_div,
            "interpolation": self.interpolation,
            "coefficient_arcsec_per_div": to_arcsec(self.coefficient),
            "coefficient_origin": self.coefficient_origin,
            "correction_arcsec": to_arcsec(self.correction),
            "schuler_before_div": list(self.schuler_before_div),
            "schuler_after_div": list(self.schuler_after_div),
        }


@dataclass(frozen=True, slots=True)
class TargetResult:
    """One sighted target of a session."""

    target: str
    line_reading: AngleResult | None
    gyro_azimuth: AngleResult | None
    collimation: float | None = None
    drift: float | None = None
    before: float | None = None
    after: float | None = None
    pointings: int = 0
    eccentric_correction: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "target": self.target,
            "line_reading": None if self.line_reading is None else self.line_reading.to_dict(),
            "gyro_azimuth": None if self.gyro_azimuth is None else self.gyro_azimuth.to_dict(),
            "collimation_arcsec": to_arcsec(self.collimation),
            "drift_arcsec": to_arcsec(self.drift),
            "pointings": self.pointings,
            "eccentric_correction_arcsec": to_arcsec(self.eccentric_correction),
        }


@dataclass(frozen=True, slots=True)
class SessionResult:
    """The reduction of one orientation session."""

    id: str
    station: str
    target: str | None
    instrument: str
    purpose: str
    method: str
    estimator: str
    gyro_north: AngleResult | None
    targets: tuple[TargetResult, ...]
    points_used: int
    dof: int
    sigma_source: str | None
    reading_sigma: float | None
    interval95: float | None
    residual_rms: float | None
    amplitude: float | None
    damping_per_half_swing: float | None
    period_s: float | None
    tape_zero: TapeZeroResult | None
    tape_zero_correction: float | None
    points: tuple[PointResult, ...] = ()
    schuler_means: tuple[float, ...] = ()
    quantities: tuple[tuple[str, float, str], ...] = ()
    warnings: tuple[ResultWarning, ...] = ()

    @property
    def main(self) -> TargetResult | None:
        """The session's own target, else the only one sighted."""
        for item in self.targets:
            if item.target == self.target:
                return item
        return self.targets[0] if len(self.targets) == 1 else None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        main = self.main
        reading = main.line_reading if main is not None else None
        azimuth = main.gyro_azimuth if main is not None else None
        return {
            "id": self.id,
            "station": self.station,
            "target": self.target,
            "instrument": self.instrument,
            "purpose": self.purpose,
            "method": self.method,
            "estimator": self.estimator,
            "gyro_north": None if self.gyro_north is None else self.gyro_north.to_dict(),
            "line_reading": None if reading is None else reading.to_dict(),
            "gyro_azimuth": None if azimuth is None else azimuth.to_dict(),
            "targets": [target.to_dict() for target in self.targets],
            "points_used": self.points_used,
            "dof": self.dof,
            "sigma_source": self.sigma_source,
            "interval95_arcsec": to_arcsec(self.interval95),
            "residual_rms_arcsec": to_arcsec(self.residual_rms),
            "amplitude_arcsec": to_arcsec(self.amplitude),
            "damping_per_half_swing": finite(self.damping_per_half_swing),
            "period_s": finite(self.period_s),
            "tape_zero_correction_arcsec": to_arcsec(self.tape_zero_correction),
            "tape_zero": None if self.tape_zero is None else self.tape_zero.to_dict(),
            "schuler_means_deg": [to_degrees(mean) for mean in self.schuler_means],
            "quantities": [
                {"name": name, "value": finite(value), "unit": unit}
                for name, value, unit in self.quantities
            ],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }


@dataclass(frozen=True, slots=True)
class LineConstant:
    """Instrument constant from one calibration line [rad]."""

    station: str
    target: str
    value: float
    sigma: float
    count: int
    rounds: int
    distance_m: float | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "station": self.station,
            "target": self.target,
            "arcsec": to_arcsec(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "n": self.count,
            "rounds": self.rounds,
            "distance_m": finite(self.distance_m),
        }


@dataclass(frozen=True, slots=True)
class Determination:
    """One determination of the instrument constant, for the plot through time."""

    session: str
    station: str
    target: str
    value: float
    sigma: float
    moment_s: float | None
    phase: str
    known_azimuth: float
    from_coordinates: float | None

    @property
    def known_minus_coordinates(self) -> float | None:
        """Known grid azimuth minus the one from the coordinates [rad], None without those."""
        if self.from_coordinates is None:
            return None
        return wrap_pi(self.known_azimuth - self.from_coordinates)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "session": self.session,
            "station": self.station,
            "target": self.target,
            "arcsec": to_arcsec(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "phase": self.phase,
            "azimuth_known_deg": to_degrees(self.known_azimuth),
            "known_minus_coordinates_arcsec": to_arcsec(self.known_minus_coordinates),
        }


@dataclass(frozen=True, slots=True)
class ConstantResult:
    """Instrument constant (true minus gyro, astronomic terms) of one instrument [rad]."""

    instrument: str
    value: float | None
    sigma: float | None
    interval95: float | None
    count: int
    stable: bool | None
    choice: str
    by_line: tuple[LineConstant, ...]
    determinations: tuple[Determination, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "instrument": self.instrument,
            "arcsec": to_arcsec(self.value),
            "sigma_arcsec": to_arcsec(self.sigma),
            "interval95_arcsec": to_arcsec(self.interval95),
            "n": self.count,
            "stable": self.stable,
            "choice": self.choice,
            "by_line": [line.to_dict() for line in self.by_line],
            "determinations": [item.to_dict() for item in self.determinations],
        }


@dataclass(frozen=True, slots=True)
class BudgetLine:
    """Share of one source in the variance of an azimuth."""

    source: str
    sigma: float
    share: float

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "source": self.source,
            "sigma_arcsec": to_arcsec(self.sigma),
            "share": finite(self.share),
        }


@dataclass(frozen=True, slots=True)
class LineResult:
    """The oriented line: what the whole program is for."""

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

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        constant = None
        if self.constant is not None:
            constant = {
                "arcsec": to_arcsec(self.constant),
                "sigma_arcsec": to_arcsec(self.constant_sigma),
                "choice": self.constant_choice,
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

    @property
    def passed(self) -> bool:
        """Whether every confirmed limit and test is met."""
        return not any(check.confirmed and check.passed is False for check in self.checks)

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
            "checks": [check.to_dict() for check in self.checks],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }
