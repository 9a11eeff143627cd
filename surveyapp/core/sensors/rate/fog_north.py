"""North by a fibre-optic gyro on a total station, the consumer of its instrument constant.

Each row is the mean of one position of the telescope. Near east and west the gyro reads almost
nothing and is most sensitive to azimuth; plunging the telescope turns the gyro round and tells its
bias from the earth. A null reading leaves 180 degrees open: the approximate north decides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.statistics.distributions import student_quantile
from surveyapp_models.angles import wrap_pi, wrap_two_pi
from surveyapp_models.arrays import Floats
from surveyapp_models.constants import EARTH_RATE

NAMES = ("north", "bias", "collimation", "elevation")
SCALE = np.array([1.0, EARTH_RATE, 1.0, 1.0])
"""Units of these unknowns in the design [rad], [rad/s], [rad], [rad]."""
FIRST_NOISE = 1e-9
"""Of a row before the residuals tell it [rad/s]."""
LEAST_NOISE = 1e-15
"""Of rows without any [rad/s]."""
NOISE_ROUNDS = 4
"""In which the rows' own scatter settles against the sigma that is stated for the constant."""
UNDETERMINED = 1e-3
"""Singular value, as a share of the largest, below which a direction is not told by the rows: a
thousandth of the earth rate per radian, 0.015 deg/h."""
_NORMAL_95 = 1.959963984540054


@dataclass(frozen=True, slots=True)
class Position:
    """Mean output in one position.

    Parameters
    ----------
    rate : float
        [rad/s]
    alidade : float
        Horizontal-circle reading [rad].
    vertical : float or None
        Vertical-circle reading [rad].
    plunged : bool
        Face right.
    """

    rate: float
    alidade: float
    vertical: float | None
    plunged: bool


@dataclass(frozen=True, slots=True)
class FogNorth:
    """North, and what was solved with it.

    Parameters
    ----------
    north : float or None
        Horizontal-circle reading of astronomic north [rad].
    sigma, interval95 : float or None
        [rad]; None where neither a sigma was stated nor residuals are left.
    bias, collimation, elevation : float or None
        [rad/s], [rad], [rad]; None = not determined.
    sigmas : tuple
        Of these three.
    undetermined : tuple of str
    residual_rms : float
        [rad/s]
    dof : int
    """

    north: float | None
    sigma: float | None
    interval95: float | None
    bias: float | None
    collimation: float | None
    elevation: float | None
    sigmas: tuple[float | None, float | None, float | None]
    undetermined: tuple[str, ...]
    residual_rms: float
    dof: int


def predicted(position: Position, parameters: Floats, *, latitude: float, offset: float) -> float:
    """Output of one position; ``offset`` = elevation of this position above the common one.

    ``latitude`` and ``offset`` [rad], rates [rad/s].
    """
    north, bias, collimation, elevation = parameters
    level, vertical = EARTH_RATE * math.cos(latitude), EARTH_RATE * math.sin(latitude)
    turn = math.pi if position.plunged else 0.0
    sign = -1.0 if position.plunged else 1.0
    azimuth = position.alidade - north + turn + sign * collimation
    v = sign * (elevation + offset)
    return float(level * math.cos(azimuth) * math.cos(v) + vertical * math.sin(v) + bias)


def solve_north(
    positions: Sequence[Position],
    *,
    latitude: float,
    approximate_north: float,
    constant: float | None = None,
    constant_sigma: float = 0.0,
    rate_sigma: float | None = None,
    reading_increases: bool = True,
) -> FogNorth:
    """Solve north, bias, collimation and elevation by least squares.

    Parameters
    ----------
    positions : sequence of Position
    latitude, approximate_north : float
        [rad]
    constant, constant_sigma : float
        Reading at which the gyro's axis is level and its standard deviation [rad].
    rate_sigma : float, optional
        Standard deviation of one row [rad/s]; without it the residuals are asked.
    reading_increases : bool
        Rule of the vertical circle.
    """
    offsets = elevation_offsets(positions, constant, reading_increases=reading_increases)
    measured = np.array([p.rate for p in positions])
    estimate = np.array([approximate_north, 0.0, 0.0, 0.0])
    prior = None if constant is None else max(constant_sigma, 1e-9)
    noise = rate_sigma if rate_sigma is not None and rate_sigma > 0.0 else FIRST_NOISE
    basis = _determined(positions, estimate, latitude, offsets=offsets, prior=prior)
    dof = measured.size + (prior is not None) - basis.shape[1]
    for _ in range(1 if rate_sigma is not None or dof < 1 else NOISE_ROUNDS):
        estimate, design = _fitted(
            positions, estimate, basis, latitude, offsets=offsets, prior=prior, noise=noise
        )
        at = _at(positions, estimate, latitude, offsets=offsets)
        if rate_sigma is None and dof > 0:
            noise = max(math.sqrt(float((measured - at) @ (measured - at)) / dof), LEAST_NOISE)
    return _result(
        measured - at, estimate, design, basis=basis, noise=noise, rate_sigma=rate_sigma, dof=dof
    )


def _fitted(
    positions: Sequence[Position],
    estimate: Floats,
    basis: Floats,
    latitude: float,
    *,
    offsets: Floats,
    prior: float | None,
    noise: float,
) -> tuple[Floats, Floats]:
    """Unknowns by least squares from a first estimate on, and the design at them."""
    measured = np.array([p.rate for p in positions])
    design = np.zeros((0, 4))
    for _ in range(30):
        design, rest = _rows(
            positions, estimate, latitude, offsets=offsets, prior=prior, noise=noise
        )
        at = _at(positions, estimate, latitude, offsets=offsets)
        rest[: measured.size] += (measured - at) / noise
        step, *_ = np.linalg.lstsq(design @ basis, rest, rcond=None)
        estimate = estimate + basis @ step * SCALE
        if float(np.abs(step).max(initial=0.0)) < 1e-13:
            break
    return estimate, design


def _at(
    positions: Sequence[Position], estimate: Floats, latitude: float, *, offsets: Floats
) -> Floats:
    """What the positions would show, shape (n,) [rad/s]."""
    return np.array(
        [
            predicted(p, estimate, latitude=latitude, offset=o)
            for p, o in zip(positions, offsets.tolist(), strict=True)
        ]
    )


def _both(positions: Sequence[Position], offsets: Floats) -> zip[tuple[Position, float]]:
    return zip(positions, offsets.tolist(), strict=True)


def elevation_offsets(
    positions: Sequence[Position], constant: float | None, *, reading_increases: bool
) -> Floats:
    """Elevation of each position's direct pointing above the common one [rad], shape (n,).

    The common one has the reading of the constant, else of the first direct row; a plunged row is
    half a turn farther.
    """
    readings = [
        None if p.vertical is None else p.vertical - (math.pi if p.plunged else 0.0)
        for p in positions
    ]
    known = [r for r in readings if r is not None]
    if not known:
        return np.zeros(len(positions))
    origin = constant if constant is not None else known[0]
    sign = -1.0 if reading_increases else 1.0
    return np.array([0.0 if r is None else sign * wrap_pi(r - origin) for r in readings])


def _rows(
    positions: Sequence[Position],
    estimate: Floats,
    latitude: float,
    *,
    offsets: Floats,
    prior: float | None,
    noise: float,
) -> tuple[Floats, Floats]:
    """Design in units of ``SCALE`` and of the noise, and the right side that the prior gives."""
    rows = []
    step = 1e-6
    for position, offset in _both(positions, offsets):
        row = []
        for k in range(4):
            shift = np.zeros(4)
            shift[k] = step * SCALE[k]
            high = predicted(position, estimate + shift, latitude=latitude, offset=offset)
            low = predicted(position, estimate - shift, latitude=latitude, offset=offset)
            row.append((high - low) / (2.0 * step) / noise)
        rows.append(row)
    rest = [0.0] * len(rows)
    if prior is not None:
        rows.append([0.0, 0.0, 0.0, 1.0 / prior])
        rest.append(-float(estimate[3]) / prior)
    return np.array(rows), np.array(rest)


def _determined(
    positions: Sequence[Position],
    estimate: Floats,
    latitude: float,
    *,
    offsets: Floats,
    prior: float | None,
) -> Floats:
    """Directions of the four unknowns that the rows tell, shape (4, k)."""
    design, _ = _rows(positions, estimate, latitude, offsets=offsets, prior=None, noise=EARTH_RATE)
    if prior is not None:
        design = np.vstack([design, [0.0, 0.0, 0.0, 1.0]])
    _, size, right = np.linalg.svd(design, full_matrices=False)
    return np.asarray(right[size > UNDETERMINED * size[0]].T)


def _result(
    rest: Floats,
    estimate: Floats,
    design: Floats,
    *,
    basis: Floats,
    noise: float,
    rate_sigma: float | None,
    dof: int,
) -> FogNorth:
    known = np.sum(basis**2, axis=1) > 1.0 - 1e-6
    missing = {name for name, told in zip(NAMES, known, strict=True) if not told}
    _, r = np.linalg.qr(design @ basis)
    inverse = basis @ np.linalg.solve(r, np.eye(basis.shape[1]))
    spread = np.sqrt(np.sum(inverse**2, axis=1)) * SCALE
    factor, quantile = _judged(rest, noise, rate_sigma, dof)
    sigma = [None if factor is None else float(s * factor) for s in spread]
    value = [None if name in missing else float(v) for name, v in zip(NAMES, estimate, strict=True)]
    sigma = [None if v is None else s for v, s in zip(value, sigma, strict=True)]
    north = None if value[0] is None else wrap_two_pi(value[0])
    interval = None if sigma[0] is None or quantile is None else sigma[0] * quantile
    rms = math.sqrt(float(np.mean(rest**2)))
    names = tuple(name for name in NAMES if name in missing)
    return FogNorth(
        north,
        sigma[0],
        interval,
        value[1],
        value[2],
        value[3],
        (sigma[1], sigma[2], sigma[3]),
        names,
        rms,
        max(dof, 0),
    )


def _judged(
    rest: Floats, noise: float, rate_sigma: float | None, dof: int
) -> tuple[float | None, float | None]:
    """Factor of the sigmas and quantile: stated noise, else residuals, else none."""
    if rate_sigma is not None:
        return 1.0, _NORMAL_95
    if dof < 1:
        return None, None
    return math.sqrt(float(rest @ rest) / dof) / noise, student_quantile(0.975, dof)
