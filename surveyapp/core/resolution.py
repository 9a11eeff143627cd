"""The resolution with which a surveyor reads: the coarsest step that divides every reading."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.domain.readings import Reading
from surveyapp_models.angles import ARCSEC, TWO_PI

ARCSEC_STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 6.0, 10.0, 20.0, 30.0, 60.0)
UNIT_SIZE = {"gon": TWO_PI / 400.0, "deg": TWO_PI / 360.0, "div": 1.0}
_TOLERANCE = 1e-4
"""Of a step: far above rounding of a parsed decimal, far below half a step."""


def _divides(values: Sequence[float], step: float) -> bool:
    ratios = np.asarray(values) / step
    return bool(np.all(np.abs(ratios - np.round(ratios)) < _TOLERANCE))


def reading_resolution(readings: Sequence[Reading]) -> float:
    """Resolution of the readings of one kind in one session.

    Parameters
    ----------
    readings : sequence of Reading
        Of one kind; their unit token decides which steps are tried.

    Returns
    -------
    float
        [rad] for angles, [div] for scale readings; 0.0 where nothing can be told (no reading, or
        finer than every step).

    Source: design.md section 3: 0.1 to 60" for degrees-minutes-seconds, else 1, 2, 5 x 10^k of
    the unit.
    """
    values = [row.value for row in readings if row.value is not None]
    if not values:
        return 0.0
    unit = readings[0].unit
    if unit in UNIT_SIZE:
        size = UNIT_SIZE[unit]
        steps = [m * 10.0**k * size for k in range(-7, 3) for m in (1.0, 2.0, 5.0)]
    else:
        steps = [step * ARCSEC for step in ARCSEC_STEPS]
    return max((step for step in steps if _divides(values, step)), default=0.0)


def rounding_sigma(resolution: float) -> float:
    """Standard deviation of rounding to a resolution."""
    return resolution / math.sqrt(12.0)
