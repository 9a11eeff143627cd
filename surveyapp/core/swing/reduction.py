"""What every method of observation has in common: the outcome of one session's swing.

A method (tracking, amplitude, transit, automatic) turns the rows of a field book into one
``Reduction``; sights, constant and grid come afterwards and know no method.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from surveyapp.core.book.resolution import rounding_sigma
from surveyapp.core.swing.goodness import FitTest
from surveyapp.core.swing.tape_zero import MIN_POINTS_FOR_RESIDUALS, TapeZero, TapeZeroCoefficient
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import Reading
from surveyapp.domain.results import PointResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class UnitScatter:
    """What the residuals of one run tell of one of its readings.

    Parameters
    ----------
    source : str
        Name of the error source that it enters.
    sigma : float
        Of unit weight, in the unit of that source.
    dof : float
    """

    source: str
    sigma: float
    dof: float


@dataclass(frozen=True, slots=True)
class Reduction:
    """Gyro north (or the delivered gyro azimuth) of one session.

    Parameters
    ----------
    estimator : str
    north : Uncertain or None
        Circle reading of gyro north, tape-zero correction applied [rad].
    azimuth : Uncertain or None
        Delivered gyro azimuth of an automatic gyro [rad].
    points_used, dof : int
    sigma_source : str or None
        ``residuals`` or ``card``; None where nothing tells.
    reading_sigma : float or None
        Standard deviation of one reading in force [rad] (for scale methods [div]).
    residual_rms : float or None
        sqrt(v'v / n) [rad].
    amplitude : float or None
        At the first turning point [rad].
    damping_ratio, period_s : float or None
    tape_zero : TapeZero or None
    coefficient : TapeZeroCoefficient or None
    tape_zero_correction : float or None
        [rad]; 0 where there is no tape zero, None where its effect cannot be known.
    tests : tuple of FitTest
    points : tuple of PointResult
    schuler_means : tuple of float
        [rad] (scale methods: none).
    quantities : tuple of (name, value, unit)
        Further results worth showing.
    warnings : tuple of ResultWarning
    unit : UnitScatter or None
        None where the sigma is not from residuals.
    """

    estimator: str
    north: Uncertain | None = None
    azimuth: Uncertain | None = None
    points_used: int = 0
    dof: int = 0
    sigma_source: str | None = None
    reading_sigma: float | None = None
    residual_rms: float | None = None
    amplitude: float | None = None
    damping_ratio: float | None = None
    period_s: float | None = None
    tape_zero: TapeZero | None = None
    coefficient: TapeZeroCoefficient | None = None
    tape_zero_correction: float | None = 0.0
    tests: tuple[FitTest, ...] = ()
    points: tuple[PointResult, ...] = ()
    schuler_means: tuple[float, ...] = ()
    quantities: tuple[tuple[str, float, str], ...] = ()
    warnings: tuple[ResultWarning, ...] = field(default=())
    unit: UnitScatter | None = None


@dataclass(frozen=True, slots=True)
class ReadingSigma:
    """Standard deviation of one reading and where it comes from.

    Parameters
    ----------
    value : float
        Infinite where neither residuals nor card tell.
    dof : float
    origin : str or None
        ``residuals``, ``card`` or None.
    """

    value: float
    dof: float
    origin: str | None


def reading_sigma(
    *,
    count: int,
    variance: float | None,
    dof: int,
    card_sigma: float | None,
    resolution: float,
) -> ReadingSigma:
    """Choose the standard deviation of one reading.

    From five readings on the residuals speak, with their degrees of freedom, but never below what
    rounding alone makes; below five the card does; where it is silent, the residuals with what
    little redundancy they have; where there is none, nothing does.
    """
    if (
        variance is not None
        and dof > 0
        and (count >= MIN_POINTS_FOR_RESIDUALS or card_sigma is None)
    ):
        floor = rounding_sigma(resolution)
        sigma = math.sqrt(variance)
        return ReadingSigma(max(sigma, floor), float(dof), "residuals")
    if card_sigma is not None:
        return ReadingSigma(card_sigma, math.inf, "card")
    return ReadingSigma(math.inf, math.inf, None)


def unit_scatter(source: str, sigma: ReadingSigma) -> UnitScatter | None:
    """Scatter of one reading where the residuals tell it."""
    return UnitScatter(source, sigma.value, sigma.dof) if sigma.origin == "residuals" else None


def point_results(
    rows: Sequence[Reading],
    *,
    index: Floats,
    sides: Floats,
    observed: Sequence[float],
    fitted: Sequence[float | None],
    residuals: Sequence[float | None],
) -> tuple[PointResult, ...]:
    """Turning points beside their fit, for the record."""
    return tuple(
        PointResult(
            seq=row.seq,
            index=int(k),
            side="R" if side > 0 else "L",
            observed=value,
            fitted=fit,
            residual=residual,
            elapsed_s=row.elapsed_s,
        )
        for row, k, side, value, fit, residual in zip(
            rows, index.tolist(), sides.tolist(), observed, fitted, residuals, strict=True
        )
    )


def need_points(session: OrientationSession, *, found: int, needed: int, kind: str) -> None:
    """Refuse a session with too few readings of the kind that its method lives on."""
    if found >= needed:
        return
    raise SurveyError(
        Problem(
            what=said(
                "too few {kind} rows for the method {method}", kind=kind, method=session.method
            ),
            where=said("session {id}, {book_path}", id=session.id, book_path=session.book_path),
            found=said("{found} {kind} rows that count", found=found, kind=kind),
            expected=said("at least {needed}", needed=needed),
            hint="Observe more, or correct the session's method.",
        )
    )


def tape_zero_parts(
    session: OrientationSession,
    zero: TapeZero,
    coefficient: TapeZeroCoefficient,
    *,
    scale_sigma: float | None,
    scale_resolution: float,
    limit_div: float | None = None,
) -> Uncertain:
    """The tape-zero correction -lambda mu d with its error [rad].

    ``limit_div`` is the card's limit of a tape zero, for how far a change can be a drift.
    """
    correction = Uncertain(coefficient.value * zero.value_div)
    for name, rest, factor in (
        ("before", zero.before, zero.factor_before),
        ("after", zero.after, zero.factor_after),
    ):
        if rest is None:
            continue
        sigma = reading_sigma(
            count=rest.points,
            variance=rest.scale_variance,
            dof=rest.dof,
            card_sigma=scale_sigma,
            resolution=scale_resolution,
        )
        value = sigma.value if math.isfinite(sigma.value) else rounding_sigma(scale_resolution)
        source = Source(said("tape zero"), session.id, sigma.dof, name)
        correction = correction.with_part(
            source, coefficient.value * factor * rest.weight_norm * value
        )
    change = zero.unexplained_change_div(limit_div)
    if change > 0.0:
        source = Source(said("tape zero change"), session.id)
        correction = correction.with_part(source, coefficient.value * change)
    if coefficient.sigma > 0.0:
        source = Source(said("torsion ratio"), session.instrument)
        sign = -1.0 if coefficient.value < 0.0 else 1.0
        correction = correction.with_part(source, sign * coefficient.sigma * zero.value_div)
    return correction
