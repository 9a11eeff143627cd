"""The worked shafts of the model page, to the printed digits, through book, network and command."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.shafts.orientation import orient_shaft
from surveyapp.core.shafts.plane import Sight, bearing, length, solve_plane
from surveyapp.core.shafts.swings import period_s, pooled_sigma, swing_rest
from surveyapp.core.swing.gyrofit import schuler_means
from surveyapp.domain.shaft import Shaft, ShaftRow, ShaftRowKind
from surveyapp_models.angles import ARCSEC, wrap_pi

K = ShaftRowKind
SWING = [62.10, 41.85, 61.40, 42.60, 60.75, 43.30, 60.05, 43.95, 59.45]
GAMMA = math.radians(38.0 / 60.0 + 24.5 / 3600.0)


def row(kind: ShaftRowKind, at: str, to: str, value: float, **more: Any) -> ShaftRow:
    place = more.pop("place", "surface")
    return ShaftRow(
        kind, place, at, more.pop("back", ""), to, value, more.pop("sigma", None), **more
    )


def test_the_connecting_triangle() -> None:
    """a 9.8432, b 5.6210, c 4.2228, gamma 0-38-24.5; 0.7 mm, 3"."""
    rows = [
        Sight(row(K.AZIMUTH, "C", "A", 0.0), 1e-9),
        Sight(row(K.ANGLE, "C", "B", GAMMA, back="A"), 3.0 * ARCSEC),
        Sight(row(K.DISTANCE, "C", "B", 9.8432), 0.0007),
        Sight(row(K.DISTANCE, "C", "A", 5.6210), 0.0007),
        Sight(row(K.DISTANCE, "A", "B", 4.2228), 0.0007),
    ]
    net = solve_plane(rows, {"C": (0.0, 0.0)}, ("C", "A"))
    assert length(net.places, "C", "A") == pytest.approx(5.6210726, abs=0.5e-7)
    assert length(net.places, "C", "B") == pytest.approx(9.8431274, abs=0.5e-7)
    assert length(net.places, "A", "B") == pytest.approx(4.2228726, abs=0.5e-7)
    gamma = bearing(net.places, "C", "B") - bearing(net.places, "C", "A")
    assert gamma / ARCSEC == pytest.approx(2304.49905, abs=0.5e-5)

    def turn(places: Any) -> float:
        return bearing(places, "A", "B") - bearing(places, "C", "A")

    assert turn(net.places) / ARCSEC == pytest.approx(5372.0707, abs=0.5e-4)  # 1-29-32.0707
    slopes = net.per_row(turn, "turn")
    assert math.sqrt(float(slopes @ slopes)) / ARCSEC == pytest.approx(7.022, abs=0.5e-3)
    near_straight = 9.8432 / 4.2228 * GAMMA / ARCSEC
    assert near_straight == pytest.approx(5371.709, abs=0.5e-3)


@pytest.mark.parametrize(("sigma_mm", "c", "printed"), [(0.3, 4.2228, 20.723), (1.0, 4.0, 72.926)])
def test_plumbing_turns_the_line_of_the_wires(sigma_mm: float, c: float, printed: float) -> None:
    shaft = one_shaft(c=c, plumb=sigma_mm)
    found, _ = orient_shaft(shaft, {"C": (0.0, 0.0), "D": (0.0, 1000.0)})
    (line,) = [item for item in found.budget if item.source == "plumbing"]
    assert line.sigma / ARCSEC == pytest.approx(printed, abs=0.5e-3)


def one_shaft(*, c: float, plumb: float, depth: float = 600.0) -> Shaft:
    """C, A, B nearly in one line, underground the same seen from E; the triangle closes."""
    rows = []
    gamma = math.radians(0.5)
    far = 6.0 * math.cos(gamma) + math.sqrt(c**2 - (6.0 * math.sin(gamma)) ** 2)
    for place, station, mark in (("surface", "C", "D"), ("underground", "E", "F")):
        rows += [
            row(K.ANGLE, station, "A", math.radians(10.0), back=mark, place=place),
            row(K.ANGLE, station, "B", gamma, back="A", place=place),
            row(K.DISTANCE, station, "A", 6.0, place=place),
            row(K.DISTANCE, station, "B", far, place=place),
            row(K.DISTANCE, "A", "B", c, place=place),
        ]
    return Shaft(
        id="S",
        kind="one",
        depth_m=depth,
        wires=("A", "B"),
        orient=("E", "F"),
        sigma_plumb_m=plumb / 1000.0,
        sigma_angle=1e-6 * ARCSEC,
        sigma_mm=1e-6,
        sigma_ppm=0.0,
        rows=tuple(rows),
    )


def test_convergence_of_the_wires() -> None:
    assert pytest.approx(0.3977, abs=0.5e-4) == 600.0 * 4.2228 / 6.371e6 * 1e3
    found, _ = orient_shaft(one_shaft(c=4.2228, plumb=0.3), {"C": (0, 0), "D": (0, 1000)})
    assert found.convergence_mm == pytest.approx(0.3977, abs=0.5e-4)
    wide = one_shaft(c=500.0, plumb=0.3, depth=1000.0)
    found, _ = orient_shaft(wide, {"C": (0, 0), "D": (0, 1000)})
    assert found.convergence_mm == pytest.approx(78.4806, abs=0.5e-4)


def test_a_swing_is_reduced_like_turning_points() -> None:
    rest = swing_rest(SWING)
    assert rest.rest == pytest.approx(51.8277, abs=0.5e-4)
    assert 0.2 * rest.weight_norm == pytest.approx(0.0671, abs=0.5e-4)
    pooled = pooled_sigma([rest])
    assert pooled is not None
    assert pooled * rest.weight_norm == pytest.approx(0.0101, abs=0.5e-4)
    import numpy as np

    means, _ = schuler_means(np.array(SWING), np.arange(9.0))
    assert float(means.mean()) == pytest.approx(51.8339, abs=0.5e-4)
    assert sum(SWING) / 9.0 == pytest.approx(52.8278, abs=0.5e-4)
    assert period_s(600.0) == pytest.approx(49.14, abs=0.005)
    assert period_s(1000.0) == pytest.approx(63.44, abs=0.005)


def two_shafts(folder: Path) -> Path:
    folder.mkdir()
    (folder / "project.toml").write_text(
        """format = 1
name = "two shafts"
angle_unit = "deg"
[[station]]
name = "A"
e = 5000.0
n = 8000.0
fixed = true
[[station]]
name = "B"
e = 5305.1230
n = 8265.3965
fixed = true
[[shaft]]
id = "S"
kind = "two"
depth_m = 600.0
wires = ["A", "B"]
book = "shaft.csv"
orient = { at = "1", to = "2" }
sigma_plumb_mm = 0.7
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 0.0 }
""",
        encoding="utf-8",
    )
    (folder / "shaft.csv").write_text(
        """kind,place,at,from,to,value,unit,sigma,sigma_unit,set,note
distance,underground,A,,1,110.2345,m,,,,
distance,underground,1,,2,142.8765,m,,,,
distance,underground,2,,B,151.6543,m,,,,
angle,underground,1,A,2,176.512345,deg,,,,
angle,underground,2,1,B,186.023456,deg,,,,
depth,,,,,600.0123,m,,,1,
depth,,,,,600.0451,m,,,2,
""",
        encoding="utf-8",
    )
    return folder


def test_two_shafts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = two_shafts(tmp_path / "p")
    assert main(["shaft", str(folder), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["schema"] == "surveyapp.shaft/1"
    (shaft,) = answer["shafts"]
    middle = 45.0 + 46.0 / 60.0 + 34.960 / 3600.0
    assert shaft["azimuth"]["deg"] * 3600.0 == pytest.approx(middle * 3600.0, abs=0.5e-3)
    assert shaft["azimuth"]["sigma_arcsec"] == pytest.approx(3.283, abs=0.5e-3)
    assert shaft["scale"]["misclosure_mm"] == pytest.approx(-0.08, abs=0.005)
    assert shaft["scale"]["limit_mm"] == pytest.approx(7.22, abs=0.005)
    assert shaft["scale"]["pass"] is True
    assert shaft["convergence_mm"] == pytest.approx((404.39504 - 404.35695) * 1e3, abs=0.02)
    depth = shaft["depth"]
    assert depth["m"] == pytest.approx(600.0287, abs=1e-9)
    assert depth["difference_mm"] == pytest.approx(32.8, abs=1e-6)
    assert depth["limit_mm"] == pytest.approx(75.0, abs=0.01)
    assert depth["sigma_m"] * 1e3 == pytest.approx(26.52, abs=0.005)
    assert depth["pass"] is True
    assert shaft["gyro"] is None
    assert shaft["combined"]["deg"] == shaft["azimuth"]["deg"]


@pytest.mark.parametrize(
    ("at", "to", "azimuth"),
    [("A", "1", (49, 15, 50.518)), ("1", "2", (45, 46, 34.960)), ("2", "B", (51, 47, 59.402))],
)
def test_azimuths_of_the_sides_between_two_shafts(
    tmp_path: Path, at: str, to: str, azimuth: tuple[int, int, float]
) -> None:
    folder = two_shafts(tmp_path / "p")
    text = (folder / "project.toml").read_text()
    (folder / "project.toml").write_text(
        text.replace('at = "1", to = "2"', f'at = "{at}", to = "{to}"')
    )
    (shaft,) = api.shaft(folder).shafts
    degrees, minutes, seconds = azimuth
    printed = math.radians(degrees + minutes / 60.0 + seconds / 3600.0)
    assert shaft.azimuth.value == pytest.approx(printed, abs=0.6e-3 * ARCSEC)


def gyro_folder(tmp_path: Path, azimuth: float, sigma: float) -> Path:
    """One side that wires orient at 123.4567 +- 22", and a gyro."""
    folder = two_shafts(tmp_path / "p")
    with (folder / "shaft.csv").open("a") as book:
        book.write(f"azimuth,underground,1,,2,{azimuth!r},deg,{sigma},arcsec,,\n")
    return folder


def test_wires_and_gyro_are_joined_by_their_own_variances() -> None:
    """123.4567000 +- 22" and 123.4613000 +- 8": 123.4607628 +- 7.5183"."""
    import numpy as np

    from surveyapp.core.shafts.joint import joined

    first = math.radians(123.4567)
    relative = np.array([0.0, math.radians(123.4613 - 123.4567)])
    gyro, together = joined(first, relative, np.diag([(22 * ARCSEC) ** 2, (8 * ARCSEC) ** 2]))
    assert together.azimuth is not None
    assert math.degrees(together.azimuth.value) == pytest.approx(123.4607628, abs=0.5e-7)
    assert together.azimuth.sigma / ARCSEC == pytest.approx(7.5183, abs=0.5e-4)
    assert together.chi2 is not None
    assert math.sqrt(together.chi2) == pytest.approx(0.7074, abs=0.5e-4)
    assert (together.dof, together.consistent) == (1, True)
    assert gyro is not None
    assert wrap_pi(gyro.value - first) / ARCSEC == pytest.approx(16.56, abs=0.005)


def test_what_contradicts_is_never_averaged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = gyro_folder(tmp_path, 45.7814, 5.0)  # 17" off, sigma 6"
    assert main(["shaft", str(folder), "--json"]) == 1
    (shaft,) = json.loads(capsys.readouterr().out)["shafts"]
    assert shaft["combined"]["consistent"] is False
    assert shaft["combined"]["deg"] is None
    assert shaft["combined"]["chi2"] > 6.635


def test_a_gyro_on_the_side_enters_with_its_own_sigma(tmp_path: Path) -> None:
    (shaft,) = api.shaft(gyro_folder(tmp_path, 45.7770, 3.283)).shafts
    assert shaft.combined.azimuth is not None
    assert shaft.combined.azimuth.sigma / ARCSEC == pytest.approx(3.283 / math.sqrt(2.0), abs=1e-3)
    middle = 0.5 * (shaft.azimuth.value + math.radians(45.7770))
    assert shaft.combined.azimuth.value == pytest.approx(middle, abs=1e-3 * ARCSEC)
