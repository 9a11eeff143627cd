"""Options of ``surveyapp calibrate edm``."""

from __future__ import annotations

import argparse

from surveyapp.cli.sensor_options import run_kind


def add_arguments(group: argparse._ArgumentGroup) -> None:
    """Declare the options of this kind."""
    group.add_argument(
        "--unit-length-m",
        type=float,
        metavar="U",
        help="unit length of the cyclic error, half the modulation wavelength; without it the "
        "common ones are tried, and the trial is paid for",
    )
    group.add_argument(
        "--heights",
        metavar="FILE",
        help="heights of the pillars: a table with the columns pillar and height_m",
    )


def run(options: argparse.Namespace) -> int:
    """Calibrate and print."""
    return run_kind(options, {"unit_length_m": options.unit_length_m, "heights": options.heights})
