"""``north --method rotation``: steps 101 to 113 of source 002, a gyro carried through a rotation.

The unit warms up, its rest is filtered, its tilt is measured and taken out by turns about Y and X,
and the heading that it had at first is carried through the rotation by quaternions. The heading
keeps the reference that it began with; a declination turns a magnetic one into a true one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final, Literal

import numpy as np

from surveyapp.core.sensors.clipping import clipped_problems
from surveyapp.core.sensors.declination import told_unstated, unstated_sigma
from surveyapp.core.sensors.rate.carried import Carried, Rest, Run, carry, tilt_of
from surveyapp.core.sensors.rate.level_phase import still_ends
from surveyapp.core.sensors.rate.parameters import DEG_H
from surveyapp.core.sensors.rate.rotation_checks import LONGEST_STEP, gap_sigma, gravity_problems
from surveyapp.core.statistics.distributions import NORMAL_95, student_tail
from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.north import NorthDirection, NorthResult, Reference
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import either, said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

GYROS = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")
ACCELEROMETERS = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
NEEDED = (*GYROS, *ACCELEROMETERS, "phase")
PHASES = ("warm-up", "filter", "level", "run")
TREND_S = 600.0
"""The last ten minutes of the warm-up are asked for a trend."""
WARM_UP_S = 1800.0
TREND_LEVEL = 0.01
ROUNDING = 1e-9
"""Part of a rate below which a trend is that of rounded numbers."""
ZERO_SIGMAS = 3.0
"""A tilt below this many sigmas is none."""

STEP_TITLES: Final = (
    (101, "take the unit: three gyros and three accelerometers"),
    (102, "a table with two axes or more"),
    (103, "set the table to zero"),
    (104, "mount the unit: X lateral (pitch), Y forward (roll), Z up (heading)"),
    (105, "warm up for 30 min, until the rest has no trend"),
    (106, "link the unit and record"),
    (107, "filter the rest"),
    (108, "temperature of the record"),
    (109, "installation matrix and biases: w = K^-T (reading - bias)"),
    (110, "initial attitude (0, 0, heading) with its reference"),
    (111, "environment: temperature, pitch and roll"),
    (112, "level by turns about Y, then X"),
    (113, "carry the heading through the rotation"),
)


@dataclass(frozen=True, slots=True)
class RotationOptions:
    """What is stated beside the log.

    Parameters
    ----------
    heading : float
        At the beginning [rad].
    reference : str
    heading_sigma : float or None
        Of that heading [rad]; None = not stated, it counts as exact and that is told.
    declination, declination_sigma : float or None
        [rad]; without a sigma that of a model.
    latitude : float or None
        [rad]
    matrix, bias : ndarray
        Output matrix M of the card (output = M rate + bias), shape (3, 3), and bias [rad/s], (3,)
        or one for each row of the log.
    force_matrix, force_bias : ndarray, shape (3, 3), (3,)
        The same of the accelerometers [m/s2].
    card : str
        Its id, for the result.
    temperature_model : str
        Model of the card by which the bias follows the temperature; empty = it does not.
    """

    heading: float
    reference: Reference
    heading_sigma: float | None = None
    declination: float | None = None
    declination_sigma: float | None = None
    latitude: float | None = None
    matrix: Floats = field(default_factory=lambda: np.eye(3))
    bias: Floats = field(default_factory=lambda: np.zeros(3))
    force_matrix: Floats = field(default_factory=lambda: np.eye(3))
    force_bias: Floats = field(default_factory=lambda: np.zeros(3))
    card: str = ""
    temperature_model: str = ""


def find_heading(log: SensorLog, options: RotationOptions) -> NorthResult:
    """Carry a heading through the record.

    Raises
    ------
    SurveyError
        If a phase is missing.
    """
    if options.declination is not None and options.declination_sigma is None:
        options = replace(options, declination_sigma=unstated_sigma(log))
        told = told_unstated(options.declination_sigma or 0.0)
        log = replace(log, warnings=(*log.warnings, told))
    phases = np.array([word.strip() for word in log.texts["phase"]])
    problems = _phase_problems(phases, log.path)
    if problems:
        raise SurveyError(problems)
    rates = np.column_stack([log.columns[c] for c in GYROS])
    rates = np.asarray(np.linalg.solve(options.matrix, (rates - options.bias).T).T)
    forces = np.column_stack([log.columns[c] for c in ACCELEROMETERS])
    forces = np.asarray(np.linalg.solve(options.force_matrix, (forces - options.force_bias).T).T)
    interval = 1.0 / (log.rate_hz or 100.0)
    warm = _warm_up(rates[phases == "warm-up"], interval)
    level_rows = np.flatnonzero(phases == "level")
    before, after = still_ends(forces[level_rows])
    filter_rows = np.flatnonzero(phases == "filter")
    rest_rows = np.union1d(filter_rows, np.union1d(level_rows[before], level_rows[after]))
    rest, rest_sigma, gained = _filtered(rates[rest_rows])
    levelling, levelled = _levelling(forces[level_rows][before]), forces[level_rows][after]
    run_rows = np.flatnonzero(phases == "run")
    run = _run_of(log, rates, forces, run_rows)
    known = Rest(
        rest,
        rest_sigma,
        np.std(np.diff(rates[rest_rows], axis=0), axis=0) / math.sqrt(2.0),
        tilt_of(levelled.mean(axis=0)),
        float(np.mean(levelled.std(axis=0, ddof=1))),
    )
    problems = clipped_problems(log, GYROS, run_rows)
    denied, told_gravity = ([], []) if problems else gravity_problems(run, known, log.path)
    if problems or denied:
        raise SurveyError([*problems, *denied])
    log = replace(log, warnings=(*log.warnings, *told_gravity))
    carried = carry(
        run,
        known,
        heading=options.heading + (options.declination or 0.0),
        latitude=options.latitude,
    )
    added = options.declination_sigma or 0.0
    sigma = math.hypot(carried.sigma, options.heading_sigma or 0.0, added, gap_sigma(run))
    turned = before != after
    return _result(log, options, carried, sigma, found=(warm, levelling, rest, gained, turned))


def _run_of(log: SensorLog, rates: Floats, forces: Floats, rows: np.ndarray) -> Run:
    """Samples of the run and how long each lasts: to the next row, wherever that belongs.

    Over a gap the rate is the mean of those about it.
    """
    time = log.columns["time_s"]
    usual = float(np.median(np.diff(time[rows])))
    until = np.append(np.diff(time), usual)[rows]
    intervals = np.where(until > 0.0, until, usual)
    held = rates[rows].copy()
    before = np.flatnonzero(intervals[:-1] > LONGEST_STEP * usual)
    held[before] = 0.5 * (rates[rows[before]] + rates[rows[before] + 1])
    return Run(held, forces[rows], intervals)


def _phase_problems(phases: np.ndarray, where: str) -> list[Problem]:
    problems = []
    strange = sorted(set(phases.tolist()) - set(PHASES))
    if strange:
        expected = either(PHASES)
        problems.append(Problem("there is no such phase", where, ", ".join(strange), expected))
    problems += [
        Problem("a phase is missing", where, "", name, said("rows with phase = {name}", name=name))
        for name in ("level", "run")
        if np.count_nonzero(phases == name) < 2
    ]
    return problems


@dataclass(frozen=True, slots=True)
class WarmUp:
    """Length [s] of the warm-up, and whether its last ten minutes still drift."""

    seconds: float
    p: float | None
    drift_deg_h_h: float | None

    @property
    def ended(self) -> bool:
        """Whether no trend is left."""
        return self.p is None or self.p > TREND_LEVEL


def _warm_up(rates: Floats, interval: float) -> WarmUp:
    """Straight line through means of 20 s of the last ten minutes, of the worst axis."""
    seconds = rates.shape[0] * interval
    last = rates[-round(TREND_S / interval) :]
    size = max(round(20.0 / interval), 1)
    count = last.shape[0] // size
    if count < 6:
        return WarmUp(seconds, None, None)
    means = last[: count * size].reshape(count, size, 3).mean(axis=1)
    t = (np.arange(count) - 0.5 * (count - 1)) * size * interval
    slope = (t @ means) / float(t @ t)
    rest = means - means.mean(axis=0) - np.outer(t, slope)
    sigma = np.sqrt(np.sum(rest**2, axis=0) / (count - 2) / float(t @ t))
    k = int(np.argmax(np.abs(slope) / np.maximum(sigma, 1e-300)))
    least = np.maximum(sigma, ROUNDING * np.abs(means).max() / TREND_S)
    score = float(abs(slope[k]) / max(float(least[k]), 1e-300))
    p = min(1.0, 3.0 * 2.0 * student_tail(score, count - 2))
    return WarmUp(seconds, p, float(slope[k]) * 3600.0 / DEG_H)


def _filtered(rates: Floats) -> tuple[Floats, Floats, dict[str, float]]:
    """Mean of the rest as a scalar Kalman filter of a constant ends, its sigma, and the gain."""
    mean = rates.mean(axis=0)
    sample = rates.std(axis=0, ddof=1)
    size = max(rates.shape[0] // 20, 1)
    whole = rates[: rates.shape[0] - rates.shape[0] % size].reshape(-1, size, 3).mean(axis=1)
    blocks = whole.std(axis=0, ddof=1) / math.sqrt(whole.shape[0]) if whole.shape[0] > 2 else sample
    sigma = np.maximum(sample / math.sqrt(rates.shape[0]), blocks)
    return (
        mean,
        sigma,
        {
            "sd_sample_deg_h": float(np.mean(sample)) / DEG_H,
            "sd_filtered_deg_h": float(np.mean(sigma)) / DEG_H,
        },
    )


@dataclass(frozen=True, slots=True)
class Levelling:
    """Tilt of the unit and the turns that take it out [rad].

    Case A1: none; A2: -roll about Y; A3: -pitch about X; A4: Y first, then X.
    """

    pitch: float
    roll: float
    sigma: float
    case: Literal["A1", "A2", "A3", "A4"]
    rotations: tuple[tuple[str, float], ...]


def level_case(pitch: float, roll: float, sigma: float) -> Levelling:
    """Decision of source 002; a tilt below three sigmas is zero.

    Parameters
    ----------
    pitch, roll, sigma : float
        [rad]
    """
    rolls, pitches = abs(roll) >= ZERO_SIGMAS * sigma, abs(pitch) >= ZERO_SIGMAS * sigma
    turns = (("y", -roll),) * rolls + (("x", -pitch),) * pitches
    cases: Mapping[tuple[bool, bool], Literal["A1", "A2", "A3", "A4"]] = {
        (False, False): "A1",
        (True, False): "A2",
        (False, True): "A3",
        (True, True): "A4",
    }
    return Levelling(pitch, roll, sigma, cases[(rolls, pitches)], turns)


def _levelling(forces: Floats) -> Levelling:
    mean = forces.mean(axis=0)
    size = float(np.linalg.norm(mean))
    pitch, roll = tilt_of(mean)
    sigma = float(np.mean(forces[:, :2].std(axis=0, ddof=1))) / math.sqrt(forces.shape[0]) / size
    return level_case(pitch, roll, sigma)


def _result(
    log: SensorLog,
    options: RotationOptions,
    carried: Carried,
    sigma: float,
    *,
    found: tuple[WarmUp, Levelling, Floats, dict[str, float], bool],
) -> NorthResult:
    warm, levelling, rest, gained, turned = found
    reference: Reference = options.reference if options.declination is None else "ASTRONOMIC"
    parameters = tuple(
        SensorParameter(f"rest_rate_{a}", float(rest[i]) / DEG_H, None, "deg/h")
        for i, a in enumerate("xyz")
    )
    return NorthResult(
        method="rotation",
        source=log.id,
        key="heading",
        direction=NorthDirection(
            math.degrees(carried.heading), sigma / ARCSEC, NORMAL_95 * sigma / ARCSEC, reference
        ),
        parameters=parameters,
        warnings=(*log.warnings, *_warnings(options, warm, turned=turned)),
        n=log.size,
        sha256=log.sha256,
        extra={
            "attitude_quaternion": carried.quaternion.tolist(),
            "levelling": {
                "case": levelling.case,
                "pitch_deg": math.degrees(levelling.pitch),
                "roll_deg": math.degrees(levelling.roll),
                "sigma_deg": math.degrees(levelling.sigma),
                "rotations": [
                    {"axis": axis, "deg": math.degrees(angle)}
                    for axis, angle in levelling.rotations
                ],
            },
            "steps": _steps(log, options, warm, gained, levelling=levelling),
            "turned_deg": math.degrees(carried.turned) % 360.0,
        },
        direction_extra={"axis": "z" if carried.vertical else "y"},
    )


def _warnings(options: RotationOptions, warm: WarmUp, *, turned: bool) -> list[ResultWarning]:
    warnings = []
    if turned:
        text = (
            "the unit turned within the phase level: the tilt is that of its beginning, and the "
            "run goes on from the attitude of its end"
        )
        warnings.append(ResultWarning("level_turned", text))
    if not warm.ended:
        text = said(
            "the last ten minutes of the warm-up still drift by "
            "{drift_deg_h_h:.3g} deg/h per hour: it has not ended",
            drift_deg_h_h=warm.drift_deg_h_h,
        )
        warnings.append(ResultWarning("warm_up", text))
    if warm.seconds < 0.99 * WARM_UP_S:
        text = said("{value:.1f} min of warm-up; the source asks for 30", value=warm.seconds / 60.0)
        warnings.append(ResultWarning("short_warm_up", text))
    if options.heading_sigma is None:
        text = (
            "the initial heading has no sigma and counts as exact: its error is in no sigma "
            "(--initial-heading-sigma-deg)"
        )
        warnings.append(ResultWarning("initial_heading_exact", text))
    if options.latitude is None:
        text = (
            "without a latitude the earth's rate is taken out as it was at rest; how it moved in "
            "the unit is counted in the sigma"
        )
        warnings.append(ResultWarning("rest_rate", text))
    if not options.card:
        text = (
            "no sensor card: the gyros' scale factors are taken as nominal, and their error times "
            "the angle turned is in no sigma"
        )
        warnings.append(ResultWarning("nominal_scale", text))
    return warnings


def _steps(
    log: SensorLog,
    options: RotationOptions,
    warm: WarmUp,
    gained: Mapping[str, float],
    *,
    levelling: Levelling,
) -> list[dict[str, Any]]:
    """Steps 101 to 113 with what this record says of each."""
    temperature = log.columns.get("temperature_c")
    degrees = None if temperature is None else float(np.nanmean(temperature))
    told: dict[int, dict[str, Any]] = {
        105: {"seconds": warm.seconds, "trend_p": warm.p, "ended": warm.ended},
        106: {"rows": log.size, "rate_hz": log.rate_hz},
        107: dict(gained),
        108: {"temperature_c": degrees, "bias_model": options.temperature_model or None},
        109: {"card": options.card or None},
        110: {"heading_deg": math.degrees(options.heading), "reference": options.reference},
        111: {
            "temperature_c": degrees,
            "pitch_deg": math.degrees(levelling.pitch),
            "roll_deg": math.degrees(levelling.roll),
        },
        112: {"case": levelling.case},
        113: {"rows": int(sum(word.strip() == "run" for word in log.texts["phase"]))},
    }
    return [{"step": n, "title": title, **told.get(n, {})} for n, title in STEP_TITLES]
