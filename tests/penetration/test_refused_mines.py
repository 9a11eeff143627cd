"""Every reason not to predict is told, all together, with exit 2 and no traceback."""

import json
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.errors import SurveyError
from tests.penetration.mines import mine_folder, mine_toml

TWO_MEETING = "meeting = { e = 0.0, n = 2000.0, h = 0.0 }"

# what of the text is replaced, by what, and words of the problem
REFUSED = [
    ('name = "P0"\ne = 0.0\nn = 0.0\nfixed = true', 'name = "P0"\ne = 0.0\nn = 0.0', "fixed point"),
    (
        '[[penetration.gyro]]\nat = "P0"\nto = "P1"\ninstrument = "G"\nsigma_arcsec = 15.0',
        "",
        "neither",
    ),
    ('route = ["P0", "P1"', 'route = ["P0", "PX"', "unknown station"),
    ('instrument = "G"', 'instrument = "H"', "no such instrument"),
    ('at = "P0"\nto = "P1"', 'at = "P0"\nto = "P2"', "no side of a route"),
    ("sigma_angle_arcsec = 7.0", "sigma_angle_arcsec = -7.0", "out of range"),
    ("sigma_angle_arcsec = 7.0", "sigma_angle_arcsec = inf", "no number"),
    ("sigma_angle_arcsec = 7.0", "sigma_angle_arcsec = nan", "no number"),
    (
        "sigma_angle_arcsec = 7.0",
        "factor = 0.0\nsigma_angle_arcsec = 7.0",
        "factor is out of range",
    ),
    (
        "sigma_angle_arcsec = 7.0",
        "tolerance = { lateral_m = 0.0 }\nsigma_angle_arcsec = 7.0",
        "lateral_m is out of range",
    ),
    ("axis_azimuth = 0.0", "axis_azimuth = 90.0", "across the last side"),
    ("axis_azimuth = 0.0", "axis_azimuth = 61.0", "across the last side"),
    ('name = "A"', 'name = "A"\nwall = ["right", "left"]', "another length than the route"),
    (TWO_MEETING, "meeting = { e = 5.0, n = 2000.0 }", "meeting point is not reached"),
    (TWO_MEETING, "meeting = { e = 0.0, n = 1900.0 }", "meeting point is not reached"),
    ("axis_azimuth = 0.0", "axis_azimuth = 0.0\nindependent_surveys = 0", "independent_surveys"),
    ('case = "one_end"', 'case = "opposite"', "needs 2"),
    ("sigma_angle_arcsec = 7.0", "", "no sigma"),
]


@pytest.mark.parametrize(("old", "new", "words"), REFUSED, ids=[r[2] + r[1][-24:] for r in REFUSED])
def test_a_mine_that_cannot_be_predicted_says_why(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    text = mine_toml()
    assert old in text
    folder = mine_folder(tmp_path / "m", text.replace(old, new))
    with pytest.raises(SurveyError) as caught:
        api.predict(folder)
    told = [problem.what for problem in caught.value.problems]
    assert any(words in what for what in told), told
    assert main(["predict", str(folder), "--json"]) == 2


def test_all_problems_come_together(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = mine_toml(table="sigma_distance = { mm = -1.0 }\nfactor = -2.0")
    for old, new in (
        ('instrument = "G"', 'instrument = "H"'),
        (TWO_MEETING, "meeting = { e = 500.0, n = 2000.0 }"),
        ('name = "A"', 'name = "A"\nwall = ["up"]'),
        ("n = 0.0\nfixed = true", "n = 0.0"),
    ):
        text = text.replace(old, new)
    folder = mine_folder(tmp_path / "m", text)
    assert main(["predict", str(folder), "--plan", "50", "--json"]) == 2
    answer = json.loads(capsys.readouterr().out)
    assert answer["schema"] == "surveyapp.error/1"
    told = " | ".join(problem["what"] for problem in answer["problems"])
    for words in (
        "mm is out of range",
        "factor is out of range",
        "no such instrument",
        "meeting point is not reached",
        "wall is not known",
        "another length",
        "fixed point",
        "more gyro sides are asked for",
    ):
        assert words in told, words


def test_an_axis_across_is_taken_where_it_is_meant(tmp_path: Path) -> None:
    text = mine_toml().replace("axis_azimuth = 0.0", "axis_azimuth = 90.0\naxis_across = true")
    across = api.predict(mine_folder(tmp_path / "a", text))
    along = api.predict(mine_folder(tmp_path / "b", mine_toml()))
    assert across.sigma.longitudinal_m == pytest.approx(along.sigma.lateral_m)


def test_a_last_side_is_carried_on_to_the_meeting_point(tmp_path: Path) -> None:
    """19 sides carried on by 100 m: the last azimuth turns 200 m."""
    text = mine_toml(sides=19).replace("n = 1900.0, h", "n = 2000.0, h")
    result = api.predict(mine_folder(tmp_path / "m", text))
    assert "carried_to_meeting" in {warning.code for warning in result.warnings}
    # as 20 sides without the angle at P19: 7" over 100 m
    whole = api.predict(mine_folder(tmp_path / "n", mine_toml()))
    assert whole.sigma.lateral_m is not None
    assert result.sigma.lateral_m is not None
    missing = 100.0 * 7.0 / 206264.806
    expected = (whole.sigma.lateral_m**2 - missing**2) ** 0.5
    assert result.sigma.lateral_m == pytest.approx(expected, rel=1e-9)


def test_a_project_without_a_breakthrough_is_refused(tmp_path: Path) -> None:
    folder = mine_folder(tmp_path / "m", 'format = 1\nname = "none"\n')
    with pytest.raises(SurveyError, match="no breakthrough"):
        api.predict(folder)
    assert main(["predict", str(folder)]) == 2
