"""Sides of turning points: east or west of the swing, from labels or from the readings.

Consecutive turning points lie on opposite sides; a missed point takes part in the count. R is the
larger reading. Circle readings are unwrapped about the first one, so that swings across 0/360
work. Nothing here knows strikes or files.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from surveyapp.domain.readings import Reading, ReadingKind, Side
from surveyapp.errors import Problem
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi

TURNING_KINDS: Final = frozenset(
    {ReadingKind.REVERSAL, ReadingKind.SCALE_REVERSAL, ReadingKind.TAPE_ZERO}
)
_SHORT_STEP: Final = 0.25
"""A step below this share of its neighbour joins two points of one side: a swing would have to
lose three quarters of its width in one half swing, where 10 % is already a faulty gyro."""
_WIDE_STEP: Final = 0.5
"""Two points of one side that differ by more than this share of the swing's width are on two."""
_MISSED_HINT: Final = said(
    "a turning point that was not read is entered as a row of kind missed; a wrong one is struck"
)


@dataclass(frozen=True, slots=True)
class Agreement:
    """How well a sequence of turning points alternates; larger is better.

    Parameters
    ----------
    labels_fit : bool
        Whether the sides as written fit the count.
    margin : float
        Smallest reading of the upper side minus the largest of the lower; minus infinity where
        only one side is present.
    """

    labels_fit: bool
    margin: float


def unwrapped(points: Sequence[Reading]) -> list[float | None]:
    """Values of one swing with circle readings unwrapped about the first."""
    first = next((p.value for p in points if p.value is not None), 0.0)
    circle = any(p.kind is ReadingKind.REVERSAL for p in points)
    return [
        None if p.value is None else (first + wrap_pi(p.value - first) if circle else p.value)
        for p in points
    ]


def agreement(points: Sequence[Reading]) -> Agreement:
    """Judge whether the points alternate, counting points without a value."""
    values = unwrapped(points)
    parities = {
        (index + (p.side is Side.RIGHT)) % 2 for index, p in enumerate(points) if p.side is not None
    }
    sides: tuple[list[float], list[float]] = ([], [])
    for index, value in enumerate(values):
        if value is not None:
            sides[index % 2].append(value)
    margin = -math.inf
    if sides[0] and sides[1]:
        margin = max(min(sides[0]) - max(sides[1]), min(sides[1]) - max(sides[0]))
    return Agreement(len(parities) < 2, margin)


def sides_of_swing(
    points: Sequence[Reading], *, where: str, tolerance: float
) -> tuple[list[Side | None], list[Problem]]:
    """Side of every turning point of one swing.

    Parameters
    ----------
    points : sequence of Reading
        Live turning points of one kind and the ``missed`` among them, in order.
    where : str
        The book, for messages.
    tolerance : float
        A swing no wider than this, in the unit of the values, has no sides (a tape at rest).

    Returns
    -------
    sides : list of Side or None
        One for each point; None for all where nothing tells them apart.
    problems : list of Problem
        Two equal sides in a row, and labels that contradict the readings.
    """
    values = unwrapped(points)
    problem = _label_problem(points, where)
    if problem is not None:
        return [p.side for p in points], [problem]
    labelled = next((i for i, p in enumerate(points) if p.side is not None), None)
    known = [v for v in values if v is not None]
    if labelled is None and (len(known) < 2 or max(known) - min(known) <= tolerance):
        return [None] * len(points), []
    if labelled is None:
        problem = _step_problem(points, values, where)
        if problem is not None:
            return [None] * len(points), [problem]
        right = _larger_parity(values)
    else:
        right = (labelled + (points[labelled].side is Side.LEFT)) % 2
        problem = _polarity_problem(points, values, where)
    sides: list[Side | None] = [
        Side.RIGHT if index % 2 == right else Side.LEFT for index in range(len(points))
    ]
    return sides, [] if problem is None else [problem]


def _place(where: str, row: Reading) -> str:
    return said("{where}, line {line} (seq {seq})", where=where, line=row.line, seq=row.seq)


def _label_problem(points: Sequence[Reading], where: str) -> Problem | None:
    labelled = [(i, p) for i, p in enumerate(points) if p.side is not None]
    for (i, before), (j, after) in pairwise(labelled):
        if (before.side is after.side) != ((j - i) % 2 == 0):
            return _equal_sides(
                before, after, where, said("side {side} out of turn", side=after.side)
            )
    return None


def _equal_sides(before: Reading, after: Reading, where: str, found: str) -> Problem:
    return Problem(
        said(
            "the turning points do not alternate: seq {seq} and {seq2} are on one side",
            seq=before.seq,
            seq2=after.seq,
        ),
        _place(where, after),
        found,
        said("left and right in turn"),
        _MISSED_HINT,
    )


def _step_problem(
    points: Sequence[Reading], values: Sequence[float | None], where: str
) -> Problem | None:
    """Find two points of one side that follow each other, by magnitude alone."""
    steps = [
        (i, b - a) for i, (a, b) in enumerate(pairwise(values)) if a is not None and b is not None
    ]
    for (i, first), (j, second) in pairwise(steps):
        if j != i + 1:
            continue
        if first * second >= 0.0 or not _SHORT_STEP <= abs(second / first) <= 1.0 / _SHORT_STEP:
            k = i if abs(first) < abs(second) else j
            found = said("{text} then {text2}", text=points[k].text, text2=points[k + 1].text)
            return _equal_sides(points[k], points[k + 1], where, found)
    return _gap_problem(points, values, where)


def _gap_problem(
    points: Sequence[Reading], values: Sequence[float | None], where: str
) -> Problem | None:
    """Steps across missed points: the polarity of all others, and none that crosses the swing."""
    known = [(i, v) for i, v in enumerate(values) if v is not None]
    steps = [(i, j, b - a) for (i, a), (j, b) in pairwise(known)]
    across = [(i, j, step) for i, j, step in steps if (j - i) % 2 == 1]
    width = max((abs(step) for _, _, step in across), default=math.inf)
    for i, j, step in steps:
        if (j - i) % 2 == 0 and abs(step) > _WIDE_STEP * width:
            return Problem(
                said(
                    "seq {seq} and {seq2} lie on different sides, but the count of missed "
                    "points between them puts them on one",
                    seq=points[i].seq,
                    seq2=points[j].seq,
                ),
                _place(where, points[j]),
                said("{text} then {text2}", text=points[i].text, text2=points[j].text),
                said("left and right in turn"),
                _MISSED_HINT,
            )
    expected = across[0][2] * (-1) ** across[0][0] if across else 0.0
    for i, j, step in across:
        if step * (-1) ** i * expected < 0.0:
            found = said("{text} then {text2}", text=points[i].text, text2=points[j].text)
            return _equal_sides(points[i], points[j], where, found)
    return None


def _larger_parity(values: Sequence[float | None]) -> int:
    """Parity of the points with the larger readings."""
    rise = 0.0
    known = [(i, v) for i, v in enumerate(values) if v is not None]
    for (i, a), (j, b) in pairwise(known):
        if (j - i) % 2 == 1:
            rise += (b - a) * (1 if i % 2 == 0 else -1)
    if rise == 0.0 and known:  # one side only: judged by nothing, counted from the first
        return known[0][0] % 2
    return 1 if rise > 0.0 else 0


def _polarity_problem(
    points: Sequence[Reading], values: Sequence[float | None], where: str
) -> Problem | None:
    """Labels against readings: R is larger on the circle; a scale may read the other way."""
    known = [(i, v) for i, v in enumerate(values) if v is not None]
    labelled = next(i for i, p in enumerate(points) if p.side is not None)
    right = (labelled + (points[labelled].side is Side.LEFT)) % 2
    circle = any(p.kind is ReadingKind.REVERSAL for p in points)
    polarity = 1.0 if circle else 0.0
    for (i, a), (j, b) in pairwise(known):
        if (j - i) % 2 == 0 or a == b:
            continue
        rise = (b - a) if j % 2 == right else (a - b)
        if polarity == 0.0:
            polarity = rise
        if rise * polarity < 0.0:
            return Problem(
                said("the side contradicts the readings"),
                _place(where, points[j]),
                said("{text} then {text2}", text=points[i].text, text2=points[j].text),
                said("R is the larger reading") if circle else said("one polarity throughout"),
                said("exchange the sides, or strike the reading and enter it anew"),
            )
    return None
