"""``surveyapp adjust``: a traverse or a .gkf network to coordinates, sigmas and tests."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from surveyapp.cli.output import heading, number, print_json, table
from surveyapp.domain.adjustment import AdjustedObservation, AdjustmentResult
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle

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

    network = api.network(options.source, traverse=options.traverse)
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
        print(adjustment_text(result, Path(options.source).name))
        for text in (_compass(compass), _components(components), _snooped(snooped)):
            if text:
                print(f"\n{text}")
    return 1 if result.global_test.passed is False or result.left_out else 0


def _snooped(found: SnoopingResult | None) -> str:
    """What data snooping took out, and the adjustment without it."""
    if found is None:
        return ""
    if not found.removed:
        return "Data snooping: nothing is taken out"
    names = "; ".join(item.description for item in found.removed)
    head = f"Data snooping takes out, in this order: {names}"
    return f"{head}\n\n{adjustment_text(found.adjustment, 'without them')}"


def _compass(items: Sequence[CompassResult]) -> str:
    """Coordinates by the compass rule, with what was distributed."""
    parts = []
    for item in items:
        rows = [
            [name, number(e, 4), number(n, 4)]
            for name, e, n in zip(item.stations, item.e, item.n, strict=True)
        ]
        angular = number(None if item.angular is None else item.angular * RHO_ARCSEC)
        gap = f"{_mm(item.misclosure_e)} {_mm(item.misclosure_n)} mm on {item.length_m:.1f} m"
        parts.append(
            f'Compass rule, no sigmas: {angular}" and {gap} distributed\n'
            + table(["station", "e", "n"], rows)
        )
    return "\n\n".join(parts)


def _components(items: Sequence[VarianceComponent]) -> str:
    """Factor of the stated sigmas of each kind."""
    rows = [
        [
            item.group,
            number(item.factor, 3),
            number(item.sigma, 3),
            number(item.redundancy, 1),
            str(item.observations),
            "goes to zero: stated sigmas kept" if item.vanishing else "",
        ]
        for item in items
    ]
    head = ["group", "factor", "±", "redundancy", "observations", ""]
    return "Variance components: factors of the stated sigmas\n" + table(head, rows) if rows else ""


def adjustment_text(result: AdjustmentResult, name: str) -> str:
    """The whole result as readable tables."""
    parts = [
        heading(f"{name}: adjustment"),
        _summary(result),
        _points(result),
        _shared(result),
        _observations(result),
        _closures(result),
        _suspects(result),
        _removals(result),
        _warnings(result),
    ]
    return "\n\n".join(part for part in parts if part)


def _summary(result: AdjustmentResult) -> str:
    test = result.global_test
    verdict = {True: "met", False: "NOT MET", None: "open (no degrees of freedom)"}[test.passed]
    lines = [
        f"  degrees of freedom  {result.dof} (rank defect {result.defect}, "
        f"{result.iterations} iterations)",
        f"  sigma0              {number(result.sigma0, 4)} (a priori {test.sigma_apriori:g})",
        f"  global test         {verdict}: ratio {number(test.ratio, 3)} within "
        f"{number(test.lower, 3)} .. {number(test.upper, 3)}",
    ]
    return "\n".join(lines)


def _mm(value: float | None) -> str:
    return number(None if value is None else value * 1000.0, 2)


def _points(result: AdjustmentResult) -> str:
    rows = []
    for point in result.points:
        ellipse = point.ellipse
        axes = ["-", "-", "-"]
        if ellipse is not None:
            axes = [_mm(ellipse.a_m), _mm(ellipse.b_m), number(math.degrees(ellipse.azimuth), 1)]
        sigmas = [_mm(value) for value in (point.sigma_e, point.sigma_n, point.sigma_h)]
        place = [number(value, 4) for value in (point.e, point.n, point.h)]
        rows.append([point.name, *place, *sigmas, *axes])
    head = ["point", "e", "n", "h", "±e mm", "±n", "±h", "a mm", "b mm", "azimuth"]
    return "Points\n" + table(head, rows)


def _shared(result: AdjustmentResult) -> str:
    rows = [
        [item.name, number(item.value * RHO_ARCSEC, 2, sign=True), number(item.sigma * RHO_ARCSEC)]
        for item in result.shared
        if item.kind == "gyro_constant"
    ]
    return "Gyro constants\n" + table(["instrument", 'constant "', '±"'], rows) if rows else ""


def _values(item: AdjustedObservation) -> list[str]:
    if item.angular:
        shown = [format_angle(value, AngleUnit.DMS) for value in (item.observed, item.adjusted)]
        small = RHO_ARCSEC
    else:
        shown = [number(value, 4) for value in (item.observed, item.adjusted)]
        small = 1000.0
    mdb = None if item.mdb is None else item.mdb * small
    return [
        *shown,
        number(item.residual * small, 2, sign=True),
        number(item.standardized, 2, sign=True),
        number(item.redundancy, 2),
        number(mdb, 1),
    ]


def _observations(result: AdjustmentResult) -> str:
    rows = [
        [str(item.kind), "-".join(x for x in (item.back, item.at, item.to) if x), *_values(item)]
        for item in result.observations
    ]
    head = ["kind", "sight", "observed", "adjusted", 'v "|mm', "v/sigma", "r", 'mdb "|mm']
    return "Observations\n" + table(head, rows)


def _closures(result: AdjustmentResult) -> str:
    rows = []
    for item in result.closures:
        values = item.to_dict()
        arc, one_in = values["angular_arcsec"], values["relative_1_in"]
        rows.append(
            [
                item.kind,
                _route(item.stations),
                number(arc if isinstance(arc, float) else None, 1, sign=True),
                str(item.angles),
                number(item.linear_m, 4),
                f"1:{one_in:.0f}" if isinstance(one_in, float) else "-",
                number(item.height_m, 4, sign=True),
                {True: "met", False: "NOT MET", None: "-"}[item.passed],
            ]
        )
    head = ["closure", "route", 'angular "', "n", "linear m", "relative", "height m", "3 sigma"]
    return "Closures before the adjustment\n" + table(head, rows) if rows else ""


def _route(stations: tuple[str, ...]) -> str:
    if len(stations) <= 6:
        return "-".join(stations)
    return f"{'-'.join(stations[:3])}-...-{'-'.join(stations[-2:])}"


def _suspects(result: AdjustmentResult) -> str:
    test = result.snooping
    if not test.suspects:
        return ""
    rows = [
        [
            item.description,
            number(item.standardized, 2, sign=True),
            number(item.estimated_error * (RHO_ARCSEC if item.angular else 1000.0), 1, sign=True),
            '"' if item.angular else "mm",
        ]
        for item in test.suspects
    ]
    head = ["observation", "v/sigma", "error", "unit"]
    title = (
        f"Suspected of a gross error (|v/sigma| above {number(test.critical, 2)}, level "
        f"{test.level:g} for all {test.tests} tests together; only the first is accused)\n"
    )
    return title + table(head, rows)


def _removals(result: AdjustmentResult) -> str:
    """What the adjustment says without each of the most suspicious observations."""
    rows = [
        [
            item.description,
            number(item.sum_of_squares, 2),
            number(item.ratio, 3),
            {True: "met", False: "NOT MET", None: "-"}[item.passed],
            str(item.suspects),
        ]
        for item in result.removals
    ]
    head = ["without", "v'Pv", "ratio", "global test", "suspects"]
    title = "The adjustment without one observation, the removal that helps most first\n"
    return title + table(head, rows) if rows else ""


def _warnings(result: AdjustmentResult) -> str:
    if not result.warnings:
        return ""
    return "Warnings\n" + "\n".join(f"  {item.code}: {item.text}" for item in result.warnings)
