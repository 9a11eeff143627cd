"""Stations, instruments and sessions corrected in a form, where they stand in project.toml.

Values are edited in place, comments stay. What would make the project unusable, or change a closed
session, is refused and the file stands as before.
"""

from __future__ import annotations

import datetime as dt
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from surveyapp import api
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.decimals import typed_number
from surveyapp.io.files import read_text, shown
from surveyapp.io.filing.dependencies import dependencies, project_data, rows_of
from surveyapp.io.filing.ledger import read_ledger
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.filing.seals import closings_in_force
from surveyapp.io.tomltext import atomic_write
from surveyapp.io.writing import Key, set_values
from surveyapp.languages import said

TableKind = Literal["station", "instrument", "orientation"]
FieldKind = Literal["text", "number", "date", "yes"]
YES: Final = "yes"


@dataclass(frozen=True, slots=True)
class CorrectionField:
    """One value of a table: its key, or key and inner key, and what it must be."""

    key: str
    kind: FieldKind = "number"
    inner: str = ""

    @property
    def id(self) -> str:
        """Name of the field in a form."""
        return f"{self.key}-{self.inner}" if self.inner else self.key


@dataclass(frozen=True, slots=True)
class TableName:
    """One table of project.toml by its kind and its name or id."""

    kind: TableKind
    name: str


_DEFLECTION: Final = tuple(
    CorrectionField("deflection", "number", inner)
    for inner in ("xi_arcsec", "eta_arcsec", "sigma_arcsec")
)
FIELDS: Final[Mapping[TableKind, tuple[CorrectionField, ...]]] = {
    "station": (
        *(CorrectionField(key) for key in ("e", "n", "y_west", "x_south", "lat", "lon", "h")),
        CorrectionField("sigma_m"),
        CorrectionField("fixed", "yes"),
        *_DEFLECTION,
        CorrectionField("note", "text"),
    ),
    "instrument": (
        CorrectionField("card", "text"),
        CorrectionField("serial", "text"),
        CorrectionField("constant", "number", "arcsec"),
        CorrectionField("constant", "number", "sigma_arcsec"),
        CorrectionField("constant_choice", "text"),
        CorrectionField("scale_value_arcsec"),
        *(
            CorrectionField("period", "number", i)
            for i in ("latitude_deg", "tracking_s", "clamped_s")
        ),
        CorrectionField("torsion", "number", "lambda"),
        CorrectionField("note", "text"),
    ),
    "orientation": (
        *(CorrectionField(key, "text") for key in ("station", "target", "instrument")),
        CorrectionField("observer", "text"),
        CorrectionField("date", "date"),
        CorrectionField("azimuth_known", "text"),
        CorrectionField("azimuth_known_sigma_arcsec"),
        CorrectionField("wanted_interval_arcsec"),
        CorrectionField("circle_shift", "text"),
    ),
}
_PAIRS: Final = (("e", "n"), ("y_west", "x_south"), ("lat", "lon"))


def table_names(folder: Path) -> tuple[TableName, ...]:
    """Tables that can be corrected, in the order of the file.

    Raises
    ------
    SurveyError
        If project.toml is no TOML.
    """
    data = project_data(folder)
    return tuple(
        TableName(kind, str(row.get("name" if kind == "station" else "id", "")))
        for kind in FIELDS
        for row in rows_of(data, kind)
    )


def fields_of(folder: Path, table: TableName) -> dict[CorrectionField, str]:
    """Fields of a table with their texts; of positions only the pair in use, or east and north.

    Raises
    ------
    SurveyError
        If project.toml is no TOML, or has no such table any more.
    """
    row = _row(folder, table)
    pair = next((p for p in _PAIRS if any(key in row for key in p)), _PAIRS[0])
    others = {key for p in _PAIRS if p != pair for key in p}
    return {
        item: _text(row, item)
        for item in FIELDS[table.kind]
        if table.kind != "station" or item.key not in others
    }


def _row(folder: Path, table: TableName) -> Mapping[str, Any]:
    key = "name" if table.kind == "station" else "id"
    for row in rows_of(project_data(folder), table.kind):
        if str(row.get(key, "")) == table.name:
            return row
    raise SurveyError(
        Problem(
            said("there is no such table any more"),
            said("project.toml, {kind}", kind=table.kind),
            shown(table.name),
        )
    )


def _text(row: Mapping[str, Any], item: CorrectionField) -> str:
    value = row.get(item.key)
    if item.inner:
        value = value.get(item.inner) if isinstance(value, Mapping) else None
    if item.kind == "yes":
        return YES if value is True else ""
    return "" if value is None else str(value)


def correct(folder: Path, table: TableName, texts: Mapping[str, str]) -> tuple[str, ...]:
    """Write what was changed in a form, and return the names of the changed fields.

    Parameters
    ----------
    folder : Path
    table : TableName
    texts : mapping
        Text by the id of its field; an empty one takes the key away.

    Raises
    ------
    SurveyError
        If a text is no number or date, if the project could not be used any more, if a closed
        session depends on the table, or if the folder cannot be written to: nothing is changed.
    """
    with ProjectLock(folder) as lock:
        if not lock.writable:
            raise SurveyError(
                Problem(
                    said("this project cannot be written to now"),
                    shown(str(folder)),
                    said("it is open elsewhere, closed, or read-only"),
                )
            )
        before = fields_of(folder, table)
        changed = [item for item, text in before.items() if texts.get(item.id, text) != text]
        if not changed:
            return ()
        _need_open(folder, table)
        _write(folder, table, changed, texts)
    return tuple(item.id for item in changed)


def _write(
    folder: Path, table: TableName, changed: list[CorrectionField], texts: Mapping[str, str]
) -> None:
    row = _row(folder, table)
    values: dict[str, object] = {}
    problems = []
    for item in changed:
        try:
            value = _value(item, texts[item.id])
        except ValueError:
            where = said(
                "project.toml, {kind} {name}, {id}", kind=table.kind, name=table.name, id=item.id
            )
            problems.append(
                Problem(said("this is no {kind}", kind=item.kind), where, shown(texts[item.id]))
            )
            continue
        if item.inner:
            own = row.get(item.key)
            holder = values.setdefault(item.key, dict(own) if isinstance(own, Mapping) else {})
            assert isinstance(holder, dict)
            holder[item.inner] = value
        else:
            values[item.key] = value
    if problems:
        raise SurveyError(problems)
    for key, value in values.items():
        if isinstance(value, dict) and all(item is None for item in value.values()):
            values[key] = None
    _write_usable(folder, [((table.kind, table.name, key), value) for key, value in values.items()])


def _write_usable(folder: Path, changes: list[tuple[tuple[Key, ...], object]]) -> None:
    """Write, read the project, and take the old file back where that made it worse."""
    path = folder / "project.toml"
    old = read_text(path, where=path.name)
    known = _problems(folder)
    set_values(path, changes)
    new = [problem for problem in _problems(folder) if str(problem) not in {str(p) for p in known}]
    if new:
        atomic_write(path, old.encode("utf-8"))
        raise SurveyError(new)


def _problems(folder: Path) -> tuple[Problem, ...]:
    try:
        api.open_project(folder)
    except SurveyError as error:
        return error.problems
    return ()


def _value(item: CorrectionField, text: str) -> object:
    plain = text.strip()
    if not plain:
        return None
    if item.kind == "number":
        return typed_number(plain)
    if item.kind == "date":
        return dt.date.fromisoformat(plain)
    return True if item.kind == "yes" else plain


def _need_open(folder: Path, table: TableName) -> None:
    """Refuse where the azimuth of a closed session depends on the table."""
    own = f"{table.kind} {table.name}"
    for session in closings_in_force(read_ledger(folder)):
        named = session and own in dependencies(folder, session)
        if named or (table.kind == "orientation" and session == table.name):
            raise SurveyError(
                Problem(
                    said("a closed session would be changed by this"),
                    own,
                    session,
                    said("open sessions"),
                    said("reopen the session first; the ledger keeps the reason"),
                )
            )
