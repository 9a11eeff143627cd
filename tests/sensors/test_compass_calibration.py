"""The ellipsoid, its gate, and the swing: against a simulated truth that is written out here."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.sensors.compass_calibration import calibrate_ellipsoid
from surveyapp.core.sensors.ellipsoid import _linearised, distances, fit_ellipsoid
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.deviation import deviation_basis, undeviated
from surveyapp_models.compass.heading import dip_of, heading_of, level_field, tilted

HARD = np.array([12.0, -5.0, 8.0])
SOFT = np.array([[1.05, 0.02, -0.01], [0.02, 0.97, 0.015], [-0.01, 0.015, 0.0]])
SOFT[2, 2] = (1.0 - np.linalg.det(SOFT)) / (SOFT[0, 0] * SOFT[1, 1] - SOFT[0, 1] ** 2)


def directions(shape: str, rng: np.random.Generator, n: int = 400) -> Floats:
    """Unit field vectors in the body: all around, in a cap, or near level."""
    psi = rng.uniform(0.0, 2.0 * np.pi, n)
    if shape in ("sphere", "cap"):
        z = rng.uniform(-1.0 if shape == "sphere" else 0.66, 1.0, n)
        level = np.sqrt(1.0 - z**2)
        return np.column_stack([level * np.cos(psi), level * np.sin(psi), z])
    span = math.radians(float(shape))
    field = level_field(psi, size=1.0, dip=math.radians(65.0))
    return tilted(field, pitch=rng.uniform(-span, span, n), roll=rng.uniform(-span, span, n))


def log_of(points: Floats, **columns: Floats) -> SensorLog:
    mag = {f"mag_{axis}_uT": points[:, i] for i, axis in enumerate("xyz")}
    return SensorLog("c", {**mag, **columns}, {}, len(points), rate_hz=20.0)


def record(shape: str, seed: int, sigma: float = 0.3) -> SensorLog:
    rng = np.random.default_rng([seed, 16])
    field = 50.0 * directions(shape, rng)
    return log_of(field @ np.linalg.inv(SOFT) + HARD + rng.normal(0.0, sigma, field.shape))


def worst_heading(result: Calibration) -> float:
    """Largest error of a level heading that is corrected by what the card would hold [deg]."""
    used = {k.removeprefix("used_"): v for k, v in result.constants.items()}
    xx, yy, zz, xy, xz, yz = (used[f"soft_iron_{p}"] for p in ("xx", "yy", "zz", "xy", "xz", "yz"))
    w = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    b = np.array([used[f"hard_iron_{axis}"] for axis in "xyz"])
    psi = np.radians(np.arange(0.0, 360.0, 10.0))
    field = level_field(psi, size=50.0, dip=math.radians(65.0))
    read = field @ np.linalg.inv(SOFT) + HARD
    error = heading_of((read - b) @ w) - psi
    return float(np.max(np.abs(np.degrees((error + np.pi) % (2.0 * np.pi) - np.pi))))


def test_derivatives_of_the_distance() -> None:
    rng = np.random.default_rng(1)
    points = 50.0 * directions("sphere", rng, 20) + HARD + rng.normal(0, 2.0, (20, 3))
    theta = np.array([11.0, -4.0, 7.0, 0.021, 0.019, 0.0205, 0.0004, -0.0003, 0.0002])
    _, jacobian = _linearised(points, theta)
    for k in range(9):
        step = 1e-6 if k < 3 else 1e-9
        up, down = theta.copy(), theta.copy()
        up[k] += step
        down[k] -= step
        numeric = (distances(points, up) - distances(points, down)) / (2.0 * step)
        assert np.allclose(jacobian[:, k], numeric, rtol=1e-5, atol=1e-5 * np.abs(numeric).max())


@pytest.mark.statistical
def test_a_whole_sphere_gives_every_parameter_within_its_sigma() -> None:
    results = [calibrate_ellipsoid(record("sphere", k), limit=math.radians(0.5)) for k in range(12)]
    truth = dict(zip([f"hard_iron_{a}" for a in "xyz"], HARD, strict=True)) | {
        "soft_iron_xx": SOFT[0, 0], "soft_iron_yy": SOFT[1, 1], "soft_iron_zz": SOFT[2, 2],
        "soft_iron_xy": SOFT[0, 1], "soft_iron_xz": SOFT[0, 2], "soft_iron_yz": SOFT[1, 2],
        "field": 50.0,
    }  # fmt: skip
    squares = []
    for result in results:
        assert result.geometry.verdict == "good"
        assert worst_heading(result) < 1.0
        for name, value in truth.items():
            item = result.parameter(name)
            assert item.value is not None
            assert item.sigma is not None
            squares.append(((item.value - value) / item.sigma) ** 2)
    # 120 squares, those of W tied by det W = 1: chi-square per degree within 0.7 to 1.4
    assert 0.7 < np.mean(squares) < 1.4


@pytest.mark.statistical
@pytest.mark.parametrize("shape", ["cap", "15", "5", "2"])
def test_no_cap_or_circle_is_accepted_with_a_wrong_heading(shape: str) -> None:
    for seed in range(6):
        result = calibrate_ellipsoid(record(shape, seed), limit=math.radians(0.5))
        if result.met:
            assert worst_heading(result) < 1.5
        else:
            assert result.geometry.undetermined == tuple(p.name for p in result.parameters)
            assert all(p.value is None and p.sigma is None for p in result.parameters)


def test_bands_do_not_run_away_and_the_gate_is_the_heading() -> None:
    for seed in range(4):
        band = record("30", seed)
        result = calibrate_ellipsoid(band, limit=math.radians(0.5))
        assert result.met
        assert worst_heading(result) < 1.5
        fit = fit_ellipsoid(np.column_stack([band.columns[f"mag_{a}_uT"] for a in "xyz"]), "full")
        assert fit.field < 100.0  # minimising s - 1 itself lets it run to 243
        assert not calibrate_ellipsoid(record("30", seed, 1.0), limit=math.radians(0.5)).met


def test_acc_and_temperature_never_change_the_ellipsoid() -> None:
    log = record("sphere", 3)
    bare = calibrate_ellipsoid(log, limit=math.radians(0.5))
    rng = np.random.default_rng(9)
    extra = {f"acc_{a}_m_s2": rng.normal(0, 9.8, log.size) for a in "xyz"}
    extra["temperature_c"] = rng.normal(20, 5, log.size)
    points = np.column_stack([log.columns[f"mag_{a}_uT"] for a in "xyz"])
    full = calibrate_ellipsoid(log_of(points, **extra), limit=math.radians(0.5))
    assert [p.to_dict() for p in full.parameters] == [p.to_dict() for p in bare.parameters]
    assert full.temperature_c is not None


def test_a_clean_sensor_needs_no_iron() -> None:
    rng = np.random.default_rng(5)
    points = 48.0 * directions("sphere", rng) + rng.normal(0.0, 0.3, (400, 3))
    result = calibrate_ellipsoid(log_of(points), limit=math.radians(0.5))
    assert [m.id for m in result.models if m.chosen] == ["none"]
    assert result.value("hard_iron_x") == 0.0
    assert result.parameter("soft_iron_xx").value == 1.0
    assert result.parameter("hard_iron_x").sigma is None
    assert result.geometry.verdict == "good"


def swing_file(path: Path, coefficients: Floats, sigma_deg: float = 0.1) -> Path:
    """Known headings, a tilted carrier, and a field whose shown heading deviates as stated."""
    rng = np.random.default_rng(8)
    psi = np.radians(np.tile(np.arange(0.0, 360.0, 15.0), 3))
    deviation = deviation_basis(psi) @ np.radians(coefficients)
    shown = psi - deviation + np.radians(rng.normal(0.0, sigma_deg, psi.size))
    pitch, roll = rng.uniform(-0.1, 0.1, (2, psi.size))
    field = tilted(level_field(shown, size=50.0, dip=1.1), pitch=pitch, roll=roll)
    up = np.tile([0.0, 0.0, 9.81], (psi.size, 1))
    acc = tilted(up, pitch=pitch, roll=roll)
    head = "time_s,heading_deg,mag_x_uT,mag_y_uT,mag_z_uT,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2"
    rows = np.column_stack([np.arange(psi.size) * 0.5, np.degrees(psi), field, acc])
    np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.9g")
    return path


def test_a_swing_gives_a_to_e_and_nothing_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    truth = np.array([1.5, 4.0, -2.0, 0.8, -0.5])
    path = swing_file(tmp_path / "swing.csv", truth)
    assert main(["calibrate", "compass", str(path), "--declination", "2.5,0.4", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert [p["name"] for p in result["parameters"]] == [f"deviation_{c}" for c in "ABCDE"]
    for item, value in zip(result["parameters"], truth, strict=True):
        assert abs(item["value"] - value) < 4.0 * item["sigma"]
        assert item["sigma"] < 0.05
    assert result["before"]["rms"] > 3.0
    assert 0.05 < result["after"]["rms"] < 0.15
    assert result["declination"] == {"deg": 2.5, "sigma_deg": 0.4, "reference": "MAGNETIC"}


def test_a_quarter_of_a_swing_is_refused_with_everything_undetermined(tmp_path: Path) -> None:
    path = swing_file(tmp_path / "swing.csv", np.zeros(5))
    lines = path.read_text().splitlines()
    kept = [lines[0], *(ln for ln in lines[1:] if float(ln.split(",")[1]) < 60.0)]
    path.write_text("\n".join(kept) + "\n")
    result = api.calibrate("compass", path)
    assert not result.met
    assert result.geometry.verdict == "refused"
    assert result.geometry.undetermined == tuple(f"deviation_{c}" for c in "ABCDE")


def test_swapped_axes_are_found_by_gravity(tmp_path: Path) -> None:
    path = swing_file(tmp_path / "swing.csv", np.zeros(5))
    text = path.read_text().replace(
        "acc_x_m_s2,acc_y_m_s2,acc_z_m_s2", "acc_z_m_s2,acc_x_m_s2,acc_y_m_s2"
    )
    path.write_text(text)
    with pytest.raises(SurveyError, match="exchanged or reversed") as caught:
        api.calibrate("compass", path)
    assert "up is +y" in str(caught.value)


def test_tilt_compensation_and_dip_are_exact() -> None:
    rng = np.random.default_rng(2)
    psi = rng.uniform(0.0, 2.0 * np.pi, 200)
    pitch, roll = rng.uniform(-1.2, 1.2, (2, 200))
    field = tilted(level_field(psi, size=40.0, dip=1.0), pitch=pitch, roll=roll)
    up = tilted(np.tile([0.0, 0.0, 9.8], (200, 1)), pitch=pitch, roll=roll)
    error = (heading_of(field, up) - psi + np.pi) % (2.0 * np.pi) - np.pi
    assert np.max(np.abs(error)) < 1e-12
    assert np.allclose(dip_of(field, up), 1.0)
    east = heading_of(level_field(np.array([np.pi / 2.0]), size=1.0, dip=0.0))
    assert east[0] == pytest.approx(np.pi / 2.0)


def test_a_known_heading_follows_from_a_shown_one() -> None:
    coefficients = np.radians([1.0, 6.0, -3.0, 1.0, 0.5])
    psi = np.linspace(0.0, 6.2, 40)
    shown = psi - deviation_basis(psi) @ coefficients
    assert np.allclose(undeviated(shown, coefficients), psi)


def test_bad_compass_input_ends_with_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = swing_file(tmp_path / "swing.csv", np.zeros(5))
    assert main(["calibrate", "compass", str(path), "--heading-limit-deg", "-1"]) == 2
    assert main(["calibrate", "compass", str(path), "--declination", "east"]) == 2
    assert main(["calibrate", "compass", str(path), "--sensor", "x"]) == 2
    assert main(["calibrate", "compass"]) == 2
    told = capsys.readouterr().err
    for part in ("no limit", "no declination", "names a log of a project", "missing"):
        assert part in told
