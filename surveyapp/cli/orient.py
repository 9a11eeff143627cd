"""``surveyapp orient``: field book to gyro north, constant and grid azimuth."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import WIDTH, heading, print_json
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.languages import said

ESTIMATORS = ("least-squares", "schuler", "amplitude", "transit")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("--session", metavar="ID", help="one session; its line from it alone")
    parser.add_argument(
        "--line",
        metavar="STATION-TARGET",
        help="one line, by every instrument; A,B if A-B is ambiguous",
    )
    parser.add_argument("--estimator", choices=ESTIMATORS, help="instead of the method's default")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Orient and print; 1 if a confirmed limit or test is not met."""
    from surveyapp import api

    project = api.open_project(options.folder)
    result = api.orient(
        project,
        session=options.session,
        line=options.line,
        estimator=options.estimator,
        advance=options.advance,
    )
    if options.json:
        print_json(result.to_dict())
    else:
        print(orientation_text(project, result, reduction=options.session is not None))
    return 0 if result.passed else 1


def orientation_text(
    project: Project, result: OrientationResult, *, reduction: bool = False
) -> str:
    """The whole result as the record shows it, without pictures.

    Parameters
    ----------
    project : Project
    result : OrientationResult
    reduction : bool
        Whether every step of every session is told.
    """
    from surveyapp.report.blocks import without_figures
    from surveyapp.report.result import result_blocks
    from surveyapp.report.text import blocks_text

    made = result_blocks(project, result, reduction=reduction)
    head = heading(said("{name}: orientation", name=result.project))
    return f"{head}\n\n{blocks_text(without_figures(made), WIDTH)}"
