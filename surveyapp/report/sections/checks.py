"""Checks with clause and verdict as words, and the warnings of the result."""

from __future__ import annotations

from surveyapp.domain.results import Check, OrientationResult
from surveyapp.languages import joined, said, said_each, term
from surveyapp.report.blocks import Block, Heading, Paragraph, Table
from surveyapp.report.numbers import four_digits


def blocks(result: OrientationResult) -> tuple[Block, ...]:
    """Answered checks, open ones, warnings."""
    found: list[Block] = [Heading(said("Checks"))]
    answered = [check for check in result.checks if check.passed is not None]
    unanswered = [check for check in result.checks if check.passed is None]
    if answered:
        found.append(_answered(answered))
    else:
        found.append(Paragraph(said("Nothing in this project can be checked yet.")))
    if unanswered:
        found += [
            Heading(said("Limits that the data of this project cannot answer"), 2),
            _open(unanswered),
        ]
    if result.warnings:
        found.append(Heading(said("Warnings"), 2))
        found += [
            Paragraph(joined(": ", (item.code, item.text)), "warning") for item in result.warnings
        ]
    return tuple(found)


def _rule(check: Check) -> str:
    """Id of the limit; a space lets a long one wrap behind the name of its book."""
    book, dot, name = check.rule.partition(".")
    text = f"{book}{dot} {name}" if dot else book
    return text + ("" if check.confirmed else said(" (not confirmed)"))


def _answered(checks: list[Check]) -> Table:
    rows = tuple(
        (
            term(check.verdict),
            check.where,
            four_digits(check.value),
            four_digits(check.limit),
            term(check.unit),
            check.text,
            _rule(check),
            check.clause,
        )
        for check in checks
    )
    head = said_each(
        "verdict", "where", "value", "limit", "unit", "what", "limit or test", "clause"
    )
    strong = frozenset(i for i, check in enumerate(checks) if check.passed is False)
    return Table(head, rows, "llrrllll", strong=strong)


def _open(checks: list[Check]) -> Table:
    rows = tuple(
        (
            check.where,
            four_digits(check.limit),
            term(check.unit),
            check.text,
            _rule(check),
            check.clause,
        )
        for check in checks
    )
    head = said_each("where", "limit", "unit", "what is missing", "limit or test", "clause")
    return Table(head, rows, "lrllll")
