"""Whether an instrument was used where its card says it may be: temperature, latitude, due date.

Beyond its latitude an instrument is refused by the orientation itself; what stands here are the
checks that go into the record. A card that states no range is not checked.
"""

from __future__ import annotations

import datetime as dt
import math
from collections.abc import Sequence

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.swing.session import ReducedSession
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.languages import said


def validity_checks(orientation: Orientation) -> tuple[Check, ...]:
    """Checks of every session against the valid range of its instrument's card."""
    checks: list[Check] = []
    for item in orientation.sessions:
        card = orientation.project.instrument(item.session.instrument).card
        checks += _temperature(item.session, card)
        checks += _latitude(orientation, item, card)
        checks += _due(item.session, card)
    return tuple(checks)


def session_temperatures_c(session: OrientationSession) -> tuple[float, ...]:
    """Every temperature [degree Celsius] that the book of a session states."""
    return tuple(
        float(value)
        for row in session.book.live
        for value in (row.temperature_c, row.value if row.kind is ReadingKind.TEMPERATURE else None)
        if value is not None
    )


def _check(
    rule: str,
    card: InstrumentCard,
    session: str,
    value: float | None,
    *,
    limit: float,
    passed: bool | None,
    unit: str,
    text: str,
) -> Check:
    return Check(
        rule=rule,
        clause=said("card {id}", id=card.id),
        value=value,
        limit=limit,
        confirmed=True,
        passed=passed,
        unit=unit,
        where=session,
        text=text,
        subject=Subject.session(session),
    )


def _temperature(session: OrientationSession, card: InstrumentCard) -> list[Check]:
    if card.valid.temperature_c is None:
        return []
    low, high = card.valid.temperature_c
    rule, where = "card.temperature", session.id
    readings: Sequence[float] = session_temperatures_c(session)
    if not readings:
        text = said("missing: a temperature in the book")
        return [_check(rule, card, where, None, limit=high, passed=None, unit="C", text=text)]
    coldest, hottest = min(readings), max(readings)
    value, limit = (coldest, low) if coldest < low else (hottest, high)
    text = said(
        "{coldest:g} to {hottest:g} C; the instrument is made for {low:g} to {high:g} C",
        coldest=coldest,
        hottest=hottest,
        low=low,
        high=high,
    )
    passed = low <= coldest and hottest <= high
    return [_check(rule, card, where, value, limit=limit, passed=passed, unit="C", text=text)]


def _latitude(orientation: Orientation, item: ReducedSession, card: InstrumentCard) -> list[Check]:
    limit = card.valid.latitude_max
    if limit is None:
        return []
    latitude = orientation.positions[item.session.station].latitude
    value = None if latitude is None else abs(math.degrees(latitude))
    text = said("missing: the latitude of the station")
    if value is not None:
        text = said("latitude {latitude:.2f} degrees", latitude=value)
    return [
        _check(
            "card.latitude",
            card,
            item.session.id,
            value,
            limit=math.degrees(limit),
            passed=None if value is None else value <= math.degrees(limit),
            unit="deg",
            text=text,
        )
    ]


def _due(session: OrientationSession, card: InstrumentCard) -> list[Check]:
    if card.calibration_due is None:
        return []
    due = dt.date.fromisoformat(card.calibration_due)
    day = session.day
    value = None if day is None else float((day - due).days)
    text = said("calibration due {isoformat}", isoformat=due.isoformat())
    text += (
        said(": missing: the date of the session")
        if day is None
        else said(", used {isoformat}", isoformat=day.isoformat())
    )
    return [
        _check(
            "card.calibration_due",
            card,
            session.id,
            value,
            limit=0.0,
            passed=None if value is None else value <= 0.0,
            unit="days",
            text=text,
        )
    ]
