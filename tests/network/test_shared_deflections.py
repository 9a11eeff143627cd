"""Gyro sides of neighbouring stations share their deflection, in the adjustment as well."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from surveyapp import api
from surveyapp_models.angles import ARCSEC, AngleUnit, format_angle

LATITUDE = math.radians(62.0)
SIDE_M = 300.0
COUNT = 4
"""Sides, straight to the north, each oriented by itself."""
ROUND = 3.0
DEFLECTION = 8.0
LENGTH_M = 5000.0
AWAY_M = 6000.0
"""From the calibration line to the first station."""
NORTH_M = 6_876_000.0
TOML = """
format = 1
name = "sides"
crs = "+proj=tmerc +lat_0=0 +lon_0=20 +k=1 +x_0=500000 +y_0=0 +ellps=GRS80 +units=m +type=crs"
deflection = {{ sigma_arcsec = {sigma}, correlation_km = {length} }}
centring_mm = {{ instrument = 0.0, target = 0.0 }}
[[instrument]]
id = "G"
card = "gyromat-3000"
[[traverse]]
name = "T"
book = "observations/T.csv"
sigma_distance = {{ mm = 0.1, ppm = 0.0 }}
centring_mm = {{ instrument = 0.0, target = 0.0 }}
"""
SESSION = """
[[orientation]]
id = "{id}"
station = "{start}"
target = "{end}"
instrument = "G"
method = "automatic"
purpose = "{purpose}"
sigma_arcsec = {sigma}
book = "observations/{id}.csv"
"""


def places() -> dict[str, float]:
    """Northings of all stations, on the central meridian."""
    found = {"K1": NORTH_M - AWAY_M, "K2": NORTH_M - AWAY_M + SIDE_M}
    return found | {f"P{i}": NORTH_M + i * SIDE_M for i in range(COUNT + 1)}


def deflections(rng: np.random.Generator) -> dict[str, float]:
    """Eta [arcsec] of the occupied stations, from the dense field."""
    names = ["K1", *(f"P{i}" for i in range(COUNT))]
    north = np.array([places()[name] for name in names])
    covariance = DEFLECTION**2 * np.exp(-np.abs(north[:, None] - north[None, :]) / LENGTH_M)
    return dict(zip(names, rng.multivariate_normal(np.zeros(len(names)), covariance), strict=True))


def write(folder: Path, rng: np.random.Generator | None) -> None:
    """Lines to the north: the gyro reads 0 + eta tan(latitude) + noise; None: no errors."""
    toml = TOML.format(sigma=DEFLECTION, length=LENGTH_M / 1000.0)
    for name, north in places().items():
        fixed = "fixed = true\n" if name in ("K1", "K2", "P0") else ""
        toml += f'[[station]]\nname = "{name}"\ne = 500000.0\nn = {north}\n{fixed}'
    eta = dict.fromkeys(places(), 0.0) if rng is None else deflections(rng)
    lines = [("K1", "K2", "calibration")]
    lines += [(f"P{i}", f"P{i + 1}", "survey") for i in range(COUNT)]
    (folder / "observations").mkdir(parents=True)
    rows = ["kind,at,to,value"]
    for start, end, purpose in lines:
        toml += SESSION.format(id=f"s{start}", start=start, end=end, purpose=purpose, sigma=ROUND)
        if purpose == "calibration":
            toml += 'azimuth_known = "0-00-00"\nazimuth_known_sigma_arcsec = 0.0\n'
        noise = 0.0 if rng is None else float(rng.normal(scale=ROUND))
        value = (eta[start] * math.tan(LATITUDE) + noise + 7.0) * ARCSEC
        text = format_angle(value % (2.0 * math.pi), AngleUnit.DMS, 3)
        book = folder / f"observations/s{start}.csv"
        book.write_text(f"seq,kind,value\n1,azimuth,{text}\n", encoding="utf-8")
        if purpose == "survey":
            rows += [f"gyro,{start},{end},", f"distance,{start},{end},{SIDE_M}"]
    (folder / "observations/T.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "project.toml").write_text(toml, encoding="utf-8")


def expected_sigma_m() -> float:
    """Lateral sigma of the last point by hand: 1' C 1 of its sides, times the length of a side."""
    names = ["K1", *(f"P{i}" for i in range(COUNT))]
    north = np.array([places()[name] for name in names])
    field = np.exp(-np.abs(north[:, None] - north[None, :]) / LENGTH_M)
    field *= (DEFLECTION * math.tan(LATITUDE)) ** 2
    gain = np.array([COUNT, *([-1.0] * COUNT)])  # every side: + eta of K1, - its own eta
    rounds = ROUND**2 * (COUNT + COUNT**2)  # its own rounds, and those of the one constant
    return SIDE_M * math.sqrt(float(gain @ field @ gain) + rounds) * ARCSEC


def test_last_point_has_the_sigma_of_the_whole_covariance(tmp_path: Path) -> None:
    write(tmp_path / "p", None)
    point = api.adjust(tmp_path / "p").point(f"P{COUNT}")
    assert point.sigma_e == pytest.approx(expected_sigma_m(), rel=2e-3)


@pytest.mark.statistical
def test_the_last_point_lies_where_its_sigma_says(tmp_path: Path) -> None:
    rng, runs = np.random.default_rng(41), 60
    squares = 0.0
    for run in range(runs):
        write(tmp_path / str(run), rng)
        point = api.adjust(tmp_path / str(run)).point(f"P{COUNT}")
        assert point.e is not None
        assert point.sigma_e is not None
        squares += ((point.e - 500000.0) / point.sigma_e) ** 2
    assert chi2.ppf(0.0005, runs) < squares < chi2.ppf(0.9995, runs)


def test_a_side_that_two_rows_name_counts_once(tmp_path: Path) -> None:
    write(tmp_path / "p", None)
    book = tmp_path / "p/observations/T.csv"
    once = api.adjust(tmp_path / "p")
    book.write_text(book.read_text(encoding="utf-8") + "gyro,P0,P1,\n", encoding="utf-8")
    twice = api.adjust(tmp_path / "p")
    assert twice.dof == once.dof
    before, after = once.point("P1").sigma_e, twice.point("P1").sigma_e
    assert before is not None
    assert after == pytest.approx(before, rel=1e-9)
