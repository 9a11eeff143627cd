"""Options that every command on a sensor log has, and how a calibration is printed."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from surveyapp.cli.numbers import finite
from surveyapp.cli.output import heading, number, paragraph, print_json, table
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp.report.numbers import decimals_of, dms_beside

if TYPE_CHECKING:
    from surveyapp.api.sensors import LogOptions
    from surveyapp.domain.advance import PartDone
    from surveyapp.domain.calibration import Calibration, SensorParameter


def add_log_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare how the columns of a log are to be understood."""
    group = parser.add_argument_group("the log")
    for option, metavar, text in (
        ("--map", "CANON=COLUMN", "which column is what, as time_s=t; several pairs each"),
        ("--unit", "COLUMN=UNIT", "uT nT mT G mG m/s2 g mg rad/s deg/s deg/h arcsec deg rad LSB 1"),
        ("--scale", "COLUMN=VALUE", "value of one count, in the unit of the column"),
    ):
        group.add_argument(
            option, action="extend", nargs="+", default=[], metavar=metavar, help=text
        )
    group.add_argument("--rate-hz", type=float, metavar="F", help="replaces a missing time_s")
    group.add_argument(
        "--header-rows", type=int, metavar="N", help="lines before the names (found by themselves)"
    )
    group.add_argument("--sensor", metavar="ID", help="the [[sensor_log]] of a project folder")
    group.add_argument(
        "--allow-outside", action="store_true", help="read a log outside the project folder"
    )


def log_options(options: argparse.Namespace) -> LogOptions:
    """The options of a log as the API takes them.

    Raises
    ------
    SurveyError
        For pairs that are none, all of them together.
    """
    from surveyapp.api.sensors import LogOptions

    problems: list[Problem] = []
    columns = pairs(options.map, "--map", problems)
    units = pairs(options.unit, "--unit", problems, last=True)
    scale: dict[str, float] = {}
    for name, text in pairs(options.scale, "--scale", problems, last=True).items():
        value = finite(text)
        if value is None:
            expected = "a finite number"
            problems.append(Problem("this is no number", f"--scale {name}", text, expected))
        else:
            scale[name] = value
    if options.rate_hz is not None and not 1e-9 <= options.rate_hz < 1e9:
        found = f"{options.rate_hz:g}"
        problems.append(Problem("this is no rate", "--rate-hz", found, "1e-9 to 1e9"))
    if options.header_rows is not None and options.header_rows < 0:
        found = str(options.header_rows)
        problems.append(Problem("this is no number of lines", "--header-rows", found, "0 or more"))
    if problems:
        raise SurveyError(problems)
    return LogOptions(columns, units, scale, options.rate_hz, options.header_rows)


def pairs(
    given: Sequence[str], option: str, problems: list[Problem], *, last: bool = False
) -> dict[str, str]:
    """``NAME=VALUE`` pairs; ``last`` splits at the last sign, for names that hold one.

    Several pairs may stand in one argument, separated by commas.
    """
    found: dict[str, str] = {}
    for argument in given:
        parts = argument.split(",")
        for text in parts if all("=" in part for part in parts) else [argument]:
            name, sign, value = text.rpartition("=") if last else text.partition("=")
            if not sign or not name.strip() or not value.strip():
                problems.append(Problem("this is no pair", option, text, "NAME=VALUE"))
            elif name.strip() in found and found[name.strip()] != value.strip():
                problems.append(Problem("this name is given twice", option, text, "each name once"))
            else:
                found[name.strip()] = value.strip()
    return found


def progress_bar() -> PartDone | None:
    """A bar on standard error while a large log is read and computed; none where nobody looks."""
    if not sys.stderr.isatty():
        return None
    shown = [-1]

    def tell(share: float) -> None:
        step = int(40 * share)
        if step == shown[0]:
            return
        shown[0] = step
        end = "\n" if share >= 1.0 else ""
        print(f"\r[{'#' * step:<40}] {share:4.0%}", end=end, file=sys.stderr, flush=True)

    return tell


def run_kind(options: argparse.Namespace, own: Mapping[str, object]) -> int:
    """Calibrate, print, and return the exit code: 1 where something is not determined."""
    from surveyapp import api

    if options.source is None:
        raise SurveyError(
            Problem("an argument is missing", "surveyapp calibrate", "", "FILE or DIR")
        )
    result = api.calibrate(
        options.kind,
        options.source,
        sensor=options.sensor,
        log=log_options(options),
        card=options.card,
        allow_outside=options.allow_outside,
        options={name: value for name, value in own.items() if value is not None},
        progress=progress_bar(),
    )
    if options.json:
        print_json(result.to_dict())
    else:
        print_calibration(result)
        if options.card is not None:
            print(f"\ncard written: {options.card}" if result.met else "\nno card was written")
    return 0 if result.met else 1


def print_calibration(result: Calibration) -> None:
    """The parameters, the misfit before and after, the geometry and the warnings."""
    print(heading(f"{result.source}: {result.kind}, {result.n} rows"))
    rows = [
        [item.name, *shown_pair(item.value, item.sigma), unit_of(item)]
        for item in result.parameters
    ]
    print(table(["parameter", "value", "sigma", "unit"], rows))
    print()
    for name, misfit in (("before", result.before), ("after", result.after)):
        of = f" ({misfit.of})" if misfit.of else ""
        print(f"  {name + ':':<9}rms {shown(misfit.rms)} {misfit.unit}{of}")
    if result.held_out is not None:
        held = result.held_out
        text = said(
            "held out: {before} -> {after} {unit}, {scheme}",
            before=shown(held.before),
            after=shown(held.after),
            unit=held.unit,
            scheme=held.scheme,
        )
        print(paragraph(text))
    if result.models:
        print()
        print(_models(result))
    print()
    _print_geometry(result)
    for warning in result.warnings:
        print(paragraph(f"{warning.code}: {warning.text}"))


def _models(result: Calibration) -> str:
    """The models that were compared; of what their residuals are where that is not one thing."""
    differ = len({m.of for m in result.models}) > 1
    rows = [
        [
            m.id,
            shown(m.rms),
            shown(m.held_out_rms),
            m.unit,
            *([m.of] if differ else []),
            "chosen" if m.chosen else "",
        ]
        for m in result.models
    ]
    return table(["model", "rms", "held out", "unit", *(["of"] if differ else []), ""], rows)


def _print_geometry(result: Calibration) -> None:
    geometry = result.geometry
    parts = [f"geometry: {geometry.verdict}"]
    if geometry.heading_sigma_deg is not None:
        parts.append(f"heading sigma {geometry.heading_sigma_deg:.3g} degrees")
    if geometry.coverage is not None:
        parts.append(f"coverage {geometry.coverage:.0%}")
    if geometry.condition is not None:
        parts.append(f"condition {geometry.condition:.3g}")
    print(paragraph(", ".join(parts)))
    for why, names in result.empty.items():
        print(paragraph(f"no value, {why}: {', '.join(names)}"))


NOTHING_BESIDE = 1e-6
"""Share of its sigma below which a value is the rounding of a computation."""


def shown_pair(value: float | None, sigma: float | None) -> tuple[str, str]:
    """A number and its standard deviation: as many digits of it as the sigma is worth."""
    decimals = decimals_of(sigma)
    if value is not None and sigma is not None and abs(value) < NOTHING_BESIDE * sigma:
        value = 0.0
    text = shown(value)
    if value is not None and decimals is not None and "e" not in text:
        known = len(text.partition(".")[2])
        text = number(float(value), max(known, min(decimals, 9)))
    return text, shown(sigma)


def unit_of(item: SensorParameter) -> str:
    """The unit of a parameter; of a circle reading with its degrees, minutes and seconds."""
    return " = ".join(t for t in (item.unit, dms_beside(item.name, item.value)) if t)


def shown(value: Any) -> str:
    """A number of any size with five digits, ``-`` where it is not determined."""
    if value is None:
        return "-"
    if value == 0.0 or 1e-3 <= abs(value) < 1e7:
        decimals = 0 if abs(value) >= 1e5 else 4 if abs(value) < 10.0 else 2
        return number(float(value), decimals)
    return f"{value:.3e}"
