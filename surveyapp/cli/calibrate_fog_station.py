"""Options of ``surveyapp calibrate fog-station``, and its planning curves."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.cli.sensor_options import run_kind
from surveyapp.errors import Problem, SurveyError


def add_arguments(group: argparse._ArgumentGroup) -> None:
    """Declare the options of this kind."""
    group.add_argument(
        "--reading-from-elevation",
        metavar="RULE",
        help="increases | decreases: what the vertical circle does as the gyro goes from its "
        "elevation to the horizontal",
    )
    group.add_argument(
        "--plan", action="store_true", help="sigma of the elevation against rate and samples"
    )
    group.add_argument("--elevation-deg", type=float, metavar="V", help="of the plan (10)")
    group.add_argument("--rate", type=float, metavar="DEG_S", help="of the plan (30)")
    group.add_argument("--samples", type=int, metavar="N", help="of the plan, each way (300)")


def run(options: argparse.Namespace) -> int:
    """Calibrate and print, or plan."""
    if options.plan:
        return _plan(options)
    own = ("reading_from_elevation", "table_rate_relative_sigma", "against")
    return run_kind(options, {name: getattr(options, name) for name in own})


def _plan(options: argparse.Namespace) -> int:
    from surveyapp import api

    if options.source is not None:
        raise SurveyError(Problem("--plan takes no log", "--plan", options.source))
    plan = api.plan_fog_station(
        elevation_deg=options.elevation_deg,
        rate_deg_s=options.rate,
        samples=options.samples,
        relative_rate_sigma=options.table_rate_relative_sigma,
    )
    if options.json:
        print_json(plan.to_dict())
        return 0
    print(heading("sigma of the elevation of a gyro on a total station [arcsec]"))
    for curve in plan.curves:
        print(paragraph(f"{curve.title}"))
        rows = [[f"{x:g}", f"{y:.3f}"] for x, y in curve.points]
        print(table([curve.abscissa, "sigma"], rows))
        print()
    return 0
