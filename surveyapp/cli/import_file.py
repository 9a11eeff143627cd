"""``surveyapp import FORMAT FILE DIR``: field files of other programs into a project."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from surveyapp.cli.output import heading, number, paragraph, print_json, table
from surveyapp.domain.fieldfile import ImportResult
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

_MOST_SETS: Final = 20


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    from surveyapp.io.importers.fieldfiles.catalogue import IMPORTERS

    names = [item.id for item in IMPORTERS]
    listing = "; ".join(f"{item.id}: {item.title}" for item in IMPORTERS)
    parser.add_argument("format", metavar="FORMAT", choices=names, help=listing)
    parser.add_argument("file", metavar="FILE", help="the field file")
    parser.add_argument("folder", metavar="DIR", help="project folder")
    parser.add_argument("--traverse", metavar="NAME", help="name of traverse and book")
    parser.add_argument("--station-code", metavar="N", help="gsi: code that opens a station")
    parser.add_argument("--instrument", metavar="ID", help="gyro-csv: the gyro")
    parser.add_argument(
        "--map", metavar="K=C", nargs="+", action="extend", default=[], help="quantity=column"
    )
    parser.add_argument(
        "--unit", metavar="K=U", nargs="+", action="extend", default=[], help="quantity=unit"
    )
    parser.add_argument(
        "--fix", metavar="NAME", nargs="+", action="extend", default=[], help="new fixed stations"
    )
    parser.add_argument("--sigma-angle", metavar="ARCSEC", help="1 sigma of an angle")
    parser.add_argument("--sigma-distance", metavar="MM+PPM", help="1 sigma of a distance")
    parser.add_argument(
        "--skip-damaged", action="store_true", help="leave damaged lines out and list them"
    )
    parser.add_argument(
        "--lines", metavar="A-B", help="take the readings of these lines: a large file in parts"
    )
    parser.add_argument(
        "--preview", action="store_true", help="say what is understood, write nothing"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def pairs(texts: Sequence[str], option: str) -> dict[str, str]:
    """``K=V`` texts as a mapping.

    Raises
    ------
    SurveyError
        For a text without ``=``, or a key that is told twice.
    """
    found: dict[str, str] = {}
    problems = []
    for text in texts:
        key, sign, value = text.partition("=")
        if not sign or not key or not value:
            problems.append(Problem("this is no pair", option, text, "like hz=COLUMN"))
        elif key in found:
            problems.append(
                Problem("this is told twice", option, text, said("one {key}=", key=key))
            )
        else:
            found[key] = value
    if problems:
        raise SurveyError(problems)
    return found


def _positive(text: str | None, option: str) -> float | None:
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < 1e5:
        raise SurveyError(
            Problem("this is no standard deviation", option, text, "a number above 0")
        )
    return value


def _distance(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    option = "--sigma-distance"
    mm, sign, ppm = text.partition("+")
    try:
        values = float(mm), float(ppm) if sign else 0.0
    except ValueError:
        values = (-1.0, 0.0)
    if not (values[0] >= 0.0 and 0.0 <= values[1] < 1e5 and 0.0 < sum(values) < 1e5):
        raise SurveyError(Problem("this is no mm+ppm", option, text, "two numbers like 2+2"))
    return values


def _progress(options: argparse.Namespace) -> Callable[[float], None]:
    """What tells the bar how many megabytes are read."""
    try:
        total = Path(options.file).stat().st_size // 1_000_000
    except (OSError, ValueError):
        total = 0

    def show(part: float) -> None:
        options.advance("MB", round(part * total), total)

    return show


def run(options: argparse.Namespace) -> int:
    """Import and tell; exit code 1 if a station lies elsewhere."""
    from surveyapp import api
    from surveyapp.io.importers.fieldfiles.parts import line_range

    result = api.import_file(
        options.format,
        options.file,
        options.folder,
        traverse=options.traverse,
        instrument=options.instrument,
        station_code=options.station_code,
        columns=pairs(options.map, "--map"),
        units=pairs(options.unit, "--unit"),
        fixed=options.fix,
        sigma_angle_arcsec=_positive(options.sigma_angle, "--sigma-angle"),
        sigma_distance=_distance(options.sigma_distance),
        skip_damaged=options.skip_damaged,
        preview=options.preview,
        lines=line_range(options.lines, "--lines"),
        progress=_progress(options),
    )
    if options.json:
        print_json(result.to_dict())
    else:
        print(import_text(result))
    return 1 if result.has_conflict else 0


def import_text(result: ImportResult) -> str:
    """The whole result as readable tables."""
    parts = [
        heading(f"{result.file}: {result.variant}"),
        _summary(result),
        _stations(result),
        _sets(result),
        _listed("Left out", [f"line {x.line}: {x.text} ({x.code})" for x in result.skipped]),
        _listed("Told", [f"{x.code}: {x.text}" for x in result.warnings]),
    ]
    return "\n\n".join(part for part in parts if part)


def _summary(result: ImportResult) -> str:
    made = f"  {result.readings} readings, {result.rows} rows"
    if result.book:
        made += f" in {result.book} (traverse {result.traverse})"
    if result.sessions:
        made += f", sessions {', '.join(result.sessions)}"
    done = "" if result.written else "\n  a preview: nothing was written"
    return f"{made}\n  as read: {result.raw}\n  sha256 {result.sha256}{done}"


def _stations(result: ImportResult) -> str:
    shown = result.stations[: 3 * _MOST_SETS]
    rows = [
        [item.name, number(item.e, 4), number(item.n, 4), number(item.h, 4), item.state]
        for item in shown
    ]
    more = len(result.stations) - len(shown)
    tail = f"\n  and {more} more" if more else ""
    return "Stations\n" + table(["station", "e", "n", "h", "state"], rows) + tail


def _sets(result: ImportResult) -> str:
    if not result.sets:
        return ""
    shown = [item.to_dict() for item in result.sets[:_MOST_SETS]]
    rows = [
        [
            item["set"],
            item["at"],
            " ".join(item["targets"]),
            str(item["faces"]),
            number(item["collimation_arcsec"], 1, sign=True),
            number(item["index_arcsec"], 1, sign=True),
        ]
        for item in shown
    ]
    more = len(result.sets) - len(rows)
    tail = f"\n  and {more} more" if more else ""
    head = ["set", "at", "targets", "faces", 'collimation "', 'index "']
    return "Sets, mean of the faces\n" + table(head, rows) + tail


def _listed(title: str, texts: Sequence[str]) -> str:
    if not texts:
        return ""
    shown = [paragraph(text) for text in texts[: 2 * _MOST_SETS]]
    more = len(texts) - len(shown)
    return "\n".join([title, *shown, *([f"  and {more} more"] if more else [])])
