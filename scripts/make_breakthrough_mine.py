"""Write the sample mine ``projects/synthetic-breakthrough``: surface, shaft, two headings.

Everything in it is simulated and says so. Two headings of 2 km and 20 sides each drive at each
other: A from the bottom of a shaft, B from an adit. What nobody declares to the program: the gyro
turns by 45" while it is underground in heading A (a transport step that is gone when it is back on
the surface). The truth stands in ``SOURCE.md`` of the sample.

    python scripts/make_breakthrough_mine.py projects/synthetic-breakthrough
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from surveyapp import api
from surveyapp.core.geodesy import open_grid
from surveyapp_models.angles import AngleUnit, format_angle, wrap_two_pi

CRS = "EPSG:4546"
SEED = 20260301
ARC = math.pi / 648_000.0
STEP = 45.0 * ARC
CONSTANT = 12.0 * ARC
SIDES, LENGTH, DEPTH = 20, 100.0, 600.0
ORIGIN = (431000.0, 3812000.0)
AXIS = math.radians(62.0)
ANGLE, GYRO, MARK = 7.0 * ARC, 6.0 * ARC, 0.0008
Point = tuple[float, float]


class Simulation:
    """Points, readings and their errors."""

    def __init__(self) -> None:
        self.random = np.random.default_rng(SEED)
        self.points: dict[str, Point] = {}
        self.grid = open_grid(CRS)

    def along(self, name: str, start: Point, azimuth: float, length: float) -> Point:
        """A new point."""
        place = (start[0] + length * math.sin(azimuth), start[1] + length * math.cos(azimuth))
        self.points[name] = place
        return place

    def azimuth(self, a: str, b: str) -> float:
        """True grid azimuth of a line."""
        (e, n), (x, y) = self.points[a], self.points[b]
        return math.atan2(x - e, y - n)

    def length(self, a: str, b: str) -> float:
        """True distance of two points."""
        return math.dist(self.points[a], self.points[b])

    def angle(self, at: str, back: str, to: str, sigma: float = ANGLE) -> str:
        """A read angle as text."""
        value = self.azimuth(at, to) - self.azimuth(at, back) + self.noise(sigma)
        return format_angle(wrap_two_pi(value), AngleUnit.DMS, decimals=1)

    def distance(self, a: str, b: str, sigma: float) -> str:
        """A read distance as text."""
        return f"{self.length(a, b) + self.noise(sigma):.4f}"

    def noise(self, sigma: float) -> float:
        """One error."""
        return float(self.random.normal(0.0, sigma))

    def gyro(self, at: str, to: str, shift: float = 0.0) -> list[str]:
        """Three rounds of an automatic gyro: true azimuth minus constant."""
        e, n = self.points[at]
        latitude, longitude = self.grid.geographic(e=e, n=n)
        turn = self.grid.convergence(latitude=latitude, longitude=longitude)
        value = self.azimuth(at, to) + turn - CONSTANT + shift + self.noise(3.0 * ARC)
        return [
            format_angle(wrap_two_pi(value + self.noise(GYRO)), AngleUnit.DMS, decimals=1)
            for _ in range(3)
        ]


def build(simulation: Simulation) -> None:
    """True places of everything."""
    s = simulation
    c = s.along("C", ORIGIN, 0.0, 0.0)
    s.along("D", c, math.radians(305.0), 420.0)
    s.along("W1", c, math.radians(20.0), 5.6210)
    s.along("W2", s.points["W1"], math.radians(21.1), 4.2228)
    place = s.along("A0", s.points["W1"], math.radians(202.0), 6.1)
    for i in range(1, SIDES + 1):
        wander = math.radians(1.5) * math.sin(0.9 * i)
        place = s.along(f"A{i}", place, AXIS + wander, LENGTH)
    places = [place]
    for i in range(SIDES, 0, -1):
        wander = math.radians(1.5) * math.sin(0.7 * i)
        places.append(s.along(f"B{i - 1}", places[-1], AXIS + wander, LENGTH))
    s.points[f"B{SIDES}"] = place
    s.along("T", s.points["B0"], AXIS + math.radians(25.0), 510.0)
    s.along("K1", c, math.radians(140.0), 900.0)
    s.along("K2", s.points["K1"], math.radians(75.0), 350.0)


HEAD = """# SYNTHETIC: every reading of this mine is simulated by scripts/make_breakthrough_mine.py.
format = 1
name = "Synthetic breakthrough"
crs = "EPSG:4546"
angle_unit = "dms"
rule_book = "cn-coal-15"
centring_mm = { instrument = 0.8, target = 0.8 }

[[instrument]]
id = "G1"
card = "gyromat-2000"
serial = "synthetic"
"""

TAIL = """
[penetration]
case = "opposite"
tunnel = "between_mines"
meeting = { e = %(e).4f, n = %(n).4f, h = -590.0 }
axis_azimuth = 62.0
sigma_scale_ppm = 2.0
height = { method = "levelling", sigma_mm_per_sqrt_km = 15.0 }
monte_carlo = { runs = 10000, seed = 7 }

[penetration.deflection]
sigma_arcsec = 3.0
correlation_length_m = 3000.0
calibrated_at = "K1"

[[penetration.heading]]
name = "A"
route = [%(a)s]
traverse = "A"
shaft = "east"

[[penetration.heading]]
name = "B"
route = [%(b)s]
traverse = "B"
start = { position_sigma_mm = 10.0 }

[[penetration.gyro]]
at = "A10"
to = "A11"
instrument = "G1"
sigma_arcsec = 6.0

[[penetration.gyro]]
at = "A18"
to = "A19"
instrument = "G1"
sigma_arcsec = 6.0

[[penetration.gyro]]
at = "B12"
to = "B13"
instrument = "G1"
sigma_arcsec = 6.0

[[penetration.step]]
id = 1
done_at = 2026-02-02
by = "survey office"
note = "gyro, wires in one shaft, 7-second traverses"

[[penetration.step]]
id = 2
done_at = 2026-02-03
by = "survey office"
note = "predict: within 0.5 m"

[[penetration.step]]
id = 3
done_at = 2026-02-05
by = "chief surveyor"

[[penetration.step]]
id = 4
done_at = 2026-02-10
by = "survey office"

[[penetration.step]]
id = 5
done_at = 2026-03-15
by = "shift A"
centre_line_mm = 4.0
waist_line_mm = -3.0

[[penetration.step]]
id = 5
done_at = 2026-04-20
by = "shift A"
centre_line_mm = -6.0
waist_line_mm = 2.0
"""

SHAFT = """
[[shaft]]
id = "east"
kind = "one"
depth_m = 600.0
wires = ["W1", "W2"]
book = "observations/shaft-east.csv"
orient = { at = "A0", to = "A1" }
sigma_plumb_mm = 0.3
sigma_angle_arcsec = 3.0
sigma_distance = { mm = 0.7, ppm = 0.0 }

[[shaft.check]]
id = "signal_ring"
done_at = 2026-02-11
by = "shaft crew"

[[shaft.check]]
id = "free_hang"
done_at = 2026-02-11
by = "shaft crew"

[[shaft.check]]
id = "fans_off"
done_at = 2026-02-11
by = "ventilation"

[[shaft.check]]
id = "damping"
done_at = 2026-02-11
by = "shaft crew"
"""


def station(simulation: Simulation, name: str, height: float, *, fixed: bool) -> str:
    """A [[station]] table; a station that is not fixed carries its planned place."""
    e, n = simulation.points[name]
    lines = ["[[station]]", f'name = "{name}"', f"e = {e:.4f}", f"n = {n:.4f}", f"h = {height:.3f}"]
    return "\n".join([*lines, *(["fixed = true"] if fixed else [])]) + "\n"


def swing(simulation: Simulation, middle: float) -> list[float]:
    """Nine turning points of a wire on its scale [mm]."""
    return [middle + 10.0 * (-0.965) ** k + simulation.noise(0.02) for k in range(9)]


def shaft_book(s: Simulation) -> str:
    """Book of the shaft."""
    rows = ["kind,place,at,from,to,value,unit,sigma,sigma_unit,set,note"]
    mm = 0.0007
    for place, at, mark in (("surface", "C", "D"), ("underground", "A0", "A1")):
        rows += [
            f"angle,{place},{at},{mark},W1,{s.angle(at, mark, 'W1', 3 * ARC)},dms,,,,",
            f"angle,{place},{at},W1,W2,{s.angle(at, 'W1', 'W2', 3 * ARC)},dms,,,,",
            f"distance,{place},{at},,W1,{s.distance(at, 'W1', mm)},m,,,,",
            f"distance,{place},{at},,W2,{s.distance(at, 'W2', mm)},m,,,,",
            f"distance,{place},W1,,W2,{s.distance('W1', 'W2', mm)},m,,,,",
        ]
    by_gyro = s.azimuth("A0", "A1") + s.noise(8.0 * ARC)
    read = format_angle(wrap_two_pi(by_gyro), AngleUnit.DMS, decimals=1)
    rows.append(f"azimuth,underground,A0,,A1,{read},dms,10.0,arcsec,,on the day of the plumbing")
    for wire, x, y in (("W1", 51.8, 38.4), ("W2", 44.2, 60.1)):
        for axis, middle in (("x", x), ("y", y)):
            rows += [f"swing,underground,{wire},,,{v:.2f},mm,,,{axis}," for v in swing(s, middle)]
    rows += [f"depth,,,,,{DEPTH + s.noise(0.02):.4f},m,,,{k}," for k in (1, 2)]
    return "\n".join(rows) + "\n"


def traverse_book(s: Simulation, letter: str, gyro: list[int], first: str) -> str:
    """Book of one heading."""
    rows = ["kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note", first]
    for i in range(1, SIDES):
        at, back, to = f"{letter}{i}", f"{letter}{i - 1}", f"{letter}{i + 1}"
        rows.append(f"angle,{at},{back},{to},{s.angle(at, back, to)},dms,,,,,,")
    for i in range(SIDES):
        a, b = f"{letter}{i}", f"{letter}{i + 1}"
        rows.append(f"distance,{a},,{b},{s.distance(a, b, 0.0022)},m,,,,,,")
    for i in range(SIDES):
        a, b = f"{letter}{i}", f"{letter}{i + 1}"
        sigma = 15.0 * math.sqrt(LENGTH / 1000.0)
        rows.append(f"height_difference,{a},,{b},{s.noise(sigma / 1e3):.4f},m,{sigma:.2f},mm,,,,")
    rows += [f"gyro,{letter}{i},,{letter}{i + 1},,,,,,,," for i in gyro]
    return "\n".join(rows) + "\n"


def session(
    s: Simulation, identity: str, sight: tuple[str, str], how: tuple[str, str, float]
) -> tuple[str, str]:
    """Table and book of one gyro session."""
    purpose, day, shift = how
    at, to = sight
    table = "\n".join(
        [
            "[[orientation]]",
            f'id = "{identity}"',
            f'station = "{at}"',
            f'target = "{to}"',
            'instrument = "G1"',
            'method = "automatic"',
            f'purpose = "{purpose}"',
            f"date = {day}",
            f'book = "observations/{identity}.csv"',
        ]
    )
    rows = [f"{k},azimuth,{value}" for k, value in enumerate(s.gyro(at, to, shift), start=1)]
    return table + "\n", "\n".join(["seq,kind,value", *rows]) + "\n"


def sessions(s: Simulation) -> list[tuple[str, str, str]]:
    """Identity, table and book of every session."""
    plan = [
        *((f"cal-before-{k}", ("K1", "K2"), ("calibration", "2026-02-12", 0.0)) for k in (1, 2, 3)),
        ("A10-A11", ("A10", "A11"), ("survey", "2026-03-20", STEP)),
        ("A18-A19", ("A18", "A19"), ("survey", "2026-04-25", STEP)),
        ("B12-B13", ("B12", "B13"), ("survey", "2026-04-28", 0.0)),
        *((f"cal-after-{k}", ("K1", "K2"), ("calibration", "2026-04-29", 0.0)) for k in (1, 2)),
    ]
    return [(name, *session(s, name, sight, how)) for name, sight, how in plan]


def write(folder: Path) -> None:
    """Write the whole sample."""
    s = Simulation()
    build(s)
    books = folder / "observations"
    books.mkdir(parents=True, exist_ok=True)
    (books / "shaft-east.csv").write_text(shaft_book(s), encoding="utf-8")
    made = sessions(s)
    for name, _, book in made:
        (books / f"{name}.csv").write_text(book, encoding="utf-8")
    start_b = f"angle,B0,T,B1,{s.angle('B0', 'T', 'B1')},dms,,,,,,"
    (books / "B.csv").write_text(traverse_book(s, "B", [12], start_b), encoding="utf-8")
    text = project_text(s, [table for _, table, _ in made])
    (folder / "project.toml").write_text(text, encoding="utf-8")
    placeholder = traverse_book(s, "A", [10, 18], "azimuth,A0,,A1,0.0,deg,20.0,arcsec,,,,")
    (books / "A.csv").write_text(placeholder, encoding="utf-8")
    joint = api.shaft(folder).shafts[0].combined.azimuth
    assert joint is not None, "wires and gyro contradict each other"
    start = (
        f"azimuth,A0,,A1,{math.degrees(joint.value):.7f},deg,{joint.sigma / ARC:.2f},arcsec,,,,"
        "shaft: wires and gyro"
    )
    final = placeholder.replace("azimuth,A0,,A1,0.0,deg,20.0,arcsec,,,,", start)
    (books / "A.csv").write_text(final, encoding="utf-8")
    (folder / "project.toml").write_text(text + measured(folder), encoding="utf-8")


def project_text(s: Simulation, tables: list[str]) -> str:
    """project.toml without the measured miss."""
    known = {"C": 10.0, "D": 14.0, "K1": 12.0, "K2": 13.0, "A0": -590.0, "B0": -590.0, "T": -585.0}
    parts = [HEAD, *(station(s, name, h, fixed=True) for name, h in known.items())]
    for letter in "AB":
        parts += [station(s, f"{letter}{i}", -590.0, fixed=False) for i in range(1, SIDES + 1)]
    parts += tables
    for letter in "AB":
        parts.append(
            "\n".join(
                [
                    "[[traverse]]",
                    f'name = "{letter}"',
                    f'book = "observations/{letter}.csv"',
                    'class = "7sec"',
                    "sigma_angle_arcsec = 7.0",
                    "sigma_distance = { mm = 2.0, ppm = 2.0 }",
                    "centring_mm = { instrument = 0.8, target = 0.8 }",
                    "atmosphere_applied = true",
                    "constant_applied = true",
                ]
            )
            + "\n"
        )
    e, n = s.points[f"A{SIDES}"]
    routes = {x: ", ".join(f'"{x.upper()}{i}"' for i in range(SIDES + 1)) for x in "ab"}
    return "\n".join(parts) + SHAFT + TAIL % {"e": e, "n": n, **routes}


def measured(folder: Path) -> str:
    """The miss: coordinates of the one physical point by both headings."""
    ends = {p.name: p for x in "AB" for p in api.adjust(folder, traverse=x).points}
    a, b = ends[f"A{SIDES}"], ends[f"B{SIDES}"]
    east, north = (a.e or 0.0) - (b.e or 0.0), (a.n or 0.0) - (b.n or 0.0)
    up = (a.h or 0.0) - (b.h or 0.0)
    right = east * math.cos(AXIS) - north * math.sin(AXIS)
    along = east * math.sin(AXIS) + north * math.cos(AXIS)
    return f"""
[[penetration.step]]
id = 6
done_at = 2026-05-06
by = "survey office"

[penetration.measured]
lateral_m = {right:.3f}
longitudinal_m = {along:.3f}
vertical_m = {up:.3f}
date = 2026-05-06
by = "survey office"
"""


if __name__ == "__main__":
    write(Path(sys.argv[1]))
