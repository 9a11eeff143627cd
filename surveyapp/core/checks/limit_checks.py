"""The rule book applied to everything that a project has measured and predicted."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from surveyapp.core.checks.breakthrough_checks import breakthrough_measures, shaft_measures
from surveyapp.core.checks.evidence import Evidence, TraverseEvidence
from surveyapp.core.network import adjust
from surveyapp.core.network.closures import network_closures
from surveyapp.core.network.fieldchecks import (
    closure_measures,
    ellipse_measures,
    gyro_measures,
    repeated_angles,
    repeated_traverse,
    side_measures,
)
from surveyapp.core.tolerance import Measured, rule_book_checks
from surveyapp.core.tolerance.measures import measure
from surveyapp.domain.results import Check
from surveyapp.domain.rulebook import RuleBook
from surveyapp.errors import SurveyError
from surveyapp.languages import said


def limit_checks(evidence: Evidence) -> tuple[Check, ...]:
    """Checks of the project's rule book; none where it names none."""
    book = evidence.project.rules
    if book is None:
        return ()
    measured = [
        *measure(evidence.orientation),
        *traverse_measures(evidence.traverses, book),
        *shaft_measures(evidence.shafts),
        *breakthrough_measures(evidence.breakthrough),
    ]
    return rule_book_checks(book, measured)


def traverse_measures(traverses: Sequence[TraverseEvidence], book: RuleBook) -> list[Measured]:
    """What traverses answer of a rule book: closures, repeated angles, gyro sides, ellipses."""
    found: list[Measured] = []
    for item in traverses:
        found += _of_one(item, book)
    for first, second in combinations(traverses, 2):
        found += repeated_traverse(
            first.network,
            second.network,
            class_name=first.traverse.traverse_class,
            subject=first.traverse.subject,
        )
    return found


def _of_one(item: TraverseEvidence, book: RuleBook) -> list[Measured]:
    name, subject = item.traverse.traverse_class, item.traverse.subject
    network = item.network
    found = closure_measures(network_closures(network), class_name=name, subject=subject)
    found += repeated_angles(network.observations, class_name=name, subject=subject)
    found += gyro_measures(network, class_name=name, subject=subject)
    found += side_measures(network, class_name=name, subject=subject)
    if any(limit.quantity == "control_ellipse" for limit in book.limits):
        found += _ellipses(item)
    return found


def _ellipses(item: TraverseEvidence) -> list[Measured]:
    """Relative ellipses of the adjusted traverse; why there are none where it has no adjustment."""
    name, subject = item.traverse.traverse_class, item.traverse.subject
    try:
        return ellipse_measures(adjust(item.network), class_name=name, subject=subject)
    except SurveyError as error:
        text = said("missing: an adjusted network ({what})", what=error.problems[0].what)
        quantity = "control_ellipse"
        return [Measured(quantity, None, subject.text, text, {}, name, subject=subject)]
