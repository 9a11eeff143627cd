"""Projects with sessions that are still being observed, re-exported by ``surveyapp.api``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from surveyapp.api.project import Folder, opened
from surveyapp.domain.project import Project, ResultWarning


def without_unfinished(project: Project, *, keep: Iterable[str] = ()) -> Project:
    """Project without the sessions that are still being observed, a warning for each.

    Parameters
    ----------
    project : Project
    keep : iterable of str
        Ids of sessions that stay whatever they lack.
    """
    from surveyapp.core.orientation.unfinished import without_unfinished as without
    from surveyapp.io.filing.seals import is_closed

    folder = Path(project.path) if project.path else None
    return without(
        project,
        keep=frozenset(keep),
        closed=lambda name: folder is not None and is_closed(folder, name),
    )


def unfinished(project: Project | Folder) -> tuple[ResultWarning, ...]:
    """What is left out of a project's results because it is still being observed."""
    project = opened(project)
    told = len(project.warnings)
    return without_unfinished(project).warnings[told:]
