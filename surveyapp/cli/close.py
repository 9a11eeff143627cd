"""``surveyapp close``: seal a project, or one session of it, with a hash chain in the ledger."""

from __future__ import annotations

import argparse
import sys

from surveyapp.cli.output import print_json
from surveyapp.cli.password import asked_password
from surveyapp.domain.filing import ClosingResult


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("--session", metavar="ID", help="this session alone")
    parser.add_argument("--by", default="", metavar="NAME", help="who closes")
    parser.add_argument("--note", default="", metavar="TEXT", help="a sentence for the ledger")
    parser.add_argument("--key", metavar="FILE.key", help="secret key of minisign, to sign with")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Close and say what stands in the ledger."""
    from surveyapp import api

    result = api.close(
        options.folder,
        session=options.session,
        by=options.by,
        note=options.note,
        key=options.key,
        password=asked_password,
    )
    return tell(result, as_json=options.json, folder=options.folder)


def tell(result: ClosingResult, *, as_json: bool, folder: str) -> int:
    """Print a closing or a reopening, and that a record on the disk is out of date now."""
    from surveyapp.observation.record import outdated_told

    outdated = outdated_told(folder)
    if outdated:
        print(outdated, file=sys.stderr)
    if as_json:
        print_json(result.to_dict())
        return 0
    what = f"session {result.session}" if result.session else "project"
    if result.seal:
        print(f"{what} closed, {result.files} files sealed")
        print(f"  at    {result.at}\n  seal  {result.head}")
        print(f"  surveyapp check DIR --seal {result.head} verifies it")
        if result.signature:
            print(f"  signed {result.signature}")
    else:
        print(f"{what} reopened: {result.reason}\n  at    {result.at}")
        for text in result.found:
            print(f"  changed since it was closed: {text}")
    return 0
