"""Field files drawn at random: a truth, written in a dialect of a format, and what it must become.

Written by the layouts of the formats alone and independent of ``field_writers``: stations and
targets, order of faces and rounds, units of every word, conventions of stations, words that are
results, line ends and blank lines are drawn. The truth holds what the digits in the file say.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

FOOT = 0.3048


@dataclass
class Shot:
    """One pointing as the digits say: degrees and metres, None where nothing is written."""

    at: str
    to: str
    set: tuple[int, int]
    face: str
    hz: float
    v: float
    sd: float | None
    hi: float | None
    ht: float | None


@dataclass
class Stand:
    """One set-up: station with its coordinates and height of the instrument."""

    name: str
    place: tuple[float, float, float] | None
    hi: float
    shots: list[Shot] = field(default_factory=list)


@dataclass
class Written:
    """A file: its lines, options of its import, the truth of the digits, how it was drawn."""

    form: str
    lines: list[str]
    end: str
    options: dict[str, object]
    stands: list[Stand]
    dialect: str

    @property
    def shots(self) -> list[Shot]:
        return [shot for stand in self.stands for shot in stand.shots]

    def data(self) -> bytes:
        return (self.end.join(self.lines) + self.end).encode("latin-1")


def _names(r: random.Random, count: int) -> list[str]:
    style = r.choice(("digits", "letters", "mixed"))
    if style == "digits":
        first = r.choice((1, 101, 5000))
        return [str(first + i) for i in range(count)]
    if style == "letters":
        return [f"{r.choice('ABKPS')}{i + 1}" for i in range(count)]
    return [f"{r.choice(('TP', 'L', 'S'))}{i}{r.choice('abN')}" for i in range(count)]


ORDERS: tuple[Callable[[list[str]], list[tuple[str, str]]], ...] = (
    lambda names: [(n, "L") for n in names] + [(n, "R") for n in reversed(names)],
    lambda names: [(n, "L") for n in names] + [(n, "R") for n in names],
    lambda names: [(n, f) for n in names for f in "LR"],
    lambda names: [(n, "R") for n in names] + [(n, "L") for n in reversed(names)],
    lambda names: [(n, f) for i, n in enumerate(names) for f in ("LR" if i % 2 == 0 else "RL")],
)


def survey(r: random.Random) -> list[Stand]:
    """A truth: set-ups with their pointings, not yet rounded to any format."""
    stands, rounds = [], r.randint(1, 4)
    names = _names(r, r.randint(4, 7))
    count = r.randint(1, len(names) - 2)
    order = r.choice(ORDERS)
    turned = r.random() < 0.7
    hanging = r.random() < 0.3
    for i in range(count):
        near = [names[i], *names[i + 2 : i + 2 + r.randint(1, 3)]]
        place = (r.uniform(-900, 90000), r.uniform(-900, 90000), r.uniform(-900, 900))
        hi = round(r.uniform(1.2, 1.8), 3)
        stand = Stand(names[i + 1], place, hi)
        rays = {n: (360.0 * (k + r.uniform(0.1, 0.8)) / len(near)) for k, n in enumerate(near)}
        steep = {n: r.uniform(70, 110) for n in near}
        length = {n: r.uniform(5, 300) for n in near}
        height = {n: round(r.uniform(-1.9, 1.9) if hanging else r.uniform(0.1, 2), 3) for n in near}
        c, x = r.gauss(0, 0.002), r.gauss(0, 0.002)
        turn = 0.0
        for k in range(rounds):
            if k == 0 or turned:
                turn += r.uniform(20, 70) if k else r.uniform(0, 360)
            for to, face in order(near):
                hz = rays[to] + turn + (c if face == "L" else 180 - c) + r.gauss(0, 0.0005)
                v = steep[to] + x if face == "L" else 360 - steep[to] + x
                sd = length[to] + r.gauss(0, 0.0007)
                stand.shots.append(
                    Shot(stand.name, to, (i, k), face, hz % 360, v, sd, hi, height[to])
                )
        stands.append(stand)
    return stands


# --- Leica GSI

CIRCLE = {"2": (0.9, 5), "3": (1.0, 5), "5": (360 / 6400, 4)}
LENGTH = {"0": 1e-3, "6": 1e-4, "8": 1e-5, "1": 1e-3 * FOOT, "7": 1e-4 * FOOT}


def _circle_digits(value: float, unit: str) -> tuple[int, float]:
    """Digits of a circle reading and the degrees they say."""
    if unit == "4":
        tenths = round(value * 36000) % (360 * 36000)
        d, m, s = tenths // 36000, tenths // 600 % 60, tenths % 600
        return d * 100000 + m * 1000 + s, tenths / 36000
    factor, places = CIRCLE[unit]
    whole = round(360 / factor * 10**places)
    digits = round(value / factor * 10**places) % whole
    return digits, digits * factor / 10**places


class _Gsi:
    def __init__(self, r: random.Random) -> None:
        self.r = r
        self.width = r.choice((8, 16))
        self.number = r.choice((0, 0, 9990))
        self.lines: list[str] = []
        self.tail = r.choice((" ", " ", ""))

    def word(self, index: str, info: str, value: int | str) -> str:
        sign = "-" if isinstance(value, int) and value < 0 else "+"
        text = str(abs(value)) if isinstance(value, int) else value
        assert len(text) <= self.width, (index, text)
        return f"{index}{info}{sign}{text.rjust(self.width, '0')}"

    def length(self, index: str, unit: str, value: float) -> tuple[str, float]:
        digits = round(value / LENGTH[unit])
        return self.word(index, f"..1{unit}", digits), digits * LENGTH[unit]

    def block(self, index: str, name: str, words: list[str]) -> None:
        self.number = (self.number + 1) % 10000
        head = self.word(index, f"{self.number:04d}", name)
        star = "*" if self.width == 16 else ""
        self.lines.append(star + " ".join([head, *words]) + self.tail)


def gsi(r: random.Random) -> Written:
    """GSI-8 or 16, stations as blocks or code blocks, units by word."""
    stands, g = survey(r), _Gsi(r)
    code = r.choice((None, None, "2", "21", "STN"))
    angle, angle2 = r.choice("2345"), r.choice("2345")
    if r.random() < 0.7:
        angle2 = angle
    far, near = r.choice("06817"), r.choice("06817")
    if g.width == 8:
        far = r.choice("0")
    extra = r.choice(("none", "results", "32", "remark", "58", "time", "dashes"))
    pair = "0008+000" if g.width == 8 else r.choice(("00000008+0000000", "000000000008+000"))
    for stand in stands:
        if code is None:
            assert stand.place is not None
            words, said = [], []
            for index, value in zip(("84", "85", "86"), stand.place, strict=True):
                word, metres = g.length(index, far, value)
                words.append(word)
                said.append(metres)
            word, stand.hi = g.length("88", near, stand.hi)
            g.block("11", stand.name, [*words, word])
            stand.place = (said[0], said[1], said[2])
        else:
            stand.place = None
            if r.random() < 0.5:
                text = g.word("43", "....", round(stand.hi * 1000))
            else:
                text = g.word("43", "....", f"{stand.hi:.3f}")
            g.block("41", code, [g.word("42", "....", stand.name), text])
            if r.random() < 0.3:
                g.block("41", "99", [g.word("42", "....", "NOTE")])
        for shot in stand.shots:
            shot.hi = stand.hi
            digits, shot.hz = _circle_digits(shot.hz, angle)
            words = [g.word("21", f".32{angle}", digits)]
            digits, shot.v = _circle_digits(shot.v, angle2)
            words.append(g.word("22", f".32{angle2}", digits))
            assert shot.sd is not None
            assert shot.ht is not None
            sd: float | None
            word, sd = g.length("31", near, shot.sd)
            if r.random() < 0.05:
                word, sd = g.word("31", f"..0{near}", 0), None  # not measured
            words.append(word)
            if extra in ("results", "32"):
                flat = shot.sd * abs(math.sin(math.radians(shot.v)))
                words.append(g.length("32", near, flat)[0])
            if extra == "results":
                words.append(g.length("33", near, shot.sd * math.cos(math.radians(shot.v)))[0])
                words += [g.length(i, far, 12.5 * int(i) - 900)[0] for i in ("81", "82", "83")]
            if extra == "58":
                words += [g.word("58", "..16", 175), g.word("59", "..16", 83000)]
            else:
                words.append(g.word("51", "..1.", pair))
            word, shot.ht = g.length("87", near, shot.ht)
            words.append(word)
            shot.sd = sd
            if extra == "remark":
                words.append(g.word("71", "....", r.choice(("PILLAR", "0", "B-4"))))
            elif extra == "dashes":
                words.append(g.word("71", "....", "-----"))
            elif extra == "time":
                words.append(g.word("19", "....", "11281305"))
            g.block("11", shot.to, words)
    lines, end = g.lines, r.choice(("\n", "\r\n", "\r"))
    if r.random() < 0.2:
        lines.insert(r.randrange(len(lines)), r.choice(("", "   ")))
    if r.random() < 0.1:
        lines = [(" " if not g.tail else "").join(lines)]
    told = f"GSI-{g.width} code {code} angle {angle}{angle2} length {far}{near} {extra}"
    options: dict[str, object] = {} if code is None else {"station_code": code}
    return Written("gsi", lines, end, options, stands, told)


# --- Sokkia SDR


def sdr(r: random.Random) -> Written:
    """SDR33 or SDR20 in any of their units; face records or means beside them."""
    stands = survey(r)
    version = r.choice(("SDR33", "SDR20"))
    name, width, places = (16, 16, 8) if version == "SDR33" else (4, 10, 4)
    unit = r.choice("124")
    turn = {"1": 1.0, "2": 0.9, "4": 360 / 6400}[unit]
    feet = r.choice((False, False, True))
    factor = FOOT if feet else 1.0
    order = r.choice("12")
    horizon = r.random() < 0.25
    means = r.random() < 0.3

    def number(value: float) -> tuple[str, float]:
        text = f"{value:.{places}f}"
        while len(text) > width:
            text = text[:-1]
        return text.ljust(width), float(text)

    def length(value: float | None) -> tuple[str, float | None]:
        if value is None:
            return " " * width, None
        text, said = number(value / factor)
        return text, said * factor

    head = f"00NM{version + ' V04-04.02':<16}{'':<4}{'28-Nov-26 13:00':<15} "
    lines = [f"{head}{unit}{'2' if feet else '1'}11{order}1"]
    lines += [f"10NM{'JOB':<{name}}121111", "06NM" + number(1.0)[0]]
    prism = r.choice((None, "Applied", "Not applied"))
    if prism is not None:
        lines.append(f"13PCP.C. mm {prism}:-30.000")
    if horizon:
        lines.append("01NM" + f"{'INSTR':<16}{'123456':<30}" + "2")
    for stand in stands:
        assert stand.place is not None
        e, n, h = stand.place
        texts, said = [], []
        for value in (n, e) if order == "1" else (e, n):
            text, metres = length(value)
            texts.append(text)
            said.append(metres or 0.0)
        text, height = length(h)
        told, hi = length(stand.hi)
        stand.place = (
            (said[1], said[0], height or 0.0) if order == "1" else (said[0], said[1], height or 0.0)
        )
        assert hi is not None
        stand.hi = hi
        lines.append(f"02TP{stand.name:>{name}}{''.join(texts)}{text}{told}{'':<16}")
        last: float | None = None
        for shot in stand.shots:
            if shot.ht != last:
                last = shot.ht
                text, written = length(shot.ht)
                lines.append("03NM" + text)
            shot.hi, shot.ht = stand.hi, written
            empty = r.random() < 0.05
            sd_text, shot.sd = length(None if empty else shot.sd)
            if shot.sd is not None and prism == "Not applied":
                shot.sd -= 0.030
            v = 90.0 - shot.v if horizon else shot.v
            v_text, v = number(v / turn)
            shot.v = (90.0 - v * turn) % 360 if horizon else v * turn
            hz_text, hz = number(shot.hz / turn)
            shot.hz = hz * turn % 360
            kind = 1 if shot.face == "L" else 2
            lines.append(
                f"09F{kind}{shot.at:>{name}}{shot.to:>{name}}{sd_text}{v_text}{hz_text}{'':<16}"
            )
            if means and shot.face == "R":
                lines.append(
                    f"09MC{shot.at:>{name}}{shot.to:>{name}}"
                    f"{number(5.0)[0]}{number(90 / turn)[0]}{number(7 / turn)[0]}{'':<16}"
                )
    if r.random() < 0.3:
        lines = [line.rstrip() for line in lines]
    if r.random() < 0.2:
        lines = ["\x02", *lines, "\x03"]
    told = f"{version} angle {unit} feet {feet} order {order} horizon {horizon} {prism}"
    return Written("sdr", lines, r.choice(("\n", "\r\n")), {}, stands, told)


# --- Trimble JobXML


def jobxml(r: random.Random) -> Written:
    """Raw distances with prism and ppm; deleted records, faces as null, results beside them."""
    stands = survey(r)
    prism, ppm = r.choice((0.0, -0.0345, 0.0175)), r.choice((0.0, 12.5, -31.2))
    nulls = r.random() < 0.3
    space = r.choice(("", ' xmlns="http://www.trimble.com/schema/JobXML/5_6"'))
    prefix = r.choice(("", "")) if space else ""
    units = f"<AngleUnits>{r.choice(('Gons', 'DMSDegrees', 'Mils'))}</AngleUnits>"
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<JOBFile{space} jobName="J" version="5.7">',
        f"<Environment><DisplaySettings>{units}</DisplaySettings></Environment>",
        "<FieldBook>",
        f'<AtmosphereRecord ID="a1"><Pressure>1013.2</Pressure><Temperature>15.5</Temperature>'
        f"<PPM>{ppm}</PPM></AtmosphereRecord>",
    ]
    number = 0
    for i, stand in enumerate(stands):
        assert stand.place is not None
        e, n, h = stand.place = tuple(round(x, 4) for x in stand.place)  # type: ignore[assignment]
        lines.append(
            f'<PointRecord ID="c{i}"><Name>{stand.name}</Name><Method>Coordinates</Method>'
            f"<Deleted>false</Deleted><Grid><North>{n}</North><East>{e}</East>"
            f"<Elevation>{h}</Elevation></Grid></PointRecord>"
        )
        lines.append(
            f'<StationRecord ID="s{i}"><StationName>{stand.name}</StationName>'
            f"<TheodoliteHeight>{stand.hi}</TheodoliteHeight><ScaleFactor>1</ScaleFactor>"
            "<AtmosphereID>a1</AtmosphereID></StationRecord>"
        )
        heights = sorted({shot.ht for shot in stand.shots if shot.ht is not None})
        for k, height in enumerate(heights):
            lines.append(
                f'<TargetRecord ID="t{i}-{k}"><PrismType>Custom</PrismType>'
                f"<PrismConstant>{prism}</PrismConstant><TargetHeight>{height}</TargetHeight>"
                "</TargetRecord>"
            )
        for shot in stand.shots:
            assert shot.ht is not None
            assert shot.sd is not None
            shot.hi = stand.hi
            shot.hz, shot.v = round(shot.hz, 8) % 360, round(shot.v, 8)
            raw = round((shot.sd - prism) / (1 + ppm * 1e-6), 4)
            shot.sd = raw + prism + raw * ppm * 1e-6
            distance = f"<EDMDistance>{raw:.4f}</EDMDistance>"
            if r.random() < 0.05:
                distance, shot.sd = r.choice(("<EDMDistance></EDMDistance>", "")), None
            face = "FaceNull" if nulls else "Face1" if shot.face == "L" else "Face2"
            common = (
                f"<StationID>s{i}</StationID><TargetID>t{i}-{heights.index(shot.ht)}</TargetID>"
            )
            for deleted in (True, False) if r.random() < 0.1 else (False,):
                number += 1
                hz = (shot.hz + 3.0) % 360 if deleted else shot.hz
                lines.append(
                    f'<PointRecord ID="p{number}" TimeStamp="2026-11-28T13:00:00">'
                    f"<Name>{shot.to}</Name><Code/><Method>DirectReading</Method>"
                    f"<Deleted>{str(deleted).lower()}</Deleted><Circle><HorizontalCircle>{hz:.8f}"
                    f"</HorizontalCircle><VerticalCircle>{shot.v:.8f}</VerticalCircle>{distance}"
                    f"<Face>{face}</Face></Circle>{common}</PointRecord>"
                )
        if r.random() < 0.3:
            number += 1
            lines.append(
                f'<PointRecord ID="p{number}"><Name>{stand.shots[0].to}</Name>'
                "<Method>MeanTurnedAngle</Method><Deleted>false</Deleted><Circle>"
                "<HorizontalCircle>11.0</HorizontalCircle><VerticalCircle>91.0</VerticalCircle>"
                f"<EDMDistance>7.0</EDMDistance></Circle><StationID>s{i}</StationID></PointRecord>"
            )
    lines += [
        "</FieldBook>",
        "<Reductions><Point><Name>1</Name></Point></Reductions>",
        "</JOBFile>",
    ]
    told = f"JobXML prism {prism} ppm {ppm} nulls {nulls} {space}{prefix}"
    return Written("jobxml", lines, r.choice(("\n", "\r\n")), {}, stands, told)


# --- CSV


def _dms(value: float, style: str) -> tuple[str, float]:
    tenths = round(value * 36000) % (360 * 36000)
    d, m, s = tenths // 36000, tenths // 600 % 60, tenths % 600
    text = {"-": f"{d}-{m:02d}-{s / 10:04.1f}", " ": f"{d} {m} {s / 10:.1f}"}.get(
        style, f"{d}:{m:02d}:{s / 10:04.1f}"
    )
    return text, tenths / 36000


def table(r: random.Random) -> Written:
    """A table in any units, separators and names of columns."""
    stands = survey(r)
    angle = r.choice(("gon", "deg", "dms", "mil", "rad"))
    turn = {"gon": 0.9, "deg": 1.0, "mil": 360 / 6400, "rad": 180 / math.pi, "dms": 1.0}[angle]
    length = r.choice(("m", "mm", "cm", "ft"))
    heights = r.choice(("m", "mm", "ft"))
    factors = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "ft": FOOT}
    separator = r.choice(",;\t|")
    comma = separator != "," and r.random() < 0.5
    faces = r.choice((("I", "II"), ("L", "R"), ("1", "2"), ("l", "r"), None))
    stated = r.random() < 0.5
    style = r.choice("- :")
    names = ["Stn", "Tgt", "HA", "ZA", "SD", "HI", "HT"]
    quantities = ["at", "to", "hz", "v", "sd", "hi", "ht"]
    if faces:
        names.insert(2, "F")
        quantities.insert(2, "face")
    if stated:
        names.append("Set")
        quantities.append("set")
    shift = list(range(len(names)))
    r.shuffle(shift)
    header = [names[k] for k in shift]
    header.insert(r.randrange(len(header) + 1), "Remark")
    lines = [separator.join(header)]

    def number(value: float, places: int) -> tuple[str, float]:
        text = f"{value:.{places}f}"
        return text.replace(".", ",") if comma else text, float(text)

    for stand in stands:
        stand.place = None
        for shot in stand.shots:
            assert shot.sd is not None
            assert shot.ht is not None
            cells = {"Stn": shot.at, "Tgt": shot.to, "Remark": "", "Set": str(shot.set[1] + 1)}
            for column, key in (("HA", "hz"), ("ZA", "v")):
                value = getattr(shot, key)
                if angle == "dms":
                    text, said = _dms(value, style)
                    cells[column] = text.replace(".", ",") if comma else text
                else:
                    places = {"rad": 9, "gon": 5, "deg": 6, "mil": 4}[angle]
                    cells[column], said = number(value / turn, places)
                    said *= turn
                setattr(shot, key, said % 360)
            for column, key, unit in (
                ("SD", "sd", length),
                ("HI", "hi", heights),
                ("HT", "ht", heights),
            ):
                value = getattr(shot, key)
                if key == "sd" and r.random() < 0.05:
                    cells[column] = ""
                    shot.sd = None
                    continue
                cells[column], said = number(value / factors[unit], 1 if unit == "mm" else 4)
                setattr(shot, key, said * factors[unit])
            if faces:
                cells["F"] = faces[0] if shot.face == "L" else faces[1]
            lines.append(separator.join(cells[name] for name in header))
    units = {"hz": angle, "v": angle, "sd": length, "hi": heights, "ht": heights}
    columns = dict(zip(quantities, names, strict=True))
    told = f"CSV {angle} {length} {heights} {separator!r} comma {comma} {faces} {stated} {style}"
    options: dict[str, object] = {"columns": columns, "units": units}
    return Written("csv", lines, r.choice(("\n", "\r\n")), options, stands, told)


DIALECTS: dict[str, Callable[[random.Random], Written]] = {
    "gsi": gsi,
    "sdr": sdr,
    "jobxml": jobxml,
    "csv": table,
}
