"""``surveyapp motion FILE``: stationary, steady, accelerating, braking, turning; and the path."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import heading, paragraph, print_json, table
from surveyapp.cli.sensor_options import add_log_arguments, log_options, progress_bar, shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", metavar="FILE", help="log, or project folder")
    parser.add_argument("--false-alarm", type=float, metavar="P", help="of a rest (0.01)")
    parser.add_argument("--path", action="store_true", default=None, help="the path driven")
    parser.add_argument("--from", dest="begin", metavar="E,N,AZIMUTH", help="where it begins")
    parser.add_argument("--to", dest="end", metavar="E,N", help="known point at its end")
    parser.add_argument(
        "--snap", action="store_true", default=None, help="lay the drift back over the path"
    )
    parser.add_argument(
        "--snap-power-cycle",
        metavar="WHICH",
        help="previous | current (default): where a constant correction goes",
    )
    parser.add_argument(
        "--still-gate-factor", type=float, metavar="F", help="multiplies the threshold of rest"
    )
    add_log_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Judge the motion and print it; 1 where the gate is found to be wrong."""
    from surveyapp import api

    names = ("false_alarm", "path", "begin", "end", "snap", "snap_power_cycle", "still_gate_factor")
    own = {name: getattr(options, name) for name in names}
    result = api.motion(
        options.source,
        sensor=options.sensor,
        log=log_options(options),
        allow_outside=options.allow_outside,
        options={name: value for name, value in own.items() if value is not None},
        progress=progress_bar(),
    )
    if options.json:
        print_json(result.to_dict())
        return 0 if result.met else 1
    print(heading(f"{result.source}: motion, {result.n} rows at {result.rate_hz:g} Hz"))
    rows = [[f"{s.start_s:.2f}", f"{s.end_s:.2f}", s.state] for s in result.segments]
    print(table(["from [s]", "to [s]", "state"], rows))
    if result.path is not None:
        path = result.path
        print(f"\n  path ({path.mode}): {path.length_m:.2f} m, closes to {shown(path.closure_m)} m")
        sides = ", ".join(f"{side:.3f}" for side in path.sides_m)
        print(paragraph(f"between stops: {sides or '-'} m"))
    for snapped in result.snapped:
        print(
            f"  snapped {snapped.from_m:.1f} to {snapped.to_m:.1f} m, {snapped.kind}, "
            f"{snapped.heading_deg:+.3f} degrees"
        )
    if result.zero_velocity is not None:
        print(f"  zero velocity: {result.zero_velocity['verdict']}")
    for warning in result.warnings:
        print(paragraph(f"{warning.code}: {warning.text}"))
    return 0 if result.met else 1
