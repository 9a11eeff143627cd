"""Editing project.toml keeps its owner's words, or does not happen."""

import datetime as dt
import tomllib
from pathlib import Path

import pytest

from surveyapp.errors import SurveyError
from surveyapp.io import locations
from surveyapp.io.project import read_project
from surveyapp.io.writing import (
    append_subtable,
    append_table,
    comments,
    create_project,
    set_value,
    toml_value,
)
from surveyapp_models.angles import AngleUnit

TEXT = """\
# The mine's own project
format = 1   # never change
name = "Ramp # 3"
title = '''
# no comment
'''

[[station]]
name = "A"    # the old pillar
e = 1.50      # metres
n = 2.0

# two sessions follow
[[orientation]]
id = "r1"
book = "r1.csv"  # first

[[orientation.effect]]
id = "old"

# the second one
[[orientation]]
id = "r2"
book = "r2.csv"

[[traverse]]
name = "main"   # end
"""


@pytest.fixture
def toml(tmp_path: Path) -> Path:
    path = tmp_path / "project.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def data(path: Path) -> dict[str, object]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def test_comments_are_found_outside_of_strings_only() -> None:
    found = comments(TEXT)
    assert found[0] == "# The mine's own project"
    assert "# no comment" not in found
    assert not any("3" in c for c in found)
    assert len(found) == 8


def test_a_new_table_goes_to_the_end_as_text(toml: Path) -> None:
    mapping = {"name": "B", "e": 2.5, "h": None, "date": dt.date(2026, 1, 2), "x": {"a b": [1, 2]}}
    append_table(toml, "station", mapping)
    text = toml.read_text(encoding="utf-8")
    assert text.startswith(TEXT)
    stations = data(toml)["station"]
    assert isinstance(stations, list)
    assert stations[1] == {"name": "B", "e": 2.5, "date": dt.date(2026, 1, 2), "x": {"a b": [1, 2]}}


def test_awkward_texts_survive(toml: Path) -> None:
    awkward = 'quote " slash \\ tab \t line \n del \x7f bell \x07 \u20ac \U0001f600'
    append_table(toml, "station", {"name": awkward})
    stations = data(toml)["station"]
    assert isinstance(stations, list)
    assert stations[1]["name"] == awkward


def test_an_effect_goes_to_its_own_session(toml: Path) -> None:
    append_subtable(toml, ("orientation", "r1"), "effect", {"id": "new", "before": 2.0})
    append_subtable(toml, ("orientation", "r2"), "effect", {"id": "other"})
    sessions = data(toml)["orientation"]
    assert isinstance(sessions, list)
    assert [e["id"] for e in sessions[0]["effect"]] == ["old", "new"]
    assert [e["id"] for e in sessions[1]["effect"]] == ["other"]
    assert comments(toml.read_text(encoding="utf-8")) == comments(TEXT)
    text = toml.read_text(encoding="utf-8")
    assert text.index("# the second one") > text.index('id = "new"')


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("name",), "Ramp 4"),
        (("station", "A", "e"), 17.25),
        (("station", 0, "h"), 812.0),
        (("orientation", "r1", "target"), "A"),
        (("orientation", "r1", "book"), "other.csv"),
        (("orientation", "r2", "date"), dt.date(2026, 11, 22)),
        (("orientation", "r2", "eccentric"), {"distance_m": 0.5, "at": "station"}),
        (("traverse", "main", "class"), "15sec"),
        (("crs",), "EPSG:4546"),
        (("station", "A", "fixed"), True),
    ],
)
def test_a_value_is_set_in_place(toml: Path, path: tuple[str | int, ...], value: object) -> None:
    set_value(toml, path, value)
    found: object = data(toml)
    for key in path:
        if isinstance(found, list):
            found = (
                found[key]
                if isinstance(key, int)
                else next(t for t in found if key in (t.get("id"), t.get("name")))
            )
        else:
            assert isinstance(found, dict)
            found = found[key]
    assert found == value
    assert sorted(comments(toml.read_text(encoding="utf-8"))) == sorted(comments(TEXT))


def test_other_lines_do_not_change(toml: Path) -> None:
    set_value(toml, ("station", "A", "e"), 17.25)
    expected = TEXT.replace("e = 1.50 ", "e = 17.25 ")
    assert toml.read_text(encoding="utf-8") == expected


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("station", "Z", "e"), 1.0),
        (("nothing", "x"), 1.0),
        (("station", "A"), {"name": "B"}),
        (("name", "x"), 1.0),
        (("station", "A", "e"), float("nan")),
        (("station", "A", "e"), object()),
        (("station", "A", "name"), None),
    ],
)
def test_what_cannot_be_is_refused_with_the_file_untouched(
    toml: Path, path: tuple[str, ...], value: object
) -> None:
    with pytest.raises(SurveyError):
        set_value(toml, path, value)
    assert toml.read_text(encoding="utf-8") == TEXT


def test_a_writer_that_errs_is_caught_before_the_file_changes(
    toml: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for wrong in (TEXT, TEXT.replace("1.50", "17.26"), TEXT.replace("1.50", "17.25") + "z = 1\n"):
        monkeypatch.setattr("tomlkit.dumps", lambda document, text=wrong: text)
        with pytest.raises(SurveyError, match="intended data"):
            set_value(toml, ("station", "A", "e"), 17.25)
    lost = TEXT.replace("1.50", "17.25").replace("# metres", "")
    monkeypatch.setattr("tomlkit.dumps", lambda document: lost)
    with pytest.raises(SurveyError, match="# metres"):
        set_value(toml, ("station", "A", "e"), 17.25)
    assert toml.read_text(encoding="utf-8") == TEXT


def test_a_table_that_is_no_list_is_not_appended_to(toml: Path) -> None:
    with pytest.raises(SurveyError, match="no list of tables"):
        append_table(toml, "name", {"x": 1})
    assert toml.read_text(encoding="utf-8") == TEXT


def test_numbers_are_written_to_the_last_digit() -> None:
    for value in (0.1 + 0.2, 1e-300, 3811452.311, -0.0, 1e22):
        assert tomllib.loads(f"x = {toml_value(value)}")["x"] == value


@pytest.mark.parametrize("unit", list(AngleUnit))
@pytest.mark.parametrize("crs", [None, "EPSG:4546", 'PROJCRS["x"]'])
def test_a_new_project_reads_without_problems(
    tmp_path: Path, unit: AngleUnit, crs: str | None
) -> None:
    path = create_project(tmp_path / "a" / "b", name='The "new" one', crs=crs, angle_unit=unit)
    project = read_project(path.parent)
    assert (project.name, project.crs, project.angle_unit) == ('The "new" one', crs, unit)
    assert project.warnings == ()
    assert (path.parent / "observations").is_dir()


@pytest.mark.parametrize("unit", list(AngleUnit))
def test_the_template_with_its_examples_taken_in_reads_as_well(
    tmp_path: Path, unit: AngleUnit
) -> None:
    path = create_project(tmp_path / "p", name="x", angle_unit=unit)
    lines = path.read_text(encoding="utf-8").split("\n")
    examples = [
        line[2:]
        if line.startswith(("# [[", "# crs")) or (" = " in line[:30] and line[0] == "#")
        else line
        for line in lines
    ]
    path.write_text("\n".join(examples), encoding="utf-8")
    row = next(line for line in lines if line.startswith("# 1,,,"))[2:]
    header = next(line for line in lines if line.startswith("# seq,"))[2:]
    book = path.parent / "observations" / "calibration-1.csv"
    book.write_text(f"{header}\n{row}\n", encoding="utf-8")
    project = read_project(path.parent)
    assert [s.id for s in project.sessions] == ["calibration-1"]
    assert project.warnings == ()
    assert project.sessions[0].azimuth_known == project.sessions[0].book.rows[0].value


def test_a_new_project_needs_a_folder_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("", encoding="utf-8")
    for folder in (tmp_path, tmp_path / "x", tmp_path / "x" / "y"):
        with pytest.raises(SurveyError):
            create_project(folder, name="x")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["x"]


@pytest.mark.parametrize("name", ["", "  ", "two\nlines", "\x1b[31m", "x" * 300])
def test_a_name_that_could_not_be_read_again_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(SurveyError, match="no name"):
        create_project(tmp_path / "p", name=name)
    assert not (tmp_path / "p").exists()


def test_samples_are_found_and_copied(tmp_path: Path) -> None:
    assert {"gi-b1-1966", "johannesburg-1966", "tongjin-2015"} <= set(locations.sample_names())
    copy = locations.copy_sample("tongjin-2015", tmp_path)
    original = read_project(locations.samples_folder() / "tongjin-2015")
    assert read_project(copy).digest == original.digest
    with pytest.raises(SurveyError, match="Did you mean tongjin-2015"):
        locations.copy_sample("tongjin", tmp_path)
    with pytest.raises(SurveyError, match="cannot be copied"):
        locations.copy_sample("tongjin-2015", tmp_path)


def test_the_config_folder_is_named_and_not_made() -> None:
    assert locations.user_config_folder().name == "surveyapp"
