"""Whether the columns of a drive can be what they are taken for: axes, senses, unit of the rates.

A vehicle goes where it points. Between two stops its speed is the sum of the forward force, and
while it turns at a rate w clockwise with a speed v the lateral force is v w (Titterton and Weston,
ch. 13: non-holonomic constraints). Each way in which columns can be wrong is a hypothesis that
foretells the lateral force of every second from the others, with nothing to fit; where there is an
odometer, it foretells the forward force as well. The residuals are compared by their likelihood.

A likelihood ratio of c against the columns as they stand comes by chance with a probability of at
most 1/c: of any of K hypotheses with K/c. That holds for a known standard deviation and independent
seconds; here the seconds are counted half. By simulation see bench rate_axes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.motion_pieces import ACCELEROMETERS, GYROS, stacked
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.domain.columns import let_go
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions

FALSE_ALARM: Final = 0.001
"""Stated, of a record whose columns are in order."""
BLOCK_S: Final = 1.0
STEP_S: Final = 0.1
"""Samples are averaged to this interval first: a vehicle turns by little within it."""
COUNTED: Final = 0.5
"""Share of the seconds that is counted as independent."""
LEAST_RATIO: Final = 4.0
"""Sum of squares left by the columns as they stand over that of a hypothesis: it must explain most
of what they do not, or the unit is on no vehicle."""
REST_S, LEAST_REST_S = 2.0, 0.3
"""Of a stop, over which level and bias are taken; margin that is added to a leg."""
LEAST_LEG_S, LONGEST_LEG_S = 3.0, 300.0
LEAST_SPEED: Final = 0.3
"""A leg that reaches no such speed along x or y is no drive [m/s]."""
TURN_SIGMAS: Final = 6.0
"""Turning below so many standard deviations of a second at rest is none: a noisy gyro would
otherwise be quieter in any larger unit."""
MOST_LEGS: Final = 50
"""Of a long record evenly chosen."""
DEGREE: Final = math.pi / 180.0


@dataclass(frozen=True, slots=True)
class Columns:
    """What the columns may be.

    Parameters
    ----------
    axes : tuple
        Forces to the right and forward as rows of a matrix of the columns x and y.
    rates : tuple
        Rates about right and forward in the same way.
    turning : float
        Factor of the vertical rate; ``scale``: of all rates.
    """

    axes: tuple[tuple[float, float], tuple[float, float]] = ((1.0, 0.0), (0.0, 1.0))
    rates: tuple[tuple[float, float], tuple[float, float]] = ((1.0, 0.0), (0.0, 1.0))
    turning: float = 1.0
    scale: float = 1.0

    def forces_of(self, values: Floats) -> Floats:
        """To the right, forward, up from the columns x, y, z, shape (..., 3)."""
        return np.concatenate([values[..., :2] @ np.array(self.axes).T, values[..., 2:]], axis=-1)

    def rates_of(self, values: Floats) -> Floats:
        """The same of rates, shape (..., 3)."""
        level = values[..., :2] @ np.array(self.rates).T
        return self.scale * np.concatenate([level, self.turning * values[..., 2:]], axis=-1)


_EXCHANGED: Final = ((0.0, 1.0), (1.0, 0.0))
_TURNED: Final = ((0.0, -1.0), (1.0, 0.0))
_REVERSED: Final = ((-1.0, 0.0), (0.0, -1.0))

AS_STATED: Final = Columns()
WRONG: Final[Mapping[str, Columns]] = {
    "axes_exchanged": Columns(axes=_EXCHANGED),
    "axes_turned": Columns(axes=_TURNED, rates=_TURNED),
    "turning_reversed": Columns(turning=-1.0),
    "rates_in_degrees": Columns(scale=DEGREE),
    "rates_too_small": Columns(scale=1.0 / DEGREE),
}
"""What a record without an odometer can contradict; a unit that looks back is a vehicle that
backs."""
WITH_ODOMETER: Final[Mapping[str, Columns]] = {
    **WRONG,
    "looks_back": Columns(axes=_REVERSED, rates=_REVERSED),
    "axes_turned": Columns(axes=_TURNED, rates=_TURNED),
    "axes_turned_left": Columns(axes=((0.0, 1.0), (-1.0, 0.0)), rates=((0.0, 1.0), (-1.0, 0.0))),
}

FORWARD_IS_X: Final = ("axes_exchanged", "axes_turned", "axes_turned_left")
"""Without a turn and on level ground these are one."""
_TOLD: Final[Mapping[str, str]] = {
    "forward_is_x": said(
        "what a vehicle feels forward is in acc_x, what it feels to the side in acc_y: name the "
        "columns the other way, or turn the unit in its vehicle; forward is Y"
    ),
    "turning_reversed": said(
        "in its turns the vehicle is pushed to the wrong side: the sense of gyr_z or that of acc_x "
        "is reversed; the path turns the wrong way"
    ),
    "rates_in_degrees": said(
        "for its speed the vehicle turns 57 times too fast: the rates seem to be in degrees per "
        "second; state that unit"
    ),
    "rates_too_small": said(
        "for its speed the vehicle turns 57 times too slowly: the rates seem to be in radians per "
        "second and were read as degrees; state the unit"
    ),
    "looks_back": said(
        "by the odometer the unit looks back, or the vehicle backed all the way: accelerating and "
        "braking are exchanged"
    ),
}


@dataclass(frozen=True, slots=True)
class _Leg:
    """A drive from stop to stop: samples with the ends of both stops around them.

    Parameters
    ----------
    force, rate : ndarray, shape (n, 3)
        Rates without the bias of the stops.
    before, after : ndarray, shape (3,)
        Mean force of the two stops.
    distance : ndarray, shape (n,), or None
    noise : float
        Standard deviation of the vertical rate at the stops [rad/s].
    interval_s : float
    """

    force: Floats
    rate: Floats
    before: Floats
    after: Floats
    distance: Floats | None
    noise: float
    interval_s: float


def axes_doubts(log: SensorLog, rests: Rests) -> list[ResultWarning]:
    """What the drives from stop to stop say against the columns; nothing where they cannot.

    Parameters
    ----------
    log : SensorLog
    rests : Rests
    """
    rolled = log.columns.get("odometer_m")
    guided = rolled is not None and bool(np.isfinite(rolled[:1]).all())
    name = contradicted(_legs(log, rests), WITH_ODOMETER if guided else WRONG)
    if name is None:
        return []
    code = "forward_is_x" if name in FORWARD_IS_X else name
    return [ResultWarning(code, _TOLD[code])]


def contradicted(legs: Iterator[_Leg], wrong: Mapping[str, Columns]) -> str | None:
    """The hypothesis that is likelier than the columns as they stand and than every other."""
    squares, seconds = np.zeros((2, 1 + len(wrong))), 0
    for leg in legs:
        if not _drives(leg):
            continue
        for k, carried in enumerate((True, False)):
            found = [_squares(leg, c, carried=carried) for c in (AS_STATED, *wrong.values())]
            squares[k] += [total for total, _ in found]
        seconds += found[0][1]
    squares = squares.min(axis=0)  # with the level carried by the gyros, or straight between stops
    if seconds == 0 or not 0.0 < float(squares.min()) < math.inf:
        return None
    names = ("", *wrong)
    best = names[int(np.argmin(squares))]
    of_best = FORWARD_IS_X if best in FORWARD_IS_X else (best,)
    ratios = squares / squares.min()
    bound = math.log(2.0 * len(wrong) / FALSE_ALARM)
    rivals = [float(r) for name, r in zip(names, ratios, strict=True) if name not in of_best]
    gain = 0.5 * COUNTED * seconds * math.log(min(rivals))
    return best if best and ratios[0] >= LEAST_RATIO and gain >= bound else None


def _drives(leg: _Leg) -> bool:
    """Whether it is fast enough along x or y for a drive."""
    return any(
        float(np.abs(_speed(force, leg.interval_s)).max()) >= LEAST_SPEED
        for force in _level(leg, AS_STATED, None)
    )


def _speed(ahead: Floats, interval_s: float) -> Floats:
    """Sum of a force that ends at 0 as it begins [m/s]."""
    gone = np.cumsum(ahead) * interval_s
    return np.asarray(gone - gone[-1] * np.linspace(0.0, 1.0, gone.size))


def _legs(log: SensorLog, rests: Rests) -> Iterator[_Leg]:
    interval = 1.0 / (log.rate_hz or 100.0)
    step = max(round(STEP_S / interval), 1)
    reach, margin = (max(round(s / interval), 1) for s in (REST_S, LEAST_REST_S))
    rolled = log.columns.get("odometer_m")
    stops = [run for run in rests.runs if run[1] - run[0] >= 2 * margin]
    ways = [
        (begin, first, last, end)
        for (begin, first), (last, end) in pairwise(stops)
        if LEAST_LEG_S <= (last - first) * interval <= LONGEST_LEG_S
    ]
    for begin, first, last, end in ways[:: max(-(-len(ways) // MOST_LEGS), 1)]:
        low, high = first - margin, last + margin
        parts = slice(max(begin, low - reach), low), slice(high, min(end, high + reach))
        still = [stacked(log, GYROS, part) for part in parts]
        edges = [rates.mean(axis=0) for rates in still]
        rate = _thinned(stacked(log, GYROS, slice(low, high)), step)
        share = np.linspace(0.0, 1.0, rate.shape[0])[:, None]
        noise = float(np.mean([rates[:, 2].std() for rates in still]))
        yield _Leg(
            _thinned(stacked(log, ACCELEROMETERS, slice(low, high)), step),
            rate - edges[0] - share * (edges[1] - edges[0]),
            stacked(log, ACCELEROMETERS, parts[0]).mean(axis=0),
            stacked(log, ACCELEROMETERS, parts[1]).mean(axis=0),
            None if rolled is None else _thinned(rolled[low:high, None], step)[:, 0],
            noise / math.sqrt(step),
            interval * step,
        )
        if rolled is not None:
            let_go(rolled)


def _thinned(values: Floats, step: int) -> Floats:
    """Means of so many rows each, shape (n // step, k)."""
    count = values.shape[0] // step
    return np.asarray(values[: count * step].reshape(count, step, -1).mean(axis=1))


def _squares(leg: _Leg, columns: Columns, *, carried: bool) -> tuple[float, int]:
    """Sum of squares of what a hypothesis leaves of the forces of a leg, and its seconds."""
    dt, size = leg.interval_s, max(round(BLOCK_S / leg.interval_s), 1)
    rates = columns.rates_of(leg.rate)
    side, ahead = _level(leg, columns, rates if carried else None)
    up = 1.0 if float(leg.before[2]) >= 0.0 else -1.0
    turns = np.abs(_means(leg.rate[:, 2], size)) > TURN_SIGMAS * leg.noise / math.sqrt(size)
    turn = -up * rates[:, 2]
    turn[: turns.size * size] *= np.repeat(turns, size)
    if leg.distance is None:
        left = side - _speed(ahead, dt) * turn
        return float(np.sum(_means(left, size) ** 2)), side.size // size
    speed = np.gradient(_smooth(leg.distance, size), dt)
    pushed = np.gradient(speed, dt)
    both = _means(side - speed * turn, size), _means(ahead - pushed, size)
    return float(sum(np.sum(part**2) for part in both)), 2 * (side.size // size)


def _level(leg: _Leg, columns: Columns, rates: Floats | None) -> tuple[Floats, Floats]:
    """Forces to the right and ahead without gravity [m/s2], shape (n,) each.

    Gravity is that of the stop before, carried by the rates and bent to that of the stop behind;
    without rates it goes straight from one to the other.
    """
    force, before, after = (columns.forces_of(v) for v in (leg.force, leg.before, leg.after))
    share = np.linspace(0.0, 1.0, force.shape[0])[:, None]
    if rates is None:
        felt = before + share * (after - before)
    else:
        q = quaternions.integrate(rates, interval_s=leg.interval_s)[1:]
        felt = quaternions.rotate_back(
            q, before + share * (quaternions.rotate(q[-1], after) - before)
        )
    free = force - felt
    return free[:, 0], free[:, 1]


def _means(values: Floats, size: int) -> Floats:
    return _thinned(values[:, None], size)[:, 0]


def _smooth(values: Floats, size: int) -> Floats:
    """Centred mean over so many rows, the ends as they are."""
    padded = np.concatenate([np.full(size, values[0]), values, np.full(size, values[-1])])
    total = np.cumsum(np.concatenate([[0.0], padded]))
    low = np.arange(values.size) + size - size // 2
    return np.asarray((total[low + size] - total[low]) / size)
