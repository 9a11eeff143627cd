"""Amplitude and transit methods: from a clamped alidade and its swinging scale to gyro north.

N = N' + (1 + lambda) mu B - lambda mu d, with N' the circle reading of the clamped alidade, B the
middle of the swing on the scale, d the tape zero, mu the scale value, lambda the torsion ratio at
the station's latitude (physics.md 1.4). How B is found stands in ``clamped_middle``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.book.resolution import reading_resolution
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.clamped import Observed, clamp_reading, observe, session_problem
from surveyapp.core.swing.clamped_middle import Middle, middle_of
from surveyapp.core.swing.goodness import FitTest, Judge, goodness_of_fit
from surveyapp.core.swing.gyrofit import fit_damped_swing
from surveyapp.core.swing.levelling import tilt_change_across_north
from surveyapp.core.swing.reduction import Reduction, point_results, tape_zero_parts
from surveyapp.core.swing.sights import TripodTwist, moments
from surveyapp.core.swing.swingfit import ClampedFit
from surveyapp.core.swing.tape_zero import (
    TapeZero,
    TapeZeroCoefficient,
    reduce_tape_zero,
    with_levels,
    with_tilt,
)
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.results import PointResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import listed, said
from surveyapp_models.arrays import Floats

LARGEST_SCALE_SIGMA_DIV = 0.3
"""Of one scale reading where the card states none: scales are read to tenths of a division."""
LARGEST_IN_SIGMA = 5.0
"""Of readings and passages by the sigmas that are assumed where the card states none."""


@dataclass(frozen=True, slots=True)
class _Constants:
    """Torsion ratio lambda at the station with its sigma, and scale value mu [rad/div]."""

    ratio: float
    ratio_sigma: float
    scale: float


def reduce_nontracking(
    session: OrientationSession,
    card: InstrumentCard,
    judge: Judge,
    *,
    latitude: float | None,
    estimator: str | None,
    twist: TripodTwist | None = None,
) -> Reduction:
    """Reduce one session with a clamped alidade.

    Parameters
    ----------
    estimator : str or None
        ``amplitude`` (Schuler means of the scale), ``transit`` (arcsine of the time difference),
        ``least-squares`` (all readings and times together); None: least squares where there is
        redundancy for it, else the method's own closed form.
    twist : TripodTwist or None
        Turning of the tripod that the sights tell: the clamped alidade turns with it.

    Raises
    ------
    SurveyError
        If the clamp reading, the times, one side of the swing or the card's scale value or torsion
        ratio is missing, or if the amplitude lies beyond the scale.

    ``latitude`` [rad].
    """
    clamp = clamp_reading(session)
    constants = _constants(session, card, latitude)
    observed = observe(session, card)
    zero = reduce_tape_zero(session.book, [*observed.readings, *observed.passages])
    if zero is not None:
        zero = with_levels(zero, session.book, card)
        zero = with_tilt(zero, tilt_change_across_north(session, clamp[0]), card)
    observed = _at_middle(observed, zero, twist, constants)
    middle = middle_of(session, observed, card, estimator=estimator, latitude=latitude)
    coefficient = TapeZeroCoefficient(
        -constants.ratio * constants.scale, 0.0, "lambda", latitude is not None
    )
    north = _north(session, clamp, middle, zero, constants=constants)
    correction: float | None = 0.0
    if zero is not None:
        part = _tape_zero_part(session, card, zero, coefficient)
        north, correction = north + part, part.value
    swing, fit = observed.swing, middle.fit
    residuals = _residuals(observed, fit)
    return Reduction(
        estimator=middle.estimator,
        north=north,
        points_used=swing.count,
        dof=fit.dof if fit is not None else max(swing.readings.size - 3, 0),
        sigma_source=middle.origin,
        reading_sigma=None,
        residual_rms=_residual_rms(residuals, constants),
        amplitude=0.5 * float(np.ptp(swing.readings)) * abs(constants.scale),
        damping_ratio=None if fit is None else math.exp(-fit.log_decrement),
        period_s=fit.period_s if fit is not None else observed.period_s,
        tape_zero=zero,
        coefficient=coefficient,
        tape_zero_correction=correction,
        tests=_tests(observed, fit, card, judge),
        points=_points(observed, residuals),
        quantities=_quantities(clamp[0], middle, constants),
        warnings=_warnings(session, zero, middle),
        unit=middle.unit,
    )


def _north(
    session: OrientationSession,
    clamp: tuple[float, float],
    middle: Middle,
    zero: TapeZero | None,
    *,
    constants: _Constants,
) -> Uncertain:
    """N' + (1 + lambda) mu B [rad]; the error of lambda counts from the tape zero."""
    reading, reading_sigma = clamp
    scale, factor = constants.scale, 1.0 + constants.ratio
    d = 0.0 if zero is None else zero.value_div
    return Uncertain(
        reading + factor * scale * middle.value_div,
        {
            Source(middle.source, session.id, middle.sigma_dof): factor * scale * middle.sigma_div,
            Source("clamp reading", session.id): reading_sigma,
            Source("torsion ratio", session.instrument): scale
            * (middle.value_div - d)
            * constants.ratio_sigma,
        },
    )


def _tape_zero_part(
    session: OrientationSession,
    card: InstrumentCard,
    zero: TapeZero,
    coefficient: TapeZeroCoefficient,
) -> Uncertain:
    rows = session.book.of_kind(ReadingKind.TAPE_ZERO)
    return tape_zero_parts(
        session,
        zero,
        coefficient,
        scale_sigma=card.sigma.scale_div,
        scale_resolution=reading_resolution(rows),
        limit_div=card.tape_zero.limit_div,
    )


def _quantities(
    clamp: float, middle: Middle, constants: _Constants
) -> tuple[tuple[str, float, str], ...]:
    return (
        (said("clamp reading"), math.degrees(clamp), "deg"),
        (said("middle of the swing"), middle.value_div, "div"),
        (said("sigma of the middle"), middle.sigma_div, "div"),
        (said("torsion ratio"), constants.ratio, ""),
        *middle.quantities,
    )


def _warnings(
    session: OrientationSession, zero: TapeZero | None, middle: Middle
) -> tuple[ResultWarning, ...]:
    warnings = []
    if zero is None:
        text = said("session {id}: no tape zero was observed", id=session.id)
        warnings.append(ResultWarning("no_tape_zero", text))
    if middle.origin == "card":
        text = said(
            "session {id}: too few readings to judge by: sigma is the card's", id=session.id
        )
        warnings.append(ResultWarning("sigma_from_card", text))
    return tuple(warnings)


def _at_middle(
    observed: Observed,
    zero: TapeZero | None,
    twist: TripodTwist | None,
    constants: _Constants,
) -> Observed:
    """Refer readings and passages to the tape zero and the tripod at the middle of the run.

    The middle of a clamped swing follows the tape zero by lambda / (1 + lambda); of a tripod that
    turns the alidade away it shows 1 / (1 + lambda).
    """
    times = moments([*observed.readings, *observed.passages])
    if times is None:
        return observed
    ratio, scale = constants.ratio, constants.scale
    shift = np.zeros(times.size)
    if zero is not None:
        shift += ratio / (1.0 + ratio) * zero.drift_at(times)
    if twist is not None:
        shift += twist.at(times) / ((1.0 + ratio) * scale)
    if not np.any(shift):
        return observed
    count = len(observed.readings)
    swing = replace(
        observed.swing,
        readings=observed.swing.readings - shift[:count],
        divisions=observed.swing.divisions - shift[count:],
    )
    return replace(observed, swing=swing)


def _constants(
    session: OrientationSession, card: InstrumentCard, latitude: float | None
) -> _Constants:
    ratio = card_at(card, latitude).torsion_ratio
    if ratio is None or card.scale_value is None:
        missing = said("the torsion ratio (lambda, or both periods)") if ratio is None else ""
        if card.scale_value is None:
            missing = listed(filter(None, [missing, said("the scale value")]))
        raise session_problem(
            session,
            said(
                "the method {method} needs the torsion ratio and the scale value",
                method=session.method,
            ),
            found=said("card {id} without {missing}", id=card.id, missing=missing),
            expected="scale_value_arcsec, and [torsion] lambda or both periods",
            hint="Give them in the [[instrument]] table, or observe by tracking.",
        )
    return _Constants(ratio.value, ratio.sigma, card.scale_value)


def _residuals(observed: Observed, fit: ClampedFit | None) -> Floats | None:
    """Residuals of the scale readings [div], None where fewer than three make no swing."""
    swing = observed.swing
    if fit is not None:
        return fit.reading_residuals
    if swing.readings.size >= 3:
        return fit_damped_swing(swing.readings, swing.index, swing.sides).residuals
    return None


def _residual_rms(residuals: Floats | None, constants: _Constants) -> float | None:
    if residuals is None:
        return None
    return float(np.sqrt(np.mean(residuals**2))) * (1.0 + constants.ratio) * abs(constants.scale)


def _points(observed: Observed, residuals: Floats | None) -> tuple[PointResult, ...]:
    swing = observed.swing
    readings = swing.readings.tolist()
    left = [None] * len(readings) if residuals is None else residuals.tolist()
    return point_results(
        observed.readings,
        index=swing.index,
        sides=swing.sides,
        observed=readings,
        fitted=[None if v is None else x - v for x, v in zip(readings, left, strict=True)],
        residuals=left,
    )


def _tests(
    observed: Observed, fit: ClampedFit | None, card: InstrumentCard, judge: Judge
) -> tuple[FitTest, ...]:
    swing = observed.swing
    if fit is not None:
        whitened = np.concatenate(
            [
                fit.reading_residuals / swing.sigma_div,
                fit.passage_residuals / swing.sigma_s,
            ]
        )
        known = card.sigma.scale_div is not None and card.sigma.time_s is not None
        return goodness_of_fit(
            whitened,
            fit.jacobian,
            judge,
            sigma=1.0 if known else None,
            resolution=0.0,
            readings=np.concatenate([swing.readings, swing.divisions]),
            bound=LARGEST_IN_SIGMA,
        )
    if swing.readings.size < 4:
        return ()
    own = fit_damped_swing(swing.readings, swing.index, swing.sides)
    return goodness_of_fit(
        own.residuals,
        own.jacobian(swing.index, swing.sides),
        judge,
        sigma=card.sigma.scale_div,
        resolution=reading_resolution(observed.readings),
        readings=swing.readings,
        bound=LARGEST_SCALE_SIGMA_DIV,
    )
