"""Simulated surveys of a mine, by whoever computes: this process, others, a cluster."""

from __future__ import annotations

from concurrent.futures import Executor
from functools import partial

from surveyapp.core.penetration.mine import Mine
from surveyapp.core.penetration.simulation import Task, simulate_block, summary
from surveyapp.domain.penetration_result import SimulatedSigma
from surveyapp.workflows.spreading import spread


def simulated(mine: Mine, executor: Executor | None = None) -> SimulatedSigma:
    """1 sigma of the miss over as many surveys as the project asks for."""
    wanted = mine.plan.monte_carlo
    task = Task(mine, wanted.seed, wanted.runs)
    blocks = spread(partial(simulate_block, task), range(task.blocks), executor)
    return summary(blocks, task)
