"""Whether a user's own effect has the form of one: texts, types and ranges, nothing computed."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from surveyapp.errors import Problem
from surveyapp.languages import said
from surveyapp_models.effects.effect import (
    SUBJECTS,
    Coefficient,
    Column,
    Effect,
    GridParameter,
)

_TEXTS = ("title", "datum", "source", "remedy", "symptom", "separate_by")
_CHOICES: dict[str, tuple[object, ...]] = {
    "subject": SUBJECTS,
    "per": (None, "session", "instrument", "line"),
    "acts_on": ("midpoint", "amplitude", "observation"),
    "one_sided": (True, False),
}


def form_problems(effect: Effect, file: str) -> list[Problem]:
    """Everything that is wrong with the form of one effect.

    Parameters
    ----------
    effect : Effect
        As the user made it: a dataclass does not look at what it is given.
    file : str
        For messages.
    """
    where = said("{file}, effect {id}", file=file, id=effect.id)
    found: list[Problem] = []

    def wrong(what: str, value: object, expected: str) -> None:
        found.append(Problem(what, where, repr(value)[:120], expected))

    if not _text(effect.id):
        wrong("id is no text", effect.id, "a text")
    for name in _TEXTS:
        if not _text(getattr(effect, name)):
            wrong(
                said("{name} is no text", name=name),
                getattr(effect, name),
                "a text for the surveyor",
            )
    for name, choices in _CHOICES.items():
        value = getattr(effect, name)
        if not any(value is choice or value == choice for choice in choices):
            wrong(
                said("{name} is not known", name=name),
                value,
                ", ".join(str(item) for item in choices),
            )
    for name, kind in (("needs", Column), ("coefficients", Coefficient), ("grid", GridParameter)):
        items = getattr(effect, name)
        if not isinstance(items, tuple) or not all(isinstance(item, kind) for item in items):
            wrong(
                said("{name} is no tuple of {name2}", name=name, name2=kind.__name__),
                items,
                f"({kind.__name__}(...), ...)",
            )
    if not isinstance(effect.confusable_with, tuple):
        wrong("confusable_with is no tuple", effect.confusable_with, '("id", ...)')
    for name in ("basis", "law", "at_datum", "midpoint", "reference"):
        value = getattr(effect, name)
        if not callable(value) and (value is not None or name == "basis"):
            wrong(said("{name} is no function", name=name), value, "a function")
    if not found:
        _parts(effect, wrong)
    return found


def _text(value: Any) -> bool:
    return isinstance(value, str) and bool(value.strip())


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _parts(effect: Effect, wrong: Callable[[str, object, str], None]) -> None:
    """Columns, coefficients and scanned parameters, each by itself."""
    if not effect.needs:
        wrong("needs is empty", effect.needs, "the columns that the effect reads")
    for column in effect.needs:
        if not _text(column.name) or not isinstance(column.unit, str):
            wrong("a column has no name or no unit", column, "Column(name, unit)")
    for item in effect.coefficients:
        _coefficient(item, wrong)
        if effect.one_sided and item.low != 0.0:
            wrong("a one-sided coefficient does not begin at 0", item.low, "low = 0.0")
    for parameter in effect.grid:
        if not _text(parameter.name) or not callable(parameter.values):
            what = "a scanned parameter has no name or no function"
            wrong(what, parameter, "GridParameter(name, unit, values, meaning)")
    for name, items in (
        ("needs", effect.needs),
        ("coefficients", effect.coefficients),
        ("grid", effect.grid),
    ):
        names = [item.name for item in items]
        if len(set(names)) < len(names):
            wrong(said("a name stands twice in {name}", name=name), names, "names that differ")


def _coefficient(item: Coefficient, wrong: Callable[[str, object, str], None]) -> None:
    name = f"coefficient {item.name}"
    if not all(_text(text) for text in (item.name, item.unit, item.meaning)):
        wrong("a coefficient lacks its name, unit or meaning", item, "texts")
    if not _number(item.scale) or not item.scale > 0.0:
        wrong(
            said("the scale of {name} is no size of a unit", name=name),
            item.scale,
            "a finite number above 0",
        )
    if not (_number(item.low) and _number(item.high)):
        what = said("the plausible range of {name} is not finite", name=name)
        wrong(what, (item.low, item.high), "two finite numbers")
    elif not (item.low < item.high and item.low <= 0.0 <= item.high):
        what = said(
            "the plausible range of {name} is none that holds 0, where the effect is absent",
            name=name,
        )
        wrong(what, (item.low, item.high), "low < high, low <= 0 <= high")
