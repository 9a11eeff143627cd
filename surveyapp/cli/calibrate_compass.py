"""Options of ``surveyapp calibrate compass``."""

from __future__ import annotations

import argparse

from surveyapp.cli.sensor_options import run_kind


def add_arguments(group: argparse._ArgumentGroup) -> None:
    """Declare the options of this kind."""
    group.add_argument(
        "--heading-limit-deg",
        type=float,
        metavar="D",
        help="largest sigma of a level heading that is accepted (default 0.5)",
    )
    group.add_argument(
        "--declination",
        metavar="D[,SIGMA]",
        help="degrees, east positive: magnetic headings are given as astronomic ones as well",
    )


def run(options: argparse.Namespace) -> int:
    """Calibrate and print."""
    return run_kind(
        options,
        {"heading_limit_deg": options.heading_limit_deg, "declination": options.declination},
    )
