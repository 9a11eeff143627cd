"""A clamped session (amplitude, transit) while it is observed: forecast, north now, alarm.

It uses the reduction that ``orient`` uses, on the book as it stands; forecasts and alarm come on
top. The order of the computation stands here, the formulas in the modules it calls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from surveyapp.core.book.resolution import reading_resolution, rounding_sigma
from surveyapp.core.observing.clamped_alert import alert_of_readings, alert_of_swing
from surveyapp.core.observing.clamped_outlook import north_now, two_more
from surveyapp.core.observing.forecast import (
    PointForecast,
    Timing,
    fit_timing,
    forecast_reading,
    period_share,
    side_unknown,
)
from surveyapp.core.observing.passage_forecast import (
    Known,
    PassageFit,
    PassageForecast,
    first_side,
    fit_passages,
    forecast_passage,
    judge_last,
)
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.run_alert import Alert
from surveyapp.core.observing.swing_shown import residual_channel, shown_curve, shown_points
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.clamped import (
    NOMINAL_SIGMA_DIV,
    NOMINAL_SIGMA_S,
    NumberedRows,
    number_rows,
    polarity,
    triples_of,
)
from surveyapp.core.swing.gyrofit import DampedFit, fit_damped_swing, schuler_means, side_signs
from surveyapp.core.swing.reduction import ReadingSigma, reading_sigma
from surveyapp.core.swing.sights import moments
from surveyapp.core.swing.swingfit import ClampedSwing
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import Reading
from surveyapp_models.angles import wrap_two_pi
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Standing:
    """A clamped swing as it stands.

    Parameters
    ----------
    rows : NumberedRows
    swing : ClampedSwing
        With passages that have a time; index 0 is the first turning point that was read.
    first : int
        Number of that turning point in the book.
    stamps : ndarray or None
        Moments of the readings [s].
    known : Known
    """

    rows: NumberedRows
    swing: ClampedSwing
    first: int
    stamps: Floats | None
    known: Known

    @property
    def next_index(self) -> int:
        """Number of the next turning point."""
        return self.rows.last + 1 - self.first

    @property
    def next_after(self) -> int:
        """Number of the turning point before the next passage."""
        return self.next_index if self.rows.at_passage else self.next_index - 1


def clamped_progress(
    session: OrientationSession,
    card: InstrumentCard,
    rng: np.random.Generator,
    *,
    latitude: float | None,
) -> Progress:
    """Judge an amplitude or transit session as it stands.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
    rng : numpy.random.Generator
        For the null distributions of the tests.
    latitude : float or None
        [rad].
    """
    standing = standing_of(session, card, latitude)
    swing, period = standing.swing, standing.known.period_s
    if not standing.rows.readings and not standing.rows.passages:
        return Progress(scale=True, period_s=period)
    fit = _fit(swing)
    sigma = _sigma(standing, card, fit)
    timing = None
    if standing.stamps is not None:
        timing = fit_timing(swing.index, standing.stamps, period, share=standing.known.share)
    passing = fit_passages(swing, standing.known) if session.method == "transit" else None
    north, missing, source = north_now(session, card, rng, latitude)
    forecast = _next(standing, sigma, timing, passing)
    return replace(
        _seen(standing, fit),
        next=forecast,
        next_reading=None if forecast is None else forecast.reading,
        passage=_passage(standing, passing),
        period_s=_period(period, timing, passing),
        north=None if north is None else wrap_two_pi(north.value),
        interval95=north.interval95 if north is not None and math.isfinite(north.sigma) else None,
        interval95_two_more=two_more(
            session,
            card,
            latitude=latitude,
            north=north,
            swing=swing,
            fit=fit,
            passing=passing,
            coming=(standing.next_index, standing.next_after),
        ),
        sigma_source=source,
        missing=missing,
        alert=_alert(session, standing, fit, rng),
    )


def _seen(standing: Standing, fit: DampedFit | None) -> Progress:
    """What the readings so far show by themselves."""
    swing = standing.swing
    means, _ = schuler_means(swing.readings, swing.index)
    return Progress(
        points=shown_points(
            [row for _, row in standing.rows.readings],
            fit,
            index=swing.index,
            sides=swing.sides,
            readings=swing.readings.tolist(),
            offsets=swing.readings,
        ),
        scale=True,
        schuler_means=tuple(means.tolist()),
        time_differences=time_differences(swing),
        midpoint=residual_channel(fit, swing.sides, 0),
        amplitude=residual_channel(fit, swing.sides, 1),
        curve=shown_curve(fit, first_side=first_side(swing), next_index=standing.next_index),
        middle=None if fit is None else fit.north,
    )


def standing_of(
    session: OrientationSession, card: InstrumentCard, latitude: float | None
) -> Standing:
    """Collect what stands in the book, however little; passages without a time tell nothing.

    ``latitude`` [rad].
    """
    numbered = number_rows(session)
    rows = [row for _, row in numbered.readings]
    first = numbered.readings[0][0] if rows else 0
    timed, times = _timed(numbered)
    values = np.array([row.value for row in rows], dtype=np.float64)
    here = card_at(card, latitude).clamped_s
    sigma_div = card.sigma.scale_div or NOMINAL_SIGMA_DIV
    swing = ClampedSwing(
        readings=values,
        index=np.array([turn - first for turn, _ in numbered.readings], dtype=np.float64),
        sides=_sides(rows, values),
        passages_s=times,
        divisions=np.array([row.value for _, row in timed], dtype=np.float64),
        after=np.array([turn - first for turn, _ in timed], dtype=np.float64),
        sigma_div=sigma_div,
        sigma_s=card.sigma.time_s or NOMINAL_SIGMA_S,
    )
    resolution = reading_resolution(rows) if rows else 0.0
    known = Known(
        None if here is None else here.value,
        period_share(latitude),
        rounding_sigma(resolution) / sigma_div,
    )
    return Standing(numbered, swing, first, moments(rows), known)


def _timed(numbered: NumberedRows) -> tuple[tuple[tuple[int, Reading], ...], Floats]:
    """Passages and their moments on one clock; of mixed ones those with elapsed seconds."""
    passages = numbered.passages
    times = moments([row for _, row in passages])
    if times is None:
        passages = tuple(item for item in passages if item[1].elapsed_s is not None)
        times = moments([row for _, row in passages])
    return passages, np.empty(0) if times is None else times


def _sides(rows: list[Reading], values: Floats) -> Floats:
    """+1 for the larger readings; where one side was read only, its sign on the scale tells."""
    written = side_signs(rows)
    if np.unique(written).size > 1:
        return written * polarity(values, written)
    right = values.size == 0 or float(values.mean()) >= 0.0
    return np.full(values.size, 1.0 if right else -1.0)


def _fit(swing: ClampedSwing) -> DampedFit | None:
    if swing.readings.size < 3 or np.unique(swing.sides).size < 2:
        return None
    return fit_damped_swing(swing.readings, swing.index, swing.sides)


def _sigma(standing: Standing, card: InstrumentCard, fit: DampedFit | None) -> ReadingSigma:
    rows = [row for _, row in standing.rows.readings]
    return reading_sigma(
        count=len(rows),
        variance=None if fit is None else fit.variance,
        dof=0 if fit is None else fit.dof,
        card_sigma=card.sigma.scale_div,
        resolution=reading_resolution(rows) if rows else 0.0,
    )


def _next(
    standing: Standing, sigma: ReadingSigma, timing: Timing | None, passing: PassageFit | None
) -> PointForecast | None:
    """The next turning point on the scale; its side is known once one has been read."""
    swing, index = standing.swing, standing.next_index
    if not swing.readings.size:
        return None
    reading, half_width = forecast_reading(
        swing.readings,
        swing.index,
        swing.sides,
        next_index=index,
        sigma=sigma.value if math.isfinite(sigma.value) else None,
        dof=sigma.dof,
    )
    moment, spread = (None, None) if timing is None else timing.moment(float(index))
    if passing is not None:
        moment, spread = passing.turning(index)
    side: Literal["L", "R"] = "R" if (first_side(swing) > 0.0) == (index % 2 == 0) else "L"
    return PointForecast(
        index=index,
        side="" if side_unknown([row for _, row in standing.rows.readings]) else side,
        reading=reading,
        half_width=half_width,
        moment_s=moment,
        moment_half_width_s=None if spread is None else NORMAL_95 * spread,
    )


def _passage(standing: Standing, passing: PassageFit | None) -> PassageForecast | None:
    if passing is None:
        return None
    division = float(standing.swing.divisions[-1])
    return forecast_passage(passing, standing.next_after, division)


def _period(known: float | None, timing: Timing | None, passing: PassageFit | None) -> float | None:
    if passing is not None:
        return float(passing.parameters[4])
    return known if timing is None else 2.0 * timing.half_period_s


def time_differences(swing: ClampedSwing) -> tuple[float, ...]:
    """East minus west of every three passages in a row [s]: dt = s (2 t2 - t1 - t3).

    Empty while no reading tells which side is which (physics.md 2.3).
    """
    if not swing.readings.size:
        return ()
    found = []
    for i in triples_of(swing.after.tolist()):
        if swing.divisions[i] == swing.divisions[i + 1] == swing.divisions[i + 2]:
            side = first_side(swing) * (1.0 if int(swing.after[i] + 1) % 2 == 0 else -1.0)
            first, second, third = swing.passages_s[i : i + 3].tolist()
            found.append(side * (2.0 * second - first - third))
    return tuple(found)


def _alert(
    session: OrientationSession,
    standing: Standing,
    fit: DampedFit | None,
    rng: np.random.Generator,
) -> Alert | None:
    swing = standing.swing
    if session.method != "transit":
        return alert_of_readings(standing.rows, swing, fit, rng)
    timed = [row for _, row in _timed(standing.rows)[0]]
    last = swing.passages_s.size - 1
    if last >= 1:
        before = fit_passages(_before(swing, last), standing.known)
        found = judge_last(
            before,
            after=int(swing.after[last]),
            division=float(swing.divisions[last]),
            moment_s=float(swing.passages_s[last]),
        )
        if found is not None:
            return Alert(found[0], timed[last].seq, last, found[1])
    return alert_of_swing(standing.rows, timed, swing, rng, period=standing.known.period_s)


def _before(swing: ClampedSwing, last: int) -> ClampedSwing:
    """The swing as it was before its last passage."""
    earlier = swing.index <= swing.after[last]
    return replace(
        swing,
        readings=swing.readings[earlier],
        index=swing.index[earlier],
        sides=swing.sides[earlier],
        passages_s=swing.passages_s[:last],
        divisions=swing.divisions[:last],
        after=swing.after[:last],
        first_side=first_side(swing),
    )
