"""Whether magnetometer and accelerometer of a compass are seen in the same axes.

The angle between the earth's field and up is the same in every attitude: field m, specific force
a of unit length, hard iron b give m a = c + b a, linear in c and b. Where the columns are exchanged
or one is reversed that fails, and another arrangement of the axes holds.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from surveyapp.domain.sensor_log import TRIPLES, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

ROWS: Final = 2000
"""Rows that are looked at, evenly taken."""

BETTER: Final = 3.0
"""Another arrangement must leave so many times less."""

NOTICED: Final = 0.02
"""What is left, as a share of the field, below which the axes are not doubted: 1 degree of dip."""

LOOSE: Final = 0.2
"""Share of the whole field above which no arrangement fits: soft iron of 15 % leaves up to .15,
forces by chance .58."""

MIRRORED: Final = 3.0
"""A shown heading that runs against the known one: the resultant of their sum over that of their
difference."""

Arrangement = tuple[tuple[int, int, int], tuple[float, float, float]]


def check_axes(log: SensorLog) -> tuple[ResultWarning, ...]:
    """Refuse exchanged axes; warn where the forces fit in no way, or the field points up.

    Parameters
    ----------
    log : SensorLog
        ``mag_*`` [uT], ``acc_*`` [m/s2] where recorded.

    Raises
    ------
    SurveyError
        If another arrangement of the axes holds and the given one does not.
    """
    acc = log.vector("acc")
    if acc is None or log.size < 20:
        return ()
    every = max(log.size // ROWS, 1)
    field = np.column_stack([log.columns[f"mag_{a}_uT"] for a in "xyz"])[::every]
    up = acc[::every]
    size = np.linalg.norm(up, axis=1)
    if not bool(np.all(size > 0.0)):
        return ()
    up = up / size[:, None]
    left = {found: _left(field, up, found) for found in _arrangements()}
    as_given = left[_GIVEN]
    best = min(left, key=lambda found: left[found])
    scale = float(np.median(np.linalg.norm(field - field.mean(axis=0), axis=1)))
    if as_given > NOTICED * scale and as_given > BETTER * left[best]:
        raise SurveyError(_exchanged(log.path, (as_given, left[best]), best))
    size_of_field = float(np.median(np.linalg.norm(field, axis=1)))
    if as_given > LOOSE * size_of_field:
        text = said(
            "the specific force does not belong to the field: the dip scatters by "
            "{value:.1f} degrees; was the compass moved jerkily, or are the axes "
            "those of another sensor? The dip of an ellipsoid is not taken from it",
            value=np.degrees(np.arctan(as_given / scale)),
        )
        return (ResultWarning("acc_does_not_fit", text),)
    return ()


_GIVEN: Final[Arrangement] = ((0, 1, 2), (1.0, 1.0, 1.0))


def _arrangements() -> list[Arrangement]:
    """Every order and sign of three axes; one of each pair of opposites, as both fit alike."""
    signs = [(1.0, 1.0, 1.0), (1.0, 1.0, -1.0), (1.0, -1.0, 1.0), (-1.0, 1.0, 1.0)]
    return [(order, sign) for order in _orders() for sign in signs]


def _orders() -> list[tuple[int, int, int]]:
    return [(a, b, c) for a, b, c in itertools.permutations(range(3))]


def _left(field: Floats, up: Floats, found: Arrangement) -> float:
    """Root mean square of m a about c + b a for the forces so arranged [uT]."""
    order, sign = found
    turned = up[:, list(order)] * np.array(sign)
    product = np.sum(field * turned, axis=1)
    design = np.column_stack([np.ones(len(turned)), turned])
    solution = np.linalg.lstsq(design, product, rcond=1e-6)[0]
    return float(np.sqrt(np.mean((product - design @ solution) ** 2)))


def refuse_mirrored(known: Floats, shown: Floats, where: str) -> None:
    """Refuse a swing whose shown heading runs backwards: x and y exchanged, or one reversed.

    Parameters
    ----------
    known, shown : ndarray, shape (n,)
        Headings [rad].

    Raises
    ------
    SurveyError
    """
    against = abs(np.mean(np.exp(1j * (known + shown))))
    along = abs(np.mean(np.exp(1j * (known - shown))))
    if against > 0.7 and against > MIRRORED * along:
        raise SurveyError(
            Problem(
                said("the shown heading runs against the known one"),
                where,
                said("x and y are exchanged, one of them is reversed, or z points down"),
                said("x towards the mark, y to the left, z up; headings clockwise"),
                said("exchange the columns with `columns`; `scale` COLUMN=-1 reverses one"),
            )
        )


def without_force(log: SensorLog) -> SensorLog:
    """The log without its specific force, where that does not belong to the field."""
    columns = {k: v for k, v in log.columns.items() if k not in TRIPLES["acc"]}
    return replace(log, columns=columns)


def _exchanged(where: str, left: Sequence[float], found: Arrangement) -> Problem:
    order, sign = found
    fits = ", ".join(
        f"{'-' if s < 0.0 else ''}{'xyz'[i]}" for i, s in zip(order, sign, strict=True)
    )
    return Problem(
        said("the axes of field and specific force are exchanged or one is reversed"),
        where,
        said("field along up scatters by {left:.2g} uT", left=left[0]),
        said(
            "as with acc ({fits}) for (x, y, z): {left:.2g} uT; axes right-handed, +g up",
            fits=fits,
            left=left[1],
        ),
        said("exchange the columns with `columns`; `scale` COLUMN=-1 reverses one"),
    )
