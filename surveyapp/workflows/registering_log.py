"""A sensor log into a project: looked at, copied below the folder, and entered in project.toml."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import date
from pathlib import Path
from typing import Final

import numpy as np

from surveyapp.domain.advance import PartDone
from surveyapp.domain.log_preview import LogPreview, PreviewedColumn
from surveyapp.domain.sensor_entry import SENSOR_KINDS
from surveyapp.domain.sensor_log import NUMBER_COLUMNS, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import decode, shown_path
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.guarded import can_name_file, name_hint
from surveyapp.io.project import read_project
from surveyapp.io.sensor_logs.reading import LogFile, LogRequest, Need, open_log
from surveyapp.io.sensor_logs.tables import is_inside
from surveyapp.io.tomltext import atomic_write
from surveyapp.io.writing import append_table
from surveyapp.languages import either, said

FIRST_ROWS: Final = 3
LARGEST_COPY: Final = 64 * 1024 * 1024
"""A larger log stays where it is: the project pins it by its hash."""
_HEAD_BYTES: Final = 1 << 16


@dataclass(frozen=True, slots=True)
class LogEntryWish:
    """What the ``[[sensor_log]]`` of a log is to say beside its columns.

    Parameters
    ----------
    id : str
        Empty = the name of the file.
    kind, programme, instrument, serial : str or None
    latitude_deg : float or None
    calibrated_on : datetime.date or None
        Day of the record.
    """

    id: str = ""
    kind: str | None = None
    programme: str | None = None
    instrument: str | None = None
    serial: str | None = None
    latitude_deg: float | None = None
    calibrated_on: date | None = None
    more: Mapping[str, object] = field(default_factory=dict)


def preview_log(request: LogRequest, *, progress: PartDone | None = None) -> LogPreview:
    """What would be understood of a log, and everything that is wrong with it, in words.

    Raises
    ------
    SurveyError
        If the file cannot be opened or holds no table at all.
    """
    file = open_log(request)
    known = tuple(name for name in file.places if name in NUMBER_COLUMNS)
    problems: tuple[str, ...] = ()
    log: SensorLog | None = None
    try:
        log = file.read(Need(optional=None, timed="optional"), progress=progress)
    except SurveyError as error:
        problems = tuple(problem.text for problem in error.problems)
    if not known:
        named = ", ".join(file.layout.names)
        problems += (
            said("no column is a known one: {named}; map.CANON=COLUMN names them", named=named),
        )
    return LogPreview(
        path=str(request.path),
        columns=_columns(file, log),
        rows=0 if log is None else log.size,
        rate_hz=None if log is None else log.rate_hz,
        problems=problems,
        warnings=() if log is None else (*log.warnings, *_unstated(file)),
    )


def _columns(file: LogFile, log: SensorLog | None) -> tuple[PreviewedColumn, ...]:
    names = {place.index: canonical for canonical, place in file.places.items()}
    cells = _first_cells(file)
    found = []
    for index, name in enumerate(file.layout.names):
        canonical = names.get(index)
        place = None if canonical is None else file.places[canonical]
        taken = canonical if canonical is not None and _is_known(canonical) else None
        values = None if log is None or canonical is None else log.columns.get(canonical)
        usable = values is not None and bool(np.isfinite(values).any())
        found.append(
            PreviewedColumn(
                name=name,
                canonical=taken,
                unit="" if place is None or taken is None else place.unit,
                stated=place is not None and place.stated,
                factor=1.0 if place is None else place.factor,
                first=tuple(row[index] for row in cells if index < len(row)),
                low=float(np.nanmin(values)) if values is not None and usable else None,
                high=float(np.nanmax(values)) if values is not None and usable else None,
            )
        )
    return tuple(found)


def _is_known(name: str) -> bool:
    from surveyapp.domain.sensor_log import TEXT_COLUMNS

    return name in NUMBER_COLUMNS or name in TEXT_COLUMNS


def _first_cells(file: LogFile) -> list[list[str]]:
    with file.request.path.open("rb") as stream:
        head = stream.read(_HEAD_BYTES)
    lines = decode(head[: head.rfind(b"\n") + 1] or head, where=file.request.where).splitlines()
    first = file.layout.first_row - 1
    rows = csv.reader(lines[first : first + FIRST_ROWS], delimiter=file.layout.separator)
    try:
        return [[cell.strip() for cell in row] for row in rows]
    except csv.Error:  # reading the log says what is wrong with it
        return []


def _unstated(file: LogFile) -> tuple[ResultWarning, ...]:
    """Columns whose unit nobody stated: taken for the canonical one."""
    names = [
        f"{place.name} as {NUMBER_COLUMNS[canonical]}"
        for canonical, place in file.places.items()
        if canonical in NUMBER_COLUMNS and place.name != canonical and not place.stated
    ]
    if not names:
        return ()
    return (
        ResultWarning("unit_assumed", said("no unit is stated: {names}", names=", ".join(names))),
    )


def register_log(
    folder: Path,
    request: LogRequest,
    wish: LogEntryWish,
    *,
    progress: PartDone | None = None,
) -> LogPreview:
    """Take a log into a project: a copy below ``sensors/`` and a ``[[sensor_log]]``.

    A log that lies in the folder stays where it is. The file's hash is pinned: whoever changes
    the log afterwards is told.

    Parameters
    ----------
    folder : Path
    request : LogRequest
    wish : LogEntryWish
    progress : callable, optional

    Raises
    ------
    SurveyError
        With everything that is wrong; nothing is written then.
    """
    preview = preview_log(request, progress=progress)
    problems = [Problem(text, request.where) for text in preview.problems]
    identity = wish.id or request.path.stem
    project = read_project(folder)
    problems += _wish_problems(identity, wish, [entry.id for entry in project.sensor_logs])
    inside = is_inside(folder, str(request.path.absolute()))
    size = request.path.stat().st_size
    if not inside and size > LARGEST_COPY:
        expected = said(
            "{size} MB or less, or a log below the project folder", size=LARGEST_COPY // 1000000
        )
        hint = "move it into sensors/ of the project and add it from there"
        found = f"{size / 1e6:.0f} MB"
        what = "the log is too large to be copied"
        problems.append(Problem(what, request.where, found, expected, hint))
    if problems:
        raise SurveyError(problems)
    with ProjectLock(folder) as lock:
        if not lock.writable:
            what = "the project is closed, or written by somebody else"
            raise SurveyError(Problem(what, str(folder), "", "a project that may be written to"))
        name = _place(folder, request.path, identity, inside=inside)
        append_table(folder / "project.toml", "sensor_log", _table(identity, name, request, wish))
    return replace(preview, written=name)


def _wish_problems(identity: str, wish: LogEntryWish, taken: list[str]) -> list[Problem]:
    problems = []
    if identity in taken:
        names = ", ".join(taken)
        problems.append(
            Problem(
                "a sensor log has this id", "id", identity, said("none of: {names}", names=names)
            )
        )
    if not can_name_file(identity) or "'" in identity:
        expected, hint = "letters, digits, - and _", name_hint(identity)
        problems.append(Problem("this is no id", "id", identity, expected, hint))
    if wish.kind is not None and wish.kind not in SENSOR_KINDS:
        hint = nearest_names(wish.kind, SENSOR_KINDS)
        expected = either(SENSOR_KINDS)
        problems.append(Problem("there is no such kind", "kind", wish.kind, expected, hint))
    if wish.latitude_deg is not None and not -90.0 <= wish.latitude_deg <= 90.0:
        found = f"{wish.latitude_deg:g}"
        problems.append(Problem("this is no latitude", "latitude", found, "-90 to 90 degrees"))
    return problems


def _place(folder: Path, source: Path, identity: str, *, inside: bool) -> str:
    """Where the log stands in the project; copied, unless it lies there already."""
    if inside:
        return source.resolve().relative_to(folder.resolve()).as_posix()
    ending = source.suffix if can_name_file(f"log{source.suffix}") else ""
    target = folder / "sensors" / f"{identity}{ending or '.csv'}"
    name = target.relative_to(folder).as_posix()
    try:
        data = source.read_bytes()
        if target.exists() and target.read_bytes() != data:
            raise SurveyError(
                Problem("another file of this name stands there", name, shown_path(target),
                        "a free name", "id=NAME gives the log another one")
            )  # fmt: skip
        target.parent.mkdir(exist_ok=True)
    except OSError as error:
        what = said("the log cannot be copied ({strerror})", strerror=error.strerror or error)
        raise SurveyError(Problem(what, name, shown_path(source))) from None
    atomic_write(target, data)
    return name


def _table(identity: str, name: str, request: LogRequest, wish: LogEntryWish) -> dict[str, object]:
    """The ``[[sensor_log]]``."""
    return {
        "id": identity,
        "kind": wish.kind,
        "file": name,
        "programme": wish.programme,
        "columns": dict(request.columns) or None,
        "units": dict(request.units) or None,
        "scale": dict(request.scale) or None,
        "rate_hz": request.rate_hz,
        "header_rows": request.header_rows,
        "instrument": wish.instrument,
        "serial": wish.serial,
        "latitude_deg": wish.latitude_deg,
        "calibrated_on": wish.calibrated_on,
        **wish.more,
        "sha256": hashlib.sha256(request.path.read_bytes()).hexdigest(),
    }
