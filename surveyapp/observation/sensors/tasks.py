"""What a task finds in a log: a task is the command of the same name, its result as blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, cast

from surveyapp import api
from surveyapp.domain.advance import PartDone
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.chart import Picture
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp.observation.sensors.options import ToldOptions, told_options
from surveyapp.report.blocks import Block


class CancelledError(Exception):
    """The surveyor does not want the result any more."""


@dataclass(frozen=True, slots=True)
class Examined:
    """What a task found in a log.

    Parameters
    ----------
    task : str
    blocks : tuple of Block
        What the record prints too.
    pictures : tuple of Picture
    met : bool
        False where something is not determined or inconsistent.
    calibration : Calibration or None
        Of ``calibrate``: what a card is written from.
    adoptable : tuple of str
        Effects that a diagnosis has named.
    options : str
        The line under which this was found.
    card : str
        Path of a card that was written already; empty where none was.
    """

    task: str
    blocks: tuple[Block, ...]
    pictures: tuple[Picture, ...] = ()
    met: bool = True
    calibration: Calibration | None = None
    adoptable: tuple[str, ...] = ()
    options: str = ""
    card: str = ""


def examine(
    folder: str, entry: SensorLogEntry, task: str, options: str, *, progress: PartDone | None = None
) -> Examined:
    """Run a task on a log of a project.

    Parameters
    ----------
    folder : str
        Of the project.
    entry : SensorLogEntry
    task : str
        calibrate, allan, filter, spectrum, motion, north, plan or diagnose.
    options : str
        One line.
    progress : callable, optional
        Called with the share that was read; whoever raises in it ends the task.

    Raises
    ------
    SurveyError
        As the command of the same name.
    """
    told = told_options(task, options)
    return replace(TASKS[task](folder, entry, told, progress), options=options)


def first_task(entry: SensorLogEntry) -> str:
    """What the record makes of a log, too: north or motion where the entry says so."""
    from surveyapp.workflows.motion import PROGRAMME

    if entry.options.get("method"):
        return "north"
    return "motion" if entry.programme == PROGRAMME else "calibrate"


def _calibrate(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.sections.sensors import calibration_body

    own = dict(told.own)
    kind = str(own.pop("kind", None) or entry.kind or "")
    if not kind:
        expected = "kind=compass, tilt, rate or fog-station"
        raise SurveyError(
            Problem("of which kind is this log?", f"[[sensor_log]] {entry.id}", "", expected)
        )
    result = api.calibrate(
        kind, folder, sensor=entry.id, log=told.log, options=own, progress=progress
    )
    pictures = api.sensor_pictures(result, folder, sensor=entry.id, log=told.log)
    return Examined("calibrate", calibration_body(result), pictures.pictures, result.met, result)


def _allan(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.blocks import without_figures
    from surveyapp.report.sections.sensors import allan_blocks

    own = cast("dict[str, Any]", dict(told.own))
    result = api.allan(folder, sensor=entry.id, log=told.log, progress=progress, **own)
    blocks = without_figures(allan_blocks(entry.id, result))
    return Examined("allan", blocks, api.sensor_pictures(result).pictures)


def _filter(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.sections.sensor_results import filter_blocks

    own = cast("dict[str, Any]", dict(told.own))
    name = str(own.pop("filter", "kalman"))
    if "seed" in own:
        own["seed"] = int(own["seed"])
    result = api.filter_log(
        folder, name=name, sensor=entry.id, log=told.log, progress=progress, **own
    )
    return Examined("filter", filter_blocks(result), api.sensor_pictures(result).pictures)


def _spectrum(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.sections.sensor_results import spectrum_blocks

    own = cast("dict[str, Any]", dict(told.own))
    column = own.pop("column", None) or _only_column(folder, entry, told)
    sensitivity = own.pop("sensitivity", None)
    result = api.spectrum(
        folder,
        str(column),
        sensor=entry.id,
        log=told.log,
        sensitivity_deg_h_t=sensitivity,
        progress=progress,
        **own,
    )
    return Examined("spectrum", spectrum_blocks(result), api.sensor_pictures(result).pictures)


def _only_column(folder: str, entry: SensorLogEntry, told: ToldOptions) -> str:
    """The sensor's column where there is one only.

    Raises
    ------
    SurveyError
        Where there are several.
    """
    from surveyapp.domain.sensor_log import SENSOR_COLUMNS

    file = api.open_sensor_log(folder, sensor=entry.id, log=told.log).file
    found = [name for name in SENSOR_COLUMNS if file.has(name)]
    if len(found) == 1:
        return found[0]
    expected = said("column={found}", found=found[0]) if found else "column=NAME"
    raise SurveyError(Problem("which column?", "options", ", ".join(found), expected))


def _motion(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.sections.sensor_results import motion_blocks

    own = dict(told.own)
    for name, given in (("begin", "from"), ("end", "to")):
        if given in own:
            own[name] = own.pop(given)
    result = api.motion(folder, sensor=entry.id, log=told.log, options=own, progress=progress)
    pictures = api.sensor_pictures(result).pictures
    return Examined("motion", motion_blocks(result), pictures, result.met)


def _north(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.sections.sensor_results import north_blocks

    own = dict(told.own)
    method = own.pop("method", None)
    result = api.north(
        folder,
        method=None if method is None else str(method),
        sensor=entry.id,
        log=told.log,
        options=own,
        progress=progress,
    )
    pictures = api.sensor_pictures(result).pictures
    return Examined("north", north_blocks(result), pictures, result.met)


def _plan(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.sections.sensor_results import plan_blocks

    own = cast("dict[str, Any]", dict(told.own))
    latitude = own.pop("latitude", entry.latitude_deg)
    plan = api.plan_north_stops(latitude_deg=latitude, **own)
    return Examined("plan", plan_blocks(plan), api.sensor_pictures(plan).pictures)


def _diagnose(
    folder: str, entry: SensorLogEntry, told: ToldOptions, progress: PartDone | None
) -> Examined:
    from surveyapp.report.sections.sensor_results import diagnosis_blocks

    found = (
        api.diagnose_sensor(folder, entry.id)
        if entry.kind in ("rate", "fog-station")
        else api.diagnose_log(folder, sensor=entry.id, log=told.log, progress=progress)
    )
    document = found.to_dict()
    adopted = tuple(str(item["effect"]) for item in document["adopted"])
    return Examined("diagnose", diagnosis_blocks(document, found.words), adoptable=adopted)


def adopt_effects(folder: str, entry: SensorLogEntry) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Diagnose a log again and write what is named into its entry.

    Returns
    -------
    written, refused : tuple of str
        Places in project.toml, and why others were not written.

    Raises
    ------
    SurveyError
        If the project may not be written to.
    """
    if entry.kind in ("rate", "fog-station"):
        document = api.diagnose_sensor(folder, entry.id, adopt=True).to_dict()
    else:
        document = api.diagnose_log(folder, sensor=entry.id, adopt=True, keep=True).to_dict()
    refused = tuple(f"{item['effect']}: {item['reason']}" for item in document["not_written"])
    return tuple(document["written"]), refused


TASKS: Final[
    Mapping[str, Callable[[str, SensorLogEntry, ToldOptions, PartDone | None], Examined]]
] = {
    "calibrate": _calibrate,
    "allan": _allan,
    "filter": _filter,
    "spectrum": _spectrum,
    "motion": _motion,
    "north": _north,
    "plan": _plan,
    "diagnose": _diagnose,
}
