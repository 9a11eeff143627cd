"""``calibrate edm``: a table of distances between pillars, and the heights of the pillars."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from pathlib import Path
from typing import Final

from surveyapp.core.sensors.edm_baseline import calibrate_edm
from surveyapp.domain.calibration import Calibration
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import read_inside, read_text
from surveyapp.io.sensor_logs.reading import LogFile, Need, open_log
from surveyapp.languages import said
from surveyapp.workflows.calibrating.request import CalibrationRequest

NEED: Final = Need(
    columns=("slope_distance_m",),
    varying=("slope_distance_m",),
    optional=(
        "from_pillar",
        "to_pillar",
        "height_of_instrument_m",
        "height_of_target_m",
        "from_height_m",
        "to_height_m",
        "temperature_c",
        "pressure_hpa",
        "humidity_percent",
    ),
    timed="no",
)
ALIASES: Final = {
    "slope_distance_m": "slope_distance",
    "height_of_instrument_m": "height_of_instrument",
    "height_of_target_m": "height_of_target",
    "temperature_c": "temperature",
    "pressure_hpa": "pressure",
    "humidity_percent": "humidity",
}
"""Headings of baseline records without their unit, as common programs write them."""
PILLAR: Final = ("pillar", "pillar_name", "name")
HEIGHT: Final = ("height_m", "pillar_rl", "height")
LONGEST_UNIT_M: Final = 100.0


def calibrate(request: CalibrationRequest) -> Calibration:
    """Calibrate a distance meter from its readings on a baseline."""
    unit = request.number("unit_length_m")
    problems = []
    if unit is not None and not 0.1 <= unit <= LONGEST_UNIT_M:
        expected = said("0.1 to {longest_unit_m:g} m", longest_unit_m=LONGEST_UNIT_M)
        problems.append(Problem("this is no unit length", "unit_length_m", f"{unit:g}", expected))
    heights = None
    file = _named(request.file)
    missing = [name for name in ("from_pillar", "to_pillar") if not file.has(name)]
    problems += [
        Problem(
            said("the column {name} is missing", name=name),
            file.request.where,
            ", ".join(file.layout.names),
            name,
            said("`columns` {name}=COLUMN names it", name=name),
        )
        for name in missing
    ]
    try:
        heights = _heights(request)
        log = replace(request, file=file).read(NEED)
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems:
        raise SurveyError(problems)
    return calibrate_edm(log, heights=heights, unit_length_m=unit)


def _named(file: LogFile) -> LogFile:
    """The file with headings that have no unit taken for the canonical ones."""
    names = file.layout.names
    more = {
        canonical: column
        for canonical, column in ALIASES.items()
        if not file.has(canonical) and list(names).count(column) == 1
    }
    if not more:
        return file
    return open_log(replace(file.request, columns={**more, **file.request.columns}))


def _heights(request: CalibrationRequest) -> dict[str, float] | None:
    """Heights of the pillars by their name [m]; None where no table was given.

    Raises
    ------
    SurveyError
    """
    name = request.option("heights")
    if name is None:
        return None
    where = str(name)
    if request.options.get("heights") is None and request.folder is not None:
        text = read_inside(request.folder, where, where=where).decode("utf-8-sig", "replace")
    else:
        text = read_text(Path(where), where=where)
    rows = list(csv.DictReader(text.lstrip("\ufeff").splitlines()))
    names = list(rows[0]) if rows else []
    pillar = next((n for n in PILLAR if n in names), None)
    height = next((n for n in HEIGHT if n in names), None)
    if pillar is None or height is None:
        found = ", ".join(str(n) for n in names)
        raise SurveyError(
            Problem("this is no table of heights", where, found, "columns pillar and height_m")
        )
    found_heights: dict[str, float] = {}
    problems = []
    for number, row in enumerate(rows, start=2):
        key, value = (row[pillar] or "").strip(), _number(row[height])
        place = said("{where}, line {number}", where=where, number=number)
        if value is None:
            problems.append(Problem("this is no height", place, str(row[height]), "metres"))
        elif found_heights.get(key, value) != value:
            problems.append(Problem("a pillar has two heights", place, key, "one height"))
        else:
            found_heights[key] = value
    if problems:
        raise SurveyError(problems)
    return found_heights


def _number(text: str | None) -> float | None:
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if math.isfinite(value) else None
