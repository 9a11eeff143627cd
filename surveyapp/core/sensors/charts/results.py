"""Pictures that a result alone holds: noise, filters, spectrum, motion, turntables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from surveyapp.core.sensors.rate.stop_plan import StopPlan
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.chart import MOST_POINTS, Chart, Picture, Series
from surveyapp.domain.line_spectrum import LineSpectrum
from surveyapp.domain.motion import STATES, Motion, Path
from surveyapp.domain.noise import AllanChannel, AllanResult, FilterResult
from surveyapp.languages import counted, joined, said, term
from surveyapp.languages.names import by_id, named

TIME: Final = said("time [s]")
TAU: Final = said("averaging time [s]")
SLOPES: Final = {"Q": -1.0, "N": -0.5, "B": 0.0, "K": 0.5, "R": 1.0}
"""Slope of the Allan deviation that each coefficient makes (IEEE 952, annex C)."""

PLANE_95: Final = math.sqrt(5.991464547)
"""Standard ellipse to the 95 % ellipse of a plane: chi-square of two degrees of freedom."""
ELLIPSES: Final = 12
_TITLES: Final = {
    "bias": said("Bias over temperature"),
    "scale_factor": said("Scale factor over temperature"),
}

Points = tuple[tuple[float, float], ...]


def pairs(x: Iterable[float], y: Iterable[float]) -> Points:
    """Points of a curve where both values are numbers, thinned to what can be told apart."""
    found = [
        (float(a), float(b))
        for a, b in zip(x, y, strict=True)
        if math.isfinite(float(a)) and math.isfinite(float(b))
    ]
    step = max(1, math.ceil(len(found) / MOST_POINTS))
    return tuple(found[::step])


def allan_charts(result: AllanResult) -> tuple[Picture, ...]:
    """The deviation of each column with its interval, and the slope of each coefficient found."""
    return tuple(_allan_chart(channel) for channel in result.channels if len(channel.taus_s) > 1)


def _allan_chart(channel: AllanChannel) -> Chart:
    curves = [
        Series(said("deviation"), pairs(channel.taus_s, channel.deviation)),
        Series("95 %", pairs(channel.taus_s, channel.low), "bound"),
        Series("95 %", pairs(channel.taus_s, channel.high), "bound"),
    ]
    curves += slopes(channel)
    return Chart(
        said("Allan deviation of {name}", name=channel.name),
        TAU,
        said("deviation [{unit}]", unit=channel.unit),
        tuple(_positive(curve) for curve in curves),
        log_x=True,
        log_y=True,
        note=_named(channel),
    )


def slopes(channel: AllanChannel) -> list[Series]:
    """Through the point where a term matters most: a line of its slope over a decade and more."""
    taus = np.array(channel.taus_s)
    values = np.array(channel.deviation)
    if taus.size < 2 or not np.all(values > 0.0):
        return []
    found = []
    local = np.gradient(np.log(values), np.log(taus))
    for item in channel.coefficients:
        if item.value is None or item.symbol not in SLOPES:
            continue
        slope = SLOPES[item.symbol]
        place = int(np.argmin(np.abs(local - slope)))
        ends = taus[max(place - 3, 0)], taus[min(place + 3, taus.size - 1)]
        line = tuple(
            (float(tau), float(values[place] * (tau / taus[place]) ** slope)) for tau in ends
        )
        found.append(Series(said("slope of {symbol}", symbol=item.symbol), line, "guide"))
    return found


def _named(channel: AllanChannel) -> str:
    known = [c for c in channel.coefficients if c.value is not None]
    if not known:
        return said("no coefficient is determined")
    return ", ".join(f"{c.symbol} {c.value:.3g} {c.unit}" for c in known)


def _positive(curve: Series) -> Series:
    return Series(curve.name, tuple(p for p in curve.points if p[1] > 0.0), curve.style)


def filter_charts(results: Sequence[FilterResult]) -> tuple[Picture, ...]:
    """Raw and filtered deviation curves together, and the ratios."""
    first = results[0]
    curves = [Series(said("raw"), pairs(first.before.taus_s, first.before.deviation))]
    curves += [
        Series(result.filter, pairs(result.after.taus_s, result.after.deviation))
        for result in results
    ]
    ratios = tuple(Series(r.filter, pairs(r.before.taus_s, r.deviation_ratio)) for r in results)
    return (
        Chart(
            said("Raw and filtered: {column}", column=first.column),
            TAU,
            said("deviation [{unit}]", unit=first.unit),
            tuple(_positive(curve) for curve in curves),
            log_x=True,
            log_y=True,
        ),
        Chart(said("Deviation, filtered to raw"), TAU, said("ratio"), ratios, log_x=True),
    )


def spectrum_charts(result: LineSpectrum) -> tuple[Picture, ...]:
    """Power spectral density in decibels with the lines found."""
    density = [
        (f, 10.0 * math.log10(d))
        for f, d in zip(result.frequency_hz, result.density, strict=True)
        if d > 0.0 and f > 0.0
    ]
    if len(density) < 2:
        return ()
    lowest, highest = min(y for _, y in density), max(y for _, y in density)
    curves = [Series(said("density"), pairs(*zip(*density, strict=True)))]
    curves += [
        Series(
            f"{line.frequency_hz:.3f} Hz",
            ((line.frequency_hz, lowest), (line.frequency_hz, highest)),
            "guide",
        )
        for line in result.lines[:20]
    ]
    found = counted("{count} line", "{count} lines", count=len(result.lines))
    note = found if result.lines else said("no line")
    label = said("density [dB re {unit}^2/Hz]", unit=result.unit)
    title = said("Spectrum of {column}", column=result.column)
    return (Chart(title, said("frequency [Hz]"), label, tuple(curves), note=note),)


def motion_charts(result: Motion) -> tuple[Picture, ...]:
    """States over time, and the path where there is one."""
    steps: list[tuple[float, float]] = []
    for segment in result.segments:
        level = float(STATES.index(segment.state))
        steps += [(segment.start_s, level), (segment.end_s, level)]
    found: list[Picture] = [
        Chart(
            said("State of motion"),
            TIME,
            "",
            (Series(said("state"), tuple(steps)),),
            y_names=tuple(term(state) for state in STATES),
        )
    ]
    if result.path is not None and len(result.path.points) > 1:
        path = result.path
        places = pairs(path.points[:, 1].tolist(), path.points[:, 2].tolist())
        told = [joined("", (term(path.mode), f": {path.length_m:.2f} m"))]
        if path.closure_m is not None:
            told.append(
                said(
                    "its end is {closure:.3f} m from its beginning, or from the point that was "
                    "stated",
                    closure=path.closure_m,
                )
            )
        note = joined("; ", (*told, said("95 % ellipses")))
        marks = (
            Series(said("begin"), places[:1], "dots"),
            Series(said("end"), places[-1:], "dots"),
        )
        series = (Series(said("path"), places), *marks, *_ellipses(path))
        found.append(
            Chart(said("Path"), said("east [m]"), said("north [m]"), series, square=True, note=note)
        )
        sigma = np.hypot(path.points[:, 3], path.points[:, 4]).tolist()
        along = pairs(path.points[:, 0].tolist(), sigma)
        title = said("Uncertainty of the place along the path")
        found.append(
            Chart(title, said("along [m]"), said("sigma [m]"), (Series(said("sigma"), along),))
        )
    return tuple(found)


def _ellipses(path: Path) -> tuple[Series, ...]:
    """95 % ellipses of the place, evenly along the path and at its end."""
    count = min(ELLIPSES, len(path.points) - 1)
    rows = np.unique(np.linspace(0, len(path.points) - 1, count + 1).astype(np.intp))[1:]
    angle = np.linspace(0.0, 2.0 * math.pi, 49)
    ring = np.array([np.cos(angle), np.sin(angle)])
    found = []
    for row in rows.tolist():
        _, east, north, sigma_e, sigma_n, cross = path.points[row].tolist()
        covariance = np.array([[sigma_e**2, cross], [cross, sigma_n**2]])
        size, axes = np.linalg.eigh(covariance)
        edge = axes @ (np.sqrt(np.maximum(size, 0.0))[:, None] * ring) * PLANE_95
        points = pairs((edge[0] + east).tolist(), (edge[1] + north).tolist())
        found.append(Series("95 %", points, "bound"))
    return tuple(found)


def plan_charts(plan: StopPlan) -> tuple[Picture, ...]:
    """What a bias leaves of the pointing."""
    series = (Series(said("arctan(bias / level earth rate)"), tuple(plan.pointing)),)
    title = said("Pointing at latitude {latitude:g}", latitude=plan.latitude_deg)
    return (Chart(title, said("bias [deg/h]"), said("error [deg]"), series, log_x=True),)


def table_charts(result: Calibration) -> tuple[Picture, ...]:
    """Repeats of the constant, and parameters over temperature, where there are any."""
    found: list[Picture] = []
    sets: Sequence[dict[str, Any]] = result.extra.get("sets", ())
    if result.kind == "fog-station" and sets:
        found.append(_repeats(sets))
    nodes: Sequence[dict[str, Any]] = result.extra.get("nodes", ())
    for name, unit in (("bias", "deg/h"), ("scale_factor", "ppm")):
        series = tuple(
            Series(by_id(f"{name}_{axis}"), _node_points(nodes, f"{name}_{axis}")) for axis in "xyz"
        )
        if any(item.points for item in series):
            word = named(name)
            title = _TITLES[name]
            found.append(
                Chart(title, said("temperature [C]"), joined("", (word, f" [{unit}]")), series)
            )
    return tuple(found)


def _repeats(sets: Sequence[dict[str, Any]]) -> Chart:
    """Each set about the mean of its own pass: the passes themselves lie degrees apart."""
    shown = np.array([s["elevation_arcsec"] for s in sets], dtype=np.float64)
    passes = np.array([s["pass"] for s in sets])
    for number in np.unique(passes):
        shown[passes == number] -= shown[passes == number].mean()
    line = ((1.0, 0.0), (float(len(sets)), 0.0))
    return Chart(
        said("Elevation of the gyro axis, set by set"),
        said("set"),
        said("about the mean of its pass [arcsec]"),
        (
            Series(said("elevation"), pairs(range(1, len(sets) + 1), shown), "dots"),
            Series(said("mean"), line, "guide"),
        ),
    )


def _node_points(nodes: Sequence[dict[str, Any]], name: str) -> Points:
    return tuple(
        (float(node["temperature_c"]), float(p["value"]))
        for node in nodes
        for p in node["parameters"]
        if p["name"] == name and p["value"] is not None
    )


def turns_of(result: Calibration) -> tuple[Picture, ...]:
    """Whole turns of every stretch of a six-position programme, in the order of the record."""
    steps = [s for s in result.extra.get("steps", ()) if s.get("step") == "segment"]
    if not steps:
        return ()
    marks = tuple(
        (0.5 * (s["start_s"] + s["end_s"]), math.copysign(s["turns_used"], s["rate_deg_s"]))
        for s in steps
    )
    order = [s["position"] for s in steps]
    changes = [order[0], *(b for a, b in pairwise(order) if a != b)]
    note = said("positions in order: {positions}", positions=" ".join(changes))
    series = (Series(said("turns"), marks, "dots"),)
    title = said("Turns used, both senses")
    return (Chart(title, TIME, said("turns"), series, note=note),)
