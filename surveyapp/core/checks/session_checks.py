"""Statistical tests of sessions, constants and lines, with the card's own limits.

The limits of a rule book are applied elsewhere; here stand the tests that need no rule book
because they compare the data with themselves. All of them together alarm by
chance in one clean project of twenty.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations

from surveyapp.core.orientation.agreement import agreement_text
from surveyapp.core.orientation.combined_lines import sides_of
from surveyapp.core.orientation.instrument_constant import InstrumentConstant
from surveyapp.core.orientation.lines import OrientedLine
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.statistics.levels import CONSTANT_SHARE, level_of_one
from surveyapp.core.swing.goodness import FitTest
from surveyapp.core.swing.session import ReducedSession, SightSigma
from surveyapp.core.swing.sights import drift_probability
from surveyapp.core.uncertain import Uncertain
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.languages import joined, said
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi

_FIT_WORDS = {
    "chi_square": said("residuals against the card's reading sigma (v'v / sigma^2)"),
    "size": said("residuals against what no reading of the kind exceeds (v'v / sigma^2)"),
    "largest_residual": said("largest studentized residual"),
    "lag1_correlation": said("lag-1 correlation of the residuals"),
    "runs": said("number of runs of equal sign in the residuals"),
}
_TEST_CLAUSE = said("statistical test, level shared over the project")


def statistical_checks(orientation: Orientation) -> list[Check]:
    """All tests that the data of a project answer by themselves."""
    checks: list[Check] = []
    for item in orientation.sessions:
        checks += _fit_checks(item)
        checks += _tape_zero_checks(orientation, item)
        sigma = orientation.sight_sigmas[item.session.instrument]
        checks += _sight_checks(item, sigma, level_of_one(len(orientation.sessions)))
    constant_level = CONSTANT_SHARE / max(sum(map(_tested, orientation.constants)), 1)
    for constant in orientation.constants:
        checks += _constant_checks(constant, constant_level)
    for line in orientation.lines:
        checks += _line_checks(line, level_of_one(len(orientation.lines)))
    checks += _forward_back(orientation)
    return checks


def _fit_checks(item: ReducedSession) -> list[Check]:
    checks = _fit_summary(item)
    for test in item.reduction.tests:
        words = _FIT_WORDS[test.name] + _point_name(item, test)
        verdict = said("fits") if test.passed else said("does NOT fit the damped swing")
        if test.at_limit:
            verdict += said(" (at the limit: the draws cannot tell on which side)")
        checks.append(
            Check(
                rule=f"fit.{test.name}",
                clause=_TEST_CLAUSE,
                value=test.value,
                limit=_violated_bound(test),
                confirmed=True,
                passed=test.passed,
                where=item.session.id,
                text=said("{words}: the run {verdict}", words=words, verdict=verdict),
                subject=Subject.session(item.session.id),
            )
        )
    return checks


def _point_name(item: ReducedSession, test: FitTest) -> str:
    """Which reading has the largest residual, in words."""
    if test.point is None:
        return ""
    points = item.reduction.points
    if test.point >= len(points):
        return said(", passage {point}", point=test.point - len(points) + 1)
    point = points[test.point]  # counted as in alarm, diagnosis and record: with missed ones
    return said(", turning point {index} (seq {seq})", index=point.index + 1, seq=point.seq)


def _fit_summary(item: ReducedSession) -> list[Check]:
    """One line for the whole run: its rms, and whether every test of fit is met."""
    reduction = item.reduction
    if not reduction.tests or reduction.residual_rms is None:
        return []
    failed = [
        _FIT_WORDS[test.name] + _point_name(item, test)
        for test in reduction.tests
        if not test.passed
    ]
    rms = reduction.residual_rms * RHO_ARCSEC
    limit = None
    for test in reduction.tests:
        if test.name in ("chi_square", "size") and test.high is not None and test.value > 0.0:
            limit = rms * math.sqrt(test.high / test.value)
    if failed:
        text = said(
            'rms {rms:.1f}": the damped swing does NOT fit this run ({failed})',
            rms=rms,
            failed=joined("; ", failed),
        )
    else:
        text = said('rms {rms:.1f}": the damped swing fits', rms=rms)
    return [
        Check(
            rule="fit",
            clause=_TEST_CLAUSE,
            value=rms,
            limit=limit,
            confirmed=True,
            passed=not failed,
            unit="arcsec",
            where=item.session.id,
            text=text,
            subject=Subject.session(item.session.id),
        )
    ]


def _violated_bound(test: FitTest) -> float | None:
    if test.low is not None and test.value < test.low:
        return test.low
    return test.high


def _tape_zero_checks(orientation: Orientation, item: ReducedSession) -> list[Check]:
    card = orientation.project.instrument(item.session.instrument).card
    zero, limit = item.reduction.tape_zero, card.tape_zero.limit_div
    if zero is None or limit is None:
        return []
    checks = []
    for name, rest in ((said("before"), zero.before), (said("after"), zero.after)):
        if rest is not None:
            checks.append(
                Check(
                    rule="tape_zero.limit",
                    clause=said("card {id}", id=card.id),
                    value=abs(rest.value_div),
                    limit=limit,
                    confirmed=True,
                    passed=abs(rest.value_div) <= limit,
                    unit="div",
                    where=f"{item.session.id} {name}",
                    text=said(
                        "tape zero {name} {value_div:+.3f} div", name=name, value_div=rest.value_div
                    ),
                    subject=Subject.session(item.session.id),
                )
            )
    return checks


def _sight_checks(item: ReducedSession, sigma: SightSigma, level: float) -> list[Check]:
    checks = []
    for target in item.targets:
        sights = target.sights
        if sights is None or sights.drift is None:
            continue
        probability = drift_probability(sights, sigma=sigma.value, dof=sigma.dof)
        if probability is None:
            continue
        limit = student_quantile(1.0 - 0.5 * level, sigma.dof) * sigma.value
        limit *= math.sqrt(sights.drift_cofactor)
        checks.append(
            Check(
                rule="sights.drift",
                clause=_TEST_CLAUSE,
                value=abs(sights.drift) * RHO_ARCSEC,
                limit=limit * RHO_ARCSEC,
                confirmed=True,
                passed=probability >= level,
                unit="arcsec",
                where=Subject.session(item.session.id, target.target).text,
                text=said("sights after minus before: the tripod may have turned; it is taken out"),
                subject=Subject.session(item.session.id, target.target),
            )
        )
    return checks


def _tested(constant: InstrumentConstant) -> int:
    """Number of tests of one constant."""
    tests = (constant.line_agreement, constant.phase_agreement)
    known = constant.pooled is not None and constant.known is not None
    return sum(test is not None for test in tests) + known


def _constant_checks(constant: InstrumentConstant, level: float) -> list[Check]:
    """Lines, epochs and a value known beforehand.

    What disagrees at 5 % is in the sigma and warns; a blunder is what does so at the level that a
    clean project as a whole allows.
    """
    checks = []
    for rule, what, test in (
        ("constant.lines", "lines", constant.line_agreement),
        ("constant.before_after", "epochs", constant.phase_agreement),
    ):
        if test is not None:
            checks.append(
                Check(
                    rule=rule,
                    clause=said("physics of the constant, statistical test, 5 %"),
                    value=test.difference * RHO_ARCSEC,
                    limit=test.limit * RHO_ARCSEC,
                    confirmed=test.agree or test.probability < level,
                    passed=test.agree,
                    unit="arcsec",
                    where=constant.instrument.id,
                    text=agreement_text(test, what),
                    subject=Subject.of("instrument", constant.instrument.id),
                )
            )
    pooled = constant.pooled
    if pooled is not None and constant.known is not None:
        subject = Subject.of("instrument", constant.instrument.id)
        checks.append(_compare("constant.known", pooled - constant.known, subject, level))
    return checks


def _compare(
    rule: str, difference: Uncertain, subject: Subject, level: float, *, text: str = ""
) -> Check:
    limit = student_quantile(1.0 - 0.5 * level, max(difference.dof, 1.0)) * difference.sigma
    value = abs(wrap_pi(difference.value))
    return Check(
        rule=rule,
        clause=_TEST_CLAUSE,
        value=value * RHO_ARCSEC,
        limit=limit * RHO_ARCSEC if math.isfinite(limit) else None,
        confirmed=True,
        passed=value <= limit if math.isfinite(limit) else None,
        unit="arcsec",
        where=subject.text,
        text=text or said("determined now against known beforehand"),
        subject=subject,
    )


def _line_checks(line: OrientedLine, level: float) -> list[Check]:
    test = line.agreement
    if test is None:
        return []
    return [
        Check(
            rule="line.rounds_agree",
            clause=_TEST_CLAUSE,
            value=test.statistic,
            limit=None,
            confirmed=True,
            passed=test.probability >= level,
            where=f"{line.result.station}-{line.result.target}",
            text=(
                said(
                    "{sessions} sessions of one line, scatter against their own sigmas (p = "
                    "{probability:.3g})",
                    sessions=len(line.result.sessions),
                    probability=test.probability,
                )
            ),
            subject=line.result.subject,
        )
    ]


def _forward_back(orientation: Orientation) -> list[Check]:
    """A-B against B-A: the grid azimuths differ by half a circle but for arc-to-chord in both.

    Every line of a side is compared with every other, whatever instruments oriented them: an
    error that both ends of a side share with one instrument shows against another.
    """
    pairs = [
        (line, other, len(side) == 2)
        for side in sides_of(orientation.lines).values()
        for line, other in combinations(side, 2)
    ]
    level = level_of_one(len(pairs))
    checks = []
    for line, other, alone in pairs:
        assert line.grid is not None
        assert other.grid is not None
        first, second = orientation.deflections.jointly([line.grid, other.grid])
        checks.append(_of_one_side(line, other, first - second, level=level, alone=alone))
    return checks


def _of_one_side(
    line: OrientedLine, other: OrientedLine, difference: Uncertain, *, level: float, alone: bool
) -> Check:
    own, its = line.result.instrument, other.result.instrument
    rule, names = "line.instruments", said("{own} and {its}", own=own, its=its)
    text = said("two instruments on one line ({names})", names=names)
    if line.result.station != other.result.station:
        difference = difference.shifted(math.pi)
        rule, names = (
            "line.forward_back",
            own if own == its else said("{own} there, {its} back", own=own, its=its),
        )
        text = said("forward against back, the two ends of one line ({names})", names=names)
    check = _compare(rule, difference, line.result.subject, level, text=text)
    return check if alone else replace(check, where=f"{check.where} ({names})")
