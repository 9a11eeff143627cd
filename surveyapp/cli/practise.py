"""``surveyapp practise``: a simulated instrument to observe, and the truth afterwards."""

from __future__ import annotations

import argparse

from surveyapp.cli.languages import run_screens
from surveyapp.cli.terminal import need_terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--method",
        choices=("tracking", "amplitude", "transit", "automatic"),
        default="tracking",
        help="how the gyro is observed (default: tracking)",
    )
    parser.add_argument("--speed", type=float, default=1.0, help="times faster than life")
    hidden = parser.add_mutually_exclusive_group()
    hidden.add_argument("--hidden", action="store_true", help="with a hidden disturbance")
    hidden.add_argument("--perhaps", action="store_true", help="the lot decides whether with one")
    parser.add_argument("--seed", type=int, help="the same seed, the same instrument")


def run(options: argparse.Namespace) -> int:
    """Open the session screen on a simulated instrument; bad input is told before that."""
    from surveyapp.observation import practice as api_practice

    need_terminal()
    practice = api_practice.begin(
        api_practice.practice_folder(),
        method=options.method,
        speed=options.speed,
        disturbed=None if options.perhaps else options.hidden,
        seed=options.seed,
    )
    return run_screens(lambda app: int(app.run_practice(practice)))
