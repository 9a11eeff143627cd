"""Which model of hard and soft iron serves: the simplest that no richer one beats held out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.sensors.ellipsoid import Ellipsoid, distances, fit_ellipsoid
from surveyapp.core.sensors.linear import alternate_blocks
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats

BLOCK_S: Final = 2.0
"""Length of a held-out block [s]."""

BETTER, FORESEEN = 2.0, 1.0
"""A richer model must predict blocks and tenths better by so many standard errors of the gain."""

TENTHS: Final = 10
TENTHS_ROWS: Final = 1500


@dataclass(frozen=True, slots=True)
class ModelTrial:
    """A model with its fits of the whole record and of both halves.

    ``blocks`` are the mean squares of the held-out blocks [uT^2].
    """

    fit: Ellipsoid
    halves: tuple[Ellipsoid, Ellipsoid]
    held_rms: float
    blocks: Floats


def block_rows(log: SensorLog) -> int:
    """Rows of a held-out block of about 2 s; at least ten blocks where the record allows it."""
    rate = log.rate_hz if log.rate_hz is not None else 20.0
    return max(min(round(BLOCK_S * rate), log.size // 10), 1)


def try_model(points: Floats, model: str, block: int) -> ModelTrial:
    """Fit a model to the whole record and to both halves of its blocks.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        [uT]
    model : str
    block : int
        Rows of a block.
    """
    fit = fit_ellipsoid(points, model)
    held = np.full(len(points), np.nan)
    halves = []
    for used, left in alternate_blocks(len(points), block):
        half = fit_ellipsoid(points[used], model, start=fit.theta if fit.converged else None)
        held[left] = distances(points[left], half.theta)
        halves.append(half)
    number = np.arange(len(points)) // block
    counts = np.bincount(number)
    squares = np.bincount(number, weights=held**2) / counts
    return ModelTrial(
        fit,
        (halves[0], halves[1]),
        float(np.sqrt(np.mean(held**2))),
        squares,
    )


def tenths(points: Floats, fit: Ellipsoid) -> Floats:
    """Mean squares of contiguous tenths, each predicted from the other nine [uT^2], shape (10,).

    What a model says of directions that it has not seen; of a long record every k-th row.
    """
    part = points[:: max(len(points) // TENTHS_ROWS, 1)]
    number = np.arange(len(part)) * TENTHS // len(part)
    squares = np.empty(TENTHS)
    for tenth in range(TENTHS):
        used = number != tenth
        half = fit_ellipsoid(part[used], fit.model, start=fit.theta)
        squares[tenth] = np.mean(distances(part[~used], half.theta) ** 2)
    return squares


def choose(points: Floats, trials: list[ModelTrial]) -> int:
    """The simplest model that no richer one beats, on the held-out blocks and on the tenths."""
    chosen = 0
    for index in range(1, len(trials)):
        if not trials[index].fit.converged:
            continue
        if not gains(trials[chosen].blocks - trials[index].blocks, BETTER):
            continue
        gain = tenths(points, trials[chosen].fit) - tenths(points, trials[index].fit)
        if gains(gain, FORESEEN):
            chosen = index
    return chosen


def gains(gain: Floats, errors: float) -> bool:
    """Whether the mean of a gain exceeds so many standard errors."""
    if gain.size < 2:
        return False
    return float(np.mean(gain)) > errors * float(np.std(gain, ddof=1)) / math.sqrt(gain.size)
