"""Is the instrument itself? Periods against the card, spin supply, tilt and tape zero.

None of these limits stands in a rule book: they warn. A measured period is a free check of spin
and latitude (physics.md 1.2); a wandering supply moves the constant (physics.md 7, one day of a
failing battery: 4'44").
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.statistics.distributions import normal_quantile, student_quantile
from surveyapp.core.statistics.levels import LOUD
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.clamped import NOMINAL_SIGMA_S
from surveyapp.core.swing.session import ReducedSession
from surveyapp.core.swing.sights import moments
from surveyapp.core.swing.tape_zero import mean_level
from surveyapp.domain.readings import Place, Reading, ReadingKind
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi
from surveyapp_models.gyro.coefficients import torsion_ratio_from_clampings
from surveyapp_models.gyro.estimates import Estimate
from surveyapp_models.gyro.periods import period_at_amplitude_s

PERIOD_LIMIT = 0.01
"""Relative deviation of a period where the card states no sigma: one degree of latitude changes T1
by 0.5 to 2.4 % (physics.md 1.2)."""
SPIN_PER_PERIOD = 1.0 / 0.48
"""Relative change of the spin per relative change of T1 (physics.md 1.2)."""
SUPPLY_LIMIT_PERCENT = 1.0
"""One per cent of spin moves T1 by 2 s of 425 s (physics.md 1.2)."""
LEAST_CLAMPINGS_APART = math.radians(5.0 / 60.0)
"""Nearer clampings say nothing of the torsion ratio."""


def instrument_checks(orientation: Orientation) -> list[Check]:
    """Checks of periods, supply and tape-zero tilt of every session."""
    checks: list[Check] = []
    for item in orientation.sessions:
        checks += _period_check(orientation, item)
        checks += _supply_checks(item)
        checks += _tilt_check(orientation, item)
    return checks + _clamping_checks(orientation)


def _period_check(orientation: Orientation, item: ReducedSession) -> list[Check]:
    """Period from the times of the turning points or passages against the card's, at amplitude."""
    session, reduction = item.session, item.reduction
    if reduction.period_s is None or session.method == "automatic":
        return []
    card = orientation.project.instrument(session.instrument).card
    here = card_at(card, orientation.positions[session.station].latitude)
    tracked = session.method == "tracking"
    predicted = here.tracking_s if tracked else here.clamped_s
    if predicted is None:
        return []
    share = 1.0
    if not tracked and here.torsion_ratio is not None:
        share = 1.0 / (1.0 + here.torsion_ratio.value)
    amplitude = reduction.amplitude or 0.0
    expected = period_at_amplitude_s(
        predicted.value, amplitude=abs(amplitude), stiffness_share=share
    )
    difference = reduction.period_s - expected
    limit = _period_limit(item, predicted, expected)
    spin = SPIN_PER_PERIOD * difference / expected if tracked else None
    text = said(
        "period {period_s:.2f} s, card at this latitude {expected:.2f} s",
        period_s=reduction.period_s,
        expected=expected,
    )
    if spin is not None:
        text += said("; as a change of spin {spin:+.2f} %", spin=100.0 * spin)
    return [
        Check(
            rule="period.tracking" if tracked else "period.clamped",
            clause=said("physics of the swing, 1 %"),
            value=abs(difference),
            limit=limit,
            confirmed=False,
            passed=abs(difference) <= limit,
            unit="s",
            where=session.id,
            text=text,
            subject=Subject.session(session.id),
        )
    ]


def _period_limit(item: ReducedSession, predicted: Estimate, expected: float) -> float:
    """What chance makes of the difference at 1 %, from the card's sigma and the times' scatter."""
    if predicted.sigma <= 0.0:
        return PERIOD_LIMIT * expected
    quantile = normal_quantile(1.0 - 0.5 * LOUD)
    if item.session.method == "tracking":
        own = _slope_sigma(item.session.book.of_kind(ReadingKind.REVERSAL))
        return quantile * math.hypot(predicted.sigma, own)
    found = _passage_sigma(item)
    if found is None:
        return PERIOD_LIMIT * expected
    sigma, dof = found
    wider = student_quantile(1.0 - 0.5 * LOUD, dof) if dof < math.inf else quantile
    return math.hypot(quantile * predicted.sigma, wider * sigma)


def _passage_sigma(item: ReducedSession) -> tuple[float, float] | None:
    """Sigma of the clamped period [s] from the passages' own scatter, and degrees of freedom.

    Passages of one division come in two kinds, to the right and to the left: each has its moment.
    """
    rows = item.session.book.of_kind(ReadingKind.TRANSIT)
    of_one = [row for row in rows if row.value == rows[0].value]
    times = moments(of_one)
    if times is None or times.size < 3:
        return None
    index = np.arange(times.size, dtype=np.float64)
    columns = np.column_stack([np.ones_like(index), index, (-1.0) ** index])
    inverse = np.linalg.pinv(columns)
    slope = float(np.sqrt(inverse[1] @ inverse[1]))
    dof = times.size - 3
    if dof < 1:
        return 2.0 * slope * NOMINAL_SIGMA_S, math.inf
    residuals = times - columns @ (inverse @ times)
    return 2.0 * slope * math.sqrt(float(residuals @ residuals) / dof), float(dof)


def _slope_sigma(rows: tuple[Reading, ...]) -> float:
    """Sigma of the period [s] from the scatter of the moments about a straight line."""
    times = moments(rows) if len(rows) >= 4 else None
    if times is None:
        return 0.0
    index = np.arange(times.size, dtype=np.float64)
    slope, offset = np.polyfit(index, times - times[0], 1)
    residuals = times - times[0] - slope * index - offset
    variance = float(residuals @ residuals) / (times.size - 2)
    spread = float(np.sum((index - index.mean()) ** 2))
    return 2.0 * math.sqrt(variance / spread)


def _supply_checks(item: ReducedSession) -> list[Check]:
    """Range of the spin motor's supply within one session, per cent of its mean."""
    by_unit: dict[str, list[float]] = {}
    for row in item.session.book.of_kind(ReadingKind.SUPPLY):
        if row.value is not None:
            by_unit.setdefault(row.unit, []).append(row.value)
    checks = []
    for unit, values in by_unit.items():
        mean = sum(values) / len(values)
        if len(values) < 2 or mean == 0.0:
            continue
        percent = 100.0 * (max(values) - min(values)) / abs(mean)
        checks.append(
            Check(
                rule="supply.steady",
                clause=said("spin motor supply within one session"),
                value=percent,
                limit=SUPPLY_LIMIT_PERCENT,
                confirmed=False,
                passed=percent <= SUPPLY_LIMIT_PERCENT,
                unit="%",
                where=item.session.id,
                text=said(
                    "supply between {values:g} and {values2:g} {unit}",
                    values=min(values),
                    values2=max(values),
                    unit=unit,
                ),
                subject=Subject.session(item.session.id),
            )
        )
    return checks


def _tilt_check(orientation: Orientation, item: ReducedSession) -> list[Check]:
    """Does the change of level explain the change of the tape zero? (physics.md 2.5)."""
    zero = item.reduction.tape_zero
    card = orientation.project.instrument(item.session.instrument).card
    factor = card.tape_zero.div_per_tilt
    if zero is None or zero.before is None or zero.after is None or not factor:
        return []
    levels = [
        mean_level(item.session.book, ReadingKind.LEVEL_ACROSS, place)
        for place in (Place.BEFORE, Place.AFTER)
    ]
    if levels[0] is None or levels[1] is None:
        return []
    tilt = levels[1] - levels[0]
    measured = zero.after.value_div - zero.before.value_div
    sigma = (card.sigma.scale_div or 0.0) * math.hypot(
        zero.before.weight_norm, zero.after.weight_norm
    )
    rest = measured - factor * tilt
    limit = normal_quantile(1.0 - 0.5 * LOUD) * sigma
    return [
        Check(
            rule="tape_zero.tilt",
            clause=said("card {id}, div_per_arcsec_tilt", id=card.id),
            value=abs(rest),
            limit=limit if sigma > 0.0 else None,
            confirmed=False,
            passed=abs(rest) <= limit if sigma > 0.0 else None,
            unit="div",
            where=item.session.id,
            text=(
                said(
                    "tape zero changed by {measured:+.3f} div, the level across by "
                    '{tilt:+.1f}", which explains {factor:+.3f} div',
                    measured=measured,
                    tilt=tilt * RHO_ARCSEC,
                    factor=factor * tilt,
                )
            ),
            subject=Subject.session(item.session.id),
        )
    ]


@dataclass(frozen=True, slots=True)
class _Clamping:
    """One clamping relative to a line: clamp reading [rad] and centre of swing [div]."""

    session: str
    clamp: Estimate
    centre_div: Estimate


def _clampings(orientation: Orientation) -> dict[tuple[str, str, str], list[_Clamping]]:
    """Clampings by instrument, station and target; the tape zero is taken out of the centre."""
    found: dict[tuple[str, str, str], list[_Clamping]] = {}
    for item in orientation.sessions:
        values = {name: value for name, value, _ in item.reduction.quantities}
        if "middle of the swing" not in values:
            continue
        zero = item.reduction.tape_zero
        for target in item.targets:
            if target.line_reading is None:
                continue
            clamp = wrap_pi(math.radians(values["clamp reading"]) - target.line_reading.value)
            centre = values["middle of the swing"]
            ratio = values["torsion ratio"]
            if zero is not None:
                centre -= ratio / (1.0 + ratio) * zero.value_div
            key = (item.session.instrument, item.session.station, target.target)
            found.setdefault(key, []).append(
                _Clamping(
                    item.session.id,
                    Estimate(clamp, target.line_reading.sigma),
                    Estimate(centre, values.get("sigma of the middle", 0.0)),
                )
            )
    return found


def _clamping_checks(orientation: Orientation) -> list[Check]:
    """Torsion ratio from the two clampings of a line that lie furthest apart, against the card."""
    checks = []
    for (instrument, station, target), items in _clampings(orientation).items():
        card = orientation.project.instrument(instrument).card
        ordered = sorted(items, key=lambda clamping: clamping.clamp.value)
        first, last = ordered[0], ordered[-1]
        here = card_at(card, orientation.positions[station].latitude).torsion_ratio
        apart = last.clamp.value - first.clamp.value
        if card.scale_value is None or here is None or apart < LEAST_CLAMPINGS_APART:
            continue
        try:
            found = torsion_ratio_from_clampings(
                (first.clamp, last.clamp),
                (first.centre_div, last.centre_div),
                scale_value=card.scale_value,
            )
        except ValueError as error:
            text, value, limit, passed = str(error), None, None, False
        else:
            quantile = normal_quantile(1.0 - 0.5 * LOUD)
            limit = quantile * math.hypot(found.sigma, here.sigma)
            value = abs(found.value - here.value)
            passed = value <= limit
            text = said(
                "torsion ratio from clampings {session} and {session2} {value:.4f} "
                "+-{sigma:.4f}, card at this latitude {value2:.4f}",
                session=first.session,
                session2=last.session,
                value=found.value,
                sigma=found.sigma,
                value2=here.value,
            )
        checks.append(
            Check(
                rule="torsion_ratio.clampings",
                clause=said("two clampings, lambda = (H1 - H2)/(mu (B2 - B1)) - 1"),
                value=value,
                limit=limit,
                confirmed=False,
                passed=passed,
                where=f"{station}-{target}",
                text=text,
                subject=Subject.line(station, target, instrument),
            )
        )
    return checks
