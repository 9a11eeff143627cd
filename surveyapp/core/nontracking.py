"""Amplitude and transit methods: a clamped alidade, a swinging scale, and the full fit of both.

N = N' + (1 + lambda) mu B - lambda mu d, with N' the circle reading of the clamped alidade, B the
middle of the swing on the scale, d the tape zero, mu the scale value, lambda the torsion ratio at
the station's latitude (physics.md 1.4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.cardphysics import card_at
from surveyapp.core.clamped import (
    LEAST_OF_SCALE,
    Observed,
    clamp_reading,
    observe,
    session_problem,
    triples_of,
)
from surveyapp.core.goodness import FitTest, Judge, goodness_of_fit
from surveyapp.core.gyrofit import damping_left, design, fit_swing, schuler_means
from surveyapp.core.reduction import (
    Reduction,
    UnitScatter,
    need_points,
    reading_sigma,
    tape_zero_parts,
    unit_scatter,
)
from surveyapp.core.resolution import reading_resolution, rounding_sigma
from surveyapp.core.sights import TripodTwist, moments
from surveyapp.core.swingfit import ClampedFit, fit_clamped
from surveyapp.core.tapezero import TapeZero, TapeZeroCoefficient, reduce_tape_zero, with_levels
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession, ResultWarning
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.results import PointResult
from surveyapp_models.angles import RHO_ARCSEC

Floats = NDArray[np.float64]

MIN_FULL_FIT = 7
"""Observations from which the full fit (5 unknowns) has two degrees of freedom."""
LEAST_SQUARES_FROM = 6


@dataclass(frozen=True, slots=True)
class Middle:
    """Middle of the swing on the scale with its error.

    Parameters
    ----------
    value_div, sigma_div : float
    sigma_dof : float
    origin : str or None
        ``residuals`` or ``card``.
    estimator : str
    source : str
        Name of the error source.
    unit : UnitScatter or None
    """

    value_div: float
    sigma_div: float
    sigma_dof: float
    origin: str | None
    estimator: str
    source: str
    unit: UnitScatter | None = None


def _transit_middle(
    session: OrientationSession, observed: Observed, period: float
) -> tuple[Middle, float, float]:
    """Closed form B = v + a sin(pi dt / (2 T2)), and dt and a (physics.md 1.4, 2.3)."""
    swing = observed.swing
    need_points(session, found=swing.divisions.size, needed=3, kind="transit")
    written = np.array([row.value for row in observed.passages], dtype=np.float64)
    usable = np.flatnonzero(written == written[0])
    need_points(session, found=usable.size, needed=3, kind="transit (of one division)")
    times, after = swing.passages_s[usable], swing.after[usable]
    parity = 1.0 if int(swing.index[0]) % 2 == 0 else -1.0
    weights = np.zeros(times.size)
    triples = triples_of(after.tolist())
    for i in triples:
        # between passages i and i+1 the swing is on the side of the turning point after[i] + 1
        side = float(swing.sides[0]) * parity * (1.0 if int(after[i] + 1) % 2 == 0 else -1.0)
        weights[i : i + 3] += side * np.array([-1.0, 2.0, -1.0])
    need_points(session, found=3 if triples else 0, needed=3, kind="transit (consecutive)")
    weights /= len(triples)
    dt = float(weights @ (times - times[0]))
    right, left = swing.readings[swing.sides > 0], swing.readings[swing.sides < 0]
    amplitude = 0.5 * float(right.mean() - left.mean())
    sigma_a = 0.5 * swing.sigma_div * math.sqrt(1.0 / right.size + 1.0 / left.size)
    phase = 0.5 * math.pi * dt / period
    value = float(swing.divisions[usable].mean()) + amplitude * math.sin(phase)
    sigma_t = swing.sigma_s * float(np.sqrt(weights @ weights))
    by_dt = amplitude * math.cos(phase) * 0.5 * math.pi / period
    sigma = math.hypot(math.sin(phase) * sigma_a, by_dt * sigma_t)
    return Middle(value, sigma, math.inf, "card", "transit", "passages"), dt, amplitude


def _scale_middle(
    session: OrientationSession, observed: Observed, card: InstrumentCard, estimator: str
) -> Middle:
    """Middle from scale turning points alone: Schuler means, or the damped fit."""
    swing = observed.swing
    need_points(
        session,
        found=swing.readings.size,
        needed=LEAST_OF_SCALE["amplitude"],
        kind="scale_reversal",
    )
    fit = fit_swing(swing.readings, swing.index, swing.sides)
    sigma = reading_sigma(
        count=swing.readings.size,
        variance=fit.variance,
        dof=fit.dof,
        card_sigma=card.sigma.scale_div,
        resolution=reading_resolution(observed.readings),
    )
    means, weights = schuler_means(swing.readings, swing.index)
    left = 0.0
    if estimator == "amplitude" and means.size:
        value, norm = float(means.mean()), float(np.sqrt(weights @ weights))
        left = damping_left(fit, weights, index=swing.index, sides=swing.sides)
    else:
        value, norm = fit.north, math.sqrt(fit.cofactor[0, 0])
        estimator = "least-squares"
    source = "scale readings"
    unit = unit_scatter(source, sigma)
    spread = math.hypot(norm * sigma.value, left)
    return Middle(value, spread, sigma.dof, sigma.origin, estimator, source, unit)


def _full_middle(observed: Observed, period: float) -> tuple[Middle, ClampedFit] | None:
    """Middle from the full fit, None where it does not converge."""
    fit = fit_clamped(observed.swing, period_s=period)
    if not fit.converged:
        return None
    unit = 1.0
    origin, dof = "card", math.inf
    if fit.unit_variance is not None and fit.dof >= 2:
        floor_div = rounding_sigma(reading_resolution(observed.readings)) / observed.swing.sigma_div
        unit, origin, dof = max(fit.unit_variance, floor_div**2), "residuals", float(fit.dof)
    source = "scale readings and passages"
    middle = Middle(
        fit.middle_div,
        math.sqrt(unit * fit.cofactor_middle),
        dof,
        origin,
        "least-squares",
        source,
        UnitScatter(source, math.sqrt(unit), dof) if origin == "residuals" else None,
    )
    return middle, fit


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
    """
    clamp, clamp_sigma = clamp_reading(session)
    ratio, ratio_sigma, scale = _constants(session, card, latitude)
    observed = observe(session, card)
    zero = reduce_tape_zero(session.book, [*observed.readings, *observed.passages])
    if zero is not None:
        zero = with_levels(zero, session.book, card)
    observed = _at_middle(observed, zero, twist, ratio=ratio, scale=scale)
    middle, fit, extras = _middle(session, observed, card, estimator, latitude)
    coefficient = TapeZeroCoefficient(-ratio * scale, 0.0, "lambda", latitude is not None)
    d = 0.0 if zero is None else zero.value_div
    north = Uncertain(
        clamp + (1.0 + ratio) * scale * middle.value_div,
        {
            Source(middle.source, session.id, middle.sigma_dof): (1.0 + ratio)
            * scale
            * middle.sigma_div,
            Source("clamp reading", session.id): clamp_sigma,
            Source("torsion ratio", session.instrument): scale
            * (middle.value_div - d)
            * ratio_sigma,
        },
    )
    warnings = []
    correction: float | None = 0.0
    if zero is None:
        text = f"session {session.id}: no tape zero was observed"
        warnings.append(ResultWarning("no_tape_zero", text))
    else:
        rows = session.book.of_kind(ReadingKind.TAPE_ZERO)
        part = tape_zero_parts(
            session,
            zero,
            coefficient,
            scale_sigma=card.sigma.scale_div,
            scale_resolution=reading_resolution(rows),
        )
        north, correction = north + part, part.value
    if middle.origin == "card":
        text = f"session {session.id}: too few readings to judge by: sigma is the card's"
        warnings.append(ResultWarning("sigma_from_card", text))
    residuals, points = _residuals(observed, fit)
    return Reduction(
        estimator=middle.estimator,
        north=north,
        points_used=observed.swing.count,
        dof=fit.dof if fit is not None else max(observed.swing.readings.size - 3, 0),
        sigma_source=middle.origin,
        reading_sigma=None,
        residual_rms=None
        if residuals is None
        else float(np.sqrt(np.mean(residuals**2))) * (1.0 + ratio) * abs(scale),
        amplitude=0.5 * float(np.ptp(observed.swing.readings)) * abs(scale),
        damping_ratio=None if fit is None else math.exp(-fit.log_decrement),
        period_s=fit.period_s if fit is not None else observed.period_s,
        tape_zero=zero,
        coefficient=coefficient,
        tape_zero_correction=correction,
        tests=_tests(observed, fit, card, judge),
        points=points,
        quantities=(
            ("clamp reading", math.degrees(clamp), "deg"),
            ("middle of the swing", middle.value_div, "div"),
            ("sigma of the middle", middle.sigma_div, "div"),
            ("torsion ratio", ratio, ""),
            *extras,
        ),
        warnings=tuple(warnings),
        unit=middle.unit,
    )


def _at_middle(
    observed: Observed,
    zero: TapeZero | None,
    twist: TripodTwist | None,
    *,
    ratio: float,
    scale: float,
) -> Observed:
    """Refer readings and passages to the tape zero and the tripod at the middle of the run.

    The middle of a clamped swing follows the tape zero by lambda / (1 + lambda); of a tripod that
    turns the alidade away it shows 1 / (1 + lambda).
    """
    times = moments([*observed.readings, *observed.passages])
    if times is None:
        return observed
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
) -> tuple[float, float, float]:
    ratio = card_at(card, latitude).torsion_ratio
    if ratio is None or card.scale_value is None:
        missing = "the torsion ratio (lambda, or both periods)" if ratio is None else ""
        if card.scale_value is None:
            missing = " and ".join(filter(None, [missing, "the scale value"]))
        raise session_problem(
            session,
            f"the method {session.method} needs the torsion ratio and the scale value",
            found=f"card {card.id} without {missing}",
            expected="scale_value_arcsec, and [torsion] lambda or both periods",
            hint="Give them in the [[instrument]] table, or observe by tracking.",
        )
    return ratio.value, ratio.sigma, card.scale_value


def _middle(
    session: OrientationSession,
    observed: Observed,
    card: InstrumentCard,
    estimator: str | None,
    latitude: float | None,
) -> tuple[Middle, ClampedFit | None, tuple[tuple[str, float, str], ...]]:
    """Choose the estimator; the closed transit form is shown beside the full fit."""
    here = card_at(card, latitude)
    card_period = None if here.clamped_s is None else here.clamped_s.value
    period = observed.period_s or card_period
    has_passages = observed.swing.passages_s.size > 0
    wants_fit = estimator in (None, "least-squares")
    extras: tuple[tuple[str, float, str], ...] = ()
    closed = None
    if session.method == "transit":
        if period is None:
            raise session_problem(
                session,
                "the period of the clamped swing is not known",
                found="neither two passages one period apart nor a card period",
                expected="at least three passages of one division",
                hint="Observe three transits or more.",
            )
        closed, dt, amplitude = _transit_middle(session, observed, period)
        linear = amplitude * 0.5 * math.pi * dt / period
        origin = float(observed.swing.divisions.mean())
        extras = (
            ("time difference east minus west", dt, "s"),
            ("amplitude", amplitude, "div"),
            ("middle by the arcsine form", closed.value_div, "div"),
            ("middle by the linear form", origin + linear, "div"),
            ("linear minus arcsine", origin + linear - closed.value_div, "div"),
        )
        if here.transit_c is not None:
            product = here.transit_c.value * amplitude * dt * RHO_ARCSEC
            extras = (*extras, ("linear form C a dt", product, "arcsec"))
    if wants_fit and has_passages and period is not None and observed.swing.count >= MIN_FULL_FIT:
        full = _full_middle(observed, period)
        if full is not None:
            return full[0], full[1], extras
        if estimator == "least-squares":
            raise session_problem(
                session,
                "the full fit of readings and times does not converge",
                found=f"{observed.swing.count} observations that make no damped swing",
                expected="turning points and passages of one swing",
                hint="Look for a passage on the wrong side of a turning point.",
            )
    if closed is not None:
        return closed, None, extras
    chosen = estimator or (
        "least-squares" if observed.swing.readings.size >= LEAST_SQUARES_FROM else "amplitude"
    )
    return _scale_middle(session, observed, card, chosen), None, extras


def _residuals(
    observed: Observed, fit: ClampedFit | None
) -> tuple[Floats | None, tuple[PointResult, ...]]:
    swing = observed.swing
    if fit is not None:
        residuals: Floats | None = fit.reading_residuals
    elif swing.readings.size >= 3:
        residuals = fit_swing(swing.readings, swing.index, swing.sides).residuals
    else:
        residuals = None
    values = [None] * swing.readings.size if residuals is None else residuals.tolist()
    points = tuple(
        PointResult(
            seq=row.seq,
            index=int(index),
            side="R" if side > 0 else "L",
            observed=reading,
            fitted=None if residual is None else reading - residual,
            residual=residual,
            elapsed_s=row.elapsed_s,
        )
        for row, index, side, reading, residual in zip(
            observed.readings,
            swing.index.tolist(),
            swing.sides.tolist(),
            swing.readings.tolist(),
            values,
            strict=True,
        )
    )
    return residuals, points


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
            whitened, fit.jacobian, judge, sigma=1.0 if known else None, resolution=0.0
        )
    if swing.readings.size < 4:
        return ()
    own = fit_swing(swing.readings, swing.index, swing.sides)
    jacobian = design(
        swing.index, swing.sides, amplitude=own.amplitude, log_decrement=own.log_decrement
    )
    return goodness_of_fit(
        own.residuals,
        jacobian,
        judge,
        sigma=card.sigma.scale_div,
        resolution=reading_resolution(observed.readings),
    )
