"""A breakthrough in the record: prediction, budget, plan of the headings, evaluation, six steps."""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.domain.penetration import STEP_TITLES
from surveyapp.domain.penetration_result import MissTest, Prediction
from surveyapp.languages import joined, said, said_each, term
from surveyapp.report.blocks import (
    Block,
    Figure,
    Heading,
    KeyValues,
    Label,
    Line,
    Marker,
    Paragraph,
    Polyline,
    Primitive,
    Table,
)
from surveyapp.report.numbers import NOTHING, plain
from surveyapp.report.plan import round_below

WIDTH_MM, HEIGHT_MM, MARGIN_MM = 170.0, 90.0, 12.0
ELLIPSE_MM = 14.0
STEPS = 48


def blocks(result: Prediction) -> tuple[Block, ...]:
    """Blocks of the section."""
    figure = plan_figure(result)
    return (
        *prediction(result),
        *(() if figure is None else (figure,)),
        *budget(result),
        *evaluation(result),
        Heading(said("The six steps of the procedure"), 2),
        steps(result),
        *warnings(result),
    )


def prediction(result: Prediction) -> tuple[Block, ...]:
    """What is predicted and what is allowed."""
    return (Heading(said("Breakthrough")), KeyValues(_facts(result)), _verdict(result))


def budget(result: Prediction) -> tuple[Block, ...]:
    """Every cause at the meeting point."""
    return (
        Heading(said("Budget at the meeting point"), 2),
        _budget(result),
        Paragraph(said("1 sigma; the rows add in squares to the total."), "small"),
    )


def evaluation(result: Prediction) -> tuple[Block, ...]:
    """The miss that was measured against what was predicted; none before."""
    if result.measured is None:
        return ()
    return (Heading(said("After the breakthrough"), 2), *_measured(result.measured))


def warnings(result: Prediction) -> tuple[Block, ...]:
    """What must be told beside the numbers."""
    return tuple(Paragraph(joined(": ", (w.code, w.text)), "warning") for w in result.warnings)


def _facts(result: Prediction) -> tuple[tuple[str, str], ...]:
    sections = result.sectioned
    facts = [(said("factor"), f"{result.factor:g} ({result.factor_source})")]
    if result.tolerance is not None:
        sure = "" if result.tolerance.confirmed else said(", not confirmed")
        facts.append((said("allowed by"), joined("", (result.tolerance.source, sure))))
    if sections.lateral_m is not None:
        why = "" if sections.valid else said("; does not hold here: {why}", why=sections.why)
        facts.append(
            (
                said("sectioned formula"),
                said("lateral {lateral_m:.4f} m{why}", lateral_m=sections.lateral_m, why=why),
            )
        )
    if result.simulated is not None:
        runs = result.simulated
        text = said(
            "lateral {lateral_m} m over {runs} runs, seed {seed}",
            lateral_m=plain(runs.sigma.lateral_m, 4),
            runs=runs.runs,
            seed=runs.seed,
        )
        facts.append((said("simulated surveys"), text))
    ellipse = result.ellipse
    axes = said("{a_m:.1f} x {b_m:.1f} mm", a_m=ellipse.a_m * 1000.0, b_m=ellipse.b_m * 1000.0)
    facts.append((said("ellipse"), f"{axes}, {math.degrees(ellipse.azimuth):.1f}\N{DEGREE SIGN}"))
    return tuple(facts)


def _verdict(result: Prediction) -> Table:
    allowed = (None, None, None) if result.tolerance is None else result.tolerance.components()
    rows = []
    names = said_each("lateral", "longitudinal", "vertical")
    for name, sigma, limit in zip(names, result.sigma.components(), allowed, strict=True):
        value = None if sigma is None else result.factor * sigma
        met = NOTHING
        if limit is not None and value is not None:
            met = said("yes") if value <= limit * (1.0 + 1e-12) else said("NO")
        rows.append((name, plain(sigma, 4), plain(value, 4), plain(limit, 4), met))
    head = (
        said("component"),
        said("1 sigma m"),
        said("x {factor:g} m", factor=result.factor),
        said("allowed m"),
        said("met"),
    )
    return Table(head, tuple(rows), "lrrrl", strong=frozenset({0}))


def _budget(result: Prediction) -> Table:
    rows: list[tuple[str, ...]] = [
        (
            term(row.source.replace("_", " ")),
            row.heading or said("common"),
            plain(row.lateral_m, 4),
            plain(row.longitudinal_m, 4),
            plain(row.vertical_m, 4),
        )
        for row in result.budget
    ]
    sigma = result.sigma
    rows.append((said("total"), "", *(plain(value, 4) for value in sigma.components())))
    head = said_each("cause", "heading", "lateral m", "longitudinal m", "vertical m")
    return Table(head, tuple(rows), "llrrr", strong=frozenset({len(rows) - 1}))


def _measured(test: MissTest) -> list[Block]:
    names = said_each("lateral", "longitudinal", "vertical")
    facts = [
        (said("{name}: miss / sigma", name=name), plain(value, 2, sign=True))
        for name, value in zip(names, test.t, strict=True)
    ]
    facts.append((said("chi-square"), said("{chi2:.2f}, p = {p:.4f}", chi2=test.chi2, p=test.p)))
    facts.append((said("verdict"), term(test.verdict.replace("_", " "))))
    found: list[Block] = [KeyValues(tuple(facts))]
    if test.text:
        found.append(Paragraph(test.text))
    if test.candidates:
        rows = tuple(
            (
                joined(" ", (term(item.effect.replace("_", " ")), item.subject)),
                term(item.component),
                joined(" ", (f"{item.needed:+.4g}", term(item.unit))),
                plain(item.sigmas, 1),
            )
            for item in test.candidates
        )
        head = said_each("one cause alone", "component", "would be", "declared sigmas")
        found.append(Table(head, rows, "llrr"))
    shares = tuple(
        (
            share.heading,
            *(
                plain(x, 4, sign=True)
                for x in (share.lateral_m, share.longitudinal_m, share.vertical_m)
            ),
        )
        for share in test.distribution
    )
    if shares:
        found.append(
            Paragraph(said("The miss distributed by least squares: the ends move by"), "small")
        )
        found.append(Table(said_each("heading", "right m", "along m", "up m"), shares, "lrrr"))
    return found


def steps(result: Prediction) -> Table:
    """The six steps of the procedure with every entry that is recorded of them."""
    rows: list[tuple[str, ...]] = []
    for number, title in enumerate(STEP_TITLES, start=1):
        entries = [step for step in result.steps if step.id == number]
        if not entries:
            rows.append((joined(" ", (str(number), term(title))), said("open"), "", "", ""))
        for step in entries:
            readings = ", ".join(
                said("{name} {value:+.1f} mm", name=name, value=value)
                for name, value in (
                    (said("centre line"), step.centre_line_mm),
                    (said("waist line"), step.waist_line_mm),
                )
                if value is not None
            )
            note = "; ".join(part for part in (readings, step.note) if part)
            rows.append(
                (
                    joined(" ", (str(number), term(title))),
                    step.done_at or said("open"),
                    step.by,
                    step.file,
                    note,
                )
            )
    return Table(
        said_each("step", "done", "by", "file", "readings and notes"), tuple(rows), "lllll"
    )


def plan_figure(result: Prediction) -> Figure | None:
    """Plan of the headings with gyro sides, and the ellipse at the meeting point enlarged."""
    drawing = result.drawing
    if drawing is None:
        return None
    every = [place for route in drawing.routes for place in route]
    low = [min(p[i] for p in every) for i in (0, 1)]
    span = [max(max(p[i] for p in every) - low[i], 1e-3) for i in (0, 1)]
    scale = min((WIDTH_MM - 2 * MARGIN_MM) / span[0], (HEIGHT_MM - 2 * MARGIN_MM) / span[1])
    shift = [0.5 * (WIDTH_MM - span[0] * scale), 0.5 * (HEIGHT_MM - span[1] * scale)]

    def paper(place: tuple[float, float]) -> tuple[float, float]:
        return (
            shift[0] + (place[0] - low[0]) * scale,
            shift[1] + (place[1] - low[1]) * scale,
        )

    parts: list[Primitive] = []
    for route in drawing.routes:
        parts.append(Polyline(tuple(paper(place) for place in route), "axis"))
        parts += [Marker(paper(place), "dot") for place in route]
        parts.append(Marker(paper(route[0]), "square"))
    parts += [Line(paper(a), paper(b), "bar") for a, b in drawing.gyro]
    for name, route in zip(drawing.names, drawing.routes, strict=True):
        x, y = paper(route[0])
        parts.append(Label((x + 1.5, y + 1.8), name, "start"))
    meeting = paper(drawing.meeting)
    enlarged, curve = _ellipse(result, meeting, scale)
    parts.append(Polyline(curve, "data"))
    parts += _corridor(result, meeting, scale * enlarged)
    parts += _scale_bar(scale)
    title = said(
        "Plan, north up; thick: gyro sides; ellipse of {factor:g} sigma and the "
        "allowed lateral error {enlarged:g} times enlarged",
        factor=result.factor,
        enlarged=enlarged,
    )
    return Figure(title, WIDTH_MM, HEIGHT_MM, tuple(parts))


def _ellipse(
    result: Prediction, at: tuple[float, float], scale: float
) -> tuple[float, tuple[tuple[float, float], ...]]:
    ellipse = result.ellipse
    a, b = result.factor * ellipse.a_m, result.factor * ellipse.b_m
    enlarged = round_below(ELLIPSE_MM / (a * scale)) if a > 0.0 else 1.0
    curve = []
    for k in range(STEPS + 1):
        u = a * enlarged * scale * math.cos(math.tau * k / STEPS)
        w = b * enlarged * scale * math.sin(math.tau * k / STEPS)
        t = ellipse.azimuth
        curve.append(
            (
                at[0] + u * math.sin(t) + w * math.cos(t),
                at[1] + u * math.cos(t) - w * math.sin(t),
            )
        )
    return enlarged, tuple(curve)


def _corridor(result: Prediction, at: tuple[float, float], scale: float) -> list[Primitive]:
    """Lines along the axis at the allowed lateral distance."""
    drawing, tolerance = result.drawing, result.tolerance
    if drawing is None or tolerance is None or tolerance.lateral_m is None:
        return []
    sine, cosine = math.sin(drawing.axis_azimuth), math.cos(drawing.axis_azimuth)
    half = 12.0
    offset = min(tolerance.lateral_m * scale, 60.0)
    return [
        Line(
            (
                at[0] + sign * offset * cosine - half * sine,
                at[1] - sign * offset * sine - half * cosine,
            ),
            (
                at[0] + sign * offset * cosine + half * sine,
                at[1] - sign * offset * sine + half * cosine,
            ),
            "limit",
        )
        for sign in (1.0, -1.0)
    ]


def _scale_bar(scale: float) -> Sequence[Primitive]:
    length = round_below(40.0 / scale)
    end = 4.0 + length * scale
    ticks = [Line((x, 3.2), (x, 4.8), "axis") for x in (4.0, end)]
    return [
        Line((4.0, 4.0), (end, 4.0), "axis"),
        *ticks,
        Label((end + 1.5, 3.2), said("{length:g} m", length=length), "start"),
    ]
