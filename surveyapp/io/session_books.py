"""The sessions of a project with their field books; a torn last line is moved aside and told."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import FieldBook
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError
from surveyapp.io.fieldbook.reading import interpret, move_tail_aside, split_tail
from surveyapp.io.files import shown
from surveyapp.io.findings import Findings
from surveyapp.io.guarded import place_inside
from surveyapp.io.project_files import PROJECT_FILE, ProjectFiles, inside
from surveyapp.io.project_tables import Names, read_session, unique
from surveyapp.io.tables import Table
from surveyapp.languages import said
from surveyapp_models.angles import AngleUnit


def read_sessions(
    tables: Sequence[Table], files: ProjectFiles, names: Names, *, repair: bool | None
) -> list[OrientationSession]:
    """Every [[orientation]] with its book; problems are noted in the findings.

    Parameters
    ----------
    tables : sequence of Table
    files : ProjectFiles
    names : Names
        Stations and instruments that they may name.
    repair : bool or None
        Whether a torn last line is moved aside; None: while nobody else writes.
    """
    sessions = []
    for table in tables:
        session = read_session(table, names)
        book = _session_book(table, session, files, (names.unit, repair))
        names.check_targets(table, book, session.book_path)
        sessions.append(replace(session, book=book))
    unique([s.id for s in sessions], "orientation", files.findings)
    _warn_shared_books([s.book_path for s in sessions], files.findings)
    return sessions


def _session_book(
    table: Table,
    session: OrientationSession,
    files: ProjectFiles,
    options: tuple[AngleUnit, bool | None],
) -> FieldBook:
    """Book of a session; problems are noted, an unreadable one is empty."""
    empty = FieldBook((), ())
    unit, repair = options
    findings, name = files.findings, session.book_path
    if not name or not inside(name, table):
        return empty
    data = files.read(name, table.where)
    if data is None:
        return empty
    try:
        text, tail = split_tail(data, where=name)
        files.contents[name] = data[: len(data) - len(tail)]
        book, odd = interpret(text, angle_unit=unit, where=name)
    except SurveyError as error:
        findings.absorb(error)
        return empty
    subject = Subject.session(session.id)
    for column in odd:
        text = said(
            "{name}: the column {column} is not known and was not used",
            name=name,
            column=shown(column),
        )
        findings.warnings.append(ResultWarning("unknown_column", text, subject))
    if not book.rows:
        text = said("{name}: the book of {where} has no reading yet", name=name, where=table.where)
        findings.warnings.append(ResultWarning("empty_book", text, subject))
    if not tail:
        return book
    moved = _repair(files.path, name, (len(data), tail), repair)
    text = said(
        "{name}: the last line has no newline and does not count: {shown}",
        name=name,
        shown=shown(_torn(tail)),
    ) + (said("; it was moved to {name}.torn", name=name) if moved else "")
    findings.warnings.append(ResultWarning("torn_tail", text, subject))
    return replace(book, torn_tail=_torn(tail))


def _torn(tail: bytes) -> str:
    return tail.decode("utf-8", errors="replace")


def _repair(folder: Path, name: str, torn: tuple[int, bytes], repair: bool | None) -> bool:
    if repair is False:
        return False
    size, tail = torn
    path = place_inside(folder, name)
    if path is None:
        return False
    if repair:
        return move_tail_aside(path, size=size, tail=tail)
    from surveyapp.io.filing.lock import ProjectLock

    with ProjectLock(folder) as lock:
        return lock.writable and move_tail_aside(path, size=size, tail=tail)


def _warn_shared_books(paths: list[str], findings: Findings) -> None:
    for path in sorted(p for p, count in Counter(paths).items() if p and count > 1):
        text = said(
            "{project_file}: several sessions name the book {path}: it counts for each of them",
            project_file=PROJECT_FILE,
            path=path,
        )
        findings.warnings.append(ResultWarning("shared_book", text))
