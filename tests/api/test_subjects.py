"""What a verdict is about is a value: names that look alike are never taken for each other."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.orientation.circumstances import (
    Circumstances,
    columns_of,
    name_of,
    numbered,
)
from surveyapp.core.orientation.line_names import resolve_line
from surveyapp.domain.station_line import StationLine, meanings
from surveyapp.errors import SurveyError
from tests.api.projects import GYRO, TM, azimuths, session, station, write

KNOWN = "constant = { arcsec = 10.0, sigma_arcsec = 2.0 }\n"
SURVEY = ['purpose = "survey"', "sigma_arcsec = 5.0"]
CASES = Path(__file__).resolve().parents[2].parent / "shared" / "cases"


def two_gyros(folder: Path, lines: list[tuple[str, str, str, str, str]], stations: str) -> Path:
    """A project of automatic gyros G1 and G2: (session, station, target, instrument, azimuth)."""
    toml = GYRO + KNOWN + GYRO.replace('"G1"', '"G2"') + KNOWN + stations
    for name, at, to, instrument, _ in lines:
        toml += session(name, at, to, more=SURVEY).replace('"G1"', f'"{instrument}"')
    books = {name: azimuths(value) for name, _, _, _, value in lines}
    return write(folder, toml, books, head=TM)


AB = station("A", e=1000.0, n=5200000.0) + station("B", e=1300.0, n=5200400.0)


def test_each_session_keeps_its_checks_whatever_its_neighbours_are_called(tmp_path: Path) -> None:
    names = ["run", "run 2", "run 2 b", "run-2"]
    folder = two_gyros(tmp_path, [(n, "A", "B", "G1", "36-50-00") for n in names], AB)
    (folder / "card.toml").write_text(
        (folder / "card.toml").read_text() + "[range]\ntemperature_c = [-20.0, 50.0]\n"
    )
    everything = api.check(folder)
    for name in names:
        own = api.orient(folder, session=name).checks
        named = {c.subject.id for c in own if c.subject.kind == "session"}
        assert named == {name}
        expected = [c.rule for c in everything if c.subject.id in (name, *named)]
        assert [c.rule for c in own if c.subject.kind == "session"] == expected


def test_one_book_under_two_names_has_one_verdict(tmp_path: Path) -> None:
    """The case of two sessions with the same book, ``run`` and ``run 2``."""
    if not CASES.is_dir():
        pytest.skip("the shared cases are not here")
    folder = tmp_path / "p"
    shutil.copytree(CASES / "session-names-share-a-beginning", folder)
    codes = [main(["orient", str(folder), "--session", name]) for name in ("run", "run 2")]
    assert codes == [1, 1]
    first, second = (api.orient(folder, session=name).checks for name in ("run", "run 2"))
    pairs = [
        [(c.rule, c.passed) for c in checks if c.subject.kind == "session"]
        for checks in (first, second)
    ]
    assert pairs[0] == pairs[1] != []


def test_a_line_is_shown_by_every_instrument_that_oriented_it(tmp_path: Path) -> None:
    lines = [("one", "A", "B", "G1", "36-50-00"), ("two", "A", "B", "G2", "36-50-30")]
    result = api.orient(two_gyros(tmp_path, lines, AB), line="A-B")
    assert [(x.subject.kind, x.subject.instrument) for x in result.lines] == [
        ("line", "G1"),
        ("line", "G2"),
    ]
    assert len({x.subject for x in result.lines}) == 2


def test_forward_and_back_of_two_instruments_are_all_compared(tmp_path: Path) -> None:
    lines = [
        ("1", "A", "B", "G1", "36-50-00"),
        ("2", "B", "A", "G1", "216-50-10"),
        ("3", "A", "B", "G2", "36-50-40"),
        ("4", "B", "A", "G2", "216-50-20"),
    ]
    checks = [c for c in api.check(two_gyros(tmp_path, lines, AB)) if c.rule == "line.forward_back"]
    values = {c.where: round(c.value or 0.0) for c in checks}
    # convergence differs by a few seconds between the ends: what counts is their order
    assert set(values) == {
        "A-B (G1)",
        "A-B (G1 there, G2 back)",
        "B-A (G1 there, G2 back)",
        "A-B (G2)",
    }
    shift = 10 - values["A-B (G1)"]
    assert abs(values["A-B (G1 there, G2 back)"] - (20 - shift)) <= 1
    assert {c.subject.instrument for c in checks} == {"G1", "G2"}


HYPHENS = (
    station("A-B", e=1000.0, n=5200000.0)
    + station("C", e=1300.0, n=5200400.0)
    + station("A", e=2000.0, n=5200000.0)
    + station("B-C", e=2300.0, n=5200500.0)
)


def test_hyphens_in_station_names_are_resolved_or_told(tmp_path: Path) -> None:
    lines = [("1", "A-B", "C", "G1", "36-50-00"), ("2", "A", "B-C", "G1", "30-50-00")]
    one = two_gyros(tmp_path / "one", lines[:1], HYPHENS)
    both = two_gyros(tmp_path / "both", lines, HYPHENS)
    assert [x.station for x in api.orient(one, line="A-B-C").lines] == ["A-B"]
    with pytest.raises(SurveyError, match="means several lines") as caught:
        api.orient(both, line="A-B-C")
    assert caught.value.problems[0].expected == "A,B-C or A-B,C"
    assert [x.station for x in api.orient(both, line="A,B-C").lines] == ["A"]
    assert [x.station for x in api.orient(both, line=("A-B", "C")).lines] == ["A-B"]
    assert main(["orient", str(both), "--line", "A-B-C"]) == 2


def test_meanings_are_pairs_of_stations_that_exist() -> None:
    assert meanings("A-B-C", ["A", "B-C", "A-B", "C"]) == (
        StationLine("A", "B-C"),
        StationLine("A-B", "C"),
    )
    assert meanings("A-B", ["A", "C"]) == ()
    with pytest.raises(SurveyError, match="no oriented line"):
        resolve_line("A-B", ["A", "B"], ())


def test_a_confirming_session_may_be_called_anything(tmp_path: Path) -> None:
    names = [f"det {i:02d}" for i in range(1, 9)] + ["det 09 (b)", "det 10", "det 11 (c) (d)"]
    toml = GYRO + AB
    for place, name in enumerate(names):
        more = [
            'purpose = "calibration"',
            'azimuth_known = "36-52-12"',
            "sigma_arcsec = 5.0",
            f"order = {place}",
        ]
        toml += session(name, "A", "B", more=more)
    books = {name: azimuths(f"36-50-{i:02d}") for i, name in enumerate(names)}
    folder = write(tmp_path, toml, books, head=TM)
    found = api.diagnose(folder, campaign="G1", confirm="det 09 (b)", log=False)
    assert found.diagnosis is not None
    assert found.diagnosis.before.confirm_rms is not None
    with pytest.raises(SurveyError, match="no determination") as caught:
        api.diagnose(folder, campaign="G1", confirm="det 09", log=False)
    assert "det 09 (b)" in caught.value.problems[0].hint


def test_every_check_of_the_samples_says_what_it_is_about() -> None:
    samples = Path(__file__).resolve().parents[2] / "projects"
    for folder in sorted(path for path in samples.iterdir() if (path / "project.toml").exists()):
        project = api.open_project(folder)
        sessions = {item.id for item in project.sessions}
        instruments = {item.id for item in project.instruments}
        for check in api.check(folder):
            data = check.to_dict()["subject"]
            assert set(data) == {"kind", "id", "station", "target", "instrument"}
            if check.subject.kind == "session":
                assert check.subject.id in sessions
            if check.subject.kind in ("instrument", "line"):
                assert (check.subject.instrument or check.subject.id) in instruments


ALIKE = [("cal-1", "A-B", "C", "G1", "36-50-00"), ("cal-2", "A", "B-C", "G1", "30-50-20")]


def two_lines_of_one_text(folder: Path, choice: str) -> Path:
    """Calibrations on A-B to C and on A to B-C, which both read A-B-C, and one survey line."""
    toml = GYRO.replace('id = "G1"', f'id = "G1"\n{choice}') + HYPHENS
    toml += station("D", e=1900.0, n=5200900.0)
    for name, at, to, _, _ in ALIKE:
        toml += session(name, at, to, more=['purpose = "calibration"', "sigma_arcsec = 5.0"])
    toml += session("run", "A", "D", more=SURVEY)
    books = {name: azimuths(value) for name, _, _, _, value in ALIKE}
    return write(folder, toml, books | {"run": azimuths("353-30-00")}, head=TM)


def test_calibration_lines_of_one_text_are_two_lines(tmp_path: Path) -> None:
    result = api.orient(two_lines_of_one_text(tmp_path, 'constant_choice = "pooled"'))
    lines = result.constants[0].by_line
    assert [(x.station, x.target, x.count) for x in lines] == [("A-B", "C", 1), ("A", "B-C", 1)]


def test_a_constant_of_a_line_is_that_of_its_two_stations(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="means several lines") as caught:
        api.orient(two_lines_of_one_text(tmp_path / "text", 'constant_choice = "line:A-B-C"'))
    assert caught.value.problems[0].expected == "line:A,B-C or line:A-B,C"
    values = {}
    for typed in ("A-B,C", "A,B-C"):
        folder = two_lines_of_one_text(tmp_path / typed, f'constant_choice = "line:{typed}"')
        result = api.orient(folder)
        values[typed] = result.lines[0].constant
        assert result.lines[0].constant_choice == "line:A-B-C"
        of_line = {f"{x.station},{x.target}": x.value for x in result.constants[0].by_line}
        assert values[typed] == of_line[typed]
    assert values["A-B,C"] != values["A,B-C"]


def test_a_campaign_numbers_lines_by_their_stations_and_prints_them_apart() -> None:
    facts = [
        Circumstances.of({"line": StationLine(at, to)})
        for at, to in (("A-B", "C"), ("A", "B-C"), ("A-B", "C"))
    ]
    assert columns_of(facts)["line"].tolist() == [0.0, 1.0, 0.0]
    numbers, texts = numbered([fact.name("line") for fact in facts])
    assert numbers.tolist() == [0.0, 1.0, 0.0]
    assert texts == {0.0: "A-B,C", 1.0: "A,B-C"}
    lines = [fact.name("line") for fact in facts]
    assert name_of("A,B-C", lines) == StationLine("A", "B-C")
    with pytest.raises(SurveyError, match="means several lines"):
        name_of("A-B-C", lines)
    assert name_of("A-B-C", lines[:1]) == StationLine("A-B", "C")
