"""A drive by odometer: headings integrated from the rate about up, stop by stop, row after row."""

from __future__ import annotations

import math

import numpy as np

from surveyapp.core.sensors.rate.motion_pieces import ACCELEROMETERS, GYROS, PIECE_ROWS
from surveyapp.core.sensors.rate.odometer_path import Driven
from surveyapp.core.sensors.rate.rests import Rests
from surveyapp.domain.columns import Room, let_go, pieces, sampled
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats

LEAST_BIAS_S = 0.5
"""Of a rest, for its mean rate to be a bias."""
LOOKED_AT = 100_000
"""Rows that tell which side is up."""


def drive_of(
    log: SensorLog, rests: Rests, *, azimuth: float, bias: float, interval_s: float, room: Room
) -> Driven:
    """Odometer and integrated heading; biases from every rest, so that the earth cancels too.

    Parameters
    ----------
    log : SensorLog
    rests : Rests
    azimuth : float
        At the beginning [rad].
    bias : float
        Of the gyro along z where no rest is long enough [rad/s].
    interval_s : float
    room : callable
        Where the columns of the drive lie.
    """
    rates, odometer = [log.columns[name] for name in GYROS], log.columns["odometer_m"]
    middle, biases, ups = _at_rest(log, rests, bias, interval_s)
    distance, heading = room(log.size), room(log.size)
    turned, farthest = 0.0, -math.inf
    for first in range(0, log.size, PIECE_ROWS):
        part = slice(first, min(first + PIECE_ROWS, log.size))
        rows = np.arange(part.start, part.stop)
        turn = np.zeros(rows.size)
        for rate, mean, up in zip(rates, biases.T, ups.T, strict=True):
            turn -= np.interp(rows, middle, up) * (rate[part] - np.interp(rows, middle, mean))
        turn[rests.mask(part.start, part.stop)] = 0.0
        angle = np.cumsum(np.concatenate([[turned], turn]))
        heading[part] = azimuth + angle[:-1] * interval_s
        distance[part] = np.maximum.accumulate(np.maximum(odometer[part], farthest))
        turned, farthest = float(angle[-1]), float(distance[part][-1])
        for column in (*rates, odometer, heading, distance):
            let_go(column)
    return Driven(distance, heading, _known(log, rests), log.columns.get("power_cycle"), rests)


def _at_rest(
    log: SensorLog, rests: Rests, bias: float, interval_s: float
) -> tuple[Floats, Floats, Floats]:
    """Middle row (m,) of each rest, mean rates and direction of up in the body there, (m, 3).

    Biases and up lie on straight lines between these. A unit that leans turns about up with all of
    its gyros.
    """
    runs = [r for r in rests.runs if r[1] - r[0] >= round(LEAST_BIAS_S / interval_s)]
    if not runs:
        force = log.columns[ACCELEROMETERS[2]]
        up = 1.0 if float(np.median(sampled(force, LOOKED_AT))) >= 0.0 else -1.0
        return np.zeros(1), np.array([[0.0, 0.0, bias]]), np.array([[0.0, 0.0, up]])
    biases = np.array([[_mean(log.columns[c], *run) for c in GYROS] for run in runs])
    forces = np.array([[_mean(log.columns[c], *run) for c in ACCELEROMETERS] for run in runs])
    ups = forces / np.linalg.norm(forces, axis=1)[:, None]
    return np.array([0.5 * (a + b) for a, b in runs]), biases, ups


def _mean(column: Floats, first: int, last: int) -> float:
    return sum(float(piece.sum()) for piece in pieces(column[first:last])) / (last - first)


def _known(log: SensorLog, rests: Rests) -> dict[int, float]:
    """Headings found at stops [rad], by the last row of each stop, and of the last row of all."""
    column = log.columns.get("heading_deg")
    if column is None:
        return {}
    found = {}
    for first, last in (*rests.runs, (log.size - 1, log.size)):
        for stop in range(last, first, -PIECE_ROWS):
            part = column[max(stop - PIECE_ROWS, first) : stop]
            finite = np.flatnonzero(np.isfinite(part))
            let_go(column)
            if finite.size:
                found[last - 1] = math.radians(float(part[finite[-1]]))
                break
    return found
