"""``surveyapp reopen``: open a closed project or session again; the ledger keeps the reason."""

from __future__ import annotations

import argparse

from surveyapp.cli.close import tell


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("--reason", required=True, metavar="TEXT", help="why")
    parser.add_argument("--session", metavar="ID", help="this session alone")
    parser.add_argument("--by", default="", metavar="NAME", help="who reopens")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Reopen and say what stands in the ledger."""
    from surveyapp import api

    result = api.reopen(
        options.folder, reason=options.reason, session=options.session, by=options.by
    )
    return tell(result, as_json=options.json, folder=options.folder)
