"""Motion without shaking: what the likelihood ratio of rest takes for rest.

That statistic removes the mean of its window, so that a constant acceleration, and a smooth drive
at constant speed, look like rest. Two things tell them: an odometer that moves, and, where there is
none, the mean force against that of the rest before, carried by the gyro. Rest returns only when
the speed that the force has built up is gone.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.still import Mask, RestNoise, runs_of
from surveyapp_models.arrays import Floats

CREEP_M_S: Final = 0.02
"""Speed of an odometer from which a vehicle is on its way."""
HALF_S: Final = 0.5
"""Before and behind a row in which the odometer must move; and length of a part of a rest."""
PUSH_M_S2: Final = 0.08
"""Least change of the mean force that is acceleration: bias and suspension change it by less."""
SIGMAS: Final = 4.0
SLOW_M_S, SLOW_SHARE = 0.05, 0.10
"""Speed that counts as gone: this, and this share of the largest since the rest before."""
LONGEST_JERK_S: Final = 2.0
MOST_TURNED: Final = math.radians(5.0)
"""Between two parts: beyond, the force cannot be carried and the next part is taken as it is."""
FASTEST_M_S: Final = 20.0
"""No mining vehicle: the force has changed for another reason, and nothing was driven."""
REST_PARTS: Final = 8
"""Parts of a rest whose mean force is that of the rest."""


@dataclass(slots=True)
class _Carried:
    """Force of the rest before, turned with the body, and the speed built up since."""

    base: Floats
    speed: Floats
    peak: float = 0.0
    recent: int = 0


def moving_smoothly(
    force: Floats,
    rate: Floats,
    rest: Mask,
    *,
    noise: RestNoise,
    interval_s: float,
    odometer: Floats | None = None,
) -> Mask:
    """Rows of ``rest`` in which the unit moves all the same, shape (n,).

    Parameters
    ----------
    force, rate : ndarray, shape (n, 3)
        [m/s2], [rad/s]
    rest : ndarray of bool, shape (n,)
    noise : RestNoise
    interval_s : float
    odometer : ndarray, shape (n,), optional
        [m]; where it is there it alone decides.
    """
    if odometer is not None and np.all(np.isfinite(odometer)):
        return rest & _rolling(odometer, interval_s)
    parts = _parts_of(rest, max(round(HALF_S / interval_s), 3))
    if not parts:
        return np.zeros(rest.size, dtype=bool)
    turned = np.concatenate([np.zeros((1, 3)), np.cumsum((rate - noise.bias) * interval_s, axis=0)])
    pushed = np.concatenate([np.zeros((1, 3)), np.cumsum(force * interval_s, axis=0)])
    runs = runs_of(rest)
    first, last = max(runs, key=lambda run: run[1] - run[0])
    anchor = next(k for k, part in enumerate(parts) if first <= part[0] < last)
    sigma = SIGMAS * float(np.max(noise.force))
    record = _Record(turned, pushed, interval_s, sigma)
    moving = np.zeros(rest.size, dtype=bool)
    for order in (parts[anchor:], parts[: anchor + 1][::-1]):
        for begin, end in _driven(order, record):
            moving[begin:end] = True
    return rest & moving


def _rolling(odometer: Floats, interval_s: float) -> Mask:
    """Rows before and behind which the odometer moves."""
    half = max(round(HALF_S / interval_s), 1)
    steps = np.abs(np.diff(odometer))
    least = float(np.min(steps[steps > 0.0], initial=math.inf))
    limit = max(CREEP_M_S * half * interval_s, 1.5 * least if math.isfinite(least) else 0.0)
    padded = np.concatenate([np.full(half, odometer[0]), odometer, np.full(half, odometer[-1])])
    back = np.abs(odometer - padded[: odometer.size])
    ahead = np.abs(padded[2 * half :] - odometer)
    return np.asarray(np.minimum(back, ahead) > limit)


def _parts_of(rest: Mask, size: int) -> list[tuple[int, int]]:
    """Rests cut into parts of about a size; what is left joins the last part of its rest."""
    found = []
    for first, last in runs_of(rest):
        count = max((last - first) // size, 1)
        edges = [first + k * size for k in range(count)] + [last]
        found += list(itertools.pairwise(edges))
    return found


@dataclass(frozen=True, slots=True)
class _Record:
    """Running sums of rate [rad] and force [m/s], and what a part's mean force may differ by."""

    turned: Floats
    pushed: Floats
    interval_s: float
    sigma: float

    def mean(self, part: tuple[int, int]) -> Floats:
        """Mean force of a part [m/s2]."""
        begin, end = part
        return np.asarray(
            (self.pushed[end] - self.pushed[begin]) / ((end - begin) * self.interval_s)
        )

    def middle(self, part: tuple[int, int]) -> Floats:
        """Turned up to the middle of a part [rad]."""
        return np.asarray(0.5 * (self.turned[part[0]] + self.turned[part[1]]))


def _driven(parts: list[tuple[int, int]], record: _Record) -> list[tuple[int, int]]:
    """Parts that are driven, from a rest on, forwards or backwards in time."""
    found: list[tuple[int, int]] = []
    pending: list[tuple[int, int]] = []
    state = _Carried(record.mean(parts[0]), np.zeros(3))
    before = parts[0]
    for part in parts[1:]:
        low, high = (before[1], part[0]) if part[0] >= before[1] else (part[1], before[0])
        angle = record.middle(part) - record.middle(before)
        mean = record.mean(part)
        before = part
        if _lost(record, low, high):
            found, pending = found + pending, []
            state = _Carried(mean, np.zeros(3))
            continue
        state.base = state.base - np.cross(angle, state.base)
        span = (high - low) * record.interval_s
        state.speed = state.speed + record.pushed[high] - record.pushed[low] - state.base * span
        push = mean - state.base
        limit = PUSH_M_S2 + record.sigma / math.sqrt(part[1] - part[0])
        accelerated = float(np.linalg.norm(push)) > limit
        if accelerated:
            state.speed = state.speed + push * ((part[1] - part[0]) * record.interval_s)
        size = float(np.linalg.norm(state.speed))
        state.peak = max(state.peak, size)
        if size > FASTEST_M_S:
            pending, state = [], _Carried(mean, np.zeros(3))
        elif accelerated or size > SLOW_M_S + SLOW_SHARE * state.peak:
            pending.append(part)
        else:
            found, pending = found + pending, []
            weight = 1.0 / min(state.recent + 2, REST_PARTS)
            base = state.base + weight * push
            state = _Carried(base, np.zeros(3), recent=state.recent + 1)
    return found + pending


def _lost(record: _Record, low: int, high: int) -> bool:
    """Whether the force cannot be carried over what lies between: too long, or turned too far."""
    if (high - low) * record.interval_s > LONGEST_JERK_S:
        return True
    path = np.diff(record.turned[low : high + 1], axis=0)
    return float(np.linalg.norm(path, axis=1).sum()) > MOST_TURNED
