"""``motion``: a vehicle's inertial record to states, path, and the test of its own gate."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from surveyapp.core.sensors.clipping import clipped_problems
from surveyapp.core.sensors.rate.motion_doubts import (
    CONTRADICTIONS,
    odometer_problems,
    record_doubts,
)
from surveyapp.core.sensors.rate.motion_pieces import (
    ACCELEROMETERS,
    GYROS,
    PIECE_ROWS,
    States,
    stacked,
    states_of,
)
from surveyapp.core.sensors.rate.motion_states import Thresholds
from surveyapp.core.sensors.rate.odometer_drive import drive_of
from surveyapp.core.sensors.rate.odometer_path import Driven, Reckoned, reckon
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.core.sensors.rate.snapping import snap
from surveyapp.core.sensors.rate.still import FALSE_ALARM, Gate
from surveyapp.core.sensors.rate.zero_velocity import (
    BOUND,
    TOLERATED,
    InertialPath,
    Samples,
    inertial_path,
)
from surveyapp.domain.columns import Room, in_memory, let_go
from surveyapp.domain.motion import Motion, MotionSegment, Path, Snapped
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said
from surveyapp_models.arrays import Floats

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


def judge_motion(log: SensorLog, options: MotionOptions, *, room: Room = in_memory) -> Motion:
    """States, path and test of a record.

    Parameters
    ----------
    log : SensorLog
    options : MotionOptions
    room : callable
        Where columns as long as the record lie.

    Raises
    ------
    SurveyError
    """
    if log.size < LEAST_ROWS:
        found = said("{size} rows", size=log.size)
        raise SurveyError(Problem("the record is too short", log.path, found, "100 rows or more"))
    falls = odometer_problems(log)
    if options.path or options.snap:
        falls += clipped_problems(log, GYROS, slice(None))
    if falls:
        raise SurveyError(falls)
    interval = 1.0 / (log.rate_hz or 100.0)
    states = states_of(log, false_alarm=options.false_alarm, factor=options.still_gate_factor)
    path, snapped, zero, warnings = _path(_Record(log, states, interval, room), options)
    time = log.columns["time_s"]
    doubts = record_doubts(log, states.rests, snapping=options.snap)
    warnings = [*warnings, *doubts]
    unseen = _unseen(time, states.rests, interval) if path is not None else None
    if unseen is not None:
        warnings = [*warnings, unseen]
    wrong = any(w.code in CONTRADICTIONS for w in doubts)
    consistent = unseen is None and not wrong and (zero is None or zero["verdict"] == "consistent")
    return Motion(
        source=log.id,
        n=log.size,
        rate_hz=1.0 / interval,
        segments=states.segments,
        false_alarm=options.false_alarm,
        thresholds=_thresholds(states.gate, states.limits),
        detectors={
            "likelihood_ratio_still": states.still_share,
            "norm_and_rate_still": states.other_share,
            "kappa": states.kappa,
        },
        path=path,
        zero_velocity=zero,
        snapped=tuple(snapped),
        warnings=(*log.warnings, *warnings, *_told(states.segments, zero)),
        met=consistent,
        sha256=log.sha256,
    )


def _unseen(time: Floats, rests: Rests, interval: float) -> ResultWarning | None:
    """That a path runs over a gap in which the unit may have moved: it is not known there."""
    longest = max(LONGEST_GAP_S, 1.5 * interval)
    found = []
    for begin in range(0, time.size - 1, PIECE_ROWS):
        part = slice(begin, begin + PIECE_ROWS + 1)
        wide, still = np.diff(time[part]) > longest, rests.mask(begin, begin + PIECE_ROWS + 1)
        found.append(begin + np.flatnonzero(wide & ~(still[:-1] & still[1:])))
        let_go(time)
    rows = np.concatenate(found)
    if rows.size == 0:
        return None
    first = int(rows[0])
    text = counted(
        "the record has a gap from {begin:.12g} to {end:.12g} s while moving: what was turned "
        "there is not known, and the path after it is not to be used",
        "the record has {count} gaps while moving, the first from {begin:.12g} to {end:.12g} s: "
        "what was turned there is not known, and the path after it is not to be used",
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
    """A log, what was found of its states, the interval [s], and room for further columns."""

    log: SensorLog
    states: States
    interval: float
    room: Room

    @property
    def rests(self) -> Rests:
        """Its rests."""
        return self.states.rests

    def samples_from(self, begun: int) -> Samples:
        """Forces and rates of the rows from one on, read when they are asked for."""

        def rows(first: int, last: int, /) -> tuple[Floats, Floats]:
            part = slice(begun + first, begun + last)
            return stacked(self.log, ACCELEROMETERS, part), stacked(self.log, GYROS, part)

        return rows


def _path(
    record: _Record, options: MotionOptions
) -> tuple[Path | None, list[Snapped], Mapping[str, Any] | None, list[ResultWarning]]:
    """Path and tests that are asked for."""
    asked = options.path or options.snap
    if not asked and options.still_gate_factor == 1.0:
        return None, [], None, []
    if not record.rests.runs:
        if not asked:
            return None, [], None, []
        hint = "stand still for some seconds before driving off: bias and level come from there"
        raise SurveyError(Problem("there is no stop in the record", record.log.path, hint=hint))
    if asked and "odometer_m" in record.log.columns:
        path, snapped, warnings = _by_odometer(record, options)
        return path, snapped, None, warnings
    begun = record.rests.runs[0][0]
    warnings = []
    if begun > 0:
        text = said(
            "the first {value:.1f} s before the first stop are not in the path",
            value=begun * record.interval,
        )
        warnings.append(ResultWarning("before_first_stop", text))
    rests = record.rests.behind(begun)
    found = inertial_path(record.samples_from(begun), rests, interval_s=record.interval)
    return _inertial(found, rests.size, options), [], _zero_velocity(found), warnings


def _zero_velocity(found: InertialPath) -> dict[str, Any]:
    return {
        "verdict": "consistent" if found.consistent else "inconsistent",
        "share_exceeding": found.exceeding,
        "expected_share": 0.01,
        "tolerated_share": TOLERATED,
        "bound": BOUND,
        "updates": found.updates,
    }


def _inertial(found: InertialPath, size: int, options: MotionOptions) -> Path:
    place, stops, end = found.place, found.stops, found.end
    level = found.covariance[:2, :2]
    begin = place[0]
    if options.begin is not None:
        place, stops, end = (_laid(v, options.begin) for v in (place, stops, end))
        begin = place[0]
        c, s = math.cos(options.begin[2]), math.sin(options.begin[2])
        axes = np.array([[c, s], [-s, c]])
        level = axes @ level @ axes.T
    if options.end is not None:
        closure = math.hypot(*(end[:2] - np.array(options.end)).tolist())
    else:
        closure = float(np.linalg.norm(end - begin))
    spread = np.sqrt(np.maximum(np.diag(level), 0.0))
    share = found.rows / max(size - 1, 1)
    grown = np.sqrt(share)
    points = np.column_stack(
        [found.along, place[:, :2], spread[0] * grown, spread[1] * grown, level[0, 1] * share]
    )
    sides = _sides(_apart(list(stops)))
    return Path("inertial", closure, tuple(end.tolist()), sides, points, found.length)


def _laid(places: Floats, begin: tuple[float, float, float]) -> Floats:
    """Places of the body's first level frame in east and north, shape (..., 3)."""
    e, n, azimuth = begin
    c, s = math.cos(azimuth), math.sin(azimuth)
    turned = places.copy()
    turned[..., 0] = e + c * places[..., 0] + s * places[..., 1]
    turned[..., 1] = n - s * places[..., 0] + c * places[..., 1]
    return turned


def _apart(places: list[Floats]) -> list[Floats]:
    """One place a stop: bumps within a stop are not sides."""
    stops: list[Floats] = []
    for here in places:
        if not stops or float(np.linalg.norm(here - stops[-1])) > SAME_STOP_M:
            stops.append(here)
    return stops


def _sides(stops: list[Floats]) -> tuple[float, ...]:
    return tuple(float(np.linalg.norm(b - a)) for a, b in pairwise(stops))


def _by_odometer(
    record: _Record, options: MotionOptions
) -> tuple[Path, list[Snapped], list[ResultWarning]]:
    log = record.log
    begin = options.begin or (0.0, 0.0, 0.0)
    time, noise = log.columns["time_s"], record.states.noise
    driven = drive_of(
        log,
        record.rests,
        azimuth=begin[2],
        bias=float(noise.bias[2]),
        interval_s=record.interval,
        room=record.room,
    )
    snapped: list[Snapped] = []
    warnings = []
    if options.snap:
        driven, snapped = snap(
            driven,
            power_cycle=options.power_cycle,
            end=options.end,
            start=begin[:2],
            room=record.room,
        )
        if options.end is not None and not driven.known and not snapped:
            text = "nothing was snapped: no drift of the heading brings the path to the stated end"
            warnings.append(ResultWarning("end_not_met", text))
    driven_m = float(driven.distance[-1] - driven.distance[0])
    speed = max(driven_m / float(time[-1] - time[0]), 0.01)
    walk = float(noise.rate[2]) * math.sqrt(record.interval / speed)
    found = reckon(driven, start=begin[:2], heading_walk=walk, heading_sigma=BEGIN_SIGMA)
    end = found.place[-1]
    target = options.end if options.end is not None else begin[:2]
    closure = math.hypot(float(end[0]) - target[0], float(end[1]) - target[1])
    return _odometer_path(found, driven, closure), snapped, warnings


def _odometer_path(found: Reckoned, driven: Driven, closure: float) -> Path:
    middle = [(first + last) // 2 for first, last in driven.rests.runs]
    along = driven.distances(middle) - float(driven.distance[0])
    at = np.column_stack([np.interp(along, found.distance, found.place[:, i]) for i in range(2)])
    stops = _apart(list(at))
    sigma = np.sqrt(np.maximum(np.diagonal(found.covariance, axis1=1, axis2=2), 0.0))
    cross = found.covariance[:, 0, 1]
    points = np.column_stack([found.distance, found.place, sigma, cross])
    end = (float(found.place[-1, 0]), float(found.place[-1, 1]), 0.0)
    return Path("odometer", closure, end, _sides(stops), points, float(found.distance[-1]))


def _told(segments: Sequence[MotionSegment], zero: Mapping[str, Any] | None) -> list[ResultWarning]:
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
