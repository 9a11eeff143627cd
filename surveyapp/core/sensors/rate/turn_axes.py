"""Whether gyros and accelerometers of a hand-held unit are seen in the same axes, and unit.

What the gyros turned from one rest to the next must carry gravity along. Where columns are
exchanged or one is reversed, or the rates are in another unit, it does not, and no calibration
starts from there: the arrangement that does is told.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.hand_held import Turn
from surveyapp.errors import Problem
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions

NOTICED: Final = math.radians(10.0)
"""By so much a unit that was never calibrated does not miss gravity in a turn by hand: a scale
factor 5 % off misses 6 degrees after 120."""
BETTER: Final = 3.0
"""Another arrangement must miss so many times less."""
DENIED: Final = math.radians(30.0)
"""From here on no calibration starts, although no arrangement is found that mends it [rad]."""
UNITS: Final = (("deg/s", math.radians(1.0)), ("deg/h", math.radians(1.0) / 3600.0))


def axes_problems(turns: Sequence[Turn], where: str) -> list[Problem]:
    """What contradicts the columns of the gyros; empty where they carry gravity along.

    Parameters
    ----------
    turns : sequence of Turn
        Bias and earth rate taken out.
    where : str
        The log.
    """
    if len(turns) < 3:
        return []
    given = _missed(turns, np.eye(3))
    if given <= NOTICED:
        return []
    for name, factor in UNITS:
        if BETTER * _missed(turns, factor * np.eye(3)) < given:
            return [_of_another_unit(name, where)]
    signs = sorted(itertools.product((1.0, -1.0), repeat=3), key=lambda s: s.count(-1.0))
    every = [
        (order, sign)
        for sign, order in itertools.product(signs, itertools.permutations(range(3)))
        if (order, sign) != ((0, 1, 2), (1.0, 1.0, 1.0))
    ]
    left = [_missed(turns, np.eye(3)[list(o)] * np.array(s)[:, None]) for o, s in every]
    best = int(np.argmin(left))
    if BETTER * left[best] >= given:
        return [_unexplained(given, where)] if given > DENIED else []
    return [
        Problem(
            said("gyros and accelerometers are not seen in the same axes"),
            where,
            said("the turns miss gravity by {angle:.0f} degrees", angle=math.degrees(given)),
            said(
                "with {columns} for (x, y, z) by {angle:.1f}",
                columns=_columns(*every[best]),
                angle=math.degrees(left[best]),
            ),
            said("exchange the columns with `columns`; `scale` COLUMN=-1 reverses one"),
        )
    ]


def _columns(order: Sequence[int], sign: Sequence[float]) -> str:
    """An arrangement of the gyros in letters, or what is the same of the accelerometers.

    Turned backwards and with gravity reversed, which the turns cannot tell from down.
    """
    kind = "gyr"
    if sum(s < 0.0 for s in sign) > 1:
        kind = "acc"
        back = [order.index(k) for k in range(3)]
        order, sign = back, [-sign[i] for i in back]
    letters = (f"{'-' if s < 0.0 else ''}{'xyz'[i]}" for i, s in zip(order, sign, strict=True))
    return f"{kind} ({', '.join(letters)})"


def _of_another_unit(name: str, where: str) -> Problem:
    return Problem(
        said("the gyros are in another unit"),
        where,
        said("their turns carry gravity along only if they are in {unit}", unit=name),
        "rad/s",
        "`unit` COLUMN=UNIT; counts take `scale` COLUMN=VALUE",
    )


def _unexplained(given: float, where: str) -> Problem:
    return Problem(
        "the turns of the gyros do not carry gravity along",
        where,
        said("the turns miss gravity by {angle:.0f} degrees", angle=math.degrees(given)),
        "10 degrees at most of a unit that was never calibrated",
        "is one column in another unit, or the sampling rate another? no order or sign mends it",
    )


def _missed(turns: Sequence[Turn], matrix: Floats) -> float:
    """Median angle by which gravity is missed with the rates so arranged [rad]."""
    angles = []
    for turn in turns:
        q = quaternions.integrate(turn.rates @ matrix.T, interval_s=turn.interval_s)[-1]
        up = quaternions.rotate_back(q, turn.before)
        across = float(np.linalg.norm(np.cross(up, turn.after)))
        angles.append(math.atan2(across, float(up @ turn.after)))
    return float(np.median(angles))
