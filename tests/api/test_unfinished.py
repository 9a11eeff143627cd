"""A session that is still being observed holds nothing up; a wrong one is told as before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.orientation.unfinished import lacking
from surveyapp.core.simulate.session import book_text, simulate_session
from surveyapp.core.simulate.specification import SessionSpec, SwingMethod
from surveyapp.errors import SurveyError
from tests.cli.command import GOOD_BOOK, GOOD_TOML, run

SECOND = """
[[orientation]]
id = "late"
station = "A"
target = "B"
instrument = "G1"
method = "{method}"
purpose = "survey"
book = "observations/late.csv"
"""
CONSTANTS = """
scale_value_arcsec = 600.0
period = { latitude_deg = 47.0, tracking_s = 425.4, clamped_s = 388.3, unspun_s = 146.0 }
sigma = { reversal_arcsec = 6.0, azimuth_arcsec = 15.0, scale_div = 0.05, time_s = 0.2 }
"""
TRAVERSE = """
[[station]]
name = "F"
e = 431640.0
n = 3811400.0
fixed = true

[[station]]
name = "P"

[[traverse]]
name = "main"
book = "main.csv"
sigma_angle_arcsec = 10.0
sigma_distance = { mm = 3.0, ppm = 0.0 }
"""
LEG = "kind,at,from,to,value\nangle,A,F,P,120-00-00\ndistance,A,,P,50.000\n"
HEAD = "seq,elapsed_s,kind,value,unit,face,side,target\n"


def project(folder: Path, late: str | None, method: str = "tracking", more: str = "") -> Path:
    """A good session, and a second one with this book."""
    (folder / "observations").mkdir(parents=True)
    toml = GOOD_TOML.replace(
        "constant = { arcsec = -9.7, sigma_arcsec = 3.0 }\n",
        "constant = { arcsec = -9.7, sigma_arcsec = 3.0 }" + CONSTANTS,
    )
    (folder / "observations" / "run.csv").write_text(GOOD_BOOK, encoding="utf-8")
    if late is not None:
        toml += SECOND.format(method=method)
        (folder / "observations" / "late.csv").write_text(late, encoding="utf-8")
    (folder / "project.toml").write_text(toml + more, encoding="utf-8")
    return folder


def book(*rows: str) -> str:
    """A book of ``kind,value`` rows, a minute apart."""
    lines = [f"{i},{60 * i},{row}" for i, row in enumerate(rows, start=1)]
    return HEAD + "".join(line + "," * (7 - line.count(",")) + "\n" for line in lines)


UNFINISHED = {
    "nothing": ("tracking", book(), "0 turning points"),
    "set-up": ("tracking", book("level_along,2,arcsec"), "0 turning points"),
    "one": ("tracking", book("reversal,359-00-00"), "1 turning points, 3 are the least"),
    "pre-orientation": ("tracking", book("reversal,359-00-00", "reversal,1-00-00"), "2 turning"),
    "one side": (
        "tracking",
        book("reversal,359-00-00,,,L", "missed,", "reversal,359-00-40,,,L", "missed,",
             "reversal,359-01-20,,,L"),
        "one side only",
    ),
    "scale": (
        "amplitude",
        book("clamp,0-05-00", "scale_reversal,7.2", "scale_reversal,-6.4"),
        "2 turning points on the scale, 3 are the least",
    ),
    "no clamp yet": ("amplitude", book("scale_reversal,7.2"), "1 turning points on the scale"),
    "two transits": (
        "transit",
        book("clamp,0-05-00", "transit,0", "scale_reversal,7.2", "transit,0",
             "scale_reversal,-6.4"),
        "2 transits, 3 are the least",
    ),
    "no triple": (
        "transit",
        book("clamp,0-05-00", "transit,0", "scale_reversal,7.2", "missed,", "scale_reversal,7.1",
             "transit,0", "scale_reversal,-6.4", "missed,", "scale_reversal,-6.3", "transit,0"),
        "no three transits of one division in a row",
    ),
    "no round": ("automatic", book("temperature,12,C"), "no round yet"),
}  # fmt: skip
WRONG = {
    "scale": ("amplitude", book("clamp,0-05-00", "scale_reversal,72"), "beyond the scale"),
    "clamps": (
        "amplitude",
        book("clamp,0-05-00", "clamp,9-05-00", "scale_reversal,7"),
        "different readings",
    ),
    "faces": (
        "tracking",
        book("backsight,40-00-00,,L,,B", "backsight,300-00-00,,R,,B", "reversal,359-00-00"),
        "faces",
    ),
    "target": ("tracking", book("backsight,40-00-00,,L,,Z", "reversal,359-00-00"), "no station"),
    "still": (
        "tracking",
        book("reversal,359-00-00", "reversal,359-00-00", "reversal,359-00-00"),
        "do not swing",
    ),
    "no clamp": (
        "amplitude",
        book("scale_reversal,7", "scale_reversal,-5", "scale_reversal,6.9"),
        "clamped",
    ),
}


@pytest.mark.parametrize("name", UNFINISHED)
def test_it_is_left_out_with_a_warning_that_says_what_is_missing(tmp_path: Path, name: str) -> None:
    method, late, missing = UNFINISHED[name]
    folder = project(tmp_path / "p", late, method)
    result = api.orient(folder)
    (told,) = [item.text for item in result.warnings if item.code == "session_unfinished"]
    assert told.startswith("session late is left out")
    assert missing in told
    alone = api.orient(project(tmp_path / "alone", None))
    assert [item.id for item in result.sessions] == ["run"]
    assert result.sessions[0].to_dict() == alone.sessions[0].to_dict()
    assert [line.to_dict() for line in result.lines] == [line.to_dict() for line in alone.lines]


@pytest.mark.parametrize("name", WRONG)
def test_wrong_readings_remain_an_error_however_few_they_are(tmp_path: Path, name: str) -> None:
    method, late, what = WRONG[name]
    outcome = run("orient", project(tmp_path / "p", late, method), "--json")
    assert outcome.code == 2
    assert outcome.json["schema"] == "surveyapp.error/1"
    assert what in outcome.out


def test_asked_for_by_name_it_is_an_error(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", book("reversal,359-00-00"))
    outcome = run("orient", folder, "--session", "late", "--json")
    assert outcome.code == 2
    (problem,) = outcome.json["problems"]
    assert "too few reversal rows" in problem["what"]
    assert "late" in problem["where"]
    assert run("orient", folder, "--session", "run").code == run("orient", folder).code
    assert run("diagnose", folder, "--session", "late").code == 2
    assert "--session late" not in run("diagnose", folder).out


def test_two_turning_points_asked_for_by_name_are_a_pre_orientation(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", book("reversal,359-00-00", "reversal,1-00-00"))
    result = api.orient(folder, session="late")
    assert result.sessions[0].estimator == "two turning points"


def test_every_command_gives_the_others(tmp_path: Path) -> None:
    late = book("reversal,359-00-00")
    folder = project(tmp_path / "p", late, more=TRAVERSE)
    (folder / "main.csv").write_text(LEG, encoding="utf-8")
    toml = (folder / "project.toml").read_text(encoding="utf-8")
    (folder / "project.toml").write_text(
        toml.replace("n = 3811452.311\n", "n = 3811452.311\nfixed = true\n"), encoding="utf-8"
    )
    checked = run("check", folder, "--json")
    assert checked.code in (0, 1)
    told = run("orient", folder, "--json").json["warnings"]
    assert "session_unfinished" in [item["code"] for item in told]
    assert checked.json["warnings"] == told
    assert "session_unfinished" in run("check", folder).out
    adjusted = run("adjust", folder, "--json")
    assert adjusted.code in (0, 1)
    assert "session_unfinished" in [item["code"] for item in adjusted.json["warnings"]]
    assert {point["name"] for point in adjusted.json["points"]} >= {"A", "F", "P"}
    assert run("report", folder, "-o", tmp_path / "r.pdf").code == 0
    assert "session late is left out" in " ".join(run("report", folder, "--text").out.split())
    table = tmp_path / "batch.csv"
    assert run("batch", folder, "-o", table).code in (0, 1)
    assert "failed" not in table.read_text(encoding="utf-8")
    assert run("export", "csv", folder, tmp_path / "lines.csv").code == 0


def test_traverses_are_adjusted_while_the_only_session_is_observed(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", None, more=TRAVERSE)
    (folder / "observations" / "run.csv").write_text(book("reversal,359-00-00"), encoding="utf-8")
    (folder / "main.csv").write_text(LEG, encoding="utf-8")
    toml = (folder / "project.toml").read_text(encoding="utf-8")
    (folder / "project.toml").write_text(
        toml.replace("n = 3811452.311\n", "n = 3811452.311\nfixed = true\n"), encoding="utf-8"
    )
    assert run("adjust", folder).code in (0, 1)
    assert run("check", folder).code in (0, 1)
    assert run("orient", folder).code == 2


def test_a_gyro_side_that_is_still_observed_is_left_out_of_the_adjustment(tmp_path: Path) -> None:
    late = SECOND.format(method="tracking").replace('target = "B"', 'target = "F"')
    folder = project(tmp_path / "p", None, more=TRAVERSE + late)
    (folder / "observations" / "late.csv").write_text(book("reversal,359-00-00"), encoding="utf-8")
    (folder / "main.csv").write_text(LEG + "gyro,A,,F,\n", encoding="utf-8")
    toml = (folder / "project.toml").read_text(encoding="utf-8")
    (folder / "project.toml").write_text(
        toml.replace("n = 3811452.311\n", "n = 3811452.311\nfixed = true\n"), encoding="utf-8"
    )
    adjusted = run("adjust", folder, "--json")
    assert adjusted.code in (0, 1)
    assert "gyro" not in [item["kind"] for item in adjusted.json["observations"]]
    assert "session_unfinished" in [item["code"] for item in adjusted.json["warnings"]]
    (folder / "main.csv").write_text(LEG + "gyro,F,,A,\n", encoding="utf-8")
    assert run("adjust", folder).code == 2  # a side that no session observes


def test_a_line_that_is_still_observed_is_told_to_be_so(tmp_path: Path) -> None:
    late = SECOND.format(method="tracking").replace('station = "A"', 'station = "B"')
    late = late.replace('target = "B"', 'target = "A"')
    folder = project(tmp_path / "p", None, more=late)
    (folder / "observations" / "late.csv").write_text(book("reversal,359-00-00"), encoding="utf-8")
    outcome = run("orient", folder, "--line", "B-A", "--json")
    assert outcome.code == 2
    assert "session late is left out" in outcome.json["problems"][0]["hint"]


def test_nothing_finished_is_an_error_that_names_them_all(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", book("reversal,359-00-00"))
    (folder / "observations" / "run.csv").write_text(book(), encoding="utf-8")
    outcome = run("orient", folder, "--json")
    assert outcome.code == 2
    assert len(outcome.json["problems"]) == 2


def test_a_signed_session_is_finished_by_its_signature(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", book("reversal,359-00-00"))
    assert api.orient(folder).sessions
    api.close(folder, session="late", by="Meier")
    with pytest.raises(SurveyError, match="too few reversal"):
        api.orient(folder)
    api.reopen(folder, session="late", reason="signed too early")
    assert api.orient(folder).sessions


@pytest.mark.parametrize("method", ["tracking", "amplitude", "transit"])
@pytest.mark.parametrize("missed", [(), (1,), (0, 2)])
def test_as_far_as_it_is_observed_it_is_either_computed_or_unfinished(
    tmp_path: Path, method: SwingMethod, missed: tuple[int, ...]
) -> None:
    """Every beginning of a book: what lacks nothing can be oriented, what lacks is refused."""
    spec = SessionSpec(method=method, points=7, times=True, missed=missed)
    rows = simulate_session(spec, np.random.default_rng(11)).rows
    folder = project(tmp_path / "p", "", method)
    path = folder / "observations" / "late.csv"
    seen = set()
    for count in range(len(rows) + 1):
        text = book_text(rows[:count]).replace(",L,,,,", ",L,,B,,")
        path.write_text(text, encoding="utf-8")
        opened = api.open_project(folder)
        text = lacking(opened.session("late"))
        seen.add(bool(text))
        assert [item.code for item in api.unfinished(opened)] == ["session_unfinished"] * bool(text)
        try:
            estimator = api.orient(opened, session="late").sessions[0].estimator
        except SurveyError:
            assert text
        else:
            assert not text or estimator == "two turning points"
    assert seen == {True, False}
