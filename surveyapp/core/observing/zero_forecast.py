"""The next turning point of the unspun swing, from those that were read: for doubts at the entry.

Nothing here enters a result; the reduction of the tape zero stands in ``tapezero``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.book.resolution import reading_resolution
from surveyapp.core.observing.forecast import forecast_reading
from surveyapp.core.swing.clamped import NOMINAL_SIGMA_DIV
from surveyapp.core.swing.gyrofit import fit_damped_swing
from surveyapp.core.swing.reduction import reading_sigma
from surveyapp.domain.readings import Reading, Side
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class ZeroForecast:
    """What the next reading of the mark should be.

    Parameters
    ----------
    middle : float
        Of the swing [div].
    reading : float or None
        [div].
    half_width : float or None
        Of its 99 % interval [div].
    side : Side or None
        None where the mark hardly swings: noise alone may turn it over.
    """

    middle: float
    reading: float | None
    half_width: float | None
    side: Side | None


def forecast_zero(rows: Sequence[Reading], *, card_sigma: float | None) -> ZeroForecast | None:
    """Forecast the next turning point of a tape zero.

    Parameters
    ----------
    rows : sequence of Reading
        Those read so far, of one swing, in their order.
    card_sigma : float or None
        Standard deviation of one scale reading [div].

    Returns
    -------
    ZeroForecast or None
        None before two readings.
    """
    values = np.array([row.value for row in rows], dtype=np.float64)
    if values.size < 2:
        return None
    sides, index = _sides(values)
    fit = fit_damped_swing(values, index, sides) if values.size > 2 else None
    sigma = reading_sigma(
        count=values.size,
        variance=None if fit is None else fit.variance,
        dof=0 if fit is None else fit.dof,
        card_sigma=NOMINAL_SIGMA_DIV if card_sigma is None else card_sigma,
        resolution=reading_resolution(list(rows)),
    )
    reading, half_width = forecast_reading(
        values, index, sides, next_index=int(index[-1]) + 1, sigma=sigma.value, dof=sigma.dof
    )
    middle = 0.5 * float(values[sides > 0.0][-1] + values[sides < 0.0][-1])
    side = Side.LEFT if sides[-1] > 0.0 else Side.RIGHT
    swings = abs(float(values[-1]) - middle) > 3.0 * sigma.value
    return ZeroForecast(middle, reading, half_width, side if swings else None)


def _sides(values: Floats) -> tuple[Floats, Floats]:
    """Sides and numbers as the readings tell: two of one side in a row left one out between."""
    middle = 0.5 * float(values[0] + values[1])
    first = 1.0 if values[0] >= middle else -1.0
    sides = np.where(values > middle, 1.0, -1.0)
    sides[:2] = first, -first
    turns = np.where(sides[1:] == sides[:-1], 2.0, 1.0)
    return sides, np.concatenate([[0.0], np.cumsum(turns)])
