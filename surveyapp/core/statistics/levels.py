"""Levels of significance: how rarely a test may speak where nothing is wrong. One place for all."""

from __future__ import annotations

from typing import Final

LOUD: Final = 0.01
"""A test whose failure stops a surveyor: fit, sights, tape zero, lines, alarms."""

CONSISTENT: Final = 0.05
"""A test that asks whether determinations may be taken together: what fails is kept apart."""
