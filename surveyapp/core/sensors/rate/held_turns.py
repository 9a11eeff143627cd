"""The turns between hand-held stops: which rows they are, and what is taken out of their rates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from surveyapp.core.sensors.clipping import at_an_end
from surveyapp.core.sensors.rate.hand_forces import ForceModel
from surveyapp.core.sensors.rate.hand_held import (
    HeldStop,
    RateModel,
    Turn,
    level_axes,
    turn_rows,
)
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.rate import quaternions

ACCELEROMETERS = ("acc_x_m_s2", "acc_y_m_s2", "acc_z_m_s2")
GYROS = ("gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s")
LEAST_FOR_FORCES = 8
"""Stops from which the sensitivity to gravity is carried through the turns: twice its elements."""
WORST_CONDITION = 1e3
"""Of the attitudes of the stops, for the same [forces in m/s2 beside 1]."""
LONGEST_STEP = 1.5
"""Samples between two neighbours from which one is missing."""


def turns_between(
    log: SensorLog,
    stops: Sequence[HeldStop],
    model: ForceModel,
    latitude: float | None,
) -> list[Turn]:
    """Turns between the stops, their rates less the mean of the two rests about them.

    A turn with a gap in it, or with a gyro at the end of its range, tells nothing and is left out.
    The vertical earth rate turns nothing that the accelerometers feel and stays in the turn.

    ``latitude`` [rad].
    """
    rate = np.column_stack([log.columns[c] for c in GYROS])
    ups = ups_of(stops, model)
    rests = rest_rates(stops, ups, latitude)
    interval = 1.0 / (log.rate_hz or 100.0)
    turns = []
    for k, (one, other) in enumerate(pairwise(stops)):
        inside = slice(one.stop, other.start)
        if other.start - one.stop < 2 or _broken(log, one.stop, other.start):
            continue
        local = 0.5 * (rests[k] + rests[k + 1])  # a slow bias as the two rests show it
        turns.append(Turn(rate[inside] - local, ups[k], ups[k + 1], interval, k))
    return turns


def _broken(log: SensorLog, first: int, last: int) -> bool:
    """Whether samples are missing in a turn, or a gyro stands at the end of its range."""
    time = log.columns["time_s"]
    interval = 1.0 / (log.rate_hz or 100.0)
    if float(np.diff(time[first - 1 : last + 1]).max()) > LONGEST_STEP * interval:
        return True
    rows = slice(first, last)
    return any(at_an_end(log.columns[n], rows)[0] for n in GYROS if n in log.clipped)


def ups_of(stops: Sequence[HeldStop], model: ForceModel) -> Floats:
    """Direction of up in the body at each stop, shape (n, 3)."""
    ups = np.array([model.corrected(s.force) for s in stops])
    return np.asarray(ups / np.linalg.norm(ups, axis=1)[:, None])


def rest_rates(stops: Sequence[HeldStop], ups: Floats, latitude: float | None) -> Floats:
    """Mean rates at the stops, the vertical earth rate taken out where the latitude is known.

    ``latitude`` [rad].
    """
    means = np.array([s.rate for s in stops])
    if latitude is None:
        return means
    return np.asarray(means - EARTH_RATE * math.sin(latitude) * ups)


def with_g_sensitivity(
    log: SensorLog, stops: Sequence[HeldStop], model: ForceModel, turns: Sequence[Turn]
) -> list[Turn]:
    """The turns with the sensitivity to gravity that the rests show carried through them.

    Empty where the rests do not determine it: each gyro has a bias and three elements.
    """
    rests = model.corrected(np.array([s.force for s in stops]))
    design = np.column_stack([np.ones(len(stops)), rests])
    if len(stops) < LEAST_FOR_FORCES or float(np.linalg.cond(design)) > WORST_CONDITION:
        return []
    means = np.array([s.rate for s in stops])
    pull = np.linalg.lstsq(design, means, rcond=None)[0][1:]
    force = np.column_stack([log.columns[c] for c in ACCELEROMETERS])
    found = []
    for turn in turns:
        k = turn.leaves
        inside = model.corrected(force[stops[k].stop : stops[k + 1].start])
        rest = 0.5 * (rests[k] + rests[k + 1])
        found.append(replace(turn, rates=turn.rates - (inside - rest) @ pull))
    return found


def with_frame(
    gyro: RateModel, turns: Sequence[Turn], shifted: Sequence[Floats], covariance: Floats
) -> RateModel:
    """The gyros' model with the uncertainty of the accelerometers, whose triad is their frame.

    Parameters
    ----------
    gyro : RateModel
        From the turns.
    turns : sequence of Turn
    shifted : sequence of ndarray, shape (n, 3)
        Up at each stop with one parameter of the accelerometers off by its standard deviation.
    covariance : ndarray, shape (p, p)
        Of these parameters in units of their standard deviations.
    """
    jacobian, moved = [], []
    for turn in turns:
        k, rows = turn.leaves, turn_rows(turn, gyro.matrix)
        jacobian.append(turn.rates.shape[0] * turn.interval_s * rows.rate.reshape(2, 9))
        across, last = level_axes(turn.after), quaternions.to_matrix(turn.attitude(gyro.matrix))
        changes = [
            across @ (last.T @ (up[k] - turn.before) - up[k + 1] + turn.after) for up in shifted
        ]
        moved.append(np.column_stack(changes))
    # change = - J+ error, d(output) = -output change
    answer = np.linalg.lstsq(np.concatenate(jacobian), np.concatenate(moved), rcond=1e-10)[0]
    slope = np.kron(gyro.output, np.eye(3)) @ answer
    return replace(gyro, covariance=gyro.covariance + slope @ covariance @ slope.T)
