"""A guided programme in a project: begun, step by step written down, ended in a log and a card."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Final

from surveyapp.core.sensors.programmes.seen import NEEDED, rows_of_log
from surveyapp.core.sensors.programmes.state import (
    DONE,
    programme_of,
    read_value,
    state_of,
    typed_rows,
)
from surveyapp.domain.programme import (
    BEGIN,
    LOG,
    STRIKE,
    Programme,
    ProgrammeRun,
    ProgrammeState,
    Row,
)
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.guarded import can_name_file, name_hint
from surveyapp.io.programmes import append_entry, read_run, run_path
from surveyapp.io.project import read_project
from surveyapp.io.sensor_logs.reading import LogRequest, Need, read_log
from surveyapp.io.sensor_logs.writing import columns_text, write_columns
from surveyapp.io.tomltext import atomic_write
from surveyapp.io.writing import append_table

_BAD_IN_ID: Final = "'. "


def begin_run(
    folder: Path, programme: str, identity: str, *, moment: datetime, software: str
) -> ProgrammeRun:
    """Begin a run of a programme.

    Raises
    ------
    SurveyError
        If there is no such programme, or a run or a log has this id.
    """
    found = programme_of(programme)
    problems = []
    if not can_name_file(identity) or any(letter in _BAD_IN_ID for letter in identity):
        expected = "letters, digits, - and _"
        problems.append(Problem("this is no id", "id", identity, expected, name_hint(identity)))
    elif run_path(folder, identity).exists():
        problems.append(Problem("a run has this id", "id", identity, "a free id"))
    if identity in {entry.id for entry in read_project(folder).sensor_logs}:
        problems.append(Problem("a sensor log has this id", "id", identity, "a free id"))
    if problems:
        raise SurveyError(problems)
    note = f"{found.standard}; {software}"
    return _append(folder, identity, step=BEGIN, value=found.id, note=note, moment=moment)


def _append(
    folder: Path, identity: str, *, step: str, value: str, note: str, moment: datetime
) -> ProgrammeRun:
    with ProjectLock(folder) as lock:
        if not lock.writable:
            what = "the project is closed, or written by somebody else"
            raise SurveyError(Problem(what, str(folder), "", "a project that may be written to"))
        return append_entry(folder, identity, step=step, value=value, note=note, moment=moment)


def record_entry(
    folder: Path, identity: str, step: str, value: str, *, note: str, moment: datetime
) -> ProgrammeRun:
    """Write down that a step was done, or what was read in it.

    Raises
    ------
    SurveyError
        If the run has no such step, or the reading is none.
    """
    programme = programme_of(read_run(folder, identity).programme)
    found = programme.step(step)
    if found is None or found.kind == "record":
        known = ", ".join(s.id for s in programme.steps if s.kind != "record")
        hint = "" if found is None else "it is found in the log"
        raise SurveyError(Problem("nothing is typed in this step", "step", step, known, hint))
    if found.kind == "read":
        read_value(found, value)
    elif value.strip() not in ("", DONE):
        hint = "leave the reading empty once it is done; a remark is a note"
        raise SurveyError(Problem("this step has no reading", found.title, value, "", hint))
    text = value.strip() or DONE
    return _append(folder, identity, step=step, value=text, note=note, moment=moment)


def strike_entry(folder: Path, identity: str, *, note: str, moment: datetime) -> ProgrammeRun:
    """Strike the latest entry that counts; it stays in the file.

    Raises
    ------
    SurveyError
        If there is none.
    """
    run = read_run(folder, identity)
    live = sorted(run.live.values(), key=lambda entry: entry.seq)
    if not live:
        raise SurveyError(Problem("there is nothing to be struck", run.path))
    seq = str(live[-1].seq)
    return _append(folder, identity, step=STRIKE, value=seq, note=note, moment=moment)


def give_log(
    folder: Path, identity: str, path: str, *, options: str, moment: datetime
) -> ProgrammeRun:
    """Name the log of a run, which may still be growing.

    Parameters
    ----------
    options : str
        How its columns are to be understood, in one line.

    Raises
    ------
    SurveyError
        If the programme is typed, or there is no such file.
    """
    programme = programme_of(read_run(folder, identity).programme)
    if programme.typed:
        raise SurveyError(Problem("the readings of this programme are typed", "log", path))
    if not _log_file(folder, path).is_file():
        raise SurveyError(Problem("the log does not exist", "log", path, "a file"))
    return _append(folder, identity, step=LOG, value=path, note=options, moment=moment)


def _log_file(folder: Path, path: str) -> Path:
    place = Path(path)
    return place if place.is_absolute() else folder / place


def run_state(
    folder: Path, identity: str, *, moment: datetime, request: LogRequest | None = None
) -> ProgrammeState:
    """Where a run stands, its log looked at as far as it is written.

    Parameters
    ----------
    request : LogRequest or None
        How the log is to be read; None = it was not given yet.

    Raises
    ------
    SurveyError
        If run or log cannot be read.
    """
    run = read_run(folder, identity)
    programme = programme_of(run.programme)
    seen: Sequence[Row] = ()
    if request is not None and not programme.typed:
        seen = rows_of_log(programme.id, _read_so_far(request, programme))
    return state_of(programme, run, now=moment, seen=seen)


def _read_so_far(request: LogRequest, programme: Programme) -> SensorLog:
    """The whole lines of a log that may still be written to."""
    columns, optional = NEEDED[programme.id]
    need = Need(columns=columns, optional=optional, biased=programme.id == "multi-position")
    data = request.path.read_bytes()
    if data.endswith(b"\n"):
        return read_log(request, need)
    with tempfile.TemporaryDirectory() as place:
        whole = Path(place) / request.path.name
        whole.write_bytes(data[: data.rfind(b"\n") + 1])
        return read_log(replace(request, path=whole), need)


def write_typed_log(folder: Path, state: ProgrammeState) -> str:
    """The readings of a run as a sensor log of the project, entered once.

    Returns
    -------
    str
        Id of the ``[[sensor_log]]``.

    Raises
    ------
    SurveyError
        If nothing was read, or the project may not be written to.
    """
    run, programme = state.run, state.programme
    rows = typed_rows(programme, run)
    if not rows:
        raise SurveyError(Problem("nothing was read yet", run.path))
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {name: _cells(rows, name) for name in names}
    identity, name = run.id, f"sensors/{run.id}.csv"
    with ProjectLock(folder) as lock:
        if not lock.writable:
            what = "the project is closed, or written by somebody else"
            raise SurveyError(Problem(what, str(folder), "", "a project that may be written to"))
        if identity in {entry.id for entry in read_project(folder).sensor_logs}:
            atomic_write(folder / name, columns_text(columns).encode())  # from the run, as before
        else:
            write_columns(folder / name, columns, inputs=())
            append_table(folder / "project.toml", "sensor_log", _entry(state, name))
    return identity


def _cells(rows: Sequence[Row], name: str) -> list[str]:
    """A column as text; empty where a row has no such value."""
    values = [row.get(name) for row in rows]
    return ["" if v is None else v if isinstance(v, str) else f"{v:.12g}" for v in values]


def _entry(state: ProgrammeState, file: str) -> dict[str, object]:
    programme = state.programme
    return {
        "id": state.run.id,
        "kind": programme.kind,
        "file": file,
        "programme": programme.log_programme,
        "units": dict(programme.units) or None,
        "calibrated_on": state.run.entries[0].time.date(),
        "note": procedure_note(state),
    }


def procedure_note(state: ProgrammeState) -> str:
    """What the record and the card say of how it was done."""
    parts = [f"{state.programme.title}, {state.programme.standard}", *state.warnings]
    return "; ".join(parts)
