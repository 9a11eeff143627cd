"""Noise filters, spectra, motion, north and diagnoses of sensor logs as blocks.

What the screens show, and what the record prints of a log beside its calibration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from surveyapp.core.sensors.rate.stop_plan import StopPlan
from surveyapp.domain.line_spectrum import LineSpectrum
from surveyapp.domain.motion import Motion
from surveyapp.domain.noise import FilterResult
from surveyapp.domain.north import NorthResult
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said, said_each, term
from surveyapp.languages.names import by_id, named
from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph, Table
from surveyapp.report.numbers import NOTHING, four_digits, plain
from surveyapp.report.sections.undetermined import undetermined_blocks

PM = "\N{PLUS-MINUS SIGN}"


def warning_blocks(warnings: Sequence[ResultWarning]) -> tuple[Block, ...]:
    """Every warning as a paragraph of its own."""
    return tuple(Paragraph(joined(": ", (item.code, item.text)), "warning") for item in warnings)


def filter_blocks(result: FilterResult) -> tuple[Block, ...]:
    """What a filter gains at each averaging time, and how late it follows a step."""
    rows = tuple(
        (f"{tau:g}", four_digits(a), four_digits(b), four_digits(ratio))
        for tau, a, b, ratio in zip(
            result.before.taus_s,
            result.before.deviation,
            result.after.deviation,
            result.deviation_ratio,
            strict=True,
        )
    )
    terms = tuple(
        (
            joined(" ", (a.symbol, named(a.name))),
            four_digits(a.value),
            four_digits(b.value),
            a.unit,
            named(b.reason or a.reason or ""),
        )
        for a, b in zip(result.before.coefficients, result.after.coefficients, strict=True)
    )
    lags = [
        (said("90 % of a step of {name}", name=name.replace("_", " ")), _lag(value))
        for name, value in result.step_lag_90_samples.items()
    ]
    facts = [(said("filter"), f"{result.filter}, q {result.q:.4g}, r {result.r:.4g}"), *lags]
    if result.resamplings is not None:
        facts.append(
            (
                said("resamplings"),
                said("{n} of {count} samples", n=result.resamplings, count=result.before.n),
            )
        )
    return (
        Heading(said("Filter on {column}", column=result.column), 2),
        KeyValues(tuple(facts)),
        Table(
            (said("time s"), said("raw {unit}", unit=result.unit), said("filtered"), said("ratio")),
            rows,
            "rrrr",
        ),
        Table(said_each("coefficient", "before", "after", "unit", "why not"), terms, "lrrll"),
        *warning_blocks(result.warnings),
    )


def _lag(samples: float | None) -> str:
    if samples is None:
        return said("not within the test")
    return said("after {n:.0f} samples", n=samples)


def spectrum_blocks(result: LineSpectrum) -> tuple[Block, ...]:
    """Lines with their probability of false alarm, families, and the scatter without them."""
    rows = tuple(
        (
            f"{line.frequency_hz:.4f}",
            f"{line.sigma_hz:.1e}",
            four_digits(line.amplitude),
            f"{line.false_alarm_probability:.1e}",
            "" if line.family is None else str(line.family + 1),
        )
        for line in result.lines
    )
    scatter = result.scatter
    facts = [
        (said("record"), said("{n} rows at {rate:g} Hz", n=result.n, rate=result.rate_hz)),
        (said("sd of a sample"), _change(scatter.before, scatter.after, scatter.unit)),
        (said("sd of 10 s means"), _change(scatter.before_10s, scatter.after_10s, scatter.unit)),
    ]
    for i, family in enumerate(result.families, start=1):
        times = ", ".join(str(h) for h in family.harmonics)
        text = f"{times} x {family.fundamental_hz:.4f} Hz, p {family.p_family:.1e}"
        facts.append((said("family {number}", number=i), text))
    if result.magnetic is not None:
        m = result.magnetic
        text = (
            f"{m.field_uT:g} uT x {m.sensitivity_deg_h_t:g} deg/h per T / {m.shielding:g} "
            f"= {m.bias_deg_h:.4g} deg/h"
        )
        facts.append((said("magnetic bias"), text))
    size = said("amplitude {unit}", unit=result.unit)
    head = ("Hz", PM, size, *said_each("false alarm", "family"))
    lines: Block = Table(head, rows, "rrrrr") if rows else Paragraph(said("No line stands out."))
    return (
        Heading(said("Spectrum of {column}", column=result.column), 2),
        KeyValues(tuple(facts)),
        lines,
        *_against(result.against),
        *warning_blocks(result.warnings),
    )


def _change(before: float | None, after: float | None, unit: str) -> str:
    return said(
        "{before} with the lines, {after} without {unit}",
        before=four_digits(before),
        after=four_digits(after),
        unit=unit,
    )


def _against(found: Mapping[str, Any] | None) -> tuple[Block, ...]:
    if found is None:
        return ()
    rows = tuple(
        (
            str(axis["column"]),
            four_digits(axis["sd_first"]),
            four_digits(axis["sd_second"]),
            four_digits(axis["sd_ratio"]),
            ", ".join(f"{line['frequency_hz']:.3f}" for line in axis["new_lines"]) or NOTHING,
        )
        for axis in found["axes"]
    )
    return (Table(said_each("column", "sd", "sd second", "ratio", "new lines Hz"), rows, "lrrrl"),)


def motion_blocks(result: Motion) -> tuple[Block, ...]:
    """States, the path, what was laid back over it, and the test of the gate."""
    rows = tuple((f"{s.start_s:.2f}", f"{s.end_s:.2f}", term(s.state)) for s in result.segments)
    facts = [(said("record"), said("{n} rows at {rate:g} Hz", n=result.n, rate=result.rate_hz))]
    facts.append((said("false alarm of a rest"), f"{result.false_alarm:g}"))
    if result.path is not None:
        path = result.path
        facts.append((said("path"), joined("", (term(path.mode), f", {path.length_m:.2f} m"))))
        facts.append((said("closes to"), f"{plain(path.closure_m, 3)} m"))
        sides = ", ".join(f"{side:.3f}" for side in path.sides_m)
        facts.append((said("between stops"), f"{sides or NOTHING} m"))
    for item in result.snapped:
        text = said(
            "{begin:.1f} to {end:.1f} m, {kind}, {heading:+.3f} degrees",
            begin=item.from_m,
            end=item.to_m,
            kind=term(item.kind),
            heading=item.heading_deg,
        )
        facts.append((said("laid back"), text))
    if result.zero_velocity is not None:
        verdict = str(result.zero_velocity["verdict"])
        share = result.zero_velocity.get("share_exceeding")
        told = term(verdict)
        if share is not None:
            beyond = said("{share:.0%} of the innovations beyond their bound", share=share)
            told = joined(", ", (told, beyond))
        facts.append((said("gate of rest"), told))
    return (
        Heading(said("State of motion"), 2),
        KeyValues(tuple(facts)),
        Table(said_each("from s", "to s", "state"), rows, "rrl"),
        *warning_blocks(result.warnings),
    )


def north_blocks(result: NorthResult) -> tuple[Block, ...]:
    """North or heading with its reference, both roots where they are not told apart."""
    way = result.direction
    facts = [(said("method"), said("{kind}, {n} rows", kind=term(result.method), n=result.n))]
    gyro = result.key == "gyro_north"
    name = said("gyro north, circle reading") if gyro else named("heading")
    value = said("not determined")
    if way.deg is not None:
        value = said("{angle:.5f} degrees {to}", angle=way.deg, to=term(way.reference))
    facts.append((name, value))
    if way.sigma_arcsec is not None:
        interval = plain(way.interval95_arcsec)
        facts.append((said("sigma, 95 % interval"), f'{plain(way.sigma_arcsec)}", {PM}{interval}"'))
    third = result.extra.get("third_axis")
    blocks: list[Block] = [Heading(said("North"), 2), KeyValues(tuple(facts))]
    if third:
        blocks += _roots(third)
    rows = tuple(
        (named(p.name), four_digits(p.value), four_digits(p.sigma), p.unit)
        for p in result.parameters
    )
    blocks.append(Table(said_each("parameter", "value", "±", "unit"), rows, "lrrl"))
    steps = result.extra.get("steps") or ()
    if steps:
        blocks.append(_steps(steps))
    tracking = result.extra.get("tracking") or ()
    if tracking:
        blocks.append(_tracking(tracking))
    blocks += undetermined_blocks(result.parameters, result.undetermined)
    return (*blocks, *warning_blocks(result.warnings))


def _roots(third: Mapping[str, Any]) -> list[Block]:
    """The headings that the third axis leaves open."""
    rows = tuple(
        (four_digits(root["heading_deg"]), four_digits(root["bias_deg_h"]))
        for root in third.get("roots", ())
    )
    found: list[Block] = [Paragraph(said("Third axis: {verdict}.", verdict=term(third["verdict"])))]
    if rows:
        found.append(Table(said_each("heading deg", "bias of the third axis deg/h"), rows, "rr"))
    return found


def _steps(steps: Sequence[Mapping[str, Any]]) -> Table:
    rows = []
    for item in steps:
        keys = [k for k in item if k not in ("step", "title")]
        told = ", ".join(f"{k} {_value(item[k])}" for k in keys)
        rows.append((str(item.get("step", "")), str(item.get("title", "")), told))
    return Table(said_each("step", "", "done"), tuple(rows), "lll")


def _value(value: object) -> str:
    if isinstance(value, float):
        return four_digits(value)
    if isinstance(value, list | tuple):
        return " ".join(_value(v) for v in value)
    return NOTHING if value is None else str(value)


def _tracking(tracking: Sequence[Mapping[str, Any]]) -> Table:
    rows = tuple(
        (
            str(i),
            _value(item.get("bias")),
            _value(item.get("sigma")),
            said("gated") if item.get("gated") else "",
        )
        for i, item in enumerate(tracking, start=1)
    )
    return Table(said_each("stop", "bias deg/h", "±", ""), rows, "rrrl")


def plan_blocks(plan: StopPlan) -> tuple[Block, ...]:
    """Stops by spacings, and what a bias leaves."""
    rows = tuple(
        (
            f"{row.stop_s:g}",
            f"{row.spacing_m:g}",
            plain(row.heading_sd_deg, 2),
            plain(row.lateral_sd_m, 2),
            plain(row.hours, 2),
            "" if row.enough is None else said("yes") if row.enough else said("no"),
        )
        for row in plan.rows
    )
    table = tuple((f"{bias:g}", plain(theta, 2)) for bias, theta in plan.pointing)
    return (
        Heading(
            said(
                "Stops of a {unit} at latitude {latitude:g}",
                unit=plan.grade.title,
                latitude=plan.latitude_deg,
            ),
            2,
        ),
        Table(
            said_each("stop s", "every m", "heading deg", "lateral m", "hours", "enough"),
            rows,
            "rrrrrl",
        ),
        Paragraph(plan.words),
        Table(said_each("bias deg/h", "pointing error deg"), table, "rr"),
    )


def diagnosis_blocks(document: Mapping[str, Any], words: Sequence[str]) -> tuple[Block, ...]:
    """The diagnosis of a log: words, candidates, before and after on held-out data."""
    unit = str(document.get("unit", ""))
    held = document.get("held_out") or {}
    facts = [(said("verdict"), named(str(document["verdict"])))]
    titles = {"before": said("rms before"), "after": said("rms after")}
    for name, title in titles.items():
        model = document.get(name) or {}
        left = held.get(name, model.get("loo_rms"))
        text = said(
            "{rms} {unit}, left out {left} {unit}",
            rms=four_digits(model.get("rms")),
            left=four_digits(left),
            unit=unit,
        )
        facts.append((title, text))
    rows = tuple(
        (
            named(str(item["effect"])),
            named(str(item["verdict"])),
            _p(item.get("p_family")),
            four_digits(item.get("delta_bic")),
        )
        for item in document.get("candidates", ())
    )
    return (
        Heading(said("Diagnosis"), 2),
        KeyValues(tuple(facts)),
        *(Paragraph(word) for word in words),
        Table(said_each("effect", "verdict", "p of family", "BIC gained"), rows, "llrr"),
    )


def _p(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.2g}"


def adopted_blocks(entry: SensorLogEntry) -> tuple[Block, ...]:
    """Effects that were adopted of a log, with their proof; none where there are none."""
    rows = tuple(
        (
            named(effect.id),
            joined(
                ", ",
                [
                    joined("", (by_id(name), f" {value:.4g} {unit}"))
                    for name, value, _, unit in effect.coefficients
                ],
            ),
            four_digits(effect.before),
            four_digits(effect.after),
            effect.adopted_at[:10],
        )
        for effect in entry.effects
    )
    if not rows:
        return ()
    head = said_each("effect", "coefficients", "rms before", "after", "adopted")
    return (Heading(said("Adopted"), 2), Table(head, rows, "llrrl"))
