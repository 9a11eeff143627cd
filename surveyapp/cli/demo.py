"""``surveyapp demo``: measured samples; print beside computation, sensors before and after."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import heading, number, paragraph, print_json, table
from surveyapp.cli.sensor_options import shown
from surveyapp.domain.demonstrated import DemonstratedSensor
from surveyapp.domain.results import to_arcsec
from surveyapp_models.angles import AngleUnit, format_angle


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Orient every sample; the exit code is 0 whatever the checks say."""
    from surveyapp import api

    samples, sensors = api.demo(), api.demo_sensors()
    if options.json:
        print_json({**samples.to_dict(), "sensors": sensors.to_dict()["sensors"]})
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
    for sensor in sensors:
        print_sensor(sensor)
    print("Look closer: surveyapp orient DIR, or the screens: surveyapp open DIR")
    print("with DIR one of:")
    for sample in samples:
        print(f"  {sample.folder}")
    print("Sensors: surveyapp diagnose DIR --sensor ID, or L on the screen of a project:")
    for sensor in sensors:
        print(f"  {sensor.folder}")
    return 0


def print_sensor(sensor: DemonstratedSensor) -> None:
    """One sensor log: numbers without and with what was found, and what is named."""
    print(heading(f"{sensor.name}: {sensor.title}"))
    rows = [[n.quantity, shown(n.before), shown(n.after), n.unit] for n in sensor.numbers]
    print(table(["quantity", "before", "after", "unit"], rows))
    if sensor.named:
        print(paragraph(f"named: {sensor.named.replace('_', ' ')}"))
    for words in sensor.words:
        print(paragraph(words))
    print()
