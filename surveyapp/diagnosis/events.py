"""Events in a second set: what happens once is not refused by a clean second run.

A step, a slip, a shift in transport cannot recur. What else saw it confirms it: the level of the
second run, where both stand on one circle; the tape zero and the sights after it. Otherwise it is
told as unconfirmed.
"""

from __future__ import annotations

import math

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import fit_members
from surveyapp.diagnosis.loop import Search, is_event
from surveyapp.diagnosis.run_value import datum_values, value_of
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi

AGREES, APART = 2.0, 3.0
"""Combined sigmas within which a level agrees, and beyond which it is another one."""
SAME_CIRCLE = 0.01
"""Levels further apart [rad] are not of one orientation of the circle."""


def event_notes(case: Case, found: Search, confirm: Case | None) -> list[ResultWarning]:
    """What a second set, or its want, says of the events among the names."""
    notes = []
    for name in found.adopted:
        if not is_event(found.after, name):
            continue
        title = name.replace("_", " ")
        level = None if confirm is None else _level(case, found, name, confirm)
        if confirm is not None and level is True:
            text = said(
                "{title}: confirmed by the level of {identity}, which is that after the "
                "event and not that before it",
                title=title,
                identity=confirm.identity,
            )
            notes.append(ResultWarning("event_confirmed", text))
        elif confirm is not None:
            text = said(
                "{title}: an event does not recur, so that the second set neither confirms "
                "nor refuses it; the tape zero and the sights after it, and a note of what "
                "happened, do",
                title=title,
            )
            notes.append(ResultWarning("event_unconfirmed", text))
    return notes


def _level(case: Case, found: Search, name: str, confirm: Case) -> bool | None:
    """Whether the second run stands at the level after the event; None where that cannot tell."""
    states = datum_values(case, found.after)
    own = [value for effect, _, value in states if effect == name]
    if not case.has_swing or len(own) != 2:
        return None
    other = value_of(confirm, fit_members(confirm, ()))
    gaps = []
    for value in own:
        gap = wrap_pi(value.value + case.offset - other.value - confirm.offset)
        if abs(gap) > SAME_CIRCLE:
            return None
        gaps.append(abs(gap) / math.hypot(value.sigma, other.sigma))
    return gaps[1] <= AGREES and gaps[0] >= APART
