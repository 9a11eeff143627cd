"""Planning: which method, how many points, how long, for a wanted interval at this latitude.

The standard errors are those of the estimators that the reduction uses (physics.md 2.1 to 2.4),
with the card's reading sigmas and its values carried to the latitude; the 95 % interval has the
t quantile of the degrees of freedom that the observation will have.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from surveyapp.core.geodesy import grid_of, position_of
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.swing.card_physics import CardAt, card_at
from surveyapp.core.swing.gyrofit import LEAST_SQUARES_FROM, fit_damped_swing
from surveyapp.core.swing.swingfit import ClampedSwing, fit_clamped, passage_times
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Project
from surveyapp_models.angles import RHO_ARCSEC

TAPE_ZERO_POINTS = 5
TAPE_ZERO_NORM = 0.5 / math.sqrt(2.0)
"""Two zeros of five points each: se .500 of one reading (physics.md 2.1), and their mean."""
RUN_UP_MINUTES = 3.0
PRE_ORIENTATION_PERIODS = 1.0
"""physics.md 2.6 and 2.8: run-up 2-3 minutes, pre-orientation one half to one period."""
SIGHT_MINUTES = 4.0
DAMPING, AMPLITUDE_DIV = 0.01, 7.0


@dataclass(frozen=True, slots=True)
class PlannedMethod:
    """One way to observe.

    Parameters
    ----------
    method : str
    points : int
        Turning points, or timed passages.
    sigma, interval95 : float
        Of gyro north [rad].
    minutes : float or None
        From run-up to the last sight; None where nothing tells.
    enough : bool
        Whether the interval is met.
    """

    method: str
    points: int
    sigma: float
    interval95: float
    minutes: float | None
    enough: bool

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "method": self.method,
            "points": self.points,
            "sigma_arcsec": self.sigma * RHO_ARCSEC,
            "interval95_arcsec": self.interval95 * RHO_ARCSEC,
            "minutes": self.minutes,
            "enough": self.enough,
        }


def plan_methods(
    card: InstrumentCard, *, latitude: float | None, wanted: float, most_points: int = 20
) -> tuple[PlannedMethod, ...]:
    """The shortest observation of each method that meets a wanted 95 % interval.

    Parameters
    ----------
    card : InstrumentCard
    latitude : float or None
        [rad]; None: the card's own.
    wanted : float
        Half-width of the 95 % interval of gyro north [rad].
    most_points : int
        No plan goes beyond this number; the longest is then given with ``enough`` False.

    Returns
    -------
    tuple of PlannedMethod
        Shortest first; a method whose sigmas or constants the card does not know is absent.
    """
    here = card_at(card, latitude)
    plans = [
        _first_enough(name, candidates, wanted)
        for name, candidates in (
            ("tracking", _tracking(card, here, most_points)),
            ("amplitude", _amplitude(card, here, most_points)),
            ("transit", _transit(card, here, most_points)),
        )
        if candidates
    ]
    if card.kind == "automatic" and card.sigma.azimuth is not None:
        plans.append(_automatic(card.sigma.azimuth, wanted, most_points))
    return tuple(sorted(plans, key=lambda item: (not item.enough, item.minutes or 0.0)))


@dataclass(frozen=True, slots=True)
class _Candidate:
    points: int
    sigma: float
    dof: float
    minutes: float


def _first_enough(name: str, candidates: list[_Candidate], wanted: float) -> PlannedMethod:
    chosen = candidates[-1]
    for item in candidates:
        if student_quantile(0.975, item.dof) * item.sigma <= wanted:
            chosen = item
            break
    interval = student_quantile(0.975, chosen.dof) * chosen.sigma
    return PlannedMethod(
        name, chosen.points, chosen.sigma, interval, chosen.minutes, interval <= wanted
    )


def _overhead(here: CardAt, period: float) -> float:
    """Minutes around the swing: run-up, pre-orientation, two tape zeros, sights twice."""
    unspun = here.unspun_s.value if here.unspun_s is not None else 0.35 * period
    zeros = 2.0 * 0.5 * (TAPE_ZERO_POINTS - 1) * unspun
    return RUN_UP_MINUTES + 2.0 * SIGHT_MINUTES + (zeros + PRE_ORIENTATION_PERIODS * period) / 60.0


def _tape_zero_sigma(card: InstrumentCard, here: CardAt) -> float:
    if here.torsion_ratio is None or card.scale_value is None:
        return 0.0
    spread = card.sigma.scale_div or 0.0
    return here.torsion_ratio.value * abs(card.scale_value) * spread * TAPE_ZERO_NORM


def _combined(own: float, dof: float, zero: float) -> tuple[float, float]:
    """Sigma and Welch-Satterthwaite degrees of freedom of swing and tape zero together."""
    variance = own * own + zero * zero
    return math.sqrt(variance), (variance**2 / (own**4 / dof) if math.isfinite(dof) else math.inf)


def _tracking(card: InstrumentCard, here: CardAt, most: int) -> list[_Candidate]:
    if card.sigma.reversal is None or here.tracking_s is None:
        return []
    return _turning_points(
        card, here, most, here.tracking_s.value, reading=(card.sigma.reversal, 1.0)
    )


def _clamped_scale(card: InstrumentCard, here: CardAt) -> float | None:
    if here.torsion_ratio is None or card.scale_value is None or here.clamped_s is None:
        return None
    return (1.0 + here.torsion_ratio.value) * abs(card.scale_value)


def _amplitude(card: InstrumentCard, here: CardAt, most: int) -> list[_Candidate]:
    scale = _clamped_scale(card, here)
    if scale is None or card.sigma.scale_div is None or here.clamped_s is None:
        return []
    return _turning_points(
        card, here, most, here.clamped_s.value, reading=(card.sigma.scale_div, scale)
    )


def _turning_points(
    card: InstrumentCard, here: CardAt, most: int, period: float, *, reading: tuple[float, float]
) -> list[_Candidate]:
    """Turning points alone; ``reading``: sigma of one, and what one unit of it is in north."""
    spread, scale = reading
    zero, found = _tape_zero_sigma(card, here), []
    for points in range(LEAST_SQUARES_FROM, most + 1):
        index = np.arange(float(points))
        sides = np.where(index % 2 == 0, 1.0, -1.0)
        fit = fit_damped_swing(sides * np.exp(-DAMPING * index), index, sides)
        own = math.sqrt(fit.cofactor[0, 0]) * spread * scale
        sigma, dof = _combined(own, points - 3, zero)
        minutes = _overhead(here, period) + 0.5 * (points - 1) * period / 60.0
        found.append(_Candidate(points, sigma, dof, minutes))
    return found


def _transit(card: InstrumentCard, here: CardAt, most: int) -> list[_Candidate]:
    """Passages of the zero with the scale read at every turning point between, fitted together."""
    scale = _clamped_scale(card, here)
    sigmas = card.sigma
    if scale is None or sigmas.scale_div is None or sigmas.time_s is None or here.clamped_s is None:
        return []
    period = here.clamped_s.value
    zero, found = _tape_zero_sigma(card, here), []
    for passages in range(5, most + 1):
        index = np.arange(float(passages + 1))
        sides = np.where(index % 2 == 0, 1.0, -1.0)
        readings = AMPLITUDE_DIV * sides * np.exp(-DAMPING * index)
        nothing = np.zeros(passages)
        after = np.arange(float(passages))
        empty = ClampedSwing(
            readings, index, sides, nothing, nothing, after, sigmas.scale_div, sigmas.time_s
        )
        truth = np.array([0.0, AMPLITUDE_DIV, DAMPING, 0.0, period])
        times, _ = passage_times(empty, truth)
        swing = ClampedSwing(
            readings, index, sides, times, nothing, after, sigmas.scale_div, sigmas.time_s
        )
        fit = fit_clamped(swing, period_s=period)
        sigma, dof = _combined(math.sqrt(fit.cofactor_middle) * scale, fit.dof, zero)
        minutes = _overhead(here, period) + 0.5 * passages * period / 60.0
        found.append(_Candidate(passages, sigma, dof, minutes))
    return found


def _automatic(sigma: float, wanted: float, most: int) -> PlannedMethod:
    """Rounds of an automatic gyro; how long one takes the card does not say."""
    quantile = student_quantile(0.975, math.inf)
    rounds = min(max(1, math.ceil((quantile * sigma / wanted) ** 2)), most)
    own = sigma / math.sqrt(rounds)
    return PlannedMethod("automatic", rounds, own, quantile * own, None, quantile * own <= wanted)


@dataclass(frozen=True, slots=True)
class StationPlan:
    """Plans for one station and instrument."""

    station: str
    instrument: str
    latitude_deg: float | None
    methods: tuple[PlannedMethod, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "station": self.station,
            "instrument": self.instrument,
            "latitude_deg": self.latitude_deg,
            "methods": [method.to_dict() for method in self.methods],
        }


def plan_stations(
    project: Project, names: Sequence[str], *, wanted: float
) -> tuple[StationPlan, ...]:
    """Plan every instrument of a project at the named stations, interval [rad]."""
    grid = grid_of(project)
    plans = []
    for name in names:
        latitude = position_of(project.station(name), grid).latitude
        degrees = None if latitude is None else math.degrees(latitude)
        plans += [
            StationPlan(
                name,
                instrument.id,
                degrees,
                plan_methods(instrument.card, latitude=latitude, wanted=wanted),
            )
            for instrument in project.instruments
        ]
    return tuple(plans)
