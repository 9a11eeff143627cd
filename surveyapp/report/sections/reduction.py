"""The reduction of every session: each correction on its own line, with its origin, and plots."""

from __future__ import annotations

import math

from surveyapp.domain.project import OrientationSession, Project
from surveyapp.domain.results import (
    OrientationResult,
    SessionResult,
    TapeZeroResult,
    TargetResult,
)
from surveyapp.languages import joined, said, said_each, term
from surveyapp.report.blocks import Block, Heading, Paragraph, Table
from surveyapp.report.numbers import (
    NOTHING,
    direction,
    line_name,
    plain,
    seconds,
    signed_angle,
    with_sigma,
)
from surveyapp.report.sections import session_sensors
from surveyapp.report.sections.azimuths import STEPS
from surveyapp.report.sections.swing_plots import plots
from surveyapp_models.angles import AngleUnit, wrap_pi, wrap_two_pi

Row = tuple[str, str, str, str, str]


def blocks(project: Project, result: OrientationResult) -> tuple[Block, ...]:
    """All sessions, then the reduction of each."""
    found = [block for item in result.sessions for block in session_blocks(project, item)]
    return (*summary(project, result), *found)


SUMMARY = said_each("session", "method", "points", "gyro north", "azimuth", '±"', 'rms "')
"""Columns of ``summary``."""
SUMMARY_ALIGN = "llrrrrr"


def summary(project: Project, result: OrientationResult) -> tuple[Block, ...]:
    """Each session in one row, then each sight of a target in one row."""
    unit = project.angle_unit
    rows = tuple(summary_row(item, unit) for item in result.sessions)
    if not rows:
        return ()
    found: list[Block] = [Heading(said("Sessions")), Table(SUMMARY, rows, SUMMARY_ALIGN)]
    sights = tuple(
        (
            item.id,
            term(item.purpose),
            line_name(item.station, target.target),
            with_sigma(target.line_reading, unit)[0],
            *with_sigma(target.gyro_azimuth, unit)[:2],
        )
        for item in result.sessions
        for target in item.targets
    )
    if sights:
        head = said_each("session", "purpose", "line", "line reading", "gyro azimuth", '±"')
        found.append(Table(head, sights, "lllrrr"))
    return tuple(found)


def summary_row(item: SessionResult, unit: AngleUnit) -> tuple[str, ...]:
    """One session: what it was reduced from, gyro north, and the azimuth of its target."""
    azimuth = None if item.main is None else item.main.gyro_azimuth
    return (
        item.id,
        joined(", ", (term(item.method), term(item.estimator))),
        str(item.points_used),
        with_sigma(item.gyro_north, unit)[0],
        with_sigma(azimuth, unit)[0],
        with_sigma(azimuth or item.gyro_north, unit)[1],
        seconds(item.residual_rms, 1),
    )


def session_blocks(project: Project, item: SessionResult) -> tuple[Block, ...]:
    """The reduction of one session: every step, figures of merit, its points and warnings."""
    unit = project.angle_unit
    session = project.session(item.id)
    rows = [*_north(item, unit)]
    strong = {len(rows) - 1} if item.gyro_north is not None else set()
    for target in item.targets:
        rows += _target(session, target, unit)
        if target.gyro_azimuth is not None:
            strong.add(len(rows) - 1)
    line = line_name(item.station, item.target)
    found: list[Block] = [
        Heading(
            said("Session {id}: {line}, {method}", id=item.id, line=line, method=term(item.method)),
            2,
        ),
        Table(STEPS, tuple(rows), "lrrrl", strong=frozenset(strong)),
        *session_sensors.blocks(item, unit),
        *_effects(project, session),
        _figures_of_merit(item),
    ]
    found += _points(item, unit)
    found += [Paragraph(joined(": ", (w.code, w.text)), "warning") for w in item.warnings]
    return tuple(found)


def _north(item: SessionResult, unit: AngleUnit) -> list[Row]:
    north = item.gyro_north
    if north is None:
        return []
    rows: list[Row] = []
    how = said(
        "{estimator}, {points_used} points, {dof} degrees of freedom",
        estimator=term(item.estimator or ""),
        points_used=item.points_used,
        dof=item.dof,
    )
    correction = item.tape_zero_correction
    before = north.value - (correction or 0.0)
    scale = _scale_steps(item, before, unit, how)
    rows += scale
    if item.tape_zero is not None or scale:
        how = "" if scale else how
        rows.append(
            (said("= north as observed"), direction(wrap_two_pi(before), unit), "", "", how)
        )
    if item.tape_zero is not None:
        rows += _tape_zero(item.tape_zero, correction)
        how = ""
    origin = (
        said("sigma from {sigma_source}", sigma_source=term(item.sigma_source))
        if item.sigma_source
        else said("no sigma: nothing tells")
    )
    text = joined("; ", (how, origin)) if how else origin
    rows.append((said("= gyro north"), *with_sigma(north, unit), text))
    return rows


def _scale_steps(item: SessionResult, north: float, unit: AngleUnit, how: str) -> list[Row]:
    """Steps of a clamped swing: the alidade, and the middle of the swing on the scale."""
    known = {name: value for name, value, _ in item.quantities}
    if not {"clamp reading", "middle of the swing", "torsion ratio"} <= set(known):
        return []
    clamp = math.radians(known["clamp reading"])
    middle, ratio = known["middle of the swing"], known["torsion ratio"]
    shift = wrap_pi(north - clamp)
    return [
        (said("middle of the swing B"), said("{middle:+.4f} div", middle=middle), "", "", how),
        (said("clamped alidade"), direction(clamp, unit), "", "", said("circle reading")),
        (
            said("+ (1 + lambda) mu B"),
            signed_angle(shift),
            "",
            "",
            said("lambda {ratio:.4f} at this latitude, mu of the card", ratio=ratio),
        ),
    ]


def _tape_zero(zero: TapeZeroResult, correction: float | None) -> list[Row]:
    rows: list[Row] = []
    for name, value, means in (
        (said("before"), zero.before_div, zero.schuler_before_div),
        (said("after"), zero.after_div, zero.schuler_after_div),
    ):
        if value is not None:
            listing = ", ".join(plain(mean, 3, sign=True) for mean in means)
            origin = (
                said("Schuler means {listing} div", listing=listing)
                if means
                else said("rest reading")
            )
            rows.append(
                (
                    said("tape zero {name}", name=name),
                    said("{value:+.3f} div", value=value),
                    "",
                    "",
                    origin,
                )
            )
    how = {
        "time": said("interpolated in time to the middle of the run"),
        "mean": said("mean of before and after"),
        "single": said("the only one"),
    }.get(zero.interpolation, zero.interpolation)
    rows.append(
        (
            said("tape zero in force"),
            said("{value_div:+.3f} div", value_div=zero.value_div),
            "",
            "",
            how,
        )
    )
    if correction is None or zero.coefficient is None:
        text = said("the card tells neither lambda nor a coefficient: not applied")
        rows.append((said("+ tape-zero correction"), said("not known"), "", "", text))
    else:
        origin = said(
            '{coefficient}" per division ({coefficient_origin})',
            coefficient=seconds(zero.coefficient),
            coefficient_origin=zero.coefficient_origin,
        )
        rows.append((said("+ tape-zero correction"), signed_angle(correction), "", "", origin))
    return rows


def _target(session: OrientationSession, target: TargetResult, unit: AngleUnit) -> list[Row]:
    rows: list[Row] = []
    name = target.target or said("target")
    for place, value in ((said("before"), target.before), (said("after"), target.after)):
        if value is not None:
            origin = said("mean of the sights of {name}, as face left", name=name)
            rows.append(
                (said("sights {place}", place=place), direction(value, unit), "", "", origin)
            )
    if target.collimation is not None:
        origin = said("half of face left minus face right; cancels in the mean of both")
        rows.append((said("collimation"), signed_angle(target.collimation), "", "", origin))
    if target.drift is not None:
        origin = said("sights after minus before; taken out linearly in time")
        rows.append((said("turning of the tripod"), signed_angle(target.drift), "", "", origin))
    if target.eccentric_correction or session.eccentric is not None:
        shift = signed_angle(target.eccentric_correction)
        rows.append((said("+ eccentric set-up"), shift, "", "", _eccentric(session, unit)))
    if target.line_reading is not None:
        shown = with_sigma(target.line_reading, unit)
        rows.append(
            (
                said("= line reading"),
                *shown,
                said("{pointings} pointings of {name}", pointings=target.pointings, name=name),
            )
        )
    if target.gyro_azimuth is not None:
        origin = said("line reading - gyro north")
        if target.line_reading is None:
            origin = said("delivered by the instrument, mean of the rounds")
        rows.append(
            (
                said("= gyro azimuth to {name}", name=name),
                *with_sigma(target.gyro_azimuth, unit),
                origin,
            )
        )
    return rows


def _eccentric(session: OrientationSession, unit: AngleUnit) -> str:
    item = session.eccentric
    if item is None:
        return ""
    return said(
        "{at} {distance_m:.3f} m beside its mark, mark in direction {direction}",
        at=item.at,
        distance_m=item.distance_m,
        direction=direction(item.direction, unit),
    )


def _effects(project: Project, session: OrientationSession) -> list[Block]:
    effects = [*project.instrument(session.instrument).effects, *session.effects]
    if not effects:
        return []
    rows = tuple(
        (effect.id, name, f"{value:.4g}", f"{sigma:.2g}", unit, effect.adopted_at)
        for effect in effects
        for name, value, sigma, unit in (effect.coefficients or (("", 0.0, 0.0, ""),))
    )
    head = said_each("adopted effect", "coefficient", "value", "±", "unit", "adopted")
    return [Table(head, rows, "llrrll")]


def _figures_of_merit(item: SessionResult) -> Table:
    rows = [
        (said("points used"), str(item.points_used), ""),
        (said("degrees of freedom"), str(item.dof), ""),
        (said("rms of the residuals"), seconds(item.residual_rms), said("arcsec")),
        (said("95 % interval"), seconds(item.interval95), said("arcsec")),
        (said("amplitude, first point"), seconds(item.amplitude), said("arcsec")),
        (said("amplitude ratio of successive points"), plain(item.damping_per_half_swing, 5), ""),
        (said("period"), plain(item.period_s, 2), "s"),
    ]
    if item.reading_sigma is not None and item.method in ("tracking", "automatic"):
        rows.append((said("sigma of one reading"), seconds(item.reading_sigma), said("arcsec")))
    rows += [
        (term(name.replace("_", " ")), _quantity(value, unit), unit)
        for name, value, unit in item.quantities
    ]
    known = tuple(row for row in rows if row[1] != NOTHING)
    return Table(said_each("quantity", "value", "unit"), known, "lrl")


def _quantity(value: float, unit: str) -> str:
    """A further quantity: degrees to a hundredth of an arc-second, the rest to six digits."""
    return plain(value, 6) if unit == "deg" else f"{value:.6g}"


def _points(item: SessionResult, unit: AngleUnit) -> list[Block]:
    if not item.points:
        return []
    scale = item.method in ("amplitude", "transit")

    def value(reading: float | None) -> str:
        return plain(reading, 3) if scale else direction(reading, unit)

    rows = []
    for index, point in enumerate(item.points):
        schuler = ""
        if 1 <= index <= len(item.schuler_means):
            schuler = direction(item.schuler_means[index - 1], unit)
        residual = (
            plain(point.residual, 3, sign=True) if scale else seconds(point.residual, 1, sign=True)
        )
        rows.append(
            (
                str(point.index + 1),
                str(point.seq),
                point.side,
                plain(point.elapsed_s, 1) if point.elapsed_s is not None else "",
                value(point.observed),
                value(point.fitted),
                residual,
                schuler,
            )
        )
    columns = [
        said("point"),
        said("seq"),
        said("side"),
        said("elapsed s"),
        said("observed"),
        said("fitted"),
    ]
    columns += [said("residual div") if scale else said('residual "'), said("Schuler mean")]
    used = [i for i in range(len(columns)) if any(row[i] not in ("", NOTHING) for row in rows)]
    table = Table(
        tuple(columns[i] for i in used),
        tuple(tuple(row[i] for i in used) for row in rows),
        "".join("rrcrrrrr"[i] for i in used),
    )
    return [table, *plots(item)]
