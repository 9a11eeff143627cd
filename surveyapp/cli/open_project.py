"""``surveyapp open DIR``, and ``surveyapp`` alone: the terminal screens."""

from __future__ import annotations

import argparse

from surveyapp.cli.languages import run_screens
from surveyapp.cli.terminal import need_terminal


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="project folder")


def run(options: argparse.Namespace) -> int:
    """Open the screens on one project; bad input is told before the screen is taken."""
    from surveyapp import api

    api.open_project(options.folder)
    need_terminal()
    return run_screens(lambda app: int(app.run_app(options.folder)))


def run_home() -> int:
    """Open the screens without a project."""
    need_terminal()
    return run_screens(lambda app: int(app.run_app(None)))
