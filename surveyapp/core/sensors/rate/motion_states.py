"""Steady, accelerating, braking and turning: what a vehicle does while it is not at rest.

A complementary filter keeps the level from gyro and accelerometer; what is left of the forward
force is acceleration, what is left of the vertical rate is turning. Both are smoothed, and their
thresholds follow from the record's own noise at the stated rate of false alarms. Deceleration and
braking are one state: an accelerometer cannot tell a brake from an uphill coast at equal force.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from surveyapp.core.sensors.rate.still import Mask, RestNoise, runs_of
from surveyapp.core.statistics.distributions import normal_quantile
from surveyapp.domain.motion import MotionSegment, State
from surveyapp_models.arrays import Floats

SMOOTHED_S = 1.0
LEVEL_S = 30.0
"""Time constant of the complementary filter: longer than a manoeuvre, shorter than a slope."""
REST_S = 2.0
"""Of a rest beside a motion, over which its level is averaged."""
LEAST_S = 0.5
"""A shorter state is noise."""
LEAST_TURN = math.radians(0.5)
"""Turning slower than this is a curve of the road surface [rad/s]."""
LEAST_FORCE = 0.05
"""Acceleration below this is the road [m/s2]."""


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Of the smoothed forward acceleration [m/s2] and vertical rate [rad/s]."""

    force: float
    turn: float


def forward_and_turn(
    force: Floats, rate: Floats, still: Mask, noise: RestNoise, *, interval_s: float
) -> tuple[Floats, Floats]:
    """Forward acceleration [m/s2] and clockwise vertical rate [rad/s], smoothed, shape (n,).

    Up in the body is carried by the gyros and pulled to the accelerometers' with a long time
    constant, at rest at once: its part along Y is what a tilted unit feels of gravity.
    """
    own = rate - noise.bias
    along, turn = _complementary(own, force / noise.gravity, still, interval_s)
    forward = force[:, 1] - noise.gravity * along
    forward = np.where(still, 0.0, forward)
    width = max(round(SMOOTHED_S / interval_s), 1)
    return smoothed(forward, width), smoothed(turn, width)


def _complementary(
    rate: Floats, felt: Floats, still: Mask, interval_s: float
) -> tuple[Floats, Floats]:
    """First-order complementary filter of up along Y, piecewise between rests; and the turning.

    Within a motion up is that of the rest before it carried by the rates, pulled linearly to that
    of the rest after it: what the gyros drifted in between. A record without any rest is pulled to
    the accelerometers with a long time constant. Where up is u, it moves by -w x u: along Y by
    w_x u_z - w_z u_x, so that a unit that is mounted with a roll keeps its level in a curve.
    """
    width = max(round(0.5 / interval_s), 1)
    reach = max(round(REST_S / interval_s), 1)
    along = smoothed(felt[:, 1], width)
    usual = _unit(np.median(felt, axis=0))
    turn = np.asarray(-(rate @ usual))
    for first, last in runs_of(~still):
        before = felt[max(first - reach, 0) : first].mean(axis=0) if first > 0 else None
        after = felt[last : last + reach].mean(axis=0) if last < still.size else None
        begin = _unit(before if before is not None else usual if after is None else after)
        end = _unit(after) if after is not None else begin
        share = np.linspace(0.0, 1.0, last - first)
        up_x, up_z = (begin[k] + (end[k] - begin[k]) * share for k in (0, 2))
        part = rate[first:last]
        moved = (part[:, 0] * up_z - part[:, 2] * up_x) * interval_s
        turn[first:last] = -(part[:, 0] * up_x + part[:, 2] * up_z)
        whole = float(moved.sum())
        carried = np.cumsum(moved) - moved
        if before is not None and after is not None:
            carried = before[1] + carried + (after[1] - before[1] - whole) * share
        elif before is not None:
            carried = before[1] + carried
        elif after is not None:
            carried = after[1] - whole + carried
        else:
            slow = max(round(LEVEL_S / interval_s), 1)
            carried = carried + smoothed(felt[first:last, 1] - carried, slow)
        turn[first:last] -= part[:, 1] * carried
        along[first:last] = carried
    return along, turn


def _unit(vector: Floats) -> Floats:
    """The direction of a vector, shape (3,)."""
    return np.asarray(vector / max(float(np.linalg.norm(vector)), 1e-300))


def smoothed(values: Floats, width: int) -> Floats:
    """Centred running mean, the ends over what there is, shape (n,)."""
    if width <= 1 or values.size == 0:
        return values
    width = min(width, values.size)
    offset = float(values[0])
    total = np.concatenate([[0.0], np.cumsum(values - offset)])
    index = np.arange(values.size)
    low = np.maximum(index - width // 2, 0)
    high = np.minimum(index - width // 2 + width, values.size)
    return np.asarray((total[high] - total[low]) / (high - low) + offset)


def thresholds_of(
    force: Floats, rate: Floats, still: Mask, *, interval_s: float, false_alarm: float
) -> Thresholds:
    """From the noise of neighbouring samples while moving, carried through the smoothing."""
    z = normal_quantile(1.0 - 0.5 * false_alarm)
    width = max(round(SMOOTHED_S / interval_s), 1)
    moving = ~still if np.count_nonzero(~still) > 4 * width else np.ones(still.size, dtype=bool)
    rows = np.flatnonzero(moving[1:] & moving[:-1])

    def spread(values: Floats) -> float:
        steps = np.diff(values)[rows]
        return 1.4826 * float(np.median(np.abs(steps - np.median(steps)))) / math.sqrt(2.0)

    root = math.sqrt(width)
    return Thresholds(
        max(z * spread(force[:, 1]) / root, LEAST_FORCE),
        max(z * spread(rate[:, 2]) / root, LEAST_TURN),
    )


def segments_of(
    time_s: Floats, still: Mask, forward: Floats, turn: Floats, *, limits: Thresholds
) -> list[MotionSegment]:
    """States one after the other; what is shorter than half a second joins its neighbour."""
    state = np.zeros(still.size, dtype=np.int8)
    state[~still] = 1
    state[~still & (forward > limits.force)] = 2
    state[~still & (forward < -limits.force)] = 3
    state[~still & (np.abs(turn) > limits.turn)] = 4
    step = float(np.median(np.diff(time_s))) if time_s.size > 1 else 1.0
    state = _calmed(state, still, max(round(LEAST_S / step), 1))
    names: tuple[State, ...] = ("stationary", "steady", "accelerating", "braking", "turning")
    edges = np.concatenate([[0], np.flatnonzero(np.diff(state)) + 1, [state.size]]).tolist()
    found = []
    for first, last in pairwise(edges):
        end = float(time_s[min(last, state.size - 1)])
        found.append(MotionSegment(float(time_s[first]), end, names[int(state[first])]))
    return found


def _calmed(state: np.ndarray, still: Mask, least: int) -> np.ndarray:
    """Runs of a moving state that are too short take the longer neighbouring moving state."""
    found = state.copy()
    for first, last in runs_of(~still):
        part = found[first:last]
        for _ in range(4):
            edges = np.concatenate([[0], np.flatnonzero(np.diff(part)) + 1, [part.size]])
            lengths = np.diff(edges)
            short = np.flatnonzero(lengths < least)
            if short.size == 0 or lengths.size == 1:
                break
            for k in short.tolist():
                left = int(lengths[k - 1]) if k > 0 else -1
                right = int(lengths[k + 1]) if k + 1 < lengths.size else -1
                source = edges[k] - 1 if left >= right else edges[k + 1]
                part[edges[k] : edges[k + 1]] = part[source]
    return found
