"""``[penetration]`` of project.toml: read strictly, every problem noted, nothing raised.

What a value may be is judged here; whether the whole makes a mine that can be predicted (routes,
orientation, meeting point) in ``surveyapp.core.penetration.refusals``.
"""

from __future__ import annotations

import datetime as dt
import math
from collections.abc import Mapping, Sequence
from typing import Final, Literal, cast

from surveyapp.domain.instrument import Instrument
from surveyapp.domain.penetration import (
    AssumedSigmas,
    DeflectionField,
    ExcavationCase,
    GyroSide,
    Heading,
    HeadingStart,
    HeightMethod,
    MeasuredMiss,
    MeetingPoint,
    MonteCarloPlan,
    Penetration,
    PenetrationTable,
    ProcedureStep,
    StatedTolerance,
    TunnelCase,
    Wall,
    WallRefraction,
)
from surveyapp.errors import Problem, nearest_names
from surveyapp.io.findings import Findings, told_once
from surveyapp.io.tables import Table, as_number
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, TWO_PI, AngleUnit

MM: Final = 1e-3
WALLS: Final = ("right", "left", "none")
MOST_ARCSEC: Final = 3.6e5
COMPONENTS: Final = ("lateral_m", "longitudinal_m", "vertical_m")


WHERE: Final = "project.toml, [penetration]"


def read_penetration_table(
    top: Table, instruments: Sequence[Instrument], unit: AngleUnit
) -> PenetrationTable | None:
    """``[penetration]`` of a project.toml with its problems; None where there is none."""
    raw = top.get("penetration")
    if raw is None:
        return None
    findings = Findings()
    if not isinstance(raw, Mapping):
        findings.problems.append(Problem("penetration is no table", WHERE, "", "[penetration]"))
        raw = {}
    plan = read_penetration(Table(raw, WHERE, findings), instruments, unit)
    return PenetrationTable(plan, tuple(told_once(findings.problems)), findings.told())


def read_penetration(
    table: Table, instruments: Sequence[Instrument], unit: AngleUnit
) -> Penetration:
    """Read the table; a value that is wrong is noted and replaced, so that reading goes on."""
    case = table.choice("case", [str(c) for c in ExcavationCase], required=True)
    tunnel = table.choice("tunnel", [str(c) for c in TunnelCase], required=True)
    headings = tuple(_heading(item) for item in table.tables("heading"))
    found = Penetration(
        case=ExcavationCase(case or "opposite"),
        tunnel=TunnelCase(tunnel or "within_mine"),
        meeting=_meeting(table),
        axis_azimuth=axis(table, "axis_azimuth", unit),
        headings=headings,
        gyro=_gyro_sides(table, instruments),
        sigmas=_sigmas(table),
        independent_surveys=_surveys(table),
        factor=table.number("factor", high=100.0, positive=True),
        axis_across=table.boolean("axis_across"),
        height=_height(table),
        tolerance=_tolerance(table),
        monte_carlo=_monte_carlo(table),
        refraction=_refraction(table),
        deflection=_deflection(table),
        measured=_measured(table),
        steps=tuple(_step(item) for item in table.tables("step")),
    )
    table.get("note")
    table.get("traverses")
    table.warn_unknown()
    return found


def axis(table: Table, key: str, unit: AngleUnit) -> float:
    """Direction [rad]: text in the project's unit, a number in decimal degrees."""
    if key not in table:
        table.problem(
            said("{key} is missing", key=key),
            "",
            said('{key} = "..." or a number in decimal degrees', key=key),
        )
        return 0.0
    number = as_number(table.get(key))
    if number is None:
        return table.angle(key, unit) or 0.0
    if not -360.0 <= number <= 360.0:
        table.problem(said("{key} is out of range", key=key), number, "0 to 360 degrees")
    return math.radians(number) % TWO_PI


def _meeting(table: Table) -> MeetingPoint:
    inner = table.table("meeting")
    if inner is None:
        if "meeting" not in table:
            table.problem("meeting is missing", "", "meeting = { e = ..., n = ..., h = ... }")
        return MeetingPoint(0.0, 0.0)
    e, n = (inner.number(key, low=-1e8, high=1e8, required=True) for key in ("e", "n"))
    h = inner.number("h", low=-12000.0, high=12000.0)
    inner.warn_unknown()
    return MeetingPoint(e or 0.0, n or 0.0, h)


def _heading(table: Table) -> Heading:
    names = texts(table, "route")
    if names is None and "route" not in table:
        table.problem("route is missing", "", 'route = ["S1", "P1", ...]')
    wall = texts(table, "wall")
    for entry in dict.fromkeys(wall or ()):
        if entry not in WALLS:
            table.problem(
                "wall is not known", entry, " | ".join(WALLS), nearest_names(entry, WALLS)
            )
    heading = Heading(
        name=table.text("name", required=True) or "",
        route=tuple(names or ()),
        traverse=table.text("traverse") or "",
        wall=tuple(cast("Wall", w if w in WALLS else "none") for w in wall or ()),
        start=_start(table),
        height_transfer_m=table.number("height_transfer_m", low=0.0, high=12000.0),
        shaft=table.text("shaft") or "",
    )
    table.get("note")
    table.warn_unknown()
    return heading


def texts(table: Table, key: str) -> list[str] | None:
    """List of texts, None where absent or wrong."""
    value = table.get(key)
    if value is None:
        return None
    if not isinstance(value, list) or not all(isinstance(item, str) and item for item in value):
        table.problem(said("{key} is no list of texts", key=key), value, f'{key} = ["...", "..."]')
        return None
    return [str(item) for item in value]


def _start(heading: Table) -> HeadingStart:
    table = heading.table("start")
    if table is None:
        return HeadingStart()
    azimuth = table.number("azimuth_sigma_arcsec", low=0.0, high=MOST_ARCSEC)
    position = table.number("position_sigma_mm", low=0.0, high=1e6)
    start = HeadingStart(
        None if azimuth is None else azimuth * ARCSEC,
        (position or 0.0) * MM,
        table.text("group") or "",
    )
    table.warn_unknown()
    return start


def _gyro_sides(table: Table, instruments: Sequence[Instrument]) -> tuple[GyroSide, ...]:
    known = {item.id: item for item in instruments}
    return tuple(_gyro_side(item, known) for item in table.tables("gyro"))


def _gyro_side(table: Table, instruments: Mapping[str, Instrument]) -> GyroSide:
    name = table.text("instrument")
    if name is None and "instrument" not in table and len(instruments) == 1:
        name = next(iter(instruments))
    if name is None:
        table.problem(
            "the gyro side names no instrument", "", 'instrument = "id of [[instrument]]"'
        )
    elif name not in instruments:
        hint = nearest_names(name, instruments)
        table.problem("there is no such instrument", name, "an id of [[instrument]]", hint)
    sigma = table.number("sigma_arcsec", low=0.0, high=MOST_ARCSEC)
    known = instruments.get(name or "")
    if sigma is None and "sigma_arcsec" not in table and known is not None:
        card = known.card.sigma.azimuth
        sigma = None if card is None else card / ARCSEC
        if sigma is None:
            table.problem(
                "the gyro side has no sigma and the card none", "", "sigma_arcsec = a number"
            )
    side = GyroSide(
        at=table.text("at", required=True) or "",
        to=table.text("to", required=True) or "",
        instrument=name or "",
        sigma=(sigma or 0.0) * ARCSEC,
        reciprocal=table.boolean("reciprocal"),
    )
    table.get("note")
    table.warn_unknown()
    return side


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor


def _sigmas(table: Table) -> AssumedSigmas:
    angle = table.number("sigma_angle_arcsec", low=0.0, high=MOST_ARCSEC)
    scale = table.number("sigma_scale_ppm", low=0.0, high=1e5)
    distance, centring = table.table("sigma_distance"), table.table("centring_mm")
    mm = ppm = instrument = target = None
    if distance is not None:
        mm = distance.number("mm", low=0.0, high=1e5) or 0.0
        ppm = distance.number("ppm", low=0.0, high=1e5) or 0.0
        distance.warn_unknown()
    if centring is not None:
        instrument = centring.number("instrument", low=0.0, high=1e4) or 0.0
        target = centring.number("target", low=0.0, high=1e4) or 0.0
        centring.warn_unknown()
    return AssumedSigmas(
        _scaled(angle, ARCSEC), mm, ppm, scale, _scaled(instrument, MM), _scaled(target, MM)
    )


def _surveys(table: Table) -> int:
    return whole(table, "independent_surveys", default=1, low=1, high=1000)


def whole(table: Table, key: str, *, default: int, low: int, high: int) -> int:
    """Whole number within bounds."""
    value = table.get(key)
    if value is None:
        return default
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        table.problem(
            said("{key} is out of range", key=key),
            value,
            said("a whole number from {low} to {high}", low=low, high=high),
        )
        return default
    return value


def _height(table: Table) -> HeightMethod | None:
    inner = table.table("height")
    if inner is None:
        return None
    method = inner.choice("method", ("levelling", "trig"), required=True)
    levelling, trig = method == "levelling", method == "trig"
    keys = ("sigma_mm_per_sqrt_km", "sigma_zenith_arcsec", "sigma_hi_mm", "sigma_ht_mm")
    needed = (levelling, trig, False, False)
    values = [
        inner.number(key, low=0.0, high=MOST_ARCSEC, required=required) or 0.0
        for key, required in zip(keys, needed, strict=True)
    ]
    found = HeightMethod(
        cast("Literal['levelling', 'trig']", method or "levelling"),
        values[0] * MM,
        values[1] * ARCSEC,
        values[2] * MM,
        values[3] * MM,
        inner.boolean("reciprocal"),
    )
    inner.warn_unknown()
    return found


def _tolerance(table: Table) -> StatedTolerance | None:
    inner = table.table("tolerance")
    if inner is None:
        return None
    values = [inner.number(key, high=1e4, positive=True) for key in COMPONENTS]
    source = inner.text("source") or ""
    inner.warn_unknown()
    return StatedTolerance(values[0], values[1], values[2], source)


def _monte_carlo(table: Table) -> MonteCarloPlan:
    inner = table.table("monte_carlo")
    if inner is None:
        return MonteCarloPlan()
    runs = whole(inner, "runs", default=10_000, low=2, high=100_000_000)
    seed = whole(inner, "seed", default=1, low=0, high=2**63 - 1)
    inner.warn_unknown()
    return MonteCarloPlan(runs, seed)


def _refraction(table: Table) -> WallRefraction | None:
    inner = table.table("refraction")
    if inner is None:
        return None
    gradient = inner.number("gradient_sigma_k_per_m", low=0.0, high=100.0, required=True)
    pressure = inner.number("pressure_hpa", low=100.0, high=2000.0)
    temperature = inner.number("temperature_c", low=-90.0, high=150.0)
    shared = inner.choice("shared", ("all", "heading"))
    inner.warn_unknown()
    return WallRefraction(
        gradient or 0.0,
        1013.25 if pressure is None else pressure,
        15.0 if temperature is None else temperature,
        cast("Literal['all', 'heading']", shared or "all"),
    )


def _deflection(table: Table) -> DeflectionField | None:
    inner = table.table("deflection")
    if inner is None:
        return None
    sigma = inner.number("sigma_arcsec", low=0.0, high=300.0, required=True)
    length = inner.number("correlation_length_m", high=1e7, positive=True, required=True)
    latitude = inner.number("latitude_deg", low=-89.0, high=89.0)
    found = DeflectionField(
        (sigma or 0.0) * ARCSEC,
        length or 1.0,
        math.nan if latitude is None else math.radians(latitude),
        inner.text("calibrated_at") or "",
    )
    inner.warn_unknown()
    return found


def _measured(table: Table) -> MeasuredMiss | None:
    inner = table.table("measured")
    if inner is None:
        return None
    values = [inner.number(key, low=-1e5, high=1e5) for key in COMPONENTS]
    if all(key not in inner for key in COMPONENTS):
        inner.problem("nothing was measured", "", " | ".join(COMPONENTS))
    miss = MeasuredMiss(values[0], values[1], values[2], inner.date("date"), inner.text("by") or "")
    inner.get("note")
    inner.warn_unknown()
    return miss


def _step(table: Table) -> ProcedureStep:
    done = table.get("done_at")
    if isinstance(done, dt.datetime | dt.date):
        done_at = done.isoformat()
    else:
        done_at = table.text("done_at") or ""
    step = ProcedureStep(
        whole(table, "id", default=1, low=1, high=6),
        done_at,
        table.text("by") or "",
        table.text("note", multiline=True) or "",
        table.text("file") or "",
        table.number("centre_line_mm", low=-1e5, high=1e5),
        table.number("waist_line_mm", low=-1e5, high=1e5),
    )
    if "id" not in table:
        table.problem("id is missing", "", "id = 1 ... 6")
    table.warn_unknown()
    return step
