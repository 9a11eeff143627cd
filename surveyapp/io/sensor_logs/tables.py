"""``[[sensor_log]]`` of project.toml, and how one of them becomes a file to read."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, cast

from surveyapp.domain.sensor_entry import SENSOR_KINDS, SensorKind, SensorLogEntry
from surveyapp.domain.sensor_log import NUMBER_COLUMNS, TEXT_COLUMNS
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.adopted_effects import read_effect
from surveyapp.io.files import shown
from surveyapp.io.sensor_logs.reading import LogRequest
from surveyapp.io.sensor_logs.units import UNITS
from surveyapp.io.tables import Table, as_number
from surveyapp.languages import said

_MAX_HEADER: Final = 150

OPTIONS: Final = (
    "note",
    "card",
    "reference_temperature_c",
    "declination_deg",
    "declination_sigma_deg",
    "heading_limit_deg",
    "table_rate_relative_sigma",
    "reading_from_elevation",
    "approximate_north_deg",
    "flip_sigma_arcsec",
    "room",
    "index_axis",
    "predict_at",
    "constant_deg",
    "constant_sigma_arcsec",
    "rate_sigma_deg_h",
    "bias_prior_deg_h",
    "bias_prior_sigma_deg_h",
    "initial_heading_deg",
    "initial_heading_sigma_deg",
    "initial_reference",
    "gravity_m_s2",
    "method",
    "track",
    "index_sigma_deg",
    "second",
    "indexed",
    "false_alarm",
    "path",
    "from",
    "to",
    "snap",
    "snap_power_cycle",
    "still_gate_factor",
    "unit_length_m",
    "heights",
)
"""Further keys that a subject may read; they are passed on as they stand."""


def read_sensor_logs(top: Table, lines: Sequence[int] = ()) -> tuple[SensorLogEntry, ...]:
    """Every ``[[sensor_log]]``; what is wrong goes to the findings of the table.

    Parameters
    ----------
    top : Table
        project.toml as a whole.
    lines : sequence of int
        Lines of the headers, for messages.
    """
    entries = [_entry(table) for table in top.tables("sensor_log", lines)]
    names = [entry.id for entry in entries if entry.id]
    for name in sorted({n for n in names if names.count(n) > 1}):
        top.problem("two sensor logs have one id", name, "an id for each")
    return tuple(entries)


def _entry(table: Table) -> SensorLogEntry:
    columns = _texts(table, "columns")
    known = (*NUMBER_COLUMNS, *TEXT_COLUMNS)
    for canonical in columns:
        if canonical not in known:
            hint = nearest_names(canonical, known)
            table.problem("columns: there is no such column", canonical, "a canonical name", hint)
    units = _texts(table, "units")
    for column, unit in units.items():
        if unit not in UNITS:
            hint = nearest_names(unit, UNITS)
            table.problem(
                said("units: {column} has no known unit", column=shown(column)),
                unit,
                "a unit",
                hint,
            )
    rows = table.number("header_rows", low=0, high=_MAX_HEADER)
    sha256 = table.text("sha256")
    entry = SensorLogEntry(
        id=table.text("id", required=True) or "",
        kind=cast("SensorKind | None", table.choice("kind", SENSOR_KINDS)),
        file=table.text("file", required=True) or "",
        columns=columns,
        units=units,
        scale=_numbers(table, "scale"),
        rate_hz=table.number("rate_hz", high=1e9, positive=True),
        header_rows=None if rows is None else int(rows),
        sha256=sha256,
        instrument=table.text("instrument"),
        serial=table.text("serial"),
        programme=table.text("programme"),
        latitude_deg=table.number("latitude_deg", low=-90.0, high=90.0),
        calibrated_on=table.date("calibrated_on"),
        options={key: table.get(key) for key in OPTIONS if key in table},
        effects=tuple(read_effect(one) for one in table.tables("effect")),
    )
    table.warn_unknown()
    return entry


def _texts(table: Table, key: str) -> dict[str, str]:
    inner = table.table(key)
    if inner is None:
        return {}
    return {name: text for name in inner.data if (text := inner.text(name, required=True))}


def _numbers(table: Table, key: str) -> dict[str, float]:
    inner = table.table(key)
    if inner is None:
        return {}
    found = {}
    for name, value in inner.data.items():
        number = as_number(value)
        if number is None or number == 0.0:
            inner.problem(
                said("{name} is no usable scale", name=shown(name)), value, "a number other than 0"
            )
        else:
            found[name] = number
    return found


def request_of(
    entry: SensorLogEntry,
    folder: Path,
    *,
    allow_outside: bool = False,
    override: Mapping[str, object] | None = None,
) -> LogRequest:
    """How the file of an entry is read.

    Parameters
    ----------
    entry : SensorLogEntry
    folder : Path
        Of the project.
    allow_outside : bool
        Whether a file outside the folder may be read.
    override : mapping, optional
        ``columns``, ``units``, ``scale``, ``rate_hz``, ``header_rows`` of the command line.

    Raises
    ------
    SurveyError
        If the file lies outside and that is not allowed.
    """
    if not allow_outside and not is_inside(folder, entry.file):
        raise SurveyError(
            Problem(
                "the log lies outside of the project folder",
                f"project.toml, [[sensor_log]] {entry.id}",
                entry.file,
                "a path below the project folder",
                "copy it into sensors/, or allow it with `allow_outside`",
            )
        )
    given = override or {}
    rate, rows = given.get("rate_hz"), given.get("header_rows")
    return LogRequest(
        path=folder / entry.file,
        where=entry.file,
        id=entry.id,
        columns={**entry.columns, **cast("Mapping[str, str]", given.get("columns") or {})},
        units={**entry.units, **cast("Mapping[str, str]", given.get("units") or {})},
        scale={**entry.scale, **cast("Mapping[str, float]", given.get("scale") or {})},
        rate_hz=entry.rate_hz if rate is None else cast("float", rate),
        header_rows=entry.header_rows if rows is None else cast("int", rows),
        sha256=entry.sha256,
    )


def is_inside(folder: Path, name: str) -> bool:
    """Whether a path as written leads to a place below the folder, links followed."""
    root = Path(os.path.realpath(folder))
    return Path(os.path.realpath(root / name.replace("\\", "/"))).is_relative_to(root)
