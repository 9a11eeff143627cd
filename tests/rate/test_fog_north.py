"""North by the gyro on a total station: sigma against theory and scatter against sigma."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.sensors.rate.fog_north import FogNorth, Position, solve_north
from surveyapp.core.simulate.rate.table_programmes import DEG_H
from surveyapp_models.angles import ARCSEC, wrap_pi
from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.rate.fog_station import FogOnTelescope
from tests.rate.fog_rows import fog_north_rows
from tests.rate.logs import PUBLISHED_CONSTANT


def positions(
    north: float, latitude: float, rng: np.random.Generator | None, *, count: int = 4
) -> list[Position]:
    fog = FogOnTelescope(
        constant=PUBLISHED_CONSTANT, bias=3.0 * DEG_H, noise=0.05 * DEG_H, collimation=1e-3
    )
    beta, east, west = PUBLISHED_CONSTANT, north + math.pi / 2, north - math.pi / 2
    readings = (
        (east, beta, False),
        (east, beta + math.pi, True),
        (west, beta, False),
        (west, beta + math.pi, True),
    )[:count]
    log = fog_north_rows(fog, north=north, latitude=latitude, readings=readings, rng=rng)
    c = log.columns
    return [
        Position(
            float(c["gyr_x_rad_s"][k]),
            math.radians(c["horizontal_circle_deg"][k]),
            math.radians(c["vertical_circle_deg"][k]),
            log.texts["face"][k] == "R",
        )
        for k in range(count)
    ]


def test_four_exact_positions_give_north_bias_collimation_and_elevation_exactly() -> None:
    north = math.radians(123.0)
    found = solve_north(
        positions(north, math.radians(35.0), None),
        latitude=math.radians(35.0),
        approximate_north=north + 0.3,
        rate_sigma=0.05 * DEG_H,
    )
    assert found.north == pytest.approx(north, abs=1e-9)
    assert found.bias == pytest.approx(3.0 * DEG_H, rel=1e-9)
    assert found.collimation == pytest.approx(1e-3, abs=1e-9)
    assert found.elevation == pytest.approx(0.0, abs=1e-9)
    assert found.undetermined == ()


@pytest.mark.parametrize(("latitude", "theory"), [(0, 343), (35, 419), (60, 686), (-35, 419)])
def test_scatter_of_north_is_sigma_over_twice_the_level_earth_rate(
    latitude: float, theory: float
) -> None:
    """rate.md section 2; 200 runs: bounds of chi-square at 1e-4 are 0.81 and 1.20."""
    rng = np.random.default_rng(17)
    phi = math.radians(latitude)
    off, found = [], None
    for _ in range(200):
        north = rng.uniform(0.0, 2.0 * math.pi)
        found = solve_north(
            positions(north, phi, rng),
            latitude=phi,
            approximate_north=north + 0.05,
            rate_sigma=0.05 * DEG_H,
        )
        assert found.north is not None
        off.append(wrap_pi(found.north - north))
    assert isinstance(found, FogNorth)
    assert found.sigma is not None
    assert found.sigma / ARCSEC == pytest.approx(theory, rel=2e-3)
    assert found.sigma == pytest.approx(0.05 * DEG_H / (2.0 * EARTH_RATE * math.cos(phi)), rel=2e-3)
    assert 0.81 < float(np.std(off)) / found.sigma < 1.20
    if latitude == 0:  # no vertical earth rate: the elevation leaves no trace, north needs none
        assert found.undetermined == ("elevation",)


@pytest.mark.parametrize(("latitude", "expected"), [(0, 495), (35, 584), (60, 998), (-35, 597)])
def test_two_positions_need_the_constant_and_its_error_enters_by_the_tangent(
    latitude: float, expected: float
) -> None:
    """rate.md section 2 gives the scatter of 300 runs: within 5 % of the sigma here."""
    phi = math.radians(latitude)
    two = positions(1.0, phi, None, count=2)
    with_constant = solve_north(
        two,
        latitude=phi,
        approximate_north=1.05,
        rate_sigma=0.05 * DEG_H,
        constant=PUBLISHED_CONSTANT,
        constant_sigma=5.0 * ARCSEC,
    )
    assert with_constant.north == pytest.approx(1.0, abs=1e-9)
    assert with_constant.sigma is not None
    assert with_constant.sigma / ARCSEC == pytest.approx(expected, rel=0.05)
    assert with_constant.undetermined == ("bias", "collimation")
    without = solve_north(two, latitude=phi, approximate_north=1.05, rate_sigma=0.05 * DEG_H)
    if latitude:
        assert "north" in without.undetermined
        assert without.north is None


def test_the_stated_sigma_of_the_constant_is_not_scaled_by_the_scatter_of_the_rows() -> None:
    """Twenty rows each way without a stated noise: the constant keeps its 5", north its theory."""
    phi, rng = math.radians(35.0), np.random.default_rng(4)
    rows = [p for _ in range(20) for p in positions(1.0, phi, rng, count=2)]
    found = solve_north(
        rows,
        latitude=phi,
        approximate_north=1.05,
        constant=PUBLISHED_CONSTANT,
        constant_sigma=5.0 * ARCSEC,
    )
    assert found.sigmas[2] == pytest.approx(5.0 * ARCSEC, rel=1e-6)
    level = EARTH_RATE * math.cos(phi)
    theory = math.hypot(0.05 * DEG_H / level / math.sqrt(40.0), 5.0 * ARCSEC * math.tan(phi))
    assert found.sigma == pytest.approx(theory, rel=0.35)  # 38 degrees of freedom: 11 % each sigma


def test_the_approximate_north_decides_between_the_two_roots() -> None:
    north = math.radians(200.0)
    four = positions(north, 0.6, None)
    for start in (-0.5, 0.5):
        found = solve_north(four, latitude=0.6, approximate_north=north + start, rate_sigma=1e-7)
        assert found.north == pytest.approx(north, abs=1e-9)
    other = solve_north(four, latitude=0.6, approximate_north=north + 3.0, rate_sigma=1e-7)
    assert other.north is not None
    assert abs(wrap_pi(other.north - north)) > 3.0


def written(path: Path, rows: list[Position]) -> None:
    """The rows as a log."""
    lines = ["time_s,gyr_x_rad_s,horizontal_circle_deg,vertical_circle_deg,face"] + [
        f"{60 * k},{p.rate!r},{math.degrees(p.alidade)!r},{math.degrees(p.vertical or 0.0)!r},"
        + ("R" if p.plunged else "L")
        for k, p in enumerate(rows)
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def test_a_north_far_from_the_stated_one_is_told(tmp_path: Path) -> None:
    """At 91 degrees off the other root is the nearer one: nothing else would tell it."""
    rows = positions(math.radians(123.0), math.radians(35.0), None)
    written(tmp_path / "n.csv", rows)

    def codes(stated: float) -> list[str]:
        options = {"latitude": 35.0, "approximate_north_deg": stated, "rate_sigma_deg_h": 0.05}
        found = api.north(tmp_path / "n.csv", method="fog-station", options=options)
        return [w.code for w in found.warnings]

    assert "approximate_north_far" in codes(214.0)
    assert "approximate_north_far" not in codes(120.0)


CARD = """id = "fog-ts"
title = "gyro on a total station"
source = "its own calibration"
kind = "automatic"
"""
PROJECT = """format = 1
name = "a gyro on a total station"
angle_unit = "deg"
[[instrument]]
id = "fog-ts"
card = "fog-ts.toml"
constant = {{ arcsec = 0.0, sigma_arcsec = 1.0 }}
[[station]]
name = "A"
[[station]]
name = "B"
[[orientation]]
id = "fog-1"
station = "A"
target = "B"
instrument = "fog-ts"
method = "automatic"
book = "fog-1.csv"
sigma_arcsec = {sigma}
"""


def test_the_north_found_is_a_session_of_an_automatic_gyro(tmp_path: Path) -> None:
    """Circle reading and sigma of `north` in a book: azimuth of the line by the circle's zero."""
    north = math.radians(123.0)
    written(tmp_path / "n.csv", positions(north, math.radians(35.0), np.random.default_rng(8)))
    options = {"latitude": 35.0, "approximate_north_deg": 120.0, "rate_sigma_deg_h": 0.05}
    found = api.north(tmp_path / "n.csv", method="fog-station", options=options).to_dict()
    reading, sigma = found["gyro_north"]["deg"], found["gyro_north"]["sigma_arcsec"]
    book = f"seq,kind,value\n1,backsight,200.0\n2,north,{reading!r}\n3,backsight,200.0\n"
    for name, text in (
        ("fog-ts.toml", CARD),
        ("project.toml", PROJECT.format(sigma=sigma)),
        ("fog-1.csv", book),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
    line = api.orient(tmp_path).to_dict()["lines"][0]["true_azimuth"]
    assert line["reference"] == "ASTRONOMIC"
    assert line["deg"] == pytest.approx(200.0 - reading, abs=1e-9)
    assert line["sigma_arcsec"] == pytest.approx(math.hypot(sigma, 1.0), rel=0.01)
    assert abs(line["deg"] - 77.0) * 3600.0 < 4.0 * sigma
