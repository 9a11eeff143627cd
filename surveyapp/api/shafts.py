"""Shafts for scripts, re-exported by ``surveyapp.api``: orientation through wires, with gyro."""

from __future__ import annotations

from surveyapp.api.project import SOFTWARE, Folder, opened
from surveyapp.domain.project import Project
from surveyapp.domain.shaft_result import ShaftResult


def has_shafts(project: Project) -> bool:
    """Whether a project holds a ``[[shaft]]``."""
    return project.shafts is not None


def shaft(project: Project | Folder) -> ShaftResult:
    """Orient through every shaft of a project.

    Raises
    ------
    SurveyError
        If there is none, or with every problem of tables, books and networks.
    """
    from surveyapp.workflows.plumbing import orient_shafts

    return orient_shafts(opened(project), software=SOFTWARE)
