"""``check`` answers what rule books limit of breakthroughs and shafts."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.shafts.orientation import orient_shaft
from surveyapp.domain.shaft import ShaftRowKind
from surveyapp_models.angles import ARCSEC
from tests.penetration.mines import mine_folder, mine_toml
from tests.shafts.test_refused_shafts import BOOK, TABLE, folder
from tests.shafts.test_worked_shafts import one_shaft, row

K = ShaftRowKind
BOOK_TOP = 'rule_book = "cn-coal-15"'
HEIGHT = 'height = { method = "levelling", sigma_mm_per_sqrt_km = 15.0 }\n'
MISS = "[penetration.measured]\nlateral_m = -0.35\nvertical_m = 0.02\n"


def checks(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> tuple[int, dict[str, list[dict[str, Any]]]]:
    code = main(["check", str(path), "--json"])
    found: dict[str, list[dict[str, Any]]] = {}
    for item in json.loads(capsys.readouterr().out)["checks"]:
        found.setdefault(item["rule"].removeprefix("cn-coal-15."), []).append(item)
    return code, found


def mine(path: Path, **more: Any) -> Path:
    table = HEIGHT + more.pop("table", "") + "sigma_distance = { mm = 2.0, ppm = 2.0 }"
    return mine_folder(path, mine_toml(gyro=(0, 10, 19), top=BOOK_TOP, table=table, **more))


def test_predicted_errors_meet_the_class_of_the_tunnel(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Layout B of the model page: 2 x .1224 of .3 m; heights 2 x 15 mm sqrt(2 km) of .2 m."""
    code, found = checks(mine(tmp_path / "m"), capsys)
    assert code == 0
    (lateral,) = found["lateral-within-mine"]
    assert (lateral["pass"], lateral["limit"], lateral["confirmed"]) == (True, 0.3, True)
    assert lateral["value"] == pytest.approx(2 * 0.1224, abs=1e-4)
    (vertical,) = found["vertical-within-mine"]
    assert vertical["value"] == pytest.approx(2 * 0.015 * math.sqrt(2.0), rel=1e-12)
    assert "lateral-between-mines" not in found  # of another class


def test_a_measured_miss_fails_a_confirmed_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, found = checks(mine(tmp_path / "m", more=MISS), capsys)
    assert code == 1
    predicted, measured = found["lateral-within-mine"]
    assert (predicted["pass"], measured["pass"], measured["value"]) == (True, False, 0.35)
    assert [item["pass"] for item in found["vertical-within-mine"]] == [True, True]


def test_an_unconfirmed_limit_only_warns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A shaft between mines: .5 m from general knowledge, exceeded."""
    text = mine_toml(top=BOOK_TOP, table=HEIGHT, more=MISS.replace("-0.35", "0.75"))
    path = mine_folder(tmp_path / "m", text.replace('"within_mine"', '"shaft"'))
    code, found = checks(path, capsys)
    assert code == 0
    assert [item["pass"] for item in found["lateral-shaft"]] == [True, False]
    assert not found["lateral-shaft"][0]["confirmed"]


def test_the_projects_tolerance_and_factor_win_and_are_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = "factor = 1.5\ntolerance = { lateral_m = 0.15, source = 'contract' }\n"
    code, found = checks(mine(tmp_path / "m", table=table), capsys)
    assert code == 1
    (own,) = found["penetration.lateral"]
    assert (own["pass"], own["limit"], own["clause"]) == (False, 0.15, "contract")
    assert own["value"] == pytest.approx(1.5 * 0.1224, abs=1e-4)
    (ruled,) = found["lateral-within-mine"]
    assert (ruled["pass"], ruled["value"]) == (None, None)
    assert "penetration.lateral" in ruled["text"]
    (factor,) = found["penetration-factor"]
    assert (factor["value"], factor["limit"], factor["pass"]) == (1.5, 2.0, False)


def test_a_refused_prediction_leaves_the_limit_open_and_says_why(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = mine(tmp_path / "m", table="independent_surveys = 0\n")
    assert main(["predict", str(path)]) == 2
    capsys.readouterr()
    code, found = checks(path, capsys)
    assert code == 0
    (lateral,) = found["lateral-within-mine"]
    assert lateral["pass"] is None
    assert "independent_surveys" in lateral["text"]


DEPTHS = "depth,,,,,600.0123,m,,,1,\ndepth,,,,,600.0451,m,,,2,\n"


def test_a_shaft_answers_wires_and_height(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """f -.2178 mm of 2 and of 4; depths 32.8 of 75.0 mm: the worked shaft of the model page."""
    table = TABLE.replace("[[station]]", f"{BOOK_TOP}\n[[station]]", 1)
    code, found = checks(folder(tmp_path / "s", table, BOOK + DEPTHS), capsys)
    assert code == 0
    for place, limit in (("surface", 2.0), ("underground", 4.0)):
        (wires,) = found[f"wires-{place}"]
        assert wires["value"] == pytest.approx(0.2178, abs=1e-4)
        assert (wires["limit"], wires["pass"]) == (limit, True)
    (height,) = found["height-transfer"]
    assert height["value"] == pytest.approx(0.0328, abs=1e-9)
    assert height["limit"] == pytest.approx(0.0750036, abs=1e-6)
    apart = DEPTHS.replace("600.0451", "600.0951")
    code, found = checks(folder(tmp_path / "far", table, BOOK + apart), capsys)
    assert (code, found["height-transfer"][0]["pass"]) == (1, False)
    assert found["height-transfer"][0]["subject"]["kind"] == "shaft"


def test_the_austrian_book_limits_direction_point_and_depth(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Direction as in ``shaft``; two depths may differ by 5 mm + h / 8000; nothing is confirmed."""
    top = 'rule_book = "at-mvo-2013"\n[[station]]'
    path = folder(tmp_path / "s", TABLE.replace("[[station]]", top, 1), BOOK + DEPTHS)
    code, found = checks(path, capsys)
    assert code == 0
    (shaft,) = api.shaft(path).shafts
    (direction,) = found["at-mvo-2013.plumbed-direction"]
    assert direction["value"] == pytest.approx(shaft.azimuth.sigma / ARCSEC, rel=1e-12)
    (depth,) = found["at-mvo-2013.depth"]
    assert depth["value"] == pytest.approx(32.8, abs=1e-6)
    assert depth["limit"] == pytest.approx(5.0 + 600.0287 / 8.0, abs=1e-4)
    # F was oriented and never measured to: it has no place
    (point,) = found["at-mvo-2013.plumbed-point"]
    assert point["where"].endswith("E")


def test_two_plumbings_of_one_side_are_compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second angle below is 90 arc-seconds larger; the book allows 2 minutes."""
    entry = TABLE[TABLE.index("[[shaft]]") :]
    table = TABLE.replace("[[station]]", f"{BOOK_TOP}\n[[station]]", 1)
    table += entry.replace('"S"', '"S2"').replace("shaft.csv", "again.csv")
    path = folder(tmp_path / "s", table)
    (path / "again.csv").write_text(BOOK.replace("100.0,deg", "100.025,deg"), encoding="utf-8")
    _, found = checks(path, capsys)
    (twice,) = found["one-shaft-twice"]
    assert twice["value"] == pytest.approx(1.5, abs=1e-6)
    assert (twice["unit"], twice["pass"]) == ("arcmin", True)


def test_the_place_of_a_plumbed_point_by_hand() -> None:
    """Only the wires err: e^2 + 2 (e d / c)^2, d from the middle of the wires to E."""
    shaft = one_shaft(c=4.0, plumb=1.0)
    found, _ = orient_shaft(shaft, {"C": (0.0, 0.0), "D": (0.0, 1000.0)})
    (point,) = found.points
    far = shaft.rows[3].value
    d = math.sqrt((6.0**2 + far**2) / 2.0 - 4.0)  # the median of the triangle
    assert point.sigma_m == pytest.approx(0.001 * math.sqrt(1 + 2 * d**2 / 16.0), rel=1e-6)


def test_the_place_of_a_plumbed_point_by_simulation() -> None:
    """4000 plumbings with every reading disturbed, E worked out from each: 1.1 % standard error."""
    known = {"C": (0.0, 0.0), "D": (0.0, 1000.0)}
    exact = one_shaft(c=4.0, plumb=0.0)
    a, n = 0.3 * ARCSEC * 20, 4000
    shaft = replace(exact, sigma_plumb_m=0.0005, sigma_angle=a, sigma_mm=0.4)
    shaft = replace(shaft, rows=tuple(r for r in shaft.rows if {r.at, r.to} != {"A", "B"}))
    found, _ = orient_shaft(shaft, known)
    (point,) = found.points
    rng = np.random.default_rng(15)
    gamma, far = shaft.rows[1].value, shaft.rows[3].value

    def wires(first: float) -> tuple[Any, Any]:
        """A and B as complex n + i e from a station, its mark at azimuth 0, disturbed."""
        one = first + a * rng.standard_normal(n)
        two = one + gamma + a * rng.standard_normal(n)
        near = 6.0 + 0.0004 * rng.standard_normal(n)
        return near * np.exp(1j * one), (far + 0.0004 * rng.standard_normal(n)) * np.exp(1j * two)

    up, low = wires(math.radians(10.0)), wires(math.radians(10.0))
    plumb = 0.0005 * (rng.standard_normal((2, n)) + 1j * rng.standard_normal((2, n)))
    hung = (up[0] + plumb[0], up[1] + plumb[1])  # where the wires are below
    turn = (hung[1] - hung[0]) / (low[1] - low[0])
    place = (hung[0] + hung[1]) / 2.0 - turn / np.abs(turn) * (low[0] + low[1]) / 2.0
    spread = math.sqrt(float(np.mean(np.abs(place) ** 2)))
    assert point.sigma_m == pytest.approx(spread, rel=0.035)
    assert (point.e, point.n) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_an_unmeasured_side_has_no_place_and_a_measured_one_has() -> None:
    shaft = one_shaft(c=4.0, plumb=1.0)
    more = row(K.DISTANCE, "E", "F", 50.0, place="underground")
    found, _ = orient_shaft(
        replace(shaft, rows=(*shaft.rows, more)), {"C": (0.0, 0.0), "D": (0.0, 1000.0)}
    )
    assert [point.station for point in found.points] == ["E", "F"]
    assert found.points[1].sigma_m > found.points[0].sigma_m
