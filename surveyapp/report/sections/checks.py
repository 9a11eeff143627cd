"""Checks with clause and verdict as words, and the warnings of the result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from surveyapp.domain.results import Check
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said, term
from surveyapp.report.blocks import Block, ForWidth, Heading, Paragraph, Table
from surveyapp.report.numbers import four_digits


@dataclass(frozen=True, slots=True)
class Column:
    """One thing that is told of a check.

    Parameters
    ----------
    head : str
    of : callable
        From the check to its text.
    align : str
    open_head : str
        Head where the data cannot answer; empty: not told there.
    """

    head: str
    of: Callable[[Check], str]
    align: str = "l"
    open_head: str = ""


_TERMINAL: Final = (
    Column(said("verdict"), lambda check: term(check.verdict)),
    Column(said("check"), lambda check: check.rule, open_head=said("check")),
    Column(said("where"), lambda check: check.where, open_head=said("where")),
    Column(said("value"), lambda check: four_digits(check.value), "r"),
    Column(said("limit"), lambda check: four_digits(check.limit), "r", said("limit")),
    Column(said("unit"), lambda check: term(check.unit), open_head=said("unit")),
)
COLUMNS: Final = (
    *_TERMINAL,
    Column(said("what"), lambda check: check.text, open_head=said("what is missing")),
    Column(said("clause"), lambda check: term(check.clause), open_head=said("clause")),
)
"""Everything that is told of a check: a new field is one entry."""
HEAD: Final = tuple(column.head for column in _TERMINAL)
"""Heads of ``row``."""
ALIGN: Final = "".join(column.align for column in _TERMINAL)
"""Alignment of ``row``."""


def row(check: Check) -> tuple[str, ...]:
    """One check in one row, without running text."""
    return tuple(column.of(check) for column in _TERMINAL)


def table(checks: Iterable[Check]) -> Table:
    """Every check in a row, what is not met first, what could not be answered last."""
    shown = ordered(checks)
    return Table(HEAD, tuple(row(check) for check in shown), ALIGN, strong=_strong(shown))


def details(check: Check) -> tuple[Paragraph, ...]:
    """The running text of a check: its sentence and its clause."""
    return tuple(Paragraph(column.of(check)) for column in COLUMNS[len(_TERMINAL) :])


def ordered(checks: Iterable[Check]) -> list[Check]:
    """The checks, what is not met first, what could not be answered last."""
    order = {False: 0, True: 1, None: 2}
    return sorted(checks, key=lambda check: order[check.passed])


def blocks(checks: Sequence[Check], warnings: Sequence[ResultWarning] = ()) -> tuple[Block, ...]:
    """Answered checks, open ones, warnings.

    Parameters
    ----------
    checks : sequence of Check
    warnings : sequence of ResultWarning
        Shown as well: what they say of a check is not said twice.
    """
    found: list[Block] = [Heading(said("Checks"))]
    answered = ordered(check for check in checks if check.passed is not None)
    unanswered = [check for check in checks if check.passed is None]
    if answered:
        found.append(ForWidth((_answered(answered),), _narrow(answered, warnings)))
    else:
        found.append(Paragraph(said("Nothing in this project can be checked yet.")))
    if unanswered:
        found += [
            Heading(said("Limits that the data of this project cannot answer"), 2),
            ForWidth((_open(unanswered),), _missing(unanswered)),
        ]
    if warnings:
        found.append(Heading(said("Warnings"), 2))
        found += [Paragraph(joined(": ", (item.code, item.text)), "warning") for item in warnings]
    return tuple(found)


def _strong(checks: Sequence[Check]) -> frozenset[int]:
    return frozenset(i for i, check in enumerate(checks) if check.passed is False)


def _answered(checks: Sequence[Check]) -> Table:
    rows = tuple(tuple(column.of(check) for column in COLUMNS) for check in _wrappable(checks))
    head = tuple(column.head for column in COLUMNS)
    align = "".join(column.align for column in COLUMNS)
    return Table(head, rows, align, strong=_strong(checks))


def _narrow(checks: Sequence[Check], warnings: Sequence[ResultWarning]) -> tuple[Block, ...]:
    """A row for each check, then what is not met in words, then where the limits come from."""
    found: list[Block] = [
        Table(HEAD, tuple(row(check) for check in checks), ALIGN, strong=_strong(checks))
    ]
    loud = {(warning.code, warning.subject) for warning in warnings}
    found += [
        Paragraph(joined(": ", filter(None, (term(check.verdict), check.where, check.text))))
        for check in checks
        if check.passed is False
        and check.text
        and not check.is_part
        and (check.warning_code, check.subject) not in loud
    ]
    clauses: dict[str, dict[str, None]] = {}
    for check in checks:
        clauses.setdefault(check.clause, {})[check.rule] = None
    facts = tuple((term(clause), ", ".join(rules)) for clause, rules in clauses.items())
    return (*found, *(Paragraph(joined(": ", fact), "small") for fact in facts))


def _open(checks: Sequence[Check]) -> Table:
    columns = [column for column in COLUMNS if column.open_head]
    rows = tuple(tuple(column.of(check) for column in columns) for check in _wrappable(checks))
    head = tuple(column.open_head for column in columns)
    return Table(head, rows, "".join(column.align for column in columns))


def _missing(checks: Sequence[Check]) -> tuple[Block, ...]:
    """What the data cannot answer, by what is missing."""
    missing: dict[str, dict[str, None]] = {}
    for check in checks:
        name = f"{check.rule} ({check.where})" if check.where else check.rule
        missing.setdefault(check.text, {})[name] = None
    return tuple(
        Paragraph(joined(": ", (text, ", ".join(rules)))) for text, rules in missing.items()
    )


def _wrappable(checks: Sequence[Check]) -> Iterator[Check]:
    """Checks whose ids may be wrapped behind the name of their rule book."""
    for check in checks:
        book, dot, name = check.rule.partition(".")
        rule = f"{book}{dot} {name}" if dot else book
        yield replace(check, rule=rule + ("" if check.confirmed else said(" (not confirmed)")))
