"""Inertial path with zero-velocity updates, and whether the updates were at rest at all.

Strapdown integration with an error-state filter of position, velocity and attitude. While the gate
says rest, velocity is taken for zero. A gate that is too wide calls slow motion rest; the path may
still close, but the velocity that the filter has to throw away is larger than it can be: the share
of such innovations is the test, not the closure.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, repeat
from typing import Protocol

import numpy as np

from surveyapp.core.sensors.rate.rests import Rests, Run
from surveyapp.core.sensors.rate.strapdown import (
    PLACE,
    TURN,
    VELOCITY,
    Navigation,
    Stretch,
    integrate,
    noise_of_all,
    noise_of_few,
)
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions

FORCE_WALK = 0.001
"""Least velocity error per square root of a second [m/s]; more where the samples are noisier."""
RATE_WALK = math.radians(0.01)
"""Attitude error per square root of a second [rad]."""
REST_SPEED = 0.001
"""Standard deviation of the velocity at rest: what hands and vibration do [m/s]."""
EVERY = 5
"""An update at every fifth sample at rest."""
BOUND = 11.345
"""99 % point of chi-square with three degrees of freedom."""
TOLERATED = 0.01
"""Share of innovations beyond the 99 % bound: the nominal one. By simulation (bench rate_motion):
drives with sensors of four grades have .000 to .002 with a right gate, shaking hard or not, and .04
to .31 with one that calls a twentieth of the motion rest. The measured square: .000; fifty times
too wide .003, a hundred times .016, five hundred times .062."""


MOVING_ROWS = 50_000
"""Samples of motion integrated together."""
RESTING_ROWS = (50, 50, 50, 50, 2000)
"""Samples of rest in which corrections add up before they are taken out: few at first, when they
are largest; then as the last number says."""
POINT_M = 0.05
"""Distance of the points of the path that are kept; doubled whenever there are too many."""
MOST_POINTS = 20_000
PLACE_ROWS = 20_000
"""Samples of a stop from which its place is taken."""


@dataclass(frozen=True, slots=True)
class InertialPath:
    """Path and test.

    Parameters
    ----------
    rows : ndarray of int, shape (m,)
        Samples of the points, every 5 cm of the way.
    along : ndarray, shape (m,)
        How far has been gone there [m].
    place : ndarray, shape (m, 3)
        In a level frame whose y axis is where the body's points at first [m].
    stops : ndarray, shape (k, 3)
        Where each rest was [m].
    end : ndarray, shape (3,)
        [m]
    length : float
        [m]
    covariance : ndarray, shape (3, 3)
        Of the last position [m2].
    exceeding : float or None
        Share of velocity innovations beyond the 99 % bound; None without any.
    updates : int
    """

    rows: np.ndarray
    along: Floats
    place: Floats
    stops: Floats
    end: Floats
    length: float
    covariance: Floats
    exceeding: float | None
    updates: int

    @property
    def consistent(self) -> bool:
        """Whether the updates can have been at rest."""
        return self.exceeding is None or self.exceeding <= TOLERATED


class Samples(Protocol):
    """Rows of a record, some at a time."""

    def __call__(self, first: int, last: int, /) -> tuple[Floats, Floats]:
        """Forces [m/s2] and rates [rad/s] of the rows first to last (exclusive), (k, 3) each."""
        ...


def in_memory(force: Floats, rate: Floats) -> Samples:
    """A record that is held whole, (n, 3) each."""
    return lambda first, last: (force[first:last], rate[first:last])


def inertial_path(samples: Samples, rests: Rests, *, interval_s: float) -> InertialPath:
    """Integrate with zero-velocity updates; bias, gravity and level from the first rest.

    Parameters
    ----------
    samples : callable
        Rows of the record; it is read in pieces, and no more than one is held.
    rests : Rests
        The first of them at the beginning.
    interval_s : float
    """
    unit = _unit_of(samples, rests, interval_s)
    now = Navigation(
        unit.level,
        np.zeros(3),
        np.zeros(3),
        np.diag([1e-8] * 3 + [1e-6] * 3 + [1e-5, 1e-5, 1e-8]),
    )
    ends = {last for _, last in rests.runs}
    way, beyond, updates = _Way(), 0, 0
    for first, last, resting in _stretches(rests):
        force, rate = samples(first, last)
        stretch = integrate(
            now, force, rate - unit.bias, gravity=unit.gravity, interval_s=interval_s
        )
        if resting:
            numbers = np.arange(first, last)
            place, more, out = _rested(now, stretch, numbers, unit)
            updates, beyond = updates + more, beyond + out
        else:
            place = _moved(now, stretch, unit)
        way.add(place, first, resting=resting, ends=last in ends)
    share = beyond / updates if updates else None
    return way.path(now.covariance[:3, :3].copy(), share, updates)


@dataclass(frozen=True, slots=True)
class _Unit:
    """What the first rest tells: attitude, bias [rad/s], gravity [m/s2]; and the noise.

    The noise is what a sample adds to the variance of velocity and attitude, at rest and moving.
    """

    level: Floats
    bias: Floats
    gravity: float
    at_rest: tuple[float, float]
    moving: tuple[float, float]


def _unit_of(samples: Samples, rests: Rests, interval_s: float) -> _Unit:
    first, last = rests.runs[0] if rests.runs else (0, 1)
    force, rate = samples(first, min(last, first + MOVING_ROWS))
    felt = force.mean(axis=0)
    of_force, of_rate = _white_while(samples, rests.moving)
    at_rest, turning = _white(force), _white(rate)
    return _Unit(
        _levelled(felt),
        rate.mean(axis=0),
        float(np.linalg.norm(felt)),
        _noise(at_rest, turning, interval_s),
        _noise(max(of_force, at_rest), max(of_rate, turning), interval_s),
    )


def _stretches(rests: Rests) -> Iterator[tuple[int, int, bool]]:
    """Rows first to last (exclusive) that are all at rest or all moving, none too long."""
    bounds = [(*run, True) for run in rests.runs] + [(*run, False) for run in rests.moving]
    for first, last, resting in sorted(bounds):
        sizes = chain(RESTING_ROWS, repeat(RESTING_ROWS[-1])) if resting else repeat(MOVING_ROWS)
        for size in sizes:
            stop = min(first + size, last)
            yield first, stop, resting
            first = stop
            if first >= last:
                break


def _moved(now: Navigation, stretch: Stretch, unit: _Unit) -> Floats:
    """Go through a stretch of motion; places (n, 3)."""
    count = stretch.place.shape[0]
    step = stretch.transitions(np.array([0]), np.array([count]))[0]
    velocity, turn = unit.moving
    noise = noise_of_all(stretch, velocity=velocity, turn=turn)
    now.covariance = step @ now.covariance @ step.T + noise
    now.attitude, now.velocity, now.place = (
        stretch.attitude,
        stretch.velocity[-1],
        stretch.place[-1],
    )
    return stretch.place


def _rested(
    now: Navigation, stretch: Stretch, numbers: np.ndarray, unit: _Unit
) -> tuple[Floats, int, int]:
    """Go through a stretch of rest: places (n, 3), updates, and how many lie beyond the bound."""
    count = numbers.size
    due = np.flatnonzero(numbers % EVERY == 0) + 1
    ends = due if due.size and due[-1] == count else np.append(due, count)
    begins = np.append(0, ends[:-1])
    steps = stretch.transitions(begins, ends)
    force = stretch.sums[-1] / (count * stretch.interval_s)
    velocity, turn = unit.at_rest
    noises = noise_of_few(
        ends - begins, force, interval_s=stretch.interval_s, velocity=velocity, turn=turn
    )
    covariance, error, beyond = now.covariance, np.zeros(9), 0
    errors = np.empty((ends.size, 9))
    for k, end in enumerate(ends.tolist()):
        errors[k] = error
        step = steps[k]
        error = step @ error
        covariance = step @ covariance @ step.T + noises[k]
        if k < due.size:
            seen = stretch.velocity[end - 1] + error[VELOCITY]
            gain, size = _gain(covariance, seen)
            beyond += size > BOUND
            error = error - gain @ seen
            covariance = covariance - gain @ covariance[VELOCITY]
            covariance = 0.5 * (covariance + covariance.T)
    place = _corrected(stretch, begins, ends, errors)
    if due.size and due[-1] == count:
        place[-1] = stretch.place[-1] + error[PLACE]
    now.attitude, now.velocity, now.place = (
        stretch.attitude,
        stretch.velocity[-1],
        stretch.place[-1],
    )
    now.correct(error)
    now.covariance = covariance
    return place, due.size, beyond


def _corrected(stretch: Stretch, begins: np.ndarray, ends: np.ndarray, errors: Floats) -> Floats:
    """Places of each sample with the error at the begin of its group carried to it, (n, 3)."""
    group = np.repeat(np.arange(begins.size), ends - begins)
    after = np.arange(1, group.size + 1)
    _, lever = stretch.levers(begins[group], after)
    time = (after - begins[group])[:, None] * stretch.interval_s
    known = errors[group]
    turned = np.cross(lever, known[:, TURN])
    found = stretch.place + known[:, PLACE] + time * known[:, VELOCITY] - turned
    # at the end of a group its own update has already moved the place
    last = ends[:-1] - 1
    found[last] = stretch.place[last] + errors[1:, PLACE]
    return np.asarray(found)


class _Way:
    """What is kept of the places while they pass by."""

    def __init__(self) -> None:
        self.rows: list[int] = []
        self.along: list[float] = []
        self.places: list[Floats] = []
        self.stops: list[Floats] = []
        self._here: list[Floats] = []
        self._gone, self._last = 0.0, np.zeros(3)
        self._next, self._spacing = 0, POINT_M

    def add(self, place: Floats, first: int, *, resting: bool, ends: bool) -> None:
        """Places of the rows from ``first`` on, all at rest or all moving; ``ends`` the rest."""
        before = np.vstack([self._last if first else place[0], place])
        along = self._gone + np.cumsum(np.linalg.norm(np.diff(before[:, :2], axis=0), axis=1))
        count = math.floor(along[-1] / self._spacing) + 1
        grid = np.arange(self._next, count)
        self._next = max(self._next, count)
        rows = np.unique(np.searchsorted(along, grid * self._spacing))
        self.rows += (first + rows).tolist()
        self.along += along[rows].tolist()
        self.places += list(place[rows])
        if len(self.rows) > MOST_POINTS:
            for kept in (self.rows, self.along, self.places):
                del kept[1::2]
            self._spacing *= 2.0
            self._next = math.floor(along[-1] / self._spacing) + 1
        self._gone, self._last = float(along[-1]), place[-1]
        if resting:
            taken = sum(part.shape[0] for part in self._here)
            if taken < PLACE_ROWS:
                self._here.append(place[: PLACE_ROWS - taken])
            if ends:
                self.stops.append(np.median(np.concatenate(self._here), axis=0))
                self._here = []

    def path(self, covariance: Floats, share: float | None, updates: int) -> InertialPath:
        """The path so far."""
        return InertialPath(
            np.array(self.rows),
            np.array(self.along),
            np.array(self.places),
            np.array(self.stops).reshape(-1, 3),
            self._last,
            self._gone,
            covariance,
            share,
            updates,
        )


def _noise(force: float, rate: float, interval_s: float) -> tuple[float, float]:
    """Variance that a sample adds to velocity [m2/s2] and attitude [rad2]: its white noise.

    While a unit moves it shakes, and what the samples miss of that is an error of the velocity and
    of the attitude.
    """
    walks = (
        max(FORCE_WALK, force * math.sqrt(interval_s)),
        max(RATE_WALK, rate * math.sqrt(interval_s)),
    )
    return walks[0] ** 2 * interval_s, walks[1] ** 2 * interval_s


def _white(values: Floats) -> float:
    """Standard deviation of a sample at rest, the largest of three axes, drifts left out."""
    if values.shape[0] < 3:
        return 0.0
    return float(np.std(np.diff(values, axis=0), axis=0).max() / math.sqrt(2.0))


def _white_while(samples: Samples, moving: Sequence[Run]) -> tuple[float, float]:
    """The same of forces and rates of these rows, piece by piece."""
    count, total, squares = 0, np.zeros(6), np.zeros(6)
    for first, last in moving:
        for begin in range(first, last, MOVING_ROWS):
            piece = np.hstack(samples(begin, min(begin + MOVING_ROWS, last)))
            steps = np.diff(piece, axis=0)
            count += steps.shape[0]
            total, squares = total + steps.sum(axis=0), squares + (steps**2).sum(axis=0)
    if count < 2:
        return 0.0, 0.0
    spread = np.sqrt((squares / count - (total / count) ** 2) / 2.0)
    return float(spread[:3].max()), float(spread[3:].max())


def _levelled(felt: Floats) -> Floats:
    """Attitude that brings the felt force upright, azimuth of the body's y axis zero."""
    up = felt / np.linalg.norm(felt)
    ahead = np.array([0.0, 1.0, 0.0])
    if abs(float(up[1])) > 0.99:
        ahead = np.array([0.0, 0.0, 1.0])
    ahead = ahead - up * float(up @ ahead)
    ahead /= np.linalg.norm(ahead)
    return quaternions.from_matrix(np.vstack([np.cross(ahead, up), ahead, up]))


def _gain(covariance: Floats, velocity: Floats) -> tuple[Floats, float]:
    """Gain of a zero-velocity update, and the innovation squared in its own covariance."""
    spread = covariance[3:6, 3:6] + np.eye(3) * REST_SPEED**2
    inverse = np.linalg.inv(spread)
    return covariance[:, 3:6] @ inverse, float(velocity @ inverse @ velocity)
