"""Levels of significance: how rarely a test may speak where nothing is wrong. One place for all."""

from __future__ import annotations

from typing import Final

LOUD: Final = 0.01
"""A test whose failure stops a surveyor: fit, sights, tape zero, lines, alarms."""

CONSISTENT: Final = 0.05
"""A test that asks whether determinations may be taken together: what fails is kept apart."""

PROJECT_LEVEL: Final = 0.05
"""Of all confirmed tests of a clean project together: each family of tests has a share of it and
divides it by the number of its tests (Bonferroni). What is measured of it is printed by
``python -m bench blunders``."""
FIT_KIND: Final = 0.005
"""Of each of the four kinds of tests of fit over all sessions of a project."""
CONSTANT_SHARE: Final = 0.01
"""Of the tests of the constants of all instruments: lines, epochs, a value known beforehand."""
FAMILY_SHARE: Final = 0.002
"""Of each of the nine other families: drift and agreement of sights, collimation, tape zero and its
readings, rounds, sessions of a line, forward and back, coordinates."""


def level_of_one(tests: int) -> float:
    """Level of one test of a family of so many."""
    return FAMILY_SHARE / max(tests, 1)
