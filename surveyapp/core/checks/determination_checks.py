"""Determinations of the constant on one line against each other, and what they took as known.

Two calibrations of one line and epoch that disagree hold a blunder in one of them: another target,
a mistyped known azimuth, a face. Surveys of one line are compared by ``line.rounds_agree``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from surveyapp.core.orientation.instrument_constant import Calibration
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.statistics.levels import level_of_one
from surveyapp.core.statistics.repeated import consistency
from surveyapp.core.uncertain import Uncertain
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.results import Check
from surveyapp.domain.station_line import StationLine
from surveyapp.domain.subject import Subject
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, wrap_pi

SAME_AZIMUTH: Final = 1.0 * ARCSEC
"""Two statements of one known azimuth differ by their last digit at most."""


def determination_checks(orientation: Orientation) -> list[Check]:
    """Agreement of repeated calibrations, and of the azimuths that they state."""
    return [*_agreement(orientation), *_same_azimuth(orientation)]


def _agreement(orientation: Orientation) -> list[Check]:
    groups: dict[tuple[str, StationLine, int], list[Calibration]] = {}
    for constant in orientation.constants:
        for item in constant.calibrations:
            key = (constant.instrument.id, item.line, item.block)
            groups.setdefault(key, []).append(item)
    repeated = {key: items for key, items in groups.items() if len(items) > 1}
    checks = []
    for (instrument, line, _), items in repeated.items():
        values = [item.value.without(said("run-to-run scatter")) for item in items]
        test = consistency([values])
        if test is None:
            continue
        worst = _furthest(items, values)
        checks.append(
            Check(
                rule="constant.determinations",
                clause=said("scatter against their own sigmas, level shared over the project"),
                value=test.statistic,
                limit=None,
                confirmed=True,
                passed=test.probability >= level_of_one(len(repeated)),
                where=f"{instrument} on {line}",
                text=(
                    said(
                        "{items} determinations of the constant on {line}, scatter against their "
                        "own sigmas (p = {probability:.3g}); furthest off: {worst}",
                        items=len(items),
                        line=line,
                        probability=test.probability,
                        worst=worst,
                    )
                ),
                subject=Subject.of("instrument", instrument),
            )
        )
    return checks


def _furthest(items: Sequence[Calibration], values: Sequence[Uncertain]) -> str:
    """Session whose constant lies furthest from the median; of two, both."""
    if len(items) == 2:
        apart = wrap_pi(values[0].value - values[1].value) * RHO_ARCSEC
        return said(
            '{session} and {session2}, {apart:.1f}" apart',
            session=items[0].session,
            session2=items[1].session,
            apart=abs(apart),
        )
    middle = sorted(value.value for value in values)[len(values) // 2]
    worst = max(range(len(items)), key=lambda i: abs(wrap_pi(values[i].value - middle)))
    apart = wrap_pi(values[worst].value - middle) * RHO_ARCSEC
    return said(
        '{session}, {apart:+.1f}" from the median', session=items[worst].session, apart=apart
    )


def _same_azimuth(orientation: Orientation) -> list[Check]:
    """Sessions that state the azimuth of one line state the same one, there and back."""
    by_line: dict[tuple[str, str], list[tuple[OrientationSession, float]]] = {}
    for session in orientation.project.sessions:
        if session.azimuth_known is None or session.target is None:
            continue
        ends = (session.station, session.target)
        forward = ends == tuple(sorted(ends))
        value = session.azimuth_known if forward else session.azimuth_known + math.pi
        by_line.setdefault((min(ends), max(ends)), []).append((session, value))
    checks = []
    several = {ends: stated for ends, stated in by_line.items() if len(stated) > 1}
    for ends, stated in several.items():
        first, value = stated[0]
        apart, other = max(
            ((abs(wrap_pi(v - value)), session) for session, v in stated[1:]),
            key=lambda pair: pair[0],
        )
        sigma = math.hypot(first.azimuth_known_sigma or 0.0, other.azimuth_known_sigma or 0.0)
        limit = SAME_AZIMUTH + student_quantile(0.999, math.inf) * sigma
        if (first.station, first.target) != (other.station, other.target):
            limit += 60.0 * ARCSEC  # arc-to-chord at both ends
        subject = Subject.side(*ends)
        checks.append(
            Check(
                rule="known_azimuth.same_line",
                clause=said("a line has one azimuth"),
                value=apart * RHO_ARCSEC,
                limit=limit * RHO_ARCSEC,
                confirmed=True,
                passed=apart <= limit,
                unit="arcsec",
                where=subject.text,
                text=said(
                    "known azimuths stated in sessions {id} and {id2}", id=first.id, id2=other.id
                ),
                subject=subject,
            )
        )
    return checks
