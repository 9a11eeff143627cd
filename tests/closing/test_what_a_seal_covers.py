"""Whatever moves the azimuth of a closed session is found by ``check``: each thing is changed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from tests.sensors.test_session_sensors import session as sensor_session
from tests.tui.helpers_tui import HEADER, make_calibrations

SURVEY = """
[[orientation]]
id = "s1"
station = "3083"
target = "3082"
instrument = "G1"
method = "tracking"
date = 2026-03-21
book = "observations/s1.csv"
"""
EFFECT = """
[[orientation.effect]]
id = "dry_friction"
coefficients = { loss = { value = 5.0, sigma = 1.0, unit = "arcsec/half swing" } }
sessions = ["s1"]
"""
Change = Callable[[Path], None]


def text_change(name: str, old: str, new: str) -> Change:
    def change(folder: Path) -> None:
        path = folder / name
        text = path.read_text("utf-8")
        assert old in text, (name, old)
        path.write_text(text.replace(old, new, 1), "utf-8")

    return change


def appended(name: str, more: str) -> Change:
    def change(folder: Path) -> None:
        path = folder / name
        path.write_text(path.read_text("utf-8") + more, "utf-8")

    return change


@pytest.fixture
def closed(tmp_path: Path) -> Path:
    """A survey session with sights of two targets, closed alone; its card is the project's own."""
    folder = make_calibrations(tmp_path / "p")
    rows = ["backsight,10-00-00,dms,L,", "backsight,190-00-10,dms,R,"]
    rows += ["backsight,40-00-00,dms,L,,3090", "backsight,220-00-10,dms,R,,3090"]
    rows += [
        f"reversal,{'12' if k % 2 else '350'}-00-{10 + k},dms,,{'LR'[k % 2]}" for k in range(8)
    ]
    cells = [row.split(",") for row in rows]
    lines = [
        f"{n},,,{c[0]},{c[1]},{c[2]},{c[3]},{c[4]},{c[5] if len(c) > 5 else ''},,"
        for n, c in enumerate(cells, start=1)
    ]
    (folder / "observations" / "s1.csv").write_text(HEADER + "\n".join(lines) + "\n", "utf-8")
    card = Path(api.__file__).parents[2] / "models/surveyapp_models/instruments/wild-gak1.toml"
    (folder / "own.toml").write_bytes(card.read_bytes())
    path = folder / "project.toml"
    text = path.read_text("utf-8").replace('card = "wild-gak1"', 'card = "own.toml"')
    path.write_text(text + SURVEY, "utf-8")
    api.close(folder, session="s1", by="Li")
    assert found(folder) is False
    return folder


def found(folder: Path) -> bool:
    """Whether ``check`` says that what was closed is not as it was."""
    try:
        checks = api.check(folder)
    except SurveyError as error:
        return any("changed" in problem.what for problem in error.problems)
    return any(c.rule == "closing.unchanged" and c.passed is False for c in checks)


PROJECT = "project.toml"
CHANGES: dict[str, Change] = {
    "a reading": text_change("observations/s1.csv", "10-00-00", "10-00-01"),
    "the station": text_change(PROJECT, "lat = 47.0\nlon = 8.0\n", "lat = 47.1\nlon = 8.0\n"),
    "the target": text_change(PROJECT, "lat = 47.001", "lat = 47.002"),
    "another target that was sighted": text_change(PROJECT, "lon = 8.02", "lon = 8.03"),
    "the constant": text_change(PROJECT, "arcsec = -9.7", "arcsec = -9.8"),
    "a value of the instrument": text_change(PROJECT, "= 600.0", "= 601.0"),
    "the card": appended("own.toml", "# another word\n"),
    "the grid": text_change(PROJECT, "EPSG:25832", "EPSG:25833"),
    "the unit of angles": text_change(PROJECT, 'angle_unit = "dms"', 'angle_unit = "gon"'),
    "the session's own table": text_change(PROJECT, "2026-03-21", "2026-03-22"),
    "an adopted effect": appended(PROJECT, EFFECT),
    "the azimuth of a calibration": text_change(PROJECT, '"45-00-00"', '"45-00-01"'),
    "a reading of a calibration": text_change("observations/k3.csv", "2026-03-09", "2026-03-10"),
    "a calibration more": appended(
        PROJECT,
        SURVEY.replace('"s1"', '"k9"').replace("date =", 'purpose = "calibration"\ndate ='),
    ),
}


@pytest.mark.parametrize("what", CHANGES)
def test_what_the_azimuth_depends_on_is_sealed(what: str, closed: Path) -> None:
    CHANGES[what](closed)
    assert found(closed), what


@pytest.mark.parametrize("name", ["t.toml", "c.toml", "t.csv", "c.csv"])
def test_logs_and_cards_of_the_sensors_are_sealed(name: str, tmp_path: Path) -> None:
    folder = sensor_session(tmp_path / "a")
    session = api.open_project(folder).sessions[0].id
    api.close(folder, session=session)
    assert found(folder) is False
    path = folder / name
    path.write_text(path.read_text("utf-8") + "\n", "utf-8")
    assert found(folder)


def test_what_it_does_not_depend_on_may_change(closed: Path) -> None:
    path = closed / PROJECT
    text = path.read_text("utf-8").replace('name = "Ramp 3"', 'name = "Ramp 4"')
    path.write_text(text + '\n[[station]]\nname = "later"\n', "utf-8")
    assert found(closed) is False
