"""Every bad input of a surveyor ends in one clear message and exit code 2, as text and as JSON."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.command import GOOD_BOOK, GOOD_TOML, good_project, run

A_BY_GRID = "e = 431630.663\nn = 3811452.311\n"


def book(old: str, new: str) -> Callable[[Path], None]:
    assert old in GOOD_BOOK
    return lambda folder: _write(good_project(folder, book=GOOD_BOOK.replace(old, new, 1)))


def toml(old: str, new: str) -> Callable[[Path], None]:
    assert old in GOOD_TOML
    return lambda folder: _write(good_project(folder, toml=GOOD_TOML.replace(old, new, 1)))


def _write(folder: Path) -> None:
    assert folder.is_dir()


def no_book(folder: Path) -> None:
    (good_project(folder) / "observations" / "run.csv").unlink()


def only_a_folder(folder: Path) -> None:
    folder.mkdir(parents=True)


def nothing(folder: Path) -> None:
    assert not folder.exists()


def a_file(folder: Path) -> None:
    folder.write_text("x", encoding="utf-8")


def binary(name: str) -> Callable[[Path], None]:
    return lambda folder: _none(
        (good_project(folder) / name).write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20)
    )


def _none(value: object) -> None:
    assert value is not None


def huge(name: str) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        with (good_project(folder) / name).open("wb") as stream:
            stream.truncate(200_000_000)

    return make


LINE_5 = "observations/run.csv, line 5 (seq 4)"
CASES: dict[str, tuple[Callable[[Path], None], dict[str, str]]] = {
    "no angle": (
        book("1-00-00", "one degree"),
        {"what": "no angle", "where": LINE_5, "found": "one degree", "expected": "179-01-56"},
    ),
    "gon in a dms book": (
        book("1-00-00", "1.1111"),
        {"what": "no angle", "where": LINE_5, "found": "1.1111", "hint": "unit column"},
    ),
    "dms under gon": (
        book("1-00-00,", "1-00-00,gon"),
        {"where": LINE_5, "found": "1-00-00", "expected": "gon", "hint": "unit column"},
    ),
    "365 degrees": (
        book("1-00-00", "365-00-00"),
        {"where": LINE_5, "found": "365-00-00", "expected": "360"},
    ),
    "60 minutes": (book("1-00-00", "1-60-00"), {"where": LINE_5, "found": "1-60-00"}),
    "sides do not alternate": (
        book("5,reversal,359-00-40,,,L", "5,reversal,359-00-40,,,R"),
        {
            "what": "do not alternate",
            "where": "observations/run.csv, line 6 (seq 5)",
            "found": "R",
            "expected": "left and right in turn",
            "hint": "missed",
        },
    ),
    "target is no station": (
        book("L,,B", "L,,Bx"),
        {
            "what": "target is no station",
            "where": "observations/run.csv, line 2 (seq 1)",
            "found": "Bx",
            "expected": "[[station]]",
            "hint": "Did you mean B?",
        },
    ),
    "missing book": (
        no_book,
        {"what": "does not exist", "where": "[[orientation]] run", "found": "run.csv"},
    ),
    "unknown card": (
        toml("wild-gak1", "wild-gak"),
        {
            "what": "no such instrument card",
            "where": "[[instrument]] G1",
            "found": "wild-gak",
            "hint": "Did you mean wild-gak1?",
        },
    ),
    "missing card": (
        toml("wild-gak1", "cards/own.toml"),
        {"what": "does not exist", "where": "[[instrument]] G1", "found": "own.toml"},
    ),
    "latitude 82": (
        toml(A_BY_GRID, "lat = 82.0\nlon = 111.0\n"),
        {
            "where": "session run, station A",
            "found": "latitude 82.0000",
            "expected": "75",
            "hint": "latitude_max_deg",
        },
    ),
    "latitude 82 by the grid": (
        toml("n = 3811452.311", "n = 9111452.311"),
        {"where": "session run, station A", "found": "latitude 82.0", "expected": "75"},
    ),
    "a CRS without convergence": (
        toml("EPSG:4546", "EPSG:4326"),
        {
            "what": "convergence",
            "where": "project.toml, crs",
            "found": "WGS 84",
            "expected": "projected",
        },
    ),
    "no CRS at all": (
        toml("EPSG:4546", "Gauss-Krueger"),
        {"where": "project.toml, crs", "found": "Gauss-Krueger", "expected": "EPSG"},
    ),
    "format 2": (
        toml("format = 1", "format = 2"),
        {"what": "newer", "where": "project.toml", "found": "2", "expected": "1", "hint": "update"},
    ),
    "an empty folder": (
        only_a_folder,
        {"what": "empty", "expected": "project.toml", "hint": "surveyapp new"},
    ),
    "no folder": (nothing, {"what": "does not exist", "expected": "project.toml"}),
    "a file": (a_file, {"what": "file", "expected": "project.toml"}),
    "a binary book": (
        binary("observations/run.csv"),
        {"what": "binary", "where": "observations/run.csv", "expected": "UTF-8"},
    ),
    "a binary project": (
        binary("project.toml"),
        {"what": "binary", "where": "project.toml", "expected": "UTF-8"},
    ),
    "a book of 200 MB": (
        huge("observations/run.csv"),
        {"what": "too large", "where": "[[orientation]] run", "found": "200 MB", "expected": "MB"},
    ),
    "a project of 200 MB": (
        huge("project.toml"),
        {"what": "too large", "where": "project.toml", "found": "200 MB", "expected": "MB"},
    ),
    "no TOML": (
        toml('name = "Test"', "name = Test"),
        {"what": "no valid TOML", "where": "project.toml", "found": "line 2"},
    ),
    "a method of nobody": (
        toml('"tracking"', '"trackin"'),
        {"where": "[[orientation]] run", "found": "trackin"},
    ),
    "an instrument of nobody": (
        toml('instrument = "G1"', 'instrument = "G2"'),
        {"where": "run", "found": "G2", "hint": "G1"},
    ),
    "a constant of nobody": (
        toml('book = "obs', 'constant_choice = "line:A-C"\nbook = "obs'),
        {"found": "A-C"},
    ),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("command", ["orient", "check"])
def test_bad_input_is_told(tmp_path: Path, case: str, command: str) -> None:
    make, expected = CASES[case]
    folder = tmp_path / "project"
    make(folder)
    answer = run(command, folder)
    assert answer.code == 2, answer
    assert answer.out == ""
    assert "Traceback" not in answer.err
    assert "internal fault" not in answer.err
    as_json = run(command, folder, "--json")
    assert (as_json.code, as_json.err) == (2, "")
    error = as_json.json
    assert error["schema"] == "surveyapp.error/1"
    assert set(error) == {"schema", "problems"}
    assert error["problems"]
    for problem in error["problems"]:
        assert set(problem) == {"what", "where", "found", "expected", "hint"}
        assert all(isinstance(text, str) for text in problem.values())
    problem = error["problems"][0]
    assert problem["what"]
    assert problem["where"]
    for key, part in expected.items():
        assert part in problem[key], (key, problem)
        assert part in answer.err


def test_all_problems_of_a_project_come_together(tmp_path: Path) -> None:
    bad = GOOD_BOOK.replace("1-00-00", "one").replace("359-01-20", "365-00-00")
    good_project(tmp_path, toml=GOOD_TOML.replace("wild-gak1", "wild"), book=bad)
    problems = run("orient", tmp_path, "--json").json["problems"]
    assert {problem["found"] for problem in problems} == {"one", "365-00-00", "wild"}


def test_good_project_is_good(tmp_path: Path) -> None:
    answer = run("orient", good_project(tmp_path), "--json")
    assert answer.code == 0, answer
    assert answer.json["lines"][0]["grid_azimuth"] is not None


@pytest.mark.parametrize(
    ("arguments", "where", "found", "hint"),
    [
        (["oreint", "DIR"], "surveyapp", "oreint", "Did you mean orient"),
        (["DIR"], "surveyapp", "project", "project` opens a project"),
        (["orient", "DIR", "--session", "rum"], "--session", "rum", "Did you mean run"),
        (["orient", "DIR", "--line", "A-C"], "--line", "A-C", "Did you mean A-B"),
        (["orient", "DIR", "--estimator", "shuler"], "--estimator", "shuler", "mean schuler"),
        (
            ["orient", "DIR", "--estimator", "transit"],
            "session run",
            "transit",
            "one session alone",
        ),
        (["orient", "DIR", "--sesion", "run"], "surveyapp orient", "--sesion", "mean --session"),
        (["orient", "DIR", "more"], "surveyapp orient", "more", ""),
        (["orient"], "surveyapp orient", "", "--help"),
        (["orient", "DIR", "--session"], "surveyapp orient", "", "--help"),
        (["models", "wild-gak"], "card", "wild-gak", "Did you mean wild-gak1"),
        (["new", "DIR"], "", "not empty", ""),
        (["new", "OTHER", "--crs", "EPSG:4326"], "crs", "WGS 84", "grid"),
        (["new", "OTHER", "--angle-unit", "grad"], "--angle-unit", "grad", "gon"),
        (["open", "OTHER"], "other", "", "surveyapp new"),
        (["close", "OTHER"], "other", "", "surveyapp new"),
        (["demo", "more"], "surveyapp demo", "more", ""),
    ],
)
def test_bad_arguments_are_told(
    tmp_path: Path, arguments: list[str], where: str, found: str, *, hint: str
) -> None:
    folder = good_project(tmp_path / "project")
    named = {"DIR": str(folder), "OTHER": str(tmp_path / "other")}
    words = [named.get(word, word) for word in arguments]
    answer = run(*words)
    assert (answer.code, answer.out) == (2, ""), answer
    assert "Traceback" not in answer.err
    for part in (where, found, hint):
        assert part in answer.err
    assert not (tmp_path / "other").exists()
    if words[0] == "open":
        return
    problem = run(*words, "--json").json["problems"][0]
    assert problem["what"]
    assert where in problem["where"]
    assert found in problem["found"]
    assert hint in problem["hint"]


def test_a_line_without_constant_is_told_only_if_it_is_asked_for(tmp_path: Path) -> None:
    text = GOOD_TOML.replace("constant = { arcsec = -9.7, sigma_arcsec = 3.0 }\n", "")
    folder = good_project(tmp_path, toml=text)
    assert run("orient", folder).code == 0
    answer = run("orient", folder, "--line", "A-B")
    assert answer.code == 2
    assert "no instrument constant" in answer.err


def test_a_file_that_may_not_be_read_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = good_project(tmp_path)
    book_path = folder / "observations" / "run.csv"
    usual = Path.open

    def refuse(self: Path, *arguments: object, **options: object) -> object:
        if self == book_path:
            raise PermissionError(13, "Permission denied", str(self))
        return usual(self, *arguments, **options)  # type: ignore[call-overload]

    monkeypatch.setattr(Path, "open", refuse)
    answer = run("orient", folder)
    assert answer.code == 2
    assert "Permission denied" in answer.err
    assert "run.csv" in answer.err


ROOT = Path(__file__).parents[2]
ENVIRONMENT = {
    **{k: v for k, v in os.environ.items() if not k.startswith(("SURVEYAPP", "PYTHON"))},
    "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'models'}",
    "OMP_NUM_THREADS": "1",
}
COMMAND = [sys.executable, "-m", "surveyapp"]
SAMPLE = str(ROOT / "projects" / "gi-b1-1966")


def test_the_real_process_tells_bad_input_without_a_traceback(tmp_path: Path) -> None:
    folder = good_project(tmp_path, book=GOOD_BOOK.replace("1-00-00", "one degree"))
    done = subprocess.run(
        [*COMMAND, "orient", str(folder)], env=ENVIRONMENT, capture_output=True, check=False
    )
    assert (done.returncode, done.stdout) == (2, b"")
    assert b"one degree" in done.stderr
    assert b"Traceback" not in done.stderr


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_reader_that_goes_away_is_no_fault(options: list[str]) -> None:
    with subprocess.Popen(
        [*COMMAND, "orient", SAMPLE, *options],
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        told = process.stderr.read()
    assert told == b""
    assert process.returncode == 0


@pytest.mark.parametrize("options", [[], ["--json"]])
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")
def test_a_full_disk_is_told(options: list[str]) -> None:
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*COMMAND, "orient", SAMPLE, *options],
            env=ENVIRONMENT,
            stdout=full,
            stderr=subprocess.PIPE,
            check=False,
        )
    assert done.returncode == 2
    assert b"cannot be written" in done.stderr
    assert b"Traceback" not in done.stderr
    assert b"Exception" not in done.stderr


def test_a_poor_terminal_gets_escapes_and_json_stays_json(tmp_path: Path) -> None:
    text = GOOD_TOML.replace('name = "Test"', 'name = "\u901a\u91d1 \U0001f9ed"')
    folder = good_project(tmp_path, toml=text)
    environment = {**ENVIRONMENT, "PYTHONIOENCODING": "ascii"}
    for options in ([], ["--json"]):
        done = subprocess.run(
            [*COMMAND, "orient", str(folder), *options],
            env=environment,
            capture_output=True,
            check=False,
        )
        assert (done.returncode, done.stderr) == (0, b"")
        assert done.stdout.isascii()
    assert json.loads(done.stdout)["project"] == "\u901a\u91d1 \U0001f9ed"


def test_a_folder_whose_name_is_no_text(tmp_path: Path) -> None:
    name = os.fsencode(tmp_path) + b"/no\xff"
    done = subprocess.run(
        [*COMMAND, "orient", name, "--json"], env=ENVIRONMENT, capture_output=True, check=False
    )
    assert (done.returncode, done.stderr) == (2, b"")
    assert b"does not exist" in done.stdout


def test_a_fault_of_the_program_is_told_as_such(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*arguments: object, **options: object) -> object:
        raise ZeroDivisionError("a fault")

    monkeypatch.delenv("SURVEYAPP_DEBUG", raising=False)
    monkeypatch.setattr("surveyapp.api.orient", broken)
    folder = good_project(tmp_path)
    answer = run("orient", folder)
    assert (answer.code, answer.out) == (3, "")
    assert "internal fault: ZeroDivisionError" in answer.err
    assert run("orient", folder, "--json").json["schema"] == "surveyapp.error/1"
    monkeypatch.setenv("SURVEYAPP_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        run("orient", folder)
