"""``surveyapp allan FILE``: Allan deviation with intervals, and the five noise coefficients."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.cli.sensor_options import add_log_arguments, log_options, progress_bar, shown
from surveyapp.errors import Problem, SurveyError

if TYPE_CHECKING:
    from surveyapp.domain.noise import AllanChannel


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", metavar="FILE", help="log, or project folder with --sensor")
    parser.add_argument("--column", metavar="C", help="one column (default: every sensor column)")
    parser.add_argument(
        "--estimator", choices=("oadev", "adev"), default="oadev", help="default oadev"
    )
    parser.add_argument(
        "--taus", metavar="A,B", help="averaging times in seconds (default 1, 2, 4 ... samples)"
    )
    add_log_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Compute and print; 0 whatever is null."""
    from surveyapp import api

    result = api.allan(
        options.source,
        sensor=options.sensor,
        log=log_options(options),
        column=options.column,
        estimator=options.estimator,
        taus=times(options.taus),
        allow_outside=options.allow_outside,
        progress=progress_bar(),
    )
    if options.json:
        print_json(result.to_dict())
        return 0
    for channel in result.channels:
        _print_channel(channel)
    for warning in result.warnings:
        print(paragraph(f"{warning.code}: {warning.text}"))
    return 0


def times(text: str | None) -> tuple[float, ...] | None:
    """Times of an option, separated by commas.

    Raises
    ------
    SurveyError
    """
    if text is None:
        return None
    try:
        return tuple(float(part) for part in text.split(",") if part.strip())
    except ValueError:
        expected = "seconds, separated by commas"
        raise SurveyError(Problem("these are no times", "--taus", text, expected)) from None


def _print_channel(channel: AllanChannel) -> None:
    print(heading(f"{channel.name}, {channel.n} samples at {channel.rate_hz:g} Hz"))
    rows = [
        [f"{tau:g}", shown(value), shown(low), shown(high)]
        for tau, value, low, high in zip(
            channel.taus_s, channel.deviation, channel.low, channel.high, strict=True
        )
    ]
    print(table(["tau s", channel.unit, "95 % from", "to"], rows))
    print()
    rows = [
        [c.symbol, c.name, shown(c.value), shown(c.sigma), c.unit, c.reason or ""]
        for c in channel.coefficients
    ]
    print(table(["", "coefficient", "value", "sigma", "unit", "why not"], rows))
    print()
