"""Field files of a simulated traverse, written by the layouts of the formats alone.

Pointings are in degrees and metres; each writer rounds them to what its format holds and returns
the text. What an importer must make of them is computed here from the rounded values.
"""

from __future__ import annotations

import random
from dataclasses import dataclass


@dataclass(frozen=True)
class Sight:
    """One pointing of the truth: degrees, metres."""

    setup: int
    round: int
    at: str
    to: str
    face: str
    hz: float
    v: float
    sd: float
    hi: float
    ht: float


@dataclass(frozen=True)
class Setup:
    name: str
    e: float
    n: float
    h: float
    hi: float


def simulated(stations: int = 3, rounds: int = 2, seed: int = 7) -> tuple[list[Setup], list[Sight]]:
    """Set-ups and pointings in the order I I II II, the circle turned between rounds."""
    r = random.Random(seed)
    setups, sights = [], []
    for i in range(stations):
        name = str(102 + i)
        setup = Setup(
            name, 1000 + 80.123 * i, 2000 - 5.456 * i, -312.5 - i, round(r.uniform(1.3, 1.7), 3)
        )
        setups.append(setup)
        targets = [
            (str(101 + i), r.uniform(0, 360), r.uniform(80, 100), r.uniform(40, 140)),
            (str(103 + i), r.uniform(0, 360), r.uniform(80, 100), r.uniform(40, 140)),
        ]
        heights = {name: round(r.uniform(1.2, 1.8), 3) for name, *_ in targets}
        for k in range(rounds):
            turn = r.uniform(20, 160) * (k + 1)
            for face, order in (("L", targets), ("R", targets[::-1])):
                for to, hz, v, sd in order:
                    c, x = 0.0008, -0.0005
                    hz_read = (hz + turn + (c if face == "L" else 180 - c)) % 360
                    v_read = v + x if face == "L" else 360 - v + x
                    noise = r.gauss(0, 0.0004)
                    sights.append(
                        Sight(
                            *(i, k, name, to, face, (hz_read + noise) % 360, v_read),
                            *(sd + r.gauss(0, 0.0005), setup.hi, heights[to]),
                        )
                    )
    return setups, sights


def mean_direction(left: float, right: float) -> float:
    gap = (right - 180 - left + 180) % 360 - 180
    return (left + gap / 2) % 360


# --- GSI

ANGLE_UNITS = {"gon": ("2", 1e5 / 0.9), "deg": ("3", 1e5), "mil": ("5", 1e4 * 6400 / 360)}
LENGTH_UNITS = {
    "m": ("0", 1e3),
    "m4": ("6", 1e4),
    "m5": ("8", 1e5),
    "ft": ("1", 1e3 / 0.3048),
    "ft4": ("7", 1e4 / 0.3048),
}


def _word(index: str, info: str, value: int | str, width: int) -> str:
    sign = "-" if isinstance(value, int) and value < 0 else "+"
    text = str(abs(value)) if isinstance(value, int) else value
    return f"{index}{info}{sign}{text.rjust(width, '0')} "


def angle_digits(degrees: float, unit: str) -> int:
    if unit == "dms":
        tenths = round(degrees * 36000)
        seconds, minutes, whole = tenths % 600, tenths // 600 % 60, tenths // 36000
        return whole * 100000 + minutes * 1000 + seconds
    return round(degrees * ANGLE_UNITS[unit][1])


def angle_value(digits: int, unit: str) -> float:
    if unit == "dms":
        return digits // 100000 + digits // 1000 % 100 / 60 + digits % 1000 / 36000
    return digits / ANGLE_UNITS[unit][1]


def gsi(
    setups: list[Setup],
    sights: list[Sight],
    *,
    width: int = 8,
    angle: str = "gon",
    length: str = "m",
    code: str | None = None,
    pair: str = "0008+000",
) -> list[str]:
    """Lines of a GSI file."""
    star = "*" if width == 16 else ""
    unit = "4" if angle == "dms" else ANGLE_UNITS[angle][0]
    metre, scale = LENGTH_UNITS[length]
    lines: list[str] = []
    last = None
    for s in sights:
        if s.setup != last:
            last, setup = s.setup, setups[s.setup]
            number = f"{(len(lines) + 1) % 10000:04d}"
            if code is not None:
                text = _word("41", number, code, width) + _word("42", "....", setup.name, width)
                text += _word("43", "....", round(setup.hi * 1000), width)
            else:
                text = _word("11", number, setup.name, width)
                for index, value in (("84", setup.e), ("85", setup.n), ("86", setup.h)):
                    text += _word(index, f"..1{metre}", round(value * scale), width)
                text += _word("88", f"..1{metre}", round(setup.hi * scale), width)
            lines.append(star + text)
        number = f"{(len(lines) + 1) % 10000:04d}"
        text = _word("11", number, s.to, width)
        text += _word("21", f".32{unit}", angle_digits(s.hz, angle), width)
        text += _word("22", f".32{unit}", angle_digits(s.v, angle), width)
        text += _word("31", f"..0{metre}", round(s.sd * scale), width)
        text += _word("51", "..1.", pair, width)
        text += _word("87", f"..1{metre}", round(s.ht * scale), width)
        lines.append(star + text)
    return lines


# --- SDR


def sdr(
    setups: list[Setup],
    sights: list[Sight],
    *,
    version: str = "SDR33",
    angle: str = "deg",
    feet: bool = False,
    order: str = "NEZ",
    horizon: bool = False,
    trimmed: bool = False,
) -> list[str]:
    """Lines of an SDR file."""
    name, value = (16, 16) if version == "SDR33" else (4, 10)
    digits = 8 if version == "SDR33" else 4
    turn = {"deg": 1.0, "gon": 1 / 0.9, "mil": 6400 / 360}[angle]
    foot = 1 / 0.3048 if feet else 1.0

    def number(x: float) -> str:
        return f"{x:.{digits}f}".ljust(value)

    flags = {"deg": "1", "gon": "2", "mil": "4"}[angle] + ("2" if feet else "1") + "11"
    flags += "1" if order == "NEZ" else "2"
    lines = [f"00NM{version + ' V04-04.02':<16}{'28-Nov-26 13:00':>19} {flags}1"]
    lines += [f"10NM{'JOB':<16}121111", "13PCP.C. mm Applied:-30.000"]
    if horizon:
        lines.append("01NM" + " " * 46 + "2")
    last, height = None, None
    for s in sights:
        if s.setup != last:
            last, p = s.setup, setups[s.setup]
            pair = (p.n, p.e) if order == "NEZ" else (p.e, p.n)
            place = "".join(number(x * foot) for x in (*pair, p.h, p.hi))
            lines.append(f"02TP{p.name:>{name}}{place}{'':<16}")
            height = None
        if s.ht != height:
            height = s.ht
            lines.append(f"03NM{number(s.ht * foot)}")
        v = (90 - s.v) if horizon else s.v
        text = number(s.sd * foot) + number(v * turn) + number(s.hz * turn)
        lines.append(f"09F{1 if s.face == 'L' else 2}{s.at:>{name}}{s.to:>{name}}{text}")
    return [line.rstrip() for line in lines] if trimmed else lines


# --- JobXML


def jobxml(
    setups: list[Setup],
    sights: list[Sight],
    *,
    prism: float = -0.0345,
    ppm: float = 12.5,
    namespace: str = "",
) -> list[str]:
    """Lines of a JobXML file, one record each; distances are stored raw."""
    space = f' xmlns="{namespace}"' if namespace else ""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f'<JOBFile{space} version="5.7"><FieldBook>']
    lines.append(
        f'<AtmosphereRecord ID="A"><Pressure>1013</Pressure><Temperature>15</Temperature>'
        f"<PPM>{ppm}</PPM></AtmosphereRecord>"
    )
    last = None
    for i, s in enumerate(sights):
        if s.setup != last:
            last, p = s.setup, setups[s.setup]
            lines.append(
                f"<PointRecord><Name>{p.name}</Name><Method>Coordinates</Method><Deleted>false"
                f"</Deleted><Grid><North>{p.n}</North><East>{p.e}</East><Elevation>{p.h}"
                "</Elevation></Grid></PointRecord>"
            )
            lines.append(
                f'<StationRecord ID="S{last}"><StationName>{p.name}</StationName>'
                f"<TheodoliteHeight>{p.hi}</TheodoliteHeight><AtmosphereID>A</AtmosphereID>"
                "</StationRecord>"
            )
        lines.append(
            f'<TargetRecord ID="T{i}"><PrismConstant>{prism}</PrismConstant>'
            f"<TargetHeight>{s.ht}</TargetHeight></TargetRecord>"
        )
        raw = (s.sd - prism) / (1 + ppm * 1e-6)
        lines.append(
            f'<PointRecord ID="P{i}"><Name>{s.to}</Name><Method>DirectReading</Method><Deleted>'
            f"false</Deleted><Circle><HorizontalCircle>{s.hz:.9f}</HorizontalCircle>"
            f"<VerticalCircle>{s.v:.9f}</VerticalCircle><EDMDistance>{raw:.6f}</EDMDistance>"
            f"<Face>Face{1 if s.face == 'L' else 2}</Face></Circle><StationID>S{last}</StationID>"
            f"<TargetID>T{i}</TargetID></PointRecord>"
        )
    return [*lines, "</FieldBook></JOBFile>"]


# --- CSV


def table(
    sights: list[Sight],
    *,
    angle: str = "gon",
    feet: bool = False,
    separator: str = ",",
    comma: bool = False,
) -> list[str]:
    """Lines of a table with the columns Stn Tgt F HA ZA SD HI HT."""
    turn = {"gon": 1 / 0.9, "deg": 1.0, "mil": 6400 / 360}[angle]
    foot = 1 / 0.3048 if feet else 1.0
    lines = [separator.join(("Stn", "Tgt", "F", "HA", "ZA", "SD", "HI", "HT"))]
    for s in sights:
        numbers = [f"{s.hz * turn:.6f}", f"{s.v * turn:.6f}"]
        numbers += [f"{x * foot:.5f}" for x in (s.sd, s.hi, s.ht)]
        if comma:
            numbers = [x.replace(".", ",") for x in numbers]
        lines.append(separator.join([s.at, s.to, "I" if s.face == "L" else "II", *numbers]))
    return lines


TABLE_MAP = {
    "at": "Stn",
    "to": "Tgt",
    "face": "F",
    "hz": "HA",
    "v": "ZA",
    "sd": "SD",
    "hi": "HI",
    "ht": "HT",
}
