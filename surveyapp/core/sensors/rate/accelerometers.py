"""Bias, scale factor and misalignment of three accelerometers turned in gravity.

Output i = K_i (f_i + sum_j M_ij f_j) + B_i. Six positions determine all twelve parameters. One
position per direction has rank nine: bias and scale factor then need the misalignments from
elsewhere (a room-temperature log), and without them stand on the assumption that there are none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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
    rank : int
        Of the twelve unknowns from these positions alone.
    """

    bias: Floats
    scale: Floats
    misalignment: Floats
    sigma_bias: Floats
    sigma_scale: Floats
    sigma_misalignment: Floats
    rank: int


def solve_accelerometers(
    resting: Sequence[Resting], *, gravity: float, misalignment: Floats | None = None
) -> AccelerometerTriad:
    """Solve what the positions determine, axis by axis.

    Parameters
    ----------
    resting : sequence of Resting
    gravity : float
        Local acceleration of free fall [m/s2].
    misalignment : ndarray, shape (3, 3), optional
        From elsewhere [rad]; without it and without full rank it counts as zero and stays
        undetermined.
    """
    forces = np.array([r.force(gravity) for r in resting])
    outputs = np.array([r.mean for r in resting])
    sigmas = np.array([r.sigma for r in resting])
    design = np.column_stack([forces, np.ones(len(resting))])
    rank_one = int(np.linalg.matrix_rank(design)) if len(resting) else 0
    nan3, nan33 = np.full(3, np.nan), np.full((3, 3), np.nan)
    bias, scale, s_bias, s_scale = nan3.copy(), nan3.copy(), nan3.copy(), nan3.copy()
    tilt, s_tilt = nan33.copy(), nan33.copy()
    for i in range(3):
        if rank_one == 4:
            solution, spread = _weighted(design, outputs[:, i], sigmas[:, i])
            scale[i], bias[i] = solution[i] - 1.0, solution[3]
            s_scale[i], s_bias[i] = spread[i], spread[3]
            for j in range(3):
                if j != i:
                    tilt[i, j], s_tilt[i, j] = solution[j] / solution[i], spread[j] / solution[i]
            continue
        across = np.zeros(3) if misalignment is None else np.nan_to_num(misalignment[i])
        across[i] = 1.0
        reduced = np.column_stack([forces @ across, np.ones(len(resting))])
        if np.linalg.matrix_rank(reduced) < 2:
            continue
        solution, spread = _weighted(reduced, outputs[:, i], sigmas[:, i])
        scale[i], bias[i] = solution[0] - 1.0, solution[1]
        s_scale[i], s_bias[i] = spread[0], spread[1]
    if misalignment is not None and rank_one < 4:
        tilt = misalignment.copy()
    return AccelerometerTriad(bias, scale, tilt, s_bias, s_scale, s_tilt, 3 * rank_one)


def _weighted(design: Floats, values: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    weight = 1.0 / np.maximum(sigma, 1e-12)
    q, r = np.linalg.qr(design * weight[:, None])
    solution = np.linalg.solve(r, q.T @ (values * weight))
    inverse = np.linalg.solve(r, np.eye(r.shape[0]))
    return solution, np.sqrt(np.sum(inverse**2, axis=1))
