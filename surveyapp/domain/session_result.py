"""The reduction of one session as results hold it: its points, tape zero, targets, gyro north."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from surveyapp.domain.angle_result import AngleResult, finite, to_arcsec, to_degrees
from surveyapp.domain.session_sensors import LogLevelling, PreOrientation
from surveyapp.domain.warning import ResultWarning


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
    levelling_correction: float | None = None

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
            "levelling_correction_arcsec": to_arcsec(self.levelling_correction),
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
    levelling: LogLevelling | None = None
    pre_orientation: PreOrientation | None = None

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
            "levelling_correction_arcsec": to_arcsec(
                None if main is None else main.levelling_correction
            ),
            "levelling": None if self.levelling is None else self.levelling.to_dict(),
            "pre_orientation": (
                None if self.pre_orientation is None else self.pre_orientation.to_dict()
            ),
            "tape_zero": None if self.tape_zero is None else self.tape_zero.to_dict(),
            "schuler_means_deg": [to_degrees(mean) for mean in self.schuler_means],
            "quantities": [
                {"name": name, "value": finite(value), "unit": unit}
                for name, value, unit in self.quantities
            ],
            "warnings": [warning.to_dict() for warning in self.warnings],
        }
