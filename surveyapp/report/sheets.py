"""The sheets of the trade as tables: traverse computation and gyro computation, for CSV and HTML.

Traverse sheet: one line for each sight, with what was observed, its adjusted grid azimuth and the
coordinates of its end. Gyro sheet: one line for each oriented line, from gyro azimuth to grid
azimuth with every correction between. Numbers are those of the record; nothing is computed anew but
differences of the adjusted coordinates.
"""

from __future__ import annotations

import csv
import html
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass

from surveyapp.domain.adjustment import AdjustedObservation, AdjustedPoint, AdjustmentResult
from surveyapp.domain.angle_result import AngleResult
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.records import not_a_formula
from surveyapp.domain.results import OrientationResult
from surveyapp.languages import current, joined, said, said_each, shown, term
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, wrap_pi, wrap_two_pi

K = ObservationKind
_KINDS = (K.ANGLE, K.DIRECTION, K.ZENITH, K.SLOPE_DISTANCE, K.DISTANCE, K.AZIMUTH, K.GYRO)
_STYLE = (
    "body{font-family:sans-serif;margin:2em}table{border-collapse:collapse}"
    "th,td{border:1px solid #888;padding:.2em .5em;text-align:right}"
    "th{background:#eee}td:first-child,td:nth-child(2){text-align:left}"
    "caption{text-align:left;font-weight:bold;padding:.5em 0}"
)


@dataclass(frozen=True, slots=True)
class Sheet:
    """A table with a title, a head and what stands below it.

    Parameters
    ----------
    id, title : str
    head : tuple of str
        With units.
    rows : tuple of tuple of str
    remarks : tuple of str
    """

    id: str
    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    remarks: tuple[str, ...] = ()


def _metres(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"


def _sides(result: AdjustmentResult) -> dict[tuple[str, str], list[AdjustedObservation]]:
    """Observations by sight, in the order of the book; an angle belongs to its fore sight."""
    sides: dict[tuple[str, str], list[AdjustedObservation]] = {}
    for item in result.observations:
        if item.kind in _KINDS and item.to:
            sides.setdefault((item.at, item.to), []).append(item)
    return sides


def _mean(items: Sequence[AdjustedObservation], *kinds: ObservationKind) -> float | None:
    """Mean of what was observed; directions and angles of one kind only."""
    found = [item.observed for item in items if item.kind in kinds]
    return sum(found) / len(found) if found else None


Angles = dict[tuple[str, str], tuple[str, float]]
"""Back sight and angle [rad] of each sight."""


def _angles(result: AdjustmentResult) -> Angles:
    """Angles as observed, of directions the mean of the sets from the first target of the station.

    A set ends where a target comes again.
    """
    found: Angles = {}
    sets: dict[str, list[dict[str, float]]] = {}
    for item in result.observations:
        if item.kind is K.ANGLE:
            found.setdefault((item.at, item.to), (item.back, item.observed))
        elif item.kind is K.DIRECTION:
            rays = sets.setdefault(item.at, [{}])
            if item.to in rays[-1]:
                rays.append({})
            rays[-1][item.to] = item.observed
    for at, rays in sets.items():
        back = next(iter(rays[0]))
        for to in dict.fromkeys(name for ray in rays for name in ray if name != back):
            turns = [ray[to] - ray[back] for ray in rays if to in ray and back in ray]
            if turns:
                gaps = [wrap_pi(turn - turns[0]) for turn in turns]
                found.setdefault((at, to), (back, turns[0] + sum(gaps) / len(gaps)))
    return found


def _traverse_row(
    ends: tuple[AdjustedPoint, AdjustedPoint],
    items: list[AdjustedObservation],
    angles: Angles,
    unit: AngleUnit,
) -> tuple[str, ...]:
    at, to = ends
    back, turn = angles.get((at.name, to.name), ("", None))
    angle = "" if turn is None else format_angle(wrap_two_pi(turn), unit)
    zenith = _mean(items, K.ZENITH)
    slope = _mean(items, K.SLOPE_DISTANCE)
    level = azimuth = ""
    steps = ["", ""]
    if None not in (at.e, at.n, to.e, to.n):
        de, dn = (to.e or 0.0) - (at.e or 0.0), (to.n or 0.0) - (at.n or 0.0)
        level = _metres(math.hypot(de, dn))
        azimuth = format_angle(wrap_two_pi(math.atan2(de, dn)), unit)
        steps = [_metres(de), _metres(dn)]
    rise = None if at.h is None or to.h is None else to.h - at.h
    sets = sum(item.kind is K.DIRECTION for item in items)
    return (
        *(at.name, to.name, back, angle, str(sets) if sets else ""),
        "" if zenith is None else format_angle(zenith, unit),
        *(_metres(slope), level, azimuth, *steps, _metres(rise)),
        *(_metres(to.e), _metres(to.n), _metres(to.h)),
        *(_millimetres(to.sigma_e), _millimetres(to.sigma_n), _millimetres(to.sigma_h)),
    )


def _millimetres(value: float | None) -> str:
    return "" if value is None else f"{value * 1000.0:.1f}"


def traverse_sheet(name: str, result: AdjustmentResult, unit: AngleUnit) -> Sheet:
    """Traverse computation: what was observed on each sight and what came out.

    Parameters
    ----------
    name : str
        Of the traverse.
    result : AdjustmentResult
    unit : AngleUnit
        Of the project.
    """
    points = {point.name: point for point in result.points}
    angles = _angles(result)
    rows = [
        _traverse_row((points[at], points[to]), items, angles, unit)
        for (at, to), items in _sides(result).items()
        if at in points and to in points
    ]
    head = (
        *said_each("station", "target", "back", "angle", "sets", "zenith", "slope m", "level m"),
        *said_each(
            "grid azimuth", "dE m", "dN m", "dH m", "E m", "N m", "H m", "sE mm", "sN mm", "sH mm"
        ),
    )
    verdict = {True: said("met"), False: said("NOT MET"), None: said("open")}
    remarks = [
        said(
            "least squares, {dof} degrees of freedom, global test {verdict}",
            dof=result.dof,
            verdict=verdict[result.global_test.passed],
        )
    ]
    remarks += [_closure(item.to_dict()) for item in result.closures]
    remarks += [said("left out: {what}", what=item.description) for item in result.left_out]
    remarks += [joined(": ", (item.code, item.text)) for item in result.warnings]
    title = said("Traverse {name}", name=name)
    return Sheet(f"traverse-{name}", title, head, tuple(rows), tuple(remarks))


def _closure(values: dict[str, object]) -> str:
    found = {key: value for key, value in values.items() if isinstance(value, float)}
    parts = [said("closure {kind}", kind=term(str(values["kind"])))]
    if "angular_arcsec" in found:
        parts.append(said('angular {value:+.1f}"', value=found["angular_arcsec"]))
    if "linear_m" in found:
        parts.append(said("linear {value:.4f} m", value=found["linear_m"]))
    if "relative_1_in" in found:
        parts.append(f"1:{found['relative_1_in']:.0f}")
    if "height_m" in found:
        parts.append(said("height {value:+.4f} m", value=found["height_m"]))
    if "height_mm_per_sqrt_km" in found:
        parts.append(said("{value:+.1f} mm per root km", value=found["height_mm_per_sqrt_km"]))
    if "height_allowed_m" in found:
        parts.append(said("allowed {value:.4f} m", value=found["height_allowed_m"]))
    return joined(", ", parts)


def _result(value: AngleResult | None, unit: AngleUnit) -> tuple[str, str]:
    if value is None:
        return "", ""
    sigma = f"{value.sigma * RHO_ARCSEC:.1f}" if math.isfinite(value.sigma) else ""
    return format_angle(value.value, unit), sigma


def _seconds(value: float | None) -> str:
    return "" if value is None else f"{value * RHO_ARCSEC:+.1f}"


def gyro_sheet(result: OrientationResult, unit: AngleUnit) -> Sheet:
    """Gyro computation: from the gyro azimuth of each line to its grid azimuth."""
    rows = []
    for line in result.lines:
        gyro, gyro_sigma = _result(line.gyro_azimuth, unit)
        grid, grid_sigma = _result(line.grid_azimuth, unit)
        true, _ = _result(line.true_azimuth, unit)
        rows.append(
            (
                *(line.station, line.target, line.instrument, str(line.rounds), gyro, gyro_sigma),
                *(_seconds(line.constant), _seconds(line.deflection), true),
                *(_seconds(line.convergence), _seconds(line.arc_to_chord), grid, grid_sigma),
            )
        )
    head = (
        *said_each(
            "station", "target", "instrument", "rounds", "gyro azimuth", 's "', 'constant "'
        ),
        *said_each('deflection "', "true azimuth", 'convergence "', 'T-t "', "grid azimuth", 's "'),
    )
    constants = [
        said("constant of {instrument}", instrument=item.instrument)
        + f': {_seconds(item.value)}"'
        + ("" if item.sigma is None else f' +-{item.sigma * RHO_ARCSEC:.1f}"')
        for item in result.constants
        if item.value is not None
    ]
    warnings = [joined(": ", (item.code, item.text)) for item in result.warnings]
    return Sheet("gyro", said("Gyro orientation"), head, tuple(rows), (*constants, *warnings))


def sheet_csv(sheet: Sheet) -> str:
    """A sheet as CSV: head, rows, an empty line, remarks; English in every language."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(sheet.head)
    writer.writerows([[not_a_formula(cell) for cell in row] for row in sheet.rows])
    if sheet.remarks:
        writer.writerow([])
        writer.writerows([[not_a_formula(text)] for text in sheet.remarks])
    return stream.getvalue()


def sheet_html(sheet: Sheet, *, project: str, software: str) -> str:
    """A sheet as one self-contained page of HTML, its texts in the language in use."""

    def cells(tag: str, row: Sequence[str]) -> str:
        return (
            "<tr>" + "".join(f"<{tag}>{html.escape(shown(cell))}</{tag}>" for cell in row) + "</tr>"
        )

    title = html.escape(f"{project}: {shown(sheet.title)}")
    lines = [
        f'<!DOCTYPE html><html lang="{current()}"><head><meta charset="utf-8">',
        f"<title>{title}</title><style>{_STYLE}</style></head><body>",
        f"<table><caption>{title}</caption><thead>{cells('th', sheet.head)}</thead><tbody>",
        *(cells("td", row) for row in sheet.rows),
        "</tbody></table>",
        *(f"<p>{html.escape(shown(text))}</p>" for text in sheet.remarks),
        f"<p><small>{html.escape(software)}</small></p></body></html>",
    ]
    return "\n".join(lines) + "\n"
