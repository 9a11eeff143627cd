"""A fitted swing as it is shown: points, curve with the forecast, residuals in two channels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from surveyapp.core.observing.forecast import swing_curve
from surveyapp.core.observing.progress import Point
from surveyapp.core.observing.run_alert import channels
from surveyapp.core.swing.gyrofit import DampedFit
from surveyapp.domain.readings import Reading
from surveyapp_models.arrays import Floats

CURVE_STEPS: Final = 24
"""Points of the drawn swing in one half swing."""
AHEAD: Final = 2
"""Half swings that are drawn beyond the last point."""


def shown_points(
    rows: Sequence[Reading],
    fit: DampedFit | None,
    *,
    index: Floats,
    sides: Floats,
    readings: Sequence[float],
    offsets: Floats,
) -> tuple[Point, ...]:
    """The turning points read so far, with residuals where the fit has redundancy.

    ``readings`` as they stand on the circle or scale, ``offsets`` as they are drawn.
    """
    residuals: list[float | None] = [None] * len(rows)
    if fit is not None and fit.dof > 0:
        residuals = list(fit.residuals.tolist())
    return tuple(
        Point(row.seq, int(k), "R" if side > 0 else "L", reading, offset, residual)
        for row, k, side, reading, offset, residual in zip(
            rows, index.tolist(), sides.tolist(), readings, offsets.tolist(), residuals, strict=True
        )
    )


def residual_channel(fit: DampedFit | None, sides: Floats, which: int) -> tuple[float, ...]:
    """Residuals in the channel of the midpoint (0) or of the amplitude (1); empty without any."""
    if fit is None or fit.dof < 1:
        return ()
    return tuple(channels(fit.residuals, sides)[which].tolist())


def shown_curve(
    fit: DampedFit | None, *, first_side: float, next_index: int
) -> tuple[tuple[float, float], ...]:
    """Number of half swings and offset of the swing, two half swings beyond the last point.

    Parameters
    ----------
    fit : DampedFit or None
    first_side : float
        +1 if point 0 stands on the right, else -1.
    next_index : int
        Number of the next turning point.
    """
    if fit is None or not fit.converged:
        return ()
    last = next_index - 1 + AHEAD
    positions = np.linspace(0.0, last, last * CURVE_STEPS + 1)
    offsets = swing_curve(
        north=fit.north,
        amplitude=fit.amplitude,
        log_decrement=fit.log_decrement,
        first_side=first_side,
        index=positions,
    )
    return tuple(zip(positions.tolist(), offsets.tolist(), strict=True))
