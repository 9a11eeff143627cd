"""The one list of verdicts of a project: command line, screens and record show what stands here.

A check is a function from the evidence to checks, and one line in ``CHECKS``. It reads no file,
computes no orientation, and says with ``subject`` what each verdict is about.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

from surveyapp.core.checks.always_on import always_on_checks
from surveyapp.core.checks.breakthrough_checks import breakthrough_checks
from surveyapp.core.checks.evidence import Evidence
from surveyapp.core.checks.filing_checks import filing_checks
from surveyapp.core.checks.instrument_checks import instrument_checks
from surveyapp.core.checks.levelling_checks import levelling_checks
from surveyapp.core.checks.limit_checks import limit_checks
from surveyapp.core.checks.session_checks import statistical_checks
from surveyapp.core.checks.traverse_checks import traverse_checks
from surveyapp.core.checks.validity import validity_checks
from surveyapp.domain.results import Check


@dataclass(frozen=True, slots=True)
class CheckGroup:
    """Checks that one function makes.

    Parameters
    ----------
    id : str
    title : str
        What is looked at, for the list of checks in the documentation.
    checks : callable
        From the evidence to its checks, none where nothing can be said.
    """

    id: str
    title: str
    checks: Callable[[Evidence], Iterable[Check]]


CHECKS: Final[tuple[CheckGroup, ...]] = (
    CheckGroup(
        "statistics",
        "the data against themselves: fit, tape zero, sights, constants, lines",
        lambda e: statistical_checks(e.orientation),
    ),
    CheckGroup(
        "instrument",
        "periods, supply and tape-zero tilt against the card",
        lambda e: instrument_checks(e.orientation),
    ),
    CheckGroup(
        "levelling",
        "the tilt of the standing axis against the card",
        lambda e: levelling_checks(e.orientation),
    ),
    CheckGroup(
        "always on",
        "the data against card, coordinates and grid; no rule book is needed",
        lambda e: always_on_checks(e.orientation),
    ),
    CheckGroup(
        "validity",
        "temperature, latitude and due date of the card",
        lambda e: validity_checks(e.orientation),
    ),
    CheckGroup("filing", "ledger and closings", lambda e: filing_checks(e.project.filing)),
    CheckGroup(
        "traverses",
        "closures and repeated sides of the traverses",
        lambda e: traverse_checks(e.traverses),
    ),
    CheckGroup(
        "breakthrough",
        "predicted and measured error at the meeting point against the project's own tolerance",
        lambda e: breakthrough_checks(e.breakthrough),
    ),
    CheckGroup("limits", "every limit of the rule book", limit_checks),
)
"""In the order in which they are shown."""


def verdicts(evidence: Evidence) -> tuple[Check, ...]:
    """Every check of a project.

    Raises
    ------
    SurveyError
        If a value of the project cannot be judged at all.
    """
    return tuple(check for group in CHECKS for check in group.checks(evidence))


def verdicts_of(checks: Iterable[Check], session: str) -> tuple[Check, ...]:
    """The checks that say something of one session: all but those of other sessions."""
    return tuple(
        check for check in checks if check.subject.kind != "session" or check.subject.id == session
    )
