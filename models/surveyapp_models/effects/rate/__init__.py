"""Effects of a rate sensor: what the outputs of its stops hold beside bias, scale and misalignment.

A row is one gyro at one stop, or one of two angles of a turn between stops: what the gyros carried
less what the accelerometers found, per time of the turn. A turn takes its rates from its two rests,
so a bias, a ramp or a temperature is not in it. The columns that all effects read stand here once.
"""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Column, Columns

AXIS = Column("axis", "gyro of the row: 0, 1, 2 = x, y, z; 3, 4 = the two angles of a turn")
STOP = Column("stop", "number of the stop, from 1; turns follow")
ELAPSED = Column("elapsed_s", "seconds since the first stop")
TEMPERATURE = Column("temperature_c", "degree Celsius")
FORCES = tuple(Column(f"force_{a}", "specific force in the body, m/s2") for a in "xyz")
GYRO_FORCES = tuple(
    Column(f"force_{a}{b}", f"force along {b} as the row has it through gyro {a}, m/s2")
    for a in "xyz"
    for b in "xyz"
)
GYRO_RATES = tuple(
    Column(f"rate_{a}{b}", f"rate about {b} as the row has it through gyro {a}, rad/s")
    for a in "xyz"
    for b in "xyz"
)
GYRO_SIZES = tuple(
    Column(f"half_size_{a}", f"half the size of gyro {a}'s own rate, as the row has it, rad/s")
    for a in "xyz"
)
INPUTS = tuple(Column(f"input_{a}", "known rate of the body, rad/s") for a in "xyz")
FIELDS = tuple(Column(f"field_{a}", "magnetic flux density in the body, T") for a in "xyz")
PLACE = Column("place", "number of the position on the table, from 1")
DEG_S = 0.017453292519943295
"""One degree per second [rad/s]."""


def by_axis(columns: Columns, values: Floats) -> Floats:
    """One column a gyro: the values in its own rows, else 0; shape (n, 3)."""
    return np.asarray((columns["axis"][:, None] == np.arange(3.0)) * values[:, None])


def own(columns: Columns, name: str) -> Floats:
    """Of three columns ``name_x/y/z`` the one along the row's own axis, shape (n,); of a turn 0."""
    three = np.column_stack([columns[f"{name}_{a}"] for a in "xyz"])
    three = np.column_stack([three, np.zeros((three.shape[0], 2))])
    return np.asarray(three[np.arange(three.shape[0]), columns["axis"].astype(np.intp)])
