"""A value with its standard deviation, as the functions of this package return it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value and its standard deviation, in the same unit.

    Parameters
    ----------
    value : float
    sigma : float
        One standard deviation; 0.0 where the inputs were taken as exact.
    """

    value: float
    sigma: float


def propagated(value: float, *terms: float) -> Estimate:
    """Return the value with the root of the sum of squares of independent error terms."""
    return Estimate(value, math.hypot(*terms) if terms else 0.0)
