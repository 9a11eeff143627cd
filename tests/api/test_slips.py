"""Slips of the hand that no statistic sees: coordinates, units and directions of the known line."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.geodesy import open_grid
from tests.api.projects import azimuths, session, station, write

GYRO = '[[instrument]]\nid = "G1"\ncard = "card.toml"\n'
CARD = """
id = "auto"
title = "Automatic gyro"
kind = "automatic"
source = "invented for a test"
[sigma]
azimuth_arcsec = 4.0
"""
PLACES = {"K": (0.0, 0.0), "L": (300.0, 400.0), "A": (500.0, 0.0), "B": (800.0, 400.0)}
BEARING = math.degrees(math.atan2(300.0, 400.0))
"""Of both lines in the grid."""
Change = Callable[[float, float], tuple[float, float]]


def project(
    folder: Path,
    *,
    crs: str,
    at: tuple[float, float],
    typed: Change = lambda e, n: (e, n),
    known: str = "",
    constant: float = 0.0,
    gyro: str = "",
) -> Path:
    """One calibration and one survey, read without error; coordinates as they were typed.

    ``at`` is the true place of K (latitude, longitude) [deg], ``constant`` that of the gyro [deg].
    """
    grid = open_grid(crs)
    latitude, longitude = (math.radians(value) for value in at)
    e, n = grid.projected(latitude=latitude, longitude=longitude)
    true = BEARING + math.degrees(grid.convergence(latitude=latitude, longitude=longitude))
    toml = GYRO + gyro
    for name, (east, north) in PLACES.items():
        typed_e, typed_n = typed(e + east, n + north)
        toml += station(name, e=typed_e, n=typed_n)
    toml += session("c", "K", "L", more=('purpose = "calibration"', *filter(None, [known])))
    toml += session("u", "A", "B", more=('purpose = "survey"',))
    book = azimuths(f"{(true - constant) % 360.0:.8f}")
    head = f'crs = "{crs}"\nangle_unit = "deg"'
    return write(folder, toml, {"c": book, "u": book}, card=CARD, head=head)


def failed(folder: Path) -> set[str]:
    """Confirmed checks that are not met."""
    return {check.rule for check in api.check(folder) if check.confirmed and check.passed is False}


FEET: Change = lambda e, n: (e / 0.3048, n / 0.3048)  # noqa: E731
PL92, SWISS, KROVAK = "EPSG:2180", "EPSG:21781", "EPSG:5514"
WHERE = {PL92: (50.3, 18.8), SWISS: (46.8, 8.2), KROVAK: (49.8, 18.2), "EPSG:2154": (45.0, 5.0)}


@pytest.mark.parametrize("crs", list(WHERE))
def test_a_clean_project_is_met(tmp_path: Path, crs: str) -> None:
    assert not failed(project(tmp_path, crs=crs, at=WHERE[crs]))


@pytest.mark.parametrize(
    ("crs", "typed"),
    [
        (KROVAK, FEET),
        (SWISS, FEET),
        ("EPSG:2154", FEET),
        (KROVAK, lambda e, n: (n, e)),
        (SWISS, lambda e, n: (n, e)),
        ("EPSG:2154", lambda e, n: (e, n - 1e6)),  # nine degrees of latitude
        (PL92, lambda e, n: (e, -n)),
    ],
)
def test_coordinates_far_outside_of_the_area_of_the_grid_are_told(
    tmp_path: Path, crs: str, typed: Change
) -> None:
    assert "grid.area" in failed(project(tmp_path, crs=crs, at=WHERE[crs], typed=typed))


def test_a_grid_is_carried_on_across_a_border(tmp_path: Path) -> None:
    near = project(tmp_path, crs=PL92, at=(46.7, 18.8))
    checks = {check.rule: check for check in api.check(near)}
    assert checks["grid.area"].passed is True
    area = open_grid(PL92).area_deg
    assert area is not None
    assert checks["grid.area"].value == pytest.approx(area[1] - 46.7, abs=0.01)


@pytest.mark.parametrize(
    ("slip", "words"),
    [
        ({"typed": lambda e, n: (n, e)}, "east and north"),  # Silesia lands in Masovia
        ({"known": f"azimuth_known = {BEARING / 0.9:.6f}"}, "in gon"),
        ({"known": f"azimuth_known = {BEARING * 0.9:.6f}"}, "in degrees, not in gon"),
        ({"known": f"azimuth_known = {BEARING + 180.0:.6f}"}, "station and target"),
    ],
)
def test_a_large_constant_that_one_slip_explains_is_no_constant(
    tmp_path: Path, slip: dict[str, object], words: str
) -> None:
    folder = project(tmp_path, crs=PL92, at=WHERE[PL92], **slip)  # type: ignore[arg-type]
    (check,) = (check for check in api.check(folder) if check.rule == "constant.slip")
    assert check.confirmed
    assert check.passed is False
    assert words in str(check.text)


def test_a_large_constant_that_nothing_explains_only_warns(tmp_path: Path) -> None:
    folder = project(tmp_path, crs=PL92, at=WHERE[PL92], constant=7.3)
    assert not failed(folder)
    assert "constant_large" in {warning.code for warning in api.orient(folder).warnings}


def test_a_constant_that_is_known_to_be_large_is_one(tmp_path: Path) -> None:
    known = f"azimuth_known = {BEARING:.6f}"
    gyro = "constant = { arcsec = -648000.0, sigma_arcsec = 5.0 }\n"
    at = WHERE[PL92]
    folder = project(tmp_path / "a", crs=PL92, at=at, known=known, constant=180.0)
    assert "constant.slip" in failed(folder)
    folder = project(tmp_path / "b", crs=PL92, at=at, known=known, constant=180.0, gyro=gyro)
    assert "constant.slip" not in failed(folder)


def test_a_line_that_nobody_can_sight_is_told(tmp_path: Path) -> None:
    folder = project(tmp_path, crs=PL92, at=WHERE[PL92])
    text = (folder / "project.toml").read_text()
    n = text.split('name = "B"\n')[1].split("n = ")[1].split("\n")[0]
    (folder / "project.toml").write_text(text.replace(f"n = {n}", f"n = {float(n) + 1e5}"))
    assert "coordinates.length" in failed(folder)
