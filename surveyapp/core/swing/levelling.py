"""What a tilt of the standing axis does to sights and to the tape zero.

Level readings are along (positive where the target's side is low) and across (positive where the
right side is low), of the session's target. Across a direction d clockwise from it the tilt is
v_T = across cos d - along sin d; a circle reading at the zenith angle z is then corrected by
v_T cot z (first order; checked against exact rotations). Both faces have it alike.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from surveyapp.core.book.resolution import reading_resolution, rounding_sigma
from surveyapp.core.swing.sights import reduce_sights
from surveyapp.domain.project import OrientationSession, Station, grid_distance_m
from surveyapp.domain.readings import FieldBook, Reading, ReadingKind

LEVELS: Final = (ReadingKind.LEVEL_ALONG, ReadingKind.LEVEL_ACROSS)
RUN: Final = frozenset(
    {
        ReadingKind.REVERSAL,
        ReadingKind.SCALE_REVERSAL,
        ReadingKind.TRANSIT,
        ReadingKind.CLAMP,
        ReadingKind.NORTH,
        ReadingKind.AZIMUTH,
        ReadingKind.MISSED,
    }
)
ASIDE: Final = frozenset(
    {
        *LEVELS,
        ReadingKind.TEMPERATURE,
        ReadingKind.SUPPLY,
        ReadingKind.NOTE,
        ReadingKind.STRIKE,
        ReadingKind.ZENITH,
    }
)
"""Rows that say nothing of the block in which they stand."""


@dataclass(frozen=True, slots=True)
class Tilt:
    """Tilt of the standing axis during a block.

    Parameters
    ----------
    along, across : float
        Mean readings [rad].
    sigma : float
        Of each [rad]: from their scatter, not below rounding.
    count : int
        Readings of the axis that was read less often.
    logged : bool
        From a calibrated log: its sigma is the whole one.
    """

    along: float
    across: float
    sigma: float
    count: int
    logged: bool = False

    def across_direction(self, direction: float) -> float:
        """v_T across a direction [rad], clockwise from the session's target."""
        return self.across * math.cos(direction) - self.along * math.sin(direction)


def in_tape_zero(book: FieldBook, row: Reading) -> bool:
    """Whether a level row stands next to the tape zero and not next to the run.

    Parameters
    ----------
    book : FieldBook
    row : Reading
        Of the book.
    """
    index = book.live.index(row)
    before = next((r.kind for r in reversed(book.live[:index]) if r.kind not in ASIDE), None)
    after = next((r.kind for r in book.live[index + 1 :] if r.kind not in ASIDE), None)
    return not {before, after} & RUN and ReadingKind.TAPE_ZERO in (before, after)


def tilt_of(book: FieldBook, *, tape_zero: bool) -> Tilt | None:
    """Tilt during the tape zero, or during everything else; None unless both axes were read.

    Parameters
    ----------
    book : FieldBook
    tape_zero : bool
    """
    values: list[list[float]] = []
    sigmas = []
    for kind in LEVELS:
        rows = [
            row
            for row in book.of_kind(kind)
            if row.value is not None and in_tape_zero(book, row) is tape_zero
        ]
        if not rows:
            return None
        own = [row.value for row in rows if row.value is not None]
        mean = math.fsum(own) / len(own)
        rounding = rounding_sigma(reading_resolution(rows))
        scatter = 0.0
        if len(own) > 1:
            squares = math.fsum((v - mean) ** 2 for v in own)
            scatter = math.sqrt(squares / (len(own) - 1) / len(own))
        values.append(own)
        sigmas.append(max(scatter, rounding))
    along, across = (math.fsum(own) / len(own) for own in values)
    return Tilt(along, across, max(sigmas), min(len(own) for own in values))


def session_tilt(session: OrientationSession, *, tape_zero: bool) -> Tilt | None:
    """Tilt from the session's calibrated log, else from its level rows.

    Parameters
    ----------
    session : OrientationSession
    tape_zero : bool
        During the tape zero, or during everything else.
    """
    log = session.levelling
    if log is not None and log.run is not None:
        block = log.tape_zero if tape_zero else log.run
        if block is None:
            return None
        return Tilt(block.along, block.across, block.sigma, block.samples, logged=True)
    return tilt_of(session.book, tape_zero=tape_zero)


def steepness(
    session: OrientationSession,
    target: str,
    stations: Mapping[str, Station],
    zenith: float | None,
) -> float:
    """Cot z of a sight: from its zenith angle, else from the heights, else 0 (level).

    Parameters
    ----------
    session : OrientationSession
    target : str
    stations : mapping of str to Station
    zenith : float or None
        Mean zenith angle of the target [rad].
    """
    if zenith is not None:
        return math.cos(zenith) / math.sin(zenith)
    start, end = stations.get(session.station), stations.get(target)
    if start is None or end is None or start.h is None or end.h is None:
        return 0.0
    distance = grid_distance_m(start, end)
    return (end.h - start.h) / distance if distance else 0.0


def sight_correction(tilt: Tilt, *, direction: float, cotangent: float) -> float:
    """What is added to a circle reading [rad]: v_T cot z.

    Parameters
    ----------
    tilt : Tilt
    direction : float
        Of the sight, clockwise from the session's target [rad].
    cotangent : float
        Of its zenith angle.
    """
    return tilt.across_direction(direction) * cotangent


def tilt_change_across_north(session: OrientationSession, north: float) -> float | None:
    """v_N during the run minus v_N during the tape zero [rad].

    A zero that was observed under the tilt of the run contains it already; only what changed
    between them moves it.

    Parameters
    ----------
    session : OrientationSession
    north : float
        Circle reading of gyro north; minutes do not matter [rad].

    Returns
    -------
    float or None
        None unless both blocks have both levels and the target was sighted.
    """
    run, zero = (session_tilt(session, tape_zero=value) for value in (False, True))
    if run is None or zero is None:
        return None
    sights = reduce_sights(session.book, session.target or "", default_target=session.target)
    if sights is None:
        return None
    direction = north - sights.line_reading
    return run.across_direction(direction) - zero.across_direction(direction)
