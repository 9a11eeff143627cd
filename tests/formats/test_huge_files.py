"""Files larger than memory should hold: read as a stream, answered in words, taken in parts.

The limits are made small where a test is about them; ``python -m bench huge_files`` takes 100 MB.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.io.importers.fieldfiles import damage, parts
from tests.cli.command import run
from tests.formats import field_writers as w
from tests.formats.importing import bring, field_file, project, rows, tree
from tests.formats.test_import_damage import FILES, OPTIONS

SETUPS, SIGHTS = w.simulated(stations=6, rounds=3)
UNITS = {"hz": "gon", "v": "gon", "sd": "m", "hi": "m", "ht": "m"}
LARGE: dict[str, tuple[list[str], dict[str, Any]]] = {
    "gsi": (w.gsi(SETUPS, SIGHTS), {}),
    "sdr": (w.sdr(SETUPS, SIGHTS), {}),
    "jobxml": (w.jobxml(SETUPS, SIGHTS), {}),
    "csv": (w.table(SIGHTS), {"columns": w.TABLE_MAP, "units": UNITS}),
}


@pytest.mark.parametrize("form", ["gsi", "sdr", "jobxml", "csv"])
def test_a_file_too_large_for_one_book_is_taken_in_parts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    """The parts that the refusal names hold every reading once, and none cuts a set-up."""
    lines, options = LARGE[form]
    _, whole = bring(tmp_path / "whole", form, lines, **options)
    monkeypatch.setattr(parts, "MOST_READINGS", 30)
    monkeypatch.setattr(parts, "PART", 30)
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "field", lines)
    with pytest.raises(SurveyError) as refused:
        api.import_file(form, path, folder, traverse="main", **options)
    problem = refused.value.problems[0]
    assert problem.found == f"{len(SIGHTS)} readings"
    named = [text.strip() for text in problem.hint.rpartition(": ")[2].split(",")]
    assert len(named) == 3  # 12 readings a set-up
    found = []
    for number, text in enumerate(named):
        first, last = (int(part) for part in text.split("-"))
        result = api.import_file(
            form, path, folder, traverse=f"t{number}", lines=(first, last), **options
        )
        assert result.file == "imports/field"
        assert result.readings == 24
        found += rows(folder / result.raw)
    wanted = rows(tmp_path / "whole" / "p" / whole.raw)
    assert [{**row, "set": ""} for row in found] == [{**row, "set": ""} for row in wanted]


def test_lines_on_the_command_line(tmp_path: Path) -> None:
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.gsi", LARGE["gsi"][0])
    result = run("import", "gsi", str(path), str(folder), "--lines", "1-13", "--json")
    assert json.loads(result.out)["readings"] == 12
    for text in ("5", "5-3", "a-b", "-", "0-4", "1-²"):
        refused = run("import", "gsi", str(path), str(folder), "--lines", text, "--json")
        assert refused.code == 2
        assert json.loads(refused.out)["problems"][0]["where"] == "--lines"


def test_damage_outside_the_lines_does_not_count(tmp_path: Path) -> None:
    lines = list(LARGE["gsi"][0])
    lines[20] = lines[20][:-9]
    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.gsi", lines)
    assert api.import_file("gsi", path, folder, lines=(1, 13)).readings == 12
    with pytest.raises(SurveyError, match="line 21"):
        api.import_file("gsi", path, folder, traverse="b", lines=(14, 27))


def test_gsi_blocks_on_one_line_longer_than_a_line_may_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("surveyapp.io.importers.fieldfiles.lines.LONGEST_LINE", 1 << 16)
    setups, sights = w.simulated(stations=10, rounds=15)
    lines = w.gsi(setups, sights, width=16)
    one, _ = bring(tmp_path / "one", "gsi", ["".join(lines)])
    assert len("".join(lines)) > 1 << 16
    many, _ = bring(tmp_path / "many", "gsi", lines)
    found, wanted = (rows(folder / "imports" / "main.raw.csv") for folder in (one, many))
    assert [{**row, "line": ""} for row in found] == [{**row, "line": ""} for row in wanted]


@pytest.mark.parametrize("form", ["sdr", "csv"])
def test_a_line_without_end_is_told(tmp_path: Path, form: str) -> None:
    lines = [*FILES[form], "x" * (1 << 21)]
    with pytest.raises(SurveyError, match=rf"line {len(lines)}: the line is too long"):
        bring(tmp_path, form, lines, **OPTIONS.get(form, {}))


@pytest.mark.parametrize("form", ["gsi", "sdr", "csv"])
def test_of_a_flood_of_damage_every_line_has_its_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    monkeypatch.setattr(damage, "MOST_NAMED", 3)
    lines = [*FILES[form], *["?" * 30] * 5, FILES[form][-1], "??", ""]
    with pytest.raises(SurveyError) as refused:
        bring(tmp_path, form, lines, **OPTIONS.get(form, {}))
    first = len(FILES[form]) + 1
    problems = refused.value.problems
    assert [p.where for p in problems[:3]] == [f"field.{form}, line {first + i}" for i in range(3)]
    assert problems[3].where == f"field.{form}, lines {first + 3}-{first + 4}, {first + 6}"
    monkeypatch.setattr(damage, "FLOOD", 6)
    with pytest.raises(SurveyError, match="can be listed"):
        bring(tmp_path / "b", form, lines, skip_damaged=True, **OPTIONS.get(form, {}))


_CHILD = """
import resource, sys
from surveyapp import api
told = []
result = api.import_file("jobxml", sys.argv[1], sys.argv[2], progress=told.append)
print(result.readings, len(told), max(told), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no measure of memory")
def test_the_memory_does_not_grow_with_the_file(tmp_path: Path) -> None:
    """60 MB of records that are not used: less than 40 MB of memory more than 0.1 MB of them."""
    lines = FILES["jobxml"]
    note = "<NoteRecord><Note>" + "x" * 4000 + "</Note></NoteRecord>\n"
    used = []
    for count in (25, 15_000):
        folder = project(tmp_path / str(count))
        path = tmp_path / f"{count}.jxl"
        with path.open("w", encoding="utf-8") as stream:
            stream.write("\n".join(lines[:-1]) + "\n")
            for _ in range(count):
                stream.write(note)
            stream.write(lines[-1] + "\n")
        done = subprocess.run(
            [sys.executable, "-c", _CHILD, str(path), str(folder)],
            check=True,
            capture_output=True,
            text=True,
        )
        readings, told, last, memory = (float(text) for text in done.stdout.split())
        assert (readings, last) == (24, 1.0)
        assert told >= (1 if count == 25 else 100)
        used.append(memory / 1024.0)
    assert used[1] - used[0] < 40.0


def test_a_file_that_changes_meanwhile_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from surveyapp.io.importing import traverse

    folder = project(tmp_path / "p")
    path = field_file(tmp_path, "f.gsi", LARGE["gsi"][0])
    real = traverse.read_traverse_file

    def slow(*arguments: Any) -> Any:
        read = real(*arguments)
        path.write_bytes(path.read_bytes() + b"\n")
        return read

    monkeypatch.setattr(traverse, "read_traverse_file", slow)
    with pytest.raises(SurveyError, match="changed while"):
        api.import_file("gsi", path, folder)
    assert list(tree(folder)) == ["project.toml"]
