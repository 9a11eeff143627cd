"""All checks in half a sentence."""

from __future__ import annotations

from surveyapp.domain.results import OrientationResult
from surveyapp.tui import texts


def summary(result: OrientationResult) -> str:
    """All confirmed checks in half a sentence."""
    confirmed = [check for check in result.checks if check.confirmed and check.passed is not None]
    failed = [check for check in confirmed if not check.passed]
    if failed:
        return texts.SOME_NOT_MET.format(count=len(failed), total=len(confirmed))
    return texts.ALL_MET if confirmed else texts.NO_CHECKS
