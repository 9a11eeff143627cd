"""Calibration from hand-held stops: accelerometers by the size of gravity, gyros by its direction.

At each stop the accelerometers must show one gravity whatever the attitude; from stop to stop the
gyros must carry its direction to where the accelerometers find it. Source: Tedaldi, Pretto and
Menegatti 2014. The accelerometer triad is the frame: its x axis is the body's, y lies in the xy
plane of the body.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.sensors.rate.needed import (
    CROSS_TOLERANCE,
    NORMAL_95,
    SCALE_TOLERANCE,
    ZERO_TOLERANCE,
    covariance_of,
)
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions

LEVELS = ("bias_scale", "three_scales", "misalignment")
"""Accelerometer models, each with more parameters: 4, 6, 9."""
PARAMETERS = {"bias_scale": 4, "three_scales": 6, "misalignment": 9}
_ITERATIONS = 40
_STOP_NOISE = 0.005
"""Of the size of gravity at a stop where its residuals do not tell a smaller one [m/s2]."""
_CONVERGED = 1e-7
"""Of the residuals: a step that moves them by less ends the fit."""


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
class ForceModel:
    """True force = matrix (output - bias).

    Parameters
    ----------
    level : str
    bias : ndarray, shape (3,)
        [m/s2]
    matrix : ndarray, shape (3, 3)
    vector : ndarray, shape (p,)
        The parameters as fitted: bias, then scales, then the three lower elements.
    covariance : ndarray, shape (p, p)
        From the residuals.
    rms : float
        Of the size of gravity [m/s2].
    dof : int
    """

    level: str
    bias: Floats
    matrix: Floats
    vector: Floats
    covariance: Floats
    rms: float
    dof: int

    def corrected(self, force: Floats) -> Floats:
        """True forces of outputs, shape (..., 3)."""
        return np.asarray((force - self.bias) @ self.matrix.T)


def _parts(level: str, vector: Floats) -> tuple[Floats, Floats]:
    """Bias and output matrix K (1 + M) of a parameter vector."""
    bias = vector[:3]
    if level == "bias_scale":
        return bias, np.eye(3) * vector[3]
    out = np.diag(vector[3:6])
    if level == "misalignment":
        out = out.copy()
        out[1, 0] = vector[6] * vector[4]
        out[2, 0], out[2, 1] = vector[7] * vector[5], vector[8] * vector[5]
    return bias, out


def shifted_forces(model: ForceModel, covariance: Floats) -> list[ForceModel]:
    """The model with each parameter off by its standard deviation, in turn.

    Parameters
    ----------
    model : ForceModel
    covariance : ndarray, shape (p, p)
        Of its parameters.
    """
    found = []
    for k, sigma in enumerate(np.sqrt(np.maximum(np.diag(covariance), 0.0))):
        vector = model.vector.copy()
        vector[k] += sigma
        bias, out = _parts(model.level, vector)
        inverse = np.asarray(np.linalg.inv(out), dtype=np.float64)
        found.append(replace(model, bias=bias, matrix=inverse, vector=vector))
    return found


def fit_forces(
    forces: Floats, *, level: str, gravity: float, start: Floats | None = None
) -> ForceModel:
    """Fit one model to the stops' outputs, by Levenberg and Marquardt.

    Parameters
    ----------
    forces : ndarray, shape (n, 3)
        Outputs [m/s2].
    level : str
    gravity : float
        [m/s2]
    start : ndarray, shape (p,), optional
        Parameters to begin with.
    """
    vector = _first_guess(forces, level, gravity) if start is None else start
    dof = forces.shape[0] - PARAMETERS[level]
    if start is None:
        vector = _fitted(forces, level, vector, gravity, noise=_STOP_NOISE)
    rest, _ = _misfit(forces, level, vector, gravity)
    noise = math.sqrt(float(rest @ rest) / max(dof, 1))
    vector = _fitted(forces, level, vector, gravity, noise=min(noise, _STOP_NOISE))
    rest, jacobian = _misfit(forces, level, vector, gravity)
    bias, out = _parts(level, vector)
    scale = float(rest @ rest) / max(dof, 1)
    covariance = covariance_of(jacobian) * scale
    rms = math.sqrt(float(np.mean(rest**2)))
    inverse = np.asarray(np.linalg.inv(out), dtype=np.float64)
    return ForceModel(level, bias, inverse, vector, covariance, rms, dof)


def _fitted(forces: Floats, level: str, vector: Floats, gravity: float, *, noise: float) -> Floats:
    """Parameters by Levenberg and Marquardt.

    What the stops do not tell stays at its nominal value: each parameter counts as observed with
    the tolerance of any unit, beside stops of that noise [m/s2].
    """
    count = PARAMETERS[level]
    damping = 1e-6
    weight = noise / _tolerances(level)
    nominal = np.array([0.0] * 3 + [1.0] * 3 + [0.0] * 3)[:count]

    def held(at: Floats) -> tuple[Floats, Floats]:
        rest, jacobian = _misfit(forces, level, at, gravity)
        own = weight * (at - nominal)
        return np.append(rest, own), np.vstack([jacobian, np.diag(weight)])

    rest, jacobian = held(vector)
    for _ in range(_ITERATIONS):
        size = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-12)
        rows = np.vstack([jacobian / size, math.sqrt(damping) * np.eye(count)])
        step = np.linalg.lstsq(rows, np.append(-rest, np.zeros(count)), rcond=None)[0] / size
        after, slope = held(vector + step)
        if float(after @ after) <= float(rest @ rest) + 1e-18:
            moved = float(np.linalg.norm(jacobian @ step))
            small = moved < _CONVERGED * float(np.linalg.norm(rest))
            done = small or float(np.abs(step).max()) < 1e-12
            vector, rest, jacobian = vector + step, after, slope
            damping = max(damping * 0.1, 1e-12)
            if done:
                break
        else:
            damping = min(damping * 10.0, 1e3)
    return vector


def _tolerances(level: str) -> Floats:
    """What any unit may have, as standard deviations of the parameters of a level."""
    half = [ZERO_TOLERANCE] * 3 + [SCALE_TOLERANCE] * 3 + [CROSS_TOLERANCE] * 3
    return np.array(half[: PARAMETERS[level]]) / NORMAL_95


def covariance_with_omitted(forces: Floats, model: ForceModel, *, gravity: float) -> Floats:
    """Covariance of bias, three scales and misalignments beside a model that lacks some of them.

    What the model has not is not known to be zero: it may be what makers leave open, or what these
    stops still allow of that. A model with everything has its own covariance.

    Parameters
    ----------
    forces : ndarray, shape (n, 3)
        [m/s2]
    model : ForceModel
    gravity : float
        [m/s2]

    Returns
    -------
    ndarray, shape (9, 9)
    """
    if model.level == "misalignment":
        return model.covariance
    scales = model.vector[3:6] if model.level == "three_scales" else np.full(3, model.vector[3])
    vector = np.concatenate([model.bias, scales, np.zeros(3)])
    rest, jacobian = _misfit(forces, "misalignment", vector, gravity)
    noise = math.sqrt(max(float(rest @ rest) / max(model.dof, 1), 1e-20))
    prior = np.zeros((6, 9))
    prior[:3, 3:6] = np.eye(3) * (NORMAL_95 / SCALE_TOLERANCE)
    prior[3:, 6:] = np.eye(3) * (NORMAL_95 / CROSS_TOLERANCE)
    omitted = prior[3:] if model.level == "three_scales" else prior
    return covariance_of(np.vstack([jacobian / noise, omitted]))


def _misfit(forces: Floats, level: str, vector: Floats, gravity: float) -> tuple[Floats, Floats]:
    """Size of the true force less gravity (n,), and its derivatives (n, p)."""
    bias, out = _parts(level, vector)
    inverse = np.linalg.inv(out)
    true = (forces - bias) @ inverse.T
    size = np.linalg.norm(true, axis=1)
    # d|true| = -(K^-T true / |true|) . (d bias + dK true)
    along = -(true / np.maximum(size, 1e-12)[:, None]) @ inverse
    scales = along * true
    if level == "bias_scale":
        columns = [along, scales.sum(axis=1)[:, None]]
    elif level == "three_scales":
        columns = [along, scales]
    else:
        yx, zx, zy = vector[6:]
        scales = scales.copy()
        scales[:, 1] += yx * along[:, 1] * true[:, 0]
        scales[:, 2] += along[:, 2] * (zx * true[:, 0] + zy * true[:, 1])
        tilts = np.column_stack(
            [
                vector[4] * along[:, 1] * true[:, 0],
                vector[5] * along[:, 2] * true[:, 0],
                vector[5] * along[:, 2] * true[:, 1],
            ]
        )
        columns = [along, scales, tilts]
    return size - gravity, np.hstack(columns)


def _first_guess(forces: Floats, level: str, gravity: float) -> Floats:
    """Centre and radius of the sphere through the stops, by linear least squares."""
    design = np.column_stack([2.0 * forces, np.ones(forces.shape[0])])
    solution, *_ = np.linalg.lstsq(design, np.sum(forces**2, axis=1), rcond=None)
    centre = solution[:3]
    radius = math.sqrt(max(float(solution[3] + centre @ centre), 1e-6))
    if np.linalg.cond(design / np.linalg.norm(design, axis=0)) > 1e8:
        centre, radius = np.zeros(3), gravity
    scale = radius / gravity
    tail = {"bias_scale": [scale], "three_scales": [scale] * 3}.get(level, [scale] * 3 + [0.0] * 3)
    return np.concatenate([centre, tail])


def left_out(forces: Floats, *, level: str, gravity: float) -> float | None:
    """Root mean square of the size of gravity at stops that had no part in the fit [m/s2]."""
    count = forces.shape[0]
    if count <= PARAMETERS[level] + 1:
        return None
    rest = []
    start = fit_forces(forces, level=level, gravity=gravity).vector
    for k in range(count):
        keep = np.arange(count) != k
        model = fit_forces(forces[keep], level=level, gravity=gravity, start=start)
        rest.append(float(np.linalg.norm(model.corrected(forces[k]))) - gravity)
    return math.sqrt(float(np.mean(np.square(rest))))


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

    def carried(self, inverse: Floats) -> Floats:
        """Direction of up after the turn, by gyros whose true rate is ``inverse`` output."""
        q = quaternions.integrate(self.rates @ inverse.T, interval_s=self.interval_s)[-1]
        return quaternions.rotate_back(q, self.before)


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
    across = _level(turn.after)
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


def _level(up: Floats) -> Floats:
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
