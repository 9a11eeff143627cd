"""Turning points of one run, as every estimation takes them, and the damped swing through them.

Source: physics.md 2.1 and section 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.book.resolution import reading_resolution
from surveyapp.core.swing.clamped import session_problem
from surveyapp.core.swing.gyrofit import (
    LEAST_SQUARES_FROM,
    DampedFit,
    fit_damped_swing,
    side_signs,
    unwrap,
)
from surveyapp.core.swing.reduction import need_points
from surveyapp.core.swing.sights import TripodTwist, moments
from surveyapp.core.swing.tape_zero import TapeZero, TapeZeroCoefficient
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import Reading, ReadingKind
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

MIN_POINTS = 3


@dataclass(frozen=True, slots=True)
class RunPoints:
    """Turning points of one run, ready for estimation.

    Parameters
    ----------
    rows : tuple of Reading
    values : ndarray, shape (n,)
        [rad], unwrapped relative to ``origin``.
    index : ndarray, shape (n,)
        Number of each point, missed ones counted.
    sides : ndarray, shape (n,)
        +1 right, -1 left.
    origin : float
        First reading [rad].
    resolution : float
        [rad].
    """

    rows: tuple[Reading, ...]
    values: Floats
    index: Floats
    sides: Floats
    origin: float
    resolution: float


def turning_points(
    session: OrientationSession, kind: ReadingKind = ReadingKind.REVERSAL
) -> RunPoints:
    """Collect the live turning points of one session; missed ones count in the index."""
    swing = session.book.of_kind(kind, ReadingKind.MISSED)
    numbered = [(i, row) for i, row in enumerate(swing) if row.kind is kind]
    rows = tuple(row for _, row in numbered)
    need_points(session, found=len(rows), needed=MIN_POINTS, kind=kind.value)
    index = np.array([i for i, _ in numbered], dtype=np.float64)
    readings = np.array([row.value for row in rows], dtype=np.float64)
    sides = side_signs(rows)
    if np.unique(sides).size < 2:
        raise session_problem(
            session,
            "the turning points do not swing: nothing tells left from right",
            found=said("{size} points on one side, or all with one reading", size=len(rows)),
            expected="points on both sides of north",
            hint="Was the gyro running, and was it released? Were points left out?",
        )
    angular = kind is ReadingKind.REVERSAL
    stated = session.resolution if angular else None
    return RunPoints(
        rows=rows,
        values=unwrap(readings) if angular else readings - readings[0],
        index=index - index[0],
        sides=sides,
        origin=float(readings[0]),
        resolution=stated if stated is not None else reading_resolution(rows),
    )


def without_tape_drift(
    points: RunPoints, zero: TapeZero | None, coefficient: TapeZeroCoefficient | None
) -> RunPoints:
    """Refer every turning point to the tape zero at the middle of the run.

    A zero that changes from before to after moves the middle of the swing while it is observed:
    the known regressor -lambda mu d(t) of physics.md section 4.
    """
    times = moments(points.rows)
    if zero is None or coefficient is None or times is None or zero.drift_div_per_s == 0.0:
        return points
    return replace(points, values=points.values + coefficient.value * zero.drift_at(times))


def without_twist(points: RunPoints, twist: TripodTwist | None) -> RunPoints:
    """Refer every turning point to the circle as it stood at the middle of the observation."""
    times = moments(points.rows)
    if twist is None or times is None:
        return points
    return replace(points, values=points.values - twist.at(times))


def period_from_times(rows: Sequence[Reading], index: Floats) -> float | None:
    """Full period [s] from the moments of the turning points, None without them."""
    times = moments(rows)
    if times is None or times.size < 2 or index[-1] == index[0]:
        return None
    slope = float(np.polyfit(index, times - times[0], 1)[0])
    return 2.0 * slope if slope > 0.0 else None


def damped_fit(session: OrientationSession, points: RunPoints) -> DampedFit:
    """Fit the damped swing.

    Raises
    ------
    SurveyError
        If six turning points or more do not swing about one middle.
    """
    fit = fit_damped_swing(points.values, points.index, points.sides)
    if fit.converged or points.values.size < LEAST_SQUARES_FROM:
        return fit
    raise SurveyError(no_fit(session, points))


def no_fit(session: OrientationSession, points: RunPoints) -> Problem:
    """Say that turning points swing about no middle."""
    return Problem(
        what="the damped swing does not fit: the turning points do not swing about one middle",
        where=said("session {id}, {book_path}", id=session.id, book_path=session.book_path),
        found=said(
            "{size} turning points whose amplitude does not decay smoothly", size=points.values.size
        ),
        expected="readings alternating about north with slowly falling amplitude",
        hint="Look for a mistyped degree or a missed turning point.",
    )
