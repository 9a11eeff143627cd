"""The nodes of a temperature calibration: their parameters, and what they say between them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from surveyapp.core.sensors.rate.accelerometers import (
    AccelerometerTriad,
    Resting,
    solve_accelerometers,
)
from surveyapp.core.sensors.rate.compensation import (
    ModelName,
    fitted,
    held_out_residuals,
    weights_at,
)
from surveyapp.core.sensors.rate.parameters import (
    PPM,
    accelerometer_parameters,
    gyro_parameters,
)
from surveyapp.core.sensors.rate.six_position import (
    GyroTriad,
    PositionMeans,
    solve_six_positions,
)
from surveyapp.domain.calibration import SensorParameter, with_reasons
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

FULL_RANK = 12
"""Of the accelerometers in six positions."""


@dataclass(frozen=True, slots=True)
class TemperatureOptions:
    """What is stated beside the log.

    Parameters
    ----------
    latitude : float
        [rad]
    predict_at : tuple of float
        Chamber temperatures [C].
    room : tuple of Resting or None
        Rests of a room-temperature log in six positions.
    gravity : float
        [m/s2]
    flip_sigma : float
        [rad]
    relative_rate_sigma : float
    """

    latitude: float
    predict_at: tuple[float, ...] = ()
    room: tuple[Resting, ...] | None = None
    gravity: float = STANDARD_GRAVITY_M_S2
    flip_sigma: float = 0.0
    relative_rate_sigma: float = 0.0


@dataclass(frozen=True, slots=True)
class Node:
    """Parameters at one chamber temperature [C].

    ``common`` is the part of a sigma that all nodes share: what comes from the misalignments of
    the accelerometers, which one log at room temperature (or none) tells for all of them.
    """

    temperature_c: float
    parameters: tuple[SensorParameter, ...]
    gyro: GyroTriad
    common: Mapping[str, float]


def nodes_of(
    levels: Floats,
    means: Sequence[PositionMeans],
    resting: Sequence[tuple[int, Resting]],
    room: AccelerometerTriad | None,
    *,
    options: TemperatureOptions,
) -> list[Node]:
    """Parameters of every node.

    Parameters
    ----------
    levels : ndarray, shape (k,)
        Chamber temperatures [C].
    means : sequence of PositionMeans
        Their group is the number of the node, from 0.
    resting : sequence of (int, Resting)
        The same number and the accelerometers.
    room : AccelerometerTriad or None
        From six positions at room temperature.
    options : TemperatureOptions
    """
    nodes = []
    for k, level in enumerate(levels.tolist()):
        here = [m for m in means if m.group == k]
        gyro = _gyro(here, options)
        parameters, common = gyro_parameters(gyro), {}
        rests = [r for group, r in resting if group == k]
        if rests:
            triad = solve_accelerometers(rests, gravity=options.gravity, room=room)
            parameters += accelerometer_parameters(triad)
            common = _common(triad, alone=room is None)
        why = partial(_why, axes={m.position[0] for m in here}, level=level)
        nodes.append(Node(level, with_reasons(parameters, why), gyro, common))
    return nodes


def _why(name: str, *, axes: set[str], level: float) -> str:
    """Why a parameter has no value at a node."""
    if name.startswith("accelerometer_misalignment"):
        return said(
            "one position per direction: the accelerometer equations have rank 9 of 12; --room "
            "brings them from six positions"
        )
    axis = name[-1]
    if axis not in axes:
        return said(
            "no whole turns both ways with {axis} up at {level:g} C", axis=axis, level=level
        )
    return said("less than a whole turn leaves the level earth rate in it")


def _common(triad: AccelerometerTriad, *, alone: bool) -> dict[str, float]:
    """Sigmas of an accelerometer triad that all nodes share, in the units of the parameters."""
    if triad.rank == FULL_RANK:
        return {}
    found = {}
    for i, a in enumerate("xyz"):
        found[f"accelerometer_bias_{a}"] = float(triad.tilt_bias[i])
        found[f"accelerometer_scale_factor_{a}"] = float(triad.tilt_scale[i]) / PPM
        for j, b in enumerate("xyz"):
            if i != j and not alone:
                sigma = float(triad.sigma_misalignment[i, j]) / ARCSEC
                found[f"accelerometer_misalignment_{a}{b}"] = sigma
    return found


def _gyro(means: Sequence[PositionMeans], options: TemperatureOptions) -> GyroTriad:
    """Matrix as in six positions; the bias from every position with the matrix as measured there.

    How the unit is seated enters the measured column and the earth's rate along the table's axis
    alike, so every position serves for every bias.
    """
    triad = solve_six_positions(
        means,
        flip_sigma=options.flip_sigma,
        relative_rate_sigma=options.relative_rate_sigma,
    )
    if not means:
        return triad
    free = np.array([m.rest - m.up * m.column() * (m.earth or 0.0) for m in means])
    noise = np.array([m.sigma_rest for m in means])
    for one, row in zip(means, noise, strict=True):
        row[one.axis] = one.own_rest_sigma(options.relative_rate_sigma)
    sigma = np.sqrt(np.sum(noise**2, axis=0)) / len(means)
    return GyroTriad(triad.matrix, free.mean(axis=0), triad.sigma_matrix, sigma)


@dataclass(frozen=True, slots=True)
class Series:
    """A parameter over the nodes: values, their own sigmas, and what all of them share."""

    values: Floats
    sigmas: Floats
    common: float


def series_of(nodes: Sequence[Node], name: str) -> Series | None:
    """A parameter over the nodes; None where a node lacks it."""
    cells = [next((p for p in n.parameters if p.name == name), None) for n in nodes]
    values = [None if c is None else c.value for c in cells]
    if any(v is None for v in values):
        return None
    sigmas = np.array([0.0 if c is None or c.sigma is None else c.sigma for c in cells])
    shared = np.array([n.common.get(name, 0.0) for n in nodes])
    own = np.sqrt(np.maximum(sigmas**2 - shared**2, 0.0))
    common = float(np.sqrt(np.mean(shared**2)))
    return Series(np.array(values, dtype=np.float64), own, common)


def predicted(nodes: Sequence[Node], model: ModelName, at: float) -> list[SensorParameter]:
    """Every parameter at a temperature, its sigma with the model's own error at left-out nodes.

    ``at`` in degrees Celsius.
    """
    temperatures = np.array([n.temperature_c for n in nodes])
    found = []
    for parameter in nodes[0].parameters:
        series = series_of(nodes, parameter.name)
        if series is None:
            cells = [p for n in nodes for p in n.parameters if p.name == parameter.name]
            why = next((p.reason for p in cells if p.reason), said("a node lacks it"))
            found.append(SensorParameter(parameter.name, None, None, parameter.unit, why))
            continue
        values, sigmas = series.values, series.sigmas
        function = fitted(model, temperatures, values)
        weights = weights_at(model, temperatures, at)
        if function is None:
            simple: ModelName = "piecewise_linear" if values.size > 1 else "none"
            function = fitted(simple, temperatures, values)
            weights = weights_at(simple, temperatures, at)
        value = float(function(np.array([at]))[0]) if function is not None else math.nan
        spread = float(np.sqrt(np.mean(sigmas**2)))
        noise = float(np.sqrt(np.sum((weights * sigmas) ** 2))) if weights is not None else spread
        error = _model_error(model, temperatures, values, sigmas)
        sigma = math.hypot(noise, error, series.common)
        found.append(SensorParameter(parameter.name, value, sigma, parameter.unit))
    return found


def _model_error(model: ModelName, temperatures: Floats, values: Floats, sigmas: Floats) -> float:
    """What is left at left-out nodes beyond the noise of the nodes themselves.

    A left-out node is off by its own noise and by that of the others through their weights.
    """
    rest = held_out_residuals(model, temperatures, values)
    if rest is None:
        return 0.0
    noise = []
    for k in range(1, values.size - 1):
        keep = np.arange(values.size) != k
        weights = weights_at(model, temperatures[keep], float(temperatures[k]))
        others = sigmas[keep] if weights is None else weights * sigmas[keep]
        total = float(np.sum(others**2)) if weights is not None else float(np.mean(others**2))
        noise.append(float(sigmas[k]) ** 2 + total)
    return math.sqrt(max(float(np.mean(rest**2)) - float(np.mean(noise)), 0.0))
