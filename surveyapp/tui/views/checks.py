"""Checks in half a sentence, and a value with its unit."""

from __future__ import annotations

from surveyapp.domain.results import OrientationResult
from surveyapp.languages import translated
from surveyapp.tui import texts


def quantity_text(value: float | None, unit: str) -> str:
    """A value or limit with its unit."""
    if value is None:
        return texts.NOT_DETERMINED
    mark = {"arcsec": '"'}.get(unit, f" {translated(unit)}" if unit else "")
    return f"{value:.4g}{mark}"


def summary(result: OrientationResult) -> str:
    """All confirmed checks in half a sentence."""
    confirmed = [check for check in result.checks if check.confirmed and check.passed is not None]
    failed = [check for check in confirmed if not check.passed]
    if failed:
        return texts.SOME_NOT_MET.format(count=len(failed), total=len(confirmed))
    return texts.ALL_MET if confirmed else texts.NO_CHECKS
