"""Clipped, dead, exchanged and foreign readings, from logs that no simulator of the program made.

Every attitude here is a product of plain rotation matrices; x to the mark, y left, z up.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.sensors.clipping import ends_of_range
from surveyapp.core.sensors.compensation import force_sigma
from surveyapp.diagnosis.sensors.field_size import possible_iron
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats

MAG = tuple(f"mag_{a}_uT" for a in "xyz")
ACC = tuple(f"acc_{a}_m_s2" for a in "xyz")
Log = dict[str, Floats]
G = 9.80665
FIELD = 50.0 * np.array([math.cos(math.radians(65.0)), 0.0, -math.sin(math.radians(65.0))])
HARD = np.array([12.0, -7.0, 20.0])
SOFT = np.array([[1.05, 0.02, -0.01], [0.02, 0.97, 0.03], [-0.01, 0.03, 0.99]])

Iron = tuple[Floats, Floats]
SMALL: Iron = (np.array([3.0, -2.0, 1.0]), np.diag([1.02, 0.98, 1.0]))
"""Iron of a carrier that is swung: its deviation is a few degrees."""


def about(axis: int, angle: Floats) -> Floats:
    """Rotation matrices about an axis, shape (n, 3, 3)."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found = np.zeros((angle.size, 3, 3))
    found[:, axis, axis] = 1.0
    found[:, i, i] = found[:, j, j] = np.cos(angle)
    found[:, j, i], found[:, i, j] = np.sin(angle), -np.sin(angle)
    return found


def sensed(
    attitude: Floats, seed: int, *, force_sigma: float = 0.02, iron: Iron = (HARD, SOFT)
) -> Log:
    """What a compass of these attitudes (body to north, west, up) records."""
    rng = np.random.default_rng(seed)
    n = len(attitude)
    mag = (
        np.einsum("nji,j->ni", attitude, FIELD) @ iron[1].T + iron[0] + rng.normal(0.0, 0.3, (n, 3))
    )
    acc = attitude[:, 2, :] * G + rng.normal(0.0, force_sigma, (n, 3))
    log = {"time_s": np.arange(n) / 20.0}
    return log | dict(zip((*MAG, *ACC), (*mag.T, *acc.T), strict=True))


def tumbled(n: int = 1600) -> Floats:
    """Attitudes over the whole sphere."""
    t = np.arange(n) / 20.0
    return (
        about(2, 0.46 * t) @ about(1, 0.5 * np.pi * np.sin(0.2 * t)) @ about(0, 0.1337 * t)
    )  # fmt: skip


def swung(spread: float = 0.05) -> tuple[Floats, Floats]:
    """Known headings [deg] in steps of ten, and attitudes with a small tilt."""
    rng = np.random.default_rng(8)
    heading = np.repeat(np.arange(0.0, 360.0, 10.0), 15)
    pitch, roll = rng.normal(0.0, spread, (2, heading.size))
    return heading, about(2, -np.radians(heading)) @ about(1, pitch) @ about(0, roll)


def written(path: Path, log: Log) -> Path:
    rows = np.column_stack(list(log.values()))
    np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(log), comments="")
    return path


def read(path: Path, name: str) -> Floats:
    """A column; an empty cell is NaN."""
    head, *rows = path.read_text().splitlines()
    place = head.split(",").index(name)
    return np.array([float(row.split(",")[place] or "nan") for row in rows])


@pytest.fixture(scope="module")
def sphere(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Log]:
    """A good record with its card beside it."""
    folder = tmp_path_factory.mktemp("sphere")
    log = sensed(tumbled(), 4)
    api.calibrate("compass", written(folder / "good.csv", log), card=folder / "card.toml")
    return folder, log


def codes(result: object) -> list[str]:
    return [item.code for item in result.warnings]  # type: ignore[attr-defined]


def test_rows_at_the_end_of_the_range_are_left_out(
    sphere: tuple[Path, Log], tmp_path: Path
) -> None:
    _, log = sphere
    end = float(np.quantile(log[MAG[0]], 0.9))
    clipped = written(tmp_path / "c.csv", {**log, MAG[0]: np.minimum(log[MAG[0]], end)})
    assert list(ends_of_range(np.minimum(log[MAG[0]], end))) == [end]
    result = api.calibrate("compass", clipped)
    assert {"clipped", "clipped_left_out"} <= set(codes(result))
    assert result.n == log["time_s"].size - int(np.sum(log[MAG[0]] >= end))
    for name, value in zip("xyz", HARD, strict=True):
        item = result.parameter(f"hard_iron_{name}")
        assert item.value is not None
        assert item.sigma is not None
        assert abs(item.value - value) < 4.0 * item.sigma
    assert ends_of_range(np.full(30, 2.0)) == {}
    first = log["time_s"] < 40.0
    ends = {MAG[0]: np.where(first, 90.0, log[MAG[0]]), MAG[1]: np.where(first, log[MAG[1]], 90.0)}
    still = written(tmp_path / "s.csv", {k: (log | ends)[k] for k in ("time_s", *MAG)})
    with pytest.raises(SurveyError, match="every row stands at an end"):
        api.calibrate("compass", still)


def test_a_sensor_slower_than_its_logger_is_not_at_the_end_of_its_range() -> None:
    """Each reading stands in five rows, so the largest one does (measured: vqf_imu)."""
    values = np.random.default_rng(4).normal(0.0, 10.0, 400)
    held = np.repeat(values, 5)
    assert ends_of_range(held) == {}
    end = float(np.sort(values)[-12])
    assert ends_of_range(np.minimum(held, end)) == {end: 60}


def test_a_force_of_something_else_does_not_tell_the_dip(
    sphere: tuple[Path, Log], tmp_path: Path
) -> None:
    _, log = sphere
    result = api.calibrate(
        "compass", written(tmp_path / "c.csv", {**log, ACC[0]: np.full(log["time_s"].size, 1.5)})
    )
    assert {"acc_does_not_fit", "dip_assumed"} <= set(codes(result))
    assert result.extra["dip_deg"] == pytest.approx(65.0)


def test_exchanged_and_dead_axes_are_refused_when_a_card_is_applied(
    sphere: tuple[Path, Log], tmp_path: Path
) -> None:
    folder, log = sphere
    out = tmp_path / "o.csv"
    turned = {**log, MAG[0]: log[MAG[1]], MAG[1]: log[MAG[0]]}
    with pytest.raises(SurveyError, match="exchanged"):
        api.compensate(
            "compass", written(tmp_path / "t.csv", turned), card=folder / "card.toml", out=out
        )
    dead = {**log, MAG[2]: np.full(log["time_s"].size, 3.0)}
    with pytest.raises(SurveyError, match="mag_z_uT is constant"):
        api.compensate(
            "compass", written(tmp_path / "d.csv", dead), card=folder / "card.toml", out=out
        )
    assert not out.exists()


def test_the_sigma_of_a_heading_holds_the_noise_of_the_force(
    sphere: tuple[Path, Log], tmp_path: Path
) -> None:
    folder, _ = sphere
    heading, attitude = swung(0.1)
    log = sensed(attitude, 6, force_sigma=0.15)
    out = tmp_path / "o.csv"
    api.compensate("compass", written(tmp_path / "l.csv", log), card=folder / "card.toml", out=out)
    north = attitude[:, :2, 0]
    true = np.degrees(np.arctan2(-north[:, 1], north[:, 0]))
    error = (read(out, "heading_deg") - true + 180.0) % 360.0 - 180.0
    share = error / read(out, "heading_sigma_deg")
    assert np.std(share) == pytest.approx(1.0, abs=0.12)  # 540 rows: 4 sigma of a deviation
    assert np.std(error) > 1.8  # .88 degrees per hundredth of g, .8 by the field
    level = np.column_stack([log[name] for name in ACC])
    assert force_sigma(level) == pytest.approx(0.15 / G, rel=0.15)
    assert force_sigma(level[:5]) == 0.0
    assert heading.size == 540


def test_a_swing_card_tells_what_one_heading_is_worth(tmp_path: Path) -> None:
    heading, attitude = swung()
    log = sensed(attitude, 7, iron=SMALL)
    log |= {"heading_deg": heading}
    path, card, out = written(tmp_path / "s.csv", log), tmp_path / "s.toml", tmp_path / "o.csv"
    api.calibrate("compass", path, card=card)
    made = api.compensate("compass", path, card=card, out=out)
    error = (read(out, "heading_deg") - heading + 180.0) % 360.0 - 180.0
    share = error / read(out, "heading_sigma_deg")
    assert np.std(share) == pytest.approx(1.0, abs=0.12)
    assert made.heading_sigma_deg == pytest.approx(float(read(out, "heading_sigma_deg").max()))


def test_headings_of_several_turns_are_taken_modulo_a_turn(tmp_path: Path) -> None:
    heading, attitude = swung()
    log = sensed(attitude, 7, iron=SMALL)
    plain = api.calibrate("compass", written(tmp_path / "a.csv", log | {"heading_deg": heading}))
    twice = np.where(np.arange(heading.size) % 2 == 0, heading, heading + 720.0)
    result = api.calibrate("compass", written(tmp_path / "b.csv", log | {"heading_deg": twice}))
    for letter in "ABCDE":
        name = f"deviation_{letter}"
        assert result.value(name) == pytest.approx(plain.value(name), abs=1e-7)
    assert "heading_beyond_a_turn" in codes(result)
    assert "heading_beyond_a_turn" not in codes(plain)
    radians = written(tmp_path / "r.csv", log | {"heading_deg": np.radians(heading)})
    refused = api.calibrate("compass", radians)
    assert not refused.met
    assert "heading_in_radians" in codes(refused)


def tilts(seed: int) -> dict[str, np.ndarray]:
    """Sixty readings of a good two-axis sensor, one arcsecond of noise."""
    rng = np.random.default_rng(seed)
    along, across = rng.uniform(-600.0, 600.0, (2, 60))
    return {
        "tilt_along_arcsec": along + rng.normal(0, 1, 60),
        "tilt_across_arcsec": across + rng.normal(0, 1, 60),
        "ref_along_arcsec": along,
        "ref_across_arcsec": across,
    }


def test_temperatures_in_kelvin_are_refused(tmp_path: Path) -> None:
    log = tilts(2) | {"temperature_c": np.linspace(283.0, 303.0, 60)}
    with pytest.raises(SurveyError, match="cannot be in degrees Celsius"):
        api.calibrate("tilt", written(tmp_path / "k.csv", log))
    log["temperature_c"] = log["temperature_c"] - 273.15
    card, out = tmp_path / "t.toml", tmp_path / "o.csv"
    api.calibrate("tilt", written(tmp_path / "c.csv", log), card=card)
    minutes = {
        **log,
        "tilt_along_arcsec": 60.0 * log["ref_along_arcsec"],
        "tilt_across_arcsec": np.full(60, 5.0),
    }
    made = api.compensate("tilt", written(tmp_path / "m.csv", minutes), card=card, out=out)
    assert {"beyond_range", "never_changes"} <= set(codes(made))


def test_a_card_without_a_range_says_that_no_range_is_judged(tmp_path: Path) -> None:
    source = written(tmp_path / "t.csv", tilts(4))
    card, old, out = tmp_path / "t.toml", tmp_path / "old.toml", tmp_path / "o.csv"
    api.calibrate("tilt", source, card=card)
    lines = card.read_text(encoding="utf-8").splitlines(keepends=True)
    kept = [line for line in lines if "largest_reading_arcsec" not in line]
    assert len(kept) == len(lines) - 1
    old.write_text("".join(kept), encoding="utf-8")
    assert "range_unknown" not in codes(api.compensate("tilt", source, card=card, out=out))
    known = out.read_text(encoding="utf-8")
    assert "range_unknown" in codes(api.compensate("tilt", source, card=old, out=out))
    assert out.read_text(encoding="utf-8") == known


def test_headings_beyond_the_tilts_of_a_restricted_card_are_empty(tmp_path: Path) -> None:
    heading, attitude = swung(0.2)
    log = sensed(attitude, 11, force_sigma=0.001, iron=SMALL)
    card, out = tmp_path / "r.toml", tmp_path / "o.csv"
    result = api.calibrate(
        "compass", written(tmp_path / "level.csv", log), card=card,
        options={"heading_limit_deg": 5.0},
    )  # fmt: skip
    assert result.geometry.verdict == "restricted"
    steep = about(2, -np.radians(heading)) @ about(1, np.full(heading.size, 1.2))
    mixed = np.concatenate([attitude[:100], steep])
    later = sensed(mixed, 12, force_sigma=0.001, iron=SMALL)
    made = api.compensate("compass", written(tmp_path / "l.csv", later), card=card, out=out)
    empty = np.isnan(read(out, "heading_deg"))
    assert int(empty.sum()) == heading.size
    assert not empty[:100].any()
    assert {"beyond_tilt", "restricted"} <= set(codes(made))


def test_a_swing_shows_no_iron_that_makes_a_constant_of_any_reading(tmp_path: Path) -> None:
    """Near level S = diag(1/2, 1/2, -1) with a hard iron along z does, at a sigma of 2 uT."""
    assert not possible_iron(np.array([0.4886, 0.4877, 0.0001, 0.0044, -0.0072]))
    assert possible_iron(np.array([0.06, -0.03, 0.02, 0.01, -0.02]))
    _, attitude = swung()
    path = written(tmp_path / "s.csv", sensed(attitude, 7, iron=SMALL))
    document = api.diagnose_log(path).to_dict()
    assert document["verdict"] == "not_separable"
    assert {"soft_iron", "hard_iron"} <= set(document["ambiguous"][0]["any_of"])
    assert document["adopted"] == []
