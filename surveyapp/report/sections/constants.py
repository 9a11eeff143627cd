"""The instrument constant: line by line, determination by determination, through time."""

from __future__ import annotations

import math

from surveyapp.core.orientation.constant_axis import EPOCH, calendar_moment
from surveyapp.domain.results import ConstantResult, Determination, OrientationResult, to_arcsec
from surveyapp.languages import said, said_each, term
from surveyapp.report.blocks import Block, Figure, Heading, KeyValues, Table
from surveyapp.report.numbers import NOTHING, plain, seconds
from surveyapp.report.plots import Axis, Frame, axis

_STABLE = {
    True: said("stable"),
    False: said("NOT STABLE: lines or epochs disagree"),
    None: said("nothing can tell"),
}


def blocks(result: OrientationResult) -> tuple[Block, ...]:
    """Blocks of every instrument whose constant is known."""
    found: list[Block] = []
    for constant in result.constants:
        if constant.value is not None:
            found += _constant(constant)
    return (Heading(said("Instrument constant")), *found) if found else ()


def _constant(constant: ConstantResult) -> list[Block]:
    found: list[Block] = [
        Heading(
            said(
                "{instrument}: true minus gyro azimuth, astronomic terms",
                instrument=constant.instrument,
            ),
            2,
        ),
        KeyValues(
            (
                (
                    said("constant"),
                    f'{seconds(constant.value, sign=True)}" ± {seconds(constant.sigma)}"',
                ),
                (said("95 % interval"), f'± {seconds(constant.interval95)}"'),
                (said("choice"), term(constant.choice)),
                (said("determinations"), str(constant.count)),
                (said("stability"), _STABLE[constant.stable]),
            )
        ),
    ]
    if constant.by_line:
        rows = tuple(
            (
                f"{line.station} - {line.target}",
                seconds(line.value, sign=True),
                seconds(line.sigma),
                str(line.count),
                str(line.rounds),
                plain(line.distance_m, 1),
            )
            for line in constant.by_line
        )
        head = said_each("known line", 'constant "', '±"', "determinations", "rounds", "length m")
        found.append(Table(head, rows, "lrrrrr"))
    if constant.determinations:
        found += [_determinations(constant), _plot(constant)]
    return found


def _determinations(constant: ConstantResult) -> Table:
    rows = []
    for item in constant.determinations:
        difference = None
        if item.from_coordinates is not None:
            difference = math.remainder(item.known_azimuth - item.from_coordinates, 2 * math.pi)
        rows.append(
            (
                item.session,
                f"{item.station} - {item.target}",
                term(item.phase),
                seconds(item.value, sign=True),
                seconds(item.sigma),
                NOTHING if difference is None else seconds(difference, sign=True),
            )
        )
    head = said_each("session", "line", "phase", 'constant "', '±"', 'known minus coordinates "')
    return Table(head, tuple(rows), "lllrrr")


def _plot(constant: ConstantResult) -> Figure:
    items = constant.determinations
    centre = constant.value or 0.0
    spread = [item.sigma if math.isfinite(item.sigma) else 0.0 for item in items]
    bounds = [
        bound
        for item, sigma in zip(items, spread, strict=True)
        for bound in (item.value - sigma, item.value + sigma)
    ]
    shown = [to_arcsec(value) or 0.0 for value in (*bounds, centre)]
    frame = Frame(_moments(items), axis(shown), height_mm=52.0)
    names = [_name(item) for item in items]
    by_order = len(set(frame.x.ticks)) == len(items) and frame.x.decimals < 0
    parts = frame.axes(
        said("session") if by_order else said("date (UTC)"),
        said("arcsec"),
        names if by_order else _days(frame.x),
    )
    parts.append(frame.level(to_arcsec(centre) or 0.0, "mean"))
    for place, item in zip(_places(items), items, strict=True):
        value = to_arcsec(item.value) or 0.0
        if math.isfinite(item.sigma):
            sigma = to_arcsec(item.sigma) or 0.0
            parts += frame.bar(place, low=value - sigma, high=value + sigma, cap_mm=1.0)
        parts += frame.marks([(place, value)], "circle")
    title = said("Determinations of the constant with one sigma; dashed: the constant in force")
    return frame.figure(title, parts)


def _name(item: Determination) -> str:
    return item.session if len(item.session) < 18 else item.session[:16] + "..."


def _places(items: tuple[Determination, ...]) -> list[float]:
    stamps = [item.moment_s for item in items]
    if any(stamp is None for stamp in stamps) or len(set(stamps)) < 2:
        return [float(index) for index in range(len(items))]
    return [float(stamp) for stamp in stamps if stamp is not None]


def _moments(items: tuple[Determination, ...]) -> Axis:
    """Axis of time where there are moments, else of the order (marked by negative decimals)."""
    places = _places(items)
    if places == [float(index) for index in range(len(items))]:
        return Axis(-0.5, len(items) - 0.5, tuple(places), -1)
    return axis(places, count=4)


def _days(x: Axis) -> list[str]:
    """Labels of a time axis: dates where the numbers are plausible moments, else the numbers."""
    labels = []
    for tick in x.ticks:
        moment = calendar_moment(tick)
        if moment is None:
            labels.append(f"{tick:g}")
        elif x.low > EPOCH:
            labels.append(moment.strftime("%Y-%m-%d"))
        else:
            labels.append(moment.strftime("%Y-%m-%d %H:%M"))
    return labels
