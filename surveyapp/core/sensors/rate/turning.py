"""Steady turning cut out of a raw table log: which rows, how many turns, and their mean.

A log runs through pauses, run-ups and steady turning. What is used is the steady part, cut to
whole turns, so that the level part of the earth rate cancels. Nothing here knows what is being
calibrated.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from surveyapp_models.angles import wrap_pi_array
from surveyapp_models.arrays import Floats

TWO_PI = 2.0 * math.pi
STILL_SHARE = 0.005
"""Of the largest rate of the log: slower is a pause."""
PLATEAU = 0.005
"""Relative departure from the median within which a rate is steady."""
LEAST_SAMPLES = 8
"""A shorter stretch is a run-up, not steady turning."""
RUN_UP_SIGMAS = 8.0
"""Samples at either end that lie farther from the fit are the table still running up: among
1e5 samples of normal noise none does."""
FAR_STEP = 0.5 * math.pi
"""A table that should go so far between two samples may not have gone the shorter way round; a
longer gap in the log also ends a stretch."""
TURN_SLACK = 2e-3
"""Part of a turn that a nominal rate may lack of a whole one."""


@dataclass(frozen=True, slots=True)
class Steady:
    """One stretch of steady turning.

    Parameters
    ----------
    start, stop : int
        Rows, stop exclusive.
    rate : float
        Of the table, clockwise from above [rad/s].
    angles : ndarray, shape (stop - start,)
        Of the table, not wrapped [rad].
    """

    start: int
    stop: int
    rate: float
    angles: Floats

    @property
    def step(self) -> float:
        """Angle from one sample to the next [rad]."""
        count = self.angles.size
        return abs(float(self.angles[-1] - self.angles[0])) / max(count - 1, 1)

    @property
    def turns(self) -> float:
        """Turns recorded."""
        return self.step * self.angles.size / TWO_PI

    def cut(self, first: int, last: int) -> Steady:
        """The rows ``first`` to ``last`` (exclusive) of this stretch."""
        return Steady(self.start + first, self.start + last, self.rate, self.angles[first:last])

    def whole_turns(self) -> Steady | None:
        """The beginning of the stretch that is whole turns by its angles; None below one."""
        turns = math.floor(self.turns + TURN_SLACK)
        if turns < 1:
            return None
        gone = np.maximum.accumulate(np.abs(self.angles - self.angles[0]))
        step = float(np.median(np.abs(np.diff(self.angles))))
        return self.cut(0, int(np.searchsorted(gone, turns * TWO_PI - 0.5 * step)))


@dataclass(frozen=True, slots=True)
class TableMotion:
    """What a log says of its table.

    Parameters
    ----------
    rates : ndarray, shape (n,)
        Clockwise from above [rad/s].
    angles : ndarray, shape (n,)
        Not wrapped [rad].
    encoder : bool
        Whether the angles were recorded; else they are the rates summed up.
    reversed_sense : bool
        Whether the nominal rates had the opposite sign of the recorded angles and were turned.
    nominal : bool
        Whether the rates were stated; else they are the slope of the angles.
    """

    rates: Floats
    angles: Floats
    encoder: bool
    reversed_sense: bool = False
    nominal: bool = True


def table_motion(
    time_s: Floats, *, rate_deg_s: Floats | None, angle_deg: Floats | None
) -> TableMotion:
    """Rates and angles of a table from whichever of the two the log has.

    Parameters
    ----------
    time_s : ndarray, shape (n,)
    rate_deg_s, angle_deg : ndarray, shape (n,), or None
        At least one.

    Returns
    -------
    TableMotion
    """
    gaps = np.diff(time_s)
    if angle_deg is None:
        rates = np.deg2rad(np.asarray(rate_deg_s))
        middle = np.concatenate([[0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]) * gaps)])
        return TableMotion(rates, middle, encoder=False)
    angles = _unwrapped(np.deg2rad(angle_deg), time_s, rate_deg_s)
    measured = np.gradient(angles, time_s) if angles.size > 1 else np.zeros(angles.size)
    if rate_deg_s is None:
        return TableMotion(_calmed(measured), angles, encoder=True, nominal=False)
    rates = np.deg2rad(rate_deg_s)
    agrees = float(np.sum(rates * measured)) >= 0.0
    unsigned = bool(np.all(rates >= 0.0) and measured.min() < -0.5 * float(rates.max(initial=0.0)))
    if unsigned:
        return TableMotion(np.copysign(rates, measured), angles, encoder=True)
    return TableMotion(rates if agrees else -rates, angles, encoder=True, reversed_sense=not agrees)


def _unwrapped(angles: Floats, time_s: Floats, rate_deg_s: Floats | None) -> Floats:
    """Angles of an encoder that go on beyond a turn.

    From one sample to the next a table goes the shorter way round, unless its nominal rate says
    that it went farther: through a gap of the log, or because it was sampled slowly. Then it went
    on in the sense in which the encoder saw it go before.
    """
    if rate_deg_s is None or angles.size < 2:
        return np.asarray(np.unwrap(angles))
    rates = np.deg2rad(rate_deg_s)
    expected = 0.5 * (rates[1:] + rates[:-1]) * np.diff(time_s)
    steps = wrap_pi_array(np.diff(angles))
    far = np.abs(expected) > FAR_STEP
    if np.any(far):
        seen = np.where(~far & (expected != 0.0), np.sign(steps), 0.0)
        last = np.maximum.accumulate(np.where(seen != 0.0, np.arange(steps.size), -1))
        sense = np.where(last >= 0, seen[last], np.sign(expected))
        gone = sense * np.abs(expected)
        steps = np.where(far, gone + wrap_pi_array(steps - gone), steps)
    return np.concatenate([angles[:1], angles[0] + np.cumsum(steps)])


def _calmed(values: Floats, width: int = 9) -> Floats:
    """Running median: an encoder's last digit must not cut a stretch in pieces."""
    if values.size < width:
        return values
    padded = np.pad(values, width // 2, mode="edge")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(padded, width), axis=1))


def steady_stretches(motion: TableMotion, *, breaks: Floats | None = None) -> list[Steady]:
    """Every stretch of steady turning, in the order of the log.

    Parameters
    ----------
    motion : TableMotion
    breaks : ndarray of bool, shape (n,), optional
        True at rows with which something new begins (a position, a set).

    Returns
    -------
    list of Steady
    """
    rates = motion.rates
    largest = float(np.abs(rates).max(initial=0.0))
    if largest == 0.0:
        return []
    turning = np.where(np.abs(rates) > STILL_SHARE * largest, np.sign(rates), 0.0)
    change = np.concatenate([[True], np.diff(turning) != 0.0])
    gone = np.abs(np.diff(motion.angles))
    usual = np.median(gone[turning[1:] != 0.0]) if np.any(turning[1:] != 0.0) else 0.0
    change[1:] |= gone > FAR_STEP + 2.0 * usual
    jump = np.abs(np.diff(rates)) > 0.5 * np.maximum(np.abs(rates[1:]), np.abs(rates[:-1]))
    change[1:] |= jump
    if breaks is not None:
        change |= breaks.astype(bool)
    edges = np.append(np.flatnonzero(change), rates.size)
    found = []
    for first, last in pairwise(edges.tolist()):
        if turning[first] == 0.0 or last - first < LEAST_SAMPLES:
            continue
        part = rates[first:last]
        calm = np.flatnonzero(np.abs(part - np.median(part)) <= PLATEAU * abs(np.median(part)))
        if calm.size == 0:  # nothing but a run-up between two breaks
            continue
        lo, hi = int(first + calm[0]), int(first + calm[-1] + 1)
        if hi - lo >= LEAST_SAMPLES:
            found.append(Steady(lo, hi, float(np.mean(rates[lo:hi])), motion.angles[lo:hi]))
    return [_with_encoder(s, motion) for s in found]


def _with_encoder(stretch: Steady, motion: TableMotion) -> Steady:
    """Take a nominal angle where the encoder stands still although the table is said to turn."""
    if motion.encoder and stretch.step > 0.0:
        return stretch
    count = np.arange(stretch.stop - stretch.start, dtype=np.float64)
    if stretch.step > 0.0:
        return stretch
    return Steady(stretch.start, stretch.stop, stretch.rate, stretch.rate * count)


@dataclass(frozen=True, slots=True)
class TurnMean:
    """Mean output over whole turns.

    Parameters
    ----------
    mean : float
        [unit of the values]
    noise : float
        Standard deviation of one sample about mean and earth rate.
    sigma : float
        Of the mean.
    dof : int
        Behind the noise.
    count : int
        Samples.
    turns : float
        Turns used.
    """

    mean: float
    noise: float
    sigma: float
    dof: int
    count: int
    turns: float


def settled(stretch: Steady, values: Floats) -> Steady:
    """The stretch without the samples at its ends at which the table was still running up.

    Parameters
    ----------
    stretch : Steady
    values : ndarray, shape (n,)
        The whole column.
    """
    part = values[stretch.start : stretch.stop]
    count = part.size
    if count < 4 * LEAST_SAMPLES:
        return stretch
    inner = slice(count // 10, count - count // 10)
    design = _design(stretch.angles)
    solution, *_ = np.linalg.lstsq(design[inner], part[inner], rcond=None)
    rest = part - design @ solution
    spread = 1.4826 * float(np.median(np.abs(rest[inner] - np.median(rest[inner]))))
    limit = RUN_UP_SIGMAS * spread + 1e-12 * float(np.abs(part).max())
    edge = np.flatnonzero(np.abs(rest) <= limit)
    outside_first, outside_last = int(edge[0]), int(edge[-1] + 1)
    return stretch.cut(outside_first, outside_last)


def _design(angles: Floats) -> Floats:
    return np.column_stack([np.ones(angles.size), np.cos(angles), np.sin(angles)])


def about_turns(stretch: Steady, values: Floats) -> Floats:
    """Samples of a stretch about their mean and the earth rate that turns by, shape (n,)."""
    part = values[stretch.start : stretch.stop]
    design = _design(stretch.angles)
    solution, *_ = np.linalg.lstsq(design, part, rcond=None)
    return np.asarray(part - design @ solution)


def round_the_turn(stretch: Steady, values: Floats) -> Floats:
    """Cosine and sine of the table's angle in the samples of a stretch, shape (2,)."""
    part = values[stretch.start : stretch.stop]
    return np.asarray(np.linalg.lstsq(_design(stretch.angles), part, rcond=None)[0][1:])


def mean_over_turns(stretch: Steady, values: Floats) -> TurnMean:
    """Mean of whole turns, the turning earth rate fitted beside it.

    Over whole turns the cosine and the sine are perpendicular to the mean, so that fitting them
    changes nothing but the noise that is judged from the residuals.

    Parameters
    ----------
    stretch : Steady
        Whole turns.
    values : ndarray, shape (n,)
        The whole column.
    """
    part = values[stretch.start : stretch.stop]
    design = _design(stretch.angles)
    q, r = np.linalg.qr(design)
    solution = np.linalg.solve(r, q.T @ part)
    rest = part - design @ solution
    dof = max(part.size - 3, 1)
    noise = math.sqrt(float(rest @ rest) / dof)
    spread = float(np.linalg.norm(np.linalg.solve(r, np.eye(3))[0]))  # 1/sqrt(n) without a gap
    return TurnMean(float(solution[0]), noise, noise * spread, dof, part.size, stretch.turns)


def mean_over_arc(stretch: Steady, values: Floats) -> TurnMean:
    """Plain mean over less than a turn: only the difference of the two ways is of use.

    Its noise is judged about the earth rate that turns by, as over whole turns.
    """
    part = values[stretch.start : stretch.stop]
    design = _design(stretch.angles)
    solution, *_ = np.linalg.lstsq(design, part, rcond=None)
    rest = part - design @ solution
    dof = max(part.size - 3, 1)
    noise = math.sqrt(float(rest @ rest) / dof)
    return TurnMean(
        float(part.mean()), noise, noise / math.sqrt(part.size), dof, part.size, stretch.turns
    )


def common_arc(one: Steady, other: Steady) -> tuple[Steady, Steady] | None:
    """The rows of two stretches that pass the same arc in opposite senses; None if there is none.

    Whole turns between them do not matter.

    Parameters
    ----------
    one, other : Steady
        Of opposite sense.
    """
    if one.rate * other.rate >= 0.0:
        return None
    middles = [0.5 * float(s.angles.min() + s.angles.max()) for s in (one, other)]
    turns = TWO_PI * round((middles[0] - middles[1]) / TWO_PI)
    other = replace(other, angles=other.angles + turns)
    low = max(float(one.angles.min()), float(other.angles.min()))
    high = min(float(one.angles.max()), float(other.angles.max()))
    length = min(abs(float(s.angles[-1] - s.angles[0])) for s in (one, other))
    if not high > low or high - low < 0.9 * length:
        return None
    slack = 0.5 * max(one.step, other.step)
    cuts = []
    for stretch in (one, other):
        inside = np.flatnonzero((stretch.angles >= low - slack) & (stretch.angles <= high + slack))
        cuts.append(stretch.cut(int(inside[0]), int(inside[-1] + 1)))
    return cuts[0], cuts[1]
