"""Options of ``surveyapp calibrate rate``."""

from __future__ import annotations

import argparse

from surveyapp.cli.sensor_options import run_kind

OWN = (
    "programme",
    "latitude",
    "flip_sigma_arcsec",
    "table_rate_relative_sigma",
    "predict_at",
    "room",
    "gravity_m_s2",
    "against",
)


def add_arguments(group: argparse._ArgumentGroup) -> None:
    """Declare the options of this kind."""
    group.add_argument(
        "--programme", metavar="NAME", help="six-position | temperature | multi-position"
    )
    group.add_argument("--latitude", type=float, metavar="DEG", help="of the table")
    group.add_argument(
        "--flip-sigma-arcsec",
        type=float,
        metavar="S",
        help="how well the unit is seated after a flip, about each axis",
    )
    group.add_argument(
        "--table-rate-relative-sigma", type=float, metavar="R", help="of the table, as 1e-4"
    )
    group.add_argument(
        "--predict-at", metavar="T,...", help="chamber temperatures to predict parameters at"
    )
    group.add_argument(
        "--room", metavar="FILE", help="six positions at room temperature, for misalignments"
    )
    group.add_argument(
        "--against", metavar="CARD,...", help="older cards of the sensor: drift since then"
    )
    group.add_argument(
        "--gravity-m-s2", type=float, metavar="G", help="local gravity (default 9.80665)"
    )


def run(options: argparse.Namespace) -> int:
    """Calibrate and print."""
    return run_kind(options, {name: getattr(options, name) for name in OWN})
