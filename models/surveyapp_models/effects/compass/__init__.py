"""Effects of a compass: what the magnetometer shows beside a constant field.

A row is one axis of the magnetometer at one time. Where no reference attitude stands in the log,
the same columns are taken along the measured field, which is what its size shows of them.
"""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Column, Columns

AXIS = Column("axis", "axis of the row: 0, 1, 2 = x, y, z")
TIME = Column("time_s", "s, of the log")
FIELD = tuple(Column(f"field_{a}", "undisturbed field in the body, uT") for a in "xyz")
LEVEL = tuple(
    Column(f"level_{a}", f"cosine between the row's axis and level {a}, z up") for a in "xyz"
)
PLACE = tuple(Column(f"place_{a}", "m, from the middle of the record, level frame") for a in "xyz")
TEMPERATURE = Column("temperature_c", "degree Celsius")
SYMMETRIC = ("xx", "yy", "xy", "xz", "yz")
SHAPES = np.array(
    [
        [[1, 0, 0], [0, 0, 0], [0, 0, -1]],
        [[0, 0, 0], [0, 1, 0], [0, 0, -1]],
        [[0, 1, 0], [1, 0, 0], [0, 0, 0]],
        [[0, 0, 1], [0, 0, 0], [1, 0, 0]],
        [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
    ],
    dtype=np.float64,
)
"""Symmetric matrices of trace zero, in the order of ``SYMMETRIC``."""


def own_axis(columns: Columns) -> Floats:
    """1 in the column of the row's own axis, shape (n, 3)."""
    return np.asarray(columns["axis"][:, None] == np.arange(3.0), dtype=np.float64)


def three(columns: Columns, needs: tuple[Column, ...]) -> Floats:
    """Three columns side by side, shape (n, 3)."""
    return np.column_stack([columns[need.name] for need in needs])
