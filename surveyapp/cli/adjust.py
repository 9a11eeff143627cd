"""``surveyapp adjust``: a traverse or a .gkf network to coordinates, sigmas and tests."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.cli.output import WIDTH, number, print_json, table
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.languages import joined, said, said_each, shown, term
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit

if TYPE_CHECKING:
    from surveyapp.core.network.bowditch import CompassResult
    from surveyapp.core.network.snooping import SnoopingResult
    from surveyapp.core.network.variance_components import VarianceComponent


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("source", metavar="DIR|FILE.gkf", help="project folder or GNU Gama file")
    parser.add_argument("--traverse", metavar="NAME", help="one traverse; all together without it")
    parser.add_argument(
        "--compass-rule", action="store_true", help="the compass (Bowditch) rule beside it"
    )
    parser.add_argument(
        "--components", action="store_true", help="variance components of the kinds (Helmert)"
    )
    parser.add_argument(
        "--snoop",
        action="store_true",
        help="take gross errors out one after another, and adjust without them",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(options: argparse.Namespace) -> int:
    """Adjust and print; 1 if the global test is not met."""
    from surveyapp import api

    path = Path(options.source)
    project = None if path.is_file() else api.open_project(path)
    network = api.network(path if project is None else project, traverse=options.traverse)
    result = api.adjust_network(network)
    compass = tuple(api.compass_rule(network)) if options.compass_rule else ()
    components = tuple(api.variance_components(network)) if options.components else ()
    snooped = api.data_snooping(network) if options.snoop else None
    if options.json:
        document = result.to_dict()
        document["snooped"] = None if snooped is None else snooped.to_dict()
        document["compass_rule"] = [item.to_dict() for item in compass]
        document["variance_components"] = [item.to_dict() for item in components]
        print_json(document)
    else:
        unit = AngleUnit.DMS if project is None else project.angle_unit
        print(adjustment_text(result, Path(options.source).name, unit))
        for text in (_compass(compass), _components(components), _snooped(snooped, unit)):
            if text:
                print(f"\n{text}")
    return 1 if result.global_test.passed is False or result.left_out else 0


def _snooped(found: SnoopingResult | None, unit: AngleUnit) -> str:
    """What data snooping took out, and the adjustment without it."""
    if found is None:
        return ""
    if not found.removed:
        return shown(said("Data snooping: nothing is taken out"))
    names = joined("; ", [item.description for item in found.removed])
    head = shown(said("Data snooping takes out, in this order: {names}", names=names))
    text = adjustment_text(found.adjustment, said("without them"), unit)
    return f"{head}\n\n{text}"


def _compass(items: Sequence[CompassResult]) -> str:
    """Coordinates by the compass rule, with what was distributed."""
    parts = []
    for item in items:
        rows = [
            [name, number(e, 4), number(n, 4)]
            for name, e, n in zip(item.stations, item.e, item.n, strict=True)
        ]
        angular = number(None if item.angular is None else item.angular * RHO_ARCSEC)
        gap = f"{_mm(item.misclosure_e)} {_mm(item.misclosure_n)}"
        head = said(
            'Compass rule, no sigmas: {angular}" and {gap} mm on {length:.1f} m distributed',
            angular=angular,
            gap=gap,
            length=item.length_m,
        )
        columns = said_each("station", "e", "n")
        parts.append(f"{shown(head)}\n{table(columns, rows)}")
    return "\n\n".join(parts)


def _components(items: Sequence[VarianceComponent]) -> str:
    """Factor of the stated sigmas of each kind."""
    rows = [
        [
            term(item.group),
            number(item.factor, 3),
            number(item.sigma, 3),
            number(item.redundancy, 1),
            str(item.observations),
            said("goes to zero: stated sigmas kept") if item.vanishing else "",
        ]
        for item in items
    ]
    if not rows:
        return ""
    columns = (*said_each("group", "factor", "±", "redundancy", "observations"), "")
    head = shown(said("Variance components: factors of the stated sigmas"))
    return f"{head}\n{table(columns, rows)}"


def adjustment_text(result: AdjustmentResult, name: str, unit: AngleUnit) -> str:
    """The whole result: the blocks of the record without its plan."""
    from surveyapp.report.blocks import Figure
    from surveyapp.report.sections import traverse as section
    from surveyapp.report.text import blocks_text

    made = section.blocks(name, result, unit=unit, title=said("{name}: adjustment", name=name))
    return blocks_text((block for block in made if not isinstance(block, Figure)), WIDTH)


def _mm(value: float | None) -> str:
    return number(None if value is None else value * 1000.0, 2)
