"""Instrument constants as rows of text."""

from __future__ import annotations

from surveyapp.domain.results import Check, ConstantResult, OrientationResult
from surveyapp.domain.subject import Subject
from surveyapp.languages import shown, translated
from surveyapp.tui import texts
from surveyapp.tui.views.checks import quantity_text
from surveyapp.tui.views.form import arcsec_text, number_text

CONSTANT_COLUMNS = (
    texts.COL_INSTRUMENT,
    texts.COL_LINE,
    texts.COL_CONSTANT,
    texts.COL_SIGMA,
    texts.COL_COUNT,
    texts.COL_LENGTH,
)

CONSTANT_TESTS = ("constant.lines", "constant.before_after", "constant.known")


def constant_rows(result: OrientationResult) -> list[tuple[str, ...]]:
    """One row for each calibration line, then what is made of them."""
    rows: list[tuple[str, ...]] = []
    for constant in result.constants:
        rows += [
            (
                constant.instrument,
                f"{line.station}-{line.target}",
                arcsec_text(line.value, 2, sign=True),
                arcsec_text(line.sigma, 2),
                str(line.count),
                number_text(line.distance_m),
            )
            for line in constant.by_line
        ]
        if constant.value is not None:
            stable = {True: texts.STABLE, False: texts.NOT_STABLE, None: ""}[constant.stable]
            rows.append(
                (
                    constant.instrument,
                    f"{translated(constant.choice or '')} {stable}".strip(),
                    arcsec_text(constant.value, 2, sign=True),
                    arcsec_text(constant.sigma, 2),
                    str(constant.count),
                    "",
                )
            )
    return rows


def constant_of(result: OrientationResult, row: int) -> ConstantResult | None:
    """The constant that a row of ``constant_rows`` belongs to."""
    owners = [
        constant
        for constant in result.constants
        for _ in range(len(constant.by_line) + (constant.value is not None))
    ]
    return owners[row] if 0 <= row < len(owners) else None


def tests_of(result: OrientationResult, constant: ConstantResult) -> tuple[Check, ...]:
    """The tests whether the constant of an instrument stands still."""
    own = Subject.of("instrument", constant.instrument)
    return tuple(
        check for check in result.checks if check.rule in CONSTANT_TESTS and check.subject == own
    )


def constant_told(result: OrientationResult, constant: ConstantResult) -> list[str]:
    """The value in force with its interval, then each test with its verdict."""
    value = texts.CONSTANT_VALUE.format(
        choice=translated(constant.choice or ""),
        value=arcsec_text(constant.value, 2, sign=True),
        sigma=arcsec_text(constant.sigma, 2),
        interval=arcsec_text(constant.interval95),
    )
    tests = [_test(check) for check in tests_of(result, constant)]
    return [value, *(tests or [texts.CONSTANT_UNTESTED])]


def _test(check: Check) -> str:
    """A test in words, with its numbers where the words do not tell them."""
    text = shown(check.text) or check.rule
    value, limit = quantity_text(check.value, check.unit), quantity_text(check.limit, check.unit)
    if '"' not in text:
        text = texts.CONSTANT_NUMBERS.format(text=text, value=value, limit=limit)
    return texts.CONSTANT_TEST.format(verdict=translated(check.verdict), text=text)
