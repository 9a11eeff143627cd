"""What centring of instrument and targets does to angles and directions.

A 50 m sight with 1 mm is 4 arc-seconds: on mine sides this is often more than the angle itself.

Source: C. D. Ghilani (2010), Adjustment Computations, 5th ed., sections 7.4 and 7.5, for equal
standard deviations in both horizontal components.
"""

from __future__ import annotations

import math


def angle_centring(
    back: float, fore: float, angle: float, *, instrument_m: float, target_m: float
) -> float:
    """Variance of an angle by centring of instrument and targets [rad^2].

    Parameters
    ----------
    back, fore : float
        Lengths of the sides [m].
    angle : float
        The angle itself [rad].
    instrument_m, target_m : float
        Standard deviation of each component [m].

    Returns
    -------
    float
        The instrument's share grows with the distance between the targets; a straight angle is
        the worst.
    """
    between = back**2 + fore**2 - 2.0 * back * fore * math.cos(angle)
    return (
        target_m**2 * (1.0 / back**2 + 1.0 / fore**2)
        + instrument_m**2 * between / (back * fore) ** 2
    )


def direction_centring(length: float, *, instrument_m: float, target_m: float) -> float:
    """Variance of one direction by centring of instrument and target [rad^2]."""
    return (instrument_m**2 + target_m**2) / length**2
