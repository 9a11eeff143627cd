"""Names of sensor parameters are said in every language, and are the ids of the JSON in English."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from surveyapp import api, languages
from surveyapp.core.sensors import compass_attitude, compass_calibration, swing, tilt_axes
from surveyapp.core.sensors.noise_units import scales_of
from surveyapp.core.sensors.rate.hand_forces import LEVELS
from surveyapp.core.sensors.rate.hand_parameters import FORCE_NAMES
from surveyapp.languages.names import by_id, named
from surveyapp_models.effects import CATALOGUE

ROOT = Path(__file__).resolve().parents[2]
SENSORS = ROOT / "surveyapp" / "core" / "sensors"
OTHERS = ("de", "ru", "zh")
LITERAL = re.compile(r'(?:SensorParameter\(|null\("[^"]*", )\s*f?"([a-z_0-9]+)')


def _names() -> Iterator[str]:
    """Names of the tables, and those that stand as a literal where a parameter is made."""
    yield from (*compass_calibration.NAMES, *compass_attitude.NAMES, *swing.NAMES)
    yield from (*FORCE_NAMES, *LEVELS)
    yield from (f"{name}_{axis}" for name in tilt_axes.TERMS for axis in ("along", "across"))
    for unit in ("rad/s", "m/s2", "mV"):
        yield from (scale.name for scale in scales_of(unit)[0].values())
    yield from (effect.id for effect in CATALOGUE)
    for path in SENSORS.rglob("*.py"):
        yield from (name.rstrip("_") for name in LITERAL.findall(path.read_text(encoding="utf-8")))


NAMES = sorted(set(_names()))


@pytest.mark.parametrize("language", OTHERS)
def test_no_name_is_left_in_english(language: str) -> None:
    assert len(NAMES) > 60
    with languages.in_language(language):
        same = [name for name in NAMES if languages.shown(named(name)) == name.replace("_", " ")]
    assert same == []


def test_in_english_a_name_is_its_id() -> None:
    for name in NAMES:
        assert by_id(name) == languages.shown(by_id(name)) == name
        assert named(name) in (name, name.replace("_", " "))


@pytest.mark.parametrize(
    ("name", "german"),
    [
        ("soft_iron_xx", "Weicheisen xx"),
        ("accelerometer_bias_z", "Nullpunktfehler Beschleunigung z"),
        ("linearity_30_small_angle", "Linearität 30 kleiner Winkel"),
        ("zero_across", "Nullpunkt quer"),
        ("heading", "Richtung des Sensors"),
        ("a_name_of_a_user", "a name of a user"),
    ],
)
def test_what_it_is_of_stays_behind_the_quantity(name: str, german: str) -> None:
    with languages.in_language("de"):
        assert languages.shown(named(name)) == german


def _rows(text: str, head: str) -> list[str]:
    """First cells of the tables whose head begins with a word."""
    lines = text.splitlines()
    found = []
    for place, line in enumerate(lines):
        if line.startswith(f"  {head} "):
            table = lines[place + 1 :]
            end = next(i for i, row in enumerate(table) if not row.startswith("  "))
            found += [re.split(r"\s{2,}", row.strip())[0] for row in table[:end]]
    return found


@pytest.mark.parametrize(
    ("project", "count"),
    [("broad-attached-magnet", 10), ("xsens-multi-position", 21), ("mpu6050-static", 0)],
)
def test_no_row_of_a_german_record_is_its_english_one(project: str, count: int) -> None:
    folder = ROOT / "projects" / project
    english, german = api.report_text(folder), api.report_text(folder, language="de")
    for head, translated in (("parameter", "Parameter"), ("coefficient", "Koeffizient")):
        before, after = _rows(english, head), _rows(german, translated)
        assert len(before) == len(after)
        assert head != "parameter" or len(after) == count
        assert [a for a, b in zip(before, after, strict=True) if a == b] == []
    for words in ("Size of the", "rms before", "left out", "not significant", "time [s]"):
        assert words not in german
        assert words in english or project != "broad-attached-magnet"


@pytest.mark.parametrize("language", OTHERS)
def test_sheets_in_html_follow_the_language_and_csv_does_not(language: str, tmp_path: Path) -> None:
    folder = ROOT / "projects" / "tongjin-2015"
    plain = api.write_sheets(folder, tmp_path / "en.pdf")
    told = api.write_sheets(folder, tmp_path / "other.pdf", language=language)
    for before, after in zip(plain.paths, told.paths, strict=True):
        a, b = (Path(path).read_text(encoding="utf-8") for path in (before, after))
        if before.endswith(".csv"):
            assert a == b
            assert "grid azimuth" in next(csv.reader(a.splitlines()))
            continue
        assert f'<html lang="{language}">' in b
        with languages.in_language(language):
            for english in ("station", "grid azimuth", "Gyro orientation"):
                assert languages.translated(english) in b
                assert f">{english}<" not in b
        assert re.findall(r"<td>[^<]*</td>", a) == re.findall(r"<td>[^<]*</td>", b)
