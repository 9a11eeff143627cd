"""What an import does to a project: all or nothing, stations compared, contract of the JSON."""

from __future__ import annotations

import csv
import hashlib
import json
import os
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.errors import Problem, SurveyError
from tests.cli.command import run
from tests.formats import field_writers as w
from tests.formats.importing import bring, field_file, project, rows, tree

SHARED = Path(os.environ.get("SURVEYAPP_FORMATS", Path(__file__).parents[3] / "shared" / "formats"))
SETUPS, SIGHTS = w.simulated()
LINES = w.gsi(SETUPS, SIGHTS, width=16, length="m4")

KEYS = {
    *("schema", "format", "variant", "file", "sha256", "stations", "traverse", "book", "raw"),
    *("rows", "readings", "sets", "sessions", "skipped", "warnings", "written"),
}


def test_the_contract_of_the_json(tmp_path: Path) -> None:
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "day 1.gsi", LINES)
    result = run("import", "gsi", str(path), str(folder), "--json")
    assert result.code == 0, result.err
    document = json.loads(result.out)
    assert set(document) == KEYS
    assert document["schema"] == "surveyapp.import/1"
    assert document["traverse"] == "day 1"
    assert (document["rows"], document["readings"]) == (36, 24)
    assert document["sets"][0]["targets"] == ["101", "103"]
    assert document["sets"][0]["faces"] == 2
    assert document["sets"][0]["collimation_arcsec"] == pytest.approx(0.0008 * 3600, abs=1.5)
    assert document["sets"][0]["index_arcsec"] == pytest.approx(-0.0005 * 3600, abs=0.1)
    kept = (folder / document["file"]).read_bytes()
    assert kept == path.read_bytes()
    assert document["sha256"] == hashlib.sha256(kept).hexdigest()
    assert document["file"] == "imports/day 1.gsi"
    raw = (folder / document["raw"]).read_text(encoding="utf-8").splitlines()
    assert raw[0] == (
        "line,at,to,face,set,hz_deg,v_deg,sd_m,hd_m,hi_m,ht_m,ppm,prism_mm,temperature_c,"
        "pressure_hpa,time,code,note"
    )
    assert len(raw) == 25


def test_import_adjust_check_and_record_without_an_edit(tmp_path: Path) -> None:
    setups, sights = _true_traverse()
    folder = tmp_path / "p"
    path = field_file(tmp_path, "f.gsi", w.gsi(setups, sights, width=16, length="m4"))
    assert run("new", str(folder)).code == 0
    result = run("import", "gsi", str(path), str(folder), "--fix", "B", "C", "--json")
    assert result.code == 0, result.err
    answer = run("adjust", str(folder), "--json")
    assert answer.code == 0
    adjusted = json.loads(answer.out)
    assert adjusted["global_test"]["pass"] is True
    found = {point["name"]: point for point in adjusted["points"]}
    assert found["D"]["e"] == pytest.approx(1100.0, abs=0.01)
    assert found["D"]["n"] == pytest.approx(2160.0, abs=0.01)
    assert found["D"]["h"] == pytest.approx(12.0, abs=0.01)
    assert run("check", str(folder)).code == 0
    record = run("report", str(folder), "-o", str(tmp_path / "r.pdf"))
    assert record.code == 0, record.err


def _true_traverse() -> tuple[list[w.Setup], list[w.Sight]]:
    """B, C known, D, E new; readings from places, 2" and 0.5 mm of noise, 1 mm of centring."""
    import math
    import random

    r = random.Random(5)
    places = {"B": (1000.0, 2000.0, 10.0), "C": (1080.0, 2060.0, 11.0)}
    places |= {"D": (1100.0, 2160.0, 12.0), "E": (1180.0, 2200.0, 13.0)}
    names = list(places)
    setups, sights = [], []
    for i, at in enumerate(names):
        setups.append(w.Setup(at, *places[at], 1.5 + 0.01 * i))
        near = [names[j] for j in (i - 1, i + 1) if 0 <= j < len(names)]
        off = {name: [r.gauss(0, 0.001) for _ in range(3)] for name in (at, *near)}
        for k in range(3):
            turn = 60.0 * k + 10.0
            for face, order in (("L", near), ("R", near[::-1])):
                for to in order:
                    de, dn, dh = (
                        b + y - a - x
                        for a, x, b, y in zip(places[at], off[at], places[to], off[to], strict=True)
                    )
                    dh += 1.4 - setups[i].hi
                    flat = math.hypot(de, dn)
                    hz = math.degrees(math.atan2(de, dn)) + turn + r.gauss(0, 2 / 3600)
                    v = math.degrees(math.atan2(flat, dh)) + r.gauss(0, 2 / 3600)
                    hz, v = (hz, v) if face == "L" else (hz + 180, 360 - v)
                    sd = math.hypot(flat, dh) + r.gauss(0, 0.0005)
                    sights.append(w.Sight(i, k, at, to, face, hz % 360, v, sd, setups[i].hi, 1.4))
    return setups, sights


def test_stations_are_compared_and_never_changed(tmp_path: Path) -> None:
    more = (
        '[[station]]\nname = "102"\ne = 1000.0\nn = 2000.0\nh = -312.5\nfixed = true\n'
        '[[station]]\nname = "103"\ne = 1080.125\nn = 1994.544\n'
        '[[station]]\nname = "101"\n'
    )
    folder = project(tmp_path / "p", more)
    path = field_file(tmp_path, "f.gsi", LINES)
    result = run("import", "gsi", str(path), str(folder), "--traverse", "main", "--json")
    assert result.code == 1  # 103 lies 2 mm away
    states = {s["name"]: s["state"] for s in json.loads(result.out)["stations"]}
    assert states == {
        "102": "same",
        "101": "same",
        "103": "conflict",
        "104": "added",
        "105": "added",
    }
    text = (folder / "project.toml").read_text(encoding="utf-8")
    assert text.startswith(f'format = 1\nname = "t"\n{more}')
    assert text.count("fixed") == 1
    assert (folder / "observations" / "main.csv").exists()


@pytest.mark.parametrize("taken", ["observations/main.csv", "imports/main.raw.csv"])
def test_a_book_of_that_name_is_refused(tmp_path: Path, taken: str) -> None:
    folder = project(tmp_path / "p")
    (folder / taken).parent.mkdir()
    (folder / taken).write_text("mine")
    before = tree(folder)
    path = field_file(tmp_path, "f.gsi", LINES)
    assert run("import", "gsi", str(path), str(folder), "--traverse", "main").code == 2
    assert tree(folder) == before


def test_importing_twice_is_refused(tmp_path: Path) -> None:
    folder, _ = bring(tmp_path, "gsi", LINES)
    before = tree(folder)
    with pytest.raises(SurveyError, match="traverse of this name"):
        api.import_file("gsi", tmp_path / "field.gsi", folder, traverse="main")
    assert tree(folder) == before
    api.import_file("gsi", tmp_path / "field.gsi", folder, traverse="second")
    assert api.open_project(folder).stations


@pytest.mark.parametrize("step", ["append_tables", "atomic_write"])
def test_a_failing_import_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    from surveyapp.io.importing import writing

    real = getattr(writing, step)
    calls: list[int] = []

    def failing(*arguments: Any) -> None:
        calls.append(1)
        if step == "append_tables" or len(calls) == 3:
            raise SurveyError(Problem("the disk is full"))
        real(*arguments)

    monkeypatch.setattr(writing, step, failing)
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.gsi", LINES)
    with pytest.raises(SurveyError, match="disk is full"):
        api.import_file("gsi", path, folder, traverse="main")
    assert list(tree(folder)) == ["project.toml"]
    assert not (folder / "imports").exists()


def test_a_preview_writes_nothing(tmp_path: Path) -> None:
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.gsi", LINES)
    result = api.import_file("gsi", path, folder, traverse="main", preview=True)
    assert result.rows == 36
    assert not result.written
    assert list(tree(folder)) == ["project.toml"]


def test_a_closed_project_is_not_written_to(tmp_path: Path) -> None:
    folder, _ = bring(tmp_path, "gsi", LINES)
    api.close(folder, by="me")
    with pytest.raises(SurveyError, match="closed"):
        api.import_file("gsi", tmp_path / "field.gsi", folder, traverse="second")


@pytest.mark.parametrize("name", ["../x", "a/b", "", " ", ".hidden", "x" * 200, "a\nb", "-o"])
def test_names_that_are_no_names_of_files(tmp_path: Path, name: str) -> None:
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.gsi", LINES)
    with pytest.raises(SurveyError):
        api.import_file("gsi", path, folder, traverse=name)
    assert list(tree(folder)) == ["project.toml"]


def test_map_and_units_are_checked_together(tmp_path: Path) -> None:
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.csv", w.table(SIGHTS))
    result = run(
        *("import", "csv", str(path), str(folder), "--json"),
        *("--map", "at=Stn", "hz=HA", "v=ZA", "nonsense=SD", "--unit", "v=furlong"),
    )
    assert result.code == 2
    told = {(p["where"], p["found"]) for p in json.loads(result.out)["problems"]}
    assert told == {("--map", "nonsense"), ("--map", "to"), ("--unit", "hz"), ("--unit", "furlong")}


def test_azimuths_of_an_automatic_gyro(tmp_path: Path) -> None:
    lines = ["Standpunkt;Ziel;Zeit;Azimut;Sigma;Temp"]
    for i in range(3):
        moment = f"2026-11-28T13:0{i}:00+00:00"
        lines += [f"A;B;{moment};70,1114{i};0,8;17,{i}", f"B;A;{moment};270,1102{i};0,8;17,{i}"]
    columns = {"station": "Standpunkt", "target": "Ziel", "time": "Zeit", "azimuth": "Azimut"}
    columns |= {"sigma": "Sigma", "temperature": "Temp"}
    more = '[[instrument]]\nid = "G1"\ncard = "gyromat-2000"\n'
    folder, result = bring(
        *(tmp_path, "gyro-csv", lines),
        more=more,
        instrument="G1",
        columns=columns,
        units={"azimuth": "gon", "sigma": "mgon"},
    )
    assert result.sessions == ("A-B", "B-A")
    book = rows(folder / "observations" / "main-A-B.csv")
    assert [row["kind"] for row in book] == ["azimuth"] * 3
    assert float(book[0]["value"]) == pytest.approx(70.1114 * 0.9, abs=1e-9)
    assert "2.592 arcsec" in book[0]["note"]
    assert book[1]["temperature_c"] == "17.1"
    oriented = api.orient(folder)
    assert len(oriented.sessions) == 2
    assert all(session.method == "automatic" for session in oriented.sessions)


@pytest.mark.shared_data
@pytest.mark.skipif(not SHARED.exists(), reason="the samples are not here")
@pytest.mark.parametrize(
    "name",
    sorted(json.loads((SHARED / "expected.json").read_text())) if SHARED.exists() else [],
)
def test_samples_of_others(tmp_path: Path, name: str) -> None:
    wanted = json.loads((SHARED / "expected.json").read_text())[name]
    folder = project(tmp_path / "p")
    command = ["import", wanted["format"], str(SHARED / name), str(folder), "--traverse", "main"]
    command += [*wanted["arguments"], "--json"]
    result = run(*command)
    if wanted.get("damaged_line"):
        assert result.code == 2
        places = [p["where"] for p in json.loads(result.out)["problems"]]
        assert places == [f"{name}, line {wanted['damaged_line']}"]
        result = run(*command, "--skip-damaged")
    assert result.code == 0, result.out + result.err
    document = json.loads(result.out)
    if "rows" not in wanted:
        _check_azimuths(folder, wanted["azimuths_deg"])
        return
    assert (document["rows"], document["readings"]) == (len(wanted["rows"]), wanted["readings"])
    found = {
        (r["kind"], r["at"], r["to"], round(float(r["value"]), 6)): r
        for r in rows(folder / document["book"])
    }
    sets: dict[str, set[str]] = {}
    for row in wanted["rows"]:
        near = [
            found.get((row["kind"], row["at"], row["to"], round(row["value"] + d * 1e-6, 6)))
            for d in (0, 1, -1)
        ]
        hit = next(item for item in near if item is not None)
        assert (float(hit["hi"]), float(hit["ht"])) == (row["hi"], row["ht"])
        if row["kind"] == "direction":
            sets.setdefault(row["set"], set()).add(hit["set"])
    assert all(len(group) == 1 for group in sets.values())
    assert len({min(group) for group in sets.values()}) == len(sets)


def _check_azimuths(folder: Path, wanted: dict[str, list[float]]) -> None:
    for line, values in wanted.items():
        path = folder / "observations" / f"main-{line.replace('>', '-')}.csv"
        with path.open(encoding="utf-8") as stream:
            found = [float(row["value"]) for row in csv.DictReader(stream)]
        assert found == pytest.approx(values, abs=1e-8)
