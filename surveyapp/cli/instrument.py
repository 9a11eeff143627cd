"""``surveyapp instrument PROTOCOL:PORT``: one reading or a followed turn from the cable."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import number, print_json
from surveyapp.domain.instrument_reading import FollowedTurn, InstrumentReading
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "port",
        metavar="PROTOCOL:PORT[@BAUD]",
        help="geocom (Leica GeoCOM), gsi (Leica GSI Online) or sokkia, and the serial port",
    )
    parser.add_argument("--distance", action="store_true", help="measure a distance as well")
    parser.add_argument(
        "--follow",
        metavar="SECONDS",
        type=float,
        help="follow a turning point for so long, ten readings a second",
    )
    parser.add_argument("--timeout", metavar="S", type=float, default=5.0, help="for one answer")
    parser.add_argument(
        "--remember", action="store_true", help="the screens read this instrument by the key F9"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Read once, or follow a turn, and print it."""
    from surveyapp import api

    turn = None
    reading = api.read_instrument(
        options.port, distance=options.distance, timeout_s=options.timeout
    )
    if options.follow is not None:
        turn = api.follow_turn(options.port, seconds=options.follow, timeout_s=options.timeout)
    if options.remember:
        from dataclasses import replace

        from surveyapp.io.settings import read_settings, write_settings

        write_settings(replace(read_settings(), instrument=options.port))
    if options.json:
        document = reading.to_dict()
        document["turning_point"] = None if turn is None else turn.to_dict()
        print_json(document)
    else:
        print(_text(reading, turn))
    return 0


def _text(reading: InstrumentReading, turn: FollowedTurn | None) -> str:
    lines = [
        f"{reading.source}",
        f"  circle    {format_angle(reading.hz, AngleUnit.DMS)}",
        f"  zenith    {'-' if reading.v is None else format_angle(reading.v, AngleUnit.DMS)}"
        f"  face {reading.face or '-'}",
        f"  distance  {number(reading.slope_distance, 4)}",
    ]
    if turn is not None:
        lines.append(
            f"  turn      {format_angle(turn.value, AngleUnit.DMS)} "
            f'±{turn.sigma * RHO_ARCSEC:.1f}" after {turn.moment_s:.1f} s '
            f"±{turn.moment_sigma_s:.2f} s, {turn.readings} readings"
        )
    return "\n".join(lines)
