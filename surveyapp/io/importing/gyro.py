"""Azimuths of automatic gyros as orientation sessions: one for each line and direction.

The instrument is one of the project; one that is not there yet is added with a card of its own that
claims nothing but its kind.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import ImportResult
from surveyapp.domain.project import Project
from surveyapp.domain.readings import COLUMNS
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown
from surveyapp.io.guarded import is_reserved, name_hint
from surveyapp.io.importers.fieldfiles.catalogue import importer_of
from surveyapp.io.importers.fieldfiles.gyrocsv import GyroReading
from surveyapp.io.importers.fieldfiles.lines import field_digest
from surveyapp.io.importing.stations import check_names, match_stations
from surveyapp.io.importing.texts import RAW_COLUMNS, csv_text, degrees, plain
from surveyapp.io.importing.traverse import ImportOptions, Planned, traverse_name
from surveyapp.io.importing.writing import Additions, Content, FileCopy, stored_name, taken_files
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC

_UNSAFE: Final = '/\\:*?"<>| '


def plan_gyro(
    project: Project, form: str, file: Path, options: ImportOptions, *, instrument: str
) -> Planned:
    """Everything that an import of azimuths would write into a project.

    Parameters
    ----------
    project : Project
    form : str
        Id of an importer of azimuths.
    file : Path
    options : ImportOptions
        ``traverse`` names the readings as read.
    instrument : str
        Id of the gyro.

    Raises
    ------
    SurveyError
        Whatever is wrong with file, options, names or instrument.
    """
    folder = Path(project.path)
    name = traverse_name(options, file)
    copied = FileCopy(file, field_digest(file))
    reader = importer_of(form).azimuths
    if reader is None:
        raise SurveyError(
            Problem("this format holds no azimuths", "import", shown(form), "a table of a gyro")
        )
    read = reader(file, options.read)
    readings = [_composed(reading) for reading in read.readings]
    lines: dict[tuple[str, str], list[GyroReading]] = {}
    for reading in readings:
        lines.setdefault((reading.station, reading.target), []).append(reading)
    names = list(dict.fromkeys(name for line in lines for name in line))
    check_names(names, file.name)
    stations, tables, warnings = match_stations(project, names, {}, options.fixed)
    raw = f"imports/{name}.raw.csv"
    stored = stored_name(folder, copied, name)
    files: dict[str, Content] = {stored: copied, raw: _raw(readings)}
    new_tables: list[tuple[str, dict[str, object]]] = [("station", table) for table in tables]
    card, card_warnings = _instrument(project, instrument)
    for path, (text, table) in card.items():
        files[path] = text.encode()
        new_tables.append(("instrument", table))
    sessions = _sessions(project, lines, name, instrument)
    files |= {str(table["book"]): text for table, text in sessions}
    new_tables += [("orientation", table) for table, _ in sessions]
    problems = taken_files(folder, files)
    if problems:
        raise SurveyError(problems)
    result = ImportResult(
        format=form,
        variant=read.variant,
        file=stored,
        sha256=copied.sha256,
        stations=tuple(stations),
        traverse="",
        book="",
        raw=raw,
        rows=len(readings),
        readings=len(readings),
        sets=(),
        sessions=tuple(str(table["id"]) for table, _ in sessions),
        skipped=read.skipped,
        warnings=(*read.warnings, *warnings, *card_warnings),
        written=False,
    )
    return Planned(result, Additions(files, new_tables))


def _composed(reading: GyroReading) -> GyroReading:
    names = [unicodedata.normalize("NFC", text) for text in (reading.station, reading.target)]
    return replace(reading, station=names[0], target=names[1])


def _raw(readings: Sequence[GyroReading]) -> bytes:
    empty = dict.fromkeys(RAW_COLUMNS, "")
    rows = [
        {
            **empty,
            "line": str(r.line),
            "at": r.station,
            "to": r.target,
            "hz_deg": degrees(r.azimuth),
            "temperature_c": plain(r.temperature_c),
            "time": r.time,
            "note": f"azimuth; {_note(r)}".rstrip("; "),
        }
        for r in readings
    ]
    return csv_text(RAW_COLUMNS, [tuple(row.values()) for row in rows])


def _note(reading: GyroReading) -> str:
    sigma = reading.sigma
    parts = [] if sigma is None else [f"sigma {sigma * RHO_ARCSEC:.4g} arcsec"]
    return "; ".join([*parts, *([reading.note] if reading.note else [])])


def _instrument(
    project: Project, instrument: str
) -> tuple[dict[str, tuple[str, dict[str, object]]], list[ResultWarning]]:
    """Card and table of an instrument that the project does not know yet."""
    if any(item.id == instrument for item in project.instruments):
        kind = project.instrument(instrument).card.kind
        if str(kind) != "automatic":
            raise SurveyError(
                Problem(
                    "the instrument is no automatic gyro",
                    "instrument",
                    f"{instrument}: {kind}",
                    "an instrument whose card says kind = automatic",
                )
            )
        return {}, []
    if not _safe(instrument) or is_reserved(instrument) or len(instrument) > 100:
        raise SurveyError(
            Problem(
                "this is no id of an instrument",
                "instrument",
                shown(instrument),
                "printable characters",
                name_hint(instrument),
            )
        )
    known = ", ".join(item.id for item in project.instruments) or "none"
    path = f"cards/{_safe(instrument)}.toml"
    text = (
        f'id = "{_safe(instrument)}"\n'
        f'title = "Automatic gyro {_safe(instrument)}"\nkind = "automatic"\n'
        'source = "made by an import: nothing is known of this instrument yet"\n'
    )
    warning = ResultWarning(
        "instrument_added",
        said(
            "{instrument} was no instrument of the project ({known}): it was added "
            "with the card {path}, which knows no sigma; name its real card in "
            "project.toml",
            instrument=instrument,
            known=known,
            path=path,
        ),
    )
    return {path: (text, {"id": instrument, "card": path})}, [warning]


def _safe(text: str) -> str:
    return "".join("-" if c in _UNSAFE or not c.isprintable() else c for c in text).strip(".-")


def _sessions(
    project: Project,
    lines: dict[tuple[str, str], list[GyroReading]],
    name: str,
    instrument: str,
) -> list[tuple[dict[str, object], bytes]]:
    """Table and book of each session."""
    taken = {session.id for session in project.sessions}
    found = []
    for (station, target), readings in lines.items():
        identity = f"{station}-{target}"
        number = 1
        while identity in taken:
            number += 1
            identity = f"{station}-{target}-{number}"
        taken.add(identity)
        table: dict[str, object] = {
            "id": identity,
            "station": station,
            "target": target,
            "instrument": instrument,
            "method": "automatic",
            "purpose": "survey",
            "book": f"observations/{_safe(name)}-{_safe(identity)}.csv",
        }
        rows = [
            (
                *(str(seq), reading.time, "", "azimuth", degrees(reading.azimuth), "deg"),
                *("", "", "", plain(reading.temperature_c), _note(reading)),
            )
            for seq, reading in enumerate(readings, start=1)
        ]
        found.append((table, csv_text(COLUMNS, rows)))
    return found
