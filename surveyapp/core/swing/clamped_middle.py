"""Middle of a clamped swing on the scale: from its turning points, its passages, or both together.

B of the amplitude method from scale turning points alone; of the transit method from the time
difference of passages, B = v + a sin(pi dt / (2 T2)) (physics.md 1.4, 2.3); of both from the full
fit. What follows for north is the business of ``nontracking``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.book.resolution import reading_resolution, rounding_sigma
from surveyapp.core.swing.card_physics import CardAt, card_at
from surveyapp.core.swing.clamped import LEAST_OF_SCALE, Observed, session_problem, triples_of
from surveyapp.core.swing.gyrofit import (
    LEAST_SQUARES_FROM,
    fit_damped_swing,
    fitted_middle,
    schuler_middle,
)
from surveyapp.core.swing.reduction import UnitScatter, need_points, reading_sigma, unit_scatter
from surveyapp.core.swing.swingfit import ClampedFit, ClampedSwing, fit_clamped
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.gyro.estimates import Estimate

MIN_FULL_FIT = 7
"""Observations from which the full fit (5 unknowns) has two degrees of freedom."""


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
    fit : ClampedFit or None
        The full fit that it comes from.
    quantities : tuple of (name, value, unit)
        Further results worth showing.
    """

    value_div: float
    sigma_div: float
    sigma_dof: float
    origin: str | None
    estimator: str
    source: str
    unit: UnitScatter | None = None
    fit: ClampedFit | None = None
    quantities: tuple[tuple[str, float, str], ...] = ()


def middle_of(
    session: OrientationSession,
    observed: Observed,
    card: InstrumentCard,
    *,
    estimator: str | None,
    latitude: float | None,
) -> Middle:
    """Choose the estimator; the closed transit form is shown beside the full fit.

    Parameters
    ----------
    session : OrientationSession
    observed : Observed
    card : InstrumentCard
    estimator : str or None
        As for ``nontracking.reduce_nontracking``.
    latitude : float or None
        [rad].

    Raises
    ------
    SurveyError
        If there are too few readings or passages for the method, if its period is not known, or if
        the full fit is asked for and does not converge.
    """
    here = card_at(card, latitude)
    period = observed.period_s or (None if here.clamped_s is None else here.clamped_s.value)
    closed = _closed(session, observed, here, period) if session.method == "transit" else None
    if estimator in (None, "least-squares"):
        full = _of_all(session, observed, period, asked=estimator is not None)
        if full is not None:
            return full if closed is None else replace(full, quantities=closed.quantities)
    return closed if closed is not None else _of_scale(session, observed, card, estimator)


def _closed(
    session: OrientationSession, observed: Observed, here: CardAt, period: float | None
) -> Middle:
    """Closed form B = v + a sin(pi dt / (2 T2)) of the transit method (physics.md 1.4, 2.3)."""
    if period is None:
        raise session_problem(
            session,
            "the period of the clamped swing is not known",
            found="neither two passages one period apart nor a card period",
            expected="at least three passages of one division",
            hint="Observe three transits or more.",
        )
    swing = observed.swing
    found = closed_transit(session, observed)
    dt, sigma_t = found.difference.value, found.difference.sigma
    amplitude, sigma_a = found.amplitude.value, found.amplitude.sigma
    phase = 0.5 * math.pi * dt / period
    value = found.division + amplitude * math.sin(phase)
    by_dt = amplitude * math.cos(phase) * 0.5 * math.pi / period
    linear = float(swing.divisions.mean()) + amplitude * 0.5 * math.pi * dt / period
    return Middle(
        value_div=value,
        sigma_div=math.hypot(math.sin(phase) * sigma_a, by_dt * sigma_t),
        sigma_dof=math.inf,
        origin="card",
        estimator="transit",
        source="passages",
        quantities=(
            (said("time difference east minus west"), dt, "s"),
            ("amplitude", amplitude, "div"),
            (said("middle by the arcsine form"), value, "div"),
            (said("middle by the linear form"), linear, "div"),
            (said("linear minus arcsine"), linear - value, "div"),
            *_by_transit_constant(here, amplitude, dt),
        ),
    )


@dataclass(frozen=True, slots=True)
class ClosedTransit:
    """What the closed forms of the transit method are made of.

    Parameters
    ----------
    difference : Estimate
        Time east minus time west [s].
    amplitude : Estimate
        [div].
    division : float
        Of the passages, the drift of the tape zero taken out [div].
    """

    difference: Estimate
    amplitude: Estimate
    division: float


def closed_transit(session: OrientationSession, observed: Observed) -> ClosedTransit:
    """Time difference and amplitude of a session.

    Raises
    ------
    SurveyError
        If there are no three consecutive passages of one division.
    """
    swing = observed.swing
    usable = _passages_of_one_line(session, observed)
    weights = _difference_weights(session, swing, swing.after[usable])
    times = swing.passages_s[usable]
    amplitude, sigma_a = _amplitude(swing)
    return ClosedTransit(
        Estimate(
            float(weights @ (times - times[0])),
            swing.sigma_s * float(np.sqrt(weights @ weights)),
        ),
        Estimate(amplitude, sigma_a),
        float(swing.divisions[usable].mean()),
    )


def _passages_of_one_line(session: OrientationSession, observed: Observed) -> NDArray[np.intp]:
    """Places of the passages of the division that was timed first."""
    need_points(session, found=observed.swing.divisions.size, needed=3, kind="transit")
    written = np.array([row.value for row in observed.passages], dtype=np.float64)
    usable = np.flatnonzero(written == written[0])
    need_points(session, found=usable.size, needed=3, kind="transit (of one division)")
    return usable


def _difference_weights(session: OrientationSession, swing: ClampedSwing, after: Floats) -> Floats:
    """Weights of the passages in the mean time difference, east minus west."""
    parity = 1.0 if int(swing.index[0]) % 2 == 0 else -1.0
    weights = np.zeros(after.size)
    triples = triples_of(after.tolist())
    for i in triples:
        # between passages i and i+1 the swing is on the side of the turning point after[i] + 1
        side = float(swing.sides[0]) * parity * (1.0 if int(after[i] + 1) % 2 == 0 else -1.0)
        weights[i : i + 3] += side * np.array([-1.0, 2.0, -1.0])
    need_points(session, found=3 if triples else 0, needed=3, kind="transit (consecutive)")
    weights /= len(triples)
    return weights


def _amplitude(swing: ClampedSwing) -> tuple[float, float]:
    """Half the distance of the two sides [div], and its sigma."""
    right, left = swing.readings[swing.sides > 0], swing.readings[swing.sides < 0]
    sigma = 0.5 * swing.sigma_div * math.sqrt(1.0 / right.size + 1.0 / left.size)
    return 0.5 * float(right.mean() - left.mean()), sigma


def _by_transit_constant(
    here: CardAt, amplitude: float, dt: float
) -> tuple[tuple[str, float, str], ...]:
    if here.transit_c is None:
        return ()
    product = here.transit_c.value * amplitude * dt * RHO_ARCSEC
    return ((said("linear form C a dt"), product, "arcsec"),)


def _of_scale(
    session: OrientationSession, observed: Observed, card: InstrumentCard, estimator: str | None
) -> Middle:
    """Middle from scale turning points alone: Schuler means, or the damped fit."""
    swing = observed.swing
    values, index, sides = swing.readings, swing.index, swing.sides
    if estimator is None:
        estimator = "least-squares" if values.size >= LEAST_SQUARES_FROM else "amplitude"
    need_points(
        session, found=values.size, needed=LEAST_OF_SCALE["amplitude"], kind="scale_reversal"
    )
    fit = fit_damped_swing(values, index, sides)
    sigma = reading_sigma(
        count=values.size,
        variance=fit.variance,
        dof=fit.dof,
        card_sigma=card.sigma.scale_div,
        resolution=reading_resolution(observed.readings),
    )
    means = None
    if estimator == "amplitude":
        means = schuler_middle(fit, values, index=index, sides=sides)
    middle = fitted_middle(fit) if means is None else means
    source = said("scale readings")
    return Middle(
        value_div=middle.value,
        sigma_div=math.hypot(middle.weight_norm * sigma.value, middle.damping_left),
        sigma_dof=sigma.dof,
        origin=sigma.origin,
        estimator="least-squares" if means is None else "amplitude",
        source=source,
        unit=unit_scatter(source, sigma),
    )


def _of_all(
    session: OrientationSession, observed: Observed, period: float | None, *, asked: bool
) -> Middle | None:
    """Middle from the full fit, None where it is not possible; refused if it was asked for."""
    swing = observed.swing
    if not swing.passages_s.size or period is None or swing.count < MIN_FULL_FIT:
        return None
    fit = fit_clamped(swing, period_s=period)
    if fit.converged:
        return _of_fit(observed, fit)
    if not asked:
        return None
    raise session_problem(
        session,
        "the full fit of readings and times does not converge",
        found=said("{number} observations that make no damped swing", number=swing.count),
        expected="turning points and passages of one swing",
        hint="Look for a passage on the wrong side of a turning point.",
    )


def _of_fit(observed: Observed, fit: ClampedFit) -> Middle:
    """Middle of a full fit: its residuals tell the unit where they can, not below the rounding."""
    unit, origin, dof = 1.0, "card", math.inf
    if fit.unit_variance is not None and fit.dof >= 2:
        floor_div = rounding_sigma(reading_resolution(observed.readings)) / observed.swing.sigma_div
        unit, origin, dof = max(fit.unit_variance, floor_div**2), "residuals", float(fit.dof)
    source = said("scale readings and passages")
    return Middle(
        value_div=fit.middle_div,
        sigma_div=math.sqrt(unit * fit.cofactor_middle),
        sigma_dof=dof,
        origin=origin,
        estimator="least-squares",
        source=source,
        unit=UnitScatter(source, math.sqrt(unit), dof) if origin == "residuals" else None,
        fit=fit,
    )
