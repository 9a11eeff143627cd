"""``surveyapp shaft``: orientation through one shaft or two, checked, and joined with the gyro."""

from __future__ import annotations

import argparse
from pathlib import Path

from surveyapp.cli.output import heading, number, paragraph, print_json, table
from surveyapp.domain.shaft_result import ShaftOrientation, ShaftResult, SideAzimuth
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("project", metavar="DIR", help="project folder")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Orient and print; 1 if a check of a shaft is not met."""
    from surveyapp import api

    result = api.shaft(options.project)
    if options.json:
        print_json(result.to_dict())
    else:
        print(shaft_text(result, Path(options.project).name))
    return 0 if result.passed else 1


def shaft_text(result: ShaftResult, name: str) -> str:
    """The whole result as readable tables."""
    parts = [heading(f"{name}: orientation through shafts")]
    parts += [_one(shaft) for shaft in result.shafts]
    if result.warnings:
        lines = [paragraph(f"{w.code}: {w.text}") for w in result.warnings]
        parts.append("Warnings\n" + "\n".join(lines))
    return "\n\n".join(parts)


def _azimuth(value: SideAzimuth | None) -> list[str]:
    if value is None:
        return ["-", "-"]
    return [format_angle(value.value, AngleUnit.DMS), number(value.sigma * RHO_ARCSEC, 1)]


def _met(passed: bool | None) -> str:
    return {True: "met", False: "NOT MET", None: "-"}[passed]


def _one(shaft: ShaftOrientation) -> str:
    joint = shaft.combined
    rows = [["wires", *_azimuth(shaft.azimuth)], ["gyro", *_azimuth(shaft.gyro)]]
    if shaft.gyro is not None:
        rows.append(["together", *_azimuth(joint.azimuth)])
    parts = [
        f"Shaft {shaft.id} ({shaft.kind}): azimuth of {shaft.at}-{shaft.to}\n"
        + table(["by", "azimuth", '±"'], rows)
    ]
    if joint.consistent is False:
        parts.append(
            paragraph(
                f"wires and gyro contradict each other (chi-square {number(joint.chi2, 2)}, "
                f"{joint.dof} degrees of freedom): nothing is averaged"
            )
        )
    parts += [_checks(shaft), _wires(shaft), _budget(shaft), _plumbing(shaft)]
    return "\n\n".join(part for part in parts if part)


def _checks(shaft: ShaftOrientation) -> str:
    rows = [
        [
            f"triangle at {item.station}, {item.place}",
            f"{item.f_mm:+.2f}",
            f"{item.limit_mm:.2f}",
            _met(item.passed),
        ]
        for item in shaft.triangles
    ]
    if shaft.scale is not None:
        scale = shaft.scale
        row = ["distance of the shafts", f"{scale.misclosure_mm:+.2f}", f"{scale.limit_mm:.2f}"]
        rows.append([*row, _met(scale.passed)])
    depth = shaft.depth
    rows.append(
        [
            f"depth {depth.m:.4f} m, two determinations",
            number(depth.difference_mm, 2),
            f"{depth.limit_mm:.2f}",
            _met(depth.passed),
        ]
    )
    text = "Checks\n" + table(["check", "mm", "limit mm", ""], rows)
    return text + f"\n  the wires converge by {shaft.convergence_mm:.2f} mm"


def _wires(shaft: ShaftOrientation) -> str:
    rows = [
        [
            wire.name,
            number(wire.x_mm, 3),
            number(wire.sigma_x_mm, 3),
            number(wire.y_mm, 3),
            number(wire.sigma_y_mm, 3),
            number(wire.period_s, 2),
        ]
        for wire in shaft.wires
    ]
    return "Rest of the wires\n" + table(["wire", "x mm", "±", "y mm", "±", "period s"], rows)


def _budget(shaft: ShaftOrientation) -> str:
    rows = [
        [line.source.replace("_", " "), number(line.sigma * RHO_ARCSEC, 2), f"{line.share:.0%}"]
        for line in shaft.budget
    ]
    return "Budget of the azimuth by the wires\n" + table(["source", '±"', "share"], rows)


def _plumbing(shaft: ShaftOrientation) -> str:
    from surveyapp.domain.shaft import CHECK_IDS

    recorded = {check.id: check for check in shaft.checks}
    rows = []
    for name in CHECK_IDS:
        check = recorded.get(name)
        done = "open" if check is None or not check.done_at else check.done_at
        rows.append([name.replace("_", " "), done, "" if check is None else check.by])
    return "Checks of the plumbing\n" + table(["check", "done", "by"], rows)
