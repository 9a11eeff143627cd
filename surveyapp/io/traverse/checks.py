"""The checks of a project's traverses: closures, gyro sides, repeated angles, rule book.

What a rule book leaves open in an orientation because it needs a traverse is answered here.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from surveyapp.core.network import adjust
from surveyapp.core.network.closures import SIGMAS, network_closures
from surveyapp.core.network.fieldchecks import (
    closure_measures,
    ellipse_measures,
    forward_back,
    gyro_measures,
    repeated_angles,
    repeated_traverse,
    side_measures,
)
from surveyapp.core.tolerance import Measured, rule_book_checks
from surveyapp.domain.adjustment import Closure
from surveyapp.domain.project import Project
from surveyapp.domain.results import Check
from surveyapp.domain.rulebook import RuleBook
from surveyapp.domain.traverse import Network
from surveyapp.io.project_checks import project_rule_book
from surveyapp_models.angles import RHO_ARCSEC


def _closure_check(item: Closure) -> Check:
    """A closure against three of its own standard deviations."""
    angular = item.angular is not None
    value = abs(item.angular or 0.0) * RHO_ARCSEC if angular else abs(item.height_m or 0.0) * 1e3
    sigma = item.angular_sigma if angular else item.height_sigma_m
    scale = RHO_ARCSEC if angular else 1e3
    return Check(
        rule=f"traverse.{item.kind}_closure",
        clause="3 sigma of the misclosure",
        value=value,
        limit=None if sigma is None else SIGMAS * sigma * scale,
        confirmed=True,
        passed=item.passed,
        unit="arcsec" if angular else "mm",
        where="-".join(item.stations[:6]) + ("-..." if len(item.stations) > 6 else ""),
        text=f"{item.angles} angles" if angular else "heights",
    )


def _measured(network: Network, class_name: str, book: RuleBook | None) -> list[Measured]:
    measured = closure_measures(network_closures(network), class_name=class_name)
    measured += repeated_angles(network.observations, class_name=class_name)
    measured += gyro_measures(network, class_name=class_name)
    measured += side_measures(network, class_name=class_name)
    if book is not None and any(limit.quantity == "control_ellipse" for limit in book.limits):
        measured += ellipse_measures(adjust(network), class_name=class_name)
    return measured


def traverse_checks(
    project: Project, traverses: Sequence[tuple[str, Network]], known: Sequence[Check]
) -> tuple[Check, ...]:
    """Add the checks of traverses to those of the orientation.

    Parameters
    ----------
    project : Project
    traverses : sequence of (class, Network)
        Class in the rule book's words.
    known : sequence of Check
        What has been checked already; open limits that a traverse answers are replaced.

    Returns
    -------
    tuple of Check

    Raises
    ------
    SurveyError
        If the rule book, or a network whose ellipses it limits, cannot be used.
    """
    book = project_rule_book(project)
    measured: list[Measured] = []
    own: list[Check] = []
    for class_name, network in traverses:
        measured += _measured(network, class_name, book)
        own += [_closure_check(c) for c in network_closures(network) if c.passed is not None]
        own += forward_back(network)
    for (class_name, first), (_, second) in combinations(traverses, 2):
        measured += repeated_traverse(first, second, class_name=class_name)
    if book is not None:
        quantities = {item.quantity for item in measured}
        answered = {f"{book.id}.{x.id}" for x in book.limits if x.quantity in quantities}
        own += [check for check in rule_book_checks(book, measured) if check.rule in answered]
        known = [check for check in known if check.rule not in answered]
    return (*known, *own)
