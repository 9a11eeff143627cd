"""``surveyapp plan DIR``: methods, points and minutes for a wanted interval at this latitude."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import heading, number, print_json, table


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("--station", metavar="NAME", help="plan for this station (default: all)")
    parser.add_argument(
        "--interval",
        metavar="ARCSEC",
        type=float,
        default=20.0,
        help="wanted half-width of the 95 %% interval of gyro north (default 20)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Plan and print; 1 if no method meets the interval."""
    from surveyapp import api

    plans = api.plan(options.folder, station=options.station, interval_arcsec=options.interval)
    if options.json:
        print_json(plans.to_dict())
    else:
        for item in plans:
            latitude = "" if item.latitude_deg is None else f", latitude {item.latitude_deg:.2f}"
            print(heading(f"{item.station}, {item.instrument}{latitude}"))
            rows = [
                [
                    method.method,
                    str(method.points),
                    number(method.to_dict()["interval95_arcsec"]),
                    number(method.minutes, 0),
                    "enough" if method.enough else "NOT enough",
                ]
                for method in item.methods
            ]
            head = ["method", "points", '95 % ±"', "minutes", f'for {options.interval:g}"']
            print(table(head, rows) if rows else "  the card knows no sigma to plan with")
            print()
    return int(not all(any(m.enough for m in item.methods) for item in plans if item.methods))
