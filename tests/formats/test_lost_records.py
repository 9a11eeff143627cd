"""Records that were wiped out or swallowed: what they may have said holds no more."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from tests.formats import field_writers as w
from tests.formats.importing import bring, field_file, project, rows
from tests.formats.test_import_damage import FILES, OPTIONS, _readings


def _heights(lines: list[str]) -> list[int]:
    return [i for i, line in enumerate(lines) if line.startswith("03")]


def test_a_record_wiped_out_is_no_blank_line(tmp_path: Path) -> None:
    """A target height of blanks: what follows may have another, up to the next one."""
    lines = list(FILES["sdr"])
    gone, following = _heights(lines)[3:5]
    lines[gone] = " " * len(lines[gone])
    with pytest.raises(SurveyError) as refused:
        bring(tmp_path / "a", "sdr", lines)
    assert [p.where for p in refused.value.problems] == [f"field.sdr, line {gone + 1}"]
    folder, result = bring(tmp_path / "b", "sdr", lines, skip_damaged=True)
    dependent = {x.line for x in result.skipped if x.code == "depends_on_damaged"}
    lost = {i + 1 for i in _readings("sdr") if gone < i < following}
    assert lost == dependent
    kept = {int(row["line"]) for row in rows(folder / "imports" / "main.raw.csv")}
    assert kept == {i + 1 for i in _readings("sdr")} - lost
    lines[gone] = FILES["sdr"][gone]
    _, result = bring(tmp_path / "c", "sdr", [*lines, " " * 20])  # behind the last record: nothing
    assert not result.skipped


def test_a_joined_line_may_have_swallowed_a_target_height(tmp_path: Path) -> None:
    """A reading whose end ran over the record behind it: its height holds for nobody."""
    lines = list(FILES["sdr"])
    gone = next(i for i in _heights(lines) if lines[i - 1].startswith("09") and i > 20)
    length = len(lines[gone - 1])
    lines[gone - 1] = lines[gone - 1][: length - 24] + " " * 40 + "400"
    del lines[gone]
    _, result = bring(tmp_path, "sdr", lines, skip_damaged=True)
    codes = {item.line: item.code for item in result.skipped}
    assert codes[gone] == "damaged"
    assert codes[gone + 1] == "depends_on_damaged"


def test_a_joined_line_may_have_swallowed_a_station(tmp_path: Path) -> None:
    """What then names another station than the one before has lost it, with its height."""
    lines = list(FILES["sdr"])
    gone = [i for i, line in enumerate(lines) if line.startswith("02")][1]
    lines[gone - 1] = lines[gone - 1].ljust(100) + "41737"
    del lines[gone]
    following = next(i for i, line in enumerate(lines) if i >= gone and line.startswith("02"))
    folder, result = bring(tmp_path, "sdr", lines, skip_damaged=True)
    codes = {item.line: item.code for item in result.skipped}
    lost = [i + 1 for i, line in enumerate(lines) if gone <= i < following and line[:2] == "09"]
    assert {codes[line] for line in lost} == {"depends_on_damaged"}
    raw = rows(folder / "imports" / "main.raw.csv")
    assert not {int(row["line"]) for row in raw} & set(lost)


def test_a_sight_without_a_circle_reading(tmp_path: Path) -> None:
    lines = list(FILES["sdr"])
    place = _readings("sdr")[-1]
    lines[place] = lines[place][:68].rstrip()
    with pytest.raises(SurveyError, match=r"cut short|no circle reading"):
        bring(tmp_path, "sdr", lines[: place + 1])


def test_a_word_lost_inside_a_block_is_told(tmp_path: Path) -> None:
    lines = w.gsi(*w.simulated(4, 3))
    place = next(i for i, line in enumerate(lines) if " 31." in line and i > 12)
    start = lines[place].index(" 31.")
    end = lines[place].index(" ", start + 1)
    lines[place] = lines[place][:start] + lines[place][end:]
    _, result = bring(tmp_path, "gsi", lines)
    told = [item.text for item in result.warnings if item.code == "unlike_blocks"]
    assert len(told) == 1
    assert f"line {place + 1} without 31" in told[0]


def test_a_station_sighted_from_itself_behind_a_gap_is_a_lost_station(tmp_path: Path) -> None:
    """A station block is missing: that a point is sighted from itself gives it away."""
    lines = list(FILES["gsi"])
    gone = [i for i, line in enumerate(lines) if " 84." in line][1]
    del lines[gone]
    _, result = bring(tmp_path, "gsi", lines, skip_damaged=True)
    codes = {item.line: item.code for item in result.skipped}
    itself = min(line for line, code in codes.items() if code == "damaged")
    following = next(i for i, line in enumerate(lines) if " 84." in line and i > gone)
    assert all(
        codes.get(line) in ("damaged", "depends_on_damaged")
        for line in range(itself, following + 1)
    )


@pytest.mark.parametrize("form", ["gsi", "sdr", "csv"])
def test_a_file_without_a_last_line_end_is_told(tmp_path: Path, form: str) -> None:
    for number, end in enumerate(("\n", "\r\n", "")):
        folder = project(tmp_path / f"p{number}")
        path = field_file(tmp_path, "f", FILES[form])
        path.write_bytes(path.read_bytes().rstrip(b"\n") + end.encode())
        result = api.import_file(form, path, folder, traverse="main", **OPTIONS.get(form, {}))
        assert ("open_end" in {x.code for x in result.warnings}) == (not end)


def test_a_prism_constant_that_is_in_some_of_the_distances(tmp_path: Path) -> None:
    """The notes hold from where they stand: -30 mm are added to what follows "Not applied"."""
    lines = [line for line in FILES["sdr"] if not line.startswith("13PC")]
    places = [i for i, line in enumerate(lines) if line.startswith("02")]
    notes = ["13PCP.C. mm Applied:-30.000", "13PCP.C. mm Not applied:-30.000"]
    marked = list(lines)
    marked[places[1] : places[1]] = [notes[1]]
    marked[places[0] : places[0]] = [notes[0]]
    plain, _ = bring(tmp_path / "a", "sdr", lines)
    folder, result = bring(tmp_path / "b", "sdr", marked)
    assert "raw_distances" in {item.code for item in result.warnings}
    assert not {"constant_mixed", "constant_unknown"} & {item.code for item in result.warnings}
    assert "constant_applied = true" in (folder / "project.toml").read_text("utf-8")
    first = lines[places[0]][4:20].strip()
    for old, new in zip(
        rows(plain / "observations" / "main.csv"),
        rows(folder / "observations" / "main.csv"),
        strict=True,
    ):
        if old["kind"] == "slope_distance":
            added = 0.0 if old["at"] == first else -0.03
            assert float(new["value"]) - float(old["value"]) == pytest.approx(added, abs=1e-6)
    marked[places[0] : places[0] + 1] = []  # nobody says of the first station
    _, result = bring(tmp_path / "c", "sdr", marked)
    assert "constant_mixed" in {item.code for item in result.warnings}
