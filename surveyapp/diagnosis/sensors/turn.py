"""A sensor that sits crookedly in its body: a turn of any size, linear about where it was found.

exp(w) f - f = sin t / t (w x f) + (1 - cos t) / t^2 (w (w f) - t^2 f), t = |w| (Rodrigues). With
the second part's w taken from the last round it is linear in w, and exact where both agree. The
field of the base model, a mean over all attitudes, is too short by (1 + 2 cos t) / 3 where the
sensor is turned.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from surveyapp.diagnosis.sensors.loop import Candidate
from surveyapp.diagnosis.sensors.windows import Blocks, block_means
from surveyapp_models.arrays import Floats

NAMES: Final = tuple(f"misalignment_{axis}" for axis in "xyz")
ROUNDS: Final = 12
LARGEST: Final = math.radians(60.0)
"""A sensor that is turned by more does not sit crookedly: its axes are exchanged."""


def turn(field: Floats, base_rows: Floats, block: Blocks) -> Candidate:
    """The misalignment as a candidate of the loop.

    Parameters
    ----------
    field : ndarray, shape (m, 3)
        Undisturbed field in the body, row by row [uT].
    base_rows : ndarray, shape (m, 3, p)
    block : ndarray of int, shape (m,)
    """
    base = block_means(base_rows, block)
    size = base.shape[0] * base.shape[1]

    def rows(point: Mapping[str, float]) -> Floats:
        return _design(field, np.array([point[name] for name in NAMES]))

    def designs(residual: Floats) -> Sequence[tuple[dict[str, float], Floats]]:
        found = np.zeros(3)
        for _ in range(ROUNDS):
            design = block_means(_design(field, found), block)
            whole = np.concatenate([design, base], axis=2).reshape(size, -1)
            solution = np.linalg.lstsq(whole, residual.ravel(), rcond=1e-9)[0]
            before, found = found, solution[:3]
            if float(np.linalg.norm(found)) > math.pi:
                found = np.zeros(3)
                break
            if float(np.max(np.abs(found - before))) < 1e-9:
                break
        point = {name: float(v) for name, v in zip(NAMES, found, strict=True)}
        return [(point, block_means(_design(field, found), block))]

    degree = math.degrees(1.0)
    return Candidate("misalignment", designs, NAMES, "deg", 0, degree, rows)


def _design(field: Floats, near: Floats) -> Floats:
    """Columns that add up to exp(w) f - f at w = ``near`` [rad], shape (m, 3, 3)."""
    angle = float(np.linalg.norm(near))
    first = math.sin(angle) / angle if angle > 0.0 else 1.0
    field = field * 3.0 / (1.0 + 2.0 * math.cos(angle)) if angle < LARGEST else field
    second = (1.0 - math.cos(angle)) / angle**2 if angle > 1e-6 else 0.5
    columns = [
        first * np.cross(axis, field) + second * ((field @ near)[:, None] * axis - near[k] * field)
        for k, axis in enumerate(np.eye(3))
    ]
    return np.stack(columns, axis=2)
