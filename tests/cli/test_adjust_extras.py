"""The compass rule and the variance components beside the adjustment."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.cli.command import run

PROJECT = """format = 1
name = "Square"
angle_unit = "dms"

[[station]]
name = "A"
e = 0.0
n = 0.0
fixed = true

[[station]]
name = "B"
e = 0.0
n = 100.0
fixed = true

[[station]]
name = "D"
e = 100.0
n = 0.0
fixed = true

[[station]]
name = "C"

[[traverse]]
name = "main"
book = "main.csv"
sigma_angle_arcsec = 10.0
sigma_distance = { mm = 3.0, ppm = 0.0 }
"""
BOOK = """kind,at,from,to,value
angle,B,A,C,270-00-20
angle,C,B,D,270-00-00
distance,B,,C,100.010
distance,C,,D,100.000
"""


def test_compass_rule_shares_the_gap_by_length(tmp_path: Path) -> None:
    (tmp_path / "project.toml").write_text(PROJECT)
    (tmp_path / "main.csv").write_text(BOOK)
    answer = run("adjust", tmp_path, "--compass-rule", "--components", "--json")
    document = json.loads(answer.out)
    assert document["schema"] == "surveyapp.adjust/1"
    (route,) = document["compass_rule"]
    assert route["length_m"] == pytest.approx(200.01)
    ends = {point["name"]: (point["e"], point["n"]) for point in route["points"]}
    assert ends["D"] == pytest.approx((100.0, 0.0)) or ends["B"] == pytest.approx((0.0, 100.0))
    # Bowditch by hand: C at half the way takes half of the linear gap
    gap = (route["misclosure_e_m"], route["misclosure_n_m"])
    assert abs(gap[0]) + abs(gap[1]) > 0.005
    groups = {item["group"]: item for item in document["variance_components"]}
    assert set(groups) == {"angle", "distance"}
    redundancy = sum(item["redundancy"] for item in groups.values())
    assert redundancy == pytest.approx(document["dof"], abs=1e-6)
    shown = run("adjust", tmp_path, "--compass-rule", "--components")
    assert "Compass rule" in shown.out
    assert "Variance components" in shown.out


def test_check_compares_two_measurements_and_the_sides_with_their_class(tmp_path: Path) -> None:
    toml = PROJECT.replace('angle_unit = "dms"', 'angle_unit = "dms"\nrule_book = "cn-coal-15"')
    toml = toml.replace('book = "main.csv"', 'book = "main.csv"\nclass = "15sec"')
    again = toml[toml.index("[[traverse]]") :].replace('"main"', '"again"')
    (tmp_path / "project.toml").write_text(toml + "\n" + again.replace("main.csv", "again.csv"))
    (tmp_path / "main.csv").write_text(BOOK)
    second = BOOK.replace("270-00-00", "270-05-00").replace("100.000\n", "30.000\n")
    (tmp_path / "again.csv").write_text(second)
    checks = json.loads(run("check", tmp_path, "--json").out)["checks"]
    by_rule: dict[str, list[dict[str, Any]]] = {}
    for check in checks:
        by_rule.setdefault(str(check["rule"]), []).append(check)
    (repeated,) = by_rule["cn-coal-15.repeated-angles-15"]
    # 30" sqrt(2) for the angle measured twice; it differs by 5'
    assert repeated["value"] == pytest.approx(300.0)
    assert repeated["limit"] == pytest.approx(30.0 * 2**0.5)
    assert repeated["pass"] is False
    shortest = sorted(item["value"] for item in by_rule["cn-coal-15.shortest-side-15"])
    assert shortest == pytest.approx([30.0, 100.0])
    assert {item["pass"] for item in by_rule["cn-coal-15.shortest-side-15"]} == {True, False}
