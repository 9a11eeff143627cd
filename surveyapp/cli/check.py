"""``surveyapp check``: apply every limit and test that the project's data can answer."""

from __future__ import annotations

import argparse

from surveyapp.cli.output import WIDTH, print_json
from surveyapp.errors import Problem, SurveyError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("--seal", metavar="HEAD", help="verify the seal of a signed record")
    parser.add_argument("--key", metavar="FILE.pub", help="public key that must have signed")
    parser.add_argument(
        "--signed",
        metavar="FILE",
        action="append",
        default=[],
        help="a file that it must have signed",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Check and print; 1 if a confirmed limit or test is not met."""
    from surveyapp import api

    if options.signed and options.key is None:
        raise SurveyError(Problem("the command is incomplete", "--signed", "", "--key FILE.pub"))
    found = api.check(
        options.folder,
        seal=options.seal,
        key=options.key,
        signed=tuple(options.signed),
        advance=options.advance,
    )
    if options.json:
        print_json(found.to_dict())
    else:
        from surveyapp.report.sections import checks
        from surveyapp.report.text import blocks_text

        print(blocks_text(checks.blocks(found.checks, found.warnings), WIDTH))
    return 0 if found.passed else 1
