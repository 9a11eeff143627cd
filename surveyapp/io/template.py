"""A new project: a commented project.toml that a surveyor fills in, and an empty observations/."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import has_control, shown, shown_path
from surveyapp.io.guarded import is_regular, need_short_path
from surveyapp.io.tomltext import atomic_write, toml_value
from surveyapp.languages import said
from surveyapp_models.angles import AngleUnit

ROOM: Final = 60
"""Letters of ``observations/`` and a usual name of a book with its temporary file."""
_EXAMPLES: Final = {
    AngleUnit.DMS: "246-52-09",
    AngleUnit.GON: "274.2991",
    AngleUnit.DEG: "246.8692",
}

_TEMPLATE: Final = """\
# A survey project. Take the leading # off what you need; everything else may stay away.
format = 1
name = {name}
{crs}
angle_unit = {angle_unit}    # dms | gon | deg: how angles are written here and in the books
# rule_book = "cn-coal-15"    # limits to check against: an installed one, or the path to your own
# centring_mm = {{ instrument = 1.0, target = 1.0 }}    # 1 sigma, each horizontal component

# One table for each gyro. `surveyapp models` lists the cards; every key of a card may be
# overridden here, for example scale_value_arcsec = 600.0
# [[instrument]]
# id = "G1"
# card = "wild-gak1"
# serial = "3139"
# constant = {{ arcsec = -9.7, sigma_arcsec = 3.0 }}    # if it is known beforehand
# constant_choice = "predicted"    # or pooled, interpolated, nearest, running:5, line:A-B, known

# One table for each station, targets included. Position: e and n in metres of the grid, or y_west
# and x_south, or lat and lon in degrees. Every position is optional.
# [[station]]
# name = "A"
# e = 431630.663
# n = 3811452.311
# h = 812.4
# fixed = true
# deflection = {{ xi_arcsec = 0.0, eta_arcsec = 0.0, sigma_arcsec = 5.0 }}

# [[station]]
# name = "B"

# One table for each occupation with the gyro: calibrations on lines of known azimuth first.
# [[orientation]]
# id = "calibration-1"
# station = "A"
# target = "B"
# instrument = "G1"
# method = "tracking"    # tracking | amplitude | transit | automatic
# purpose = "calibration"    # calibration | survey
# azimuth_known = {azimuth}    # grid azimuth; without it the coordinates decide
# date = 2026-11-22
# book = "observations/calibration-1.csv"

# The first lines of a book:
# seq,time,elapsed_s,kind,value,unit,face,side,target,temperature_c,note
# 1,,,backsight,{azimuth_bare},,L,,,,
"""

_INSTRUMENT: Final = """
[[instrument]]
id = "G1"
card = {card}
# what the card does not state, as its owner has determined it:
# scale_value_arcsec = 600.0
# period = {{ latitude_deg = 47.0, tracking_s = 425.4, clamped_s = 388.3 }}
# torsion = {{ lambda = 0.2 }}    # at that latitude; without it from both periods
"""


def _only_leftovers(folder: Path) -> bool:
    """Whether a folder is empty, but for what a killed ``new`` leaves; that is taken away."""
    left = list(folder.iterdir())
    ours = [item for item in left if item.name.startswith(".project.toml.") and is_regular(item)]
    rest = [item for item in left if item not in ours]
    if any(item.name != "observations" or item.is_symlink() for item in rest):
        return False
    if any(not item.is_dir() or next(item.iterdir(), None) is not None for item in rest):
        return False
    for item in ours:
        item.unlink()
    return True


def need_own_folder(folder: Path) -> None:
    """Refuse a folder that holds anything but what a killed ``new`` has left.

    Raises
    ------
    SurveyError
    """
    need_short_path(folder, room=ROOM)
    if folder.exists() and (not folder.is_dir() or not _only_leftovers(folder)):
        raise SurveyError(
            Problem(
                "a new project needs a folder of its own",
                shown_path(folder),
                "a folder that is not empty" if folder.is_dir() else "a file",
                "a folder that does not exist or is empty",
            )
        )


def create_project(
    folder: Path,
    *,
    name: str,
    crs: str | None = None,
    angle_unit: AngleUnit = AngleUnit.DMS,
    grid_line: str | None = None,
    card: str | None = None,
) -> Path:
    """Begin a project in a folder that does not exist or is empty.

    Parameters
    ----------
    folder : Path
        Its parents are made where they are missing.
    name : str
        Title of the project.
    crs : str, optional
        EPSG code, PROJ string or WKT.
    angle_unit : AngleUnit
    grid_line : str, optional
        Of a mine's own grid, which names its base itself.
    card : str, optional
        Card of the instrument G1.

    Returns
    -------
    Path
        The new project.toml.

    Raises
    ------
    SurveyError
        If the folder holds anything, or cannot be made.
    """
    if not name.strip() or has_control(name) or "\n" in name or len(name) > 200:
        raise SurveyError(
            Problem("this is no name for a project", "name", shown(name), "one line of text")
        )
    try:
        need_own_folder(folder)
        (folder / "observations").mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SurveyError(
            Problem(said("the folder cannot be made ({reason})", reason=reason), shown_path(folder))
        ) from None
    example = _EXAMPLES[angle_unit]
    crs_line = f"crs = {toml_value(crs)}" if crs else '# crs = "EPSG:4546"    # the grid'
    crs_line = grid_line or crs_line
    text = _TEMPLATE.format(
        name=toml_value(name),
        crs=crs_line,
        angle_unit=toml_value(str(angle_unit)),
        azimuth=toml_value(example),
        azimuth_bare=example,
    )
    if card is not None:
        text += _INSTRUMENT.format(card=toml_value(card))
    path = folder / "project.toml"
    atomic_write(path, text.encode("utf-8"))
    return path
