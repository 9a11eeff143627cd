"""The result of an orientation as blocks: what the command, the screens and the record all show."""

from __future__ import annotations

from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.report.blocks import Block
from surveyapp.report.sections import azimuths, checks, constants
from surveyapp.report.sections import reduction as of_sessions


def result_blocks(
    project: Project, result: OrientationResult, *, reduction: bool = False
) -> tuple[Block, ...]:
    """Azimuths, constants, sessions, checks and warnings, in the order of the record.

    Parameters
    ----------
    project : Project
    result : OrientationResult
    reduction : bool
        Whether every step of every session is told, or each session in one row.
    """
    sessions = of_sessions.blocks if reduction else of_sessions.summary
    return (
        *azimuths.blocks(project, result),
        *constants.blocks(result),
        *sessions(project, result),
        *checks.blocks(result.checks, result.warnings),
    )
