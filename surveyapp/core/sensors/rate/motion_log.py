"""``motion``: a vehicle's inertial record to states, path, and the test of its own gate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from surveyapp.core.sensors.rate.motion_states import (
    Thresholds,
    forward_and_turn,
    segments_of,
    thresholds_of,
)
from surveyapp.core.sensors.rate.odometer_path import Driven, Reckoned, reckon, snap
from surveyapp.core.sensors.rate.still import (
    FALSE_ALARM,
    WINDOW_S,
    Gate,
    Mask,
    RestNoise,
    bridged,
    kappa,
    motion_gate,
    norm_and_rate,
    rest_noise,
    runs_of,
    statistic,
)
from surveyapp.core.sensors.rate.zero_velocity import BOUND, TOLERATED, InertialPath, inertial_path
from surveyapp.domain.motion import Motion, MotionSegment, Path, Snapped
from surveyapp.domain.project import ResultWarning
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said
from surveyapp_models.arrays import Floats

GYROS = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")
ACCELEROMETERS = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
NEEDED = (*GYROS, *ACCELEROMETERS)
OPTIONAL = ("odometer_m", "power_cycle", "heading_deg", "temperature_c")
SAME_STOP_M = 0.03
"""Stops closer than this are one that was bumped."""
LONGEST_GAP_S = 0.2
"""Gap while moving from which a path is not to be used: a turn of 15 degrees/s hides 3 degrees."""
LEAST_ROWS = 100
BEGIN_SIGMA = math.radians(0.5)
"""Of the azimuth at the beginning where it is stated without a sigma [rad]."""


@dataclass(frozen=True, slots=True)
class MotionOptions:
    """What is asked for.

    Parameters
    ----------
    false_alarm : float
    still_gate_factor : float
    path : bool
    begin : tuple of float, or None
        East, north [m], azimuth [rad].
    end : tuple of float, or None
        East, north [m].
    snap : bool
    power_cycle : str
        previous | current
    """

    false_alarm: float = FALSE_ALARM
    still_gate_factor: float = 1.0
    path: bool = False
    begin: tuple[float, float, float] | None = None
    end: tuple[float, float] | None = None
    snap: bool = False
    power_cycle: Literal["previous", "current"] = "current"


def judge_motion(log: SensorLog, options: MotionOptions) -> Motion:
    """States, path and test of a record.

    Raises
    ------
    SurveyError
    """
    if log.size < LEAST_ROWS:
        found = said("{size} rows", size=log.size)
        raise SurveyError(Problem("the record is too short", log.path, found, "100 rows or more"))
    force = np.column_stack([log.columns[c] for c in ACCELEROMETERS])
    rate = np.column_stack([log.columns[c] for c in GYROS])
    time = log.columns["time_s"]
    interval = 1.0 / (log.rate_hz or 100.0)
    noise = rest_noise(force, rate, rate_hz=1.0 / interval)
    window = max(round(WINDOW_S / interval), 3)
    values = statistic(force, rate, noise, window=window)
    gate = motion_gate(
        values,
        window=window,
        false_alarm=options.false_alarm,
        factor=options.still_gate_factor,
    )
    still = bridged(values <= gate.threshold, rate_hz=1.0 / interval)
    forward, turn = forward_and_turn(force, rate, still, noise, interval_s=interval)
    limits = thresholds_of(force, rate, still, interval_s=interval, false_alarm=options.false_alarm)
    segments = segments_of(time, still, forward, turn, limits=limits)
    other = bridged(
        norm_and_rate(force, rate, noise, false_alarm=options.false_alarm), rate_hz=1.0 / interval
    )
    record = _Record(log, force, rate, still, noise, interval)
    path, snapped, zero, warnings = _path(record, options)
    unseen = _unseen(time, still, interval) if path is not None else None
    if unseen is not None:
        warnings = [*warnings, unseen]
    consistent = unseen is None and (zero is None or zero["verdict"] == "consistent")
    return Motion(
        source=log.id,
        n=log.size,
        rate_hz=1.0 / interval,
        segments=tuple(segments),
        false_alarm=options.false_alarm,
        thresholds=_thresholds(gate, limits),
        detectors={
            "likelihood_ratio_still": float(np.mean(still)),
            "norm_and_rate_still": float(np.mean(other)),
            "kappa": kappa(still, other),
        },
        path=path,
        zero_velocity=zero,
        snapped=tuple(snapped),
        warnings=(*log.warnings, *warnings, *_told(segments, zero)),
        met=consistent,
        sha256=log.sha256,
    )


def _unseen(time: Floats, still: Mask, interval: float) -> ResultWarning | None:
    """That a path runs over a gap in which the unit may have moved: it is not known there."""
    gaps = np.diff(time)
    rows = np.flatnonzero((gaps > max(LONGEST_GAP_S, 1.5 * interval)) & ~(still[:-1] & still[1:]))
    if rows.size == 0:
        return None
    first = int(rows[0])
    text = counted(
        "the record has a gap from {begin:.6g} to {end:.6g} s while moving: what was turned there "
        "is not known, and the path after it is not to be used",
        "the record has {count} gaps while moving, the first from {begin:.6g} to {end:.6g} s: what "
        "was turned there is not known, and the path after it is not to be used",
        count=rows.size,
        begin=time[first],
        end=time[first + 1],
    )
    return ResultWarning("path_over_gap", text)


def _thresholds(gate: Gate, limits: Thresholds) -> dict[str, float]:
    return {
        "still_statistic": gate.threshold,
        "window_samples": float(gate.window),
        "acceleration_m_s2": limits.force,
        "turning_deg_s": math.degrees(limits.turn),
    }


@dataclass(frozen=True, slots=True)
class _Record:
    """The columns as arrays, what was found at rest, and the interval [s]."""

    log: SensorLog
    force: Floats
    rate: Floats
    still: Mask
    noise: RestNoise
    interval: float


def _path(
    record: _Record, options: MotionOptions
) -> tuple[Path | None, list[Snapped], Mapping[str, Any] | None, list[ResultWarning]]:
    """Path and tests that are asked for."""
    asked = options.path or options.snap
    if not asked and options.still_gate_factor == 1.0:
        return None, [], None, []
    if not record.still.any():
        if not asked:
            return None, [], None, []
        hint = "stand still for some seconds before driving off: bias and level come from there"
        raise SurveyError(Problem("there is no stop in the record", record.log.path, hint=hint))
    if asked and "odometer_m" in record.log.columns:
        path, snapped = _by_odometer(record, options)
        return path, snapped, None, []
    begun = int(np.argmax(record.still))
    warnings = []
    if begun > 0:
        text = said(
            "the first {value:.1f} s before the first stop are not in the path",
            value=begun * record.interval,
        )
        warnings.append(ResultWarning("before_first_stop", text))
    found = inertial_path(
        record.force[begun:], record.rate[begun:], record.still[begun:], interval_s=record.interval
    )
    zero = _zero_velocity(found)
    return _inertial(found, record.still[begun:], options), [], zero, warnings


def _zero_velocity(found: InertialPath) -> dict[str, Any]:
    return {
        "verdict": "consistent" if found.consistent else "inconsistent",
        "share_exceeding": found.exceeding,
        "expected_share": 0.01,
        "tolerated_share": TOLERATED,
        "bound": BOUND,
        "updates": found.updates,
    }


def _inertial(found: InertialPath, still: Mask, options: MotionOptions) -> Path:
    place = found.position
    if options.begin is not None:
        e, n, azimuth = options.begin
        c, s = math.cos(azimuth), math.sin(azimuth)
        turned = place.copy()
        turned[:, 0] = e + c * place[:, 0] + s * place[:, 1]
        turned[:, 1] = n - s * place[:, 0] + c * place[:, 1]
        place = turned
    stops = _stop_places(place, still)
    target = place[0].copy()
    if options.end is not None:
        target[:2] = options.end
        closure = math.hypot(*(place[-1] - target)[:2].tolist())
    else:
        closure = float(np.linalg.norm(place[-1] - target))
    along = np.concatenate(
        [[0.0], np.cumsum(np.linalg.norm(np.diff(place[:, :2], axis=0), axis=1))]
    )
    rows = np.unique(np.searchsorted(along, np.arange(0.0, along[-1], 0.05)))
    share = rows / max(place.shape[0] - 1, 1)
    points = tuple(
        (float(along[k]), float(place[k, 0]), float(place[k, 1]),
         float(found.sigma[0] * math.sqrt(r)), float(found.sigma[1] * math.sqrt(r)))
        for k, r in zip(rows.tolist(), share.tolist(), strict=True)
    )  # fmt: skip
    return Path(
        "inertial", closure, tuple(place[-1].tolist()), _sides(stops), points, float(along[-1])
    )


def _stop_places(place: Floats, still: Mask) -> list[Floats]:
    """One place a stop: bumps within a stop are not sides."""
    stops: list[Floats] = []
    for first, last in runs_of(still):
        here = np.median(place[first:last], axis=0)
        if not stops or float(np.linalg.norm(here - stops[-1])) > SAME_STOP_M:
            stops.append(here)
    return stops


def _sides(stops: list[Floats]) -> tuple[float, ...]:
    return tuple(float(np.linalg.norm(b - a)) for a, b in pairwise(stops))


def _by_odometer(record: _Record, options: MotionOptions) -> tuple[Path, list[Snapped]]:
    log = record.log
    begin = options.begin or (0.0, 0.0, 0.0)
    driven = _driven(record, begin[2])
    snapped: list[Snapped] = []
    if options.snap:
        driven, snapped, _ = snap(
            driven, power_cycle=options.power_cycle, end=options.end, start=begin[:2]
        )
    speed = max(
        float(driven.distance[-1] - driven.distance[0]) / float(np.ptp(log.columns["time_s"])), 0.01
    )
    walk = float(record.noise.rate[2]) * math.sqrt(record.interval / speed)
    found = reckon(driven, start=begin[:2], heading_walk=walk, heading_sigma=BEGIN_SIGMA)
    end = found.place[-1]
    target = options.end if options.end is not None else begin[:2]
    closure = math.hypot(float(end[0]) - target[0], float(end[1]) - target[1])
    return _odometer_path(found, driven, closure), snapped


def _driven(record: _Record, azimuth: float) -> Driven:
    """Odometer and integrated heading; biases from every rest, so that the earth cancels too."""
    log = record.log
    up = 1.0 if float(np.median(record.force[:, 2])) >= 0.0 else -1.0
    bias = _bias_at_rest(record)
    turn = -up * (record.rate[:, 2] - bias)
    turn[record.still] = 0.0
    heading = azimuth + np.concatenate([[0.0], np.cumsum(turn[:-1]) * record.interval])
    known = log.columns.get("heading_deg", np.full(log.size, np.nan))
    cycle = log.columns.get("power_cycle", np.zeros(log.size))
    distance = np.maximum.accumulate(log.columns["odometer_m"])
    return Driven(distance, heading, np.deg2rad(known), np.nan_to_num(cycle), record.still)


def _bias_at_rest(record: _Record) -> Floats:
    """Mean vertical rate of each rest, joined by straight lines, shape (n,)."""
    runs = [r for r in runs_of(record.still) if r[1] - r[0] >= round(0.5 / record.interval)]
    if not runs:
        return np.full(record.still.size, float(record.noise.bias[2]))
    middle = np.array([0.5 * (a + b) for a, b in runs])
    means = np.array([float(record.rate[a:b, 2].mean()) for a, b in runs])
    return np.asarray(np.interp(np.arange(record.still.size), middle, means))


def _odometer_path(found: Reckoned, driven: Driven, closure: float) -> Path:
    zero = float(driven.distance[0])
    stops: list[Floats] = []
    for first, last in runs_of(driven.still):
        along = float(driven.distance[(first + last) // 2]) - zero
        here = np.array([np.interp(along, found.distance, found.place[:, i]) for i in range(2)])
        if not stops or float(np.linalg.norm(here - stops[-1])) > SAME_STOP_M:
            stops.append(here)
    sigma = np.sqrt(np.maximum(np.diagonal(found.covariance, axis1=1, axis2=2), 0.0))
    points = tuple(
        (float(d), float(p[0]), float(p[1]), float(s[0]), float(s[1]))
        for d, p, s in zip(found.distance, found.place, sigma, strict=True)
    )
    end = (float(found.place[-1, 0]), float(found.place[-1, 1]), 0.0)
    return Path("odometer", closure, end, _sides(stops), points, float(found.distance[-1]))


def _told(segments: list[MotionSegment], zero: Mapping[str, Any] | None) -> list[ResultWarning]:
    warnings = []
    if zero is not None and zero["verdict"] == "inconsistent":
        text = said(
            "{zero:.0%} of the velocity innovations lie beyond the 99 % bound: "
            "motion was taken for rest; the gate is too wide, whatever the closure "
            "says",
            zero=zero["share_exceeding"],
        )
        warnings.append(ResultWarning("gate_too_wide", text))
    if all(s.state != "stationary" for s in segments):
        text = "no stop: bias and noise are those of the quietest part of a moving record"
        warnings.append(ResultWarning("no_stop", text))
    return warnings
