"""``surveyapp report``: the survey record as PDF or text, and blank field-book forms."""

from __future__ import annotations

import argparse
import sys

from surveyapp.cli.languages import add_language, wished
from surveyapp.cli.output import print_json
from surveyapp.cli.password import asked_password
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said, shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", metavar="DIR", nargs="?", help="project folder")
    parser.add_argument("-o", "--output", metavar="FILE.pdf", help="PDF to be written")
    parser.add_argument("--blank", metavar="METHOD", help="a blank form instead of a record")
    parser.add_argument(
        "--font", metavar="FILE.ttf", help="face, or folder of faces, for further letters"
    )
    add_language(parser)
    parser.add_argument(
        "--diagnosis", action="store_true", help="diagnose every run and campaign in it"
    )
    parser.add_argument(
        "--sheets", action="store_true", help="gyro and traverse sheets as CSV and HTML beside it"
    )
    parser.add_argument("--key", metavar="FILE.key", help="secret key of minisign, to sign with")
    parser.add_argument("--text", action="store_true", help="print the record, write no PDF")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Write the record or the form; 0 whatever the checks say, they stand in it."""
    from surveyapp import api

    if (options.folder is None) == (options.blank is None):
        raise _usage("either a project folder or --blank METHOD")
    language = wished(options.language)
    if options.text and options.folder is not None:
        print(api.report_text(options.folder, language=language), end="")
        return 0
    if options.output is None:
        raise _usage("-o FILE.pdf")
    if options.blank is not None:
        written = api.blank_form(
            options.blank, options.output, font=options.font, language=language
        )
    else:
        written = api.report(
            options.folder,
            options.output,
            font=options.font,
            diagnosis=options.diagnosis,
            language=language,
            key=options.key,
            password=asked_password,
            advance=options.advance,
        )
    for warning in written.warnings:
        print(shown(warning.text), file=sys.stderr)
    sheets = api.SheetsResult((), ())
    if options.sheets and options.blank is None:
        sheets = api.write_sheets(options.folder, options.output, language=language)
    if options.json:
        print_json({**written.to_dict(), **sheets.to_dict()})
    else:
        pages = counted(
            "{path}: {count} page", "{path}: {count} pages", count=written.pages, path=written.path
        )
        print(f"{shown(pages)}\n  sha256 {written.sha256}")
        if written.signature:
            print(shown(said("  signed {name}", name=written.signature)))
        for text in (*sheets.paths, *sheets.problems):
            print(f"  {shown(text)}")
    return 0


def _usage(expected: str) -> SurveyError:
    return SurveyError(
        Problem("the command is incomplete", "surveyapp report", "", expected, "See --help.")
    )
