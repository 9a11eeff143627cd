"""``surveyapp simulate KIND OUT``: a simulated project, and its truth in truth.json."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import print_json


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "kind",
        metavar="KIND",
        help=" | ".join(
            (
                "reversal-run",
                "campaign",
                "compass",
                "tilt",
                "noise",
                "rate",
                "fog-station",
                "indexing",
                "vehicle",
            )
        ),
    )
    parser.add_argument("out", metavar="OUT", help="folder to make; must not hold anything")
    parser.add_argument(
        "--effect",
        action="append",
        default=[],
        metavar="ID=VALUE",
        help="a disturbing effect and its size; may be given several times",
    )
    parser.add_argument(
        "--programme",
        metavar="NAME",
        help="of rate: six-position (default) | temperature | multi-position; of "
        "indexing: one-stop (default) | several-stops",
    )
    parser.add_argument(
        "--coefficient",
        action="extend",
        nargs="+",
        default=[],
        metavar="SYMBOL=VALUE",
        help="of noise: Q N B K R, in arcsec, deg/sqrt(h), deg/h, deg/h/sqrt(h), deg/h^2",
    )
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="default 1")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Simulate and write."""
    from surveyapp import api

    made = api.simulate(
        options.kind,
        options.out,
        effects=options.effect,
        seed=options.seed,
        programme=options.programme,
        coefficients=options.coefficient,
    )
    if options.json:
        print_json(made.to_dict())
        return 0
    print(f"simulated (not observed): {made.folder}, {len(made.files)} files")
    print(f"the truth, which no other command reads: {made.truth}")
    return 0
