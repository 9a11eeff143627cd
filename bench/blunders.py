"""Planted blunders: which are told, which stay silent with harm; how often clean projects alarm.

A clean project is simulated (two calibrations, two surveys of one line, both ends of the line
fixed or not; or, lean, one calibration and one survey of a line without coordinates of its own),
read and checked through the public interface. Then one blunder is planted into its files as a hand
makes it. It is told where the project is refused or a confirmed check is not met;
it is silent with harm where nothing is told and the grid azimuth is off by more than three of its
own sigmas; "asked" are those of them that a warning or a check that only warns asks about. What no
second session, no fixed coordinates and no card could have told is listed with what would be needed
to see it.
"""

from __future__ import annotations

import math
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.coverage import specification, write_files
from surveyapp import api
from surveyapp.core.simulate.project import project_files, simulate_reversal_project
from surveyapp.core.simulate.specification import SwingMethod
from surveyapp.errors import SurveyError
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, parse_angle, wrap_pi

METHODS: tuple[SwingMethod, ...] = ("tracking", "transit", "amplitude")
LATITUDES_DEG = (47.0, -26.0, 62.0)
SIZES = {"1'": 60.0, "10'": 600.0, "1 deg": 3600.0, "1 gon": 3240.0}
HARM = 3.0
"""Sigmas by which a silent result must be off to count."""

Files = dict[str, str]
Plant = Callable[[Files, np.random.Generator], Files | None]


@dataclass(frozen=True, slots=True)
class Clean:
    """A clean project with its true azimuth [rad] and what could tell a blunder of it."""

    files: Files
    azimuth: float
    fixed: bool


def clean_projects(count: int, seed: int, *, lean: bool = False) -> Iterator[Clean]:
    """Simulated projects without a blunder; in every second the line has fixed coordinates.

    A lean one has a single calibration and a single survey, and coordinates of an old plan only.
    """
    rng = np.random.default_rng(seed)
    rounds = 1 if lean else 2
    for number in range(count):
        method, latitude = METHODS[number % 3], LATITUDES_DEG[(number // 3) % 3]
        spec = specification(method, latitude, rng)
        project = simulate_reversal_project(spec, rng, calibrations=rounds, surveys=rounds)
        files = project_files(project)
        survey = next(s for s in project.sessions if s.purpose == "survey")
        fixed = number % 2 == 0 and not lean
        if fixed:
            toml = files["project.toml"]
            for name in ("U1", "U2"):
                toml = toml.replace(f'name = "{name}"\n', f'name = "{name}"\nfixed = true\n')
            files["project.toml"] = toml
        yield Clean(files, survey.simulated.spec.line_azimuth, fixed)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one project.

    ``asked`` are the warnings and the checks that only warn.
    """

    told: tuple[str, ...]
    error: float | None
    sigma: float | None
    asked: frozenset[str] = frozenset()

    @property
    def harmful(self) -> bool:
        """Whether the azimuth is off by more than a user of its sigma expects."""
        if self.error is None or self.sigma is None:
            return False
        return abs(self.error) > HARM * self.sigma


def judged(files: Files, azimuth: float) -> Outcome:
    """Check and orient one project."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_files(folder, files)
        try:
            result = api.orient(folder)
        except SurveyError:
            return Outcome(("refused",), None, None)
        failed = [check for check in result.checks if check.passed is False]
        told = tuple(check.rule for check in failed if check.confirmed)
        asked = frozenset(check.rule for check in failed if not check.confirmed)
        asked |= {warning.code for warning in result.warnings}
    lines = [line for line in result.lines if line.grid_azimuth is not None]
    if not lines or lines[0].grid_azimuth is None:
        return Outcome(told or ("no azimuth",), None, None)
    found = lines[0].grid_azimuth
    true = azimuth + (math.pi if lines[0].station == "U2" else 0.0)
    return Outcome(told, wrap_pi(found.value - true), found.sigma, asked)


ROW = re.compile(r"^(\d+),([^,]*),([^,]*),(\w+),([^,]*),(\w*),(\w*),(\w*)(.*)$")


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
NEEDED = {
    "clamp": "a second clamping of the line, or fixed coordinates",
    "ends of": "fixed coordinates of both ends",
    "known azimuths in gon": "coordinates of the known line",
    "other hemisphere": "times of the swing cannot tell (the period is that of the other latitude)",
    "lambda of": "times of the turning points or passages: the period",
    "another target": "fixed coordinates, or a second session of the line",
    "known azimuth": "coordinates of the known line, or a second known line",
    "scale": "two clampings of the line, or a second session clamped elsewhere",
    "card of another": "times of the turning points or passages: the period",
    "station 1 deg": "coordinates of the target, or a traverse from the calibration line",
    "line 1 deg": "a traverse from the calibration line: the coordinates of both ends agree",
    "face": "sights in both faces, a second session",
    "sight": "sights before and after in both faces, a second session",
    "tape zero": "tape zeros before and after, five readings each",
    "turning point": "six turning points or more, with their times",
    "passage": "five passages or more",
    "scale reading": "six scale readings or more",
    "books": "a second session of the line, or fixed coordinates",
}
"""What would be needed to see what stays silent."""


def needed(name: str) -> str:
    """What would be needed to see a blunder."""
    return next((text for key, text in NEEDED.items() if name.startswith(key)), "-")


def alarms(count: int, seed: int) -> tuple[int, Counter[str]]:
    """Clean projects that alarm, and the rules that do."""
    wrong, rules = 0, Counter[str]()
    for clean in clean_projects(count, seed):
        told = judged(clean.files, clean.azimuth).told
        wrong += bool(told)
        rules.update(told)
    return wrong, rules


def planted(count: int, seed: int, *, lean: bool = False) -> dict[str, list[tuple[bool, Outcome]]]:
    """Outcomes of planted blunders by name, with whether the line had fixed coordinates.

    What is asked about in the clean project too says nothing of the blunder and is left out.
    """
    rng = np.random.default_rng(seed)
    found: dict[str, list[tuple[bool, Outcome]]] = {name: [] for name in PLANTS}
    done = 0
    while done < count:
        for clean in clean_projects(6, seed + 1000 + done, lean=lean):
            before = judged(clean.files, clean.azimuth).asked
            for name, plant in PLANTS.items():
                files = plant(clean.files, rng)
                if files is not None:
                    outcome = judged(files, clean.azimuth)
                    outcome = replace(outcome, asked=outcome.asked - before)
                    found[name].append((clean.fixed, outcome))
                    done += 1
    return found


def table(found: dict[str, list[tuple[bool, Outcome]]]) -> list[str]:
    """What became of the planted blunders, by name."""
    total = sum(map(len, found.values()))
    silent = {
        name: [o for _, o in items if not o.told and o.harmful] for name, items in found.items()
    }
    mute = [outcome for items in silent.values() for outcome in items]
    asked = sum(bool(outcome.asked) for outcome in mute)
    lines = [f"planted {total}, silent with harm {len(mute)}, of these asked about {asked}"]
    lines.append(
        "blunder                          planted  told  harmless  silent  asked  with fixed ends"
    )
    for name, items in found.items():
        told = sum(bool(o.told) for _, o in items)
        mute, fixed = (
            silent[name],
            sum(not o.told and o.harmful for is_fixed, o in items if is_fixed),
        )
        warned = sum(bool(o.asked) for o in mute)
        rest = len(items) - told - len(mute)
        words = Counter(code for o in mute for code in o.asked)
        why = f"  {needed(name)}" if mute else ""
        why += f" [{', '.join(code for code, _ in words.most_common(3))}]" if words else ""
        lines.append(
            f"{name:<32} {len(items):>7} {told:>5} {rest:>9} {len(mute):>7} {warned:>6} {fixed:>6}"
            f"{why}"
        )
    return lines


def run(clean: int = 400, blunders: int = 1000, lean: int = 500) -> list[str]:
    """Clean projects, then blunders in full programmes and in lean ones."""
    wrong, rules = alarms(clean, 20261128)
    lines = [f"clean projects {clean}, that alarm {wrong} ({wrong / clean:.1%})"]
    lines += [f"  {rule}: {number}" for rule, number in rules.most_common()]
    lines += ["two calibrations, two surveys", *table(planted(blunders, 20261129))]
    lines += ["one calibration, one survey, no coordinates of the line"]
    return lines + table(planted(lean, 20261130, lean=True))
