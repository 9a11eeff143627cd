"""Level rows in a session: against exact rotations, and that nothing is applied twice."""

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.swing.levelling import Tilt, sight_correction
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

PROJECT = """format = 1
name = "levels"
[[instrument]]
id = "G"
card = "wild-gak1"
constant = {{ arcsec = 0.0, sigma_arcsec = 5.0 }}
[[station]]
name = "A"
lat = 47.0
lon = 9.0
[[station]]
name = "B"
[[orientation]]
id = "s"
station = "A"
target = "B"
instrument = "G"
method = "tracking"
purpose = "survey"
book = "s.csv"
{more}
"""


def exact_reading(azimuth: float, elevation: float, tilt: tuple[float, float]) -> float:
    """Circle reading of a sight by an instrument whose standing axis is tilted, exactly [rad].

    ``tilt``: along (the side of the zero direction low) and across (its right side low).
    """
    along, across = tilt
    # x towards the zero direction, y to its right, z up; the axis leans to where it is low
    axis = np.array([math.tan(along), math.tan(across), 1.0])
    axis /= np.linalg.norm(axis)
    zero = np.array([1.0, 0.0, 0.0]) - axis[0] * axis
    zero /= np.linalg.norm(zero)
    right = -np.cross(axis, zero)
    level = math.cos(elevation)
    sight = np.array([level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)])
    # right-handed axes have y to the left of x when z points up: mirror once, for both
    return math.atan2(float(sight @ -right), float(sight @ zero))


def corrected_error(azimuth: float, elevation: float, tilt: tuple[float, float]) -> Floats:
    """Raw and corrected differences of a sight against the level zero direction [arcsec]."""
    raw = exact_reading(azimuth, elevation, tilt) - exact_reading(0.0, 0.0, tilt)
    cotangent = math.tan(elevation)
    model = Tilt(tilt[0], tilt[1], 0.0, 1)
    added = sight_correction(model, direction=azimuth, cotangent=cotangent)
    wrapped = (np.array([raw, raw + added]) - azimuth + math.pi) % (2.0 * math.pi) - math.pi
    return np.asarray(wrapped / ARCSEC)


def test_the_printed_cases() -> None:
    across = Tilt(0.0, 30.0 * ARCSEC, 0.0, 1)
    for elevation, value in ((20.0, 10.919), (-20.0, -10.919)):
        cotangent = math.tan(math.radians(elevation))
        found = sight_correction(across, direction=0.0, cotangent=cotangent) / ARCSEC
        assert found == pytest.approx(value, abs=5e-4)


def test_fifty_set_ups_agree_with_exact_rotations() -> None:
    rng = np.random.default_rng(16)
    for _ in range(50):
        azimuth = float(rng.uniform(0.0, 2.0 * math.pi))
        elevation = math.radians(float(rng.uniform(-30.0, 30.0)))
        tilt = (float(rng.uniform(-60, 60)) * ARCSEC, float(rng.uniform(-60, 60)) * ARCSEC)
        raw, corrected = corrected_error(azimuth, elevation, tilt)
        assert abs(corrected) < 0.05  # second order: 60" squared, tan 30 degrees
        assert abs(raw) <= 85.0 * math.tan(abs(elevation)) + 0.05


def project(folder: Path, levels: list[str], zeniths: bool = True, more: str = "") -> Path:
    rows = ["seq,time,elapsed_s,kind,value,unit,face,target"]
    lines = []
    for face, value in (("L", "30-00-00"), ("R", "210-00-00")):
        lines.append(f"backsight,{value},dms,{face},B")
        if zeniths:
            lines.append(f"zenith,{'70-00-00' if face == 'L' else '290-00-00'},dms,{face},B")
    lines += levels
    swing = [100.0 + (1 if k % 2 else -1) * 2.0 * 0.995**k for k in range(8)]
    lines += [f"reversal,{v:.6f},deg,,{''}" for v in swing]
    for face, value in (("R", "210-00-00"), ("L", "30-00-00")):
        lines.append(f"backsight,{value},dms,{face},B")
    rows += [
        f"{k},,,{line.split(',')[0]},{','.join(line.split(',')[1:])}"
        for k, line in enumerate(lines, 1)
    ]
    folder.mkdir(exist_ok=True)
    (folder / "project.toml").write_text(PROJECT.format(more=more))
    (folder / "s.csv").write_text("\n".join(rows) + "\n")
    return folder


def test_level_rows_move_the_line_and_are_shown(tmp_path: Path) -> None:
    bare = api.orient(project(tmp_path / "a", [])).to_dict()
    levels = ["level_along,12,arcsec,,", "level_across,30,arcsec,,"]
    found = api.orient(project(tmp_path / "b", levels)).to_dict()
    assert bare["sessions"][0]["levelling_correction_arcsec"] is None
    added = found["sessions"][0]["levelling_correction_arcsec"]
    assert added == pytest.approx(10.919, abs=5e-4)
    moved = found["sessions"][0]["line_reading"]["deg"] - bare["sessions"][0]["line_reading"]["deg"]
    assert moved * 3600.0 == pytest.approx(added, abs=1e-6)
    assert found["lines"][0]["levelling_correction_arcsec"] == pytest.approx(added)
    azimuth = [d["lines"][0]["true_azimuth"]["deg"] for d in (bare, found)]
    assert (azimuth[1] - azimuth[0]) * 3600.0 == pytest.approx(added, abs=1e-6)
    assert "levelling" in [row["source"] for row in found["lines"][0]["budget"]]


def test_a_level_sight_is_not_moved(tmp_path: Path) -> None:
    levels = ["level_along,12,arcsec,,", "level_across,30,arcsec,,"]
    found = api.orient(project(tmp_path / "a", levels, zeniths=False)).to_dict()
    assert found["sessions"][0]["levelling_correction_arcsec"] == 0.0


def test_a_tilt_beyond_the_instruments_limit_is_told(tmp_path: Path) -> None:
    levels = ["level_along,12,arcsec,,", "level_across,30,arcsec,,"]
    folder = project(tmp_path / "a", levels)
    text = (folder / "project.toml").read_text()
    card = 'card = "wild-gak1"\nrange = { level_arcsec = 20.0 }'
    (folder / "project.toml").write_text(text.replace('card = "wild-gak1"', card))
    check = next(c for c in api.check(folder) if c.rule == "levelling.tilt")
    assert check.value == pytest.approx(30.0)
    assert check.limit == 20.0
    assert check.passed is False


def tape_zero_project(folder: Path, during_zero: list[str], during_run: list[str]) -> float:
    """Correction of the tape zero [arcsec] with level rows in both blocks."""
    zero = [f"tape_zero,{v},div,," for v in (-3.0, 5.0, -2.96, 4.96, -2.92)]
    levels = [*zero[:2], *during_zero, *zero[2:], "backsight,30-00-00,dms,L,B", *during_run]
    made = project(folder, levels)
    text = (made / "project.toml").read_text()
    card = (
        'card = "wild-gak1"\ntape_zero = { div_per_arcsec_tilt = 0.01, limit_div = 0.5, '
        "correction_arcsec_per_div = -120.0, latitude_deg = 47.0 }"
    )
    (made / "project.toml").write_text(text.replace('card = "wild-gak1"', card))
    return float(api.orient(made).to_dict()["sessions"][0]["tape_zero_correction_arcsec"])


def test_a_zero_observed_under_the_same_tilt_contains_it_already(tmp_path: Path) -> None:
    def levels(along: float, across: float) -> list[str]:
        return [f"level_along,{along},arcsec,,", f"level_across,{across},arcsec,,"]

    plain = tape_zero_project(tmp_path / "a", [], [])
    same = tape_zero_project(tmp_path / "b", levels(12, 30), levels(12, 30))
    assert same == pytest.approx(plain, abs=1e-9)
    moved = tape_zero_project(tmp_path / "c", levels(0, 0), levels(12, 30))
    # north at 100 degrees of the circle, the target at 30: d = 70 degrees clockwise from it
    d = math.radians(70.0)
    change = 30.0 * math.cos(d) - 12.0 * math.sin(d)
    assert moved - plain == pytest.approx(-120.0 * 0.01 * change, abs=0.02)
