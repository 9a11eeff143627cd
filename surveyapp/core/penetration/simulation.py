"""Simulated surveys of a mine: readings are drawn and adjusted, the covariance is never sampled.

Every run draws the readings of its surveys (``drawing``), adjusts each heading as an adjustment
does (it knows no refraction, no deflection and not the true constant), and carries coordinates to
the meeting point. That is what the covariance promises to describe.

Runs come in blocks of a fixed size, each with a random stream of its own number, so that results
do not depend on who computes which block, beyond the rounding of a product of matrices (a worker
of one thread adds in another order than one of two).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from surveyapp.core.penetration.covariance import (
    HEIGHT_TRANSFER_DIVISOR,
    heights_known,
    normal_matrix,
    side_height_variance,
)
from surveyapp.core.penetration.drawing import Draw, own_errors, shared_errors
from surveyapp.core.penetration.mine import PPM, Mine
from surveyapp.domain.penetration_result import MissSigma, SimulatedSigma
from surveyapp_models.arrays import Floats

BLOCK = 500
"""Runs that are drawn together."""


@dataclass(frozen=True, slots=True)
class Undeclared:
    """What is in the mine and not in its declared sigmas.

    Parameters
    ----------
    gradient : float
        Temperature gradient at every wall that a heading names [K/m].
    scale_ppm : float
        Of the distance meter.
    shift : float
        Turn of all sides of heading 1 after its first [rad].
    """

    gradient: float = 0.0
    scale_ppm: float = 0.0
    shift: float = 0.0


@dataclass(frozen=True, slots=True)
class Task:
    """What a worker needs to simulate blocks.

    Parameters
    ----------
    mine : Mine
    seed, runs : int
    undeclared : Undeclared
    """

    mine: Mine
    seed: int
    runs: int
    undeclared: Undeclared = field(default_factory=Undeclared)

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return -(-self.runs // BLOCK)

    def size(self, block: int) -> int:
        """Runs of one block."""
        return min(BLOCK, self.runs - block * BLOCK)


def simulate_block(task: Task, block: int, solver: Floats | None = None) -> Floats:
    """Misses of one block of simulated surveys, shape (runs, 3) [m]: right, along, up.

    ``solver`` is that of ``adjuster`` where somebody has it already: it is the same for all blocks.
    """
    stream = np.random.SeedSequence(task.seed, spawn_key=(block,))
    draw = Draw(np.random.default_rng(stream), task.size(block))
    mine, surveys = task.mine, task.mine.plan.independent_surveys
    solver = adjuster(mine) if solver is None else solver
    shared = shared_errors(
        mine, draw, gradient=task.undeclared.gradient, shift=task.undeclared.shift
    )
    scale = (mine.plan.sigmas.scale_ppm or 0.0) * PPM * draw() + task.undeclared.scale_ppm * PPM
    starts, misses = start_errors(mine, draw), np.zeros((draw.runs, 3))
    for _ in range(surveys):
        azimuths = solver @ (shared + own_errors(mine, draw))
        closed = starts + closed_at_meeting(mine, azimuths, scale, draw)
        misses[:, :2] += closed.T @ mine.axes
        misses[:, 2] += height_errors(mine, draw)
    return misses / surveys


def adjuster(mine: Mine) -> Floats:
    """(A'WA)^-1 A'W: unknowns from readings, shape (unknowns, rows)."""
    arrays = mine.arrays
    pull = np.zeros((arrays.size, arrays.reading.size))
    for k in range(arrays.unknowns.shape[1]):
        rows = np.flatnonzero(arrays.unknowns[:, k] >= 0)
        value = arrays.partials[rows, k] * arrays.weight[rows]
        np.add.at(pull, (arrays.unknowns[rows, k], rows), value)
    return np.asarray(np.linalg.solve(normal_matrix(mine), pull), dtype=np.float64)


def start_errors(mine: Mine, draw: Draw) -> Floats:
    """What the starts do to the miss, east and north, shape (2, runs) [m]."""
    moved = np.zeros((2, draw.runs))
    groups: dict[str, Floats] = {}
    for number, route in enumerate(mine.routes):
        start = route.heading.start
        key = start.group or f"\0{number}"
        if key not in groups:
            groups[key] = draw(2)
        moved += route.sign * start.position_sigma_m * groups[key]
    return moved


def closed_at_meeting(mine: Mine, azimuths: Floats, scale: Floats, draw: Draw) -> Floats:
    """Heading 1 minus heading 2 from adjusted azimuths and drawn lengths, shape (2, runs) [m]."""
    miss = np.zeros((2, draw.runs))
    for first, heading in zip(mine.first_side, mine.headings, strict=True):
        route = heading.route
        found = azimuths[first : first + route.sides] + route.azimuth[:, None]
        random = np.hypot(heading.length_sigma, heading.length_centring)[:, None]
        length = route.length[:, None] * (1.0 + scale) + random * draw(route.sides)
        length[-1] += route.carried_m
        true_east = float(np.sum(route.reach * np.sin(route.azimuth)))
        true_north = float(np.sum(route.reach * np.cos(route.azimuth)))
        miss[0] += route.sign * (np.sum(length * np.sin(found), axis=0) - true_east)
        miss[1] += route.sign * (np.sum(length * np.cos(found), axis=0) - true_north)
    return miss


def height_errors(mine: Mine, draw: Draw) -> Floats:
    """Vertical miss of one survey, shape (runs,) [m]."""
    miss = np.zeros(draw.runs)
    transfers: dict[str, Floats] = {}
    for number, route in enumerate(mine.routes):
        sigma = np.sqrt(side_height_variance(mine, number))[:, None]
        miss += route.sign * np.sum(sigma * draw(route.sides), axis=0)
        depth = route.heading.height_transfer_m
        if depth is not None:
            key = route.heading.shaft or f"\0{number}"
            if key not in transfers:
                transfers[key] = draw()
            miss += route.sign * depth / HEIGHT_TRANSFER_DIVISOR * transfers[key]
    return miss


def summary(blocks: Iterable[Floats], task: Task) -> SimulatedSigma:
    """1 sigma over all runs, about the true meeting point."""
    square, count = np.zeros(3), 0
    for misses in blocks:
        square += np.sum(misses**2, axis=0)
        count += len(misses)
    sigma = np.sqrt(square / count)
    up = float(sigma[2]) if heights_known(task.mine) else None
    return SimulatedSigma(MissSigma(float(sigma[0]), float(sigma[1]), up), count, task.seed)


def simulate_blocks(task: Task, blocks: Sequence[int]) -> Floats:
    """Misses of several blocks, shape (runs, 3) [m]: one task of an executor."""
    solver = adjuster(task.mine)
    return np.concatenate([simulate_block(task, block, solver) for block in blocks])


def simulate_all(task: Task) -> Floats:
    """Misses of all runs in this process, shape (runs, 3) [m]."""
    return simulate_blocks(task, range(task.blocks))
