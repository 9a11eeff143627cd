"""The azimuth of an underground side through one shaft or two, with everything that checks it.

Surface and underground are adjusted each by itself; the line of the wires joins them, turned by
what the wires stand off their plumb (each wire, each axis): theta = rho sqrt(e_A^2 + e_B^2) / c.
Gyro azimuths are combined with the wires by their own variances, never where they contradict.

Source: physics.md section 6; penetration.md section 6.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.shafts.joint import joined
from surveyapp.core.shafts.plane import (
    Place,
    PlaneSolution,
    Sight,
    bearing,
    length,
    solve_plane,
)
from surveyapp.core.shafts.points import plumbed_points
from surveyapp.core.shafts.swings import SwingRest, period_s, pooled_sigma, swing_rest
from surveyapp.domain.shaft import Shaft, ShaftRow, ShaftRowKind
from surveyapp.domain.shaft_result import (
    DepthCheck,
    JointAzimuth,
    ScaleCheck,
    ShaftBudgetLine,
    ShaftDrawing,
    ShaftOrientation,
    SideAzimuth,
    TriangleCheck,
    WireRest,
)
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi, wrap_two_pi
from surveyapp_models.arrays import Floats

K = ShaftRowKind
MM, PPM = 1e-3, 1e-6
LIMIT_MM = {"surface": 2.0, "underground": 4.0}
"""|measured - computed| distance of the wires (physics.md section 6)."""
CLOSEST_M = 1.0
WIDEST = math.radians(3.0)
LONGEST = 1.5
DEPTH_SIGMA_DIVISOR = 2.0 * math.sqrt(2.0) * 8000.0


@dataclass(frozen=True, slots=True)
class _Join:
    """Both networks and the line of the wires in each."""

    shaft: Shaft
    surface: PlaneSolution
    underground: PlaneSolution


def sigma_of(shaft: Shaft, row: ShaftRow) -> float | None:
    """1 sigma of a row: its own, else the shaft's [rad] or [m]."""
    if row.sigma is not None:
        return row.sigma
    if row.kind is K.DISTANCE:
        if shaft.sigma_mm is None or shaft.sigma_ppm is None:
            return None
        return math.hypot(shaft.sigma_mm * MM, shaft.sigma_ppm * PPM * row.value)
    return shaft.sigma_angle if row.kind is K.ANGLE else None


def _sights(shaft: Shaft, place: str) -> list[Sight]:
    """Rows of one place that make its network; gyro azimuths underground are joined later."""
    kinds = (K.ANGLE, K.DISTANCE) if place == "underground" else (K.ANGLE, K.DISTANCE, K.AZIMUTH)
    found = []
    for row in shaft.rows:
        sigma = sigma_of(shaft, row)
        if row.kind in kinds and row.place == place and sigma is not None and sigma > 0.0:
            found.append(Sight(row, sigma))
    return found


def orient_shaft(
    shaft: Shaft, known: Mapping[str, Place]
) -> tuple[ShaftOrientation, tuple[ResultWarning, ...]]:
    """Orient through a shaft.

    Parameters
    ----------
    shaft : Shaft
    known : mapping of str to (east, north)
        Surface points with coordinates [m].

    Raises
    ------
    SurveyError
        If a network cannot be laid out or does not determine what is asked.
    """
    join = _joined(shaft, known)
    wires, at, to = shaft.wires, *shaft.orient
    upper = join.surface.per_row(lambda p: bearing(p, *wires), said("the azimuth of the wires"))
    lower = join.underground.per_row(
        lambda p: bearing(p, at, to) - bearing(p, *wires), said("the side against the wires")
    )
    distance = length(join.surface.places, *wires)
    plumb = math.sqrt(2.0) * shaft.sigma_plumb_m / distance
    turn = bearing(join.surface.places, *wires) - bearing(join.underground.places, *wires)
    azimuth = wrap_two_pi(bearing(join.underground.places, at, to) + turn)
    variance = float(upper @ upper) + plumb**2 + float(lower @ lower)
    by_wires = SideAzimuth(azimuth, math.sqrt(variance))
    gyro, combined = _gyro(join, by_wires, lower)
    triangles = tuple(_triangles(shaft))
    swings, told = _wires(shaft)
    found = ShaftOrientation(
        id=shaft.id,
        kind=shaft.kind,
        at=at,
        to=to,
        azimuth=by_wires,
        wires=swings,
        triangles=triangles,
        scale=_scale(join) if shaft.kind == "two" else None,
        convergence_mm=shaft.depth_m * distance / shaft.radius_m / MM,
        depth=_depth(shaft),
        gyro=gyro,
        combined=combined,
        budget=_budget(join, (upper, plumb, lower)),
        checks=shaft.checks,
        points=plumbed_points(shaft, join.surface, join.underground),
        drawing=_drawing(join, triangles),
    )
    return found, (*told, *_warnings(shaft, distance, triangles))


def _joined(shaft: Shaft, known: Mapping[str, Place]) -> _Join:
    surface = _sights(shaft, "surface")
    named = {n for s in surface for n in (s.row.at, s.row.back, s.row.to)} | set(shaft.wires)
    fixed = {name: place for name, place in known.items() if name in named}
    problems = []
    if len(fixed) < 2 and not any(s.row.kind is K.AZIMUTH and fixed for s in surface):
        problems.append(
            Problem(
                "too few surface points of the shaft have coordinates",
                f"[[shaft]] {shaft.id}",
                ", ".join(sorted(fixed)) or "none",
                "two of its surface points as [[station]] with e and n, or one and an azimuth",
            )
        )
    below = _sights(shaft, "underground")
    if not below:
        problems.append(
            Problem("nothing was observed underground", f"[[shaft]] {shaft.id}", "", "rows")
        )
    if problems:
        raise SurveyError(problems)
    try:
        above = solve_plane(surface, fixed, shaft.wires)
        places = {**above.places, **{w: fixed[w] for w in shaft.wires if w in fixed}}
        upper = PlaneSolution(places, above.order, above.spread, above.open, above.rows)
        return _Join(shaft, upper, solve_plane(below, {}, shaft.orient))
    except SurveyError as refused:
        raise SurveyError(
            [problem.within(f"[[shaft]] {shaft.id}") for problem in refused.problems]
        ) from None


def _gyro(
    join: _Join, by_wires: SideAzimuth, lower: Floats
) -> tuple[SideAzimuth | None, JointAzimuth]:
    """Gyro azimuths carried to the oriented side, and their combination with the wires."""
    shaft, net = join.shaft, join.underground
    at, to = shaft.orient
    values, slopes, own = [by_wires.value], [lower], [by_wires.sigma**2 - float(lower @ lower)]
    _refuse_unknown_sides(shaft, net.places)
    for row in shaft.of_kind(K.AZIMUTH, "underground"):
        carried = net.per_row(
            lambda p, row=row: bearing(p, at, to) - bearing(p, row.at, row.to),  # type: ignore[misc]
            said("the gyro side {at}-{to}", at=row.at, to=row.to),
        )
        turned = bearing(net.places, at, to) - bearing(net.places, row.at, row.to)
        values.append(row.value + turned)
        slopes.append(carried)
        own.append((row.sigma or 0.0) ** 2)
    matrix = np.array(slopes)
    covariance = matrix @ matrix.T + np.diag(own)
    relative = np.array([wrap_pi(value - values[0]) for value in values])
    return joined(values[0], relative, covariance)


def _refuse_unknown_sides(shaft: Shaft, places: Collection[str]) -> None:
    """A gyro side is carried between points that the angles and distances underground place."""
    problems = [
        Problem(
            "a gyro side to a point that no other row places",
            said("[[shaft]] {id}, azimuth {at}-{to}", id=shaft.id, at=row.at, to=row.to),
            name,
            "a point of the angles and distances underground",
            nearest_names(name, places),
        )
        for row in shaft.of_kind(K.AZIMUTH, "underground")
        for name in (row.at, row.to)
        if name not in places
    ]
    if problems:
        raise SurveyError(problems)


def _triangles(shaft: Shaft) -> list[TriangleCheck]:
    """Every connecting triangle that was measured whole: a, b, c and gamma."""
    found = []
    for place in ("surface", "underground"):
        sides: dict[frozenset[str], list[float]] = {}
        for row in shaft.of_kind(K.DISTANCE, place):
            sides.setdefault(frozenset((row.at, row.to)), []).append(row.value)
        mean = {ends: sum(values) / len(values) for ends, values in sides.items()}
        first, second = shaft.wires
        measured = mean.get(frozenset(shaft.wires))
        for station, gamma in _gammas(shaft, place).items():
            near = mean.get(frozenset((station, first)))
            far = mean.get(frozenset((station, second)))
            if measured is None or near is None or far is None:
                continue
            computed = math.sqrt(near**2 + far**2 - 2.0 * near * far * math.cos(gamma))
            f_mm = (measured - computed) / MM
            limit = LIMIT_MM[place]
            ratio = min(near, far) / measured
            passed = abs(f_mm) <= limit
            found.append(TriangleCheck(place, station, f_mm, limit, passed, gamma, ratio))
    return found


def _gammas(shaft: Shaft, place: str) -> dict[str, float]:
    """Angle between the wires at each station: measured, or a difference of two angles."""
    wires = set(shaft.wires)
    direct: dict[str, list[float]] = {}
    parts: dict[tuple[str, str], dict[str, float]] = {}
    for row in shaft.of_kind(K.ANGLE, place):
        if {row.back, row.to} == wires:
            direct.setdefault(row.at, []).append(abs(wrap_pi(row.value)))
        for wire, other, sign in ((row.to, row.back, 1.0), (row.back, row.to, -1.0)):
            if wire in wires and other not in wires:
                parts.setdefault((row.at, other), {})[wire] = sign * row.value
    found = {at: sum(values) / len(values) for at, values in direct.items()}
    for (at, _), turned in parts.items():
        if set(turned) == wires and at not in found:
            found[at] = abs(wrap_pi(turned[shaft.wires[1]] - turned[shaft.wires[0]]))
    return found


def _scale(join: _Join) -> ScaleCheck:
    """c_surface - (c' + H c/R) against 2 sqrt((m_b/rho)^2 sum R^2 + sum m_l^2 + 2 e^2)."""
    shaft, places = join.shaft, join.underground.places
    above = length(join.surface.places, *shaft.wires)
    below = length(places, *shaft.wires)
    misclosure = above - (below + shaft.depth_m * above / shaft.radius_m)
    line = bearing(places, *shaft.wires)
    start = places[shaft.wires[0]]
    variance = 2.0 * shaft.sigma_plumb_m**2
    for sight in join.underground.rows:
        if sight.row.kind is K.DISTANCE:
            variance += sight.sigma**2
        elif sight.row.kind is K.ANGLE:
            e, n = places[sight.row.at][0] - start[0], places[sight.row.at][1] - start[1]
            beside = e * math.cos(line) - n * math.sin(line)
            variance += (sight.sigma * beside) ** 2
    limit = 2.0 * math.sqrt(variance)
    return ScaleCheck(misclosure / MM, limit / MM, abs(misclosure) <= limit)


def _depth(shaft: Shaft) -> DepthCheck:
    """Depth by its determinations; two may differ by h/8000."""
    sets: dict[str, list[float]] = {}
    for i, row in enumerate(shaft.of_kind(K.DEPTH)):
        sets.setdefault(row.set or f"\0{i}", []).append(row.value)
    values = [sum(group) / len(group) for group in sets.values()]
    if not values:
        return DepthCheck(shaft.depth_m, None, None, shaft.depth_m / 8.0, None)
    mean = sum(values) / len(values)
    limit = mean / 8.0
    # one transfer: h/16000; the mean of n is better by their root
    sigma = mean / DEPTH_SIGMA_DIVISOR * math.sqrt(2.0 / len(values))
    if len(values) < 2:
        return DepthCheck(mean, sigma, None, limit, None)
    difference = (max(values) - min(values)) / MM
    return DepthCheck(mean, sigma, difference, limit, difference <= limit)


def _wires(shaft: Shaft) -> tuple[tuple[WireRest, ...], list[ResultWarning]]:
    """Rest of every wire on both scales."""
    warnings = []
    rests: dict[tuple[str, str], tuple[SwingRest, float | None]] = {}
    for wire in shaft.wires:
        for axis in ("x", "y"):
            rows = [r for r in shaft.of_kind(K.SWING) if r.at == wire and r.set == axis]
            if not rows:
                continue
            if len(rows) < 3:
                text = said(
                    "shaft {id}, wire {wire} {axis}: fewer than 3 turning points",
                    id=shaft.id,
                    wire=wire,
                    axis=axis,
                )
                warnings.append(ResultWarning("swing_too_short", text))
                continue
            stated = [row.sigma for row in rows if row.sigma is not None]
            own = math.sqrt(sum(s * s for s in stated) / len(stated)) if stated else None
            rests[wire, axis] = (swing_rest([row.value for row in rows]), own)
    pooled = pooled_sigma([rest for rest, _ in rests.values()])

    def part(wire: str, axis: str) -> tuple[float | None, float | None]:
        if (wire, axis) not in rests:
            return None, None
        rest, own = rests[wire, axis]
        sigma = pooled if own is None else own
        return rest.rest, None if sigma is None else sigma * rest.weight_norm

    period = period_s(shaft.depth_m)
    found = tuple(WireRest(w, *part(w, "x"), *part(w, "y"), period) for w in shaft.wires)
    return found, warnings


def _drawing(join: _Join, triangles: Sequence[TriangleCheck]) -> ShaftDrawing:
    """Swings as read, and the connecting triangles in their own frames."""
    shaft = join.shaft
    swings = []
    for wire in shaft.wires:
        for axis in ("x", "y"):
            values = [r.value for r in shaft.of_kind(K.SWING) if r.at == wire and r.set == axis]
            if values:
                swings.append((wire, axis, tuple(values)))
    nets = {"surface": join.surface.places, "underground": join.underground.places}
    shown = tuple(
        (
            item.place,
            tuple((name, *nets[item.place][name]) for name in (item.station, *shaft.wires)),
        )
        for item in triangles
    )
    return ShaftDrawing(tuple(swings), shown)


def _budget(join: _Join, parts: tuple[Floats, float, Floats]) -> tuple[ShaftBudgetLine, ...]:
    upper, plumb, lower = parts
    squares: dict[str, float] = {}
    for name, net, slopes in (
        ("surface", join.surface, upper),
        ("underground", join.underground, lower),
    ):
        for sight, slope in zip(net.rows, slopes.tolist(), strict=True):
            key = f"{name}_{sight.row.kind}s"
            squares[key] = squares.get(key, 0.0) + slope**2
    squares["plumbing"] = plumb**2
    total = sum(squares.values())
    return tuple(
        ShaftBudgetLine(join.shaft.id, name, math.sqrt(value), value / total if total else 0.0)
        for name, value in squares.items()
    )


def _warnings(
    shaft: Shaft, distance: float, triangles: Sequence[TriangleCheck]
) -> list[ResultWarning]:
    found = []
    if distance < CLOSEST_M:
        text = said(
            "shaft {id}: the wires are {distance:.3f} m apart, closer than 1 m",
            id=shaft.id,
            distance=distance,
        )
        found.append(ResultWarning("wires_close", text))
    for item in triangles:
        where = said(
            "shaft {id}, triangle at {station} ({place})",
            id=shaft.id,
            station=item.station,
            place=item.place,
        )
        if item.gamma > WIDEST:
            text = said(
                "{where}: the angle between the wires is {gamma:.2f} degrees",
                where=where,
                gamma=math.degrees(item.gamma),
            )
            found.append(ResultWarning("gamma_large", said("{text}, above 3", text=text)))
        if item.ratio > LONGEST:
            text = said("{where}: a/c = {ratio:.2f}, above 1.5", where=where, ratio=item.ratio)
            found.append(ResultWarning("triangle_long", text))
    return found
