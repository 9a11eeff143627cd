"""Sensor logs in the record: parameters with sigma, before and after, geometry, Allan deviation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

from surveyapp.core.sensors.charts.results import slopes
from surveyapp.domain.calibration import Calibration, SensorParameter
from surveyapp.domain.noise import AllanChannel, AllanResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said, said_each, term
from surveyapp.languages.names import by_id, ids, named
from surveyapp.report.blocks import Block, Figure, Heading, KeyValues, Paragraph, Table, Tone
from surveyapp.report.numbers import NOTHING, by_sigma, dms_beside, four_digits
from surveyapp.report.plots import Axis, Frame

DIGEST_SHOWN = 16
"""Hexadecimal digits of a sha256 that the record shows."""


def title_of(identity: str) -> str:
    """Heading of the section of a log."""
    return said("Sensor log {identity}", identity=identity)


def calibration_blocks(identity: str, result: Calibration) -> tuple[Block, ...]:
    """Blocks of the calibration of one log; nothing in them depends on the day of printing."""
    lasting = tuple(item for item in result.warnings if item.code != "recalibration_due")
    return (Heading(title_of(identity)), *calibration_body(replace(result, warnings=lasting)))


def calibration_body(result: Calibration) -> tuple[Block, ...]:
    """The same without the heading."""
    found: list[Block] = [_facts(result), parameter_table(result.parameters)]
    if result.models:
        found += [Heading(said("Models compared"), 2), _models(result)]
    if not result.met:
        text = said("Not determined, refused or inconsistent: no sensor card comes of this log.")
        found.append(Paragraph(text, "warning"))
    for why, names in result.empty.items():
        tone: Tone = "warning" if set(names) & set(result.geometry.undetermined) else "body"
        text = said("No value, {why}: {names}.", why=why, names=ids(names))
        found.append(Paragraph(text, tone))
    return (*found, *_warnings(result.warnings))


def allan_blocks(identity: str, result: AllanResult) -> tuple[Block, ...]:
    """Blocks of the noise of one log: for every column a table, a plot and the coefficients."""
    found: list[Block] = [Heading(title_of(identity))]
    for channel in result.channels:
        text = said(
            "Allan deviation of {name}, {n} samples at {rate_hz:g} Hz",
            name=channel.name,
            n=channel.n,
            rate_hz=channel.rate_hz,
        )
        found += [Heading(text, 2), deviations(channel), *allan_figures(channel)]
        found.append(coefficients(channel))
    return (*found, *_warnings(result.warnings))


def _facts(result: Calibration) -> KeyValues:
    geometry = result.geometry
    words: list[str] = [term(geometry.verdict)]
    if geometry.coverage is not None:
        words.append(said("coverage {coverage:.0%}", coverage=geometry.coverage))
    if geometry.heading_sigma_deg is not None:
        words.append(
            said(
                "heading sigma {heading_sigma_deg:.3g} degrees",
                heading_sigma_deg=geometry.heading_sigma_deg,
            )
        )
    if geometry.condition is not None:
        words.append(said("condition {condition:.3g}", condition=geometry.condition))
    pairs = [
        (said("calibration"), said("{kind}, {n} rows", kind=term(result.kind), n=result.n)),
        (said("sha256 of the log"), result.sha256[:DIGEST_SHOWN] or NOTHING),
        (said("geometry"), joined(", ", words)),
    ]
    for name, misfit in ((said("rms before"), result.before), (said("rms after"), result.after)):
        size = f"{four_digits(misfit.rms)} {misfit.unit}"
        of = joined("", (size, " (", by_id(misfit.of), ")")) if misfit.of else size
        pairs.append((name, of))
    held = result.held_out
    if held is not None:
        values = said(
            "{before} before, {after} after",
            before=four_digits(held.before),
            after=four_digits(held.after),
        )
        pairs.append((said("left out"), joined("", (values, f" {held.unit}: ", term(held.scheme)))))
    return KeyValues(tuple(pairs))


def parameter_table(parameters: Sequence[SensorParameter]) -> Table:
    """Parameters with their sigma, of a calibration or a card."""
    rows = tuple(
        (
            named(item.name),
            by_sigma(item.value, item.sigma),
            four_digits(item.sigma),
            joined(" = ", [t for t in (item.unit, dms_beside(item.name, item.value)) if t]),
        )
        for item in parameters
    )
    return Table(said_each("parameter", "value", "±", "unit"), rows, "lrrl")


def _models(result: Calibration) -> Table:
    differ = len({model.of for model in result.models}) > 1
    rows = tuple(
        (
            named(model.id),
            four_digits(model.rms),
            four_digits(model.held_out_rms),
            model.unit,
            *((model.of,) if differ else ()),
            said("chosen") if model.chosen else "",
        )
        for model in result.models
    )
    chosen = frozenset(i for i, model in enumerate(result.models) if model.chosen)
    of = said_each("of") if differ else ()
    head = (*said_each("model", "rms", "left out", "unit"), *of, "")
    return Table(head, rows, "lrrll" + "l" * differ, strong=chosen)


def deviations(channel: AllanChannel) -> Table:
    """Allan deviation with its 95 % interval."""
    rows = tuple(
        (f"{tau:g}", four_digits(value), four_digits(low), four_digits(high))
        for tau, value, low, high in zip(
            channel.taus_s, channel.deviation, channel.low, channel.high, strict=True
        )
    )
    return Table(
        (
            said("time s"),
            said("deviation {unit}", unit=channel.unit),
            said("95 % from"),
            said("to"),
        ),
        rows,
        "rrrr",
    )


def coefficients(channel: AllanChannel) -> Table:
    """The noise coefficients, with the reason where there is none."""
    rows = tuple(
        (
            joined(" ", (item.symbol, named(item.name))),
            four_digits(item.value),
            four_digits(item.sigma),
            item.unit,
            named(item.reason or ""),
        )
        for item in channel.coefficients
    )
    head = said_each("coefficient", "value", "±", "unit", "why not")
    return Table(head, rows, "lrrll")


def allan_figures(channel: AllanChannel) -> tuple[Figure, ...]:
    """The deviation over time, both logarithmic; none where nothing is above zero."""
    points = [
        (math.log10(tau), math.log10(value), low, high)
        for tau, value, low, high in zip(
            channel.taus_s, channel.deviation, channel.low, channel.high, strict=True
        )
        if value > 0.0
    ]
    if len(points) < 2:
        return ()
    bars = [
        (x, math.log10(low) if low > 0.0 else y, math.log10(high) if high > 0.0 else y)
        for x, y, low, high in points
    ]
    across, x_names = _decades([x for x, *_ in points])
    up, _ = _decades(list(chain.from_iterable((low, high) for _, low, high in bars)))
    frame = Frame(across, up)
    curve = [(x, y) for x, y, *_ in points]
    label = said("lg of the deviation [{unit}]", unit=channel.unit)
    parts = frame.axes(said("averaging time [s]"), label, x_names)
    for x, low, high in bars:
        parts += frame.bar(x, low=low, high=high, cap_mm=0.8)
    for guide in slopes(channel):
        ends = [(math.log10(tau), math.log10(value)) for tau, value in guide.points]
        parts.append(frame.curve(ends, "limit"))
    parts += [frame.curve(curve, "data"), *frame.marks(curve, "dot")]
    return (
        frame.figure(
            said("Allan deviation of {name} with 95 % interval", name=channel.name), parts
        ),
    )


def _decades(values: Sequence[float]) -> tuple[Axis, list[str]]:
    """Axis of decimal logarithms over whole decades, and the numbers at its ticks."""
    low, high = math.floor(min(values) + 1e-9), math.ceil(max(values) - 1e-9)
    high = max(high, low + 1)
    ticks = tuple(range(low, high + 1))
    axis = Axis(float(low), float(high), tuple(float(tick) for tick in ticks), 0)
    return axis, [f"{10.0**tick:g}" for tick in ticks]


def _warnings(warnings: Sequence[ResultWarning]) -> tuple[Block, ...]:
    return tuple(Paragraph(joined(": ", (item.code, item.text)), "warning") for item in warnings)
