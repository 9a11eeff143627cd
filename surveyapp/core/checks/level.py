"""The level of the tests that are always on: shared over the whole project.

A clean project alarms in one case of twenty, however many sessions it has: each family of tests
has a share of that, and divides it by the number of its tests (Bonferroni). What is measured of it
is printed by ``python -m bench blunders``.
"""

from __future__ import annotations

from typing import Final

PROJECT_LEVEL: Final = 0.05
"""Of all tests of a clean project together."""
FIT_SHARE: Final = 0.02
"""Four kinds of tests of fit at ``goodness.SIGNIFICANCE`` each."""
FAMILY_SHARE: Final = 0.003
"""Of each of the ten other families: drift and agreement of sights, collimation, tape zero and its
readings, rounds, constants, sessions of a line, forward and back, coordinates."""


def level_of_one(tests: int) -> float:
    """Level of one test of a family of so many."""
    return FAMILY_SHARE / max(tests, 1)
