"""``surveyapp spectrum FILE --column C``: interference lines, and a magnetic bias budget."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.cli.sensor_options import add_log_arguments, log_options, progress_bar, shown
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from surveyapp.domain.line_spectrum import LineSpectrum


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", metavar="FILE", help="log, or project folder")
    parser.add_argument("--column", metavar="C", help="which column, by its name")
    parser.add_argument(
        "--against", metavar="FILE2", help="a second state, such as the turntable switched on"
    )
    parser.add_argument("--field-uT", type=float, metavar="B", help="magnetic field [uT]")
    parser.add_argument(
        "--sensitivity", type=float, metavar="S", help="of the gyro's bias [deg/h per T]"
    )
    parser.add_argument("--shielding", type=float, metavar="F", help="factor of a shield (1)")
    add_log_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Look for lines and print them."""
    from surveyapp import api

    if options.column is None:
        raise SurveyError(
            Problem("which column?", "--column", "", "the name of a column, as gyr_x_rad_s")
        )
    result = api.spectrum(
        options.source,
        options.column,
        sensor=options.sensor,
        log=log_options(options),
        against=options.against,
        field_uT=options.field_uT,
        sensitivity_deg_h_t=options.sensitivity,
        shielding=options.shielding,
        allow_outside=options.allow_outside,
        progress=progress_bar(),
    )
    if options.json:
        print_json(result.to_dict())
    else:
        print_spectrum(result)
    return 0


def print_spectrum(result: LineSpectrum) -> None:
    """Lines, families, scatter, and the comparison."""
    print(heading(f"{result.source}: {result.column}, {result.n} rows at {result.rate_hz:g} Hz"))
    rows = [
        [
            f"{line.frequency_hz:.4f}",
            f"{line.sigma_hz:.1e}",
            shown(line.amplitude),
            f"{line.false_alarm_probability:.1e}",
            "" if line.family is None else str(line.family + 1),
        ]
        for line in result.lines
    ]
    print(table(["Hz", "sigma", f"amplitude [{result.unit}]", "false alarm", "family"], rows))
    if not rows:
        print("  no line")
    for i, family in enumerate(result.families, start=1):
        text = ", ".join(str(h) for h in family.harmonics)
        print(
            paragraph(
                f"family {i}: {text} x {family.fundamental_hz:.4f} Hz, p {family.p_family:.1e}"
            )
        )
    sd = result.scatter
    print(f"  sd of a sample: {shown(sd.before)} -> {shown(sd.after)} {sd.unit}")
    print(f"  sd of 10 s means: {shown(sd.before_10s)} -> {shown(sd.after_10s)} {sd.unit}")
    if result.magnetic is not None:
        budget = result.magnetic
        print(
            paragraph(
                f"magnetic bias: {budget.field_uT:g} uT x {budget.sensitivity_deg_h_t:g} deg/h/T "
                f"/ {budget.shielding:g} = {budget.bias_deg_h:.4g} deg/h"
            )
        )
    if result.against is not None:
        rows = [
            [
                axis["column"],
                shown(axis["sd_first"]),
                shown(axis["sd_second"]),
                shown(axis["sd_ratio"]),
                ", ".join(f"{line['frequency_hz']:.3f}" for line in axis["new_lines"]) or "-",
            ]
            for axis in result.against["axes"]
        ]
        print(table(["column", "sd", "sd second", "ratio", "new lines [Hz]"], rows))
    for warning in result.warnings:
        print(paragraph(f"{warning.code}: {warning.text}"))
