"""Runs of guided programmes on the disk: one file a run, one appended line an entry.

An entry exists when its newline is on the disk. Nothing that was written is ever changed: a wrong
reading is struck by a later line, and the next of its step takes its place.
"""

from __future__ import annotations

import csv
import io
from datetime import datetime
from pathlib import Path
from typing import Final

from surveyapp.domain.programme import BEGIN, ProgrammeEntry, ProgrammeRun
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.fieldbook.appending import append_line
from surveyapp.io.fieldbook.reading import move_tail_aside, split_tail
from surveyapp.io.files import has_control, read_bytes, shown
from surveyapp.io.guarded import checked_inside
from surveyapp.languages import said

FOLDER: Final = "sensors"
ENDING: Final = ".programme.csv"
COLUMNS: Final = ("seq", "time", "step", "value", "note")


def run_path(folder: Path, identity: str) -> Path:
    """File of a run."""
    return checked_inside(folder, f"{FOLDER}/{identity}{ENDING}", where=identity)


def read_runs(folder: Path) -> tuple[tuple[ProgrammeRun, ...], tuple[Problem, ...]]:
    """Every run of a project, and what is wrong with those that cannot be read."""
    runs: list[ProgrammeRun] = []
    problems: list[Problem] = []
    for path in sorted((folder / FOLDER).glob(f"*{ENDING}")):
        try:
            runs.append(read_run(folder, path.name.removesuffix(ENDING)))
        except SurveyError as error:
            problems += error.problems
    return tuple(runs), tuple(problems)


def read_run(folder: Path, identity: str) -> ProgrammeRun:
    """One run; a torn last line is left alone and not counted.

    Raises
    ------
    SurveyError
        With everything that is wrong.
    """
    path = run_path(folder, identity)
    where = f"{FOLDER}/{identity}{ENDING}"
    if not path.is_file():
        raise SurveyError(Problem("there is no such run of a programme", where, identity))
    text, _ = split_tail(read_bytes(path, where=where), where=where)
    try:
        lines = list(csv.reader(io.StringIO(text)))
    except csv.Error as error:
        raise SurveyError(Problem(said("no CSV ({error})", error=error), where)) from None
    if not lines or tuple(lines[0]) != COLUMNS:
        found = ",".join(lines[0]) if lines else ""
        raise SurveyError(Problem("the header is another", where, found, ",".join(COLUMNS)))
    problems: list[Problem] = []
    entries = []
    for number, cells in enumerate(lines[1:], start=2):
        entry = _entry(cells, said("{where}, line {number}", where=where, number=number), problems)
        if entry is not None:
            entries.append(entry)
    if not problems and (not entries or entries[0].step != BEGIN):
        problems.append(Problem("the run does not begin with its programme", where, "", BEGIN))
    if problems:
        raise SurveyError(problems)
    return ProgrammeRun(identity, entries[0].value, tuple(entries), where)


def _entry(cells: list[str], where: str, problems: list[Problem]) -> ProgrammeEntry | None:
    if len(cells) != len(COLUMNS):
        found, expected = said("{size} cells", size=len(cells)), f"{len(COLUMNS)}"
        problems.append(Problem("the line has another number of cells", where, found, expected))
        return None
    seq, time, step, value, note = cells
    try:
        moment = datetime.fromisoformat(time)
    except ValueError:
        moment = None
    if moment is None or moment.tzinfo is None:
        problems.append(Problem("this is no time", where, shown(time), "ISO 8601 with its offset"))
        return None
    if not seq.isdigit():
        problems.append(Problem("seq is no whole number", where, shown(seq), "1, 2, 3 ..."))
        return None
    return ProgrammeEntry(int(seq), moment, step, value, note)


def append_entry(
    folder: Path, identity: str, *, step: str, value: str, note: str, moment: datetime
) -> ProgrammeRun:
    """Append one entry; it is on the disk when this returns. The caller holds the lock.

    Returns
    -------
    ProgrammeRun
        As it stands now.

    Raises
    ------
    SurveyError
        If the text is not one line, or the system refuses; the earlier entries stand.
    """
    for name, text in (("value", value), ("note", note)):
        if has_control(text) or "\n" in text or "\r" in text:
            raise SurveyError(
                Problem(said("{name} is not one line of text", name=name), identity, shown(text))
            )
    path = run_path(folder, identity)
    where = f"{FOLDER}/{identity}{ENDING}"
    seq, head = 1, ",".join(COLUMNS) + "\n"
    if path.exists():
        data = read_bytes(path, where=where)
        text, tail = split_tail(data, where=where)
        if tail and not move_tail_aside(path, size=len(data), tail=tail):
            raise SurveyError(Problem("the torn last line cannot be moved aside", where))
        if text.strip():
            head = ""
            seq = max((entry.seq for entry in read_run(folder, identity).entries), default=0) + 1
    buffer = io.StringIO()
    cells = (seq, moment.isoformat(timespec="milliseconds"), step, value, note)
    csv.writer(buffer, lineterminator="\n").writerow(cells)
    append_line(path, (head + buffer.getvalue()).encode("utf-8"))
    return read_run(folder, identity)
