"""A shift of north in a run: inside a half swing it kicks the amplitude too, by its phase."""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats


def shift(position: Floats, side: Floats | None, place: float, phase: float) -> Floats:
    """A shift after a place at a phase of the half swing that follows it, shape (n,)."""
    after = (position > place).astype(np.float64)
    if side is None:
        return after
    kick = side * side[int(np.argmin(np.abs(position - place)))]
    return np.asarray(after * (1.0 - kick * np.cos(np.pi * phase)))
