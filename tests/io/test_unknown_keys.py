"""A key that nobody knows is told in every table of every file that is read, and told once."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import tomlkit

from surveyapp.core.sensors.card_names import PARAMETERS
from surveyapp.domain.priors import DEFAULT_PRIORS
from surveyapp.domain.project import Project
from surveyapp.errors import SurveyError
from surveyapp.io.cards import load_card
from surveyapp.io.findings import Findings
from surveyapp.io.priors import priors_text
from surveyapp.io.project import read_project
from surveyapp.io.rulebooks import read_rule_book, rule_book_text
from surveyapp.io.sensor_cards import read_sensor_card
from tests.cli.command import run
from tests.io.test_cards import FULL as INSTRUMENT_CARD
from tests.io.test_project_reading import TOML, make

PROJECTS = Path(__file__).resolve().parents[2] / "projects"
FREE = ("coefficients", "grid", "reference", "valid", "units", "columns", "scale", "notes")
"""Tables whose keys are names of the surveyor's or of an effect's own."""
SENSOR_CARD = """\
format = 1
id = "unit"
title = "Unit"
kind = "rate"
source = "here"
instrument = "U1"
serial = "7"
[parameter.bias_x]
value = 1.0
sigma = 0.1
unit = "deg/h"
[constants]
reference_temperature_c = 20.0
[temperature_model]
model = "linear"
sensor_c = [10.0, 20.0]
bias_x = [1.0, 2.0]
bias_y = [1.0, 2.0]
bias_z = [1.0, 2.0]
[notes]
anything = "is a note"
"""


def planted(data: dict[str, Any], *free: str) -> tuple[str, list[str]]:
    """The text of a file with a key of its own in every table, and these keys."""
    keys: list[str] = []
    for table in list(_tables(data, free)):
        keys.append(f"planted{len(keys)}")
        table[keys[-1]] = 1
    return tomlkit.dumps(data), keys


def _tables(value: Any, free: tuple[str, ...]) -> Iterator[dict[str, Any]]:
    if isinstance(value, list):
        for item in value:
            yield from _tables(item, free)
    elif isinstance(value, dict):
        yield value
        for key, item in value.items():
            if key in free and isinstance(item, dict):
                for inner in item.values():
                    yield from _tables(inner, free)
            else:
                yield from _tables(item, free)


def told(project: Project) -> str:
    parts = [project.warnings]
    parts += [item.warnings for item in (project.penetration, project.shafts) if item is not None]
    return "\n".join(warning.text for part in parts for warning in part)


def missing(keys: list[str], text: str) -> list[str]:
    return [key for key in keys if not re.search(rf"\b{key} is not known", text)]


def test_in_every_table_of_a_project(tmp_path: Path) -> None:
    text, keys = planted(tomllib.loads(TOML), *FREE)
    assert len(keys) > 15
    assert missing(keys, told(read_project(make(tmp_path, text)))) == []


@pytest.mark.parametrize("name", sorted(path.name for path in PROJECTS.iterdir()))
def test_in_every_table_of_the_samples(name: str, tmp_path: Path) -> None:
    import shutil

    folder = shutil.copytree(PROJECTS / name, tmp_path / name)
    path = folder / "project.toml"
    text, keys = planted(tomllib.loads(path.read_text("utf-8")), *FREE)
    path.write_text(text, encoding="utf-8")
    assert missing(keys, told(read_project(folder))) == []


def test_in_every_table_of_an_instrument_card(tmp_path: Path) -> None:
    text, keys = planted(tomllib.loads(INSTRUMENT_CARD), "notes")
    (tmp_path / "own.toml").write_text(text, encoding="utf-8")
    findings = Findings()
    assert load_card("own.toml", base=tmp_path, override={}, findings=findings) is not None
    assert missing(keys, "\n".join(item.text for item in findings.told())) == []


def test_in_every_table_of_a_sensor_card(tmp_path: Path) -> None:
    text, keys = planted(tomllib.loads(SENSOR_CARD), "notes", "parameter")
    path = tmp_path / "unit.toml"
    path.write_text(text, encoding="utf-8")
    card = read_sensor_card(path)
    assert missing(keys, "\n".join(item.text for item in card.warnings)) == []
    path.write_text(SENSOR_CARD, encoding="utf-8")
    assert read_sensor_card(path).warnings == ()


def test_a_parameter_that_no_correction_reads_names_the_nearest(tmp_path: Path) -> None:
    """Spelt wrongly the bias would be nominal, and every rate be off by it."""
    path = tmp_path / "unit.toml"
    path.write_text(SENSOR_CARD.replace("parameter.bias_x", "parameter.bais_x"), encoding="utf-8")
    (warning,) = read_sensor_card(path).warnings
    assert warning.text.startswith("unit.toml, parameter: bais_x is not known and was not used.")
    assert "Did you mean bias_x" in warning.text
    assert "misalignment_zx" in PARAMETERS["rate"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("sensor_c = [10.0, 20.0]", "senor_c = [10.0, 20.0]"),
        ("bias_z = [1.0, 2.0]", "bias_z = [1.0]"),
        ('model = "linear"', 'model = "linaer"'),
        ('model = "linear"\n', ""),
    ],
)
def test_a_temperature_model_that_is_not_whole_is_refused(
    old: str, new: str, tmp_path: Path
) -> None:
    """It was left out in silence, and the biases of the reference temperature were taken."""
    assert old in SENSOR_CARD
    path = tmp_path / "unit.toml"
    path.write_text(SENSOR_CARD.replace(old, new), encoding="utf-8")
    with pytest.raises(SurveyError, match="the temperature model is not whole"):
        read_sensor_card(path)


def test_a_rule_book_refuses_every_one(tmp_path: Path) -> None:
    text, keys = planted(tomllib.loads(rule_book_text("mvt-2", base=Path())))
    text = text.replace("planted0", "titel")
    (tmp_path / "own.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SurveyError) as caught:
        read_rule_book("own.toml", base=tmp_path)
    assert missing(keys[1:], str(caught.value)) == []
    assert "titel is not known" in str(caught.value)
    assert "Did you mean title" in str(caught.value)


def test_priors_tell_a_key_and_refuse_a_share(tmp_path: Path) -> None:
    good = priors_text(DEFAULT_PRIORS, instrument="G1", serial="", software="test")
    toml = TOML.replace("serial = 3139", 'serial = 3139\npriors = "priors.toml"')
    folder = make(tmp_path, toml)
    (folder / "priors.toml").write_text(good.replace("origin", "orign"), encoding="utf-8")
    assert "orign is not known and was not used. Did you mean origin" in told(read_project(folder))
    (folder / "priors.toml").write_text(good + '"2.2" = 0.0\n', encoding="utf-8")
    with pytest.raises(SurveyError, match=r"2\.2 is not known"):
        read_project(folder)


def test_what_is_spelt_wrongly_in_every_session_is_told_once(tmp_path: Path) -> None:
    one = TOML[TOML.index("[[orientation]]") : TOML.index("[[orientation.effect]]")]
    more = "".join(
        one.replace('id = "r1"', f'id = "s{k}"').replace("purpose", "purpse") for k in range(20)
    )
    more = more.replace('azimuth_known = "246-52-09"\n', "")
    folder = make(tmp_path, TOML + "\n" + more)
    text = told(read_project(folder))
    assert text.count("purpse is not known") == 1
    assert "[[orientation]] s0 and 19 further places: purpse is not known" in text
    (folder / "project.toml").write_text(
        (TOML + "\n" + more).replace('constant_choice = "line:', 'constant_choice = "lien:'),
        encoding="utf-8",
    )
    answer = run("orient", str(folder))
    assert answer.code == 2
    assert answer.err.count("constant_choice is not known") == 1
    assert "[[orientation]] r1 and 20 further places: constant_choice" in answer.err


def test_up_to_three_places_are_told_one_by_one() -> None:
    findings = Findings()
    for place in "abc":
        findings.unknown_key("obsever", where=place, known=["observer"])
    assert [item.text[:2] for item in findings.told()] == ["a:", "b:", "c:"]
    findings.unknown_key("obsever", where="d", known=["observer"])
    (only,) = findings.told()
    assert only.text.startswith("a and 3 further places: obsever is not known")
    assert findings.told() == findings.told()
