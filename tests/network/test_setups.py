"""Rounds of one set-up share its centring and its heights: against the full covariance by hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp_models.angles import ARCSEC
from tests.formats.importing import project

STATIONS = """
[[station]]
name = "A"
e = 0.0
n = 0.0
h = 0.0
fixed = true
[[station]]
name = "B"
e = 0.0
n = 100.0
h = 0.0
fixed = true
[[station]]
name = "C"
[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 4.0
sigma_distance = { mm = 1.0, ppm = 0.0 }
centring_mm = { instrument = 1.0, target = 2.0 }
sigma_height_mm = { instrument = 1.5, target = 0.5 }
"""


def book(rounds: int, setup: str = "1/") -> str:
    lines = ["kind,at,from,to,value,unit,set,hi,ht"]
    for k in range(rounds):
        turn = 15.0 * k
        name = f"{setup}{k + 1}"
        lines += [
            f"direction,A,,B,{turn},deg,{name},1.5,1.4",
            f"direction,A,,C,{turn + 90.0},deg,{name},1.5,1.4",
            f"slope_distance,A,,C,50.0,m,{name},1.5,1.4",
            f"zenith,A,,C,90.0,deg,{name},1.5,1.4",
        ]
    return "\n".join(lines) + "\n"


def sigmas(folder: Path, text: str) -> tuple[float, float, float]:
    project(folder, STATIONS)
    (folder / "observations").mkdir()
    (folder / "observations" / "main.csv").write_text(text, encoding="utf-8")
    point = api.adjust(folder).point("C")
    return point.sigma_e or 0.0, point.sigma_n or 0.0, point.sigma_h or 0.0


@pytest.mark.parametrize("rounds", [1, 4, 16])
def test_rounds_make_the_reading_smaller_and_never_the_centring(
    tmp_path: Path, rounds: int
) -> None:
    e, n, h = sigmas(tmp_path / "p", book(rounds))
    # C lies 50 m east: its east is the distance, its north the angle B-A-C over 50 m
    centring_e = math.hypot(1.0, 2.0) * 1e-3
    # instrument and target shift the angle: towards C by dn / 50, towards B by de / 100
    shared = np.array([1e-3 / 50, 1e-3 / 100, 2e-3 / 50, 2e-3 / 100])
    angle = math.sqrt((4.0 * ARCSEC) ** 2 / rounds + float(shared @ shared))
    assert e == pytest.approx(math.sqrt(1e-6 / rounds + centring_e**2), rel=1e-3)
    assert n == pytest.approx(50.0 * angle, rel=1e-3)
    heights = math.hypot(1.5e-3, 0.5e-3)
    assert h == pytest.approx(math.hypot(50 * 4 * ARCSEC / math.sqrt(rounds), heights), rel=1e-3)


@pytest.mark.parametrize("rounds", [1, 4, 16])
def test_rounds_of_an_angle_share_the_centring_too(tmp_path: Path, rounds: int) -> None:
    lines = ["kind,at,from,to,value,unit,set"]
    lines += [f"angle,A,B,C,90.0,deg,1/{k + 1}" for k in range(rounds)]
    lines += ["distance,A,,C,50.0,m,"]
    _, n, _ = sigmas(tmp_path / "p", "\n".join(lines) + "\n")
    shared = np.array([1e-3 / 50, 1e-3 / 100, 2e-3 / 50, 2e-3 / 100])
    reading = (4.0 * ARCSEC) ** 2  # sigma_angle is that of the angle itself
    expected = 50.0 * math.sqrt(reading / rounds + float(shared @ shared))
    assert n == pytest.approx(expected, rel=1e-3)


def test_two_angles_of_a_set_up_share_what_centring_does_to_both(tmp_path: Path) -> None:
    """Full covariance by hand: rows d angle / d (instrument e n, B e n, C e n, D e n)."""
    network = api.network(_folder(tmp_path, "angle,A,B,C,90.0,deg,1/1\nangle,A,C,D,90.0,deg,1/1\n"))
    (block,) = network.blocks
    # B 100 m north, C 50 m east, D 80 m south of A: an azimuth changes by (cos de - sin dn) / s
    b, c, d = (np.array([1 / 100, 0.0]), np.array([0.0, -1 / 50]), np.array([-1 / 80, 0.0]))
    zero = np.zeros(2)
    rows = np.array(
        [
            np.concatenate([-(c - b), -b, c, zero]),
            np.concatenate([-(d - c), zero, -c, d]),
        ]
    )
    sigma = np.array([1.0, 1.0, *[2.0] * 6]) * 1e-3
    expected = (rows * sigma) @ (rows * sigma).T
    assert np.array(block.covariance)[0, 1] == pytest.approx(expected[0, 1], rel=1e-3)
    own = np.diag(expected) + (4.0 * ARCSEC) ** 2
    assert np.diag(np.array(block.covariance)) == pytest.approx(own, rel=1e-3)


def _folder(tmp_path: Path, angles: str) -> Path:
    folder = tmp_path / "two"
    project(folder, STATIONS + '[[station]]\nname = "D"\n')
    (folder / "observations").mkdir()
    text = "kind,at,from,to,value,unit,set\n" + angles
    text += "distance,A,,C,50.0,m,\ndistance,A,,D,80.0,m,\n"
    (folder / "observations" / "main.csv").write_text(text, encoding="utf-8")
    return folder


def test_sets_without_a_set_up_stay_independent(tmp_path: Path) -> None:
    e, _, _ = sigmas(tmp_path / "p", book(4, setup=""))
    assert e == pytest.approx(math.sqrt((1e-6 + 5e-6) / 4), rel=1e-3)


def test_two_set_ups_share_nothing(tmp_path: Path) -> None:
    second = book(1, setup="2/").split("\n", 1)[1]
    e, _, _ = sigmas(tmp_path / "p", book(1, setup="1/") + second)
    assert e == pytest.approx(math.sqrt((1e-6 + 5e-6) / 2), rel=1e-3)


def test_a_name_is_the_same_composed_and_decomposed(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", STATIONS.replace('name = "C"', 'name = "O\u03081"'))
    (folder / "observations").mkdir()
    text = book(1).replace(",C,", ",\u00d61,")
    (folder / "observations" / "main.csv").write_text(text, encoding="utf-8")
    assert api.adjust(folder).point("O\u03081").sigma_e is not None


def test_heights_that_disagree_within_a_sight_are_told(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", STATIONS)
    (folder / "observations").mkdir()
    path = folder / "observations" / "main.csv"
    path.write_text(book(1), encoding="utf-8")
    assert "heights_disagree" not in {item.code for item in api.adjust(folder).warnings}
    path.write_text(book(1).replace("deg,1/1,1.5,1.4\n", "deg,1/1,,\n"), encoding="utf-8")
    told = next(x for x in api.adjust(folder).warnings if x.code == "heights_disagree")
    assert "A-C" in told.text
