"""Accelerometers from hand-held stops: at each of them one gravity, whatever the attitude.

Source: Tedaldi, Pretto and Menegatti 2014. The accelerometer triad is the frame: its x axis is the
body's, y lies in the xy plane of the body.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.sensors.rate.needed import (
    CROSS_TOLERANCE,
    SCALE_TOLERANCE,
    ZERO_TOLERANCE,
    covariance_of,
)
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp_models.arrays import Floats

LEVELS = ("bias_scale", "three_scales", "misalignment")
"""Accelerometer models, each with more parameters: 4, 6, 9."""
PARAMETERS = {"bias_scale": 4, "three_scales": 6, "misalignment": 9}
_ITERATIONS = 40
_STOP_NOISE = 0.005
"""Of the size of gravity at a stop where its residuals do not tell a smaller one [m/s2]."""
LEAST_SPHERE = 4
FAR_OFF = 3.0
"""Gravities from which a centre of the stops is the middle of a converter's range."""
_CONVERGED = 1e-7
"""Of the residuals: a step that moves them by less ends the fit."""


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


def expanded(model: ForceModel) -> ForceModel:
    """The same model with all nine parameters, those that it omits at their nominal value."""
    if model.level == "misalignment":
        return model
    scales = model.vector[3:6] if model.level == "three_scales" else np.full(3, model.vector[3])
    vector = np.concatenate([model.bias, scales, np.zeros(3)])
    return replace(model, level="misalignment", vector=vector)


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
    offset = converter_zero(forces, gravity)
    if np.any(offset):
        at = np.zeros(PARAMETERS[level])
        at[:3] = offset
        found = fit_forces(
            forces - offset,
            level=level,
            gravity=gravity,
            start=None if start is None else start - at,
        )
        return replace(found, bias=found.bias + offset, vector=found.vector + at)
    dof = forces.shape[0] - PARAMETERS[level]
    vector = _from_nothing(forces, level, gravity) if start is None else start
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
    nominal = _nominal(level)

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


def converter_zero(forces: Floats, gravity: float) -> Floats:
    """Zero of a converter whose counts begin in the middle of its range, shape (3,) [m/s2].

    Of the sphere through the stops the centre, where it lies farther out than any unit's zero and
    than the mirrored centre of a circle of stops, two gravities away; else none.
    """
    if forces.shape[0] < LEAST_SPHERE:
        return np.zeros(3)
    centre, _ = _sphere(forces, gravity)
    return centre if float(np.linalg.norm(centre)) > FAR_OFF * gravity else np.zeros(3)


def _from_nothing(forces: Floats, level: str, gravity: float) -> Floats:
    """Parameters where none are known yet.

    Stops turned about one axis lie on a circle, and two spheres of one gravity go through it: the
    true centre and its mirror, two gravities away. So the fit is begun at the nominal values, too,
    and what the tolerances of any unit find likelier is kept.
    """
    tolerances, nominal = _tolerances(level), _nominal(level)

    def cost(at: Floats) -> float:
        rest = _misfit(forces, level, at, gravity)[0] / _STOP_NOISE
        own = (at - nominal) / tolerances
        return float(rest @ rest + own @ own)

    starts = (_first_guess(forces, level, gravity), nominal)
    return min((_fitted(forces, level, s, gravity, noise=_STOP_NOISE) for s in starts), key=cost)


def _nominal(level: str) -> Floats:
    return np.array([0.0] * 3 + [1.0] * 3 + [0.0] * 3)[: PARAMETERS[level]]


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
    rest, jacobian = _misfit(forces, "misalignment", expanded(model).vector, gravity)
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
    centre, radius = _sphere(forces, gravity)
    scale = radius / gravity
    tail = {"bias_scale": [scale], "three_scales": [scale] * 3}.get(level, [scale] * 3 + [0.0] * 3)
    return np.concatenate([centre, tail])


def _sphere(forces: Floats, gravity: float) -> tuple[Floats, float]:
    """Centre and radius [m/s2]; about zero where the stops tell neither."""
    middle = forces.mean(axis=0)
    about = forces - middle
    design = np.column_stack([2.0 * about, np.ones(forces.shape[0])])
    solution, *_ = np.linalg.lstsq(design, np.sum(about**2, axis=1), rcond=None)
    size = np.maximum(np.linalg.norm(design, axis=0), 1e-300)
    if np.linalg.cond(design / size) > 1e8:
        return np.zeros(3), gravity
    centre = solution[:3]
    radius = math.sqrt(max(float(solution[3] + centre @ centre), 1e-6))
    return np.asarray(centre + middle), radius


def left_out(forces: Floats, model: ForceModel, *, gravity: float) -> float | None:
    """Root mean square of the size of gravity at stops that had no part in the fit [m/s2].

    Parameters
    ----------
    forces : ndarray, shape (n, 3)
        [m/s2]
    model : ForceModel
        From all stops: where each fit without one begins.
    gravity : float
        [m/s2]
    """
    count, level = forces.shape[0], model.level
    if count <= PARAMETERS[level] + 1:
        return None
    rest = []
    for k in range(count):
        keep = np.arange(count) != k
        others = fit_forces(forces[keep], level=level, gravity=gravity, start=model.vector)
        rest.append(float(np.linalg.norm(others.corrected(forces[k]))) - gravity)
    return math.sqrt(float(np.mean(np.square(rest))))
