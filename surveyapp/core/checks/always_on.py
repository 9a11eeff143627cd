"""Checks that need no rule book: the data against themselves, card, coordinates and grid."""

from __future__ import annotations

from surveyapp.core.checks.coordinate_checks import coordinate_checks
from surveyapp.core.checks.determination_checks import determination_checks
from surveyapp.core.checks.grid_checks import grid_checks
from surveyapp.core.checks.session_blunders import session_blunder_checks
from surveyapp.core.checks.slip_checks import slip_checks
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.domain.results import Check


def always_on_checks(orientation: Orientation) -> list[Check]:
    """All of them, for every project."""
    return [
        *grid_checks(orientation),
        *session_blunder_checks(orientation),
        *coordinate_checks(orientation),
        *determination_checks(orientation),
        *slip_checks(orientation),
    ]
