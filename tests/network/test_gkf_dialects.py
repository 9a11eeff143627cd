"""Dialects of .gkf against a small adjustment of our own that reads no file and shares no code.

The truth is drawn, the readings are computed by plain formulas in east, north, up; each dialect
writes them as the manual of GNU Gama allows; the own adjustment takes the values as written.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api

GON = math.pi / 200.0
CC, ARC, MM = GON * 1e-4, math.pi / 648000.0, 1e-3
PLACES = {
    "A": (1000.0, 2000.0, 300.0),
    "B": (1180.0, 2040.0, 310.0),
    "C": (1120.0, 2170.0, 295.0),
    "D": (960.0, 2120.0, 305.0),
}
FIXED = ("A", "B")
FREE = ("C", "D")


@dataclass
class Reading:
    """Kind, points, value [rad, m], sigma [rad, m], heights of instrument and target [m]."""

    kind: str
    at: str
    to: str
    value: float
    sigma: float
    bs: str = ""
    hi: float = 0.0
    ht: float = 0.0
    set: str = ""


Places = dict[str, tuple[float, float, float]]


def computed(r: Reading, at: Places, turned: dict[str, float]) -> float:
    """The plain formula of each kind."""
    a, b = at[r.at], at.get(r.to, (0.0, 0.0, 0.0))
    e, n, h = b[0] - a[0], b[1] - a[1], b[2] + r.ht - a[2] - r.hi
    level, bearing = math.hypot(e, n), math.atan2(e, n)
    if r.kind == "angle":
        c = at[r.bs]
        return bearing - math.atan2(c[0] - a[0], c[1] - a[1])
    return {
        "direction": bearing - turned.get(r.set, 0.0),
        "azimuth": bearing,
        "distance": level,
        "s-distance": math.hypot(level, h),
        "z-angle": math.atan2(level, h),
        "dh": b[2] - a[2],
        "e": a[0],
        "n": a[1],
        "de": e,
        "dn": n,
        "du": h,
    }[r.kind]


ANGLES = {"angle", "direction", "azimuth", "z-angle"}


def adjusted(
    readings: list[Reading], covariance: np.ndarray | None = None
) -> tuple[Places, float, dict[str, float]]:
    """Points, v'Pv and sigmas of their east coordinates [m], a priori."""
    sets = sorted({r.set for r in readings if r.set})
    spatial = any(r.kind in ("s-distance", "z-angle", "dh", "du") for r in readings)
    axes = 3 if spatial else 2
    x = np.array([PLACES[n][i] + 0.3 for n in FREE for i in range(axes)] + [0.0] * len(sets))
    first: dict[str, float] = {}
    for r in readings:
        if r.set:
            own = computed(r, PLACES, {}) - r.value
            first.setdefault(r.set, own)
    x[axes * len(FREE) :] = [first[s] for s in sets]

    def model(x: np.ndarray) -> np.ndarray:
        at = dict(PLACES)
        for k, n in enumerate(FREE):
            at[n] = (*x[axes * k : axes * k + axes], *PLACES[n][axes:])
        turned = dict(zip(sets, x[axes * len(FREE) :], strict=True))
        return np.array([computed(r, at, turned) for r in readings])

    weight = np.linalg.inv(
        np.diag([r.sigma**2 for r in readings]) if covariance is None else covariance
    )
    circular = np.array([r.kind in ANGLES for r in readings])
    for _ in range(15):
        miss = np.array([r.value for r in readings]) - model(x)
        miss[circular] = np.remainder(miss[circular] + math.pi, 2.0 * math.pi) - math.pi
        step = 1e-4
        columns = [(model(x + d) - model(x - d)) / (2 * step) for d in step * np.eye(len(x))]
        design = np.stack(columns, axis=1)
        normal = design.T @ weight @ design
        x = x + np.linalg.solve(normal, design.T @ weight @ miss)
    cofactor = np.linalg.inv(normal)
    found = {n: tuple(x[axes * k : axes * k + axes]) for k, n in enumerate(FREE)}
    sigma = {n: float(np.sqrt(cofactor[axes * k, axes * k])) for k, n in enumerate(FREE)}
    return found, float(miss @ weight @ miss), sigma


@dataclass
class Dialect:
    """How a file is written."""

    axes: str = "ne"
    left: bool = True
    dms: bool = False
    quote: str = '"'
    prolog: str = ""
    per_sight: bool = False
    after: Callable[[str], str] = field(default=lambda text: text)

    def angle(self, value: float) -> tuple[str, float]:
        """Text of an angle and the value that it says [rad]."""
        value %= 2.0 * math.pi
        if not self.dms:
            text = f"{value / GON:.6f}"
            return text, float(text) * GON
        tenths = round(value / ARC * 100)
        seconds, degrees = tenths % 6000 / 100, tenths // 360000
        return f"{degrees}-{tenths // 6000 % 60:02d}-{seconds:05.2f}", tenths / 100 * ARC

    def plane(self, e: float, n: float) -> tuple[float, float]:
        """x and y of the file."""
        of = {"n": n, "s": -n, "e": e, "w": -e}
        return of[self.axes[0]], of[self.axes[1]]

    def attributes(self, **values: object) -> str:
        return " ".join(
            f"{k.rstrip('_')}={self.quote}{v}{self.quote}" for k, v in values.items() if v != ""
        )

    def reading(self, r: Reading) -> str:
        """An element; the value of the reading becomes what the text says."""
        own = {"from": r.at} if self.per_sight or r.kind == "dh" else {}
        heights = {} if r.kind == "dh" else {"from_dh": r.hi or "", "to_dh": r.ht or ""}
        if r.kind in ANGLES:
            hand = 1.0 if self.left or r.kind == "z-angle" else -1.0
            text, said = self.angle(hand * r.value)
            r.value = hand * said
            sigma = f"{r.sigma / (ARC if self.dms else CC):.9g}"
        else:
            text = f"{r.value:.5f}"
            r.value, sigma = float(text), f"{r.sigma / MM:.9g}"
        ends = {"bs": r.bs, "fs": r.to} if r.kind == "angle" else {"to": r.to}
        values = {**own, **ends, "val": text, "stdev": sigma, **heights}
        return f"<{r.kind} {self.attributes(**values)} />"

    def file(self, body: list[str]) -> str:
        points = []
        for name, (e, n, h) in PLACES.items():
            x, y = self.plane(e, n)
            status = {"fix": "xyz"} if name in FIXED else {"adj": "xyz"}
            given = {"x": x, "y": y, "z": h} if name in FIXED else {}
            points.append(f"<point {self.attributes(id=name, **given, **status)} />")
        hand = "left-handed" if self.left else "right-handed"
        network = f'<network axes-xy="{self.axes}" angles="{hand}">'
        return self.after(
            f'<?xml version="1.0" ?>\n{self.prolog}\n<gama-local>\n{network}\n'
            '<parameters sigma-apr="1" sigma-act="apriori"/>\n<points-observations>\n'
            + "\n".join([*points, *body])
            + "\n</points-observations>\n</network>\n</gama-local>\n"
        )


def survey(g: np.random.Generator, *, plane: bool = False) -> list[Reading]:
    """Directions, distances, zenith angles of every sight, an angle, levelled heights."""
    found = []
    for at in PLACES:
        turn = float(g.uniform(0.0, 6.2))
        for to in PLACES:
            if to == at:
                continue
            found.append(Reading("direction", at, to, 0.0, 8 * CC, set=at))
            kinds = ("distance",) if plane else ("s-distance", "z-angle")
            for kind in kinds:
                sigma = 10 * CC if kind == "z-angle" else 2 * MM
                heights = (0.0, 0.0) if plane else (1.52, 1.31)
                found.append(Reading(kind, at, to, 0.0, sigma, hi=heights[0], ht=heights[1]))
        for r in found:
            if r.at == at:
                noise = float(g.normal(0.0, r.sigma))
                r.value = computed(r, PLACES, {at: turn}) + noise
    if not plane:
        found.append(Reading("dh", "A", "C", -5.0 + float(g.normal(0, 1e-3)), 1 * MM))
        found.append(Reading("dh", "C", "D", 10.0 + float(g.normal(0, 1e-3)), 1 * MM))
    angle = Reading("angle", "B", "D", 0.0, 9 * CC, bs="C")
    angle.value = computed(angle, PLACES, {}) + float(g.normal(0.0, angle.sigma))
    return [*found, angle]


def clusters(dialect: Dialect, readings: list[Reading]) -> list[str]:
    """One <obs> for each station, levelled heights in a cluster of their own."""
    body = []
    for at in PLACES:
        rows = [dialect.reading(r) for r in readings if r.at == at and r.kind != "dh"]
        own = "" if dialect.per_sight else f" from={dialect.quote}{at}{dialect.quote}"
        if dialect.per_sight:  # directions need the station of their <obs>
            own = f" from={dialect.quote}{at}{dialect.quote}"
        body += [f"<obs{own}>", *rows, "</obs>"]
    levelled = [dialect.reading(r) for r in readings if r.kind == "dh"]
    if levelled:
        body += ["<height-differences>", *levelled, "</height-differences>"]
    return body


def compare(tmp_path: Path, text: str, wanted: tuple[Places, float, dict[str, float]]) -> None:
    file = tmp_path / "n.gkf"
    file.write_text(text, encoding="utf-8")
    result = api.adjust(file)
    places, squares, sigmas = wanted
    assert result.global_test.sum_of_squares == pytest.approx(squares, rel=1e-5, abs=1e-6)
    for name, place in places.items():
        point = result.point(name)
        found = [point.e, point.n, point.h][: len(place)]
        assert found == pytest.approx(list(place), abs=2e-6), name
        assert point.sigma_e == pytest.approx(sigmas[name], rel=1e-4)


COMMENT = "<!-- a remark -- -->".replace(" -- ", " - ")
DIALECTS = {
    **{f"{axes} left": Dialect(axes=axes) for axes in ("ne", "sw", "es", "wn")},
    **{f"{axes} left": Dialect(axes=axes) for axes in ("en", "nw", "se", "ws")},
    **{f"{axes} right": Dialect(axes=axes, left=False) for axes in ("ne", "sw", "es", "wn")},
    **{f"{axes} right": Dialect(axes=axes, left=False) for axes in ("en", "nw", "se", "ws")},
    "degrees": Dialect(dms=True),
    "degrees right": Dialect(dms=True, left=False, axes="en"),
    "single quotes": Dialect(quote="'"),
    "station in each sight": Dialect(per_sight=True),
    "plain doctype": Dialect(prolog='<!DOCTYPE gama-local SYSTEM "gama-local.dtd">'),
    "public doctype": Dialect(prolog='<!DOCTYPE gama-local PUBLIC "-//GAMA" "http://x/y.dtd">'),
    "comments": Dialect(
        after=lambda t: t.replace("<obs", COMMENT + "<obs").replace("/>", f"/>{COMMENT}")
    ),
    "one line": Dialect(after=lambda t: " ".join(t.split("\n"))),
    "crlf and tabs": Dialect(after=lambda t: t.replace("\n", "\r\n").replace(" to=", "\tto=")),
    "blanks around =": Dialect(
        after=lambda t: t.replace("val=", "val = ").replace("stdev=", "stdev\n=")
    ),
    "numbers as entities": Dialect(after=lambda t: t.replace('to="C"', 'to="&#67;"')),
    "a namespace": Dialect(
        after=lambda t: t.replace(
            "<gama-local>", '<gama-local xmlns="http://www.gnu.org/software/gama/gama-local">'
        )
    ),
}


@pytest.mark.parametrize("name", list(DIALECTS))
def test_a_dialect_is_what_it_says(tmp_path: Path, name: str) -> None:
    dialect = DIALECTS[name]
    readings = survey(np.random.default_rng(5))
    text = dialect.file(clusters(dialect, readings))
    compare(tmp_path, text, adjusted(readings))


def test_faces_right_and_sixty_seconds(tmp_path: Path) -> None:
    dialect = Dialect(dms=True)
    readings = survey(np.random.default_rng(6))
    lines = []
    for line in clusters(dialect, readings):
        if "<z-angle" in line and 'to="D"' in line:  # the same reading in the other face
            degrees, minutes, seconds = line.split('val="')[1].split('"')[0].split("-")
            left = (int(degrees) * 60 + int(minutes)) * 60 + float(seconds)
            other = round((1296000 - left) * 100)
            text = f"{other // 360000}-{other // 6000 % 60}-{other % 6000 / 100:.2f}"
            line = line.replace(f"{degrees}-{minutes}-{seconds}", text)
        lines.append(line)
    text = dialect.file(lines)
    compare(tmp_path, text, adjusted(readings))
    assert "face_right" in {w.code for w in api.adjust(tmp_path / "n.gkf").warnings}


def test_a_covariance_matrix_of_a_station(tmp_path: Path) -> None:
    """Directions of A share a centring: full matrix in cc^2, banded rows of the upper triangle."""
    dialect = Dialect()
    readings = survey(np.random.default_rng(7), plane=True)
    own = [i for i, r in enumerate(readings) if r.at == "A"]
    matrix = np.diag([r.sigma**2 for r in readings])
    units = np.array([CC if r.kind in ANGLES else MM for r in readings])
    g = np.random.default_rng(1)
    root = np.eye(len(own)) + 0.4 * np.tril(g.uniform(-1, 1, (len(own), len(own))), -1)
    part = root @ root.T * 25.0
    matrix[np.ix_(own, own)] = part * np.outer(units[own], units[own])
    body = clusters(dialect, readings)
    size = len(own)
    rows = [" ".join(f"{part[i, j]:.17g}" for j in range(i, size)) for i in range(size)]
    inside = f'<cov-mat dim="{size}" band="{size - 1}">' + "\n".join(rows) + "</cov-mat>"
    body.insert(body.index("</obs>"), inside)
    text = dialect.file(body).replace("xyz", "xy")
    compare(tmp_path, text, adjusted(readings, matrix))


@pytest.mark.parametrize("axes", ["ne", "sw", "en", "ws"])
def test_coordinates_and_vectors_with_covariances(tmp_path: Path, axes: str) -> None:
    dialect = Dialect(axes=axes)
    readings = survey(np.random.default_rng(8))
    body = clusters(dialect, readings)
    signs = {"n": ("n", 1.0), "s": ("n", -1.0), "e": ("e", 1.0), "w": ("e", -1.0)}
    kinds = [signs[axes[0]], signs[axes[1]]]
    extra, truth = [], dict(PLACES)
    for kind, _ in kinds:
        place = truth["C"][0 if kind == "e" else 1]
        extra.append(Reading(kind, "C", "", place + 0.004, 0.0))
    for kind in (*(f"d{k}" for k, _ in kinds), "du"):
        r = Reading(kind, "A", "D", 0.0, 0.0)
        r.value = computed(r, truth, {}) - 0.003
        extra.append(r)
    plane = np.array([[16.0, 6.0], [6.0, 25.0]])
    space = np.array([[9.0, 2.0, 0.0], [2.0, 12.0, 3.0], [0.0, 3.0, 30.0]])
    for r in extra:
        r.value = round(r.value, 5)
    hands = np.array([s for _, s in kinds])
    x, y = (s * r.value for (_, s), r in zip(kinds, extra[:2], strict=True))
    dx, dy = (s * r.value for (_, s), r in zip(kinds, extra[2:4], strict=True))
    body += [
        f'<coordinates><point id="C" x="{x:.5f}" y="{y:.5f}"/>',
        '<cov-mat dim="2" band="1"> 16 6 25 </cov-mat></coordinates>',
        f'<vectors><vec from="A" to="D" dx="{dx:.5f}" dy="{dy:.5f}" dz="{extra[4].value:.5f}"/>',
        '<cov-mat dim="3" band="1"> 9 2 12 3 30 </cov-mat></vectors>',
    ]
    count = len(readings)
    matrix = np.zeros((count + 5, count + 5))
    matrix[:count, :count] = np.diag([r.sigma**2 for r in readings])
    matrix[count : count + 2, count : count + 2] = plane * np.outer(hands, hands) * MM**2
    turned = np.append(hands, 1.0)
    matrix[count + 2 :, count + 2 :] = space * np.outer(turned, turned) * MM**2
    compare(tmp_path, dialect.file(body), adjusted([*readings, *extra], matrix))


@pytest.mark.parametrize(
    "inside",
    [
        '<!DOCTYPE gama-local [<!ENTITY a "B">]>',
        '<!DOCTYPE gama-local [<!ENTITY % p SYSTEM "file:///etc/passwd"> %p;]>',
        '<!DOCTYPE gama-local SYSTEM "x.dtd" [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    ],
)
def test_a_doctype_with_entities_is_refused(tmp_path: Path, inside: str) -> None:
    dialect = Dialect(prolog=inside)
    file = tmp_path / "n.gkf"
    text = dialect.file(clusters(dialect, survey(np.random.default_rng(5))))
    file.write_text(text, encoding="utf-8")
    with pytest.raises(api.SurveyError, match="entities"):
        api.adjust(file)


def test_names_composed_and_decomposed_are_one(tmp_path: Path) -> None:
    dialect = Dialect()
    readings = survey(np.random.default_rng(9))
    body = [line.replace('to="C"', 'to="O\u0308"') for line in clusters(dialect, readings)]
    text = dialect.file(body).replace('id="C"', 'id="\u00d6"')
    text = text.replace('from="C"', 'from="\u00d6"').replace('bs="C"', 'bs="\u00d6"')
    places, squares, sigmas = adjusted(readings)
    places["\u00d6"], sigmas["\u00d6"] = places.pop("C"), sigmas.pop("C")
    compare(tmp_path, text, (places, squares, sigmas))


def test_what_is_not_declared_is_left_out_and_the_rest_stays(tmp_path: Path) -> None:
    dialect = Dialect()
    readings = survey(np.random.default_rng(10))
    body = clusters(dialect, readings)
    place = body.index("</obs>")
    body[place:place] = [
        '<direction to="X" val="12.0" stdev="8"/>',
        '<s-distance to="X" val="12.0" stdev="2"/>',
    ]
    compare(tmp_path, dialect.file(body), adjusted(readings))
    told = [
        w.text for w in api.adjust(tmp_path / "n.gkf").warnings if w.code == "undeclared_points"
    ]
    assert len(told) == 1
    assert "2 observations" in told[0]
    assert "X" in told[0]
