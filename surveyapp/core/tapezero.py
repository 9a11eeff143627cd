"""Tape zero: the rest position of the unspun swing, before and after, and what it does to north.

Source: physics.md sections 1.3, 1.4 and 2.5. Correction of a tracked run: N = N_obs - lambda mu d,
lambda proportional to 1 / cos(latitude).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.gyrofit import fit_swing, schuler_means
from surveyapp.core.sights import moments
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.readings import FieldBook, Place, Reading, ReadingKind, Side

Floats = NDArray[np.float64]

MIN_POINTS_FOR_RESIDUALS = 5


@dataclass(frozen=True, slots=True)
class RestPosition:
    """Mean rest reading of one group of unspun turning points.

    Parameters
    ----------
    value_div : float
        d [div].
    weight_norm : float
        Standard error of d divided by the standard deviation of one reading.
    scale_variance : float or None
        Variance of one reading from the residuals [div^2], None without redundancy.
    dof : int
    points : int
    schuler_div : tuple of float
        The three-point means, for the record.
    """

    value_div: float
    weight_norm: float
    scale_variance: float | None
    dof: int
    points: int
    schuler_div: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class TapeZero:
    """Tape zero of one session.

    Parameters
    ----------
    before, after : RestPosition or None
    value_div : float
        d in force for the run [div].
    factor_before, factor_after : float
        Its weights on before and after.
    interpolation : str
        ``time``, ``mean`` or ``single``.
    """

    before: RestPosition | None
    after: RestPosition | None
    value_div: float
    factor_before: float
    factor_after: float
    interpolation: Literal["time", "mean", "single"]


def rest_position(readings: Floats, sides: Floats) -> RestPosition:
    """Rest reading of an unspun swing from its turning points [div].

    One reading is taken as a rest reading, two are averaged, from three on the mean of the
    overlapping Schuler means is taken (1-2-1 for three).
    """
    index = np.arange(readings.size, dtype=np.float64)
    if readings.size < 3:
        mean = float(readings.mean())
        return RestPosition(mean, readings.size**-0.5, None, 0, readings.size, ())
    means, weights = schuler_means(readings, index)
    variance, dof = None, 0
    if readings.size >= MIN_POINTS_FOR_RESIDUALS and np.unique(sides).size == 2:
        fit = fit_swing(readings, index, sides)
        variance, dof = fit.variance, fit.dof
    return RestPosition(
        value_div=float(means.mean()),
        weight_norm=float(np.sqrt(weights @ weights)),
        scale_variance=variance,
        dof=dof,
        points=readings.size,
        schuler_div=tuple(means.tolist()),
    )


def reduce_tape_zero(book: FieldBook, swing: Sequence[Reading]) -> TapeZero | None:
    """Reduce the tape zeros of one book; None where there are none.

    Parameters
    ----------
    book : FieldBook
    swing : sequence of Reading
        The turning points of the spinning gyro: their mean moment is where d is wanted.
    """
    groups: dict[Place, list[Reading]] = {Place.BEFORE: [], Place.AFTER: []}
    for row in book.of_kind(ReadingKind.TAPE_ZERO):
        place = book.place_of(row)
        groups[Place.AFTER if place is Place.DURING else place].append(row)
    before, after = (_group(groups[place]) for place in (Place.BEFORE, Place.AFTER))
    if before is None and after is None:
        return None
    if before is None or after is None:
        only = before or after
        assert only is not None
        return TapeZero(
            before,
            after,
            only.value_div,
            float(before is not None),
            float(after is not None),
            "single",
        )
    fraction, how = _fraction(groups[Place.BEFORE], groups[Place.AFTER], swing)
    value = (1.0 - fraction) * before.value_div + fraction * after.value_div
    return TapeZero(before, after, value, 1.0 - fraction, fraction, how)


def _group(rows: Sequence[Reading]) -> RestPosition | None:
    if not rows:
        return None
    readings = np.array([row.value for row in rows], dtype=np.float64)
    sides = np.array([1.0 if row.side is Side.RIGHT else -1.0 for row in rows])
    return rest_position(readings, sides)


def _fraction(
    before: Sequence[Reading], after: Sequence[Reading], swing: Sequence[Reading]
) -> tuple[float, Literal["time", "mean"]]:
    times = moments([*before, *after, *swing])
    if times is None or not swing:
        return 0.5, "mean"
    first = float(times[: len(before)].mean())
    last = float(times[len(before) : len(before) + len(after)].mean())
    middle = float(times[len(before) + len(after) :].mean())
    return ((middle - first) / (last - first), "time") if last > first else (0.5, "mean")


@dataclass(frozen=True, slots=True)
class TapeZeroCoefficient:
    """What one division of tape zero adds to gyro north.

    Parameters
    ----------
    value : float
        [rad/div], -lambda mu at the session's latitude.
    sigma : float
        [rad/div], from the card's period sigma; 0 where the card states none.
    origin : str
        ``card coefficient``, ``lambda`` or ``periods``.
    transferred : bool
        Whether it was carried to the session's latitude.
    """

    value: float
    sigma: float
    origin: str
    transferred: bool


def torsion_ratio(card: InstrumentCard, latitude: float | None) -> tuple[float, float, str] | None:
    """Torsion ratio lambda = D / M of a card at a latitude, its sigma, and where it comes from.

    Source: physics.md 1.3, lambda = T1^2 / T2^2 - 1, lambda cos(latitude) constant,
    sigma = 2 (1 + lambda) sqrt((s/T1)^2 + (s/T2)^2).
    """
    periods = card.periods
    value, sigma, origin = card.torsion_lambda, 0.0, "lambda"
    if periods is not None and periods.tracking_s and periods.clamped_s:
        ratio = (periods.tracking_s / periods.clamped_s) ** 2
        spread = periods.sigma_s or 0.0
        relative = math.hypot(spread / periods.tracking_s, spread / periods.clamped_s)
        if value is None:
            value, sigma, origin = ratio - 1.0, 2.0 * ratio * relative, "periods"
    if value is None:
        return None
    factor = 1.0
    if latitude is not None and periods is not None:
        factor = math.cos(periods.latitude) / math.cos(latitude)
    return value * factor, sigma * factor, origin


def tape_zero_coefficient(
    card: InstrumentCard, latitude: float | None
) -> TapeZeroCoefficient | None:
    """Coefficient of the tape-zero correction, None where the card cannot tell.

    Parameters
    ----------
    card : InstrumentCard
        Its own ``correction_per_div`` wins over lambda and the scale value.
    latitude : float or None
        Latitude of the session [rad]; None: the card's value at its own latitude.
    """
    zero = card.tape_zero
    if zero.correction_per_div is not None:
        at = zero.latitude
        if latitude is None or at is None:
            return TapeZeroCoefficient(zero.correction_per_div, 0.0, "card coefficient", False)
        factor = math.cos(at) / math.cos(latitude)
        return TapeZeroCoefficient(zero.correction_per_div * factor, 0.0, "card coefficient", True)
    ratio = torsion_ratio(card, latitude)
    if ratio is None or card.scale_value is None:
        return None
    value, sigma, origin = ratio
    return TapeZeroCoefficient(
        -value * card.scale_value,
        sigma * abs(card.scale_value),
        origin,
        latitude is not None and card.periods is not None,
    )
