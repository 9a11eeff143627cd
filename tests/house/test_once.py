"""Every command reads a project once and orients it once, and shows the verdicts of one list."""

from __future__ import annotations

import shutil
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.orientation import whole_project
from surveyapp.io import files as io_files
from surveyapp.io import project as io_project

TOML = """\
format = 1
name = "Two traverses"
crs = "EPSG:4546"
rule_book = "own.toml"
[[instrument]]
id = "G1"
card = "wild-gak1"
constant = { arcsec = -10.0, sigma_arcsec = 5.0 }
[[station]]
name = "A"
e = 500000.0
n = 3800000.0
fixed = true
[[station]]
name = "B"
e = 500000.0
n = 3800100.0
fixed = true
[[station]]
name = "C"
[[station]]
name = "D"
e = 500100.0
n = 3800000.0
fixed = true
[[orientation]]
id = "r1"
station = "A"
target = "B"
instrument = "G1"
method = "tracking"
purpose = "survey"
book = "observations/r1.csv"
[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
[[traverse]]
name = "again"
book = "observations/again.csv"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
"""
RULES = """\
id = "own"
title = "Own"
source = "here"
[[limit]]
id = "closure"
quantity = "angular_closure_closed"
limit = 1.0
unit = "arcsec"
clause = "1"
source = "here"
confirmed = true
"""
ROWS = [(1, "R", "3-00-00"), (2, "L", "357-10-00"), (3, "R", "2-55-00"), (4, "L", "357-14-40")]
TRAVERSE = """\
kind,at,from,to,value
angle,B,A,C,270-00-30
angle,C,B,D,270-00-00
angle,D,C,A,270-00-00
distance,B,,C,100.000
distance,C,,D,100.003
gyro,A,,B,
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A project with one session, two traverses of which both miss their closure, a rule book."""
    path = tmp_path / "p"
    (path / "observations").mkdir(parents=True)
    (path / "project.toml").write_text(TOML, encoding="utf-8")
    (path / "own.toml").write_text(RULES, encoding="utf-8")
    sights = "{0},backsight,10-00-0{1},{2},,B,\n"
    book = "seq,kind,value,face,side,target,elapsed_s\n"
    book += sights.format(1, 0, "L") + sights.format(2, 2, "R").replace("10-00", "190-00")
    book += "".join(f"{n + 2},reversal,{v},,{side},,{212 * n}\n" for n, side, v in ROWS)
    book += sights.format(7, 1, "L") + sights.format(8, 3, "R").replace("10-00", "190-00")
    (path / "observations" / "r1.csv").write_text(book, encoding="utf-8")
    for name in ("main", "again"):
        (path / "observations" / f"{name}.csv").write_text(TRAVERSE, encoding="utf-8")
    return path


class Counted:
    """How often a function was called, by its first argument."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function, self.calls = function, Counter[str]()

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        first = arguments[0]
        self.calls[str(getattr(first, "path", first))] += 1
        return self.function(*arguments, **options)


def everywhere(monkeypatch: pytest.MonkeyPatch, function: Callable[..., Any]) -> Counted:
    """Count the calls of a function under every name by which a module of ours knows it."""
    counted = Counted(function)
    for module in [m for name, m in sys.modules.items() if name.startswith("surveyapp")]:
        for name, value in vars(module).copy().items():
            if value is function:
                monkeypatch.setattr(module, name, counted)
    return counted


COMMANDS = [
    (["orient", "DIR"], 1),
    (["orient", "DIR", "--session", "r1"], 1),
    (["orient", "DIR", "--line", "A-B"], 1),
    (["check", "DIR"], 1),
    (["adjust", "DIR"], 1),
    (["adjust", "DIR", "--compass-rule"], 1),
    (["diagnose", "DIR"], 1),
    (["diagnose", "DIR", "--traverse", "main"], 1),
    (["plan", "DIR"], 0),
    (["report", "DIR", "-o", "OUT.pdf"], 1),
    (["report", "DIR", "--text"], 1),
    (["report", "DIR", "--diagnosis", "-o", "OUT.pdf"], 1),
    (["export", "csv", "DIR", "OUT.csv"], 1),
    (["export", "json", "DIR", "OUT.json"], 1),
    (["export", "gkf", "DIR", "OUT.gkf"], 1),
    (["close", "DIR", "--by", "me"], 0),
]


@pytest.mark.parametrize(
    ("command", "orientations"), COMMANDS, ids=[" ".join(c) for c, _ in COMMANDS]
)
def test_a_command_reads_once_and_orients_once(
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    command: list[str],
    *,
    orientations: int,
) -> None:
    main(["orient", str(folder)])  # every module is loaded before the names are counted
    for preload in ("workflows.computing", "workflows.diagnosing", "workflows.predicting"):
        __import__(f"surveyapp.{preload}")
    oriented = everywhere(monkeypatch, whole_project.orient_project)
    projects = everywhere(monkeypatch, io_project.read_project)
    read = everywhere(monkeypatch, io_files.read_bytes)
    arguments = [
        word.replace("DIR", str(folder)).replace("OUT", str(tmp_path / "out")) for word in command
    ]
    assert main(arguments) in (0, 1)
    assert sum(oriented.calls.values()) == orientations
    assert sum(projects.calls.values()) == 1
    books = {name: n for name, n in read.calls.items() if name.endswith(("r1.csv", "main.csv"))}
    if command[:2] != ["export", "json"]:  # which files the texts of every file for a comparison
        assert set(books.values()) == {1}, books


def test_compare_reads_each_side_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = folder.parent / "q"
    shutil.copytree(folder, other)
    main(["orient", str(folder)])
    oriented = everywhere(monkeypatch, whole_project.orient_project)
    projects = everywhere(monkeypatch, io_project.read_project)
    assert main(["compare", str(folder), str(other)]) == 0
    assert sum(oriented.calls.values()) == 2
    assert sum(projects.calls.values()) == 2


def test_a_broken_traverse_book_is_refused_by_every_command(folder: Path) -> None:
    book = folder / "observations" / "main.csv"
    book.write_text(TRAVERSE.replace("270-00-30", "ninety"), encoding="utf-8")
    for command in ("orient", "check", "adjust", "diagnose", "plan"):
        assert main([command, str(folder)]) == 2, command
    assert main(["report", str(folder), "-o", str(folder / "x.pdf")]) == 2


def test_project_and_books_are_told_together(folder: Path) -> None:
    (folder / "observations" / "main.csv").write_text("kind,at,to,value\nx,A,B,1\n")
    (folder / "observations" / "r1.csv").write_text("seq,kind,value\n1,reversal,x\n")
    (folder / "own.toml").write_text(RULES.replace("arcsec", "furlong"), encoding="utf-8")
    with pytest.raises(api.SurveyError) as caught:
        api.open_project(folder)
    places = " ".join(problem.where for problem in caught.value.problems)
    assert all(name in places for name in ("main.csv", "r1.csv", "own.toml"))


def test_every_showing_takes_its_verdicts_from_one_list(folder: Path) -> None:
    found = api.compute(folder)
    expected = [(c.rule, c.where, c.passed, c.value) for c in found.result.checks]
    assert [c.passed for c in found.result.checks if c.rule == "own.closure"].count(False) == 2
    for checks in (api.check(folder), api.orient(folder).checks, api.check(found)):
        assert [(c.rule, c.where, c.passed, c.value) for c in checks] == expected
    text = api.report_text(found)
    assert text.count("NOT MET") >= 2
    assert main(["orient", str(folder)]) == main(["check", str(folder)]) == 1
    of_session = api.orient(folder, session="r1").checks
    assert {c.rule for c in of_session} == {rule for rule, *_ in expected}


@pytest.mark.shared_data
def test_the_traverse_that_misses_its_closure_is_not_met_everywhere(tmp_path: Path) -> None:
    from surveyapp.observation.session import orient_observed
    from surveyapp.tui.views.checks import summary

    case = Path(__file__).resolve().parents[2].parent / "shared" / "cases" / "trav-blunder"
    if not case.is_dir():
        pytest.skip("the shared cases are not here")
    folder = tmp_path / "p"
    shutil.copytree(case, folder)
    found = api.compute(folder)
    (broken,) = [c for c in found.result.checks if c.passed is False and c.confirmed]
    assert (broken.rule, broken.subject.kind) == ("traverse.connecting_closure", "traverse")
    assert broken.value == pytest.approx(72.16, abs=0.01)
    assert broken.limit == pytest.approx(33.54, abs=0.01)
    assert "1 of" in summary(orient_observed(found.project))
    text = api.report_text(found)
    assert "NOT MET: 1 confirmed check" in text
    assert [main([command, str(folder)]) for command in ("orient", "check")] == [1, 1]
