"""The resolution with which a surveyor read, taken from the readings themselves.

The coarsest usual step that divides every reading of one kind (design.md section 3). It never
looks at more than one kind: the caller passes turning points by themselves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from surveyapp.domain.readings import Reading
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, TWO_PI

ARCSEC_STEPS: Final = (60.0, 30.0, 20.0, 10.0, 6.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1)
PLAIN_STEPS: Final = tuple(m * 10.0**k for k in range(0, -8, -1) for m in (5.0, 2.0, 1.0))
COARSEST: Final = {"gon": 0.02, "deg": 0.02, "div": 1.0}
"""No circle is read more coarsely than by about a minute, no scale more coarsely than by whole
divisions: a few readings that are round by chance must not count as a coarse reading."""
_TOLERANCE: Final = 1e-3
"""Share of the finest step within which a reading counts as a multiple of any step. A share of
the step itself would take 220.0011 for a multiple of 20."""


def infer_resolution(readings: Sequence[float], unit: str) -> float:
    """Coarsest usual step that divides every reading.

    Parameters
    ----------
    readings : sequence of float
        Readings of one kind: angles [rad], or [div] for scale kinds.
    unit : str
        Unit token in which they were written: dms, gon, deg, or div (or any other unit of a
        plain number).

    Returns
    -------
    float
        The step [rad], for plain numbers in their unit. Without a usual step, or without
        readings, the finest one.
    """
    if unit == "dms":
        return _coarsest([value * RHO_ARCSEC for value in readings], ARCSEC_STEPS) * ARCSEC
    factor = {"gon": 400.0 / TWO_PI, "deg": 360.0 / TWO_PI}.get(unit, 1.0)
    coarsest = COARSEST.get(unit, math.inf)
    steps = tuple(step for step in PLAIN_STEPS if step <= coarsest)
    return _coarsest([value * factor for value in readings], steps) / factor


def _coarsest(values: Sequence[float], steps: Sequence[float]) -> float:
    if not values:
        return steps[-1]
    finest = steps[-1]
    return next((step for step in steps if all(_divides(step, v, finest) for v in values)), finest)


def _divides(step: float, value: float, finest: float) -> bool:
    rounding_of_floats = 1e-12 * abs(value)
    rest = abs(value - round(value / step) * step)
    return rest <= max(_TOLERANCE * finest, rounding_of_floats)


def reading_resolution(readings: Sequence[Reading]) -> float:
    """Resolution of rows of one kind [rad] or [div]; 0 where there is no row."""
    values = [row.value for row in readings if row.value is not None]
    return infer_resolution(values, readings[0].unit) if values else 0.0


def rounding_sigma(resolution: float) -> float:
    """Standard deviation of rounding to a resolution, resolution / sqrt(12).

    ``resolution`` and result in one unit: [rad] or [div].
    """
    return resolution / math.sqrt(12.0)
