"""What the azimuth of a session depends on, each with its sha256: what a session's seal covers.

Its own table, the stations that it names or sights, its instrument with card, constant, priors and
adopted effects, the settings of the project, the calibrations of the instrument with their books,
and the logs and cards of the sensors that level or pre-orient it.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from surveyapp.errors import SurveyError
from surveyapp.io.cards import card_text
from surveyapp.io.files import decode, read_inside
from surveyapp.io.filing.ledger import digest_of
from surveyapp.io.filing.sealed_files import hash_inside
from surveyapp.io.tables import parse_toml

_TABLES: Final = ("station", "instrument", "orientation", "traverse", "shaft", "sensor_log")
_NO_SETTINGS: Final = frozenset({*_TABLES, "name", "note", "penetration"})


def project_data(folder: Path) -> dict[str, Any]:
    """project.toml as parsed."""
    where = "project.toml"
    return parse_toml(decode(read_inside(folder, where, where=where), where=where), where=where)


def rows_of(data: Mapping[str, Any], kind: str) -> list[Mapping[str, Any]]:
    """The tables of a kind that are tables."""
    rows = data.get(kind)
    listed = rows if isinstance(rows, Sequence) and not isinstance(rows, str) else ()
    return [row for row in listed if isinstance(row, Mapping)]


def plain(value: object) -> Any:
    """A value of TOML as JSON has it."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [plain(item) for item in value]
    return value if isinstance(value, str | int | float | bool) else str(value)


def session_table(folder: Path, session: str) -> dict[str, Any]:
    """The [[orientation]] table of a session with plain values, empty where there is none."""
    return _table(project_data(folder), session)


def _table(data: Mapping[str, Any], session: str) -> dict[str, Any]:
    for row in rows_of(data, "orientation"):
        if row.get("id") == session:
            return {str(key): plain(value) for key, value in row.items()}
    return {}


def dependencies(folder: Path, session: str) -> dict[str, str]:
    """Hash of everything beside table and book that a session's azimuth depends on, by its name.

    Raises
    ------
    SurveyError
        If project.toml cannot be read; a card or book that cannot is hashed as missing.
    """
    data = project_data(folder)
    own = _table(data, session)
    instrument = str(own.get("instrument", ""))
    calibrations = [
        row
        for row in rows_of(data, "orientation")
        if row.get("instrument") == instrument
        and row.get("purpose") == "calibration"
        and row.get("id") != session
    ]
    found = {"settings of the project": digest_of(_settings(data))}
    rows = (own, *calibrations)
    named = {str(row.get(key, "")) for row in rows for key in ("station", "target")}
    named |= {name for row in rows for name in _sighted(folder, str(row.get("book", "")))}
    for row in rows_of(data, "station"):
        if str(row.get("name", "")) in named:
            found[f"station {row.get('name')}"] = digest_of(plain(row))
    for row in rows_of(data, "instrument"):
        if row.get("id") == instrument:
            found[f"instrument {instrument}"] = digest_of(plain(row))
            found[f"card of {instrument}"] = _card_digest(folder, str(row.get("card", "")))
            if "priors" in row:
                found[f"priors of {instrument}"] = _book_digest(folder, str(row["priors"]))
    found |= _sensors(folder, data, rows)
    for row in calibrations:
        book = _book_digest(folder, str(row.get("book", "")))
        found[f"calibration {row.get('id')}"] = digest_of({"table": plain(row), "book": book})
    return found


def _sighted(folder: Path, book: str) -> set[str]:
    """Targets that a book names beside the session's own."""
    try:
        text = decode(read_inside(folder, book, where=book), where=book)
    except SurveyError:
        return set()
    try:
        return {str(row.get("target") or "") for row in csv.DictReader(io.StringIO(text))}
    except csv.Error:
        return set()


def _sensors(
    folder: Path, data: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]
) -> dict[str, str]:
    """Logs and cards by which sessions are levelled and pre-oriented."""
    found = {}
    for row in rows:
        for key in ("levelling", "pre_orientation"):
            named = row.get(key)
            if not isinstance(named, Mapping):
                continue
            log, card = str(named.get("log", "")), str(named.get("card", ""))
            found[f"sensor card {card}"] = _book_digest(folder, card)
            for entry in rows_of(data, "sensor_log"):
                if entry.get("id") == log:
                    file = _book_digest(folder, str(entry.get("file", "")))
                    found[f"sensor log {log}"] = digest_of({"table": plain(entry), "file": file})
    return found


def _settings(data: Mapping[str, Any]) -> dict[str, Any]:
    return {str(k): plain(v) for k, v in data.items() if k not in _NO_SETTINGS}


def _card_digest(folder: Path, card: str) -> str:
    try:
        return digest_of({"text": card_text(card, folder, "")})
    except SurveyError:
        return "missing"


def _book_digest(folder: Path, book: str) -> str:
    try:
        return hash_inside(folder, book).sha256
    except SurveyError:
        return "missing"


def differences(before: Mapping[str, Any], now: Mapping[str, str]) -> list[str]:
    """What is no longer as it was, in words."""
    found = [f"{name} was changed" for name in before if name in now and before[name] != now[name]]
    found += [f"{name} is missing" for name in before if name not in now]
    found += [f"{name} was added" for name in now if name not in before]
    return found
