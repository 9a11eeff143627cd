"""The transit method as the textbooks have it: N = N' + C a dt with a stated C.

Neither torsion ratio nor scale value enters: C was determined on the instrument itself, by two
clampings. Source: physics.md 1.4 and 2.3; Thomas (1982); Schwendener (1966).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.clamped import clamp_reading, observe, session_problem
from surveyapp.core.swing.clamped_middle import ClosedTransit, closed_transit
from surveyapp.core.swing.reduction import Reduction, point_results
from surveyapp.core.swing.tape_zero import reduce_tape_zero
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.gyro.coefficients import transit_coefficient_ratio
from surveyapp_models.gyro.estimates import Estimate

RATIOS = (0.05, 0.8)
"""Torsion ratios at 47 degrees for which physics.md 1.4 tabulates C against latitude: between them
lies every instrument of the cards."""


def is_classical(session: OrientationSession, card: InstrumentCard, latitude: float | None) -> bool:
    """Whether a transit session can be reduced by C alone, and by nothing else.

    ``latitude`` [rad].
    """
    complete = card_at(card, latitude).torsion_ratio is not None and card.scale_value is not None
    return session.method == "transit" and card.transit_c is not None and not complete


def reduce_classical(
    session: OrientationSession, card: InstrumentCard, *, latitude: float | None
) -> Reduction:
    """Gyro north from clamp reading, amplitude and time difference.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
        With ``transit_c`` at ``periods.latitude``.
    latitude : float or None
        [rad].

    Raises
    ------
    SurveyError
        If the clamp reading, one side of the swing or three passages of one division are missing.
    """
    c = constant_at(card, latitude)
    clamp, _ = clamp_reading(session)
    observed = observe(session, card)
    period = observed.period_s
    if period is None:
        raise session_problem(
            session,
            "the period of the clamped swing is not known",
            found="no two passages one period apart",
            expected="at least three passages of one division",
            hint="Observe three transits or more.",
        )
    found = closed_transit(session, observed)
    if found.division != 0.0:
        raise session_problem(
            session,
            "the reduction by C alone needs passages of the middle of the scale",
            found=said("passages of division {division:g}", division=found.division),
            expected="transit rows with value 0",
            hint="State the scale value and the torsion ratio, or time the middle.",
        )
    a, dt = found.amplitude, found.difference
    north = _north(session, c, found, period)
    swing = observed.swing
    readings: Sequence[float] = swing.readings.tolist()
    blank = [None] * len(readings)
    return Reduction(
        estimator=said("transit, C a dt"),
        north=north,
        points_used=swing.count,
        sigma_source="card",
        period_s=period,
        tape_zero=reduce_tape_zero(session.book, [*observed.readings, *observed.passages]),
        tape_zero_correction=None if _zeros(session) else 0.0,
        points=point_results(
            observed.readings,
            index=swing.index,
            sides=swing.sides,
            observed=readings,
            fitted=blank,
            residuals=blank,
        ),
        quantities=(
            (said("clamp reading"), math.degrees(clamp), "deg"),
            (said("time difference east minus west"), dt.value, "s"),
            ("amplitude", a.value, "div"),
            (said("transit constant"), math.degrees(c.value) * 3600.0, said("arcsec/(div s)")),
        ),
        warnings=_warnings(session),
    )


def _north(
    session: OrientationSession, c: Estimate, found: ClosedTransit, period: float
) -> Uncertain:
    """N' + C a dt with its error; the linear form is left as it is, its excess in the sigma."""
    clamp, clamp_sigma = clamp_reading(session)
    a, dt = found.amplitude, found.difference
    product = c.value * a.value * dt.value
    return Uncertain(
        clamp + product,
        {
            Source("passages", session.id): c.value * a.value * dt.sigma,
            Source("scale readings", session.id): c.value * dt.value * a.sigma,
            Source("clamp reading", session.id): clamp_sigma,
            Source("transit constant", session.instrument): a.value * dt.value * c.sigma,
            Source("linear form", session.id): product * _bent(found, period),
        },
    )


def constant_at(card: InstrumentCard, latitude: float | None) -> Estimate:
    """C at a latitude [rad/(div s)]: without a torsion ratio its change with latitude is uncertain.

    The middle of the changes that the torsion ratios of all instruments would make is taken, and
    half their distance over sqrt(3) enters the sigma.
    """
    own, sigma = card.transit_c or 0.0, card.transit_c_sigma or 0.0
    at = None if card.periods is None else card.periods.latitude
    if latitude is None or at is None:
        return Estimate(own, sigma)
    ratio = card_at(card, latitude).torsion_ratio
    if ratio is not None:
        factor = transit_coefficient_ratio(
            ratio.value * math.cos(latitude) / math.cos(at), latitude=at, to_latitude=latitude
        )
        return Estimate(own * factor, sigma * factor)
    middle = math.radians(47.0)
    ends = []
    for value in RATIOS:
        here = value * math.cos(middle) / math.cos(at)
        ends.append(transit_coefficient_ratio(here, latitude=at, to_latitude=latitude))
    factor = 0.5 * (ends[0] + ends[1])
    spread = 0.5 * abs(ends[1] - ends[0]) / math.sqrt(3.0)
    return Estimate(own * factor, math.hypot(sigma * factor, own * spread))


def _bent(found: ClosedTransit, period: float) -> float:
    """By how much the linear form is too large, relative: (pi dt / 2 T2)^2 / 6."""
    return (0.5 * math.pi * found.difference.value / period) ** 2 / 6.0


def _zeros(session: OrientationSession) -> bool:
    return reduce_tape_zero(session.book, []) is not None


def _warnings(session: OrientationSession) -> tuple[ResultWarning, ...]:
    text = said("session {id}: too few readings to judge by: sigma is the card's", id=session.id)
    warnings = [ResultWarning("sigma_from_card", text)]
    if _zeros(session):
        text = said(
            "session {id}: the tape zero is known, but neither torsion ratio and scale "
            "value nor a correction: gyro north is not corrected",
            id=session.id,
        )
        warnings.append(ResultWarning("tape_zero_correction_unknown", text))
    else:
        text = said("session {id}: no tape zero was observed", id=session.id)
        warnings.append(ResultWarning("no_tape_zero", text))
    return tuple(warnings)
