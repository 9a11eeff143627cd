"""Strapdown integration with its covariance, many samples at a time.

Within a stretch the attitude is a chain of quaternions and velocity and place are running sums. An
error of the attitude reaches them through the sum of the forces and the sum of these sums, so that
the transition over any number of samples is known in closed form, and the noise of all samples
between is a sum of such terms. The answers are those of one sample after the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions

PLACE, VELOCITY, TURN = slice(0, 3), slice(3, 6), slice(6, 9)


@dataclass(slots=True)
class Navigation:
    """Where a unit is, how fast it goes and how it is turned; changed by every stretch.

    Parameters
    ----------
    attitude : ndarray, shape (4,)
        Body to a level frame.
    velocity, place : ndarray, shape (3,)
        [m/s], [m]
    covariance : ndarray, shape (9, 9)
        Of errors of place, velocity and attitude.
    """

    attitude: Floats
    velocity: Floats
    place: Floats
    covariance: Floats

    def correct(self, error: Floats) -> None:
        """Take an error (9,) of place, velocity and attitude out."""
        self.place = self.place + error[PLACE]
        self.velocity = self.velocity + error[VELOCITY]
        turn = quaternions.from_rotation_vector(error[TURN])
        q = quaternions.multiply(turn, self.attitude)
        self.attitude = q / np.sqrt(float(q @ q))


@dataclass(frozen=True, slots=True)
class Stretch:
    """Samples integrated from one state without a correction.

    Parameters
    ----------
    attitude : ndarray, shape (4,)
        After the last sample.
    velocity, place : ndarray, shape (n, 3)
        After each sample.
    sums, double_sums : ndarray, shape (n + 1, 3)
        Of the forces in the level frame times the interval, before the first sample and after
        each [m/s]; and of these sums before each sample times the interval [m].
    interval_s : float
    """

    attitude: Floats
    velocity: Floats
    place: Floats
    sums: Floats
    double_sums: Floats
    interval_s: float

    def levers(self, first: np.ndarray, last: np.ndarray) -> tuple[Floats, Floats]:
        """What an attitude error after ``first`` samples does until after ``last``.

        Returns
        -------
        of_velocity, of_place : ndarray, shape (k, 3)
            The error crossed with these.
        """
        of_velocity = self.sums[last] - self.sums[first]
        time = (last - first)[:, None] * self.interval_s
        of_place = self.double_sums[last] - self.double_sums[first] - time * self.sums[first]
        return of_velocity, of_place

    def transitions(self, first: np.ndarray, last: np.ndarray) -> Floats:
        """Transition of the nine errors from after ``first`` to after ``last``, (k, 9, 9)."""
        of_velocity, of_place = self.levers(first, last)
        found = np.tile(np.eye(9), (first.size, 1, 1))
        for i in range(3):
            found[:, i, 3 + i] = (last - first) * self.interval_s
        found[:, VELOCITY, TURN] = -skew(of_velocity)
        found[:, PLACE, TURN] = -skew(of_place)
        return found


def integrate(
    start: Navigation, force: Floats, rate: Floats, *, gravity: float, interval_s: float
) -> Stretch:
    """Integrate samples, corrected for the bias, from a state.

    Parameters
    ----------
    start : Navigation
    force, rate : ndarray, shape (n, 3)
        [m/s2], [rad/s]
    gravity : float
        [m/s2]
    interval_s : float
    """
    q = quaternions.integrate(rate, interval_s=interval_s, start=start.attitude)
    level = quaternions.rotate(q[1:], force) * interval_s
    sums = np.vstack([np.zeros(3), np.cumsum(level, axis=0)])
    double = np.vstack([np.zeros(3), np.cumsum(sums[:-1], axis=0) * interval_s])
    change = level - np.array([0.0, 0.0, gravity * interval_s])
    velocity = start.velocity + np.cumsum(change, axis=0)
    before = velocity - 0.5 * change
    place = start.place + np.cumsum(before, axis=0) * interval_s
    return Stretch(q[-1], velocity, place, sums, double, interval_s)


def noise_of_all(stretch: Stretch, *, velocity: float, turn: float) -> Floats:
    """Covariance from white noise of every sample of a stretch, shape (9, 9).

    ``velocity``, ``turn``: variance that a sample adds [m2/s2], [rad2].
    """
    count = stretch.place.shape[0]
    after = np.arange(1, count + 1)
    b, a = stretch.levers(after, np.full(count, count))
    time = (count - after) * stretch.interval_s
    eye, found = np.eye(3), np.zeros((9, 9))
    found[PLACE, PLACE] = velocity * float(time @ time) * eye + turn * _crossed(a, a)
    found[PLACE, VELOCITY] = velocity * float(time.sum()) * eye + turn * _crossed(a, b)
    found[VELOCITY, VELOCITY] = velocity * count * eye + turn * _crossed(b, b)
    found[PLACE, TURN] = -turn * skew(a.sum(axis=0))
    found[VELOCITY, TURN] = -turn * skew(b.sum(axis=0))
    found[TURN, TURN] = turn * count * eye
    for low, high in ((PLACE, VELOCITY), (PLACE, TURN), (VELOCITY, TURN)):
        found[high, low] = found[low, high].T
    return found


def _crossed(a: Floats, b: Floats) -> Floats:
    """Sum of [a] [b]' over the rows, [a] the matrix of the cross product, shape (3, 3)."""
    return np.asarray(float(np.sum(a * b)) * np.eye(3) - b.T @ a)


def noise_of_few(
    counts: np.ndarray, force: Floats, *, interval_s: float, velocity: float, turn: float
) -> Floats:
    """The same for groups of a few samples under a constant force, shape (k, 9, 9).

    Parameters
    ----------
    counts : ndarray of int, shape (k,)
        Samples of each group.
    force : ndarray, shape (3,)
        In the level frame [m/s2].
    interval_s : float
    velocity, turn : float
        Variance that a sample adds [m2/s2], [rad2].
    """
    kinds, index = np.unique(counts, return_inverse=True)
    found = np.empty((kinds.size, 9, 9))
    for k, count in enumerate(kinds.tolist()):
        sums = np.arange(count + 1)[:, None] * force * interval_s
        double = np.vstack([np.zeros(3), np.cumsum(sums[:-1], axis=0) * interval_s])
        still = np.zeros((count, 3))
        few = Stretch(np.zeros(4), still, still, sums, double, interval_s)
        found[k] = noise_of_all(few, velocity=velocity, turn=turn)
    return found[index]


def skew(vectors: Floats) -> Floats:
    """Matrices of the cross product, shape (..., 3, 3)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
