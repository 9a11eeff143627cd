"""Axes of gyros and accelerometers that do not belong together, found by gravity after turns.

Up is carried through every turn by the gyros and compared with what the accelerometers feel after
it. Where it misses by tens of degrees, another order or sign of the columns, or another unit of the
rates, may make it fit: that is told, never taken.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.hand_held import Turn, direction_errors
from surveyapp.errors import Problem
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

NOTICED: Final = math.radians(10.0)
"""Misfit of gravity after turns above which axes and units are looked at: three times what scale
factors of 3 % and misalignments of a degree make of a turn of 90 degrees."""

BETTER: Final = 4.0
"""Another arrangement must miss so many times less."""

LOOKED_AT: Final = 12
"""Turns that are tried, the largest."""

UNITS: Final = {
    "rad/s": 1.0,
    "deg/s": math.radians(1.0),
    "deg/h": math.radians(1.0) / 3600.0,
}
"""Unit that the rates may be in, and what makes rad/s of it."""


@dataclass(frozen=True, slots=True)
class Fitting:
    """True rate = matrix output, of rates in a unit, and how far it misses gravity [rad]."""

    matrix: Floats
    unit: str
    misfit: float


def axes_problem(turns: Sequence[Turn], where: str) -> Problem | None:
    """What is wrong with axes or unit of the gyros; None where gravity fits or nothing does.

    Parameters
    ----------
    turns : sequence of Turn
    where : str
        For messages.
    """
    largest = sorted(turns, key=lambda t: float(t.before @ t.after))[:LOOKED_AT]
    as_given = _misfit(largest, np.eye(3))
    if as_given <= NOTICED:
        return None
    tried = [
        Fitting(matrix * factor, unit, _misfit(largest, matrix * factor))
        for unit, factor in UNITS.items()
        for matrix in _arrangements()
    ]
    best = min(tried, key=lambda one: one.misfit)
    if best.misfit > NOTICED or best.misfit * BETTER > as_given:
        return None
    return _told(best, as_given, where)


def _misfit(turns: Sequence[Turn], matrix: Floats) -> float:
    errors = direction_errors(turns, matrix)
    return math.sqrt(float(np.mean(np.sum(errors**2, axis=1))))


def _arrangements() -> list[Floats]:
    """The 48 orders and signs of three axes; the given one first."""
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), order] = signs
            found.append(matrix)
    return found


def _told(best: Fitting, as_given: float, where: str) -> Problem:
    turn = np.rint(best.matrix / np.abs(best.matrix).max())
    # the force turned instead: up and down are carried alike, so that its sign is free
    force = min((turn.T, -turn.T), key=_changes)
    name, shown = ("gyr", turn) if _changes(turn) <= _changes(force) else ("acc", force)
    found = said(
        "gravity carried through the turns misses what is felt by {degrees:.0f} degrees",
        degrees=math.degrees(as_given),
    )
    if _changes(turn) == 0:
        return Problem(
            said("the gyros are in another unit"),
            where,
            found,
            said("as {unit}: {degrees:.1f} degrees", unit=best.unit, degrees=_degrees(best)),
            said("`units` COLUMN={unit} for the three gyros", unit=best.unit),
        )
    return Problem(
        said("the axes of gyros and accelerometers are exchanged or one is reversed"),
        where,
        found,
        said(
            "as with {name} ({fits}) for (x, y, z): {degrees:.1f} degrees; axes right-handed",
            name=name,
            fits=_letters(shown),
            degrees=_degrees(best),
        ),
        said("exchange the columns with `columns`; `scale` COLUMN=-1 reverses one"),
    )


def _degrees(best: Fitting) -> float:
    return math.degrees(best.misfit)


def _changes(matrix: Floats) -> int:
    """Columns that are not where they belong, or reversed."""
    return int(np.count_nonzero(np.diag(matrix) != 1.0))


def _letters(matrix: Floats) -> str:
    places = np.argmax(np.abs(matrix), axis=1)
    return ", ".join(
        f"{'-' if matrix[i, j] < 0.0 else ''}{'xyz'[j]}" for i, j in enumerate(places.tolist())
    )
