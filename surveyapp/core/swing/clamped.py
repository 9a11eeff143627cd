"""The rows of a clamped swing: clamp reading, scale turning points, timed passages, in order.

What is impossible is refused here: a missing clamp, a passage without its time or out of order, a
reading beyond the scale, a swing read on one side only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.book.resolution import reading_resolution, rounding_sigma
from surveyapp.core.swing.gyrofit import side_signs
from surveyapp.core.swing.reduction import need_points
from surveyapp.core.swing.sights import moments
from surveyapp.core.swing.swingfit import ClampedSwing, estimate_period
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import Reading, ReadingKind
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, circular_mean
from surveyapp_models.arrays import Floats

SCALE_RANGE_DIV = 15.0
"""Half length of the gyro scale (physics.md 2.6: +-15 div)."""
NOMINAL_SIGMA_DIV, NOMINAL_SIGMA_S = 0.1, 0.2
"""Relative weights where the card states none (physics.md 2.2, 2.3)."""
LEAST_OF_SCALE = {"amplitude": 3, "transit": 2}
"""Fewest turning points on the scale that a method lives on."""
LEAST_FOR_RESOLUTION = 4
SAME_CLAMPING = math.radians(0.1)


@dataclass(frozen=True, slots=True)
class Observed:
    """The swing of one session as it was observed."""

    swing: ClampedSwing
    readings: tuple[Reading, ...]
    passages: tuple[Reading, ...]
    period_s: float | None


def session_problem(
    session: OrientationSession, what: str, *, found: str, expected: str, hint: str
) -> SurveyError:
    """Say what is wrong with the book of one session."""
    return SurveyError(
        Problem(
            what=what,
            where=said("session {id}, {book_path}", id=session.id, book_path=session.book_path),
            found=found,
            expected=expected,
            hint=hint,
        )
    )


def clamp_reading(session: OrientationSession) -> tuple[float, float]:
    """Circle reading N' of the clamped alidade [rad] and the sigma of its rounding."""
    rows = session.book.of_kind(ReadingKind.CLAMP)
    if not rows:
        raise session_problem(
            session,
            said(
                "the method {method} needs the circle reading of the clamped alidade",
                method=session.method,
            ),
            found="no clamp row",
            expected="one clamp row before the swing",
            hint="Enter the circle reading at which the alidade was clamped.",
        )
    values = [row.value for row in rows if row.value is not None]
    if max(abs(v - values[0]) for v in values) > SAME_CLAMPING:
        raise session_problem(
            session,
            "the alidade was clamped at different readings within one session",
            found=", ".join(row.text for row in rows),
            expected="one clamping (repeated readings of it may differ by reading errors only)",
            hint="Make a session of its own of every clamping.",
        )
    resolution = session.resolution or circle_resolution(session, rows)
    return circular_mean(values), rounding_sigma(resolution) / math.sqrt(len(values))


def circle_resolution(session: OrientationSession, rows: Sequence[Reading]) -> float:
    """Resolution of the circle [rad] from clamp and sights together.

    One clamp reading that happens to be round says nothing: below four readings of the circle the
    last written digit counts.
    """
    together = [*rows, *session.book.of_kind(ReadingKind.BACKSIGHT)]
    if len(together) >= LEAST_FOR_RESOLUTION and len({row.unit for row in together}) == 1:
        return reading_resolution(together)
    text, unit = rows[0].text.strip(), rows[0].unit
    decimals = len(text.partition(".")[2].rstrip("\"' "))
    size = {"gon": math.pi / 200.0, "deg": math.pi / 180.0}.get(unit, ARCSEC)
    return float(size * 10.0**-decimals)


@dataclass(frozen=True, slots=True)
class NumberedRows:
    """Rows of a clamped swing with the number of the turning point at or before them.

    Parameters
    ----------
    readings, passages : tuple of (int, Reading)
        The first turning point of the book has the number 0; a passage before it -1.
    last : int
        Number of the last turning point, read or missed or implied; -1 before the first.
    at_passage : bool
        Whether the last row is a passage: a turning point comes next.
    """

    readings: tuple[tuple[int, Reading], ...]
    passages: tuple[tuple[int, Reading], ...]
    last: int
    at_passage: bool


def number_rows(session: OrientationSession) -> NumberedRows:
    """Number the scale turning points, and the passages by the turning point before each."""
    kinds = (ReadingKind.SCALE_REVERSAL, ReadingKind.MISSED, ReadingKind.TRANSIT)
    turning = -1
    readings: list[tuple[int, Reading]] = []
    passages: list[tuple[int, Reading]] = []
    last: Reading | None = None
    for row in session.book.of_kind(*kinds):
        if row.kind is ReadingKind.TRANSIT:
            if last is not None and last.value == row.value:
                turning += 1  # a turning point that nobody read lies between
            passages.append((turning, row))
            last = row
            continue
        turning += 1
        last = None
        if row.kind is ReadingKind.SCALE_REVERSAL:
            readings.append((turning, row))
    return NumberedRows(tuple(readings), tuple(passages), turning, last is not None)


def triples_of(after: Sequence[float]) -> list[int]:
    """Places of the first of every three passages in a row."""
    return [
        i
        for i in range(len(after) - 2)
        if after[i + 2] - after[i] == 2 and after[i + 1] - after[i] == 1
    ]


def check_rows(session: OrientationSession) -> None:
    """Refuse what is impossible in a clamped swing, however few its rows are so far.

    Raises
    ------
    SurveyError
        For different clampings, a reading beyond the scale, passages without time or out of order.
    """
    if session.book.of_kind(ReadingKind.CLAMP):
        clamp_reading(session)
    check_scale(session)
    passages = number_rows(session).passages
    times = _passage_times(session, tuple(row for _, row in passages))
    _check_order(session, times, np.array([turn for turn, _ in passages], dtype=np.float64))


def _passage_times(session: OrientationSession, rows: tuple[Reading, ...]) -> Floats:
    times = moments(rows) if rows else np.empty(0)
    if times is None:
        raise session_problem(
            session,
            "timed passages need their times",
            found="transit rows without elapsed_s",
            expected="elapsed_s on every transit row",
            hint="A passage without its moment says nothing: strike it or add the time.",
        )
    return times


def observe(session: OrientationSession, card: InstrumentCard) -> Observed:
    """Collect scale readings and passages, number the turning points, check what is impossible."""
    check_scale(session)
    rows = number_rows(session)
    readings, passages = rows.readings, rows.passages
    need_points(
        session, found=len(readings), needed=LEAST_OF_SCALE["transit"], kind="scale_reversal"
    )
    first = readings[0][0]
    passage_rows = tuple(row for _, row in passages)
    times = _passage_times(session, passage_rows)
    after = np.array([turn - first for turn, _ in passages], dtype=np.float64)
    _check_order(session, times, after)
    swing = ClampedSwing(
        readings=np.array([row.value for _, row in readings], dtype=np.float64),
        index=np.array([turn - first for turn, _ in readings], dtype=np.float64),
        sides=side_signs(row for _, row in readings),
        passages_s=times,
        divisions=np.array([row.value for row in passage_rows], dtype=np.float64),
        after=after,
        sigma_div=card.sigma.scale_div or NOMINAL_SIGMA_DIV,
        sigma_s=card.sigma.time_s or NOMINAL_SIGMA_S,
    )
    if np.unique(swing.sides).size < 2:
        raise session_problem(
            session,
            "the scale was read on one side of the swing only",
            found=said("{size} readings on one side", size=len(readings)),
            expected="turning points on both sides",
            hint="The amplitude is half the distance of the two sides.",
        )
    swing = replace(swing, sides=swing.sides * polarity(swing.readings, swing.sides))
    return Observed(swing, tuple(row for _, row in readings), passage_rows, estimate_period(swing))


def polarity(readings: Floats, sides: Floats) -> float:
    """-1 where the sides are written as east and west and the scale reads the other way, else +1.

    The fits take +1 for the larger reading; which way the scale reads stands in the sign of the
    scale value alone.
    """
    right, left = readings[sides > 0], readings[sides < 0]
    return -1.0 if float(right.mean()) < float(left.mean()) else 1.0


def check_scale(session: OrientationSession) -> None:
    """Refuse readings beyond the scale."""
    rows = session.book.of_kind(ReadingKind.SCALE_REVERSAL)
    beyond = [row for row in rows if row.value is not None and abs(row.value) > SCALE_RANGE_DIV]
    if beyond:
        raise SurveyError(
            Problem(
                what="the amplitude lies beyond the scale",
                where=said(
                    "session {id}, {book_path} line {line} (seq {seq})",
                    id=session.id,
                    book_path=session.book_path,
                    line=row.line,
                    seq=row.seq,
                ),
                found=said("{text} div", text=row.text),
                expected=said(
                    "-{scale_range_div:g} to +{scale_range_div:g} div",
                    scale_range_div=SCALE_RANGE_DIV,
                ),
                hint="Damp the swing or clamp nearer to north; check the decimal point.",
            )
            for row in beyond
        )


def _check_order(session: OrientationSession, times: Floats, after: Floats) -> None:
    if times.size > 1 and np.any((np.diff(times) <= 0.0) | (np.diff(after) < 0.0)):
        raise session_problem(
            session,
            "passages out of order",
            found="a transit whose time is not later than that of the transit before",
            expected="strictly increasing times",
            hint="Correct the times or strike the wrong passage.",
        )
