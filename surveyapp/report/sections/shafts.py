"""Orientation through shafts in the record: azimuths, checks, swings, budget, plumbing."""

from __future__ import annotations

from surveyapp.domain.shaft import CHECK_IDS
from surveyapp.domain.shaft_result import ShaftOrientation, ShaftResult, SideAzimuth
from surveyapp.languages import joined, said, said_each, term
from surveyapp.report.blocks import Block, Heading, Paragraph, Table
from surveyapp.report.numbers import NOTHING, direction, plain
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit

MET = {True: said("yes"), False: said("NO"), None: NOTHING}


def blocks(result: ShaftResult, *, unit: AngleUnit) -> tuple[Block, ...]:
    """Blocks of every shaft."""
    found: list[Block] = []
    for shaft in result.shafts:
        found += [*orientation(shaft, unit), *wires(shaft), *budget(shaft), *plumbing(shaft)]
    return (*found, *warnings(result))


def orientation(shaft: ShaftOrientation, unit: AngleUnit) -> tuple[Block, ...]:
    """The azimuth by wires, by gyro and together, and what checks it."""
    found: list[Block] = [Heading(said("Shaft {id}", id=shaft.id)), _azimuths(shaft, unit)]
    if shaft.combined.consistent is False:
        text = said("Wires and gyro contradict each other: nothing is averaged.")
        found.append(Paragraph(text, "warning"))
    text = said(
        "The plumb lines converge by {convergence_mm:.2f} mm over the depth.",
        convergence_mm=shaft.convergence_mm,
    )
    checks = Heading(said("Checks of the shaft"), 2)
    return (*found, checks, _checks(shaft), Paragraph(text, "small"))


def wires(shaft: ShaftOrientation) -> tuple[Block, ...]:
    """Where each wire comes to rest."""
    return (Heading(said("Rest of the wires"), 2), _wires(shaft))


def budget(shaft: ShaftOrientation) -> tuple[Block, ...]:
    """What the error of one orientation is made of."""
    return (Heading(said("Error of one orientation through the shaft"), 2), _budget(shaft))


def plumbing(shaft: ShaftOrientation) -> tuple[Block, ...]:
    """The checks of the plumbing, open ones too."""
    return (Heading(said("Checks of the plumbing"), 2), _plumbing(shaft))


def warnings(result: ShaftResult) -> tuple[Block, ...]:
    """What must be told beside the numbers."""
    return tuple(Paragraph(joined(": ", (w.code, w.text)), "warning") for w in result.warnings)


def _azimuths(shaft: ShaftOrientation, unit: AngleUnit) -> Table:
    joint = shaft.combined
    chi = (
        NOTHING
        if joint.chi2 is None
        else said("{chi2:.2f} ({dof} dof)", chi2=joint.chi2, dof=joint.dof)
    )

    def row(name: str, value: SideAzimuth | None, note: str = "") -> tuple[str, ...]:
        if value is None:
            return name, NOTHING, NOTHING, note
        return name, direction(value.value, unit), plain(value.sigma * RHO_ARCSEC, 1), note

    rows = [row(said("wires"), shaft.azimuth), row(said("gyro"), shaft.gyro)]
    if shaft.gyro is not None:
        rows.append(row(said("together"), joint.azimuth, said("chi-square {chi}", chi=chi)))
    head = (
        said("{at} - {to} by", at=shaft.at, to=shaft.to),
        said("grid azimuth"),
        '\N{PLUS-MINUS SIGN}"',
        "",
    )
    return Table(head, tuple(rows), "lrrl", strong=frozenset({len(rows) - 1}))


def _checks(shaft: ShaftOrientation) -> Table:
    rows = [
        (
            said(
                "distance of the wires from {station}, {place}",
                station=item.station,
                place=term(item.place),
            ),
            f"{item.f_mm:+.2f}",
            f"{item.limit_mm:.2f}",
            MET[item.passed],
        )
        for item in shaft.triangles
    ]
    if shaft.scale is not None:
        scale = shaft.scale
        values = (f"{scale.misclosure_mm:+.2f}", f"{scale.limit_mm:.2f}", MET[scale.passed])
        rows.append((said("distance of the shafts, above against below"), *values))
    depth = shaft.depth
    rows.append(
        (
            said("depth {m:.4f} m by two determinations", m=depth.m),
            plain(depth.difference_mm, 2),
            f"{depth.limit_mm:.2f}",
            MET[depth.passed],
        )
    )
    return Table(said_each("check", "mm", "limit mm", "met"), tuple(rows), "lrrl")


def _wires(shaft: ShaftOrientation) -> Table:
    rows = tuple(
        (
            wire.name,
            plain(wire.x_mm, 3),
            plain(wire.sigma_x_mm, 3),
            plain(wire.y_mm, 3),
            plain(wire.sigma_y_mm, 3),
            plain(wire.period_s, 2),
        )
        for wire in shaft.wires
    )
    sign = "\N{PLUS-MINUS SIGN}"
    return Table(
        (said("wire"), said("x mm"), sign, said("y mm"), sign, said("period s")), rows, "lrrrrr"
    )


def _budget(shaft: ShaftOrientation) -> Table:
    rows = tuple(
        (
            term(line.source.replace("_", " ")),
            plain(line.sigma * RHO_ARCSEC, 2),
            f"{line.share:.0%}",
        )
        for line in shaft.budget
    )
    return Table(said_each("source", '±"', "share"), rows, "lrr")


def _plumbing(shaft: ShaftOrientation) -> Table:
    recorded = {check.id: check for check in shaft.checks}
    rows = []
    for name in CHECK_IDS:
        check = recorded.get(name)
        if check is None:
            rows.append((term(name.replace("_", " ")), said("open"), "", ""))
        else:
            done = check.done_at or said("open")
            rows.append((term(name.replace("_", " ")), done, check.by, check.note))
    return Table(said_each("check", "done", "by", "note"), tuple(rows), "llll")
