"""Whether the instrument stood level enough for itself: level rows against the card."""

from __future__ import annotations

import math
from typing import Final

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.swing.levelling import session_tilt
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.languages import joined, said
from surveyapp_models.angles import RHO_ARCSEC

PRE_ORIENTATION: Final = {"tracking": 60.0, "transit": 10.0}
"""Minutes within which the alidade must point north before a run, by method (sensors: regulation
for coal mine surveying, pre-orientation)."""


def levelling_checks(orientation: Orientation) -> list[Check]:
    """Largest tilt of each session that read both levels, against the limit of its card."""
    checks = []
    for item in orientation.sessions:
        checks += _card_check(item.session) + _pre_orientation(item.session)
        tilt = session_tilt(item.session, tape_zero=False)
        if tilt is None:
            continue
        card = orientation.project.instrument(item.session.instrument).card
        largest = max(abs(tilt.along), abs(tilt.across)) * RHO_ARCSEC
        limit = None if card.valid.level is None else card.valid.level * RHO_ARCSEC
        checks.append(
            Check(
                rule="levelling.tilt",
                clause=said("card {id}, range.level_arcsec", id=card.id),
                value=largest,
                limit=limit,
                confirmed=False,
                passed=None if limit is None else largest <= limit,
                unit="arcsec",
                where=item.session.id,
                text=(
                    said(
                        'tilt along {along:+.1f}", across {across:+.1f}", compensated in the '
                        "sights",
                        along=tilt.along * RHO_ARCSEC,
                        across=tilt.across * RHO_ARCSEC,
                    )
                ),
                subject=Subject.session(item.session.id),
            )
        )
    return checks


def _card_check(session: OrientationSession) -> list[Check]:
    """Whether the card of the tilt log holds on the day and at the temperatures."""
    log = session.levelling
    if log is None:
        return []
    text = joined("; ", log.refusals) + said(": the tilt log is not applied")
    return [
        Check(
            rule="levelling.card_valid",
            clause=said("sensor card {card}", card=log.card),
            value=None,
            limit=None,
            confirmed=True,
            passed=not log.refusals,
            where=session.id,
            text=text
            if log.refusals
            else said("the card holds for the tilt log {log}", log=log.log),
            subject=Subject.session(session.id),
        )
    ]


def _pre_orientation(session: OrientationSession) -> list[Check]:
    """|offset| + its 95 % interval of the compass against what each method asks."""
    aimed = session.pre_orientation
    if aimed is None:
        return []
    value, interval = None, aimed.interval95
    if aimed.refusals:
        text = joined("; ", aimed.refusals)
    elif aimed.offset is None or interval is None:
        text = said("a MAGNETIC heading without declination_deg says nothing of north")
    else:
        offset = math.degrees(aimed.offset) * 60.0
        value = abs(offset) + math.degrees(interval) * 60.0
        text = said(
            "the alidade points {offset:+.1f}' from north, 95 % interval "
            "{degrees:.1f}': turn it by {offset2:+.1f}'",
            offset=offset,
            degrees=math.degrees(interval) * 60.0,
            offset2=-offset,
        )
        if aimed.turn_to is not None:
            text += said(
                " to the circle reading {turn_to:.4f} degrees", turn_to=math.degrees(aimed.turn_to)
            )
    return [
        Check(
            rule=f"pre_orientation.{method}",
            clause=said("pre-orientation for {method}, {limit:g}'", method=method, limit=limit),
            value=value,
            limit=limit,
            confirmed=False,
            passed=False if aimed.refusals else None if value is None else value <= limit,
            unit="arcmin",
            where=session.id,
            text=text,
            subject=Subject.session(session.id),
        )
        for method, limit in PRE_ORIENTATION.items()
    ]
