"""Bias, scale factor and misalignment of three accelerometers turned in gravity.

Output i = K_i (f_i + sum_j M_ij f_j) + B_i. Six positions determine all twelve parameters. One
position per direction has rank nine: bias and scale factor then need the misalignments from
elsewhere (a room-temperature log). Without them they stand on the assumption that there are none,
and their sigma holds misalignments as large as the positions themselves show them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.statistics.distributions import student_quantile
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Resting:
    """Mean accelerometer outputs in one position, shape (3,) [m/s2], with sigma."""

    position: str
    mean: Floats
    sigma: Floats

    def force(self, gravity: float) -> Floats:
        """Specific force in the body with the named axis up or down, shape (3,) [m/s2]."""
        vector = np.zeros(3)
        vector["xyz".index(self.position[0])] = gravity if self.position[1] == "+" else -gravity
        return vector


@dataclass(frozen=True, slots=True)
class AccelerometerTriad:
    """Parameters; NaN = not determined.

    Parameters
    ----------
    bias, scale : ndarray, shape (3,)
        [m/s2], K - 1.
    misalignment : ndarray, shape (3, 3)
        M_ij [rad], diagonal NaN.
    sigma_bias, sigma_scale, sigma_misalignment : ndarray
    tilt_bias, tilt_scale : ndarray, shape (3,)
        What the misalignments' own uncertainty has in these sigmas: common to all nodes.
    rank : int
        Of the twelve unknowns from these positions alone.
    """

    bias: Floats
    scale: Floats
    misalignment: Floats
    sigma_bias: Floats
    sigma_scale: Floats
    sigma_misalignment: Floats
    tilt_bias: Floats
    tilt_scale: Floats
    rank: int


def solve_accelerometers(
    resting: Sequence[Resting], *, gravity: float, room: AccelerometerTriad | None = None
) -> AccelerometerTriad:
    """Solve what the positions determine, axis by axis.

    Parameters
    ----------
    resting : sequence of Resting
    gravity : float
        Local acceleration of free fall [m/s2].
    room : AccelerometerTriad, optional
        Misalignments from elsewhere with their sigmas; without them and without full rank they
        count as zero and stay undetermined.
    """
    forces = np.array([r.force(gravity) for r in resting]).reshape(-1, 3)
    outputs = np.array([r.mean for r in resting]).reshape(-1, 3)
    sigmas = np.array([r.sigma for r in resting]).reshape(-1, 3)
    design = np.column_stack([forces, np.ones(len(resting))])
    rank_one = int(np.linalg.matrix_rank(design)) if len(resting) else 0
    found = _nothing(3 * rank_one)
    reduced = []
    for i in range(3):
        if rank_one == 4:
            solution, spread = _weighted(design, outputs[:, i], sigmas[:, i])
            _filled(found, i, solution[i], solution[3], spread=(spread[i], spread[3]))
            for j in range(3):
                if j != i:
                    found.misalignment[i, j] = solution[j] / solution[i]
                    found.sigma_misalignment[i, j] = spread[j] / solution[i]
            continue
        across = np.zeros(3) if room is None else np.nan_to_num(room.misalignment[i])
        across[i] = 1.0
        columns = np.column_stack([forces @ across, np.ones(len(resting))])
        if np.linalg.matrix_rank(columns) == 2:
            solution, spread = _weighted(columns, outputs[:, i], sigmas[:, i])
            _filled(found, i, solution[0], solution[1], spread=(spread[0], spread[1]))
            reduced.append((i, columns))
    if room is not None and rank_one < 4:
        found.misalignment[:] = room.misalignment
        found.sigma_misalignment[:] = room.sigma_misalignment
        tilts = room.sigma_misalignment
    else:
        tilts = np.full((3, 3), _shown_tilt(found, [i for i, _ in reduced], forces, outputs))
    for i, columns in reduced:
        _with_tilts(found, i, columns, forces, sigma=(sigmas[:, i], tilts[i]))
    return found


def _nothing(rank: int) -> AccelerometerTriad:
    """A triad of which nothing is known yet, to be filled."""
    three, nine = np.full(3, np.nan), np.full((3, 3), np.nan)
    return AccelerometerTriad(
        bias=three.copy(),
        scale=three.copy(),
        misalignment=nine.copy(),
        sigma_bias=three.copy(),
        sigma_scale=three.copy(),
        sigma_misalignment=nine.copy(),
        tilt_bias=np.zeros(3),
        tilt_scale=np.zeros(3),
        rank=rank,
    )


def _filled(
    triad: AccelerometerTriad, i: int, scale: float, bias: float, *, spread: tuple[float, float]
) -> None:
    triad.scale[i], triad.bias[i] = scale - 1.0, bias
    triad.sigma_scale[i], triad.sigma_bias[i] = spread


def _shown_tilt(
    triad: AccelerometerTriad, axes: Sequence[int], forces: Floats, outputs: Floats
) -> float:
    """Standard deviation of a misalignment [rad] from what the assumption of none leaves.

    With x, y and z up once each, output i in the other two positions is K (g M) + B: their
    difference shows two misalignments against each other, three such differences their size.
    Few degrees of freedom: widened so that 1.96 of it is the 95 % interval.
    """
    squares, count = 0.0, 0
    for i in axes:
        scale = 1.0 + triad.scale[i]
        rest = outputs[:, i] - scale * forces[:, i] - triad.bias[i]
        squares += float(rest @ rest) / float(scale**2 * np.max(np.abs(forces)) ** 2)
        count += rest.size - 2
    if count < 1:
        return 0.0
    widened = student_quantile(0.975, count) / student_quantile(0.975, 1e6)
    return float(np.sqrt(squares / count)) * widened


def _with_tilts(
    triad: AccelerometerTriad,
    i: int,
    columns: Floats,
    forces: Floats,
    *,
    sigma: tuple[Floats, Floats],
) -> None:
    """Add what the misalignments' own uncertainty does to scale factor and bias of an axis."""
    weight = 1.0 / np.maximum(sigma[0], 1e-12)
    for j in range(3):
        if j == i or not np.isfinite(sigma[1][j]):
            continue
        pull = -(1.0 + triad.scale[i]) * forces[:, j] * sigma[1][j]
        moved = np.linalg.lstsq(columns * weight[:, None], pull * weight, rcond=None)[0]
        triad.tilt_scale[i] = np.hypot(triad.tilt_scale[i], moved[0])
        triad.tilt_bias[i] = np.hypot(triad.tilt_bias[i], moved[1])
    triad.sigma_scale[i] = np.hypot(triad.sigma_scale[i], triad.tilt_scale[i])
    triad.sigma_bias[i] = np.hypot(triad.sigma_bias[i], triad.tilt_bias[i])


def _weighted(design: Floats, values: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    weight = 1.0 / np.maximum(sigma, 1e-12)
    q, r = np.linalg.qr(design * weight[:, None])
    solution = np.linalg.solve(r, q.T @ (values * weight))
    inverse = np.linalg.solve(r, np.eye(r.shape[0]))
    return solution, np.sqrt(np.sum(inverse**2, axis=1))
