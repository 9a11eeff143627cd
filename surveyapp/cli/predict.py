"""``surveyapp predict``: how far two headings will miss each other, and what would help."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from surveyapp.cli.output import heading, number, paragraph, print_json, table
from surveyapp.domain.penetration_result import Prediction


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("project", metavar="DIR", help="project folder")
    parser.add_argument(
        "--plan", metavar="K", type=int, help="place K further gyro sides, and what else helps"
    )
    parser.add_argument(
        "--cluster", metavar="ADDRESS", help="simulate on the cluster at this address"
    )
    parser.add_argument(
        "--done", metavar="STEP", type=int, help="record first that this step (1 to 6) is done"
    )
    parser.add_argument("--by", metavar="NAME", default="", help="who has done the step")
    parser.add_argument("--file", metavar="FILE", default="", help="with which file of the project")
    parser.add_argument("--note", metavar="TEXT", default="", help="anything else about the step")
    parser.add_argument(
        "--centre-line", metavar="MM", type=float, help="reading of step 5, + right"
    )
    parser.add_argument("--waist-line", metavar="MM", type=float, help="reading of step 5, + high")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Predict and print; 1 if a confirmed tolerance is not met."""
    from surveyapp import api

    if options.done is not None:
        api.record_step(
            options.project,
            options.done,
            by=options.by,
            file=options.file,
            note=options.note,
            centre_line_mm=options.centre_line,
            waist_line_mm=options.waist_line,
        )
    with api.cluster_executor(options.cluster) as executor:
        result = api.predict(options.project, plan=options.plan, executor=executor)
    if options.json:
        print_json(result.to_dict())
    else:
        print(prediction_text(result, Path(options.project).name))
    return 1 if result.failed_confirmed else 0


def prediction_text(result: Prediction, name: str) -> str:
    """The whole result as readable tables."""
    parts = [
        heading(f"{name}: prediction at the meeting point"),
        _verdict(result),
        _routes(result),
        _budget(result),
        _plan(result),
        _measures(result),
        _measured(result),
        _steps(result),
        _warnings(result),
    ]
    return "\n\n".join(part for part in parts if part)


def _verdict(result: Prediction) -> str:
    allowed = (None, None, None) if result.tolerance is None else result.tolerance.components()
    rows = [
        [
            label,
            number(sigma, 4),
            number(None if sigma is None else result.factor * sigma, 4),
            number(limit, 4),
            _met(None if sigma is None else result.factor * sigma, limit),
        ]
        for label, sigma, limit in zip(
            ("lateral", "longitudinal", "vertical"),
            result.sigma.components(),
            allowed,
            strict=True,
        )
    ]
    head = ["component", "1 sigma m", f"x {result.factor:g} m", "allowed m", ""]
    text = table(head, rows)
    if result.tolerance is not None:
        sure = "" if result.tolerance.confirmed else " (not confirmed)"
        text += f"\n  allowed by: {result.tolerance.source}{sure}"
    return text + f"\n  factor {result.factor:g} from: {result.factor_source}"


def _met(value: float | None, limit: float | None) -> str:
    if limit is None:
        return ""
    if value is None:
        return "not determined"
    return "met" if value <= limit * (1.0 + 1e-12) else "NOT MET"


def _routes(result: Prediction) -> str:
    sections = result.sectioned
    rows = [
        ["covariance", *(number(x, 4) for x in result.sigma.components())],
        ["sectioned formula", number(sections.lateral_m, 4), "", ""],
    ]
    if result.simulated is not None:
        label = f"{result.simulated.runs} simulated surveys"
        rows.append([label, *(number(x, 4) for x in result.simulated.sigma.components())])
    text = "Three routes to 1 sigma\n" + table(
        ["route", "lateral", "longitudinal", "vertical"], rows
    )
    if not sections.valid:
        text += "\n" + paragraph(f"the sectioned formula does not hold here: {sections.why}")
    ellipse = result.ellipse
    return text + (
        f"\n  ellipse at the meeting point {ellipse.a_m:.4f} x {ellipse.b_m:.4f} m, "
        f"{math.degrees(ellipse.azimuth):.1f} degrees"
    )


def _budget(result: Prediction) -> str:
    rows = [
        [
            row.source.replace("_", " "),
            row.heading or "common",
            number(row.lateral_m, 4),
            number(row.longitudinal_m, 4),
            number(row.vertical_m, 4),
        ]
        for row in result.budget
    ]
    head = ["cause", "heading", "lateral m", "longitudinal m", "vertical m"]
    return "Budget, 1 sigma (adds in squares)\n" + table(head, rows)


def _plan(result: Prediction) -> str:
    plan = result.plan
    if not plan.placements and plan.least is None and not plan.why:
        return ""
    rows = [
        [
            ", ".join(f"{side.at}-{side.to}" for side in item.added),
            number(item.lateral_m, 4),
            number(item.gain_m, 4),
            item.method,
        ]
        for item in plan.placements
    ]
    text = "Further gyro sides\n" + table(["sides", "lateral m", "gain m", "found by"], rows)
    if plan.least is not None:
        text += (
            f"\n  fewest that meet the tolerance: {plan.least.sides} "
            f"(lateral {plan.least.lateral_m:.4f} m)"
        )
    elif plan.why:
        text += "\n" + paragraph(plan.why)
    return text


def _measures(result: Prediction) -> str:
    rows = [
        [item.text, number(item.lateral_m, 4), number(item.gain_m, 4), str(item.sides_observed)]
        for item in result.plan.measures
    ]
    head = ["measure", "lateral m", "gain m", "sides"]
    return "What else would help\n" + table(head, rows) if rows else ""


def _measured(result: Prediction) -> str:
    test = result.measured
    if test is None:
        return ""
    t = " ".join(
        f"{label} {number(value, 2, sign=True)}"
        for label, value in zip(("lateral", "longitudinal", "vertical"), test.t, strict=True)
    )
    lines = [
        "After the breakthrough",
        f"  miss / sigma: {t}",
        f"  chi-square {test.chi2:.2f}, p {test.p:.4f}: {test.verdict.replace('_', ' ')}",
    ]
    if test.text:
        lines.append(paragraph(test.text))
    lines += [
        f"  residuals of traverse {item.traverse}: {item.verdict.replace('_', ' ')}"
        + (f" ({', '.join(item.effects)})" if item.effects else "")
        for item in test.residuals
    ]
    rows = [
        [
            f"{item.effect.replace('_', ' ')} {item.subject}".strip(),
            item.component,
            f"{item.needed:+.4g}",
            item.unit,
            number(item.sigmas, 1),
        ]
        for item in test.candidates
    ]
    if rows:
        head = ["one cause alone", "component", "would be", "unit", "in declared sigmas"]
        lines.append(table(head, rows))
    return "\n".join(lines)


def _steps(result: Prediction) -> str:
    from surveyapp.domain.penetration import STEP_TITLES

    rows = []
    for number_, title in enumerate(STEP_TITLES, start=1):
        entries = [step for step in result.steps if step.id == number_ and step.done_at]
        last = entries[-1] if entries else None
        rows.append(
            [
                f"{title} ({len(entries)} times)" if len(entries) > 1 else title,
                "open" if last is None else last.done_at,
                "" if last is None else last.by,
                "" if last is None else last.file,
            ]
        )
    return "The six steps\n" + table(["step", "done", "by", "file"], rows)


def _warnings(result: Prediction) -> str:
    if not result.warnings:
        return ""
    return "Warnings\n" + "\n".join(paragraph(f"{w.code}: {w.text}") for w in result.warnings)
