"""Logs and cards of a project, and writing the card of a calibration."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Final

from surveyapp import api
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import joined
from surveyapp.observation.sensors.options import told_options
from surveyapp.observation.sensors.tasks import Examined

CARD_FOLDERS: Final = ("sensors", "cards")
CARD_ENDING: Final = ".card.toml"


@dataclass(frozen=True, slots=True)
class CardShown:
    """A sensor card of the project and whether it holds today."""

    path: str
    card: SensorCard | None
    holds: bool
    problem: str = ""


@dataclass(frozen=True, slots=True)
class SensorDesk:
    """Logs and cards of a project, as its folder holds them."""

    logs: tuple[SensorLogEntry, ...]
    cards: tuple[CardShown, ...]


def sensor_desk(folder: str, today: date) -> SensorDesk:
    """Every log and card of a project.

    Raises
    ------
    SurveyError
        If the project cannot be read.
    """
    project = api.open_project(folder)
    return SensorDesk(project.sensor_logs, _cards(Path(folder), today))


def _cards(folder: Path, today: date) -> tuple[CardShown, ...]:
    from surveyapp.io.sensor_cards import read_sensor_card

    found = []
    for name in CARD_FOLDERS:
        for path in sorted((folder / name).glob("*.toml")):
            where = path.relative_to(folder).as_posix()
            try:
                card = read_sensor_card(path, where=where)
            except SurveyError as error:
                found.append(CardShown(where, None, holds=False, problem=error.text))
                continue
            refused = card.refusals(on=today, temperature_c=None, where=where)
            told = joined("; ", (problem.text for problem in refused))
            found.append(CardShown(where, card, holds=not refused, problem=told))
    return tuple(found)


def card_path(sensor: str) -> str:
    """Where the card of a log goes: beside it in the project folder."""
    return f"{CARD_FOLDERS[0]}/{sensor}{CARD_ENDING}"


def save_card(folder: str, entry: SensorLogEntry, found: Examined, path: str) -> str:
    """Write the card of a calibration into the project folder.

    Returns
    -------
    str
        The path as written.

    Raises
    ------
    SurveyError
        If nothing is determined, the project is closed or written by somebody else, or the place
        lies outside the folder or holds another kind of file.
    """
    from surveyapp.io.filing.lock import ProjectLock
    from surveyapp.io.sensor_logs.tables import is_inside

    place = Path(folder) / path
    if not path or not is_inside(Path(folder), path):
        expected = "a file of the project folder"
        raise SurveyError(Problem("the card would lie outside", "card", path, expected))
    if found.calibration is None:
        raise SurveyError(Problem("there is nothing to put on a card", "card", found.task))
    told = told_options("calibrate", found.options)
    own = dict(told.own)
    kind = str(own.pop("kind", None) or entry.kind or "")
    with ProjectLock(Path(folder)) as lock:
        if not lock.writable:
            what = "the project is closed, or written by somebody else"
            raise SurveyError(Problem(what, folder, "", "a project that may be written to"))
        place.parent.mkdir(parents=True, exist_ok=True)
        result = api.calibrate(kind, folder, sensor=entry.id, log=told.log, options=own, card=place)
    if not result.met:
        names = ", ".join(result.geometry.undetermined) or "the result is inconsistent"
        raise SurveyError(Problem("no card is written of this calibration", entry.id, names))
    return path
