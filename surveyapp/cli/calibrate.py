"""``surveyapp calibrate KIND FILE``: a sensor log to parameters, sigmas and what is not determined.

One line of ``KINDS`` a kind: the module behind it declares the options of this kind and runs it.
"""

from __future__ import annotations

import argparse
import importlib
from types import ModuleType
from typing import Final

from surveyapp.cli.sensor_options import add_log_arguments
from surveyapp.errors import Problem, SurveyError, nearest_names

KINDS: Final = {
    "compass": "calibrate_compass",
    "tilt": "calibrate_tilt",
    "rate": "calibrate_rate",
    "fog-station": "calibrate_fog_station",
    "edm": "calibrate_edm",
}
"""Kind to the module of its options."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options that all kinds have, and those of each kind."""
    parser.add_argument("kind", metavar="KIND", help=" | ".join(KINDS))
    parser.add_argument("source", metavar="FILE", nargs="?", help="log, or project folder")
    add_log_arguments(parser)
    parser.add_argument("--card", metavar="OUT.toml", help="write a sensor card")
    for kind, module in KINDS.items():
        _module(module).add_arguments(parser.add_argument_group(kind))
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Run the kind; 1 if it is refused or something is not determined, as the kind says."""
    if options.kind not in KINDS:
        hint = nearest_names(options.kind, KINDS)
        raise SurveyError(
            Problem("there is no calibration of this kind", "calibrate", options.kind, hint=hint)
        )
    return int(_module(KINDS[options.kind]).run(options))


def _module(name: str) -> ModuleType:
    return importlib.import_module(f"surveyapp.cli.{name}")
