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

Not explained. Trying it on other runs tells whether it recurs:

    surveyapp diagnose DIR --session OTHER --effects THIS_FILE
"""

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.effect import HALF_SWING, Coefficient, Effect

TIME = {time}
COURSE = {course}
"""Half swings, and the shift of north there, 1 at its largest."""


def basis(columns, /, **grid):
    """The saved course; beyond its ends it stays."""
    return np.interp(columns["half_swing"], TIME, COURSE)[:, None]


EFFECTS = (
    Effect(
        id="{id}",
        title="Not explained, recurrent: the course of run {identity}",
        subject="reversal_run",
        needs=(HALF_SWING,),
        coefficients=(
            Coefficient("size", "arcsec", ARCSEC, -3600.0, 3600.0, "{size:+.1f} in that run"),
        ),
        basis=basis,
        datum="north averaged over the run, as observed",
        source="run {identity}, {shape}: {size:+.1f} arc-seconds, not explained",
        remedy="It recurs and nobody knows why: look for what these runs have in common.",
        symptom="north took the same unexplained course as in run {identity}",
        separate_by="a run under other circumstances: another observer, tripod, hour or place",
    ),
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
    course = _course(problem, best, member)
    time = problem.position
    size = float(course[np.argmax(np.abs(course))])
    name = re.sub(r"[^a-z0-9]+", "_", problem.identity.lower()).strip("_")[:40] or "run"
    return TEMPLATE.format(
        shape=member.candidate.id.replace("_", " "),
        identity=re.sub(r'["\\\\{}\r\n]', " ", problem.identity),
        time=[round(float(t), 3) for t in time],
        course=[round(float(v / size), 4) for v in course],
        id=f"recurrent_{name}",
        size=size / ARCSEC,
    )


def _is_course(member: Member) -> bool:
    return member.candidate.kind == "shape" and member.candidate.id not in AMPLITUDE_SHAPES


def _course(problem: Case, fit: Fit, member: Member) -> Floats:
    """What north itself did, about its mean [rad], shape (n,)."""
    values, _ = coefficients(problem, fit)[member.candidate.id]
    columns = member.columns
    if member.candidate.midpoint is not None:
        columns = member.candidate.midpoint[member.g]
    course = columns @ values
    return np.asarray(course - course.mean())


def _no_shape(problem: Case, found: str, expected: str) -> Problem:
    return Problem(
        "there is no unnamed shape to save",
        said("diagnose, save shape, {identity}", identity=problem.identity),
        found,
        expected,
        "Only what the diagnosis finds and cannot name is saved.",
    )
