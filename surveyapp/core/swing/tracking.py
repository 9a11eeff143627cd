"""The reversal-point method: turning points of a tracked swing to gyro north.

Source: physics.md 1.4 (tracking: N = N_obs - lambda mu d) and 2.1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.core.book.resolution import reading_resolution
from surveyapp.core.swing.goodness import FitTest, Judge, goodness_of_fit
from surveyapp.core.swing.gyrofit import (
    LEAST_SQUARES_FROM,
    DampedFit,
    SwingMiddle,
    fitted_middle,
    schuler_means,
    schuler_middle,
)
from surveyapp.core.swing.levelling import tilt_change_across_north
from surveyapp.core.swing.preorientation import pre_orientation
from surveyapp.core.swing.reduction import (
    ReadingSigma,
    Reduction,
    point_results,
    reading_sigma,
    tape_zero_parts,
    unit_scatter,
)
from surveyapp.core.swing.run_model import ModelledNorth, RunModel, ShownModel, shown_model
from surveyapp.core.swing.run_points import (
    RunPoints,
    damped_fit,
    no_fit,
    period_from_times,
    turning_points,
    without_tape_drift,
    without_twist,
)
from surveyapp.core.swing.sights import TripodTwist
from surveyapp.core.swing.tape_zero import (
    TapeZero,
    TapeZeroCoefficient,
    reduce_tape_zero,
    tape_zero_coefficient,
    with_levels,
    with_tilt,
)
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import Reading, ReadingKind
from surveyapp.domain.results import PointResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, wrap_pi, wrap_two_pi
from surveyapp_models.arrays import Floats

LARGEST_READING_SIGMA = 60.0 * ARCSEC
"""Of one turning point where the card states none: the coarsest circles are read to 20" to 30", and
a follow-up lag of one minute is a fault. A bound of reason."""


def reduce_tracking(
    session: OrientationSession,
    card: InstrumentCard,
    judge: Judge,
    *,
    latitude: float | None,
    estimator: str | None,
    run_model: RunModel | None = None,
    twist: TripodTwist | None = None,
) -> Reduction:
    """Reduce one session of turning points.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
    judge : Judge
        Of the tests of fit.
    latitude : float or None
        [rad].
    estimator : str or None
        ``least-squares`` or ``schuler``; None chooses least squares from six points on.
    run_model : callable or None
        Estimates a run with adopted effects.
    twist : TripodTwist or None
        Turning of the tripod that the sights tell: taken out of the turning points.

    Raises
    ------
    SurveyError
        If there are fewer than three turning points, or no three consecutive ones for Schuler, or
        if the damped fit does not converge.
    """
    if len(session.book.of_kind(ReadingKind.REVERSAL)) == 2 and estimator is None:
        return pre_orientation(session, card)
    points = turning_points(session)
    zero, coefficient, correction, warnings = tape_zero_of(session, card, points.rows, latitude)
    points = without_twist(without_tape_drift(points, zero, coefficient), twist)
    fit = damped_fit(session, points)
    modelled = None
    if session.effects and run_model is not None:
        modelled = run_model(session, card, latitude, twist)
    shown = shown_model(fit, points.index, points.sides, modelled)
    means, _ = schuler_means(points.values, points.index)
    chosen, middle = _middle(session, points, fit, estimator)
    sigma = reading_sigma(
        count=points.values.size,
        variance=shown.variance,
        dof=shown.dof,
        card_sigma=card.sigma.reversal,
        resolution=points.resolution,
    )
    north = _north(session, points, middle, sigma)
    if modelled is not None:
        chosen = said(
            "least-squares with {join}", join=", ".join(effect.id for effect in session.effects)
        )
        north = _modelled_north(session, points, middle, modelled)
    return Reduction(
        estimator=chosen,
        north=north if correction is None else north + correction,
        points_used=points.values.size,
        dof=shown.dof,
        sigma_source=sigma.origin,
        reading_sigma=sigma.value if math.isfinite(sigma.value) else None,
        residual_rms=shown.residual_rms,
        amplitude=shown.amplitude,
        damping_ratio=shown.damping_ratio,
        period_s=period_from_times(points.rows, points.index),
        tape_zero=zero,
        coefficient=coefficient,
        tape_zero_correction=_correction_value(zero, correction),
        tests=_tests(points, shown, judge, card),
        points=_point_results(points, shown.residuals),
        schuler_means=tuple(wrap_two_pi(points.origin + mean) for mean in means.tolist()),
        warnings=(*warnings, *_sigma_warnings(session, sigma)),
        unit=None if session.effects else unit_scatter("turning points", sigma),
    )


def _middle(
    session: OrientationSession, points: RunPoints, fit: DampedFit, estimator: str | None
) -> tuple[str, SwingMiddle]:
    """The estimator and its middle; without three consecutive points the default is the fit."""
    chosen = estimator or (
        "least-squares" if points.values.size >= LEAST_SQUARES_FROM else "schuler"
    )
    if chosen == "schuler":
        means = schuler_middle(fit, points.values, index=points.index, sides=points.sides)
        if means is not None:
            return chosen, means
        if estimator is not None:
            raise SurveyError(_no_triple(session))
    if not fit.converged:
        raise SurveyError(no_fit(session, points))
    return "least-squares", fitted_middle(fit)


def _north(
    session: OrientationSession, points: RunPoints, middle: SwingMiddle, sigma: ReadingSigma
) -> Uncertain:
    return Uncertain(
        points.origin + middle.value,
        {
            Source("turning points", session.id, sigma.dof): middle.weight_norm * sigma.value,
            Source("damping", session.id): middle.damping_left,
        },
    )


def _modelled_north(
    session: OrientationSession, points: RunPoints, middle: SwingMiddle, modelled: ModelledNorth
) -> Uncertain:
    """North of the model with adopted effects, on the turn of the circle where the swing stands."""
    shift = wrap_pi(modelled.value - points.origin - middle.value)
    return Uncertain(
        points.origin + middle.value + shift,
        {Source("turning points", session.id, modelled.dof): modelled.sigma},
    )


def _no_triple(session: OrientationSession) -> Problem:
    return Problem(
        what="no three consecutive turning points: there is no Schuler mean",
        where=said("session {id}, {book_path}", id=session.id, book_path=session.book_path),
        expected="three turning points without a missed one between",
        hint="Use the estimator least-squares: it bridges missed points.",
    )


def tape_zero_of(
    session: OrientationSession,
    card: InstrumentCard,
    swing: Sequence[Reading],
    latitude: float | None,
) -> tuple[TapeZero | None, TapeZeroCoefficient | None, Uncertain | None, list[ResultWarning]]:
    """Tape zero at a latitude [rad], its coefficient, the correction with its error, warnings."""
    zero = reduce_tape_zero(session.book, swing)
    coefficient = tape_zero_coefficient(card, latitude)
    if zero is None:
        text = said("session {id}: no tape zero was observed", id=session.id)
        if coefficient is not None and card.tape_zero.limit_div is not None:
            worst = abs(coefficient.value) * card.tape_zero.limit_div * RHO_ARCSEC
            text += said(
                "; at the card's limit of {limit_div:g} div it moves north by ",
                limit_div=card.tape_zero.limit_div,
            )
            text += f'{worst:.0f}"'
        return None, coefficient, None, [ResultWarning("no_tape_zero", text)]
    zero = with_levels(zero, session.book, card)
    zero = with_tilt(zero, tilt_change_across_north(session, _mean_direction(swing)), card)
    warnings = []
    if zero.interpolation == "single":
        text = said("session {id}: tape zero observed on one side of the run only", id=session.id)
        warnings.append(ResultWarning("tape_zero_one_sided", text))
    if coefficient is None:
        text = said(
            "session {id}: the tape zero of {value_div:+.3f} div is known, but the "
            "card states neither torsion ratio and scale value nor a correction: gyro "
            "north is not corrected",
            id=session.id,
            value_div=zero.value_div,
        )
        return zero, None, None, [*warnings, ResultWarning("tape_zero_correction_unknown", text)]
    rows = session.book.of_kind(ReadingKind.TAPE_ZERO)
    correction = tape_zero_parts(
        session,
        zero,
        coefficient,
        scale_sigma=card.sigma.scale_div,
        scale_resolution=reading_resolution(rows),
        limit_div=card.tape_zero.limit_div,
    )
    return zero, coefficient, correction, warnings


def _mean_direction(swing: Sequence[Reading]) -> float:
    """Middle of the turning points, near enough for what a tilt across it is [rad]."""
    values = [row.value for row in swing if row.value is not None]
    sine, cosine = (math.fsum(f(v) for v in values) for f in (math.sin, math.cos))
    return math.atan2(sine, cosine)


def _correction_value(zero: TapeZero | None, correction: Uncertain | None) -> float | None:
    if correction is not None:
        return correction.value
    return 0.0 if zero is None else None


def _tests(
    points: RunPoints, shown: ShownModel, judge: Judge, card: InstrumentCard
) -> tuple[FitTest, ...]:
    return goodness_of_fit(
        shown.residuals,
        shown.design,
        judge,
        sigma=card.sigma.reversal,
        resolution=points.resolution,
        readings=points.values,
        bound=LARGEST_READING_SIGMA,
    )


def _point_results(points: RunPoints, found: Floats) -> tuple[PointResult, ...]:
    observed = [row.value or 0.0 for row in points.rows]
    residuals = found.tolist()
    return point_results(
        points.rows,
        index=points.index,
        sides=points.sides,
        observed=observed,
        fitted=[wrap_two_pi(x - v) for x, v in zip(observed, residuals, strict=True)],
        residuals=residuals,
    )


def _sigma_warnings(session: OrientationSession, sigma: ReadingSigma) -> list[ResultWarning]:
    if sigma.origin == "card":
        text = said(
            "session {id}: too few turning points to judge by: sigma is the card's", id=session.id
        )
        return [ResultWarning("sigma_from_card", text)]
    if sigma.origin is None:
        text = said("session {id}: neither residuals nor card tell a sigma", id=session.id)
        return [ResultWarning("sigma_unknown", text)]
    return []
