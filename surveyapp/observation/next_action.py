"""What to observe next once a run is enough: each action with what it is expected to bring."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from surveyapp.errors import SurveyError

if TYPE_CHECKING:
    from surveyapp.diagnosis.outlook import ActionResult
    from surveyapp.domain.project import Project

SEED = 20260401


def next_actions(project: Project, session: str) -> tuple[ActionResult, ...]:
    """Actions after a run, the one that tells most first; none where nothing can be said.

    After turning points they are those of the run; an automatic gyro delivers azimuths, and what
    is next is a determination of its constant: the actions of its campaign.

    Parameters
    ----------
    project : Project
        A snapshot: nothing is read from the disk.
    session : str
        Id of the session.
    """
    from surveyapp.core.geodesy import grid_of, position_of
    from surveyapp.diagnosis.fits import fit_members
    from surveyapp.diagnosis.next_run import run_advice
    from surveyapp.diagnosis.subjects.choice import is_run, run_problem

    item = project.session(session)
    if item.method == "automatic":
        return _of_campaign(project, item.instrument)
    if not is_run(item):
        return ()
    try:
        position = position_of(project.station(item.station), grid_of(project))
        card = project.instrument(item.instrument).card
        case = run_problem(item, card, latitude=position.latitude)
        outlook = run_advice(case, fit_members(case, ()), np.random.default_rng(SEED))
    except SurveyError:
        return ()
    return () if outlook is None else outlook.actions


def _of_campaign(project: Project, instrument: str) -> tuple[ActionResult, ...]:
    """What another determination of the constant would tell, from four of them on."""
    from surveyapp.diagnosis.next_observation import advice
    from surveyapp.diagnosis.subjects.choice import campaign_problem
    from surveyapp.workflows.computing import generator_of, oriented

    try:
        orientation = oriented(project).orientation
        case, _ = campaign_problem(orientation, instrument)
        outlook = advice(case, generator_of(project))
    except SurveyError:
        return ()
    return () if outlook is None else outlook.actions
