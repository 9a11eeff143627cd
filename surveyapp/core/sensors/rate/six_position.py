"""Twelve parameters of three gyros from whole turns in six positions of a rate table.

The mean over whole turns is the table's rate, the vertical earth rate and the bias through the
sensor's matrix: turned both ways and with the axis up and down, each of them is told from the
others, whatever the table's azimuth and level (Wu, Sun and Chen; sensors.md 2b). The bias is taken
from the axis's own pair of positions: it is hardly touched by how well the body is seated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats

AXES = "xyz"


@dataclass(frozen=True, slots=True)
class PositionMeans:
    """Outputs of the three gyros in one position, turned both ways.

    Parameters
    ----------
    position : str
        ``x+`` = body x up along the table's axis.
    slope : ndarray, shape (3,)
        Output per clockwise rate of the table [1].
    rest : ndarray, shape (3,)
        Output without the table: bias and vertical earth rate [rad/s]; NaN where less than a
        whole turn leaves the level earth rate in it.
    sigma_slope, sigma_rest : ndarray, shape (3,)
    group : int
        Round of the programme: the body is seated anew in each.
    rate : float
        Mean size of the table's rate [rad/s].
    earth : float or None
        The earth's rate along the table's axis, upwards [rad/s]; None without a latitude.
    """

    position: str
    slope: Floats
    rest: Floats
    sigma_slope: Floats
    sigma_rest: Floats
    group: int = 0
    rate: float = 0.0
    earth: float | None = None

    @property
    def axis(self) -> int:
        """Body axis along the table's."""
        return AXES.index(self.position[0])

    @property
    def up(self) -> float:
        """+1 axis up, -1 axis down."""
        return 1.0 if self.position[1] == "+" else -1.0

    def column(self) -> Floats:
        """Output of each gyro per rate about this axis, shape (3,).

        An axis that points up reads minus the table's clockwise rate.
        """
        return -self.up * self.slope

    def own_rest_sigma(self, relative_rate_sigma: float) -> float:
        """Of the own axis's ``rest`` [rad/s]: what the table's two rates were off is in it."""
        table = relative_rate_sigma * self.rate / math.sqrt(2.0)
        return math.hypot(float(self.sigma_rest[self.axis]), table)


def position_means(
    position: str, *, rates: Floats, means: Floats, sigmas: Floats, group: int = 0
) -> PositionMeans:
    """Straight line of mean outputs over the table's rates.

    Parameters
    ----------
    position : str
    rates : ndarray, shape (k,)
        Clockwise from above, both signs [rad/s].
    means, sigmas : ndarray, shape (k, 3)
        [rad/s]
    group : int
    """
    slope, rest = np.zeros(3), np.zeros(3)
    sigma_slope, sigma_rest = np.zeros(3), np.zeros(3)
    for i in range(3):
        weight = 1.0 / np.maximum(sigmas[:, i], 1e-15)
        design = np.column_stack([rates, np.ones(rates.size)]) * weight[:, None]
        q, r = np.linalg.qr(design)
        slope[i], rest[i] = np.linalg.solve(r, q.T @ (means[:, i] * weight))
        spread = np.sqrt(np.sum(np.linalg.solve(r, np.eye(2)) ** 2, axis=1))
        sigma_slope[i], sigma_rest[i] = spread
    size = float(np.mean(np.abs(rates)))
    return PositionMeans(position, slope, rest, sigma_slope, sigma_rest, group, size)


@dataclass(frozen=True, slots=True)
class GyroTriad:
    """Matrix and biases; NaN = not determined.

    Parameters
    ----------
    matrix : ndarray, shape (3, 3)
        Output i per rate about axis j.
    bias : ndarray, shape (3,)
        [rad/s]
    sigma_matrix, sigma_bias : ndarray
        Of these, from noise, table and flips.
    """

    matrix: Floats
    bias: Floats
    sigma_matrix: Floats
    sigma_bias: Floats

    @property
    def scale(self) -> Floats:
        """K - 1, shape (3,)."""
        return np.diag(self.matrix) - 1.0

    @property
    def sigma_scale(self) -> Floats:
        """Of ``scale``."""
        return np.diag(self.sigma_matrix).copy()

    def misalignment(self) -> tuple[Floats, Floats]:
        """E_ij = M_ij / M_ii and sigma [rad], shape (3, 3); scale 1 where K is unknown."""
        scale = np.where(np.isnan(np.diag(self.matrix)), 1.0, np.diag(self.matrix))
        value = self.matrix / scale[:, None]
        sigma = self.sigma_matrix / np.abs(scale)[:, None]
        np.fill_diagonal(value, np.nan)
        np.fill_diagonal(sigma, np.nan)
        return value, sigma


def solve_six_positions(
    means: Sequence[PositionMeans],
    *,
    flip_sigma: float = 0.0,
    relative_rate_sigma: float = 0.0,
) -> GyroTriad:
    """Matrix and biases from whatever positions there are.

    Parameters
    ----------
    means : sequence of PositionMeans
        Where they know the earth's rate, one position of a pair suffices for the bias.
    flip_sigma : float
        Standard deviation of the seating about each body axis [rad].
    relative_rate_sigma : float
        Of the table's rate.

    Returns
    -------
    GyroTriad
        With NaN where the positions do not determine a parameter.
    """
    matrix, sigma = np.full((3, 3), np.nan), np.full((3, 3), np.nan)
    bias, sigma_bias = np.full(3, np.nan), np.full(3, np.nan)
    for axis in range(3):
        here = [m for m in means if m.axis == axis]
        if not here:
            continue
        count = len(here)
        matrix[:, axis] = np.mean([m.column() for m in here], axis=0)
        noise = np.sqrt(np.sum([m.sigma_slope**2 for m in here], axis=0)) / count
        sigma[:, axis] = _with_flips(noise, axis, count, flip_sigma, relative=relative_rate_sigma)
        bias[axis], sigma_bias[axis] = _own_bias(
            here, axis, matrix[axis, axis], relative=relative_rate_sigma
        )
    return GyroTriad(matrix, bias, sigma, sigma_bias)


def _with_flips(noise: Floats, axis: int, count: int, flip: float, *, relative: float) -> Floats:
    """Add what seating and table do to a column.

    A flip error f about each axis turns the column by f / sqrt(positions) each way and shortens it
    by f^2 on the average (two axes, half the square each), which scatters by f^2 / sqrt(positions).
    """
    across = np.hypot(noise, flip / math.sqrt(count))
    along = math.sqrt(
        float(noise[axis]) ** 2 + flip**4 * (1.0 + 1.0 / count) + relative**2 / (2.0 * count)
    )
    across[axis] = along
    return np.asarray(across)


def _own_bias(
    here: Sequence[PositionMeans],
    axis: int,
    scale: float,
    *,
    relative: float,
) -> tuple[float, float]:
    """Bias of a gyro from its own axis up and down: the vertical earth rate cancels."""
    rests = {up: [m for m in here if m.up == up] for up in (1.0, -1.0)}
    if rests[1.0] and rests[-1.0]:
        sides = [np.mean([m.rest[axis] for m in side]) for side in rests.values()]
        variance = [
            sum(m.own_rest_sigma(relative) ** 2 for m in side) / len(side) ** 2
            for side in rests.values()
        ]
        return float(np.mean(sides)), 0.5 * math.sqrt(float(sum(variance)))
    free = [m.rest[axis] - m.up * scale * m.earth for m in here if m.earth is not None]
    if len(free) < len(here):
        return math.nan, math.nan
    variance_one = sum(m.own_rest_sigma(relative) ** 2 for m in here) / len(here) ** 2
    return float(np.mean(free)), math.sqrt(float(variance_one))


@dataclass(frozen=True, slots=True)
class StaticMeans:
    """Mean output of the gyros at rest in one position, shape (3,) [rad/s]."""

    position: str
    mean: Floats
    sigma: Floats


@dataclass(frozen=True, slots=True)
class Traditional:
    """Biases [rad/s] and K - 1 by axis, each with its sigma."""

    bias: Mapping[str, tuple[float, float]]
    scale: Mapping[str, tuple[float, float]]


def traditional(
    static: Sequence[StaticMeans],
    means: Sequence[PositionMeans],
    *,
    triad: GyroTriad,
    level_rate: float,
    seating: tuple[float, float] = (0.0, 0.0),
) -> Traditional:
    """The static and rate method: biases at rest from the pair, scale factors from one position.

    At rest the level earth rate H does not cancel unless both positions have the same azimuth:
    gyro i takes M_ij H cos and M_ik H sin of it, and H f where the seating is off by f. At any
    azimuth that has the variance H^2 (M_ij^2 + M_ik^2 + 2 f^2) / 2 a position. Whole turns are
    better.

    Parameters
    ----------
    static : sequence of StaticMeans
    means : sequence of PositionMeans
    triad : GyroTriad
        Of the six positions: how far each gyro's axis is off the body's.
    level_rate : float
        Level part of the earth rate; all of it where the latitude is not known [rad/s].
    seating : tuple of float
        Standard deviation of the seating about each axis [rad], of the table's rate [1].
    """
    bias, scale = {}, {}
    flip, relative = seating
    for axis, letter in enumerate(AXES):
        rests = {s.position[1]: s for s in static if s.position[0] == letter}
        if len(rests) == 2:
            both = [rests[sign] for sign in "+-"]
            value = 0.5 * sum(float(s.mean[axis]) for s in both)
            noise = sum(float(s.sigma[axis]) ** 2 for s in both)
            tilts = np.nan_to_num(np.delete(triad.matrix[axis], axis))
            level = level_rate**2 * (float(tilts @ tilts) + 2.0 * flip**2)
            bias[letter] = value, 0.5 * math.sqrt(noise + level)
        turned = [m for m in means if m.axis == axis]
        if turned:
            one = turned[0]
            sigma = _with_flips(one.sigma_slope, axis, 1, flip, relative=relative)
            scale[letter] = float(one.column()[axis]) - 1.0, float(sigma[axis])
    return Traditional(bias, scale)
