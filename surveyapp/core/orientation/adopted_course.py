"""Courses of north that a run has adopted although nobody can explain them."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.effects.effect import Effect
from surveyapp_models.effects.recurrent import recurrent_course


def course_of(adopted: AdoptedEffect) -> Effect | None:
    """The effect of an adopted course; None of an effect of the catalogue."""
    if not adopted.course:
        return None
    return recurrent_course(adopted.id, adopted.course, run=adopted.run)


def courses_of(effects: Sequence[AdoptedEffect]) -> tuple[Effect, ...]:
    """The adopted courses among some adopted effects."""
    found = (course_of(item) for item in effects)
    return tuple(effect for effect in found if effect is not None)


def unexplained(session: OrientationSession) -> list[ResultWarning]:
    """That a run is reduced by a course that recurs and is not explained."""
    return [
        ResultWarning(
            "course_not_explained",
            said(
                "session {id}: its turning points are reduced with {effect}, the course of run "
                "{run}: recurrent, not explained; north is the mean over the run as before",
                id=session.id,
                effect=item.id,
                run=item.run or "?",
            ),
            Subject.session(session.id),
        )
        for item in session.effects
        if item.course
    ]
