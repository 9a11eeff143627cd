"""``surveyapp close``: seal a project, or one session of it, with a hash chain in the ledger."""

from __future__ import annotations

import argparse
import sys

from surveyapp.cli.output import print_json
from surveyapp.cli.password import asked_password
from surveyapp.domain.filing import ClosingResult
from surveyapp.languages import counted, said, shown


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
        print(shown(outdated), file=sys.stderr)
    if as_json:
        print_json(result.to_dict())
        return 0
    what = said("session {name}", name=result.session) if result.session else said("project")
    if result.seal:
        _say(
            counted(
                "{what} closed, {count} file sealed",
                "{what} closed, {count} files sealed",
                count=result.files,
                what=what,
            )
        )
        _say(said("  at    {time}", time=result.at))
        _say(said("  seal  {head}", head=result.head))
        _say(said("  surveyapp check DIR --seal {head} verifies it", head=result.head))
        if result.signature:
            _say(said("  signed {name}", name=result.signature))
    else:
        _say(said("{what} reopened: {reason}", what=what, reason=result.reason))
        _say(said("  at    {time}", time=result.at))
        for text in result.found:
            _say(said("  changed since it was closed: {text}", text=text))
    return 0


def _say(text: str) -> None:
    """Print a text in the language in use."""
    print(shown(text))
