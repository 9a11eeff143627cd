"""Breakthroughs for scripts, re-exported by ``surveyapp.api``: how far will two headings miss."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING, Any

from surveyapp.api.judgement import diagnose
from surveyapp.api.orientation import Source, oriented
from surveyapp.api.project import SOFTWARE, Folder, open_project
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.penetration_result import Prediction
from surveyapp.domain.project import Project
from surveyapp.errors import SurveyError

if TYPE_CHECKING:
    from surveyapp.core.penetration.mine import Mine
    from surveyapp.core.penetration.what_if import WhatIf
    from surveyapp.workflows.predicting import ReadyMine


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
    from surveyapp.workflows.simulating import simulated

    ready = _ready(source, plan)
    found = _explained(source, ready, _predicted(ready, ready.mine))
    if plan is not None:
        allowed = None if found.tolerance is None else found.tolerance.lateral_m
        candidates = candidates_of(ready.mine, ready.defaults)
        placed = plan_sides(ready.mine, candidates, plan, allowed, factor=found.factor)
        return replace(found, plan=placed)
    if monte_carlo:
        return replace(found, simulated=simulated(ready.mine, executor))
    return found


def _explained(source: Source, ready: ReadyMine, found: Prediction) -> Prediction:
    """The prediction with what the residuals of the traverses say of a measured miss."""
    from surveyapp.core.penetration.explaining import (
        HeadingResiduals,
        NamedEffect,
        explain,
        shifted_sides,
    )

    miss = ready.mine.plan.measured
    if miss is None or found.measured is None or found.measured.consistent:
        return found
    residuals = []
    for number, heading in enumerate(ready.mine.plan.headings):
        if not heading.traverse:
            continue
        try:
            made = diagnose(source, traverse=heading.traverse, log=False).diagnosis
            network = oriented(source, even_unfinished=True).network(heading.traverse)
        except SurveyError:
            continue  # nothing controls this traverse
        if made is not None:
            shown = [row for row in network.observations if row.kind is ObservationKind.GYRO]
            named = tuple(
                NamedEffect(
                    item.effect,
                    item.coefficients[0].value,
                    shifted_sides(item.effect, {g[0]: g[1] for g in item.grid}, shown),
                )
                for item in made.adopted
            )
            verdict = str(made.verdict)
            residuals.append(HeadingResiduals(number, heading.traverse, verdict, named))
    return replace(found, measured=explain(ready.mine, miss, found.measured, residuals))


def _ready(source: Source, plan: int | None = None) -> ReadyMine:
    """The mine of a project, ready for prediction."""
    from surveyapp.workflows.predicting import ready_mine

    computed = oriented(source, even_unfinished=True)
    kept = computed.orientation.project
    return ready_mine(kept, computed.result() if kept.sessions else None, plan_sides=plan)


def _predicted(ready: ReadyMine, mine: Mine) -> Prediction:
    from surveyapp.core.penetration.prediction import prediction

    return prediction(
        mine,
        ready.rule_book,
        project=ready.project,
        software=SOFTWARE,
        digest=ready.digest,
        warnings=ready.warnings,
    )


@dataclass(frozen=True, slots=True)
class Trial:
    """What is tried on a mine, and what it makes of the prediction: a value, changed by copies.

    Parameters
    ----------
    ready : ReadyMine
    tried : WhatIf
    prediction : Prediction
        With everything that is tried.
    """

    ready: ReadyMine
    tried: WhatIf
    prediction: Prediction

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON: those of the prediction."""
        return dict(self.prediction.to_dict())

    def changed(self, tried: WhatIf) -> Trial:
        """Another trial on the same mine."""
        return Trial(self.ready, tried, _predicted(self.ready, tried.changed()))

    def add_side(self) -> Trial:
        """One more gyro side where it gains most."""
        return self.changed(self.tried.with_best_side())

    def remove_side(self) -> Trial:
        """Without the side that was added last."""
        return self.changed(self.tried.without_last_side())

    def both_ends(self) -> Trial:
        """Every gyro side from both ends, or no longer."""
        return self.changed(replace(self.tried, both_ends=not self.tried.both_ends))

    def better_angles(self) -> Trial:
        """Angles with 5/7 of the sigma, or no longer."""
        return self.changed(replace(self.tried, better_angles=not self.tried.better_angles))

    def better_gyro(self) -> Trial:
        """Gyro sides with 2/3 of the sigma, or no longer."""
        return self.changed(replace(self.tried, better_gyro=not self.tried.better_gyro))

    def survey(self) -> Trial:
        """One independent survey more, from three on none again."""
        more = (self.tried.more_surveys + 1) % 3
        return self.changed(replace(self.tried, more_surveys=more))


def record_step(
    project: Folder,
    step: int,
    *,
    by: str,
    file: str = "",
    note: str = "",
    centre_line_mm: float | None = None,
    waist_line_mm: float | None = None,
    now: datetime | None = None,
) -> None:
    """Record that a step of the procedure is done; step 5 may be recorded again and again.

    Parameters
    ----------
    project : path
    step : int
        1 to 6.
    by, file, note : str
        Who, with which file of the project folder, and anything else.
    centre_line_mm, waist_line_mm : float or None
        Readings of step 5.
    now : datetime or None
        When; None: today.

    Raises
    ------
    SurveyError
        If it cannot be recorded; nothing is written then.
    """
    from surveyapp.domain.penetration import ProcedureStep
    from surveyapp.workflows.procedure import record_step as record

    day = (now or datetime.now().astimezone()).date().isoformat()
    entry = ProcedureStep(step, day, by, note, file, centre_line_mm, waist_line_mm)
    record(open_project(project), entry)


def has_breakthrough(project: Project) -> bool:
    """Whether a project holds ``[penetration]``."""
    from surveyapp.workflows.predicting import has_penetration

    return has_penetration(project)


def trial(source: Source) -> Trial:
    """Begin to try things on a project's mine; nothing is tried yet.

    Raises
    ------
    SurveyError
        As ``predict``.
    """
    from surveyapp.core.penetration.what_if import WhatIf

    ready = _ready(source)
    return Trial(ready, WhatIf(ready.mine, ready.defaults), _predicted(ready, ready.mine))
