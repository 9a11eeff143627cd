"""Simulated surveys of a mine, by whoever computes: this process, others, a cluster."""

from __future__ import annotations

from concurrent.futures import Executor
from functools import partial

from surveyapp.core.penetration.mine import Mine
from surveyapp.core.penetration.simulation import Task, simulate_blocks, summary
from surveyapp.domain.penetration_result import SimulatedSigma
from surveyapp.workflows.spreading import spread
from surveyapp_models.arrays import Floats

TOGETHER = 10
"""Blocks that one worker takes at a time: a tenth of a second of work or more."""


def simulated_misses(task: Task, executor: Executor | None = None) -> list[Floats]:
    """Misses of all runs in the order of their blocks: the same, but for rounding, everywhere."""
    every = range(task.blocks)
    parts = [every[i : i + TOGETHER] for i in range(0, task.blocks, TOGETHER)]
    return list(spread(partial(simulate_blocks, task), parts, executor))


def simulated(mine: Mine, executor: Executor | None = None) -> SimulatedSigma:
    """1 sigma of the miss over as many surveys as the project asks for."""
    wanted = mine.plan.monte_carlo
    task = Task(mine, wanted.seed, wanted.runs)
    return summary(simulated_misses(task, executor), task)
