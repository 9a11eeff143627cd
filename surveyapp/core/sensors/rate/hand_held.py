"""Calibration from hand-held stops: accelerometers by the size of gravity, gyros by its direction.

At each stop the accelerometers must show one gravity whatever the attitude; from stop to stop the
gyros must carry its direction to where the accelerometers find it. Source: Tedaldi, Pretto and
Menegatti 2014. The accelerometer triad is the frame: its x axis is the body's, y lies in the xy
plane of the body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.sensors.rate.needed import (
    CROSS_TOLERANCE,
    SCALE_TOLERANCE,
    covariance_of,
)
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions


@dataclass(frozen=True, slots=True)
class HeldStop:
    """Mean outputs of one stop.

    Parameters
    ----------
    start, stop : int
        Rows, stop exclusive.
    force, rate : ndarray, shape (3,)
        [m/s2], [rad/s]
    time_s : float
        Of its middle.
    """

    start: int
    stop: int
    force: Floats
    rate: Floats
    time_s: float


@dataclass(frozen=True, slots=True)
class Turn:
    """A turn from one stop to the next.

    Parameters
    ----------
    rates : ndarray, shape (k, 3)
        Outputs less the bias [rad/s].
    before, after : ndarray, shape (3,)
        Directions of up in the body at the two stops.
    interval_s : float
    leaves : int
        Number of the stop before it, from 0.
    """

    rates: Floats
    before: Floats
    after: Floats
    interval_s: float
    leaves: int = 0

    def attitude(self, inverse: Floats) -> Floats:
        """Rotation by gyros whose true rate is ``inverse`` output, shape (4,)."""
        return np.asarray(
            quaternions.integrate(self.rates @ inverse.T, interval_s=self.interval_s)[-1]
        )

    def carried(self, inverse: Floats) -> Floats:
        """Direction of up after the turn, by the same gyros."""
        return quaternions.rotate_back(self.attitude(inverse), self.before)


@dataclass(frozen=True, slots=True)
class RateModel:
    """True rate = matrix (output - bias).

    Parameters
    ----------
    matrix : ndarray, shape (3, 3)
    output : ndarray, shape (3, 3)
        Its inverse: output per true rate.
    covariance : ndarray, shape (9, 9)
        Of ``output``, row by row.
    rms_before, rms_after : float
        Of the direction of gravity after a turn [rad].
    dof : int
    """

    matrix: Floats
    output: Floats
    covariance: Floats
    rms_before: float
    rms_after: float
    dof: int


def direction_errors(turns: Sequence[Turn], inverse: Floats) -> Floats:
    """Angle between carried and felt direction of gravity of each turn, shape (n, 3)."""
    return np.array([np.cross(t.carried(inverse), t.after) for t in turns])


@dataclass(frozen=True, slots=True)
class TurnRows:
    """Two rows of one turn: its error, and what causes contribute to it.

    Parameters
    ----------
    error : ndarray, shape (2,)
        Carried less felt direction, per time of the turn [rad/s].
    rate : ndarray, shape (2, 3, 3)
        What gyro i's error per rate about j contributes [rad/s].
    size : ndarray, shape (2, 3)
        What half the size of gyro i's own rate contributes [rad/s].
    force : ndarray, shape (2, 3, 3)
        What gyro i's error per force along j contributes, less what its two rests show [m/s2].
    """

    error: Floats
    rate: Floats
    size: Floats
    force: Floats


def turn_rows(
    turn: Turn, inverse: Floats, *, forces: Floats | None = None, rest: Floats | None = None
) -> TurnRows:
    """Error of one turn and its derivatives.

    Up in the body moves by du/dt = u x w. An error e(t) of the rate so moves the carried direction
    by the integral of R(T, t) (u(t) x e(t)), R turning from the body at t into the body at the end;
    divided by the time of the turn it is a mean rate.

    Parameters
    ----------
    turn : Turn
        Its rates less the mean of its two rests.
    inverse : ndarray, shape (3, 3)
        True rate per output.
    forces : ndarray, shape (k, 3), optional
        Specific force at its samples [m/s2].
    rest : ndarray, shape (3,), optional
        Mean force of the two rests [m/s2].
    """
    rates = turn.rates @ inverse.T
    attitude = quaternions.integrate(rates, interval_s=turn.interval_s)
    middle = quaternions.to_matrix(0.5 * (attitude[1:] + attitude[:-1]))
    last = quaternions.to_matrix(attitude[-1])
    up = middle.transpose(0, 2, 1) @ turn.before
    across = level_axes(turn.after)
    # rows of R(T, t): across the felt direction, in the body at t
    lead = np.einsum("aj,kjl->kal", across @ last.T, middle)
    weights = np.cross(lead, up[:, None, :]) / rates.shape[0]
    pull = np.zeros_like(rates) if forces is None or rest is None else forces - rest
    return TurnRows(
        error=across @ (last.T @ turn.before - turn.after) / (rates.shape[0] * turn.interval_s),
        rate=np.einsum("kai,kj->aij", weights, rates),
        size=0.5 * np.einsum("kai,ki->ai", weights, np.abs(rates)),
        force=np.einsum("kai,kj->aij", weights, pull),
    )


def level_axes(up: Floats) -> Floats:
    """Two unit vectors at right angles to ``up`` and to each other, shape (2, 3)."""
    first = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(up, first)])


def fit_rates(turns: Sequence[Turn]) -> RateModel:
    """Fit nine elements to the turns; each turn tells two angles.

    Parameters
    ----------
    turns : sequence of Turn
    """
    inverse = np.eye(3)
    before = direction_errors(turns, inverse)
    times = np.repeat([t.rates.shape[0] * t.interval_s for t in turns], 2)
    own = np.where(np.eye(3) > 0.0, SCALE_TOLERANCE, CROSS_TOLERANCE)
    tolerances = own.ravel() / NORMAL_95
    for _ in range(12):
        rows = [turn_rows(turn, inverse) for turn in turns]
        angles = times * np.concatenate([r.error for r in rows])
        jacobian = times[:, None] * np.concatenate([r.rate.reshape(2, 9) for r in rows])
        # what the turns do not tell stays nominal: any unit's tolerance beside their noise
        weight = math.sqrt(float(np.mean(angles**2))) / tolerances
        held = np.vstack([jacobian, np.diag(weight)])
        target = np.append(-angles, -weight * (inverse - np.eye(3)).ravel())
        change = np.linalg.lstsq(held, target, rcond=None)[0].reshape(3, 3)
        inverse = inverse + change @ inverse
        if float(np.abs(change).max()) < 1e-10:
            break
    rest = direction_errors(turns, inverse)
    dof = 2 * len(turns) - 9
    scale = float(np.sum(rest**2)) / max(dof, 1)
    of_change = covariance_of(jacobian) * scale
    output = np.asarray(np.linalg.inv(inverse), dtype=np.float64)
    chain = -np.kron(output, np.eye(3))  # d(output) = -output change
    return RateModel(
        inverse,
        output,
        chain @ of_change @ chain.T,
        _rms(before),
        _rms(rest),
        dof,
    )


def _rms(errors: Floats) -> float:
    return math.sqrt(float(np.mean(np.sum(errors**2, axis=1))))
