"""``surveyapp export FORMAT DIR FILE``: results and projects in the formats of others."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from surveyapp.cli.output import paragraph, print_json
from surveyapp.domain.filing import ExportResult

TABLES: Final = ("lines", "sessions", "constants", "checks", "all")


@dataclass(frozen=True, slots=True)
class Format:
    """One format: what it is, and what writes it."""

    summary: str
    write: Callable[[argparse.Namespace], ExportResult]


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


FORMATS: Final[Mapping[str, Format]] = {
    "csv": Format("results as a table", _csv),
    "gkf": Format("traverses as a GNU Gama network", _gkf),
    "json": Format("result with cards, rule book and hashes, for a later compare", _json),
    "gsi": Format("points as Leica GSI-16", _survey),
    "sdr": Format("points as Sokkia SDR33", _survey),
    "starnet": Format("points and observations as STAR*NET input", _survey),
    "dxf": Format("a drawing, DXF R12", _survey),
    "landxml": Format("points as LandXML 1.2", _survey),
    "kml": Format("stations and lines for maps", _survey),
    "geojson": Format("stations and lines for maps", _survey),
    "zip": Format("the whole project for hand-over", _zip),
}
"""Formats by name."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    listing = "; ".join(f"{name}: {item.summary}" for name, item in FORMATS.items())
    parser.add_argument("format", metavar="FORMAT", choices=FORMATS, help=listing)
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("file", metavar="FILE", help="file to be written")
    parser.add_argument("--table", choices=TABLES, default="lines", help="csv: which table")
    parser.add_argument(
        "--allow-outside", action="store_true", help="zip: sensor logs outside the folder too"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Export and say what was written."""
    result = FORMATS[options.format].write(options)
    if options.json:
        print_json(result.to_dict())
    else:
        print(f"{result.path}: {result.items} items\n  sha256 {result.sha256}")
        for item in result.warnings:
            print(paragraph(f"{item.code}: {item.text}"))
    return 0
