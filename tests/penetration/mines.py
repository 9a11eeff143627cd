"""Mines for tests: straight and bent drives of 100 m sides, in memory and as folders."""

import math
from collections.abc import Sequence
from pathlib import Path

from surveyapp.core.penetration.covariance import contributions, total
from surveyapp.core.penetration.mine import Mine, build_mine
from surveyapp.domain.penetration import (
    AssumedSigmas,
    DeflectionField,
    ExcavationCase,
    GyroSide,
    Heading,
    HeadingStart,
    MeetingPoint,
    Penetration,
    TunnelCase,
    Wall,
    WallRefraction,
)
from surveyapp.domain.project import Station
from surveyapp_models.angles import ARCSEC


def azimuths(sides: int, *, bent: bool = False) -> list[float]:
    if not bent:
        return [0.0] * sides
    return [0.0] * (sides // 2) + [math.radians(60.0)] * (sides - sides // 2)


def points(directions: Sequence[float], length: float = 100.0) -> list[tuple[float, float]]:
    found = [(0.0, 0.0)]
    for azimuth in directions:
        e, n = found[-1]
        found.append((e + length * math.sin(azimuth), n + length * math.cos(azimuth)))
    return found


def straight(
    sides: int,
    gyro: Sequence[int],
    *,
    own: float = 15.0,
    shared: float = 0.0,
    angle: float = 7.0,
    gradient: float = 0.0,
    wall: tuple[Wall, ...] = (),
    reciprocal: bool = False,
    surveys: int = 1,
    bent: bool = False,
    deflection: DeflectionField | None = None,
    start: HeadingStart | None = None,
    tolerance_factor: float | None = None,
) -> Mine:
    """One heading from P0 to the meeting point Pn; sigmas in arc-seconds."""
    directions = azimuths(sides, bent=bent)
    places = points(directions)
    stations = {f"P{i}": Station(f"P{i}", e, n, fixed=i == 0) for i, (e, n) in enumerate(places)}
    right: Wall = "right"
    side_of_wall = wall or ((right,) * (sides + 1) if gradient else ())
    heading = Heading("A", tuple(stations), wall=side_of_wall, start=start or HeadingStart())
    plan = Penetration(
        case=ExcavationCase.ONE_END,
        tunnel=TunnelCase.WITHIN_MINE,
        meeting=MeetingPoint(*places[-1]),
        axis_azimuth=directions[-1],
        headings=(heading,),
        gyro=tuple(GyroSide(f"P{i}", f"P{i + 1}", "G", own * ARCSEC, reciprocal) for i in gyro),
        sigmas=AssumedSigmas(angle=angle * ARCSEC),
        independent_surveys=surveys,
        factor=tolerance_factor,
        refraction=WallRefraction(gradient) if gradient else None,
        deflection=deflection,
    )
    return build_mine(plan, stations, {"G": shared * ARCSEC} if gyro else {})


def lateral(mine: Mine) -> float:
    """Lateral 1 sigma [m]."""
    return math.sqrt(float(total(contributions(mine))[0][0, 0]))


def mine_toml(
    *,
    sides: int = 20,
    gyro: Sequence[int] = (0,),
    top: str = "",
    table: str = "sigma_distance = { mm = 2.0, ppm = 2.0 }",
    heading: str = "",
    gyro_sigma: str = "sigma_arcsec = 15.0",
    constant: str = "constant = { arcsec = 0.0, sigma_arcsec = 8.0 }",
    more: str = "",
) -> str:
    """project.toml of a straight drive north with one heading, gyro on the given sides."""
    lines = ["format = 1", 'name = "drive"', top]
    lines += ["[[instrument]]", 'id = "G"', 'card = "gyromat-2000"', constant]
    for i, (e, n) in enumerate(points(azimuths(sides))):
        built = "fixed = true" if i == 0 else "planned = true"
        lines += ["[[station]]", f'name = "P{i}"', f"e = {e!r}", f"n = {n!r}", built]
    route = ", ".join(f'"P{i}"' for i in range(sides + 1))
    lines += [
        "[penetration]",
        'case = "one_end"',
        'tunnel = "within_mine"',
        f"meeting = {{ e = 0.0, n = {100.0 * sides}, h = 0.0 }}",
        "axis_azimuth = 0.0",
        "sigma_angle_arcsec = 7.0",
        table,
        "[[penetration.heading]]",
        'name = "A"',
        f"route = [{route}]",
        heading,
    ]
    for side in gyro:
        lines += ["[[penetration.gyro]]", f'at = "P{side}"', f'to = "P{side + 1}"']
        lines += ['instrument = "G"', gyro_sigma]
    return "\n".join([*lines, more]) + "\n"


def mine_folder(path: Path, text: str) -> Path:
    """A project folder with this project.toml."""
    path.mkdir(parents=True, exist_ok=True)
    (path / "project.toml").write_text(text, encoding="utf-8")
    return path
