"""Commands on a simulated system without POSIX, in consoles of other code pages; reserved names.

It was tested so and not on a machine with Windows; the reference says so.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.io import guarded
from surveyapp.io.guarded import is_reserved, place_inside
from surveyapp.observation import home
from tests.tui.helpers_tui import make_calibrations

RUNNER = Path(__file__).with_name("simulated_windows.py")
ROOT = RUNNER.parents[2]
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


@pytest.mark.parametrize("code_page", ["cp437", "cp936"])
def test_an_office_day_without_posix(code_page: str, tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    path = folder / "project.toml"
    path.write_text(path.read_text("utf-8").replace("Ramp 3", NAMES), encoding="utf-8")
    expected = api.orient(folder).to_dict()
    answer = run(tmp_path, code_page, "orient", "p", "--json")
    assert answer.returncode in (0, 1), answer.stderr
    found = json.loads(answer.stdout.decode(code_page))
    assert found["constants"] == expected["constants"]
    steps: tuple[tuple[str, ...], ...] = (
        ("close", "p", "--session", "k1", "--by", NAMES),
        ("reopen", "p", "--session", "k1", "--reason", "x"),
        ("report", "p", "-o", "r.pdf"),
        ("export", "zip", "p", "p.zip"),
        ("new", "n"),
    )
    for step in steps if code_page == "cp437" else steps[:1]:
        answer = run(tmp_path, code_page, *step)
        said = answer.stdout.decode(code_page) + answer.stderr.decode(code_page)
        assert answer.returncode in (0, 1), (step, said)
        assert "Traceback" not in said
        assert "internal fault" not in said
    left = [p.name for p in tmp_path.rglob("*.tmp")]
    assert left == []


@pytest.mark.parametrize(
    "name", ["CON", "con", "NUL.csv", "aux.toml", "COM1", "lpt9.txt", "x.", "x ", "a:b", "PRN.a.b"]
)
def test_names_that_windows_keeps_for_itself_name_no_book(name: str, tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    form = home.NewSession(name, "3083", "3082", "G1", "tracking", "survey")
    with pytest.raises(SurveyError, match="cannot name a field book"):
        home.create_session(folder, form)
    assert sorted(p.name for p in (folder / "observations").iterdir()) == [
        f"k{number}.csv" for number in range(7)
    ]


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
