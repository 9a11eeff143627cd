"""Sights of the targets: both faces, before and after, to one line reading per target.

The line reading B is the mean of both faces, referred to the middle of the observation: where the
tripod turned between the sights before and after, the turning is taken out and tested. Collimation
is shown, not believed. Nothing here knows the gyro.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.statistics.distributions import student_tail
from surveyapp.domain.readings import Face, FieldBook, Place, Reading, ReadingKind
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi, wrap_two_pi
from surveyapp_models.arrays import Floats

SIGHT_MIDDLE = (
    ReadingKind.REVERSAL,
    ReadingKind.SCALE_REVERSAL,
    ReadingKind.TRANSIT,
    ReadingKind.NORTH,
)
"""The rows whose mean moment is the middle of the observation."""

STEEPEST = math.radians(1.0)
"""A sight nearer to the vertical is no sight: its azimuth would be lost in the tilt."""


@dataclass(frozen=True, slots=True)
class Clock:
    """When the sights stood relative to the observation.

    Parameters
    ----------
    middle_s : float
        Mean moment of the observation [s].
    span_s : float
        From the mean of the sights before to that of the sights after [s].
    """

    middle_s: float
    span_s: float


@dataclass(frozen=True, slots=True)
class SightSet:
    """Reduced sights of one target.

    Parameters
    ----------
    target : str
    line_reading : float
        B [rad], both faces, at the middle of the observation.
    cofactor : float
        Variance of B divided by the variance of one pointing.
    collimation : float or None
        Half the difference of the faces (left minus right) [rad]; None with one face only.
    before, after : float or None
        Mean of the sights before and after [rad].
    drift : float or None
        After minus before [rad].
    drift_cofactor : float
        As ``cofactor``, for the drift.
    sum_of_squares : float
        v'v of the pointings [rad^2].
    dof : int
        Redundancy of the pointings.
    pointings : int
    clock : Clock or None
        None where not every row is timed.
    collimation_cofactor : float
        As ``cofactor``, for the collimation.
    largest_residual : float
        Of the pointings, absolute [rad].
    faces_known : bool
        Whether every pointing says in which face it was read.
    """

    target: str
    line_reading: float
    cofactor: float
    collimation: float | None
    before: float | None
    after: float | None
    drift: float | None
    drift_cofactor: float
    sum_of_squares: float
    dof: int
    pointings: int
    clock: Clock | None = None
    collimation_cofactor: float = 0.0
    largest_residual: float = 0.0
    faces_known: bool = True


def moments(rows: Sequence[Reading]) -> Floats | None:
    """Moments of rows [s] on one clock: all elapsed, else all dated, else None."""
    if not rows:
        return None
    if all(row.elapsed_s is not None for row in rows):
        return np.array([row.elapsed_s for row in rows], dtype=np.float64)
    if all(row.time is not None for row in rows):
        return np.array([row.time.timestamp() for row in rows if row.time is not None])
    return None


def swing_moments(
    rows: Sequence[Reading], swing: Sequence[Reading]
) -> tuple[Floats, Floats] | None:
    """Moments of rows and of the observation [s] on one clock, None where they share none.

    Of a clamped swing the passages may be the only rows that are timed: then they tell.
    """
    for own in (swing, [row for row in swing if row.kind is ReadingKind.TRANSIT]):
        times = moments([*rows, *own])
        if times is not None and own:
            return times[: len(rows)], times[len(rows) :]
    return None


def _epochs(
    book: FieldBook, rows: Sequence[Reading], swing: Sequence[Reading]
) -> tuple[Floats, Clock | None]:
    """Position of each sight relative to the middle of the observation, in units of the drift.

    With times on every row: (t - t_middle) / (t_after - t_before); without: -1/2 before, +1/2
    after, 0 during.
    """
    places = [book.place_of(row) for row in rows]
    nominal = {Place.BEFORE: -0.5, Place.DURING: 0.0, Place.AFTER: 0.5}
    positions = np.array([nominal[place] for place in places])
    times = swing_moments(rows, swing)
    if times is None:
        return positions, None
    own, middle = times[0], float(np.mean(times[1]))
    before = own[positions < 0]
    after = own[positions > 0]
    if before.size == 0 or after.size == 0:
        return positions, None
    span = float(after.mean() - before.mean())
    if span <= 0.0:
        return positions, None
    return (own - middle) / span, Clock(middle, span)


def reduce_sights(book: FieldBook, target: str, *, default_target: str | None) -> SightSet | None:
    """Reduce all sights of one target.

    Parameters
    ----------
    book : FieldBook
    target : str
        Name of the sighted station.
    default_target : str or None
        What an empty target in the book means.

    Returns
    -------
    SightSet or None
        None where the target was not sighted.
    """
    rows = [
        row
        for row in book.of_kind(ReadingKind.BACKSIGHT)
        if (row.target or default_target or "") == target and row.value is not None
    ]
    if not rows:
        return None
    swing = book.of_kind(*SIGHT_MIDDLE)
    epochs, clock = _epochs(book, rows, swing)
    faces = np.array([-1.0 if row.face is Face.RIGHT else 1.0 for row in rows])
    origin = _as_face_left(rows[0])
    values = np.array([wrap_pi(_as_face_left(row) - origin) for row in rows])
    found = _solve(target, origin, values, faces=faces, epochs=epochs)
    known = all(row.face is not None for row in rows)
    return replace(found, clock=clock, faces_known=known)


def _as_face_left(row: Reading) -> float:
    value = row.value if row.value is not None else math.nan
    return value + math.pi if row.face is Face.RIGHT else value


def _solve(
    target: str, origin: float, values: Floats, *, faces: Floats, epochs: Floats
) -> SightSet:
    """Least squares of B, collimation and drift, as far as the sights determine them."""
    both_faces = bool(np.any(faces > 0) and np.any(faces < 0))
    both_places = bool(np.any(epochs < 0) and np.any(epochs > 0))
    columns = [np.ones_like(values)]
    if both_faces:
        columns.append(faces)
    if both_places:
        columns.append(epochs)
    basis = np.column_stack(columns)
    solution, _, rank, _ = np.linalg.lstsq(basis, values, rcond=None)
    if rank < basis.shape[1]:  # one face before, the other after: collimation and drift are one
        basis = basis[:, :-1]
        both_places = False
        solution = np.linalg.lstsq(basis, values, rcond=None)[0]
    inverse = np.linalg.pinv(basis)
    residuals = values - basis @ solution
    drift = float(solution[-1]) if both_places else None
    return SightSet(
        target=target,
        line_reading=wrap_two_pi(origin + float(solution[0])),
        cofactor=float(inverse[0] @ inverse[0]),
        collimation=float(solution[1]) if both_faces else None,
        before=_mean_at(origin, values, epochs < 0, faces),
        after=_mean_at(origin, values, epochs > 0, faces),
        drift=drift,
        drift_cofactor=float(inverse[-1] @ inverse[-1]) if both_places else 0.0,
        sum_of_squares=float(residuals @ residuals),
        dof=int(values.size - basis.shape[1]),
        pointings=int(values.size),
        collimation_cofactor=float(inverse[1] @ inverse[1]) if both_faces else 0.0,
        largest_residual=float(np.max(np.abs(residuals))),
    )


def _mean_at(
    origin: float, values: Floats, chosen: NDArray[np.bool_], faces: Floats
) -> float | None:
    left, right = values[chosen & (faces > 0)], values[chosen & (faces < 0)]
    means = [float(part.mean()) for part in (left, right) if part.size]
    return wrap_two_pi(origin + sum(means) / len(means)) if means else None


def drift_probability(sights: SightSet, *, sigma: float, dof: float) -> float | None:
    """Two-sided probability of a drift this large if the tripod stood still, None without one.

    ``sigma`` and sights [rad].
    """
    if sights.drift is None or sigma <= 0.0:
        return None
    ratio = abs(sights.drift) / (sigma * math.sqrt(sights.drift_cofactor))
    return 2.0 * student_tail(ratio, dof)


@dataclass(frozen=True, slots=True)
class TripodTwist:
    """A tripod that turned under the instrument while the swing was observed.

    Parameters
    ----------
    rate : float
        Change of the circle reading of a fixed direction [rad/s].
    middle_s : float
        Moment to which everything is referred [s].
    """

    rate: float
    middle_s: float

    def at(self, times: Floats) -> Floats:
        """Circle reading of a fixed direction minus that at the middle [rad]."""
        return self.rate * (times - self.middle_s)


def tripod_twist(sets: Sequence[SightSet]) -> TripodTwist | None:
    """Turning of the tripod from the sights of all targets, None where nothing is timed.

    What the line reading is freed of the swing is freed of as well: the middle of the run does not
    feel it, but its residuals would (physics.md section 4).
    """
    timed = [
        (item.drift, item.drift_cofactor, item.clock)
        for item in sets
        if item.drift is not None and item.clock is not None and item.drift_cofactor > 0.0
    ]
    if not timed:
        return None
    total = math.fsum(1.0 / cofactor for _, cofactor, _ in timed)
    rate = math.fsum(drift / clock.span_s / cofactor for drift, cofactor, clock in timed) / total
    return TripodTwist(rate, timed[0][2].middle_s)


def zenith_angle(book: FieldBook, target: str, *, default_target: str | None) -> float | None:
    """Mean zenith angle [rad] of one target from both faces, None where it was not read."""
    values = []
    for row in book.of_kind(ReadingKind.ZENITH):
        if (row.target or default_target or "") != target or row.value is None:
            continue
        upper = row.value
        values.append(2.0 * math.pi - upper if upper > math.pi else upper)
    if not values:
        return None
    mean = float(np.mean(values))
    if math.sin(mean) < math.sin(STEEPEST):
        raise SurveyError(
            Problem(
                what="a sight straight up or down has no azimuth",
                where=said("zenith angles of {target}", target=target),
                found=said("{value:.3f} degrees", value=math.degrees(mean)),
                expected="at least 1 degree from the vertical",
                hint="Was an elevation angle entered instead of a zenith angle?",
            )
        )
    return mean


def eccentric_correction(*, line_reading: float, direction: float, ratio: float, at: str) -> float:
    """What is added to a line reading taken beside a mark.

    Parameters
    ----------
    line_reading : float
        B as read [rad].
    direction : float
        Circle reading from where instrument (or target) stood towards its mark [rad].
    ratio : float
        Eccentric distance divided by the distance of the marks [-].
    at : str
        ``station`` or ``target``.

    Notes
    -----
    With u(x) the unit vector of circle direction x, the instrument at S' = S - e u(direction) sees
    the target at S + D u(B + delta): sin(delta) = -(e/D) sin(direction - B); a target standing at
    T' = T - e u(direction) changes the sign.
    """
    delta = math.asin(ratio * math.sin(direction - line_reading))
    return -delta if at == "station" else delta
