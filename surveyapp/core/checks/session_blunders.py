"""Blunders within one session that its own readings, the card or other sessions can tell.

Rounds that do not belong together, sights of one face that disagree, a collimation that no other
session has, moments and periods that no swing can have, tape zeros that disagree.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.statistics.distributions import (
    chi_square_quantile,
    f_quantile,
    normal_quantile,
    student_quantile,
)
from surveyapp.core.statistics.levels import level_of_one
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.full_swings import full_swings
from surveyapp.core.swing.session import ReducedSession, TargetReduction
from surveyapp.core.swing.tape_zero import MIN_POINTS_FOR_RESIDUALS
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC

ROUND_SIGMA: Final = 60.0 * ARCSEC
"""Of one round of an automatic gyro where its card states none: twice the coarsest card. A bound
of reason."""
POINTING_SIGMA: Final = 20.0 * ARCSEC
"""Of one pointing where nothing else tells: coarse circles. A bound of reason."""
COLLIMATION_CHANGE: Final = 5.0 * ARCSEC
"""By which the collimation of a theodolite changes from set-up to set-up (temperature, transport);
a bound of reason."""
PERIODS_S: Final = (150.0, 1200.0)
"""Full periods of suspended gyros: 6 to 9 minutes in use (physics.md 7), with a margin."""
MOST_APART_PERCENT: Final = 5.0
"""Of two statements of C: further apart, one of them is in another unit (physics.md 1.4)."""
UNEVEN: Final = 0.05
"""Of one full swing against the others: the amplitude term makes 0.002 (physics.md 1.2)."""
TAPE_ZERO_CHANGE_DIV: Final = 0.5
"""Source: Coal Mine Surveying Regulations (China, 1989), article 62: the limit of a tape zero."""
LEAST_OTHERS: Final = 3
"""Degrees of freedom of the other sessions from which they tell of one."""

Items = Sequence[ReducedSession]
_CLAUSE: Final = said("statistical test, level shared over the project")


def session_blunder_checks(orientation: Orientation) -> list[Check]:
    """All of them, for every session."""
    items = orientation.sessions
    checks = [
        *_rounds(orientation, items),
        *_faces(orientation, items),
        *_collimations(orientation, items),
        *_tape_zeros(orientation, items),
    ]
    for item in items:
        checks += _transit_constant(orientation, item)
        checks += _period(item)
        checks += _evenness(item)
    return checks


def _made(
    rule: str,
    item: ReducedSession,
    text: str,
    *,
    value: float,
    limit: float,
    unit: str = "",
    clause: str = _CLAUSE,
    target: str = "",
    passed: bool | None = None,
) -> Check:
    subject = Subject.session(item.session.id, target)
    return Check(
        rule=rule,
        clause=clause,
        value=value,
        limit=limit,
        confirmed=True,
        passed=value <= limit if passed is None else passed,
        unit=unit,
        where=subject.text,
        text=text,
        subject=subject,
    )


def _rounds(orientation: Orientation, items: Items) -> list[Check]:
    """Rounds of an automatic gyro about their mean, against the sigma of one round."""
    tested = [
        item for item in items if item.session.method == "automatic" and item.reduction.dof > 0
    ]
    checks = []
    for item in tested:
        card = orientation.project.instrument(item.session.instrument).card
        rms, dof = item.reduction.residual_rms, item.reduction.dof
        if rms is None:
            continue
        sigma = card.sigma.azimuth if card.sigma.azimuth is not None else ROUND_SIGMA
        quantile = chi_square_quantile(1.0 - level_of_one(len(tested)), dof)
        residuals = [abs(point.residual or 0.0) for point in item.reduction.points]
        worst = item.reduction.points[int(np.argmax(residuals))].seq
        scatter = rms * math.sqrt((dof + 1.0) / dof)
        origin = (
            said("card {id}", id=card.id)
            if card.sigma.azimuth is not None
            else said("no card exceeds it")
        )
        checks.append(
            _made(
                "rounds.scatter",
                item,
                said(
                    '{dof} rounds scatter by {scatter:.1f}" about their mean, one round has '
                    '{sigma:.1f}" ({origin}); furthest off: seq {worst}',
                    dof=dof + 1,
                    scatter=scatter * RHO_ARCSEC,
                    sigma=sigma * RHO_ARCSEC,
                    origin=origin,
                    worst=worst,
                ),
                value=scatter * RHO_ARCSEC,
                limit=sigma * math.sqrt(quantile / dof) * RHO_ARCSEC,
                unit="arcsec",
            )
        )
    return checks


def _sighted(items: Items) -> Iterator[tuple[ReducedSession, TargetReduction]]:
    for item in items:
        for target in item.targets:
            if target.sights is not None:
                yield item, target


def _faces(orientation: Orientation, items: Items) -> list[Check]:
    """Residuals of the sights of one target against those of all others, else against the card."""
    tested = [(i, t) for i, t in _sighted(items) if t.sights is not None and t.sights.dof > 0]
    checks = []
    for item, target in tested:
        sights = target.sights
        assert sights is not None
        others = [
            other.sights
            for one, other in tested
            if one.session.instrument == item.session.instrument and other is not target
        ]
        dof = sum(other.dof for other in others if other is not None)
        squares = math.fsum(other.sum_of_squares for other in others if other is not None)
        card = orientation.project.instrument(item.session.instrument).card
        bound = card.sigma.reversal if card.sigma.reversal is not None else POINTING_SIGMA
        level = level_of_one(len(tested))
        variance = sights.sum_of_squares / sights.dof
        limit = bound * math.sqrt(chi_square_quantile(1.0 - level, sights.dof) / sights.dof)
        told = said('one pointing at most {bound:.1f}"', bound=bound * RHO_ARCSEC)
        if dof >= LEAST_OTHERS and squares > 0.0:
            found = squares / dof
            quantile = f_quantile(level, sights.dof, dof)
            if math.sqrt(found * quantile) < limit:
                limit = math.sqrt(found * quantile)
                told = said('the other sights have {sqrt:.1f}"', sqrt=math.sqrt(found) * RHO_ARCSEC)
        checks.append(
            _made(
                "sights.agree",
                item,
                said(
                    'sights of one face disagree by {sqrt:.1f}" (1 sigma); {told}',
                    sqrt=math.sqrt(variance) * RHO_ARCSEC,
                    told=told,
                ),
                value=math.sqrt(variance) * RHO_ARCSEC,
                limit=limit * RHO_ARCSEC,
                unit="arcsec",
                target=target.target,
            )
        )
    return checks


@dataclass(frozen=True, slots=True)
class _Collimation:
    item: ReducedSession
    target: str
    value: float
    cofactor: float


def _collimations(orientation: Orientation, items: Items) -> list[Check]:
    """Collimation of one set-up against the instrument's others: a wrong sight changes it."""
    by_instrument: dict[str, list[_Collimation]] = {}
    for item, target in _sighted(items):
        sights = target.sights
        if sights is not None and sights.collimation is not None:
            found = _Collimation(
                item, target.target, sights.collimation, sights.collimation_cofactor
            )
            by_instrument.setdefault(item.session.instrument, []).append(found)
    tested = sum(len(found) for found in by_instrument.values() if len(found) > 1)
    checks = []
    for identity, setups in by_instrument.items():
        if len(setups) < 2:
            continue
        card = orientation.project.instrument(identity).card
        pointing = orientation.sight_sigmas[identity]
        bound = card.sigma.reversal if card.sigma.reversal is not None else POINTING_SIGMA
        sigma, dof = pointing.value, pointing.dof
        if dof < LEAST_OTHERS or sigma > bound:
            sigma, dof = bound, math.inf
        quantile = (
            student_quantile(1.0 - 0.5 * level_of_one(tested), dof)
            if dof < math.inf
            else normal_quantile(1.0 - 0.5 * level_of_one(tested))
        )
        for own in setups:
            others = [other.value for other in setups if other is not own]
            middle = float(np.median(others))
            error = sigma * math.sqrt(own.cofactor * (1.0 + 1.6 / len(others)))
            limit = quantile * math.hypot(error, COLLIMATION_CHANGE)
            checks.append(
                _made(
                    "sights.collimation",
                    own.item,
                    said(
                        'collimation {value:+.1f}", in the other set-ups {middle:+.1f}" (median of '
                        "{others})",
                        value=own.value * RHO_ARCSEC,
                        middle=middle * RHO_ARCSEC,
                        others=len(others),
                    ),
                    value=abs(own.value - middle) * RHO_ARCSEC,
                    limit=limit * RHO_ARCSEC,
                    unit="arcsec",
                    target=own.target,
                )
            )
    return checks


def _period(item: ReducedSession) -> list[Check]:
    """A full period that a suspended gyro can have."""
    period = item.reduction.period_s
    if period is None or item.session.method == "automatic":
        return []
    low, high = PERIODS_S
    return [
        _made(
            "period.possible",
            item,
            said(
                "period {period:.1f} s; no suspended gyro swings outside {low:g} to {high:g} s",
                period=period,
                low=low,
                high=high,
            ),
            value=period,
            limit=low if period < low else high,
            unit="s",
            clause=said("physics of the swing"),
            passed=low <= period <= high,
        )
    ]


def _transit_constant(orientation: Orientation, item: ReducedSession) -> list[Check]:
    """A stated C against (pi/2) mu (1 + lambda) / T2 with the period of the session itself."""
    card = orientation.project.instrument(item.session.instrument).card
    if item.session.method != "transit" or card.transit_c is None:
        return []
    here = card_at(card, orientation.positions[item.session.station].latitude)
    ratio, period = here.torsion_ratio, item.reduction.period_s
    if ratio is None or here.transit_c is None or period is None or card.scale_value is None:
        return []
    theory = 0.5 * math.pi * card.scale_value * (1.0 + ratio.value) / period
    apart = here.transit_c.value / theory - 1.0
    return [
        _made(
            "transit.constant",
            item,
            said(
                "C {value:.4g} stated, {theory:.4g} arcsec/(div s) from scale value, "
                "torsion ratio and the period of this session",
                value=here.transit_c.value * RHO_ARCSEC,
                theory=theory * RHO_ARCSEC,
            ),
            value=100.0 * abs(apart),
            limit=MOST_APART_PERCENT,
            unit="%",
            clause=said("C = (pi/2) mu (1 + lambda) / T2"),
        )
    ]


def _evenness(item: ReducedSession) -> list[Check]:
    """Every full swing lasts as long as the others."""
    swing = item.session.book.of_kind(ReadingKind.REVERSAL, ReadingKind.MISSED, ReadingKind.TRANSIT)
    kind = ReadingKind.TRANSIT if item.session.method == "transit" else ReadingKind.REVERSAL
    rows = [row for row in swing if row.kind in (kind, ReadingKind.MISSED)]
    spans = full_swings(rows, kind)
    if item.session.method == "automatic" or len(spans) < 2:
        return []
    lengths = np.array([length for length, _ in spans])
    middle = float(np.median(lengths))
    worst = int(np.argmax(np.abs(lengths - middle)))
    return [
        _made(
            "moments.even",
            item,
            said(
                "full swings of {middle:.1f} s (median); the one that ends at seq {spans} "
                "lasts {lengths:.1f} s",
                middle=middle,
                spans=spans[worst][1],
                lengths=lengths[worst],
            ),
            value=abs(float(lengths[worst]) - middle),
            limit=UNEVEN * abs(middle),
            unit="s",
            clause=said("physics of the swing"),
        )
    ]


def _tape_zeros(orientation: Orientation, items: Items) -> list[Check]:
    """Tape zero after against before, and the readings of each about its own swing."""
    zeros = [(item, item.reduction.tape_zero) for item in items]
    both = [(i, z) for i, z in zeros if z is not None and z.before and z.after]
    swings = [
        (item, name, rest)
        for item, zero in zeros
        if zero is not None
        for name, rest in ((said("before"), zero.before), (said("after"), zero.after))
        if rest is not None and rest.points >= MIN_POINTS_FOR_RESIDUALS and rest.dof > 0
    ]
    checks = []
    for item, zero in both:
        assert zero is not None
        assert zero.before is not None
        assert zero.after is not None
        card = orientation.project.instrument(item.session.instrument).card
        change = zero.after.value_div - zero.before.value_div
        limit = card.tape_zero.limit_div or TAPE_ZERO_CHANGE_DIV
        noise = (card.sigma.scale_div or 0.0) * math.hypot(
            zero.before.weight_norm, zero.after.weight_norm
        )
        checks.append(
            _made(
                "tape_zero.agree",
                item,
                said(
                    "tape zero before {value_div:+.3f} div, after {value_div2:+.3f} div; the "
                    "change is in the sigma of gyro north",
                    value_div=zero.before.value_div,
                    value_div2=zero.after.value_div,
                ),
                value=abs(change),
                limit=limit + normal_quantile(1.0 - 0.5 * level_of_one(len(both))) * noise,
                unit="div",
                clause=said("change of the tape zero during one session"),
            )
        )
    for item, name, rest in swings:
        card = orientation.project.instrument(item.session.instrument).card
        if card.sigma.scale_div is None or rest.scale_variance is None:
            continue
        quantile = chi_square_quantile(1.0 - level_of_one(len(swings)), rest.dof)
        checks.append(
            _made(
                "tape_zero.readings",
                item,
                said(
                    "readings of the tape zero {name} about their damped swing, card "
                    "{scale_div:g} div",
                    name=name,
                    scale_div=card.sigma.scale_div,
                ),
                value=math.sqrt(rest.scale_variance),
                limit=card.sigma.scale_div * math.sqrt(quantile / rest.dof),
                unit="div",
            )
        )
    return checks
