"""``surveyapp new DIR``: make a new project folder."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import print_json


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="folder to make; must not hold anything")
    parser.add_argument("--name", help="name of the project (default: the folder's)")
    parser.add_argument("--crs", help="projected grid: EPSG code, PROJ string or WKT")
    parser.add_argument(
        "--mine-grid",
        metavar="LINE",
        help="the mine's own grid: 'ROTATION E N BASE_E BASE_N [SIGMA]', its origin in the crs; "
        "without a crs 'ROTATION E N LAT LON [SIGMA]', rotation from true north",
    )
    parser.add_argument("--card", metavar="CARD", help="card of its gyro: an id of `models`")
    parser.add_argument("--angle-unit", choices=("dms", "gon", "deg"), default="dms")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Make the folder and say what comes next."""
    from surveyapp import api

    path = api.new_project(
        options.folder,
        name=options.name,
        crs=options.crs,
        angle_unit=options.angle_unit,
        mine_grid=options.mine_grid,
        card=options.card,
    )
    if options.json:
        print_json(path.to_dict())
        return 0
    print(f"made {path / 'project.toml'}")
    if path.to_enter:
        values = ", ".join(path.to_enter)
        print(f"Its owner must enter what the card does not state: {values}.")
    print("Fill in stations, instrument and sessions there (it says how), then:")
    print(f"  surveyapp orient {path}")
    return 0
