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

    The pitch is carried by the gyro and pulled to the accelerometer's with a long time constant,
    at rest at once.
    """
    pitch_rate = rate[:, 0] - noise.bias[0]
    felt = np.arcsin(np.clip(force[:, 1] / noise.gravity, -1.0, 1.0))
    pitch = _complementary(pitch_rate, felt, still, interval_s)
    forward = force[:, 1] - noise.gravity * np.sin(pitch)
    forward = np.where(still, 0.0, forward)
    up = np.where(np.median(force[:, 2]) >= 0.0, 1.0, -1.0)
    turn = -up * (rate[:, 2] - noise.bias[2])
    width = max(round(SMOOTHED_S / interval_s), 1)
    return smoothed(forward, width), smoothed(np.asarray(turn), width)


def _complementary(rate: Floats, felt: Floats, still: Mask, interval_s: float) -> Floats:
    """First-order complementary filter of an angle, piecewise between rests.

    Within a motion the angle is the one of the rest before it plus the integrated rate, pulled
    linearly to that of the rest after it: what the gyro drifted in between. A record without any
    rest is pulled to the accelerometer with a long time constant.
    """
    steps = np.concatenate([[0.0], np.cumsum(rate) * interval_s])
    width = max(round(0.5 / interval_s), 1)
    reach = max(round(REST_S / interval_s), 1)
    result = smoothed(felt, width)
    for first, last in runs_of(~still):
        before, after = felt[max(first - reach, 0) : first], felt[last : last + reach]
        carried = steps[first:last] - steps[first]
        if before.size and after.size:
            begin, end = float(np.mean(before)), float(np.mean(after))
            drift = end - begin - float(steps[last] - steps[first])
            carried = begin + carried + drift * np.linspace(0.0, 1.0, last - first)
        elif before.size:
            carried = float(np.mean(before)) + carried
        elif after.size:
            carried = float(np.mean(after)) - float(steps[last] - steps[first]) + carried
        else:
            slow = max(round(LEVEL_S / interval_s), 1)
            carried = carried + smoothed(felt[first:last] - carried, slow)
        result[first:last] = carried
    return result


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
