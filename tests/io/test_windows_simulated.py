"""Commands on a simulated system without POSIX, in consoles of other code pages; reserved names.

It was tested so and not on a machine with Windows; the reference says so.
"""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.api.sensors import LogOptions
from surveyapp.errors import SurveyError
from surveyapp.io import guarded
from surveyapp.io.guarded import can_name_file, is_reserved, place_inside
from surveyapp.observation import home
from tests.formats import field_writers
from tests.formats.importing import field_file
from tests.tui.helpers_tui import NETWORK, NETWORK_BOOK, make_calibrations

RUNNER = Path(__file__).with_name("simulated_windows.py")
ROOT = RUNNER.parents[2]
GSI = field_writers.gsi(*field_writers.simulated(), width=16, length="m4")
NAMES = "\u0643\u0627\u0644\u062d \u77ff\u5c71 \u03a3"


def run(folder: Path, code_page: str, *arguments: str) -> subprocess.CompletedProcess[bytes]:
    environment = {
        **os.environ,
        "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'models'}",
        "PYTHONIOENCODING": code_page,
    }
    return subprocess.run(
        [sys.executable, str(RUNNER), *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        check=False,
    )


def run_all(folder: Path, code_page: str, steps: Iterable[str]) -> tuple[list[Any], set[str]]:
    """What each command answered, all in one process, and the files that were held once.

    No step may fail, and none may leave a file of its own behind.
    """
    file = folder / "steps.json"
    file.write_text(json.dumps([shlex.split(step) for step in steps]), encoding="utf-8")
    answer = run(folder, code_page, "--steps", file.name)
    assert answer.returncode == 0, answer.stderr
    *told, last = (json.loads(line) for line in answer.stdout.decode(code_page).splitlines())
    for step in told:
        assert step["code"] in (0, 1), step
        assert "internal fault" not in step["out"] + step["err"]
    left = [p.name for p in folder.rglob("*") if p.name.endswith((".tmp", ".part"))]
    assert left == []
    return told, {Path(path).name for path in last["held"]}


@pytest.mark.parametrize("code_page", ["cp437", "cp936"])
def test_an_office_day_without_posix(code_page: str, tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    path = folder / "project.toml"
    path.write_text(path.read_text("utf-8").replace("Ramp 3", NAMES), encoding="utf-8")
    expected = api.orient(folder).to_dict()
    if code_page == "cp936":
        answer = run(tmp_path, code_page, "orient", "p", "--json")
        assert answer.returncode in (0, 1), answer.stderr
        found = json.loads(answer.stdout.decode(code_page))
        assert found["constants"] == expected["constants"]
        return
    shutil.copytree(folder, tmp_path / "older")
    steps = (
        "orient p --json",
        f"close p --session k1 --by '{NAMES}'",
        "reopen p --session k1 --reason x",
        "report p -o r.pdf",
        "diagnose p --instrument G1 --archive older --priors priors.toml",
        "export kml p p.kml",
        "export geojson p p.geojson",
        "export zip p p.zip",
        "new n",
    )
    told, held = run_all(tmp_path, code_page, steps)
    assert json.loads(told[0]["out"])["constants"] == expected["constants"]
    assert held >= {"r.pdf", "p.kml", "p.geojson", "p.zip", "project.toml", "priors.toml"}


def test_imports_sensors_programmes_and_adoption_without_posix(tmp_path: Path) -> None:
    field_file(tmp_path, "f.gsi", GSI)
    network = tmp_path / "t"
    (network / "observations").mkdir(parents=True)
    (network / "project.toml").write_text(NETWORK, encoding="utf-8")
    (network / "observations" / "main.csv").write_text(NETWORK_BOOK, encoding="utf-8")
    api.close(network)
    (network / ".surveyapp.lock").unlink()  # a soft lock is held as long as its file stands
    ledger, other = network / "ledger.jsonl", tmp_path / "other.jsonl"
    other.hardlink_to(ledger)  # a backup that shares its bytes
    before = other.read_bytes()
    tables = ("csv", "gkf", "json", "gsi", "sdr", "starnet", "dxf", "landxml")
    steps = (
        "reopen t --reason x",
        "new n",
        "import gsi f.gsi n",
        "adjust t",
        "diagnose t --traverse main",
        "report t -o t.pdf --sheets",
        *(f"export {form} t out.{form}" for form in tables),
        "simulate tilt s --seed 2 --effect warm_up=30",
        "diagnose s --sensor tilt --adopt",
        "calibrate tilt s --card tilt.toml",
        "compensate tilt s --card tilt.toml -o true.csv",
        "programme start n compass-swing --id sw",
        "programme enter n sw next",
        "programme strike n sw",
        "programme show n sw",
        "simulate campaign g --seed 3 --effect temperature=1.5",
        "diagnose g --campaign G1 --adopt",
        "check g",
    )
    _, held = run_all(tmp_path, "cp437", steps)
    assert held >= {*(f"out.{form}" for form in tables), "project.toml", "ledger.jsonl"}
    assert held >= {"f.gsi", "f.raw.csv", "f.csv", "t-traverse-main.html", "t-traverse-main.csv"}
    assert held >= {"s", "g", "tilt.toml", "true.csv", ".surveyapp.journal"}
    assert other.read_bytes() == before
    assert len(ledger.read_bytes()) > len(before)


RESERVED = ["CON", "con", "NUL.csv", "aux.toml", "COM1", "lpt9.txt", "x.", "x ", "a:b", "PRN.a.b"]


@pytest.mark.parametrize("name", RESERVED)
def test_names_that_windows_keeps_for_itself_name_no_file(name: str, tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    field = field_file(tmp_path, "f.gsi", GSI)
    log = tmp_path / "log.csv"
    log.write_text("time_s,mag_x_uT\n0,1\n1,2\n", encoding="utf-8")
    columns = LogOptions(columns={"time_s": "time_s", "mag_x_uT": "mag_x_uT"})
    before = sorted(p for p in folder.rglob("*"))
    form = home.NewSession(name, "3083", "3082", "G1", "tracking", "survey")
    for make in (
        lambda: home.create_session(folder, form),
        lambda: api.import_file("gsi", field, folder, traverse=name),
        lambda: api.begin_programme(folder, "compass-swing", name),
        lambda: api.add_sensor_log(folder, log, identity=name, kind="compass", log=columns),
    ):
        with pytest.raises(SurveyError, match=r"cannot name a field book|this is no (name|id)"):
            make()
    assert sorted(p for p in folder.rglob("*")) == before


@pytest.mark.parametrize("name", ["CON.gsi", "a:b.gsi", "nul", "x.gsi."])
def test_a_field_file_of_such_a_name_is_stored_under_another(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "p"
    api.new_project(folder)
    result = api.import_file("gsi", field_file(tmp_path, name, GSI), folder)
    for stored in (result.file, result.book, result.raw):
        assert (folder / stored).is_file()
        assert can_name_file(Path(stored).name)


def test_a_reserved_name_is_a_device_there_and_a_file_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert is_reserved("observations/NUL.csv")
    assert is_reserved("CON/x.csv")
    assert not is_reserved("observations/CONE.csv")
    assert not is_reserved("observations/nul-1.csv")
    assert place_inside(tmp_path, "observations/NUL.csv") is not None
    monkeypatch.setattr(guarded, "ON_WINDOWS", True)
    assert place_inside(tmp_path, "observations/NUL.csv") is None
    assert place_inside(tmp_path, "observations/r1.csv") is not None
    for name in ("C:\\x.csv", "c:x.csv", "\\\\server\\share\\x.csv", "\\x.csv", "//server/x"):
        assert place_inside(tmp_path, name) is None


def test_a_path_that_is_too_long_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "/".join(["x" * 60] * 4)
    monkeypatch.setattr(guarded, "ON_WINDOWS", True)
    with pytest.raises(SurveyError, match="longer than Windows"):
        api.new_project(folder, name="deep")
    assert not folder.exists()
    shutil.rmtree(tmp_path / ("x" * 60), ignore_errors=True)
