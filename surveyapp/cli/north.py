"""``surveyapp north FILE --method METHOD``: north by a rate sensor, or a plan of it."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.cli.sensor_options import (
    add_log_arguments,
    log_options,
    progress_bar,
    shown,
    shown_pair,
)
from surveyapp.domain.calibration import names_by_reason
from surveyapp.errors import Problem, SurveyError
from surveyapp_models.angles import AngleUnit, format_angle

if TYPE_CHECKING:
    from surveyapp.domain.north import NorthResult

NUMBERS = (
    ("--latitude", "DEG", "of the place"),
    ("--constant-deg", "DEG", "vertical-circle reading at which the gyro's axis is level"),
    ("--constant-sigma-arcsec", "S", "of that constant"),
    ("--approximate-north-deg", "DEG", "circle reading of north within some degrees"),
    ("--rate-sigma-deg-h", "S", "standard deviation of one row"),
    ("--bias-prior-sigma-deg-h", "S", "of the biases known beforehand"),
    ("--initial-heading-deg", "A", "heading with which a rotation begins"),
    ("--initial-heading-sigma-deg", "S", "of that heading"),
    ("--index-sigma-deg", "S", "standard deviation of every index angle"),
)
TEXTS = (
    ("--reading-from-elevation", "RULE", "increases | decreases, as in calibrate fog-station"),
    ("--bias-prior-deg-h", "X,Y,Z", "biases known beforehand"),
    ("--initial-reference", "REF", "MAGNETIC | ASTRONOMIC | GRID: of that heading"),
    ("--card", "CARD.toml", "sensor card: matrix and biases"),
    ("--index-axis", "x|y|z", "body axis about which the sensor was turned (z)"),
    ("--second", "FILE", "log of a second unit on the same vehicle"),
    ("--indexed", "first|second", "which of the two was turned (first)"),
    ("--declination", "D[,SIGMA]", "degrees, east positive; of a MAGNETIC heading only"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", metavar="FILE", nargs="?", help="log, or project folder")
    parser.add_argument("--method", metavar="NAME", help="fog-station | indexing | rotation")
    add_log_arguments(parser)
    group = parser.add_argument_group("the method")
    for option, metavar, text in NUMBERS:
        group.add_argument(option, type=float, metavar=metavar, help=text)
    for option, metavar, text in TEXTS:
        names = [option, "--declination-deg"] if option == "--declination" else [option]
        group.add_argument(*names, metavar=metavar, help=text)
    group.add_argument(
        "--track", action="store_true", default=None, help="follow the bias from set to set"
    )
    plan = parser.add_argument_group("--plan: stops and spacing")
    plan.add_argument("--plan", action="store_true", help="what stops of 10 to 300 s would reach")
    plan.add_argument("--grade", metavar="NAME", help="grade of the gyro (mems)")
    plan.add_argument("--want-deg", type=float, metavar="S", help="wanted sigma of the heading")
    plan.add_argument("--route-m", type=float, metavar="M", help="length of the route (1000)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Find north and print it; 1 where something is not determined or ambiguous."""
    from surveyapp import api

    if options.plan:
        return _plan(options)
    if options.source is None:
        raise SurveyError(Problem("an argument is missing", "surveyapp north", "", "FILE or DIR"))
    names = [option.strip("-").replace("-", "_") for option, _, _ in (*NUMBERS, *TEXTS)]
    names.append("track")
    own = {name: getattr(options, name) for name in names}
    result = api.north(
        options.source,
        method=options.method,
        sensor=options.sensor,
        log=log_options(options),
        allow_outside=options.allow_outside,
        options={name: value for name, value in own.items() if value is not None},
        progress=progress_bar(),
    )
    if options.json:
        print_json(result.to_dict())
        return 0 if result.met else 1
    print_north(result)
    return 0 if result.met else 1


def print_north(result: NorthResult) -> None:
    """The direction with its interval, the parameters and the warnings."""
    print(heading(f"{result.source}: north by {result.method}, {result.n} rows"))
    direction = result.direction
    what = "circle reading of north" if result.key == "gyro_north" else "heading"
    sigma = None if direction.sigma_arcsec is None else direction.sigma_arcsec / 3600.0
    value = shown_pair(direction.deg, sigma)[0]
    if direction.deg is not None:
        value += f" degrees = {format_angle(math.radians(direction.deg), AngleUnit.DMS, 1)}"
    print(f"  {what}: {value}, {direction.reference}")
    print(
        f"  sigma {shown(direction.sigma_arcsec)} arcsec, "
        f"95 % interval +- {shown(direction.interval95_arcsec)} arcsec"
    )
    print()
    cells = [[p.name, *shown_pair(p.value, p.sigma), p.unit] for p in result.parameters]
    print(table(["parameter", "value", "sigma", "unit"], cells))
    told: set[str] = set()
    for reason, own_names in names_by_reason(result.parameters).items():
        told |= set(own_names)
        print(paragraph(f"not determined: {', '.join(own_names)}: {reason}"))
    open_names = [name for name in result.undetermined if name not in told]
    if open_names:
        print(paragraph(f"not determined: {', '.join(open_names)}"))
    for warning in result.warnings:
        print(paragraph(f"{warning.code}: {warning.text}"))


def _plan(options: argparse.Namespace) -> int:
    from surveyapp import api

    if options.source is not None:
        raise SurveyError(Problem("--plan takes no log", "--plan", options.source))
    plan = api.plan_north_stops(
        grade=options.grade,
        latitude_deg=options.latitude,
        want_deg=options.want_deg,
        route_m=options.route_m,
    )
    if options.json:
        print_json(plan.to_dict())
        return 0
    grade = plan.grade
    print(heading(f"stops of a {grade.title} at latitude {plan.latitude_deg:g}"))
    rows = [
        [
            f"{row.stop_s:g}",
            f"{row.spacing_m:g}",
            shown(row.heading_sd_deg),
            shown(row.lateral_sd_m),
            shown(row.hours),
            "yes" if row.enough else "",
        ]
        for row in plan.rows
    ]
    print(table(["stop [s]", "every [m]", "heading", "lateral [m]", "hours", "enough"], rows))
    print()
    rows = [[shown(d), shown(theta)] for d, theta in plan.pointing]
    print(table(["bias [deg/h]", "pointing [deg]"], rows))
    print(paragraph(plan.words))
    return 0
