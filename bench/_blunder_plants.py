"""Blunders as hands make them: each changes the files of a clean project in one place.

A plant gives None where a project holds nothing that it could be made in.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np

from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, parse_angle

SIZES = {"1'": 60.0, "10'": 600.0, "1 deg": 3600.0, "1 gon": 3240.0}

Files = dict[str, str]
Plant = Callable[[Files, np.random.Generator], Files | None]


def _rows(files: Files, book: str) -> list[list[str]]:
    return [line.split(",") for line in files[book].splitlines()]


def _with(files: Files, book: str, rows: list[list[str]]) -> Files:
    return files | {book: "\n".join(",".join(row) for row in rows) + "\n"}


def _books(files: Files) -> list[str]:
    return sorted(name for name in files if name.startswith("observations/"))


def _of_kind(rows: list[list[str]], *kinds: str) -> list[int]:
    place = rows[0].index("kind")
    return [i for i, row in enumerate(rows) if i and row[place] in kinds]


def _shifted(kind: str, arcsec: float) -> Plant:
    """One reading of a kind off by so much."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        found = _of_kind(rows, kind)
        if not found:
            return None
        row, value = int(rng.choice(found)), rows[0].index("value")
        angle = parse_angle(rows[row][value], AngleUnit.DMS) + arcsec / RHO_ARCSEC
        rows[row][value] = format_angle(angle % (2.0 * math.pi), AngleUnit.DMS, 1)
        return _with(files, book, rows)

    return plant


def _all_sights(arcsec: float) -> Plant:
    """Another target: every sight of one session off alike."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        value = rows[0].index("value")
        for row in _of_kind(rows, "backsight"):
            angle = parse_angle(rows[row][value], AngleUnit.DMS) + arcsec / RHO_ARCSEC
            rows[row][value] = format_angle(angle % (2.0 * math.pi), AngleUnit.DMS, 1)
        return _with(files, book, rows)

    return plant


def _divisions(kind: str, div: float, *, whole: bool = False) -> Plant:
    """One scale reading, or all of one side of the observation, off by so many divisions."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        found = _of_kind(rows, kind)
        if not found:
            return None
        value = rows[0].index("value")
        half = [i for i in found if i <= found[len(found) // 2 - 1]] if whole else None
        for row in half or [int(rng.choice(found))]:
            rows[row][value] = f"{float(rows[row][value]) + div:.3f}"
        return _with(files, book, rows)

    return plant


def _column(name: str, kind: str, change: Callable[[str], str]) -> Plant:
    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        found = _of_kind(rows, kind)
        if not found or name not in rows[0]:
            return None
        row, place = int(rng.choice(found)), rows[0].index(name)
        rows[row][place] = change(rows[row][place])
        return _with(files, book, rows)

    return plant


def _other_side(text: str) -> str:
    return {"L": "R", "R": "L"}.get(text, text)


def _missing(kind: str) -> Plant:
    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        found = _of_kind(rows, kind)
        if not found:
            return None
        del rows[int(rng.choice(found))]
        return _with(files, book, rows)

    return plant


def _swapped(kind: str) -> Plant:
    """The values of two neighbours exchanged."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        found = _of_kind(rows, kind)
        if len(found) < 2:
            return None
        first = int(rng.integers(len(found) - 1))
        i, j, value = found[first], found[first + 1], rows[0].index("value")
        rows[i][value], rows[j][value] = rows[j][value], rows[i][value]
        return _with(files, book, rows)

    return plant


def _late(kind: str, seconds: float) -> Plant:
    """The moment of one row, and its clock time left out."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        found = _of_kind(rows, kind)
        if not found:
            return None
        place, time = rows[0].index("elapsed_s"), rows[0].index("time")
        start = found[int(rng.integers(len(found)))]
        for row in range(start, len(rows)):
            rows[row][place] = f"{float(rows[row][place]) + seconds:.3f}"
            rows[row][time] = ""
        return _with(files, book, rows)

    return plant


def _known_azimuth(arcsec: float) -> Plant:
    """The known azimuth of one calibration mistyped."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        toml = files["project.toml"]
        found = list(re.finditer(r'azimuth_known = "([^"]*)"', toml))
        hit = found[int(rng.integers(len(found)))]
        angle = parse_angle(hit[1], AngleUnit.DMS) + arcsec / RHO_ARCSEC
        text = format_angle(angle % (2.0 * math.pi), AngleUnit.DMS, 3)
        return files | {"project.toml": toml[: hit.start(1)] + text + toml[hit.end(1) :]}

    return plant


def _text(name: str, pattern: str, new: str | Callable[[re.Match[str]], str]) -> Plant:
    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        changed = re.sub(pattern, new, files[name])
        return None if changed == files[name] else files | {name: changed}

    return plant


def _books_exchanged(files: Files, rng: np.random.Generator) -> Files | None:
    """The books of a calibration and a survey under each other's name."""
    known = [name for name in _books(files) if "/cal-" in name]
    sought = [name for name in _books(files) if "/run-" in name]
    one, other = str(rng.choice(known)), str(rng.choice(sought))
    return files | {one: files[other], other: files[one]}


def _moved(names: tuple[str, ...], degrees: float) -> Plant:
    """The longitude of some stations off by so much."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        toml = files["project.toml"]
        for name in names:
            found = re.search(rf'name = "{name}"\n(?:fixed = true\n)?lat = \S+\nlon = (\S+)', toml)
            if found is None:
                return None
            text = f"{float(found[1]) + degrees:.12f}"
            toml = toml[: found.start(1)] + text + toml[found.end(1) :]
        return files | {"project.toml": toml}

    return plant


def _ends_exchanged(purpose: str) -> Plant:
    """Station and target of the first line of a kind under each other's name."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        head, *tables = files["project.toml"].split("[[orientation]]")
        for place, table in enumerate(tables):
            if f'purpose = "{purpose}"' not in table:
                continue
            station, target = (
                re.search(rf'^{key} = "(.*)"', table, re.MULTILINE) for key in ("station", "target")
            )
            if station is None or target is None:
                return None
            other = table.replace(station[0], f'station = "{target[1]}"')
            tables[place] = other.replace(target[0], f'target = "{station[1]}"')
            break
        return files | {"project.toml": "[[orientation]]".join([head, *tables])}

    return plant


def _known_in_gon(files: Files, rng: np.random.Generator) -> Files | None:
    """Every known azimuth is the number of gon, written as degrees."""

    def changed(hit: re.Match[str]) -> str:
        angle = parse_angle(hit[1], AngleUnit.DMS)
        if angle > 1.8 * math.pi:
            return hit[0]
        return f'azimuth_known = "{format_angle(angle / 0.9, AngleUnit.DMS, 3)}"'

    toml = re.sub(r'azimuth_known = "([^"]*)"', changed, files["project.toml"])
    return None if toml == files["project.toml"] else files | {"project.toml": toml}


def _every_unit(unit: str) -> Plant:
    """The circle readings of one book in another unit than they were read in."""

    def plant(files: Files, rng: np.random.Generator) -> Files | None:
        book = str(rng.choice(_books(files)))
        rows = _rows(files, book)
        value, place = rows[0].index("value"), rows[0].index("unit")
        for row in _of_kind(rows, "backsight", "reversal", "clamp"):
            rows[row][value] = f"{math.degrees(parse_angle(rows[row][value], AngleUnit.DMS)):.5f}"
            rows[row][place] = unit
        return _with(files, book, rows)

    return plant


CARD = "cards/simulated-gyro.toml"
PLANTS: dict[str, Plant] = {
    **{f"sight {k}": _shifted("backsight", v) for k, v in SIZES.items()},
    **{f"turning point {k}": _shifted("reversal", v) for k, v in SIZES.items()},
    **{f"clamp {k}": _shifted("clamp", v) for k, v in SIZES.items()},
    **{f"another target {k}": _all_sights(v) for k, v in SIZES.items()},
    **{f"known azimuth {k}": _known_azimuth(v) for k, v in SIZES.items()},
    "tape zero 1 div": _divisions("tape_zero", 1.0),
    "tape zero before 3 div": _divisions("tape_zero", 3.0, whole=True),
    "scale reading 1 div": _divisions("scale_reversal", 1.0),
    "face": _column("face", "backsight", _other_side),
    "side": _column("side", "reversal", _other_side),
    "unit gon": _column("unit", "backsight", lambda _: "gon"),
    "sight missing": _missing("backsight"),
    "turning point missing": _missing("reversal"),
    "passage missing": _missing("transit"),
    "sights swapped": _swapped("backsight"),
    "turning points swapped": _swapped("reversal"),
    "passage a minute late": _late("transit", 60.0),
    "turning point a minute late": _late("reversal", 60.0),
    "an hour late": _late("transit", 3600.0),
    "scale value doubled": _text(
        CARD, r"scale_value_arcsec = [\d.]+", "scale_value_arcsec = 1200.0"
    ),
    "scale reversed": _text(CARD, r"scale_value_arcsec = ", "scale_value_arcsec = -"),
    "periods exchanged": _text(
        CARD, r"tracking_s = (\S+)\nclamped_s = (\S+)", r"tracking_s = \2\nclamped_s = \1"
    ),
    "card of another gyro": _text(
        CARD, r"tracking_s = \S+\nclamped_s = \S+", "tracking_s = 480.0\nclamped_s = 410.0"
    ),
    "books exchanged": _books_exchanged,
    "ends of the survey exchanged": _ends_exchanged("survey"),
    "ends of a calibration exchanged": _ends_exchanged("calibration"),
    "known azimuths in gon": _known_in_gon,
    "a book in gon": _every_unit("gon"),
    "tape zero missing": _missing("tape_zero"),
    "tape zeros swapped": _swapped("tape_zero"),
    "scale readings swapped": _swapped("scale_reversal"),
    "passages swapped": _swapped("transit"),
    "clamp missing": _missing("clamp"),
    "lambda of another latitude": _text(
        CARD, r"latitude_deg = (-?)(\d+)", lambda hit: f"latitude_deg = {hit[1]}{int(hit[2]) - 20}"
    ),
    "other hemisphere": _text(
        "project.toml", r"lat = (-?)(\S+)", lambda hit: f"lat = {'' if hit[1] else '-'}{hit[2]}"
    ),
    "station 1 deg away": _moved(("U1",), 1.0),
    "line 1 deg away": _moved(("U1", "U2"), 1.0),
    "latitude exchanged": _text("project.toml", r"lat = (\S+)\nlon = (\S+)", r"lat = \2\nlon = \1"),
}
"""Blunders by name."""
