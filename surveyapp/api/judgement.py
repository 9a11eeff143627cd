"""Limits, tests and causes for scripts, re-exported by ``surveyapp.api``: check and diagnose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from surveyapp.api.network import network
from surveyapp.api.orientation import computed, orient, oriented
from surveyapp.api.project import SOFTWARE, Folder, opened
from surveyapp.api.unfinished import without_unfinished
from surveyapp.domain.project import Project
from surveyapp.domain.results import Check
from surveyapp.errors import SurveyError

if TYPE_CHECKING:
    from surveyapp.workflows.diagnosing import Diagnosed

SubjectKeyword = Literal["session", "campaign", "traverse"]


def check(project: Project | Folder) -> tuple[Check, ...]:
    """Apply every limit and test that the project's data can answer.

    Raises
    ------
    SurveyError
        If the project cannot be used; what was changed after its closing is among the problems.
    """
    from surveyapp.io.project_checks import changed_after_closing

    try:
        project = opened(project)
        if project.tables.get("traverse"):
            return _with_traverses(project, oriented(without_unfinished(project)).checks)
        return orient(project).checks
    except SurveyError as error:
        folder = project.path if isinstance(project, Project) else project
        raise SurveyError([*changed_after_closing(Path(folder)), *error.problems]) from None


def _with_traverses(project: Project, checks: tuple[Check, ...]) -> tuple[Check, ...]:
    """Checks of the orientation with those of the traverses."""
    from surveyapp.io.traverse.checks import traverse_checks
    from surveyapp.io.traverse.header import traverse_headers

    networks = [
        (header.traverse_class, network(project, traverse=header.name))
        for header in traverse_headers(project)
    ]
    return traverse_checks(project, networks, checks)


def diagnose(
    project: Project | Folder,
    *,
    session: str | None = None,
    campaign: str | None = None,
    traverse: str | None = None,
    confirm: str | None = None,
    effects: Folder | None = None,
    adopt: bool = False,
    log: bool = True,
) -> Diagnosed:
    """Find which effect the model lacks, how sure that is, and prove it.

    Parameters
    ----------
    project : Project or path
    session : str or None
        Diagnose the turning points of this session.
    campaign : str or None
        Diagnose the determinations of this instrument.
    traverse : str or None
        Diagnose the conditions of this traverse.
    confirm : str or None
        A second session or traverse that chose nothing; for a campaign the session from which on
        the determinations only confirm.
    effects : path or None
        A Python file with a tuple ``EFFECTS`` of the user's own effects.
    adopt : bool
        Write the effects that the engine names into the project; the next ``orient`` uses them.
    log : bool
        Append the diagnosis to the project's ledger where it can be written.

    Raises
    ------
    SurveyError
        For an unknown subject, too few observations, or a project that cannot be written.
    """
    from surveyapp.io.user_effects.loading import load_effects
    from surveyapp.workflows.choosing import Request
    from surveyapp.workflows.diagnosing import diagnose_project

    project = opened(project)
    own = () if effects is None else load_effects(Path(effects), only_known_columns=True)
    kept = without_unfinished(project, keep=[name for name in (session, confirm) if name])
    return diagnose_project(
        computed(kept if kept.sessions else project),
        Request(session, campaign, confirm, own, traverse),
        folder=Path(project.path) if project.path else None,
        adopt=adopt,
        software=SOFTWARE,
        log=log,
        networks=lambda name: network(project, traverse=name),
    )


def subjects(project: Project | Folder) -> tuple[tuple[SubjectKeyword, str], ...]:
    """What ``diagnose`` can take of a project: its keyword and the id."""
    from surveyapp.workflows.choosing import subjects_of

    project = opened(project)
    keywords: dict[str, SubjectKeyword] = {
        "--session": "session",
        "--campaign": "campaign",
        "--traverse": "traverse",
    }
    kept = without_unfinished(project)
    return tuple((keywords[item.option], item.id) for item in subjects_of(kept))
