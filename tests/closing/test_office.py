"""Hand-over, comparison and batches."""

from __future__ import annotations

import csv
import io
import json
import shutil
import zipfile
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.api.batch import CHUNK
from surveyapp.cli.main import main
from surveyapp.domain.results import to_arcsec
from surveyapp.io.exporters.archive import stored_name

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ("gi-b1-1966", "johannesburg-1966", "tongjin-2015")


@pytest.fixture
def tongjin(tmp_path: Path) -> Path:
    return copy("tongjin-2015", tmp_path / "a")


def copy(name: str, folder: Path) -> Path:
    ignore = shutil.ignore_patterns("results", "ledger.jsonl", ".*")
    shutil.copytree(ROOT / "projects" / name, folder, ignore=ignore)
    return folder


def test_a_zip_is_the_project_and_the_same_every_time(tongjin: Path, tmp_path: Path) -> None:
    api.close(tongjin)
    first = api.export_zip(tongjin, tmp_path / "a.zip")
    second = api.export_zip(tongjin, tmp_path / "b.zip")
    assert first.sha256 == second.sha256
    with zipfile.ZipFile(tmp_path / "a.zip") as packed:
        packed.extractall(tmp_path / "out")
        listing = packed.read("a/MANIFEST.sha256").decode()
    assert len(listing.splitlines()) == first.items
    unpacked = tmp_path / "out" / "a"
    assert api.orient(unpacked).to_dict() == api.orient(tongjin).to_dict()
    assert all(check.passed for check in api.check(unpacked) if check.rule.startswith("closing"))


def test_names_in_a_zip_stay_below_the_folder() -> None:
    assert stored_name("observations/a.csv", 3) == "observations/a.csv"
    assert stored_name("../cards/x.toml", 3) == "outside/003-x.toml"
    assert stored_name("/etc/passwd", 4) == "outside/004-passwd"
    assert stored_name("C:\\gyro\\x.toml", 5) == "outside/005-x.toml"


@pytest.mark.parametrize(("table", "rows"), [("lines", 3), ("sessions", 5), ("constants", 1)])
def test_csv_holds_what_the_result_holds(
    table: str, rows: int, tongjin: Path, tmp_path: Path
) -> None:
    path = tmp_path / "out.csv"
    assert main(["export", "csv", str(tongjin), str(path), "--table", table]) == 0
    read = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
    assert len(read) == rows
    if table == "lines":
        expected = api.orient(tongjin).lines
        for row, line in zip(read, expected, strict=True):
            assert line.grid_azimuth is not None
            assert float(row["grid_azimuth.sigma_arcsec"]) == to_arcsec(line.grid_azimuth.sigma)


def test_every_value_stands_in_the_long_table(tongjin: Path, tmp_path: Path) -> None:
    result = api.export_csv(tongjin, tmp_path / "all.csv", table="all")
    read = list(csv.DictReader(io.StringIO((tmp_path / "all.csv").read_text(encoding="utf-8"))))
    assert len(read) == result.items
    line = api.orient(tongjin).lines[2].to_dict()
    (value,) = [
        row["value"]
        for row in read
        if (row["table"], row["row"], row["quantity"]) == ("lines", "3083-3082", "grid_azimuth.deg")
    ]
    assert float(value) == line["grid_azimuth"]["deg"]


def parts(comparison: Any) -> set[str]:
    return {item.part for item in comparison.differences}


def test_the_same_project_twice_differs_in_nothing(tongjin: Path, tmp_path: Path) -> None:
    other = copy("tongjin-2015", tmp_path / "b")
    result = api.compare(tongjin, other)
    assert result.differences == ()
    assert result.unknown == ()


def test_a_changed_reading_is_named_with_what_it_did(tongjin: Path, tmp_path: Path) -> None:
    other = copy("tongjin-2015", tmp_path / "b")
    book = other / "observations" / "3083-3082.csv"
    lines = book.read_text(encoding="utf-8").splitlines()
    old = lines[1]
    lines[1] = old.replace("001-26", "001-27")
    assert lines[1] != old
    book.write_text("\n".join(lines) + "\n", encoding="utf-8")
    result = api.compare(tongjin, other)
    assert parts(result) == {"input", "result"}
    (changed,) = [item for item in result.differences if item.part == "input"]
    assert changed.name == "observations/3083-3082.csv, line 2"
    assert (changed.a, changed.b) == (old, lines[1])
    (azimuth,) = [i for i in result.differences if i.name == "lines[3083-3082].gyro_azimuth.deg"]
    assert azimuth.change == pytest.approx(20.0 / 3600.0)  # one of three rounds by one minute


def test_card_and_rule_book_are_told_apart(tongjin: Path, tmp_path: Path) -> None:
    other = copy("tongjin-2015", tmp_path / "b")
    text = (other / "project.toml").read_text(encoding="utf-8")
    text = text.replace('serial = "15001"', 'serial = "15001"\nsigma = { azimuth_arcsec = 6.0 }')
    text = text.replace('"automatic-gyro"', '"metro"')
    (other / "project.toml").write_text(text, encoding="utf-8")
    result = api.compare(tongjin, other)
    assert parts(result) == {"input", "card", "rule_book", "result"}
    (sigma,) = [item for item in result.differences if item.part == "card"]
    assert sigma.name == "HGG05-15001.sigma.azimuth"


def test_other_software_on_the_same_input(tongjin: Path, tmp_path: Path) -> None:
    path = tmp_path / "then.json"
    api.export_json(tongjin, path)
    assert api.compare(path, tongjin).differences == ()
    then = json.loads(path.read_text(encoding="utf-8"))
    then["result"]["software"] = "surveyapp 0.0.9"
    path.write_text(json.dumps(then), encoding="utf-8")
    result = api.compare(path, tongjin)
    assert parts(result) == {"software"}


def test_the_json_of_orient_can_be_compared(
    tongjin: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["orient", str(tongjin), "--json"])
    path = tmp_path / "then.json"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    result = api.compare(path, tongjin)
    assert result.differences == ()
    assert set(result.unknown) == {"input", "card", "rule_book"}
    assert main(["compare", str(path), str(tongjin)]) == 0
    assert "Result: the same" in capsys.readouterr().out
    path.write_text("[]", encoding="utf-8")
    assert main(["compare", str(path), str(tongjin)]) == 2


def many(folder: Path, count: int) -> list[Path]:
    """Copies of the samples; every seventh is broken in its own way."""
    paths = []
    for index in range(count):
        path = copy(SAMPLES[index % 3], folder / f"p{index:03d}")
        if index % 7 == 3:
            (path / "project.toml").write_text("format = 1\nname = [", encoding="utf-8")
        if index % 21 == 10:
            shutil.rmtree(path)
        paths.append(path)
    return paths


class Unlucky(Executor):
    """An executor whose second task is lost with its worker."""

    def __init__(self) -> None:
        self.tasks = 0

    def submit(self, function: Any, /, *arguments: Any, **named: Any) -> Future[Any]:
        self.tasks += 1
        future: Future[Any] = Future()
        if self.tasks == 2:
            future.set_exception(RuntimeError("worker killed"))
        elif self.tasks > 3:
            raise RuntimeError("no more tasks")
        else:
            future.set_result(function(*arguments, **named))
        return future


def test_a_batch_has_one_row_a_project_in_order_and_names_the_broken(tmp_path: Path) -> None:
    paths = many(tmp_path, 24)
    broken = {str(p) for i, p in enumerate(paths) if i % 7 == 3 or i % 21 == 10}
    seen: list[tuple[int, int, int]] = []
    tables = {}
    for name, options in {
        "here": {"jobs": 1, "progress": lambda *state: seen.append(state)},
        "processes": {"jobs": 2},
        "threads": {"executor": ThreadPoolExecutor(2)},
    }.items():
        result = api.batch(paths, tmp_path / f"{name}.csv", **options)  # type: ignore[arg-type]
        assert {path for path, _ in result.failures} == broken
        assert result.failed + result.good + result.limit == 24
        tables[name] = (tmp_path / f"{name}.csv").read_text(encoding="utf-8")
    assert tables["here"] == tables["processes"] == tables["threads"]
    rows = list(csv.DictReader(io.StringIO(tables["here"])))
    assert [row["path"] for row in rows] == [str(path) for path in paths]
    assert all(row["problem"] for row in rows if row["status"] == "failed")
    expected = api.orient(paths[2])
    assert rows[2]["lines"] == str(len(expected.lines)) == "3"
    assert seen[-1] == (24, 24, len(broken))


def test_a_lost_worker_costs_its_projects_and_no_others(tmp_path: Path) -> None:
    path = copy("gi-b1-1966", tmp_path / "p")
    rows = list(api.batch_rows([path] * (5 * CHUNK), executor=Unlucky()))
    assert len(rows) == 5 * CHUNK
    lost = [index // CHUNK for index, row in enumerate(rows) if row.status == "failed"]
    assert sorted(set(lost)) == [1, 3, 4]
    assert "worker" in rows[CHUNK].problem


def test_a_batch_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good, limit = (str(ROOT / "projects" / name) for name in ("gi-b1-1966", "tongjin-2015"))
    table = str(tmp_path / "t.csv")
    assert main(["batch", good, "-o", table]) == 0
    assert main(["batch", good, limit, "-o", table, "--jobs", "1"]) == 1
    assert main(["batch", good, str(tmp_path / "none"), "-o", table, "--json"]) == 2
    printed = capsys.readouterr()
    assert f"failed: {tmp_path / 'none'}" in printed.err
    assert main(["batch", good, "-o", str(tmp_path / "no" / "t.csv")]) == 2


TRAVERSE = """format = 1
name = "Main drive"
[[station]]
name = "A"
e = 1000.0
n = 2000.0
fixed = true
[[station]]
name = "B"
e = 1000.0
n = 2100.0
fixed = true
[[station]]
name = "C"
[[traverse]]
name = "main"
book = "main.csv"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
atmosphere_applied = true
constant_applied = true
"""


def test_a_traverse_is_handed_over_as_a_network(tmp_path: Path) -> None:
    (tmp_path / "project.toml").write_text(TRAVERSE, encoding="utf-8")
    rows = "kind,at,from,to,value,unit\nangle,B,A,C,90-00-00,dms\ndistance,B,,C,50.000,m\n"
    (tmp_path / "main.csv").write_text(rows, encoding="utf-8")
    path = tmp_path / "main.gkf"
    assert main(["export", "gkf", str(tmp_path), str(path)]) == 0
    here, there = ({p.name: p for p in api.adjust(side).points} for side in (tmp_path, path))
    assert there["C"].e == pytest.approx(here["C"].e, abs=1e-6)
    assert there["C"].n == pytest.approx(here["C"].n, abs=1e-6)
    assert main(["export", "gkf", str(ROOT / "projects" / SAMPLES[0]), str(path)]) == 2
