"""A project folder: project.toml and every book that it names, read strictly and as a whole.

All problems of project.toml and of all books come in one error. Tables that other readers
interpret (traverses, penetration, shafts, sensor logs) are passed on as they were parsed. Nothing
is written here, except that a torn last line of a book is moved aside while nobody else writes.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from surveyapp.domain.project import Centring, OrientationSession, Project, ResultWarning
from surveyapp.domain.readings import FieldBook
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.cards import is_path
from surveyapp.io.fieldbook.reading import interpret, move_tail_aside, split_tail
from surveyapp.io.files import decode, read_bytes, shown, shown_path
from surveyapp.io.project_tables import (
    Names,
    read_centring,
    read_instrument,
    read_session,
    read_station,
    unique,
)
from surveyapp.io.tables import Findings, Table, parse_toml
from surveyapp_models.angles import AngleUnit

PROJECT_FILE: Final = "project.toml"
FORMAT: Final = 1
RAW_TABLES: Final = ("traverse", "penetration", "shaft", "sensor_log")
"""Tables that their own readers interpret."""

ANGLE_TYPING: Final = ("separated", "packed")
"""How the screens take a plain number for dms: not at all, or as degrees.MMSS."""

_HEADER = re.compile(r"^[ \t]*\[\[[ \t]*([A-Za-z_-]+)[ \t]*\]\]", re.MULTILINE)


@dataclass(slots=True)
class _Folder:
    """The files of a project, each read once.

    Parameters
    ----------
    path : Path
        The folder.
    findings : Findings
    contents : dict of str to bytes or None
        Every file that is part of the digest by its name as written; None where it is absent.
    """

    path: Path
    findings: Findings
    contents: dict[str, bytes | None] = field(default_factory=dict)

    def read(self, name: str, where: str) -> bytes | None:
        """Bytes of a file, None with a problem noted."""
        if name not in self.contents:
            try:
                self.contents[name] = read_bytes(self.path / name, where=where)
            except SurveyError as error:
                self.findings.absorb(error)
                self.contents[name] = None
        return self.contents[name]

    def digest(self) -> str:
        """sha256 of names, lengths and contents, ordered by name, project.toml first."""
        total = hashlib.sha256()
        for name in sorted(self.contents, key=lambda n: (n != PROJECT_FILE, n)):
            data = self.contents[name]
            size = "absent" if data is None else str(len(data))
            total.update(f"{name}\0{size}\0".encode("utf-8", errors="replace"))
            total.update(data or b"")
        return total.hexdigest()


def read_project(folder: Path, *, repair: bool | None = None) -> Project:
    """Read a project folder.

    Parameters
    ----------
    folder : Path
        Folder that holds project.toml.
    repair : bool or None
        Whether a torn last line of a book is moved aside. By default it is while no other
        program holds the project's lock; the holder of the lock passes True.

    Returns
    -------
    Project
        With stations, instruments, sessions and their books, and a digest: sha256 over
        project.toml and then every file it names (field books without a torn tail, traverse
        books, shaft books, sensor logs that are not pinned by their own sha256, own cards and
        rule books), ordered by the name as written, each as name, NUL, length, NUL, content.

    Raises
    ------
    SurveyError
        With every problem of project.toml and of all its books.
    """
    findings = Findings()
    files = _Folder(folder, findings)
    text = _project_text(files)
    data = parse_toml(text, where=PROJECT_FILE)
    _check_format(data)
    top = Table(data, PROJECT_FILE, findings)
    project = _read_tables(top, files, _header_lines(text), repair)
    findings.raise_if_any()
    return replace(project, digest=files.digest(), warnings=tuple(findings.warnings))


def _project_text(files: _Folder) -> str:
    folder, path = files.path, files.path / PROJECT_FILE
    hint = "surveyapp new DIR makes a project"
    try:
        if not folder.exists():
            what = "the project folder does not exist"
        elif not folder.is_dir():
            what = "this is a file and no project folder"
        elif not path.exists():
            empty = next(folder.iterdir(), None) is None
            what = "the folder is empty" if empty else f"the folder holds no {PROJECT_FILE}"
        else:
            data = read_bytes(path, where=PROJECT_FILE)
            files.contents[PROJECT_FILE] = data
            return decode(data, where=PROJECT_FILE)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        what = f"the project folder cannot be read ({reason})"
    raise SurveyError(Problem(what, shown_path(folder), "", f"a folder with {PROJECT_FILE}", hint))


def _check_format(data: Mapping[str, object]) -> None:
    """Refuse what this version cannot know before anything else is judged."""
    value = data.get("format")
    if isinstance(value, int) and not isinstance(value, bool) and value == FORMAT:
        return
    if value is None:
        problem = Problem("format is missing", PROJECT_FILE, "", f"format = {FORMAT}")
    elif isinstance(value, int) and not isinstance(value, bool) and value > FORMAT:
        problem = Problem(
            "the project was written by a newer version of this program",
            PROJECT_FILE,
            f"format = {shown(value)}",
            f"format = {FORMAT}",
            "update surveyapp to read it",
        )
    else:
        problem = Problem("format is not known", PROJECT_FILE, shown(value), f"format = {FORMAT}")
    raise SurveyError(problem)


def _header_lines(text: str) -> dict[str, list[int]]:
    """Line of every [[table]] header, for messages."""
    lines: dict[str, list[int]] = {}
    number, place = 1, 0
    for match in _HEADER.finditer(text):
        number += text.count("\n", place, match.start())
        place = match.start()
        lines.setdefault(match[1], []).append(number)
    return lines


def _read_tables(
    top: Table, files: _Folder, lines: Mapping[str, list[int]], repair: bool | None
) -> Project:
    top.get("format")
    unit = AngleUnit(top.choice("angle_unit", [str(u) for u in AngleUnit]) or AngleUnit.DMS)
    findings = files.findings
    stations = [read_station(t) for t in top.tables("station", lines.get("station", ()))]
    cards = top.tables("instrument", lines.get("instrument", ()))
    instruments = [read_instrument(t, files.path) for t in cards]
    names = Names(
        stations=unique([s.name for s in stations], "station", findings),
        instruments=unique([i.id for i in instruments], "instrument", findings),
        known_constants=frozenset(str(t.get("id")) for t in cards if "constant" in t),
        unit=unit,
    )
    sessions = _read_sessions(top, files, names, (lines.get("orientation", ()), repair))
    for instrument, table in zip(instruments, cards, strict=True):
        names.check_choice(table, instrument.constant_choice, instrument.id)
        if instrument.card.id and is_path(str(table.get("card"))):
            files.read(str(table.get("card")), table.where)
    rule_book = top.text("rule_book")
    if rule_book is not None and is_path(rule_book):
        files.read(rule_book, f"{PROJECT_FILE}, rule_book")
    tables: dict[str, object] = {k: top.get(k) for k in RAW_TABLES if k in top}
    typing = top.choice("angle_typing", ANGLE_TYPING)
    if typing is not None:
        tables["angle_typing"] = typing
    _read_other_files(top, files, lines)
    project = Project(
        name=top.text("name") or files.path.resolve().name,
        stations=tuple(stations),
        instruments=tuple(instruments),
        sessions=tuple(sessions),
        crs=top.text("crs", multiline=True),
        angle_unit=unit,
        rule_book=rule_book,
        centring=read_centring(top) or Centring(),
        path=str(files.path),
        tables=tables,
    )
    top.get("note")
    tables.update({key: top.data[key] for key in top.unread()})
    top.warn_unknown(*RAW_TABLES)
    return project


def _read_sessions(
    top: Table, files: _Folder, names: Names, options: tuple[Sequence[int], bool | None]
) -> list[OrientationSession]:
    """Sessions with their books."""
    lines, repair = options
    sessions = []
    for table in top.tables("orientation", lines):
        session = read_session(table, names)
        book = _session_book(table, session.book_path, files, (names.unit, repair))
        names.check_targets(table, book, session.book_path)
        sessions.append(replace(session, book=book))
    unique([s.id for s in sessions], "orientation", files.findings)
    _warn_shared_books([s.book_path for s in sessions], files.findings)
    return sessions


def _session_book(
    table: Table, name: str, files: _Folder, options: tuple[AngleUnit, bool | None]
) -> FieldBook:
    """Book of a session; problems are noted, an unreadable one is empty."""
    empty = FieldBook((), ())
    unit, repair = options
    findings = files.findings
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
    for column in odd:
        text = f"{name}: the column {shown(column)} is not known and was not used"
        findings.warnings.append(ResultWarning("unknown_column", text))
    if not book.rows:
        text = f"{name}: the book of {table.where} has no reading yet"
        findings.warnings.append(ResultWarning("empty_book", text))
    if not tail:
        return book
    moved = _repair(files.path, name, (len(data), tail), repair)
    text = f"{name}: the last line has no newline and does not count: {shown(_torn(tail))}" + (
        f"; it was moved to {name}.torn" if moved else ""
    )
    findings.warnings.append(ResultWarning("torn_tail", text))
    return replace(book, torn_tail=_torn(tail))


def _torn(tail: bytes) -> str:
    return tail.decode("utf-8", errors="replace")


def _repair(folder: Path, name: str, torn: tuple[int, bytes], repair: bool | None) -> bool:
    if repair is False:
        return False
    size, tail = torn
    if repair:
        return move_tail_aside(folder / name, size=size, tail=tail)
    from surveyapp.io.filing.lock import ProjectLock

    with ProjectLock(folder) as lock:
        return lock.writable and move_tail_aside(folder / name, size=size, tail=tail)


def inside(name: str, table: Table) -> bool:
    """Whether a path stays in the project folder; notes a problem where it does not."""
    path = os.path.normpath(name.replace("\\", "/"))
    if Path(path).is_absolute() or path == ".." or path.startswith("../"):
        table.problem(
            "the book lies outside of the project folder",
            name,
            "a path below the project folder",
            "copy it into observations/",
        )
        return False
    return True


def _read_other_files(top: Table, files: _Folder, lines: Mapping[str, list[int]]) -> None:
    """Take the files of other tables into the digest."""
    for kind, key in (("traverse", "book"), ("shaft", "book"), ("sensor_log", "file")):
        for table in top.tables(kind, lines.get(kind, ())):
            name = table.text(key)
            if name is None:
                continue
            if key == "book":
                if inside(name, table):
                    files.read(name, table.where)
            elif "sha256" not in table:
                _read_log(name, table, files)


def _read_log(name: str, table: Table, files: _Folder) -> None:
    """Digest of a sensor log that nobody pinned; a missing one is a warning here."""
    digest = hashlib.sha256()
    try:
        path = files.path / name
        if not path.is_file():
            raise FileNotFoundError(name)
        with path.open("rb") as stream:
            while block := stream.read(1 << 20):
                digest.update(block)
    except (OSError, ValueError):
        files.contents[name] = None
        text = f"{table.where}: the file {shown(name)} cannot be read"
        files.findings.warnings.append(ResultWarning("missing_file", text))
        return
    files.contents[name] = digest.digest()


def _warn_shared_books(paths: list[str], findings: Findings) -> None:
    for path in sorted({p for p in paths if p and paths.count(p) > 1}):
        text = f"{PROJECT_FILE}: several sessions name the book {path}: it counts for each of them"
        findings.warnings.append(ResultWarning("shared_book", text))
