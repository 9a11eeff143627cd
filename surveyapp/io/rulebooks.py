"""Rule books: installed ones by id, an office's own by path; every limit is read strictly.

An installed book is never written: whoever wants other limits copies it into the project, edits
the copy and names its path in ``rule_book``.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Final, cast

from surveyapp.core.tolerance.formula import FormulaError, parse
from surveyapp.core.tolerance.quantities import QUANTITIES, UNITS
from surveyapp.domain.rulebook import Limit, RuleBook, Sense
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.cards import is_path
from surveyapp.io.files import decode, read_inside, shown
from surveyapp.io.findings import Findings
from surveyapp.io.tables import Table, as_number, parse_toml
from surveyapp.languages import said

SENSES: Final = ("at most", "at least")


def installed_rule_book_ids() -> tuple[str, ...]:
    """Ids of the rule books that come with the program, sorted."""
    folder = resources.files("surveyapp_models").joinpath("tolerances")
    return tuple(sorted(item.name[:-5] for item in folder.iterdir() if item.name.endswith(".toml")))


def rule_book_text(name_or_path: str, *, base: Path) -> str:
    """Text of a rule book, for reading it and for making an editable copy.

    Raises
    ------
    SurveyError
        If there is none of this name; the nearest is named.
    """
    where = said("rule book {name_or_path}", name_or_path=shown(name_or_path))
    if is_path(name_or_path):
        return decode(read_inside(base, name_or_path, where=where), where=where)
    known = installed_rule_book_ids()
    if name_or_path not in known:
        raise SurveyError(
            Problem(
                "there is no such rule book",
                "project.toml, rule_book",
                shown(name_or_path),
                "the id of an installed rule book, or a path to your own ending in .toml",
                nearest_names(name_or_path, known),
            )
        )
    folder = resources.files("surveyapp_models").joinpath("tolerances")
    return folder.joinpath(f"{name_or_path}.toml").read_text(encoding="utf-8")


def read_rule_book(name_or_path: str, *, base: Path) -> RuleBook:
    """Read a rule book.

    Parameters
    ----------
    name_or_path : str
        Id of an installed rule book, or a path relative to ``base``.
    base : Path
        Folder of the file that names it.

    Raises
    ------
    SurveyError
        With every problem of the book together.
    """
    findings = Findings()
    text = rule_book_text(name_or_path, base=base)
    where = said("rule book {name_or_path}", name_or_path=shown(name_or_path))
    table = Table(parse_toml(text, where=where), where, findings)
    tables = table.tables("limit")
    limits = tuple(_limit(item) for item in tables)
    _unique(table, [limit.id for limit in limits])
    book = RuleBook(
        id=table.text("id", required=True) or "",
        title=table.text("title", required=True) or "",
        source=table.text("source", required=True, multiline=True) or "",
        limits=limits,
        note=table.text("note", multiline=True) or "",
        station_sigma_m=table.number("station_sigma_m", low=0.0, high=1e3),
    )
    table.refuse_unknown()
    findings.raise_if_any()
    return book


def _unique(table: Table, names: Sequence[str]) -> None:
    for name in sorted({n for n in names if n and names.count(n) > 1}):
        table.problem("two limits have one id", name, "each id once")


def _limit(table: Table) -> Limit:
    quantity = table.choice("quantity", [q.id for q in QUANTITIES], required=True) or ""
    unit = table.choice("unit", UNITS, required=True) or ""
    known = {q.id: q for q in QUANTITIES}
    if quantity in known and unit and unit not in known[quantity].units:
        expected = " | ".join(known[quantity].units)
        table.problem(
            said("{quantity} is not measured in {unit}", quantity=quantity, unit=unit),
            unit,
            expected,
        )
    confirmed = table.get("confirmed")
    if not isinstance(confirmed, bool):
        table.problem("confirmed is neither true nor false", confirmed, "true | false")
    limit = Limit(
        id=table.text("id", required=True) or "",
        quantity=quantity,
        limit=_number_or_formula(table),
        unit=unit,
        class_name=table.text("class") or "",
        clause=table.text("clause", required=True) or "",
        source=table.text("source", required=True, multiline=True) or "",
        confirmed=confirmed is True,
        sense=cast("Sense", table.choice("sense", SENSES) or "at most"),
        when=_formula(table, "when") or "",
        note=table.text("note", multiline=True) or "",
    )
    table.refuse_unknown()
    return limit


def _number_or_formula(table: Table) -> float | str:
    value = table.get("limit")
    if isinstance(value, str):
        return _formula(table, "limit") or 0.0
    number = as_number(value)
    if number is None or number < 0.0:
        table.problem("limit is no number", value, 'a number, or a formula like "14 * sqrt(n)"')
        return 0.0
    return number


def _formula(table: Table, key: str) -> str | None:
    text = table.text(key)
    if text is None:
        return None
    try:
        parse(text)
    except FormulaError as error:
        table.problem(
            said("{key} is no formula: {error}", key=key, error=error.args[0]),
            text,
            'arithmetic like "14 * sqrt(n)"',
        )
        return None
    return text
