"""``surveyapp compensate KIND FILE --card CARD -o OUT.csv``: a calibration applied to a log."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import paragraph, print_json
from surveyapp.cli.sensor_options import add_log_arguments, log_options, progress_bar


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("kind", metavar="KIND", help="compass | tilt | rate")
    parser.add_argument("source", metavar="FILE", help="log, or project folder with --sensor")
    parser.add_argument("--card", metavar="CARD", required=True, help="sensor card")
    parser.add_argument("-o", dest="out", metavar="OUT.csv", required=True, help="file to write")
    parser.add_argument(
        "--declination",
        metavar="D[,SIGMA]",
        help="degrees, east positive: headings become ASTRONOMIC",
    )
    add_log_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Correct, write and print."""
    from surveyapp import api

    result = api.compensate(
        options.kind,
        options.source,
        card=options.card,
        out=options.out,
        declination=options.declination,
        sensor=options.sensor,
        log=log_options(options),
        allow_outside=options.allow_outside,
        progress=progress_bar(),
    )
    if options.json:
        print_json(result.to_dict())
        return 0
    print(f"{result.path}: {result.rows} rows, {', '.join(result.columns)}")
    if result.reference is not None:
        sigma = result.heading_sigma_deg
        told = "" if sigma is None else f", sigma at most {sigma:.3f} degrees"
        print(f"  headings are {result.reference}{told}")
    for warning in result.warnings:
        print(paragraph(f"{warning.code}: {warning.text}"))
    return 0
