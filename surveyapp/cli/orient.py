"""``surveyapp orient``: field book to gyro north, constant and grid azimuth."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from surveyapp.cli.output import heading, number, paragraph, print_json, table
from surveyapp.domain.project import ResultWarning
from surveyapp.domain.results import (
    AngleResult,
    Check,
    CombinedResult,
    LineResult,
    OrientationResult,
    finite,
    to_arcsec,
)
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle

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
        print(orientation_text(result, project.angle_unit))
    return 0 if result.passed else 1


def orientation_text(result: OrientationResult, unit: AngleUnit) -> str:
    """The whole result as readable tables, angles in the project's unit."""
    parts = [heading(f"{result.project}: orientation")]
    parts += [_sessions(result, unit), _gyro_azimuths(result, unit), _constants(result)]
    parts += [_line(line, unit) for line in result.lines]
    parts += [_combined(result.combined, unit)]
    parts += [checks_text(result.checks, told=result.warnings), warnings_text(result.warnings)]
    return "\n\n".join(part for part in parts if part)


def _angle(item: AngleResult | None, unit: AngleUnit) -> tuple[str, str]:
    if item is None:
        return "-", "-"
    return format_angle(item.value, unit), number(to_arcsec(item.sigma))


def _sessions(result: OrientationResult, unit: AngleUnit) -> str:
    rows = []
    for session in result.sessions:
        north, sigma = _angle(session.gyro_north, unit)
        rms = number(to_arcsec(session.residual_rms))
        method = f"{session.method}, {session.estimator}"
        rows.append([session.id, method, str(session.points_used), north, sigma, rms])
    head = ["session", "method", "points", "gyro north", '±"', 'rms "']
    return "Sessions\n" + table(head, rows) if rows else ""


def _gyro_azimuths(result: OrientationResult, unit: AngleUnit) -> str:
    rows = []
    for session in result.sessions:
        for target in session.targets:
            reading, _ = _angle(target.line_reading, unit)
            azimuth, sigma = _angle(target.gyro_azimuth, unit)
            line = f"{session.station}-{target.target}"
            rows.append([session.id, session.purpose, line, reading, azimuth, sigma])
    head = ["session", "purpose", "line", "line reading", "gyro azimuth", '±"']
    return "Gyro azimuths\n" + table(head, rows) if rows else ""


def _constants(result: OrientationResult) -> str:
    rows = []
    for constant in result.constants:
        rows += [
            [
                constant.instrument,
                f"{line.station}-{line.target}",
                number(to_arcsec(line.value), 2, sign=True),
                number(to_arcsec(line.sigma), 2),
                str(line.count),
                str(line.rounds),
                number(line.distance_m, 1),
            ]
            for line in constant.by_line
        ]
        if constant.value is not None:
            stable = {True: "stable", False: "NOT STABLE", None: ""}[constant.stable]
            rows.append(
                [
                    constant.instrument,
                    f"{constant.choice} {stable}".strip(),
                    number(to_arcsec(constant.value), 2, sign=True),
                    number(to_arcsec(constant.sigma), 2),
                    str(constant.count),
                    "",
                    "",
                ]
            )
    head = ["instrument", "line", 'constant "', '±"', "n", "rounds", "length m"]
    if not rows:
        return ""
    lines = ["Instrument constant (true minus gyro)", table(head, rows)]
    return "\n".join([*lines, *(paragraph(text) for text in _known_azimuths(result))])


def _known_azimuths(result: OrientationResult) -> list[str]:
    """Known azimuths beside those from the coordinates, where both are there and differ."""
    return [
        f"{item.session}: the known azimuth of {item.station}-{item.target} is "
        f"{small_angle(apart)} from that of the coordinates"
        for constant in result.constants
        for item in constant.determinations
        if (apart := item.known_minus_coordinates) is not None and apart != 0.0
    ]


def _line(line: LineResult, unit: AngleUnit) -> str:
    rows: list[list[str]] = []

    def angle(label: str, item: AngleResult | None) -> None:
        if item is not None:
            value, sigma = _angle(item, unit)
            interval = number(to_arcsec(finite(item.interval95)))
            rows.append([label, value, sigma, interval])

    def small(label: str, value: float | None, sigma: float | None = None) -> None:
        if value is not None:
            rows.append([label, small_angle(value), number(to_arcsec(sigma)), ""])

    angle("gyro azimuth", line.gyro_azimuth)
    small(f"+ constant ({line.constant_choice})", line.constant, line.constant_sigma)
    angle("= true azimuth (astronomic)", line.true_azimuth)
    small("- deflection of the vertical", line.deflection)
    small("- meridian convergence", line.convergence)
    small("- arc-to-chord", line.arc_to_chord)
    angle("= grid azimuth", line.grid_azimuth)
    if line.existing_azimuth is not None:
        rows.append(["  from the coordinates", format_angle(line.existing_azimuth, unit), "", ""])
    if line.direction_from_south is not None:
        text = format_angle(line.direction_from_south, unit)
        rows.append(["direction from south", text, "", ""])
    head = [f"line {line.station}-{line.target}", "", '±"', '95 % ±"']
    text = table(head, rows, indent=0)
    if line.budget:
        budget = [
            [item.source, number(to_arcsec(item.sigma), 2), f"{item.share:.0%}"]
            for item in line.budget
            if item.sigma > 0.0
        ]
        text += "\n" + table(["  budget", '±"', "share"], [["  " + b[0], *b[1:]] for b in budget])
        zero = [item.source for item in line.budget if item.sigma == 0.0]
        if zero:
            text += "\n" + paragraph(f"zero: {', '.join(zero)}", indent=4)
    return text


def _combined(sides: Sequence[CombinedResult], unit: AngleUnit) -> str:
    """Sides with several lines: their mean by variances, or that they disagree."""
    rows = []
    for side in sides:
        value, sigma = _angle(side.grid_azimuth, unit)
        mean = side.grid_azimuth
        interval = "-" if mean is None else number(to_arcsec(finite(mean.interval95)))
        test = f"{side.chi_square:.2f} ({side.dof})"
        rows.append([f"{side.station}-{side.target}", value, sigma, interval, test])
        rows[-1].append("agree" if side.agree else "DISAGREE")
        rows += [[f"  {of.name}", "", "", "", "weight", number(of.weight, 3)] for of in side.lines]
    head = ["side", "grid azimuth", '±"', '95 % ±"', "chi-square (dof)", ""]
    return "Lines of one side, combined by their variances\n" + table(head, rows) if rows else ""


def small_angle(value: float) -> str:
    """A small angle [rad] with its sign: seconds, from a minute on minutes and seconds."""
    seconds = round(abs(value) * RHO_ARCSEC, 2)
    sign = "-" if value < 0.0 and seconds else "+"
    minutes, rest = divmod(seconds, 60.0)
    return f"{sign}{minutes:.0f}'{rest:05.2f}\"" if minutes else f'{sign}{rest:.2f}"'


def checks_text(checks: Sequence[Check], *, told: Sequence[ResultWarning] = ()) -> str:
    """The checks, one a line, then what is not met in words, then where the limits come from.

    Parameters
    ----------
    checks : sequence of Check
    told : sequence of ResultWarning
        Warnings that are shown as well: what they say of a check is not said twice.
    """
    if not checks:
        return ""
    rows = []
    loud = {(warning.code, warning.subject) for warning in told}
    answered = [check for check in checks if check.passed is not None]
    for check in answered:
        limit = "-" if check.limit is None else f"{check.limit:.4g}"
        value = "-" if check.value is None else f"{check.value:.4g}"
        rows.append([check.verdict, check.rule, check.where, value, limit, check.unit])
    head = ["verdict", "check", "where", "value", "limit", "unit"]
    parts = [table(head, rows)] if rows else []
    parts += [
        paragraph(f"{check.verdict}: {check.where}: {check.text}")
        for check in checks
        if check.passed is False
        and check.text
        and not check.is_part
        and (check.warning_code, check.subject) not in loud
    ]
    parts += _open(checks)
    clauses: dict[str, dict[str, None]] = {}
    for check in answered:
        clauses.setdefault(check.clause, {})[check.rule] = None
    parts += [paragraph(f"{clause}: {', '.join(rules)}") for clause, rules in clauses.items()]
    return "Checks\n" + "\n".join(parts)


def _open(checks: Sequence[Check]) -> list[str]:
    """What the data cannot answer, by what is missing."""
    missing: dict[str, dict[str, None]] = {}
    for check in checks:
        if check.passed is None:
            name = f"{check.rule} ({check.where})" if check.where else check.rule
            missing.setdefault(check.text, {})[name] = None
    return [paragraph(f"open, {text}: {', '.join(rules)}") for text, rules in missing.items()]


def warnings_text(warnings: Sequence[ResultWarning]) -> str:
    """The warnings, one a paragraph."""
    if not warnings:
        return ""
    texts = [paragraph(f"{item.code}: {item.text}") for item in warnings]
    return "Warnings\n" + "\n".join(texts)
