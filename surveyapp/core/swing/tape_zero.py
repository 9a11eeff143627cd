"""Tape zero: the rest position of the unspun swing, before and after, and what it does to north.

Source: physics.md sections 1.3, 1.4 and 2.5. Correction of a tracked run: N = N_obs - lambda mu d,
lambda proportional to 1 / cos(latitude).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.gyrofit import fit_damped_swing, schuler_means, side_signs
from surveyapp.core.swing.sights import swing_moments
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.readings import FieldBook, Place, Reading, ReadingKind
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

LIMIT_DIV = 0.5
"""Of a tape zero where the card states none. Source: Coal Mine Surveying Regulations (China, 1989),
article 62."""
MIN_POINTS_FOR_RESIDUALS = 5
"""Below this number the reading sigma is the card's (physics.md 2.1)."""


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
        ``time``, ``mean``, ``single``, or ``tilt`` where the levels tell what the missing zero
        would have been.
    """

    before: RestPosition | None
    after: RestPosition | None
    value_div: float
    factor_before: float
    factor_after: float
    interpolation: Literal["time", "mean", "single", "tilt"]
    drift_div_per_s: float = 0.0

    def unexplained_change_div(self, limit_div: float | None) -> float:
        """Standard deviation [div] of the zero in force for how it went from before to after.

        A small change is a drift, and the zero in force lies on the straight line. A large one may
        have come at once, at any moment of the run: then every value between the two is as likely,
        and their standard deviation is the change over sqrt(12). Between the two the share grows
        with the square of the change over the limit of a tape zero.
        """
        if self.before is None or self.after is None:
            return 0.0
        change = abs(self.after.value_div - self.before.value_div)
        share = min((change / (limit_div or LIMIT_DIV)) ** 2, 1.0)
        return share * change / math.sqrt(12.0)

    def drift_at(self, times: Floats) -> Floats:
        """Zero at the moments of the run's rows minus the zero in force, which is their mean."""
        return self.drift_div_per_s * (times - float(times.mean()))


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
        fit = fit_damped_swing(readings, index, sides)
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
    clock = _clock(groups[Place.BEFORE], groups[Place.AFTER], swing)
    if clock is None:
        value = 0.5 * (before.value_div + after.value_div)
        return TapeZero(before, after, value, 0.5, 0.5, "mean")
    first, middle, last = clock
    drift = (after.value_div - before.value_div) / (last - first)
    fraction = (middle - first) / (last - first)
    value = before.value_div + drift * (middle - first)
    return TapeZero(before, after, value, 1.0 - fraction, fraction, "time", drift)


def _group(rows: Sequence[Reading]) -> RestPosition | None:
    if not rows:
        return None
    readings = np.array([row.value for row in rows], dtype=np.float64)
    sides = side_signs(rows)
    return rest_position(readings, sides)


def _clock(
    before: Sequence[Reading], after: Sequence[Reading], swing: Sequence[Reading]
) -> tuple[float, float, float] | None:
    """Mean moments of the zero before, the run and the zero after, None where not all are timed."""
    times = swing_moments([*before, *after], swing)
    if times is None:
        return None
    first = float(times[0][: len(before)].mean())
    last = float(times[0][len(before) :].mean())
    return (first, float(times[1].mean()), last) if last > first else None


def mean_level(book: FieldBook, kind: ReadingKind, place: Place) -> float | None:
    """Mean level reading [rad] before or after the observation, None without one."""
    rows = [row for row in book.of_kind(kind) if book.place_of(row) is place]
    values = [row.value for row in rows if row.value is not None]
    return sum(values) / len(values) if values else None


def with_levels(zero: TapeZero, book: FieldBook, card: InstrumentCard) -> TapeZero:
    """Replace a missing tape zero by the one that the change of level makes of the other.

    Source: physics.md 2.5: the zero changes in proportion to the tilt of the standing axis; the
    middle of the observation lies half-way between the two levels.
    """
    factor = card.tape_zero.div_per_tilt
    if zero.interpolation != "single" or not factor:
        return zero
    before = mean_level(book, ReadingKind.LEVEL_ACROSS, Place.BEFORE)
    after = mean_level(book, ReadingKind.LEVEL_ACROSS, Place.AFTER)
    if before is None or after is None:
        return zero
    change = 0.5 * factor * (after - before)
    sign = 1.0 if zero.before is not None else -1.0
    return replace(zero, value_div=zero.value_div + sign * change, interpolation="tilt")


def with_tilt(zero: TapeZero, change: float | None, card: InstrumentCard) -> TapeZero:
    """The tape zero as the tilt of the run has it.

    Parameters
    ----------
    zero : TapeZero
        As observed; one that was made from the levels of both sides stays as it is.
    change : float or None
        Tilt across gyro north in the run minus that in the tape zero [rad].
    card : InstrumentCard
        Its ``div_per_tilt`` says what a tilt does.
    """
    factor = card.tape_zero.div_per_tilt
    if change is None or not factor or zero.interpolation == "tilt":
        return zero
    return replace(zero, value_div=zero.value_div + factor * change)


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
        at, sigma = zero.latitude, zero.correction_sigma or 0.0
        if latitude is None or at is None:
            return TapeZeroCoefficient(
                zero.correction_per_div, sigma, said("card coefficient"), False
            )
        factor = math.cos(at) / math.cos(latitude)
        return TapeZeroCoefficient(
            zero.correction_per_div * factor, sigma * factor, said("card coefficient"), True
        )
    here = card_at(card, latitude)
    if here.torsion_ratio is None or card.scale_value is None:
        return None
    return TapeZeroCoefficient(
        -here.torsion_ratio.value * card.scale_value,
        here.torsion_ratio.sigma * abs(card.scale_value),
        here.torsion_origin,
        here.transferred,
    )
