"""Effects of a tilt sensor of two axes: what its readings hold beside zero and scale.

A row is one axis at one time; readings and references in arc-seconds.
"""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Column, Columns

AXIS = Column("axis", "axis of the row: 0 = along, 1 = across")
TIME = Column("time_s", "s, of the log")
OWN = Column("reference", "true tilt of the row's axis, arcsec")
OTHER = Column("other_reference", "true tilt of the other axis, arcsec")
TEMPERATURE = Column("temperature_c", "degree Celsius")


def by_axis(columns: Columns, values: Floats) -> Floats:
    """One column an axis: the values in its own rows, else 0; shape (n, 2)."""
    return np.asarray((columns["axis"][:, None] == np.arange(2.0)) * values[:, None])
