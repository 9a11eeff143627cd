"""A shape without a name, saved as an effect of one's own: not explained, perhaps recurrent.

Where the diagnosis of a run ends at a generic shape, its course over the run can be tried on every
later run of the instrument. If it is found again it is as little explained as before, but no longer
a chance of one afternoon.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from surveyapp.diagnosis.candidates import AMPLITUDE_SHAPES
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit, Member
from surveyapp.diagnosis.loop import DEFAULT_DRAWS, search
from surveyapp.diagnosis.run_value import coefficients
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

TEMPLATE: Final = '''"""Saved by surveyapp diagnose --save-shape: {shape} of run {identity}.

Not explained. Trying it on other runs tells whether it recurs; where it is named it can be adopted:

    surveyapp diagnose DIR --session OTHER --effects THIS_FILE
    surveyapp diagnose DIR --session OTHER --effects THIS_FILE --adopt
"""

from surveyapp_models.effects.recurrent import recurrent_course

COURSE = (
{course}
)
"""Half swings, the shift of north there (1 = {size:+.1f} arc-seconds), and its errors."""

EFFECTS = (
    recurrent_course("{id}", COURSE, run="{identity}", told="{shape}, {size:+.1f} arc-seconds"),
)
'''


def shape_text(problem: Case, *, draws: int = DEFAULT_DRAWS) -> str:
    """The file of effects that holds the unnamed shape of a run.

    Raises
    ------
    SurveyError
        If it is no run, or its best explanation holds no course of north without a name.
    """
    if not problem.has_swing:
        raise SurveyError(_no_shape(problem, f"a {problem.title}", "the turning points of a run"))
    best = search(problem, draws=draws, confirm=None).best
    member = next((m for m in best.members if _is_course(m)), None)
    if member is None:
        found = " + ".join(best.effects) or "the base model"
        raise SurveyError(_no_shape(problem, found, "a bend, an oscillation, a pulse"))
    course, errors = _course(problem, best, member)
    time = problem.position if problem.half_swing is None else problem.half_swing
    size = float(course[np.argmax(np.abs(course))])
    name = re.sub(r"[^a-z0-9]+", "_", problem.identity.lower()).strip("_")[:40] or "run"
    return TEMPLATE.format(
        shape=member.candidate.id.replace("_", " "),
        identity=re.sub(r'["\\\\{}\r\n]', " ", problem.identity),
        course="\n".join(
            f"    ({', '.join(f'{x:.4f}' for x in row)}),"
            for row in np.column_stack([time, course / size, errors / size]).tolist()
        ),
        id=f"recurrent_{name}",
        size=size / ARCSEC,
    )


def _is_course(member: Member) -> bool:
    return member.candidate.kind == "shape" and member.candidate.id not in AMPLITUDE_SHAPES


def _course(problem: Case, fit: Fit, member: Member) -> tuple[Floats, Floats]:
    """What north itself did, about its mean [rad], shape (n,), and its errors, shape (n, q)."""
    values, covariance = coefficients(problem, fit)[member.candidate.id]
    columns = member.columns
    if member.candidate.midpoint is not None:
        columns = member.candidate.midpoint[member.g]
    columns = columns - columns.mean(axis=0)
    spread, turned = np.linalg.eigh(covariance)
    errors = columns @ turned * np.sqrt(np.maximum(spread, 0.0))
    return np.asarray(columns @ values), np.asarray(errors)


def _no_shape(problem: Case, found: str, expected: str) -> Problem:
    return Problem(
        "there is no unnamed shape to save",
        said("diagnose, save shape, {identity}", identity=problem.identity),
        found,
        expected,
        "Only what the diagnosis finds and cannot name is saved.",
    )
