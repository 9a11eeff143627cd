"""A project folder: project.toml and everything that it names, read strictly, once, as a whole.

All problems of project.toml and of all books come in one error. Nothing is written here, except
that a torn last line of a book is moved aside while nobody else writes.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from surveyapp.core.network.collector import paused_collection
from surveyapp.domain.closing import Filing
from surveyapp.domain.project import Centring, OrientationSession, Project
from surveyapp.domain.rulebook import RuleBook
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.cards import is_path
from surveyapp.io.files import decode, read_inside, shown, shown_path
from surveyapp.io.filing.journal import unsettled
from surveyapp.io.filing.seals import changed_after_closing, read_filing
from surveyapp.io.findings import Findings
from surveyapp.io.grid_tables import (
    read_mine_grid,
    refuse_two_convergences,
    with_regional_deflection,
)
from surveyapp.io.penetration.table import read_penetration_table
from surveyapp.io.priors import with_priors
from surveyapp.io.project_files import PROJECT_FILE, ProjectFiles
from surveyapp.io.project_tables import (
    Names,
    read_centring,
    read_instrument,
    read_station,
    unique,
)
from surveyapp.io.rulebooks import read_rule_book
from surveyapp.io.sensor_logs.tables import read_sensor_logs
from surveyapp.io.session_books import read_sessions
from surveyapp.io.shafts.table import read_shaft_tables
from surveyapp.io.tables import Table, parse_toml
from surveyapp.io.traverse.book import read_traverses
from surveyapp.languages import said
from surveyapp_models.angles import AngleUnit

FORMAT: Final = 1
ANGLE_TYPING: Final = ("separated", "packed")
"""How the screens take a plain number for dms: not at all, or as degrees.MMSS."""

_HEADER = re.compile(r"^[ \t]*\[\[[ \t]*([A-Za-z_-]+)[ \t]*\]\]", re.MULTILINE)


def read_project(folder: Path, *, repair: bool | None = None, observing: bool = False) -> Project:
    """Read a project folder.

    Parameters
    ----------
    folder : Path
        Folder that holds project.toml.
    repair : bool or None
        Whether a torn last line of a book is moved aside. By default it is while no other
        program holds the project's lock; the holder of the lock passes True.
    observing : bool
        Read it for observing a session: a rule book or a traverse that cannot be used is a warning
        then (``rule_book_unusable``, ``traverse_unusable``) and does not keep a surveyor from the
        instrument.

    Returns
    -------
    Project
        Stations, instruments, sessions and traverses with their books, rule book and closings, and
        a digest: sha256 over project.toml and then every file it names (field books without a torn
        tail, traverse books, shaft books, sensor logs that are not pinned by their own sha256, own
        cards and rule books), ordered by the name as written, each as name, NUL, length, NUL,
        content.

    Raises
    ------
    SurveyError
        With every problem of project.toml and of all its books; in a closed project also with what
        was changed since it was closed.
    """
    if repair is None and unsettled(folder):
        from surveyapp.io.filing.lock import ProjectLock

        ProjectLock(folder, even_closed=True).release()  # whoever takes the lock settles
    try:
        return _read(folder, repair=repair, observing=observing)
    except SurveyError as error:
        raise SurveyError([*changed_after_closing(folder), *error.problems]) from None


@paused_collection()
def _read(folder: Path, *, repair: bool | None, observing: bool) -> Project:
    findings = Findings()
    files = ProjectFiles(folder, findings, observing=observing)
    text = _project_text(files)
    data = parse_toml(text, where=PROJECT_FILE)
    _check_format(data)
    top = _Top(Table(data, PROJECT_FILE, findings), files, _header_lines(text))
    project = _read_tables(top, repair)
    findings.raise_if_any()
    return replace(project, digest=files.digest(), warnings=findings.told())


@dataclass(frozen=True, slots=True)
class _Top:
    """project.toml as parsed, the files beside it, and the lines of its table headers."""

    table: Table
    files: ProjectFiles
    lines: Mapping[str, list[int]]

    def tables(self, kind: str) -> list[Table]:
        """Every [[kind]] table."""
        return self.table.tables(kind, self.lines.get(kind, ()))


def _project_text(files: ProjectFiles) -> str:
    check_project_folder(files.path)
    try:
        data = read_inside(files.path, PROJECT_FILE, where=PROJECT_FILE)
    except (OSError, ValueError) as error:
        raise _no_project(files.path, _unreadable(error)) from None
    files.contents[PROJECT_FILE] = data
    return decode(data, where=PROJECT_FILE)


def check_project_folder(folder: Path) -> None:
    """Refuse what is no folder with a project.toml.

    Raises
    ------
    SurveyError
    """
    try:
        if not folder.exists():
            what = "the project folder does not exist"
        elif not folder.is_dir():
            what = "this is a file and no project folder"
        elif not (folder / PROJECT_FILE).exists():
            empty = next(folder.iterdir(), None) is None
            what = (
                "the folder is empty"
                if empty
                else said("the folder holds no {project_file}", project_file=PROJECT_FILE)
            )
        else:
            return
    except (OSError, ValueError) as error:
        what = _unreadable(error)
    raise _no_project(folder, what)


def _unreadable(error: Exception) -> str:
    reason = getattr(error, "strerror", None) or str(error)
    return f"the project folder cannot be read ({reason})"


def _no_project(folder: Path, what: str) -> SurveyError:
    hint = "surveyapp new DIR makes a project"
    return SurveyError(
        Problem(
            what,
            shown_path(folder),
            "",
            said("a folder with {project_file}", project_file=PROJECT_FILE),
            hint,
        )
    )


def _check_format(data: Mapping[str, object]) -> None:
    """Refuse what this version cannot know before anything else is judged."""
    value = data.get("format")
    if isinstance(value, int) and not isinstance(value, bool) and value == FORMAT:
        return
    if value is None:
        problem = Problem(
            "format is missing", PROJECT_FILE, "", said("format = {format}", format=FORMAT)
        )
    elif isinstance(value, int) and not isinstance(value, bool) and value > FORMAT:
        problem = Problem(
            "the project was written by a newer version of this program",
            PROJECT_FILE,
            said("format = {text}", text=shown(value)),
            said("format = {format}", format=FORMAT),
            "update surveyapp to read it",
        )
    else:
        problem = Problem(
            "format is not known",
            PROJECT_FILE,
            shown(value),
            said("format = {format}", format=FORMAT),
        )
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


def _read_tables(top: _Top, repair: bool | None) -> Project:
    table, files = top.table, top.files
    table.get("format")
    unit = AngleUnit(table.choice("angle_unit", [str(u) for u in AngleUnit]) or AngleUnit.DMS)
    stations = [read_station(t, unit) for t in top.tables("station")]
    cards = top.tables("instrument")
    instruments = [read_instrument(t, files.path) for t in cards]
    names = Names(
        stations=unique([s.name for s in stations], "station", files.findings),
        instruments=unique([i.id for i in instruments], "instrument", files.findings),
        known_constants=frozenset(str(t.get("id")) for t in cards if "constant" in t),
        unit=unit,
    )
    instruments = [
        replace(
            with_priors(instrument, card, files),
            constant_choice=names.read_choice(card, instrument.id),
        )
        for instrument, card in zip(instruments, cards, strict=True)
    ]
    orientations = top.tables("orientation")
    sessions = read_sessions(orientations, files, names, repair=repair)
    for instrument, card in zip(instruments, cards, strict=True):
        if instrument.card.id and is_path(str(card.get("card"))):
            files.read(str(card.get("card")), card.where)
    rule_book, rules = _rules(top)
    traverses = read_traverses(top.tables("traverse"), files, names.stations, unit)
    _read_other_files(top)
    crs = table.text("crs", multiline=True)
    refuse_two_convergences(stations, sessions, files.findings)
    sensor_logs = read_sensor_logs(table, top.lines.get("sensor_log", ()))
    sessions = _with_sensors(sessions, orientations, files, sensor_logs, unit=unit)
    stations, length = with_regional_deflection(table, stations)
    project = Project(
        name=table.text("name") or files.path.resolve().name,
        stations=tuple(stations),
        instruments=tuple(instruments),
        sessions=tuple(sessions),
        traverses=traverses,
        crs=crs,
        grid=read_mine_grid(table, unit, crs),
        deflection_length_m=length,
        station_sigma_m=_station_sigma(table, rules),
        angle_unit=unit,
        angle_typing=table.choice("angle_typing", ANGLE_TYPING) or ANGLE_TYPING[0],
        rule_book=rule_book,
        rules=rules,
        centring=read_centring(table) or Centring(),
        filing=_filing(files),
        path=str(files.path),
        penetration=read_penetration_table(table, instruments, unit),
        shafts=read_shaft_tables(table, files, unit),
        sensor_logs=sensor_logs,
    )
    table.get("note")
    table.warn_unknown()
    return _with_declinations(project, files.findings)


def _with_sensors(
    sessions: list[OrientationSession],
    tables: Sequence[Table],
    files: ProjectFiles,
    logs: Sequence[SensorLogEntry],
    *,
    unit: AngleUnit,
) -> list[OrientationSession]:
    """What level and compass logs say of sessions; few projects have any, and they cost imports."""
    if not any("levelling" in table or "pre_orientation" in table for table in tables):
        return sessions
    from surveyapp.io.session_sensors import with_sensors

    return with_sensors(sessions, tables, files, logs, unit=unit)


def _with_declinations(project: Project, findings: Findings) -> Project:
    if all(session.pre_orientation is None for session in project.sessions):
        return project
    from surveyapp.io.session_sensors import with_declinations

    return with_declinations(project, findings)


def _rules(top: _Top) -> tuple[str | None, RuleBook | None]:
    """Name and content of the rule book."""
    name = top.table.text("rule_book")
    if name is None:
        return None, None
    files, where = top.files, f"{PROJECT_FILE}, rule_book"
    try:
        if is_path(name):
            files.contents[name] = None
            files.contents[name] = read_inside(files.path, name, where=where)
        return name, read_rule_book(name, base=files.path)
    except SurveyError as error:
        if files.observing:
            text = error.problems[0].what
            files.findings.warnings.append(ResultWarning("rule_book_unusable", text))
        else:
            files.findings.absorb(error)
        return name, None


def _station_sigma(table: Table, rules: RuleBook | None) -> float | None:
    """The project's own, else the rule book's [m]."""
    own = table.number("station_sigma_m", low=0.0, high=1e3)
    return own if own is not None or rules is None else rules.station_sigma_m


def _filing(files: ProjectFiles) -> Filing:
    """Closings of the folder; an unreadable ledger is a problem."""
    try:
        return read_filing(files.path)
    except SurveyError as error:
        if not files.observing:
            files.findings.absorb(error)
        return Filing()


def _read_other_files(top: _Top) -> None:
    """Take sensor logs that nobody pinned into the digest."""
    for table in top.tables("sensor_log"):
        name = table.text("file")
        if name is not None and "sha256" not in table:
            top.files.read_log(name, table)
