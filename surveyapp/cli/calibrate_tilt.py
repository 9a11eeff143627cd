"""Options of ``surveyapp calibrate tilt``."""

from __future__ import annotations

import argparse

from surveyapp.cli.sensor_options import run_kind


def add_arguments(group: argparse._ArgumentGroup) -> None:
    """Declare the options of this kind."""
    group.add_argument(
        "--reference-temperature-c",
        type=float,
        metavar="T",
        help="temperature at which the zeros hold (default 20)",
    )


def run(options: argparse.Namespace) -> int:
    """Calibrate and print."""
    return run_kind(options, {"reference_temperature_c": options.reference_temperature_c})
