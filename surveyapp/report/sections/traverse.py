"""An adjusted traverse: closures, points, plan, observations with what controls them, tests."""

from __future__ import annotations

import math
from collections.abc import Sequence

from surveyapp.domain.adjustment import AdjustedObservation, AdjustmentResult, Closure, SharedValue
from surveyapp.domain.observations import ObservationKind
from surveyapp.languages import joined, said, said_each, term
from surveyapp.report.blocks import Block, Heading, KeyValues, Paragraph, Table
from surveyapp.report.numbers import NOTHING, direction, plain
from surveyapp.report.plan import plan_figure
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, wrap_two_pi

MM = 1e3
MOST_ROWS = 400
"""Rows of a table beyond which only the worst controlled and the suspects are shown."""


def blocks(
    name: str, result: AdjustmentResult, *, unit: AngleUnit, title: str = ""
) -> tuple[Block, ...]:
    """Blocks of one traverse or network.

    Parameters
    ----------
    name : str
    result : AdjustmentResult
    unit : AngleUnit
        Of the project, for directions.
    title : str
        Instead of ``Traverse NAME``.
    """
    plan = plan_figure(result)
    return (
        Heading(title or said("Traverse {name}", name=name)),
        facts(result),
        *closures(result),
        Heading(said("Points"), 2),
        points(result),
        *(() if plan is None else (plan,)),
        *shared(result, unit),
        Heading(said("Observations"), 2),
        *observations(result, unit),
        *suspicions(result),
        *(Paragraph(joined(": ", (w.code, w.text)), "warning") for w in result.warnings),
    )


def facts(result: AdjustmentResult) -> KeyValues:
    """Degrees of freedom, sigma0, the global test, and what data snooping accuses."""
    return KeyValues(_facts(result))


def closures(result: AdjustmentResult) -> tuple[Block, ...]:
    """Misclosures before the adjustment; none where no route closes."""
    plane = [item for item in result.closures if item.kind != "height"]
    heights = [item for item in result.closures if item.kind == "height"]
    found: list[Block] = []
    if plane:
        found += [Heading(said("Closures before the adjustment"), 2), _closures(plane)]
    if heights:
        found += [Heading(said("Height closures before the adjustment"), 2), _levelling(heights)]
    return tuple(found)


def suspicions(result: AdjustmentResult) -> tuple[Block, ...]:
    """What is suspected of a gross error, and the adjustment without it."""
    return (*_suspects(result), *_removals(result))


def _suspects(result: AdjustmentResult) -> tuple[Block, ...]:
    test = result.snooping
    if not test.suspects:
        return ()
    rows = tuple(
        (
            item.description,
            plain(item.standardized, 2, sign=True),
            plain(item.estimated_error * (RHO_ARCSEC if item.angular else MM), 1, sign=True),
            '"' if item.angular else said("mm"),
        )
        for item in test.suspects
    )
    text = said(
        "|v/sigma| above {critical}, level {level:g} for all {tests} tests "
        "together; only the first is accused.",
        critical=plain(test.critical, 2),
        level=test.level,
        tests=test.tests,
    )
    head = said_each("observation", "v/sigma", "error", "unit")
    return (
        Heading(said("Suspected of a gross error"), 2),
        Table(head, rows, "lrrl", strong=frozenset({0})),
        Paragraph(text, "small"),
    )


def _removals(result: AdjustmentResult) -> tuple[Block, ...]:
    """What the adjustment says without each of the most suspicious observations."""
    rows = tuple(
        (
            item.description,
            plain(item.sum_of_squares, 2),
            plain(item.ratio, 3),
            {True: said("met"), False: said("NOT MET"), None: NOTHING}[item.passed],
            str(item.suspects),
        )
        for item in result.removals
    )
    if not rows:
        return ()
    head = said_each("without", "v'Pv", "ratio", "global test", "suspects")
    title = said(
        "The adjustment without one observation or those of one cause, the best removal first"
    )
    return (Heading(title, 2), Table(head, rows, "lrrlr"))


def _facts(result: AdjustmentResult) -> tuple[tuple[str, str], ...]:
    test = result.global_test
    facts = [
        (said("observations"), str(len(result.observations))),
        (
            said("degrees of freedom"),
            said(
                "{dof} (rank defect {defect}, {iterations} iterations)",
                dof=result.dof,
                defect=result.defect,
                iterations=result.iterations,
            ),
        ),
        (
            said("sigma0"),
            said(
                "{sigma0} (a priori {sigma_apriori:g})",
                sigma0=plain(result.sigma0, 4),
                sigma_apriori=test.sigma_apriori,
            ),
        ),
        (
            said("sigmas in this section"),
            said("a priori") if result.sigma_scale == 1.0 else said("from residuals"),
        ),
    ]
    if test.ratio is not None:
        verdict = {True: said("met"), False: said("NOT MET"), None: said("open")}[test.passed]
        bounds = said(
            "{lower} to {upper} at {probability:.0%}",
            lower=plain(test.lower, 3),
            upper=plain(test.upper, 3),
            probability=test.probability,
        )
        facts.append(
            (
                said("global test"),
                said(
                    "sigma0 / a priori = {ratio:.3f}, {bounds}: {verdict}",
                    ratio=test.ratio,
                    bounds=bounds,
                    verdict=verdict,
                ),
            )
        )
        if test.sigma_dof is not None:
            text = said(
                "with {dof:.0f} degrees of freedom: bounds of an F test", dof=test.sigma_dof
            )
            facts.append((said("sigmas estimated"), text))
    else:
        facts.append((said("global test"), said("nothing controls this traverse")))
    return (*facts, *_snooping(result))


def _snooping(result: AdjustmentResult) -> list[tuple[str, str]]:
    """What data snooping accuses, if anything can be tested."""
    snoop = result.snooping
    if snoop.critical is None:
        return []
    worst = said("nothing is accused")
    if snoop.suspects:
        first = snoop.suspects[0]
        worst = said(
            "{description} stands off by {size:+.1f}{what}",
            description=first.description,
            size=first.estimated_error * (RHO_ARCSEC if first.angular else MM),
            what='"' if first.angular else " mm",
        )
    text = said(
        "limit {critical:.2f} ({tests} tests): {worst}",
        critical=snoop.critical,
        tests=snoop.tests,
        worst=worst,
    )
    return [(said("data snooping"), text)]


def _levelling(closures: Sequence[Closure]) -> Table:
    """Loops and lines of height differences: misclosure by length, against what is allowed."""
    rows = [
        (
            _route(item.stations),
            plain(None if item.length_m is None else item.length_m / 1000.0, 3),
            plain(None if item.height_m is None else item.height_m * MM, 2, sign=True),
            plain(item.height_per_sqrt_km, 2, sign=True),
            plain(None if item.height_allowed_m is None else item.height_allowed_m * MM, 2),
            {True: said("yes"), False: said("NO"), None: NOTHING}[item.passed],
        )
        for item in closures
    ]
    head = said_each("route", "km", "height mm", "mm per root km", "allowed mm", "3 sigma")
    return _filled(head, rows, "lrrrrl")


def _closures(closures: Sequence[Closure]) -> Table:
    rows = []
    for item in closures:
        relative = NOTHING
        if item.linear_m and item.length_m:
            relative = f"1 : {item.length_m / item.linear_m:.0f}"
        rows.append(
            (
                term(item.kind),
                _route(item.stations),
                plain(None if item.angular is None else item.angular * RHO_ARCSEC, sign=True),
                plain(None if item.angular_sigma is None else item.angular_sigma * RHO_ARCSEC),
                plain(None if item.linear_m is None else item.linear_m * MM),
                relative,
                {True: said("yes"), False: said("NO"), None: NOTHING}[item.passed],
            )
        )
    head = said_each("kind", "route", 'angles "', '±"', "place mm", "relative", "3 sigma")
    return _filled(head, rows, "llrrrrl")


def _filled(head: tuple[str, ...], rows: Sequence[tuple[str, ...]], align: str) -> Table:
    """A table without the columns in which nothing stands."""
    keep = [i for i in range(len(head)) if any(row[i] != NOTHING for row in rows)]
    return Table(
        tuple(head[i] for i in keep),
        tuple(tuple(row[i] for i in keep) for row in rows),
        "".join(align[i] for i in keep),
    )


def _route(stations: tuple[str, ...]) -> str:
    if len(stations) <= 6:
        return " - ".join(stations)
    return f"{' - '.join(stations[:3])} - ... ({len(stations)}) - {stations[-1]}"


def points(result: AdjustmentResult) -> Table:
    """Adjusted coordinates with their sigmas and standard ellipses."""
    rows = []
    for p in result.points:
        sigmas = [None if s is None else s * MM for s in (p.sigma_e, p.sigma_n, p.sigma_h)]
        shown = [said("fixed") if s == 0.0 else plain(s) for s in sigmas]
        ellipse = NOTHING
        if p.ellipse is not None:
            e = p.ellipse
            ellipse = said(
                "{a_m:.1f} x {b_m:.1f}, {azimuth:.0f}°",
                a_m=e.a_m * MM,
                b_m=e.b_m * MM,
                azimuth=math.degrees(e.azimuth),
            )
        values = [plain(x, 4) for x in (p.e, p.n, p.h)]
        rows.append((p.name, *values, *shown, ellipse))
    head = said_each("point", "E m", "N m", "H m", "± E mm", "± N mm", "± H mm", "ellipse mm")
    return _filled(head, rows, "lrrrrrrr")


def _of(item: SharedValue) -> str:
    """Whose it is: a set by its name, a constant by its instrument and how it is chosen."""
    if item.kind == "orientation":
        return item.name
    instrument, space, choice = item.name.rpartition(" ")
    return joined("", (instrument, space, term(choice)))


def shared(result: AdjustmentResult, unit: AngleUnit) -> tuple[Block, ...]:
    """Constants of instruments and orientations of sets; none where there are none."""
    rows = []
    for item in result.shared:
        value = (
            direction(wrap_two_pi(item.value), unit)
            if item.kind == "orientation"
            else f'{item.value * RHO_ARCSEC:+.1f}"'
        )
        rows.append(
            (term(item.kind.replace("_", " ")), _of(item), value, plain(item.sigma * RHO_ARCSEC))
        )
    if not rows:
        return ()
    table = Table(said_each("kind", "name", "value", '±"'), tuple(rows), "llrr")
    return (Heading(said("Constants and orientations"), 2), table)


OBSERVATIONS = said_each(
    "kind",
    "at",
    "to",
    "observed",
    "residual",
    "v / sigma",
    "redundancy",
    "smallest bias",
    "moves mm",
)
"""Columns of ``observation_table``."""


def observations(result: AdjustmentResult, unit: AngleUnit) -> tuple[Block, ...]:
    """The observations, of very many the worst, with what their columns mean."""
    shown, more = result.observations, 0
    if len(shown) > MOST_ROWS:
        more = len(shown) - MOST_ROWS
        order = sorted(shown, key=lambda o: -abs(o.standardized or 0.0))
        shown = tuple(order[:MOST_ROWS])
    found: list[Block] = [observation_table(result, unit, shown)]
    if more:
        text = said(
            "{more} observations with smaller residuals are not shown; adjust --json has all.",
            more=more,
        )
        found.append(Paragraph(text, "small"))
    text = said(
        "residual = adjusted - observed, arc-seconds or millimetres; redundancy: "
        "share of an error that shows in the residual; smallest bias: what the "
        "test finds with the stated power, and how far an undetected one moves a "
        "point. The accused observation is bold."
    )
    return (*found, Paragraph(text, "small"))


def observation_table(
    result: AdjustmentResult, unit: AngleUnit, shown: Sequence[AdjustedObservation]
) -> Table:
    """A row an observation, the accused one strong."""
    accused = {item.place for item in result.snooping.suspects[:1]}
    rows = tuple(_observation(item, unit) for item in shown)
    strong = frozenset(i for i, item in enumerate(shown) if item.place in accused)
    return Table(OBSERVATIONS, rows, "lllrrrrrr", strong=strong)


def _observation(item: AdjustedObservation, unit: AngleUnit) -> tuple[str, ...]:
    small = RHO_ARCSEC if item.angular else MM
    what = '"' if item.angular else said(" mm")
    if not item.angular:
        observed = said("{observed:.4f} m", observed=item.observed)
    elif item.kind is ObservationKind.GYRO_CONSTANT:
        observed = f'{item.observed * RHO_ARCSEC:+.1f}"'
    else:
        observed = direction(wrap_two_pi(item.observed), unit)
    to = f"{item.back} - {item.to}" if item.back else item.to
    bias = NOTHING if item.mdb is None else f"{item.mdb * small:.1f}{what}"
    return (
        term(str(item.kind).replace("_", " ")),
        item.at,
        to,
        observed,
        f"{item.residual * small:+.1f}{what}",
        plain(item.standardized, 2, sign=True),
        f"{item.redundancy:.2f}",
        bias,
        plain(None if item.mdb_effect_m is None else item.mdb_effect_m * MM),
    )
