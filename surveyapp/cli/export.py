"""``surveyapp export FORMAT DIR FILE``: results and projects in the formats of others."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from typing import Final

from surveyapp.cli.output import paragraph, print_json
from surveyapp.domain.filing import ExportResult

TABLES: Final = ("lines", "sessions", "constants", "checks", "all")


def _zip(options: argparse.Namespace) -> ExportResult:
    from surveyapp import api

    return api.export_zip(options.folder, options.file, allow_outside=options.allow_outside)


def _csv(options: argparse.Namespace) -> ExportResult:
    from surveyapp import api

    return api.export_csv(options.folder, options.file, table=options.table)


def _json(options: argparse.Namespace) -> ExportResult:
    from surveyapp import api

    return api.export_json(options.folder, options.file)


def _gkf(options: argparse.Namespace) -> ExportResult:
    from surveyapp import api

    return api.export_gkf(options.folder, options.file)


def _survey(options: argparse.Namespace) -> ExportResult:
    from surveyapp import api

    return api.export_survey(options.format, options.folder, options.file)


OTHERS: Final[Mapping[str, Callable[[argparse.Namespace], ExportResult]]] = {
    "csv": _csv,
    "gkf": _gkf,
    "json": _json,
    "zip": _zip,
}
"""What is no survey: the catalogue of the exporters has an entry without a writer for each."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    from surveyapp.io.exporters.catalogue import EXPORTERS

    names = [item.id for item in EXPORTERS]
    listing = "; ".join(f"{item.id}: {item.title}" for item in EXPORTERS)
    parser.add_argument("format", metavar="FORMAT", choices=names, help=listing)
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("file", metavar="FILE", help="file to be written")
    parser.add_argument("--table", choices=TABLES, default="lines", help="csv: which table")
    parser.add_argument(
        "--allow-outside", action="store_true", help="zip: sensor logs outside the folder too"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Export and say what was written."""
    result = OTHERS.get(options.format, _survey)(options)
    if options.json:
        print_json(result.to_dict())
    else:
        print(f"{result.path}: {result.items} items\n  sha256 {result.sha256}")
        for item in result.warnings:
            print(paragraph(f"{item.code}: {item.text}"))
    return 0
