"""A tracking session while it is observed: what is known now, and what two more points would bring.

It uses the reduction that ``orient`` uses, on the book as it stands; forecast and alarm come on
top. The order of the computation stands here, the formulas in the modules it calls.
"""

from __future__ import annotations

import math

import numpy as np

from surveyapp.core.book.resolution import reading_resolution
from surveyapp.core.observing.forecast import (
    PointForecast,
    Timing,
    fit_timing,
    forecast_reading,
    period_share,
    side_unknown,
)
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.run_alert import Alert, find_trouble
from surveyapp.core.observing.swing_shown import residual_channel, shown_curve, shown_points
from surveyapp.core.orientation.unfinished import lacking
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.goodness import Judge
from surveyapp.core.swing.gyrofit import (
    DampedFit,
    expected_weight_norm,
    fit_damped_swing,
    schuler_means,
    side_signs,
    unwrap,
)
from surveyapp.core.swing.reduction import ReadingSigma, reading_sigma
from surveyapp.core.swing.run_points import MIN_POINTS
from surveyapp.core.swing.sights import moments
from surveyapp.core.swing.tracking import reduce_tracking
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import Reading, ReadingKind
from surveyapp.errors import SurveyError
from surveyapp_models.angles import wrap_two_pi
from surveyapp_models.arrays import Floats


def tracking_period(card: InstrumentCard, latitude: float | None) -> float | None:
    """T1 [s] of an instrument at a latitude [rad], None where its card states none."""
    period = card_at(card, latitude).tracking_s
    return None if period is None else period.value


def tracking_progress(
    session: OrientationSession,
    card: InstrumentCard,
    rng: np.random.Generator,
    *,
    latitude: float | None,
) -> Progress:
    """Judge a tracking session as it stands.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
    rng : numpy.random.Generator
        For the null distributions of the tests.
    latitude : float or None
        [rad].
    """
    swing = session.book.of_kind(ReadingKind.REVERSAL, ReadingKind.MISSED)
    numbered = [(i, row) for i, row in enumerate(swing) if row.kind is ReadingKind.REVERSAL]
    period = tracking_period(card, latitude)
    if not numbered:
        return Progress(period_s=period)
    rows = [row for _, row in numbered]
    first = numbered[0][0]
    index = np.array([i - first for i, _ in numbered], dtype=np.float64)
    next_index = len(swing) - first
    readings = np.array([row.value for row in rows], dtype=np.float64)
    values = unwrap(readings)
    sides = side_signs(rows)
    fit = _fit(values, index, sides)
    sigma = _sigma(session, card, rows, fit)
    share = period_share(latitude)
    forecast, timing = _forecast(
        rows, values, index, sides, known=(next_index, period, share, sigma)
    )
    means, _ = schuler_means(values, index)
    north, missing, source = _north(session, card, rng, latitude)
    origin = float(readings[0])
    return Progress(
        points=shown_points(
            rows,
            fit,
            index=index,
            sides=sides,
            readings=[row.value or 0.0 for row in rows],
            offsets=values,
        ),
        origin=origin,
        next=forecast,
        next_reading=_absolute(origin, forecast.reading),
        period_s=2.0 * timing.half_period_s if timing is not None else period,
        schuler_means=tuple(wrap_two_pi(origin + mean) for mean in means.tolist()),
        north=None if north is None else wrap_two_pi(north.value),
        interval95=north.interval95 if north is not None and math.isfinite(north.sigma) else None,
        interval95_two_more=_two_more(north, fit, index, sides, known=(next_index, sigma)),
        sigma_source=source,
        missing=missing,
        midpoint=residual_channel(fit, sides, 0),
        amplitude=residual_channel(fit, sides, 1),
        curve=shown_curve(fit, first_side=float(sides[0]), next_index=next_index),
        middle=None if fit is None else fit.north,
        alert=_alert(fit, index, sides, rows, rng=rng),
    )


def _absolute(origin: float, offset: float | None) -> float | None:
    return None if offset is None else wrap_two_pi(origin + offset)


def _fit(values: Floats, index: Floats, sides: Floats) -> DampedFit | None:
    if values.size < MIN_POINTS or not (np.any(sides > 0) and np.any(sides < 0)):
        return None
    return fit_damped_swing(values, index, sides)


def _sigma(
    session: OrientationSession, card: InstrumentCard, rows: list[Reading], fit: DampedFit | None
) -> ReadingSigma:
    stated = session.resolution
    return reading_sigma(
        count=len(rows),
        variance=None if fit is None else fit.variance,
        dof=0 if fit is None else fit.dof,
        card_sigma=card.sigma.reversal,
        resolution=stated if stated is not None else reading_resolution(rows),
    )


def _forecast(
    rows: list[Reading],
    values: Floats,
    index: Floats,
    sides: Floats,
    *,
    known: tuple[int, float | None, float, ReadingSigma],
) -> tuple[PointForecast, Timing | None]:
    next_index, period, share, sigma = known
    times = moments(rows)
    timing = None if times is None else fit_timing(index, times, period, share=share)
    reading, half_width = forecast_reading(
        values,
        index,
        sides,
        next_index=next_index,
        sigma=sigma.value if math.isfinite(sigma.value) else None,
        dof=sigma.dof,
    )
    moment, spread = (None, None) if timing is None else timing.moment(float(next_index))
    flips = round(next_index - float(index[-1])) % 2
    right = (float(sides[-1]) > 0.0) != bool(flips)
    forecast = PointForecast(
        index=next_index,
        side="" if side_unknown(rows) else "R" if right else "L",
        reading=reading,
        half_width=half_width,
        moment_s=moment,
        moment_half_width_s=None if spread is None else NORMAL_95 * spread,
    )
    return forecast, timing


def _north(
    session: OrientationSession,
    card: InstrumentCard,
    rng: np.random.Generator,
    latitude: float | None,
) -> tuple[Uncertain | None, str, str | None]:
    """Gyro north exactly as the reduction gives it; else why there is none; its sigma's source."""
    try:
        reduction = reduce_tracking(session, card, Judge(rng), latitude=latitude, estimator=None)
    except SurveyError as error:
        return None, "" if lacking(session) else error.problems[0].what, None
    return reduction.north, "", reduction.sigma_source


def _two_more(
    north: Uncertain | None,
    fit: DampedFit | None,
    index: Floats,
    sides: Floats,
    *,
    known: tuple[int, ReadingSigma],
) -> float | None:
    """95 % half-width of north after two more points, if the readings stay as they are.

    Never wider than now: where the tape zero begins to rule, the interval is widened for its few
    degrees of freedom, and two more points do no harm.
    """
    next_index, sigma = known
    if north is None or fit is None or not math.isfinite(sigma.value):
        return None
    last = float(sides[-1]) * (-1.0 if round(next_index - float(index[-1])) % 2 else 1.0)
    longer = np.concatenate([index, [next_index, next_index + 1.0]])
    both = np.concatenate([sides, [last, -last]])
    norm = expected_weight_norm(fit, index=longer, sides=both)
    dof = math.inf if sigma.origin == "card" else float(longer.size - 3)
    others = north.without("turning points", "damping")
    part = Source("turning points", "", dof)
    return min(others.with_part(part, norm * sigma.value).interval95, north.interval95)


def _alert(
    fit: DampedFit | None,
    index: Floats,
    sides: Floats,
    rows: list[Reading],
    *,
    rng: np.random.Generator,
) -> Alert | None:
    if fit is None:
        return None
    found = find_trouble(fit, index, sides)
    if found is None:
        return None
    trouble, place, p, share = found
    return Alert(trouble, rows[place].seq, int(index[place]), p, share)
