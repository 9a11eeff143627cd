"""Damaged files: every line is named, nothing is written, nothing is guessed over the gap."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from tests.cli.command import run
from tests.formats import field_writers as w
from tests.formats.importing import bring, field_file, project, rows, tree

SETUPS, SIGHTS = w.simulated()
GON = {"hz": "gon", "v": "gon", "sd": "m", "hi": "m", "ht": "m"}
FILES: dict[str, list[str]] = {
    "gsi": w.gsi(SETUPS, SIGHTS),
    "sdr": w.sdr(SETUPS, SIGHTS),
    "jobxml": w.jobxml(SETUPS, SIGHTS),
    "csv": w.table(SIGHTS),
}
OPTIONS: dict[str, dict[str, Any]] = {"csv": {"columns": w.TABLE_MAP, "units": GON}}


def _readings(form: str) -> list[int]:
    """Places of lines that are pointings."""
    marks = {"gsi": " 21.", "sdr": "09F", "jobxml": "DirectReading", "csv": ",I"}
    return [i for i, line in enumerate(FILES[form]) if marks[form] in line]


def _refused(tmp_path: Path, form: str, lines: list[str], **more: Any) -> list[str]:
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "field", lines)
    before = tree(folder)
    with pytest.raises(SurveyError) as refused:
        api.import_file(form, path, folder, traverse="main", **OPTIONS.get(form, {}), **more)
    assert tree(folder) == before
    return [problem.where for problem in refused.value.problems]


@pytest.mark.parametrize("form", ["gsi", "sdr", "csv"])
def test_every_damaged_line_is_named_and_the_others_stay(tmp_path: Path, form: str) -> None:
    lines = list(FILES[form])
    places = [_readings(form)[i] for i in (1, 6, 11)]
    lines[places[0]] = lines[places[0]][: len(lines[places[0]]) // 2]
    broken = lines[places[1]]
    middle = len(broken) * 2 // 3
    lines[places[1]] = broken[:middle] + "#@" + broken[middle + 2 :]
    lines[places[2]] = "@@@@ 4711 ???"
    where = _refused(tmp_path, form, lines)
    assert [int(text.rpartition("line ")[2]) for text in where] == [i + 1 for i in places]
    folder, result = bring(tmp_path / "b", form, lines, skip_damaged=True, **OPTIONS.get(form, {}))
    left_out = [item.line for item in result.skipped if item.code == "damaged"]
    assert left_out == [i + 1 for i in places]
    if form != "gsi":  # there a lost block of unknown kind may have been a station
        kept = {int(row["line"]) for row in rows(folder / "imports" / "main.raw.csv")}
        dependent = {item.line for item in result.skipped if item.code == "depends_on_damaged"}
        assert kept == {i + 1 for i in _readings(form)} - {i + 1 for i in places} - dependent
        assert len(dependent) == (form == "sdr")  # the lost record may have been a target height


@pytest.mark.parametrize("form", ["gsi", "sdr", "jobxml", "csv"])
def test_a_last_line_cut_anywhere_never_gives_a_false_value(tmp_path: Path, form: str) -> None:
    """Whatever is left of the last line: refused, or the values are those of the whole file."""
    folder, _ = bring(tmp_path / "whole", form, FILES[form], **OPTIONS.get(form, {}))
    whole = {row["line"]: row for row in rows(folder / "imports" / "main.raw.csv")}
    last = max(_readings(form))
    head = FILES[form][:last]
    for number, cut in enumerate(range(1, len(FILES[form][last]), 3)):
        text = "\n".join([*head, FILES[form][last][:cut]])
        here = tmp_path / str(number)
        here.mkdir()
        path = here / "f"
        path.write_text(text, encoding="utf-8")
        options = OPTIONS.get(form, {})
        if not _taken(form, path, project(here / "p"), f"line {last + 1}", options=options):
            continue
        found = rows(here / "p" / "imports" / "main.raw.csv")[-1]
        expected = whole[found["line"]]
        told = {k: v for k, v in found.items() if v and k not in ("note", "ht_m", "sd_m", "ppm")}
        assert all(expected[key] == value for key, value in told.items()), (cut, found, expected)
        assert found["sd_m"] in ("", expected["sd_m"])
        assert found["ht_m"] in ("", expected["ht_m"])


def _taken(form: str, path: Path, folder: Path, line: str, *, options: dict[str, Any]) -> bool:
    """Whether the file was imported; what refuses it names the line."""
    try:
        api.import_file(form, path, folder, traverse="main", **options)
    except SurveyError as error:
        if line not in str(error):
            raise
        return False
    return True


def test_what_follows_a_damaged_station_is_left_out_with_it(tmp_path: Path) -> None:
    lines = list(FILES["gsi"])
    stations = [i for i, line in enumerate(lines) if " 84." in line]
    lines[stations[1]] = lines[stations[1]][:40]
    _, result = bring(tmp_path, "gsi", lines, skip_damaged=True)
    codes = {item.line: item.code for item in result.skipped}
    assert codes[stations[1] + 1] == "damaged"
    between = range(stations[1] + 2, stations[2] + 1)
    assert all(codes[line] == "depends_on_damaged" for line in between)
    assert {item.at for item in result.sets} == {"102", "104"}


def test_a_lost_block_of_unknown_kind_may_have_been_a_station(tmp_path: Path) -> None:
    lines = list(FILES["gsi"])
    stations = [i for i, line in enumerate(lines) if " 84." in line]
    lines[stations[1]] = "@@@@"
    _, result = bring(tmp_path, "gsi", lines, skip_damaged=True)
    assert {item.at for item in result.sets} == {"102", "104"}


def test_garbage_between_two_numbered_blocks_costs_nothing_else(tmp_path: Path) -> None:
    lines = list(FILES["gsi"])
    lines.insert(4, "@@@@ nothing of this file")
    _, result = bring(tmp_path, "gsi", lines, skip_damaged=True)
    assert result.readings == len(SIGHTS)
    assert [item.line for item in result.skipped] == [5]


def test_a_damaged_target_height_takes_its_sights_along(tmp_path: Path) -> None:
    lines = list(FILES["sdr"])
    place = next(i for i, line in enumerate(lines) if line.startswith("03NM"))
    lines[place] = "03NM1.3"
    _, result = bring(tmp_path, "sdr", lines, skip_damaged=True)
    assert [x.code for x in result.skipped][:2] == ["damaged", "depends_on_damaged"]
    assert result.readings == len(SIGHTS) - 1


def test_a_block_that_stands_twice_is_one(tmp_path: Path) -> None:
    lines = list(FILES["gsi"])
    lines.insert(3, lines[2])
    _, result = bring(tmp_path, "gsi", lines)
    assert result.readings == len(SIGHTS)
    assert [(x.line, x.code) for x in result.skipped] == [(4, "duplicate")]


def test_sets_stay_apart_where_a_pointing_is_lost(tmp_path: Path) -> None:
    """A round without its last face right must not take that of the next round."""
    sights = [s for i, s in enumerate(SIGHTS) if i not in (3, 4)]
    folder, _ = bring(tmp_path, "gsi", w.gsi(SETUPS, sights))
    book = rows(folder / "observations" / "main.csv")
    found = [r for r in book if r["kind"] == "direction" and (r["at"], r["to"]) == ("102", "101")]
    assert len(found) == 2
    assert float(found[0]["value"]) == pytest.approx(SIGHTS[0].hz, abs=1e-5)
    assert float(found[1]["value"]) == pytest.approx((SIGHTS[7].hz + 180) % 360, abs=1e-5)


def test_without_a_station_the_codes_are_listed(tmp_path: Path) -> None:
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.gsi", w.gsi(SETUPS, SIGHTS, code="21"))
    with pytest.raises(SurveyError, match=r"21 \(3 times\)"):
        api.import_file("gsi", path, folder, traverse="main")
    with pytest.raises(SurveyError, match=r"21 \(3 times\)"):
        api.import_file("gsi", path, folder, traverse="main", station_code="7")
    assert api.import_file("gsi", path, folder, traverse="main", station_code="21").readings == 24


@pytest.mark.parametrize("form", ["gsi", "sdr", "jobxml", "csv", "gyro-csv"])
@pytest.mark.parametrize(
    "content", [b"", b"\n\n", b"\x00\x01\x02\x03" * 50, b"hello\nworld\n", b"\xff\xd8\xff\xe0" * 9]
)
def test_no_field_file_at_all(tmp_path: Path, form: str, content: bytes) -> None:
    folder = project(tmp_path / "p")
    (tmp_path / "f").write_bytes(content)
    options = ["--map", "at=Stn", "to=Tgt"] if form == "csv" else []
    if form == "gyro-csv":
        options = ["--instrument", "G", "--map", "station=a", "target=b", "azimuth=c"]
        options += ["--unit", "azimuth=gon"]
    result = run("import", form, str(tmp_path / "f"), str(folder), *options, "--json")
    assert result.code == 2
    assert json.loads(result.out)["problems"][0]["what"]
    assert list(tree(folder)) == ["project.toml"]


def test_a_file_of_100_mb_is_answered_at_once(tmp_path: Path) -> None:
    with (tmp_path / "f.gsi").open("wb") as stream:
        stream.truncate(100 * 1024 * 1024)
    assert "binary" in _refused_file(tmp_path, "gsi", tmp_path / "f.gsi")
    with (tmp_path / "f.gsi").open("wb") as stream:
        stream.truncate(300 * 1024 * 1024)
    assert "315 MB" in _refused_file(tmp_path, "gsi", tmp_path / "f.gsi")


def _refused_file(tmp_path: Path, form: str, path: Path) -> str:
    folder = project(tmp_path / "p")
    with pytest.raises(SurveyError) as refused:
        api.import_file(form, path, folder, traverse="main")
    assert list(tree(folder)) == ["project.toml"]
    return str(refused.value)


BOMB = (
    '<?xml version="1.0"?><!DOCTYPE JOBFile [<!ENTITY a "aaaaaaaaaa">'
    '<!ENTITY b "&a;&a;&a;&a;&a;&a;">]><JOBFile><FieldBook><PointRecord><Name>&b;</Name>'
    "</PointRecord></FieldBook></JOBFile>"
)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (BOMB, "entities"),
        ('<!DOCTYPE JOBFile SYSTEM "file:///etc/passwd"><JOBFile/>', "document type"),
        ("<JOBFile><FieldBook>" + "<a>" * 100_000, "nested too deeply"),
        ("<html><body/></html>", "no JobXML"),
        ("<JOBFile><FieldBook><PointRecord>", "torn"),
        ('<?xml version="1.0" encoding="klingon"?><JOBFile/>', ""),
    ],
)
def test_hostile_xml(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "f.jxl"
    path.write_text(text, encoding="utf-8")
    assert said in _refused_file(tmp_path, "jobxml", path)


def test_a_torn_jobxml_keeps_its_whole_records(tmp_path: Path) -> None:
    last = max(_readings("jobxml"))
    lines = [*FILES["jobxml"][:last], FILES["jobxml"][last][:60]]
    assert _refused(tmp_path, "jobxml", lines)[0].endswith(f"line {last + 1}")
    _, result = bring(tmp_path / "b", "jobxml", lines, skip_damaged=True)
    assert result.readings == len(SIGHTS) - 1
    assert [x.line for x in result.skipped] == [last + 1]
