"""Limits reached from project folders: the value that the data give, inside and outside."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.orientation.whole_project import orient_project
from surveyapp.core.tolerance import rule_book_checks
from surveyapp.core.tolerance.measures import measure
from surveyapp.domain.results import Check
from surveyapp.io.rulebooks import read_rule_book
from surveyapp_models.angles import AngleUnit, format_angle

HEAD = """format = 1
name = "Limits"
crs = "EPSG:4546"
rule_book = "{book}"
[[instrument]]
id = "G1"
card = "{card}"
{instrument}
[[station]]
name = "A"
lat = 34.5
lon = 111.2
[[station]]
name = "B"
lat = 34.503
lon = 111.204
"""
SESSION = """
[[orientation]]
id = "{id}"
station = "{station}"
target = "{target}"
instrument = "G1"
method = "{method}"
purpose = "{purpose}"
book = "observations/{id}.csv"
{more}
"""
COLUMNS = "seq,time,elapsed_s,kind,value,unit,face,side,temperature_c\n"
NORTH = 181.0


def dms(degrees: float) -> str:
    return format_angle(degrees / 57.29577951308232, AngleUnit.DMS, 3)


class Folder:
    """A project folder in the making."""

    def __init__(self, path: Path, book: str, card: str = "hgg05", instrument: str = "") -> None:
        self.path = path
        self.text = HEAD.format(book=book, card=card, instrument=instrument)
        (path / "observations").mkdir()

    def session(self, name: str, rows: list[str], **keys: str) -> Folder:
        values = {
            "station": "A",
            "target": "B",
            "method": "automatic",
            "purpose": "survey",
            "more": "",
            **keys,
        }
        self.text += SESSION.format(id=name, **values)
        lines = [f"{i},{row}" for i, row in enumerate(rows, start=1)]
        text = COLUMNS + "\n".join(lines) + "\n"
        (self.path / "observations" / f"{name}.csv").write_text(text, encoding="utf-8")
        return self

    def checks(self, rule: str) -> list[Check]:
        (self.path / "project.toml").write_text(self.text, encoding="utf-8")
        return [check for check in api.check(self.path) if check.rule == rule]


def azimuths(*degrees: float) -> list[str]:
    return [f",,azimuth,{dms(value)},dms,,," for value in degrees]


def swing(north: float = NORTH, minute: int = 0, shift: float = 0.0) -> list[str]:
    """Six turning points about a circle reading of north [deg], a sight before and after."""
    sights = [f",,backsight,{dms(40.0)},dms,L,,", f",,backsight,{dms(220.0)},dms,R,,"]
    after = [
        f",,backsight,{dms(40.0 + shift)},dms,L,,",
        f",,backsight,{dms(220.0 + shift)},dms,R,,",
    ]
    rows = []
    for k in range(6):
        seconds = 60 * minute + 215 * k
        stamp = f"2026-03-01T{8 + seconds // 3600:02d}:{seconds // 60 % 60:02d}:{seconds % 60:02d}Z"
        value = north + (1.0 - 0.01 * k) * (-1) ** k
        rows.append(f"{stamp},,reversal,{dms(value)},dms,,,")
    return [*sights, *rows, *after]


def rounds_difference(path: Path, value: float) -> list[Check]:
    rows = azimuths(100.0, 100.0 + value / 3600.0, 100.0 + 0.5 * value / 3600.0)
    return Folder(path, "automatic-gyro").session("a", rows).checks("automatic-gyro.rounds")


def rounds_across_north(path: Path, value: float) -> list[Check]:
    rows = azimuths(359.999, (359.999 + value / 3600.0) % 360.0)
    return Folder(path, "automatic-gyro").session("a", rows).checks("automatic-gyro.rounds")


def rounds_of_two_sessions(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "cn-coal-15", "wild-gak1")
    folder.session("a", swing(), method="tracking")
    folder.session("b", swing(NORTH + value / 3600.0), method="tracking")
    return folder.checks("cn-coal-15.rounds")


def calibrations(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "automatic-gyro")
    folder.session("a", azimuths(47.0), purpose="calibration")
    folder.session("b", azimuths(47.0 + value / 3600.0), purpose="calibration")
    return folder.checks("automatic-gyro.calibrations")


def epochs(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "metro")
    folder.session("a", azimuths(47.0), purpose="calibration", more="date = 2026-03-01")
    folder.session("s", azimuths(100.0), more="date = 2026-03-02")
    later = azimuths(47.0 + value / 3600.0)
    folder.session("b", later, purpose="calibration", more="date = 2026-03-03")
    return folder.checks("metro.constants")


def independent(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "freezing-shaft-example")
    folder.session("a", azimuths(100.0, 100.0), more="date = 2026-03-01")
    later = azimuths(100.0 + value / 3600.0)
    folder.session("b", later, more="date = 2026-03-05")
    return folder.checks("freezing-shaft-example.repeated")


def independent_mean(path: Path, value: float) -> list[Check]:
    """Two single azimuths of stated sigma s: their mean has s / sqrt(2)."""
    folder = Folder(
        path,
        "cn-coal-15",
        instrument=(
            "constant = { arcsec = 0.0, sigma_arcsec = 0.000001 }\nconstant_choice = 'known'"
        ),
    )
    more = f"sigma_arcsec = {value * 2**0.5!r}\ncentring_mm = {{ instrument = 0, target = 0 }}\n"
    folder.session("a", azimuths(100.0), more=more + "date = 2026-03-01")
    folder.session("b", azimuths(100.0), more=more + "date = 2026-03-05")
    return folder.checks("cn-coal-15.independent-mean")


def tape_zero(path: Path, value: float) -> list[Check]:
    rows = [f",,tape_zero,{value + s},div,,," for s in (2.0, -2.0, 2.0)]
    folder = Folder(path, "cn-coal-15", "wild-gak1").session(
        "a", [*rows, *swing()], method="tracking"
    )
    return [c for c in folder.checks("cn-coal-15.tape-zero") if c.where == "a before"]


def tape_zero_change(path: Path, value: float) -> list[Check]:
    def rows(zero: float) -> list[str]:
        return [f",,tape_zero,{zero + s},div,,," for s in (2.0, -2.0, 2.0)]

    folder = Folder(path, "metro", "wild-gak1").session(
        "a", [*rows(0.1), *swing(), *rows(0.1 - value)], method="tracking"
    )
    return folder.checks("metro.tape-zero-change")


def pre_tracking(path: Path, value: float) -> list[Check]:
    rows = [f",,clamp,{dms(NORTH + value / 60.0)},dms,,,", *swing()]
    folder = Folder(path, "cn-coal-15", "wild-gak1").session("a", rows, method="tracking")
    return folder.checks("cn-coal-15.pre-orientation-tracking")


def pre_transit(path: Path, value: float) -> list[Check]:
    """The measure alone: a tracked session whose method is said to be transit."""
    rows = [f",,clamp,{dms(NORTH + value / 60.0)},dms,,,", *swing()]
    folder = Folder(path, "cn-coal-15", "wild-gak1").session("a", rows, method="tracking")
    assert not folder.checks("nothing")
    project = api.open_project(path)
    orientation = orient_project(project, api.generator_of(project))
    (item,) = orientation.sessions
    item = replace(item, session=replace(item.session, method="transit"))
    measured = measure(replace(orientation, sessions=(item,)))
    checks = rule_book_checks(read_rule_book("cn-coal-15", base=Path()), measured)
    return [c for c in checks if c.rule == "cn-coal-15.pre-orientation-transit"]


def sights(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "cn-coal-15", "wild-gak1")
    folder.session("a", swing(shift=value / 3600.0), method="tracking")
    return folder.checks("cn-coal-15.sights")


def rotor_rest(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "cn-coal-15", "wild-gak1")
    folder.session("a", swing(), method="tracking")
    seconds = 5 * 215 + 60.0 * value
    rows = swing(NORTH + 90.0)
    rows = [_moved(row, seconds) for row in rows]
    folder.session("b", rows, method="tracking")
    return folder.checks("cn-coal-15.rotor-rest")


def _moved(row: str, seconds: float) -> str:
    if not row.startswith("2026"):
        return row
    stamp, rest = row.split(",", 1)
    at = int(stamp[11:13]) * 3600 + int(stamp[14:16]) * 60 + int(stamp[17:19]) + seconds
    return f"2026-03-01T{int(at // 3600):02d}:{int(at // 60 % 60):02d}:{at % 60:06.3f}Z,{rest}"


def circle_spacing(path: Path, value: float) -> list[Check]:
    """Rounds with the circle shifted; half a turn more is the same place of the circle."""
    folder = Folder(path, "cn-coal-15", "wild-gak1")
    folder.session("a", swing(), method="tracking")
    folder.session("b", swing(NORTH - value), method="tracking")
    return folder.checks("cn-coal-15.circle-shift")


def observers(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "cn-coal-15")
    names = ["Иванов", "Иванов" if value < 1.5 else "Γεωργίου"]
    for index, name in enumerate(names):
        folder.session(f"s{index}", azimuths(100.0), more=f'observer = "{name}"')
    return folder.checks("cn-coal-15.observer")


def level(path: Path, value: float) -> list[Check]:
    rows = [*azimuths(100.0), f",,level_along,{-20.0 * value},arcsec,,,"]
    folder = Folder(path, "cn-coal-15").session("a", rows, more="level_division_arcsec = 20.0")
    return folder.checks("cn-coal-15.level")


def before_after(rule: str, purposes: tuple[str, str]) -> Callable[[Path, float], list[Check]]:
    def build(path: Path, value: float) -> list[Check]:
        folder = Folder(path, "cn-coal-15")
        for day, purpose in enumerate(purposes, start=1):
            count = round(value) if purpose == "calibration" else 2
            rows = azimuths(*[47.0] * count)
            folder.session(f"s{day}", rows, purpose=purpose, more=f"date = 2026-03-0{day}")
        return folder.checks(rule)

    return build


def underground(path: Path, value: float) -> list[Check]:
    folder = Folder(path, "cn-coal-15").session("a", azimuths(*[100.0] * round(value)))
    return folder.checks("cn-coal-15.rounds-underground")


CASES: dict[str, tuple[Callable[[Path, float], list[Check]], float, float]] = {
    "rounds": (rounds_difference, 9.99, 10.01),
    "rounds across north": (rounds_across_north, 9.99, 10.01),
    "rounds of two sessions": (rounds_of_two_sessions, 39.9, 40.1),
    "calibrations": (calibrations, 14.99, 15.01),
    "epochs": (epochs, 14.99, 15.01),
    "independent": (independent, 24.99, 25.01),
    "independent mean": (independent_mean, 9.99, 10.01),
    "tape zero": (tape_zero, 0.499, 0.501),
    "tape zero, negative": (tape_zero, -0.499, -0.501),
    "tape zero change": (tape_zero_change, 0.199, 0.201),
    "pre-orientation, tracking": (pre_tracking, 59.9, 60.1),
    "pre-orientation, tracking, west": (pre_tracking, -59.9, -60.1),
    "pre-orientation, transit": (pre_transit, 9.9, 10.1),
    "sights": (sights, 9.99, 10.01),
    "sights, the other way": (sights, -9.99, -10.01),
    "rotor rest": (rotor_rest, 10.01, 9.99),
    "circle": (circle_spacing, 82.0, 80.0),
    "circle, half a turn more": (circle_spacing, 262.0 - 360.0, 261.0 - 1.0 - 360.0),
    "observers": (observers, 1.0, 2.0),
    "level": (level, 0.499, 0.501),
    "rounds before": (before_after("cn-coal-15.rounds-before", ("calibration", "survey")), 2, 1),
    "rounds after": (before_after("cn-coal-15.rounds-after", ("survey", "calibration")), 2, 1),
    "rounds underground": (underground, 2, 1),
}


@pytest.mark.parametrize("name", CASES)
def test_a_limit_is_reached_by_the_data_of_a_project(name: str, tmp_path: Path) -> None:
    build, inside, outside = CASES[name]
    for value, expected in ((inside, True), (outside, False)):
        folder = tmp_path / str(expected)
        folder.mkdir()
        (check,) = build(folder, value)
        assert check.passed is expected, (value, check)
        assert check.value == pytest.approx(abs(value), rel=5e-3) or "circle" in name


@pytest.mark.parametrize(
    ("override", "row", "date", "rule", "passed"),
    [
        ("range = { temperature_c = [-10.0, 40.0] }", "40.0", "", "card.temperature", True),
        ("range = { temperature_c = [-10.0, 40.0] }", "40.1", "", "card.temperature", False),
        ("range = { temperature_c = [-10.0, 40.0] }", "-10.1", "", "card.temperature", False),
        ("range = { temperature_c = [-10.0, 40.0] }", "", "", "card.temperature", None),
        ("range = { latitude_max_deg = 34.5 }", "", "", "card.latitude", True),
        (
            "calibration_due = 2026-03-01",
            "",
            "date = 2026-03-01",
            "card.calibration_due",
            True,
        ),
        (
            "calibration_due = 2026-03-01",
            "",
            "date = 2026-03-02",
            "card.calibration_due",
            False,
        ),
        ("calibration_due = 2026-03-01", "", "", "card.calibration_due", None),
    ],
)
def test_an_instrument_is_valid_where_its_card_says_so(
    override: str, row: str, date: str, rule: str, *, passed: bool | None, tmp_path: Path
) -> None:
    folder = Folder(tmp_path, "automatic-gyro", instrument=override)
    rows = [f"{azimuths(100.0)[0]}{row}"]
    (check,) = folder.session("a", rows, more=date).checks(rule)
    assert check.passed is passed
    assert check.clause == "card hgg05"
