"""Heading of a compass from the field and the direction of up, and the field that it stands in.

Body axes: x towards the carrier's mark, z up, right-handed, so y to the left. Headings clockwise
from magnetic north, seen from above. The specific force at rest points up (+g).
"""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats

DEFAULT_DIP = np.radians(65.0)
"""Inclination of the field where no record of specific force tells it [rad]."""


def level_field(heading: Floats, *, size: float, dip: float) -> Floats:
    """Field in the axes of a level carrier.

    Parameters
    ----------
    heading : ndarray, shape (n,)
        Magnetic, clockwise [rad].
    size : float
        Of the field [any unit].
    dip : float
        Inclination, positive downwards [rad].

    Returns
    -------
    ndarray, shape (n, 3)
        In the unit of ``size``.
    """
    level = size * np.cos(dip)
    down = np.full(heading.shape, size * np.sin(dip))
    return np.column_stack([level * np.cos(heading), level * np.sin(heading), -down])


def tilted(vectors: Floats, *, pitch: Floats, roll: Floats) -> Floats:
    """Vectors of a level carrier in the axes of one that is tilted.

    Parameters
    ----------
    vectors : ndarray, shape (n, 3)
        In the axes of the level carrier.
    pitch : ndarray, shape (n,)
        Positive where the mark points up [rad].
    roll : ndarray, shape (n,)
        About the tilted x axis, positive where the left side rises [rad].

    Returns
    -------
    ndarray, shape (n, 3)
    """
    cp, sp, cr, sr = np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
    x, y, z = vectors.T
    along, up = cp * x + sp * z, -sp * x + cp * z
    return np.column_stack([along, cr * y + sr * up, -sr * y + cr * up])


def heading_of(field: Floats, up: Floats | None = None) -> Floats:
    """Magnetic heading of the mark, tilt-compensated.

    Parameters
    ----------
    field : ndarray, shape (n, 3)
        [any unit]
    up : ndarray, shape (n, 3), or None
        Specific force or any other vector that points up; None = the carrier is level.

    Returns
    -------
    ndarray, shape (n,)
        In [0, 2 pi) [rad]; NaN where the field or the mark is vertical.
    """
    if up is None:
        return np.asarray(np.arctan2(field[:, 1], field[:, 0]) % (2.0 * np.pi))
    unit = up / np.linalg.norm(up, axis=1)[:, None]
    north = field - np.sum(field * unit, axis=1)[:, None] * unit
    forward = -unit * unit[:, :1]
    forward[:, 0] += 1.0
    right = -np.sum(np.cross(north, forward) * unit, axis=1)
    along = np.sum(north * forward, axis=1)
    psi = np.arctan2(right, along) % (2.0 * np.pi)
    return np.asarray(np.where((right == 0.0) & (along == 0.0), np.nan, psi))


def dip_of(field: Floats, up: Floats) -> Floats:
    """Inclination of a field, positive downwards, shape (n,) [rad]."""
    along = np.sum(field * up, axis=1)
    size = np.linalg.norm(field, axis=1) * np.linalg.norm(up, axis=1)
    return np.asarray(-np.arcsin(np.clip(along / size, -1.0, 1.0)))
