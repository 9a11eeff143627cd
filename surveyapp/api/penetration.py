"""Breakthroughs for scripts, re-exported by ``surveyapp.api``: how far will two headings miss."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import replace

from surveyapp.api.orientation import Source, oriented
from surveyapp.api.project import SOFTWARE
from surveyapp.domain.penetration_result import Prediction


@contextmanager
def cluster_executor(address: str | None) -> Iterator[Executor | None]:
    """Executor of the cluster at an address (extra ``cluster``), None without one.

    Raises
    ------
    SurveyError
        If the extra is not installed, or nobody answers.
    """
    from surveyapp.workflows.cluster import cluster_executor as connected

    with connected(address) as executor:
        yield executor


def predict(
    source: Source,
    *,
    plan: int | None = None,
    monte_carlo: bool = True,
    executor: Executor | None = None,
) -> Prediction:
    """Predict the miss at the meeting point of a project's headings.

    Parameters
    ----------
    source : Project, path or Computed
    plan : int or None
        Place this many further gyro sides as well; no Monte Carlo then.
    monte_carlo : bool
        Simulate surveys beside the covariance.
    executor : concurrent.futures.Executor or None
        Who computes the simulated surveys; None: this process.

    Raises
    ------
    SurveyError
        If there is no ``[penetration]``, or with every reason why it cannot be predicted.
    """
    from surveyapp.core.penetration.planning import candidates_of, plan_sides
    from surveyapp.core.penetration.prediction import prediction
    from surveyapp.workflows.predicting import ready_mine
    from surveyapp.workflows.simulating import simulated

    computed = oriented(source, even_unfinished=True)
    kept = computed.orientation.project
    ready = ready_mine(kept, computed.result() if kept.sessions else None, plan_sides=plan)
    found = prediction(
        ready.mine,
        ready.rule_book,
        project=kept.name,
        software=SOFTWARE,
        digest=kept.digest,
        warnings=ready.warnings,
    )
    if plan is not None:
        allowed = None if found.tolerance is None else found.tolerance.lateral_m
        candidates = candidates_of(ready.mine, ready.defaults)
        placed = plan_sides(ready.mine, candidates, plan, allowed, found.factor)
        return replace(found, plan=placed)
    if monte_carlo:
        return replace(found, simulated=simulated(ready.mine, executor))
    return found
