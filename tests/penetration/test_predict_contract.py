"""``predict``: keys of the JSON, exit codes, tolerance and factor, and where each comes from."""

import json
from pathlib import Path
from typing import Any

import pytest

from surveyapp.cli.main import main
from tests.penetration.mines import mine_folder, mine_toml

HEIGHT = 'height = { method = "levelling", sigma_mm_per_sqrt_km = 15.0 }\n'
KEYS = {
    "schema",
    "lateral_m",
    "longitudinal_m",
    "vertical_m",
    "factor",
    "tolerance",
    "pass",
    "routes",
    "budget",
    "plan",
    "least_programme",
    "measures",
    "measured",
    "steps",
    "warnings",
}


def predict(
    folder: Path, capsys: pytest.CaptureFixture[str], *more: str
) -> tuple[int, dict[str, Any]]:
    code = main(["predict", str(folder), "--json", *more])
    return code, json.loads(capsys.readouterr().out)


def codes(answer: dict[str, Any]) -> set[str]:
    return {warning["code"] for warning in answer["warnings"]}


def test_keys_and_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = mine_toml(
        gyro=(0, 10, 19),
        top='rule_book = "cn-coal-15"',
        table=HEIGHT + "sigma_distance = { mm = 2.0, ppm = 2.0 }",
    )
    code, answer = predict(mine_folder(tmp_path / "m", text), capsys)
    assert code == 0
    assert set(answer) >= KEYS
    assert answer["schema"] == "surveyapp.predict/1"
    assert answer["lateral_m"] == pytest.approx(0.1224, abs=0.5e-4)
    assert answer["vertical_m"] == pytest.approx(0.015 * 2.0**0.5, rel=1e-12)
    assert answer["longitudinal_m"] == pytest.approx(0.002 * 20.0**0.5, rel=0.01)
    assert answer["factor"] == 2.0
    assert answer["tolerance"] == {
        "lateral_m": 0.3,
        "longitudinal_m": None,
        "vertical_m": 0.2,
        "source": answer["tolerance"]["source"],
        "confirmed": True,
    }
    assert answer["pass"] is True
    assert answer["routes"]["sectioned"]["valid"] is True
    assert [step["id"] for step in answer["steps"]] == [1, 2, 3, 4, 5, 6]
    for axis in ("lateral_m", "longitudinal_m", "vertical_m"):
        squares = sum(row[axis] ** 2 for row in answer["budget"])
        assert squares == pytest.approx(answer[axis] ** 2, rel=1e-12)
        assert answer["routes"]["covariance"][axis] == answer[axis]


def test_a_confirmed_tolerance_that_is_not_met_is_exit_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = mine_toml(table=HEIGHT + 'tolerance = { lateral_m = 0.4, source = "contract" }')
    code, answer = predict(mine_folder(tmp_path / "m", text), capsys)
    assert (code, answer["pass"]) == (1, False)
    assert answer["tolerance"]["confirmed"] is True
    assert {"factor_assumed", "sigma_distance_unknown"} <= codes(answer)


def test_an_unconfirmed_rule_book_only_warns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = mine_toml(top='rule_book = "gb-50026-tunnel"', table=HEIGHT)
    code, answer = predict(mine_folder(tmp_path / "m", text), capsys)
    assert (code, answer["pass"]) == (0, False)
    assert answer["tolerance"]["lateral_m"] == pytest.approx(0.1)
    assert "tolerance_unconfirmed" in codes(answer)


def test_the_project_wins_over_the_rule_book_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = mine_toml(
        top='rule_book = "gotthard"',
        table=HEIGHT + 'tolerance = { lateral_m = 0.7, source = "order 12" }',
    )
    _, answer = predict(mine_folder(tmp_path / "m", text), capsys)
    assert answer["factor"] == 2.5
    assert answer["tolerance"]["lateral_m"] == 0.7
    assert answer["tolerance"]["vertical_m"] == 0.125
    assert "tolerance_contradiction" in codes(answer)
    text = text.replace("sigma_angle_arcsec", "factor = 3.0\nsigma_angle_arcsec")
    _, answer = predict(mine_folder(tmp_path / "n", text), capsys)
    assert answer["factor"] == 3.0


def test_without_heights_the_vertical_error_is_not_determined(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, answer = predict(mine_folder(tmp_path / "m", mine_toml()), capsys)
    assert answer["vertical_m"] is None
    assert answer["tolerance"] is None
    assert answer["pass"] is None
    assert {"height_unknown", "no_tolerance"} <= codes(answer)


def test_a_number_for_the_axis_is_decimal_degrees(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = mine_toml().replace("axis_azimuth = 0.0", "axis_azimuth = 12.5")
    _, by_number = predict(mine_folder(tmp_path / "m", text), capsys)
    text = text.replace("axis_azimuth = 12.5", 'axis_azimuth = "12-30-00"')
    _, by_text = predict(mine_folder(tmp_path / "n", text), capsys)
    assert by_number["lateral_m"] == pytest.approx(by_text["lateral_m"], rel=1e-12)


def test_a_trigonometric_height_and_a_shaft(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    height = (
        'height = { method = "trig", sigma_zenith_arcsec = 10.0, sigma_hi_mm = 1.0, '
        "sigma_ht_mm = 2.0, reciprocal = true }"
    )
    text = mine_toml(table=height, heading="height_transfer_m = 600.0")
    _, answer = predict(mine_folder(tmp_path / "m", text), capsys)
    rows = {row["source"]: row["vertical_m"] for row in answer["budget"]}
    assert rows["height_transfer"] == pytest.approx(600.0 / (2.0 * 2.0**0.5 * 8000.0))
    zenith = 20 * 0.5 * (100.0 * 10.0 / 206264.806) ** 2
    assert rows["heights_trigonometric"] ** 2 == pytest.approx(zenith + 20 * 5e-6, rel=1e-6)
    # an independent second survey halves all of it
    twice = mine_folder(
        tmp_path / "n", text.replace("axis_azimuth", "independent_surveys = 2\naxis_azimuth")
    )
    _, second = predict(twice, capsys)
    assert second["vertical_m"] == pytest.approx(answer["vertical_m"] / 2.0**0.5)


def test_steps_are_recorded_by_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = mine_folder(tmp_path / "m", mine_toml())
    (folder / "check.pdf").write_text("drawing", encoding="utf-8")
    _, before = predict(folder, capsys)
    assert not any(step["done"] for step in before["steps"])
    predict(folder, capsys, "--done", "2", "--by", "office", "--note", "0.47 m")
    for reading in ("4.5", "-2"):
        more = ("--centre-line", reading, "--waist-line", "1.0", "--file", "check.pdf")
        _, answer = predict(folder, capsys, "--done", "5", "--by", "shift A", *more)
    steps = [step for step in answer["steps"] if step["done"]]
    assert [step["id"] for step in steps] == [2, 5, 5]
    assert [step["centre_line_mm"] for step in steps] == [None, 4.5, -2.0]
    assert steps[1]["file"] == "check.pdf"
    assert answer["lateral_m"] == before["lateral_m"]
    text = (folder / "project.toml").read_text(encoding="utf-8")
    for wrong in (
        ("--done", "7", "--by", "x"),
        ("--done", "1"),
        ("--done", "2", "--by", "x", "--waist-line", "1"),
        ("--done", "5", "--by", "x", "--file", "none.pdf"),
    ):
        assert main(["predict", str(folder), *wrong]) == 2
    assert (folder / "project.toml").read_text(encoding="utf-8") == text
