"""A fitted swing as it is shown: its curve with the forecast, its residuals in two channels."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.forecast import swing_curve
from surveyapp.core.gyrofit import SwingFit
from surveyapp.core.run_alert import channels

Floats = NDArray[np.float64]

CURVE_STEPS: Final = 24
"""Points of the drawn swing in one half swing."""
AHEAD: Final = 2
"""Half swings that are drawn beyond the last point."""


def residual_channel(fit: SwingFit | None, sides: Floats, which: int) -> tuple[float, ...]:
    """Residuals in the channel of the midpoint (0) or of the amplitude (1); empty without any."""
    if fit is None or fit.dof < 1:
        return ()
    return tuple(channels(fit.residuals, sides)[which].tolist())


def shown_curve(
    fit: SwingFit | None, *, first_side: float, next_index: int
) -> tuple[tuple[float, float], ...]:
    """Number of half swings and offset of the swing, two half swings beyond the last point.

    Parameters
    ----------
    fit : SwingFit or None
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
