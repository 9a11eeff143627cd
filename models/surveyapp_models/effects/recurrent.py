"""A course of north that recurs and that nobody can explain: saved from one run, tried on others.

It is no cause and is in no catalogue: its course is data, which a project carries with it, so that
an adopted one corrects a run wherever the project goes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import HALF_SWING, Coefficient, Columns, Effect

LARGEST_ARCSEC = 3600.0
LEAST_PLACES = 4


Course = Sequence[tuple[float, ...]]
"""Rows of a course: half swings since the first turning point, the shift of north there (1 at its
largest), and what independent errors of one standard deviation each change it there."""


def course_faults(course: Course) -> str:
    """What is wrong with a course, or an empty text."""
    if len(course) < LEAST_PLACES:
        return f"{len(course)} places, {LEAST_PLACES} at least"
    if len({len(row) for row in course}) != 1 or len(course[0]) < 2:
        return "rows of different lengths"
    numbers = np.array(course, dtype=np.float64)
    if not np.isfinite(numbers).all():
        return "a number that is not finite"
    if not bool(np.all(np.diff(numbers[:, 0]) > 0.0)):
        return "half swings that do not increase"
    if not 0.5 <= float(np.abs(numbers[:, 1]).max()) <= 1.001 or np.ptp(numbers[:, 1]) == 0.0:
        return "a course that does not vary, or whose largest value is not 1"
    return ""


def recurrent_course(identity: str, course: Course, *, run: str, told: str = "") -> Effect:
    """The effect of a saved course.

    Parameters
    ----------
    identity : str
        Its id.
    course : sequence of tuple of float
        Its rows (``Course``).
    run : str
        The run that it was saved from.
    told : str
        What the diagnosis said of it there.

    Raises
    ------
    ValueError
        If the course is none.
    """
    faults = course_faults(course)
    if faults:
        raise ValueError(f"effect {identity}: {faults}")
    time, shift = np.array(course, dtype=np.float64).T[:2]

    def basis(columns: Columns, /, **grid: float) -> Floats:
        """The saved course; beyond its ends it stays."""
        del grid
        return np.asarray(np.interp(columns["half_swing"], time, shift)[:, None])

    def at_mean(
        columns: Columns, references: Mapping[str, float], /, **grid: float
    ) -> tuple[tuple[str, tuple[float, ...]], ...]:
        """Where the course is zero: at its mean over the run that it was saved from."""
        del columns, references, grid
        return ((f"at the mean of the course of run {run}", (0.0,)),)

    return Effect(
        id=identity,
        title=f"Not explained, recurrent: the course of run {run}",
        subject="reversal_run",
        needs=(HALF_SWING,),
        coefficients=(
            Coefficient(
                "size",
                "arcsec",
                ARCSEC,
                -LARGEST_ARCSEC,
                LARGEST_ARCSEC,
                "shift of north where the course is largest",
            ),
        ),
        basis=basis,
        datum="north averaged over the run, as observed",
        source=f"run {run}{told and ', '}{told}: not explained",
        remedy="It recurs and nobody knows why: look for what these runs have in common.",
        symptom=f"north took the same unexplained course as in run {run}",
        separate_by="a run under other circumstances: another observer, tripod, hour or place",
        at_datum=at_mean,
        course=tuple(tuple(float(value) for value in row) for row in course),
        run=run,
    )


def course_errors(effect: Effect, half_swing: Floats) -> Floats:
    """What the errors of a saved course do at some points, for a size of 1.

    Parameters
    ----------
    effect : Effect
    half_swing : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n, q)
        No column for an effect that is no saved course.
    """
    rows = np.array(effect.course, dtype=np.float64).reshape(len(effect.course), -1)
    if rows.shape[1] < 3:
        return np.zeros((half_swing.size, 0))
    return np.column_stack([np.interp(half_swing, rows[:, 0], error) for error in rows.T[2:]])
