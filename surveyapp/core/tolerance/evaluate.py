"""Limits against measured quantities: the checks of a rule book.

A limit that the data cannot answer is listed as open, with what is missing. A limit that nobody
has confirmed in a source is applied all the same, and only warns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from surveyapp.core.tolerance.formula import FormulaError, evaluate, holds
from surveyapp.core.tolerance.quantities import PARAMETER, quantity
from surveyapp.domain.results import Check
from surveyapp.domain.rulebook import Limit, RuleBook
from surveyapp.domain.subject import Subject
from surveyapp.languages import joined, said

_ROUNDING = 1e-9
"""Relative: a value that equals its limit but for the last bits of a float meets it."""


@dataclass(frozen=True, slots=True)
class Measured:
    """One measured value of a quantity.

    Parameters
    ----------
    quantity : str
    value : float or None
        In the base unit of the quantity (arcsec, div, s, m, 1); None where it is missing.
    where : str
        Session, line, instrument or traverse.
    text : str
        What was compared, or what is missing.
    variables : mapping
        n and L, as far as the limit's formula needs them.
    class_name : str
        The class that the project states for this subject; empty: none, every class applies.
    subject : Subject
        What was measured, as a value.
    """

    quantity: str
    value: float | None
    where: str = ""
    text: str = ""
    variables: Mapping[str, float] = field(default_factory=dict)
    class_name: str = ""
    subject: Subject = field(kw_only=True)


def apply_limit(book: RuleBook, limit: Limit, item: Measured) -> Check | None:
    """Compare one value with one limit; None where the limit does not apply to it."""
    if item.class_name and limit.class_name and item.class_name != limit.class_name:
        return None
    kind = quantity(limit.quantity)
    # what a rule book states as a parameter is the least that a project may set for it
    sense = said("at least") if kind.subject == PARAMETER else limit.sense
    bound, missing = None, item.text if item.value is None else ""
    try:
        if not holds(limit.when, item.variables):
            return None
        bound = evaluate(limit.limit, item.variables)
    except FormulaError as error:
        missing = missing or joined(": ", (kind.title, error.args[0]))
    value = None if item.value is None else kind.in_unit(item.value, limit.unit)
    passed = None
    if value is not None and bound is not None:
        slack = _ROUNDING * max(abs(bound), 1.0)
        passed = value <= bound + slack if sense == "at most" else value >= bound - slack
    text = missing or (joined(": ", (kind.title, item.text)) if item.text else kind.title)
    if sense == "at least" and not missing:
        text += said(" (at least)")
    return Check(
        rule=f"{book.id}.{limit.id}",
        clause=limit.clause,
        value=value,
        limit=bound,
        confirmed=limit.confirmed,
        passed=passed,
        unit=limit.unit,
        where=item.where,
        text=text,
        subject=item.subject,
    )


def rule_book_checks(book: RuleBook, measured: Sequence[Measured]) -> tuple[Check, ...]:
    """Every limit of a rule book, applied to everything that was measured.

    Parameters
    ----------
    book : RuleBook
    measured : sequence of Measured
        Values, and what is missing, of any quantity.
    """
    by_quantity: dict[str, list[Measured]] = {}
    for item in measured:
        by_quantity.setdefault(item.quantity, []).append(item)
    checks = []
    for limit in book.limits:
        items = by_quantity.get(limit.quantity)
        if not items and quantity(limit.quantity).subject == PARAMETER:
            continue
        if not items:
            items = [
                Measured(
                    limit.quantity,
                    None,
                    text=said("missing: {needs}", needs=quantity(limit.quantity).needs),
                    subject=Subject.project(),
                )
            ]
        checks += [check for item in items if (check := apply_limit(book, limit, item)) is not None]
    return tuple(checks)


def limits_for(
    book: RuleBook,
    quantity_id: str,
    *,
    class_name: str = "",
    variables: Mapping[str, float] | None = None,
) -> tuple[tuple[Limit, float], ...]:
    """Limits of a quantity that apply, with their values in the base unit of the quantity.

    For whoever computes the quantity elsewhere (a prediction, a closure) and wants the limit.
    """
    found = []
    kind = quantity(quantity_id)
    for limit in book.limits:
        if limit.quantity != quantity_id or (
            class_name and limit.class_name and limit.class_name != class_name
        ):
            continue
        try:
            if holds(limit.when, variables or {}):
                bound = evaluate(limit.limit, variables or {})
                found.append((limit, bound / kind.in_unit(1.0, limit.unit)))
        except FormulaError:
            continue
    return tuple(found)
