"""Where one begins: recent projects, samples, and what a new project or session consists of.

Everything a form writes stands in project.toml; editing that by hand is as good.
"""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from surveyapp import api
from surveyapp.domain.project import Method, Purpose
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.decimals import typed_number, typed_words
from surveyapp.io.filing.dependencies import project_data, rows_of
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.guarded import can_name_file
from surveyapp.io.settings import Settings, read_settings, write_settings
from surveyapp.languages import said
from surveyapp.observation.owner_entries import OwnerEntries
from surveyapp.observation.station_lines import NewStation

OBSERVATIONS: Final = "observations"
LONGEST_ID: Final = 80
"""Bytes of a session's id, which names its field book."""
MOST_GRIDS: Final = 30
"""More are no choice: a further word of the name is."""


@dataclass(frozen=True, slots=True)
class GridChoice:
    """A grid that may be meant: its EPSG code and name."""

    code: str
    name: str


@dataclass(frozen=True, slots=True)
class NewProject:
    """What the form for a new project asks for.

    Parameters
    ----------
    folder, name : str
    crs : str
        EPSG code, PROJ string or WKT; empty for none.
    mine_grid : str
        Rotation, origin and its place in the crs, in one line; empty for none.
    angle_unit : str
        dms | gon | deg.
    angle_typing : str
        separated | packed.
    rule_book : str
        Id of an installed rule book; empty for none.
    stations : tuple of NewStation
    instruments : tuple of (str, str, str)
        Id, card and serial number.
    constant : str
        Known instrument constant of the first of them and its sigma, two numbers in arc-seconds;
        empty where calibration sessions are to tell it.
    owner : OwnerEntries
        What the owner has determined of the first of them.
    """

    folder: str
    name: str
    crs: str = ""
    mine_grid: str = ""
    angle_unit: str = "dms"
    angle_typing: str = "separated"
    rule_book: str = ""
    stations: tuple[NewStation, ...] = ()
    instruments: tuple[tuple[str, str, str], ...] = ()
    constant: str = ""
    owner: OwnerEntries = field(default_factory=OwnerEntries)


@dataclass(frozen=True, slots=True)
class NewSession:
    """What the form for a new session asks for; ``azimuth_known`` as text in the project's unit."""

    id: str
    station: str
    target: str
    instrument: str
    method: Method
    purpose: Purpose
    azimuth_known: str = ""
    wanted_interval_arcsec: float | None = None


def recent_projects() -> tuple[str, ...]:
    """Project folders opened lately that still exist."""
    return tuple(
        folder for folder in read_settings().recent if (Path(folder) / "project.toml").is_file()
    )


def remember(folder: str) -> Settings:
    """Put a project at the top of the recent ones."""
    settings = read_settings().with_recent(str(Path(folder).resolve()))
    write_settings(settings)
    return settings


def samples() -> tuple[str, ...]:
    """Names of the measured samples."""
    from surveyapp.io.locations import sample_names

    return sample_names()


def sample_copy(name: str) -> str:
    """Folder of the user's own copy of a sample; made where it does not exist yet."""
    from surveyapp.io.locations import copy_sample, user_documents_folder

    folder = user_documents_folder()
    path = folder / name
    return str(path if path.is_dir() else copy_sample(name, folder))


def rule_books() -> tuple[str, ...]:
    """Ids of the installed rule books."""
    from surveyapp.io.rulebooks import installed_rule_book_ids

    return installed_rule_book_ids()


def find_grids(text: str, stations: tuple[NewStation, ...] = ()) -> tuple[GridChoice, ...]:
    """Grids whose name or EPSG code holds the text, where the stations lie if that is known.

    Without latitude and longitude it is their east and north that must lie where the grid is made
    for. At most ``MOST_GRIDS`` are returned.
    """
    from surveyapp.core.geodesy import find_projected

    place = next(
        ((s.lat, s.lon) for s in stations if s.lat is not None and s.lon is not None), None
    )
    metres = next(((s.e, s.n) for s in stations if s.e is not None and s.n is not None), None)
    found = find_projected(
        text, place, coordinates=metres if place is None else None, limit=MOST_GRIDS
    )
    return tuple(GridChoice(code, name) for code, name in found)


def create_project(form: NewProject) -> str:
    """Make the project folder that a form describes, and return it.

    Raises
    ------
    SurveyError
        If the folder holds anything already, if the grid is none, or if a name stands twice.
    """
    from surveyapp.io.template import need_own_folder
    from surveyapp.io.tomltext import replace_held

    target = Path(form.folder).expanduser().absolute()
    part = target.with_name(f".{target.name}.part")
    try:
        need_own_folder(target)
        if part.is_dir() and not part.is_symlink():
            shutil.rmtree(part)  # of a program that ended before all of it was written
        _make_project(part, form)
        if target.exists():
            shutil.rmtree(target)  # holds nothing, or what a killed ``new`` has left
        replace_held(part, target)
    except OSError as error:
        what = said("the folder cannot be made ({strerror})", strerror=error.strerror or error)
        raise SurveyError(Problem(what, str(target))) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return str(target)


def _make_project(target: Path, form: NewProject) -> None:
    """Everything that a form says, in a folder that is nobody's project yet."""
    from surveyapp.io.writing import append_tables, set_value

    constant = _constant(form.constant)
    owner = form.owner.overrides()
    folder = api.new_project(
        target,
        name=form.name,
        crs=f"EPSG:{form.crs}" if form.crs.isdecimal() else form.crs or None,
        angle_unit=form.angle_unit,
        mine_grid=form.mine_grid or None,
    )
    path = folder / "project.toml"
    if form.angle_typing != "separated":
        set_value(path, ("angle_typing",), form.angle_typing)
    if form.rule_book:
        set_value(path, ("rule_book",), form.rule_book)
    tables: list[tuple[str, dict[str, object]]] = []
    for number, (identity, card, serial) in enumerate(form.instruments):
        table = {"id": identity, "card": card, "serial": serial or None}
        first = {"constant": constant, **owner} if number == 0 else {}
        tables.append(("instrument", {**table, **first}))
    keys = ("name", "e", "n", "lat", "lon", "h")
    tables += [("station", {key: getattr(item, key) for key in keys}) for item in form.stations]
    append_tables(path, tables)
    api.open_project(folder)


def _constant(text: str) -> dict[str, float] | None:
    if not text.strip():
        return None
    try:
        value, sigma = (typed_number(part) for part in typed_words(text.replace("±", " ")))
    except ValueError:
        raise SurveyError(
            Problem(
                said("this is no instrument constant"),
                "constant",
                text,
                said("constant and sigma in arc-seconds, like -9.7 3.0"),
            )
        ) from None
    return {"arcsec": value, "sigma_arcsec": sigma}


def create_session(folder: api.Folder, form: NewSession) -> None:
    """Add a session to a project, with an empty book.

    Raises
    ------
    SurveyError
        If the project is open elsewhere, or if the session could not stand in it: project.toml is
        as it was then.
    """
    from surveyapp.io.files import read_text
    from surveyapp.io.tomltext import atomic_write
    from surveyapp.io.writing import append_table

    path = Path(folder) / "project.toml"
    book = _book_name(form.id)
    with ProjectLock(Path(folder)) as lock:
        if not lock.writable:
            what = said("this project cannot be written to now")
            raise SurveyError(Problem(what, str(folder), said("it is open elsewhere")))
        rows = rows_of(project_data(Path(folder)), "orientation")
        if any(form.id == row.get("id") or book == row.get("book") for row in rows):
            raise SurveyError(Problem(said("a session of this id exists already"), "id", form.id))
        _new_book(Path(folder) / book)
        before = read_text(path, where=path.name)
        table = {
            "id": form.id,
            "station": form.station,
            "target": form.target or None,
            "instrument": form.instrument,
            "method": form.method,
            "purpose": form.purpose,
            "azimuth_known": form.azimuth_known or None,
            "wanted_interval_arcsec": form.wanted_interval_arcsec,
            "book": book,
        }
        try:
            append_table(path, "orientation", table)
            api.open_project(folder)
        except SurveyError:
            (Path(folder) / book).unlink()
            if read_text(path, where=path.name) != before:
                atomic_write(path, before.encode("utf-8"))
            raise


def _book_name(identity: str) -> str:
    """Path of the book of a session; the id names a file, so it must be able to."""
    if not can_name_file(identity) or len(identity.encode("utf-8")) > LONGEST_ID:
        raise SurveyError(
            Problem(
                said("this id cannot name a field book"),
                "id",
                identity,
                said(
                    'at most {longest_id} letters or digits, without / \\ : * ? " < > |',
                    longest_id=LONGEST_ID,
                ),
                said("the book is observations/<id>.csv"),
            )
        )
    return f"{OBSERVATIONS}/{identity}.csv"


def _new_book(path: Path) -> None:
    """An empty book with its header; one with anything in it is never touched."""
    from surveyapp.io.fieldbook import COLUMNS
    from surveyapp.io.guarded import is_regular
    from surveyapp.io.tomltext import atomic_write

    header = (",".join(COLUMNS) + "\n").encode("utf-8")
    if is_regular(path) and path.stat().st_size == len(header) and path.read_bytes() == header:
        return  # left by a program that ended before the session stood in project.toml
    if os.path.lexists(path):
        raise SurveyError(
            Problem(
                said("a book of this name exists already"),
                path.name,
                str(path),
                said("a new session id"),
                said("a field book is never overwritten"),
            )
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic_write(path, header)
