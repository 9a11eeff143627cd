"""The adopted effects that stand in project.toml, of a session or of an instrument.

As in ``project_tables``: an effect is returned in any case, what is wrong is noted in the findings.
"""

from __future__ import annotations

from typing import Literal, cast

from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.io.cards import number_pair
from surveyapp.io.files import shown
from surveyapp.io.tables import Table, as_number
from surveyapp.languages import said
from surveyapp_models.effects.recurrent import course_faults


def read_effect(table: Table) -> AdoptedEffect:
    """One adopted effect of a session or an instrument."""
    coefficients = []
    inner = table.table("coefficients")
    for name in inner.data if inner is not None else ():
        one = inner.table(name) if inner is not None else None
        if one is None:
            continue
        value = one.number("value", required=True)
        sigma = one.number("sigma", low=0.0)
        coefficients.append((name, value or 0.0, sigma or 0.0, one.text("unit") or ""))
        one.warn_unknown()
    adopted_at = table.get("adopted_at")
    effect = AdoptedEffect(
        id=table.text("id", required=True) or "",
        coefficients=tuple(coefficients),
        grid=_grid(table),
        covariance=_covariance(table, len(coefficients)),
        valid=_valid(table),
        reference=_reference(table),
        time=cast("Literal['days', 'order', '']", table.choice("time", ("days", "order")) or ""),
        sessions=_sessions(table),
        data_sha256=table.text("sha256") or "",
        before=table.number("before", low=0.0),
        after=table.number("after", low=0.0),
        confirm=table.number("confirm", low=0.0),
        adopted_at="" if adopted_at is None else str(adopted_at),
        software=table.text("software") or "",
        unit=table.text("unit") or "arcsec",
        course=_course(table),
        run=table.text("run") or "",
    )
    table.get("note")
    table.warn_unknown()
    return effect


def _grid(effect: Table) -> tuple[tuple[str, float | str], ...]:
    table = effect.table("grid")
    if table is None:
        return ()
    pairs: list[tuple[str, float | str | None]] = [
        (name, table.text(name) if isinstance(value, str) else table.number(name))
        for name, value in table.data.items()
    ]
    return tuple((name, value) for name, value in pairs if value is not None)


def _reference(effect: Table) -> tuple[tuple[str, float], ...]:
    table = effect.table("reference")
    if table is None:
        return ()
    pairs = [(name, table.number(name)) for name in table.data]
    return tuple((name, value) for name, value in pairs if value is not None)


def _sessions(effect: Table) -> tuple[str, ...]:
    value = effect.get("sessions")
    if value is None:
        return ()
    if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
        effect.problem("sessions is no list of names", value, '["...", "..."]')
        return ()
    return tuple(value)


def _covariance(effect: Table, size: int) -> tuple[tuple[float, ...], ...]:
    value = effect.get("covariance")
    if value is None:
        return ()
    rows = value if isinstance(value, list) else []
    matrix = [[as_number(item) for item in row] if isinstance(row, list) else [] for row in rows]
    numbers = [tuple(x for x in row if x is not None) for row in matrix]
    if (
        len(numbers) != size
        or any(len(row) != size for row in numbers)
        or any(len(row) != len(given) for row, given in zip(numbers, matrix, strict=True))
    ):
        effect.problem(
            "covariance does not fit the coefficients",
            value,
            said("{size} x {size} numbers", size=size),
        )
        return ()
    return tuple(numbers)


def _course(effect: Table) -> tuple[tuple[float, ...], ...]:
    value = effect.get("course")
    if value is None:
        return ()
    rows = value if isinstance(value, list) else [None]
    numbers = [[as_number(item) for item in row] if isinstance(row, list) else [] for row in rows]
    course = tuple(tuple(x for x in row if x is not None) for row in numbers)
    fault = course_faults(course)
    if any(len(row) != len(given) for row, given in zip(course, numbers, strict=True)):
        fault = "something that is no number"
    if fault:
        effect.problem("course cannot be used", fault, "[[half swings, shift, errors ...], ...]")
        return ()
    return course


def _valid(effect: Table) -> tuple[tuple[str, float, float], ...]:
    table = effect.table("valid")
    if table is None:
        return ()
    ranges = []
    for name, value in table.data.items():
        pair = number_pair(value)
        if pair is None:
            table.problem(said("{name} is no range", name=shown(name)), value, "[lowest, highest]")
        else:
            ranges.append((name, *pair))
        table.get(name)
    return tuple(ranges)
