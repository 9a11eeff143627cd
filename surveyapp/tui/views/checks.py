"""Checks as rows of text; the verdict is a word and never a colour alone."""

from __future__ import annotations

from surveyapp.domain.results import Check, OrientationResult
from surveyapp.languages import shown, translated
from surveyapp.tui import texts

CHECK_COLUMNS = (
    texts.COL_VERDICT,
    texts.COL_CHECK,
    texts.COL_WHERE,
    texts.COL_VALUE,
    texts.COL_LIMIT,
)


def ordered_checks(result: OrientationResult) -> list[Check]:
    """The checks, what is not met first, what could not be answered last."""
    order = {False: 0, True: 1, None: 2}
    return sorted(result.checks, key=lambda check: order[check.passed])


def check_rows(result: OrientationResult) -> list[tuple[str, ...]]:
    """Each check in one row, what is not met first."""
    return [
        (
            translated(check.verdict),
            check.rule,
            shown(check.where),
            quantity_text(check.value, check.unit),
            quantity_text(check.limit, check.unit),
        )
        for check in ordered_checks(result)
    ]


def check_texts(result: OrientationResult) -> list[str]:
    """Sentence and clause of each check, in the order of ``check_rows``."""
    return [f"{shown(check.text)}\n{shown(check.clause)}" for check in ordered_checks(result)]


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
