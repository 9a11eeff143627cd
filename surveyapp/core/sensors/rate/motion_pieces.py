"""States of motion of a record of any length, piece by piece.

A long record is judged in pieces with an overlap, so that memory does not grow with it. The noise
is estimated anew in each piece, at its own stops; a piece that never rests takes that of the last
one that did. One threshold serves for all, from statistics of the whole record.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from surveyapp.core.sensors.rate.motion_states import (
    Thresholds,
    forward_and_turn,
    segments_of,
    thresholds_of,
)
from surveyapp.core.sensors.rate.rests import Rests, Run
from surveyapp.core.sensors.rate.smooth_motion import moving_smoothly
from surveyapp.core.sensors.rate.still import (
    WINDOW_S,
    Gate,
    RestNoise,
    bias_tolerance,
    bridged,
    motion_gate,
    norm_and_rate,
    rest_noise,
    runs_of,
    statistic,
)
from surveyapp.domain.columns import let_go
from surveyapp.domain.motion import MotionSegment
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.constants import EARTH_RATE

GYROS = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")
ACCELEROMETERS = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
PIECE_ROWS = 200_000
"""Rows judged together: 33 minutes at 100 Hz, some 60 MB."""
OVERLAP_S = 60.0
"""Judged on both sides of a piece and then left to its neighbours: longer than a manoeuvre."""
LEAST_OVERLAP = 1000
SAMPLED = 400_000
"""Statistics from which the threshold is found."""
RESTLESS = 4.0
"""A piece whose quietest parts are so many times noisier than the quietest of all never rests."""


@dataclass(frozen=True, slots=True)
class States:
    """What a record says of its motion.

    Parameters
    ----------
    segments : tuple of MotionSegment
    rests : Rests
    noise : RestNoise
        Of the quietest piece.
    gate : Gate
    limits : Thresholds
        Of the first piece.
    still_share, other_share : float
        At rest by the likelihood ratio, and by norm and rate.
    kappa : float or None
        How far these two agree; None where one of them never changes.
    pieces : int
    """

    segments: tuple[MotionSegment, ...]
    rests: Rests
    noise: RestNoise
    gate: Gate
    limits: Thresholds
    still_share: float
    other_share: float
    kappa: float | None
    pieces: int


@dataclass(frozen=True, slots=True)
class _Piece:
    """Rows first to last of which begin to end count; the rest is overlap."""

    first: int
    last: int
    begin: int
    end: int

    def vectors(self, log: SensorLog, names: Sequence[str]) -> Floats:
        """Columns side by side, shape (k, 3)."""
        return stacked(log, names, slice(self.first, self.last))

    def column(self, log: SensorLog, name: str) -> Floats | None:
        """A column, shape (k,); None where the log has none."""
        values = log.columns.get(name)
        if values is None:
            return None
        found = np.array(values[self.first : self.last])
        let_go(values)
        return found

    @property
    def inner(self) -> slice:
        """Its own rows among those that are judged."""
        return slice(self.begin - self.first, self.end - self.first)


def stacked(log: SensorLog, names: Sequence[str], rows: slice) -> Floats:
    """Rows of columns side by side, (k, 3); a column that lies in a file is let go of."""
    found = np.column_stack([log.columns[c][rows] for c in names])
    for name in names:
        let_go(log.columns[name])
    return found


def _pieces(size: int, overlap: int, rows: int) -> list[_Piece]:
    if size <= rows + overlap:
        return [_Piece(0, size, 0, size)]
    count = -(-size // rows)
    edges = [round(k * size / count) for k in range(count + 1)]
    return [_Piece(max(a - overlap, 0), min(b + overlap, size), a, b) for a, b in pairwise(edges)]


def states_of(
    log: SensorLog, *, false_alarm: float, factor: float = 1.0, rows: int = PIECE_ROWS
) -> States:
    """Judge a record.

    Parameters
    ----------
    log : SensorLog
        With three accelerometers and three gyros.
    false_alarm, factor : float
        Of the gate.
    rows : int
        Of a piece.
    """
    interval = 1.0 / (log.rate_hz or 100.0)
    window = max(round(WINDOW_S / interval), 3)
    overlap = max(round(OVERLAP_S / interval), LEAST_OVERLAP)
    pieces = _pieces(log.size, overlap, rows)
    noises = _noises(log, pieces, 1.0 / interval)
    quietest = min(noises, key=_loudness)
    noises = _carried(noises, _loudness(quietest))
    sample = _sampled(log, pieces, noises, window=window, interval=interval)
    gate = motion_gate(sample, window=window, false_alarm=false_alarm, factor=factor, own_means=6)
    runs: list[Run] = []
    both, other_count = 0, 0
    segments: list[MotionSegment] = []
    limits: Thresholds | None = None
    for piece, noise in zip(pieces, noises, strict=True):
        force, rate = piece.vectors(log, ACCELEROMETERS), piece.vectors(log, GYROS)
        values = _statistic(force, rate, noise, window=window, interval=interval)
        rest = bridged(values <= gate.threshold, rate_hz=1.0 / interval)
        driven = moving_smoothly(
            force,
            rate,
            rest,
            noise=noise,
            interval_s=interval,
            odometer=piece.column(log, "odometer_m"),
        )
        rest = bridged(rest & ~driven, rate_hz=1.0 / interval)
        other = bridged(
            norm_and_rate(force, rate, noise, false_alarm=false_alarm), rate_hz=1.0 / interval
        )
        forward, turn = forward_and_turn(force, rate, rest, noise, interval_s=interval)
        own = thresholds_of(force, rate, rest, interval_s=interval, false_alarm=false_alarm)
        time = piece.column(log, "time_s")
        assert time is not None
        found = segments_of(time, rest, forward, turn, limits=own)
        segments = _joined(segments, found, *_times(log, piece))
        let_go(log.columns["time_s"])
        runs += [(piece.begin + a, piece.begin + b) for a, b in runs_of(rest[piece.inner])]
        both += int(np.count_nonzero(rest[piece.inner] & other[piece.inner]))
        other_count += int(np.count_nonzero(other[piece.inner]))
        limits = own if limits is None else limits
    assert limits is not None
    rests = Rests.joined(runs, log.size)
    count = rests.count
    return States(
        tuple(segments),
        rests,
        quietest,
        gate,
        limits,
        count / log.size,
        other_count / log.size,
        _agreement(log.size, count, other_count, both),
        len(pieces),
    )


def _times(log: SensorLog, piece: _Piece) -> tuple[float, float | None]:
    """When a piece begins, and when the next one does [s]; None after the last."""
    time = log.columns["time_s"]
    return float(time[piece.begin]), None if piece.end == log.size else float(time[piece.end])


def _noises(log: SensorLog, pieces: Sequence[_Piece], rate_hz: float) -> list[RestNoise]:
    return [
        rest_noise(p.vectors(log, ACCELEROMETERS), p.vectors(log, GYROS), rate_hz=rate_hz)
        for p in pieces
    ]


def _loudness(noise: RestNoise) -> float:
    """Geometric mean of the six standard deviations, in mixed units."""
    return float(np.exp(np.mean(np.log(np.concatenate([noise.force, noise.rate])))))


def _carried(noises: Sequence[RestNoise], quietest: float) -> list[RestNoise]:
    """The noise of each piece, or that of the last piece that rested (of the next, at first)."""
    rested = [_loudness(n) <= RESTLESS * quietest for n in noises]
    found: list[RestNoise] = []
    for k, noise in enumerate(noises):
        if rested[k]:
            found.append(noise)
        elif found:
            found.append(found[-1])
        else:
            found.append(noises[rested.index(True)])
    return found


def _statistic(
    force: Floats, rate: Floats, noise: RestNoise, *, window: int, interval: float
) -> Floats:
    """Likelihood ratio of rest, whatever the earth turns in a unit that now points elsewhere."""
    tolerance = bias_tolerance(rate, noise, rate_hz=1.0 / interval, least=2.0 * EARTH_RATE)
    return statistic(force, rate, noise, window=window, tolerance=tolerance)


def _sampled(
    log: SensorLog,
    pieces: Sequence[_Piece],
    noises: Sequence[RestNoise],
    *,
    window: int,
    interval: float,
) -> Floats:
    """Statistics of the record, of a long one a share of them evenly spread."""
    stride = max(-(-log.size // SAMPLED), 1)
    parts = []
    for piece, noise in zip(pieces, noises, strict=True):
        force, rate = piece.vectors(log, ACCELEROMETERS), piece.vectors(log, GYROS)
        values = _statistic(force, rate, noise, window=window, interval=interval)
        parts.append(values[piece.inner][::stride].copy())
    return np.concatenate(parts)


def _joined(
    before: Sequence[MotionSegment],
    found: Sequence[MotionSegment],
    begin_s: float,
    end_s: float | None,
) -> list[MotionSegment]:
    """Segments of a piece, cut to its own time, behind those before it."""
    result = list(before)
    for one in found:
        start = max(one.start_s, begin_s)
        stop = one.end_s if end_s is None else min(one.end_s, end_s)
        if stop <= start:
            continue
        if result and result[-1].state == one.state and start <= result[-1].end_s:
            result[-1] = replace(result[-1], end_s=stop)
        else:
            result.append(replace(one, start_s=start, end_s=stop))
    return result


def _agreement(size: int, one: int, other: int, both: int) -> float | None:
    """Cohen's agreement of two detectors from their counts; None where one never changes."""
    p, q = one / size, other / size
    chance = p * q + (1.0 - p) * (1.0 - q)
    if chance >= 1.0 - 1e-12:
        return None
    same = (size - one - other + 2 * both) / size
    return (same - chance) / (1.0 - chance)
