"""``surveyapp demo``: orient the measured samples and lay print and computation side by side."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import heading, number, paragraph, print_json, table
from surveyapp.domain.results import to_arcsec
from surveyapp_models.angles import AngleUnit, format_angle


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Orient every sample; the exit code is 0 whatever the checks say."""
    from surveyapp import api

    samples = api.demo()
    if options.json:
        print_json(samples.to_dict())
        return 0
    for sample in samples:
        print(heading(f"{sample.name}: {sample.result.project}"))
        print(paragraph(f"source: {sample.source}", indent=0) + "\n")
        rows = [
            [
                row.quantity,
                row.printed,
                row.computed,
                number(row.difference, 2, sign=True),
                row.unit,
            ]
            for row in sample.comparisons
        ]
        if rows:
            print(table(["quantity", "printed", "computed", "difference", "unit"], rows))
        for session in sample.default.sessions:
            if session.gyro_north is not None:
                north = format_angle(session.gyro_north.value, AngleUnit.DMS)
                sigma = number(to_arcsec(session.gyro_north.sigma))
                print(f'  {session.id}: gyro north by {session.estimator} {north} +-{sigma}"')
        for check in sample.default.checks:
            if check.passed is False and not check.is_part:
                print(paragraph(f"not met: {check.where}: {check.text}"))
        print()
    print("Look closer: surveyapp orient DIR, or the screens: surveyapp open DIR")
    print("with DIR one of:")
    for sample in samples:
        print(f"  {sample.folder}")
    return 0
