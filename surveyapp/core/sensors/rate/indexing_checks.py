"""Whether a unit was turned as its log says: gravity and the turned rates tell.

At rest gravity and the earth's rate are two fixed vectors, so that a sensor which is turned about
one axis sees them turn by the index angle about that axis. Where columns are exchanged, one is
reversed, the angles count the other way or another axis was the index axis, they do not; and where
another arrangement fits far better, the log is refused and the arrangement told.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.indexing_values import Setting, Stop
from surveyapp.core.sensors.rate.parameters import DEG_H
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem
from surveyapp.languages import either, said
from surveyapp_models.arrays import Floats
from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.rate.attitude import axis_rotation

FORCE_NOTICED: Final = 0.02
"""What is left of gravity, as a share of it, below which nothing is doubted: 1.1 degrees."""
RATE_NOTICED: Final = 8.0
"""The same of the rates, in their own sigmas."""
BETTER: Final = 5.0
"""Another arrangement must leave so many times less."""
FORCE_BIAS: Final = 0.5
"""Largest accelerometer bias that a unit has, some 50 mg [m/s2]."""
ABOVE_EARTH: Final = 1.05
"""Rates across the index axis beyond this multiple of the earth's are of another unit."""
SIGMAS: Final = 5.0
SATURATED: Final = 0.05
"""Share of the rows at one end of a gyro's range from which it is saturated."""
VALUES: Final = 40
"""Different values from which a channel shows its noise."""
MOST_TOLD: Final = 3
"""Arrangements that are told."""
TURNING_ROWS: Final = 72
"""Single rows of one index angle each from which the index turned while the log was written."""

Order = tuple[tuple[int, int, int], tuple[float, float, float]]
_GIVEN: Final[Order] = ((0, 1, 2), (1.0, 1.0, 1.0))


@dataclass(frozen=True, slots=True)
class _Turning:
    """Index axis and sense; and what forces and rates leave of it."""

    axis: int
    sense: float
    forces: float
    rates: float


def index_problems(stops: Sequence[Stop], setting: Setting, where: str) -> list[Problem]:
    """What contradicts the stated turning; empty where it may be right.

    Parameters
    ----------
    stops : sequence of Stop
    setting : Setting
    where : str
        The log.
    """
    if len(stops) < 2:
        return []
    force, rate = (np.array([getattr(s, n) for s in stops]) for n in ("force", "rate"))
    sigma = float(np.median([s.rate_sigma for s in stops]))
    angles = np.array([s.angle for s in stops])
    size = float(np.median(np.linalg.norm(force, axis=1)))

    def of(axis: int, sense: float) -> _Turning:
        turns = _turns(angles * sense, axis)
        return _Turning(
            axis,
            sense,
            _left(turns, force, axis, FORCE_BIAS) / size,
            _left(setting.matrix @ turns, rate, axis, None),
        )

    given = of(setting.axis, 1.0)
    bad_force = given.forces > FORCE_NOTICED
    bad_rate = given.rates > RATE_NOTICED * sigma
    if not bad_force and not bad_rate:
        return []
    for other in (of(a, s) for a in (setting.axis, 0, 1, 2) for s in (-1.0, 1.0)):
        if _fits(other, given, sigma):
            return [_otherwise(other, setting, where)]
    turns = _turns(angles, setting.axis)
    if bad_force:
        found = _rearranged(turns, force / size, setting.axis, FORCE_BIAS / size)
        return [_exchanged("acc", found, where)] if found else []
    found = _rearranged(setting.matrix @ turns, rate, setting.axis, None)
    return [_exchanged("gyr", found, where)] if found else []


def _fits(other: _Turning, given: _Turning, sigma: float) -> bool:
    """Whether forces and rates both fit another turning, and one of them far better."""
    fits = other.forces <= FORCE_NOTICED and other.rates <= RATE_NOTICED * sigma
    far = BETTER * other.forces < given.forces or BETTER * other.rates < given.rates
    return fits and far


def _turns(angles: Floats, axis: int) -> Floats:
    """Body at index angle 0 to the sensor, shape (k, 3, 3)."""
    return np.array([axis_rotation(axis, -float(angle)).T for angle in angles])


def _left(turns: Floats, values: Floats, axis: int, bias: float | None) -> float:
    """Root mean square of values about a turned vector and a fixed one.

    ``bias``: what size the fixed one may have; None = any.
    """
    count = turns.shape[0]
    fixed = np.tile(np.delete(np.eye(3), axis, axis=1), (count, 1, 1))
    design = np.concatenate([turns, fixed], axis=2).reshape(-1, 5)
    target = values.ravel()
    if bias is not None:
        # as heavy as all rows together: a bias of the allowed size costs a hundredth of gravity
        held = np.zeros((2, 5))
        held[:, 3:] = np.eye(2) * np.sqrt(target.size) * FORCE_NOTICED / 2.0 / bias
        scale = float(np.median(np.linalg.norm(values, axis=1)))
        design = np.vstack([design, held * scale])
        target = np.append(target, [0.0, 0.0])
    solution, *_ = np.linalg.lstsq(design, target, rcond=None)
    rest = target - design @ solution
    return float(np.sqrt(rest @ rest / values.size))


def _orders() -> Iterator[Order]:
    """Every order and sign of three axes, the simplest first."""
    signs = sorted(itertools.product((1.0, -1.0), repeat=3), key=lambda s: s.count(-1.0))
    for sign in signs:
        for a, b, c in itertools.permutations(range(3)):
            if ((a, b, c), sign) != _GIVEN:
                yield (a, b, c), (sign[0], sign[1], sign[2])


def _rearranged(turns: Floats, values: Floats, axis: int, bias: float | None) -> list[Order]:
    """The simplest arrangements of the columns that fit about as well as any, and far better.

    Several do: the same one turned about the index axis.
    """

    def left(found: Order) -> float:
        return _left(turns, values[:, list(found[0])] * np.array(found[1]), axis, bias)

    every = {found: left(found) for found in _orders()}
    best = min(every.values())
    if BETTER * best > left(_GIVEN):
        return []
    return [found for found, rest in every.items() if rest <= 1.5 * best + 1e-15][:MOST_TOLD]


def _exchanged(kind: str, found: Sequence[Order], where: str) -> Problem:
    fits = either(
        "("
        + ", ".join(f"{'-' if s < 0.0 else ''}{'xyz'[i]}" for i, s in zip(*one, strict=True))
        + ")"
        for one in found
    )
    whose = said("accelerometers") if kind == "acc" else said("gyros")
    return Problem(
        said("the {whose} are exchanged or one is reversed", whose=whose),
        where,
        said("they do not turn by index_angle_deg"),
        said("as with {kind} {fits} for (x, y, z)", kind=kind, fits=fits),
        said("exchange the columns with `columns`; `scale` COLUMN=-1 reverses one"),
    )


def _otherwise(other: _Turning, setting: Setting, where: str) -> Problem:
    letter, stated = "xyz"[other.axis], "xyz"[setting.axis]
    sense = said("clockwise") if other.sense > 0.0 else said("counter-clockwise")
    return Problem(
        said("the sensor was not turned as the log says"),
        where,
        said("gravity and rates turned {sense} about {letter}", sense=sense, letter=letter),
        said("clockwise about {stated} as seen against the axis", stated=stated),
        said("`index_axis` names the axis; `scale` index_angle_deg=-1 turns the sense"),
    )


def rate_problems(rate: float, *, sigma: float, where: str) -> list[Problem]:
    """A turned rate that the earth cannot give.

    ``rate``, ``sigma``: across the index axis, from the stops alone [rad/s].
    """
    if rate - SIGMAS * sigma <= ABOVE_EARTH * EARTH_RATE:
        return []
    return [
        Problem(
            said("the turned rate is larger than the earth's"),
            where,
            said("{rate:.4g} deg/h across the index axis", rate=rate / DEG_H),
            said("{earth:.2f} deg/h at most", earth=EARTH_RATE / DEG_H),
            said("is it deg/s or deg/h? `unit` COLUMN=UNIT; counts take `scale` COLUMN=VALUE"),
        )
    ]


def saturated(log: SensorLog, columns: Sequence[str]) -> list[Problem]:
    """Gyros that stand at one end of their range while others of their rows show noise."""
    problems = []
    for name in columns:
        values = log.columns[name]
        if np.unique(values).size < VALUES:
            continue
        share, end = max(
            (float(np.mean(values == end)), end) for end in (values.max(), values.min())
        )
        if share > SATURATED:
            problems.append(
                Problem(
                    said("{name} is saturated", name=name),
                    log.path,
                    said("{share:.0%} of the rows are {end:.6g}", share=share, end=end),
                    "rates within the range of the gyro",
                    "at rest a gyro shows its bias and the earth; choose another range, or unit",
                )
            )
    return problems


def turning_problems(log: SensorLog, lengths: Sequence[int]) -> list[Problem]:
    """An index that turned while the log was written: hardly two rows of one angle."""
    if len(lengths) <= TURNING_ROWS or max(lengths) > 1:
        return []
    return [
        Problem(
            "no index position at rest was found",
            log.path,
            said("{count} rows, each of another index_angle_deg", count=len(lengths)),
            "stretches of constant index_angle_deg",
        )
    ]
