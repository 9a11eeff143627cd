"""Six positions and the temperature programme against truth from attitudes and earth rate."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.sensors.rate.compensation import (
    chosen_model,
    compare_models,
    fitted,
    grey_model,
    ratios_admissible,
)
from surveyapp.core.sensors.rate.position_log import resting_rows
from surveyapp.core.sensors.rate.six_position_log import (
    SixPositionOptions,
    calibrate_six_positions,
)
from surveyapp.core.sensors.rate.temperature_log import (
    calibrate_temperature,
)
from surveyapp.core.sensors.rate.temperature_nodes import TemperatureOptions
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.recipes import example_unit, simulate_rate
from surveyapp.core.simulate.rate.table_programmes import (
    DEG_H,
    ImuOnTable,
    TableRun,
    six_position_log,
    temperature_log,
)
from surveyapp.domain.calibration import Calibration
from surveyapp.errors import SurveyError
from surveyapp_models.angles import ARCSEC
from surveyapp_models.rate.triad import Triad
from surveyapp_models.rate.turntable import POSITIONS, Table
from tests.rate.logs import as_read

RUN = TableRun(turns=2.0, interval_s=0.25, pause_s=1.0, ramp_s=1.0)


def unit(*, noise: bool = True, flip_sigma: float = 0.0, tilt_deg: float = 0.0) -> ImuOnTable:
    made = example_unit({}, RUN)
    table = Table(math.radians(45.77), azimuth=2.39, tilt_along=math.radians(tilt_deg))
    gyro = made.gyro if noise else replace(made.gyro, noise=0.0)
    return replace(
        made, gyro=gyro, table=table, flip_sigma=flip_sigma, warm_up_s=10.0, static_s=5.0
    )


def calibrated(log: SimulatedLog, **options: float) -> Calibration:
    return calibrate_six_positions(as_read(log), SixPositionOptions(**options))


def value(found: Calibration, name: str) -> float:
    item = found.value(name)
    assert item is not None
    return item


@pytest.mark.parametrize("tilt_deg", [0.0, 5.0, 20.0])
def test_level_and_azimuth_of_the_table_do_not_matter(tilt_deg: float) -> None:
    made = unit(noise=False, tilt_deg=tilt_deg)
    made = replace(made, accelerometer=replace(made.accelerometer, noise=0.0))
    log = six_position_log(made, np.random.default_rng(1))
    found = calibrated(log)
    for name, truth in log.truth.items():
        if not name.startswith("accelerometer"):
            tolerance = {"s": 2e-3, "m": 2e-3, "b": 2e-3}[name[0]]
            assert value(found, name) == pytest.approx(float(str(truth)), abs=tolerance), name
    step = found.extra["steps"][0]
    assert step["tilt_arcsec"] == pytest.approx(tilt_deg * 3600.0, abs=700.0)


def test_sigmas_of_all_twelve_parameters_are_right() -> None:
    """30 records x 12: pooled chi-square; the bench counts the intervals of 200."""
    scores = []
    for seed in range(30):
        log = six_position_log(unit(), np.random.default_rng(seed))
        found = calibrated(log)
        for item in found.parameters:
            assert item.value is not None
            assert item.sigma is not None
            scores.append((item.value - float(str(log.truth[item.name]))) / item.sigma)
    assert float(np.mean(np.square(scores))) == pytest.approx(1.0, abs=0.30)  # 4 sigma of 360
    assert 0.91 <= float(np.mean(np.abs(scores) <= 1.96)) <= 0.99


def test_flips_of_a_minute_are_46_seconds_in_a_misalignment_and_the_sigma_says_so() -> None:
    """rate.md: E rms 46 arcsec in 20 runs; 60/sqrt(2) = 42.4 by theory."""
    off, scores = [], []
    for seed in range(30):
        log = six_position_log(unit(flip_sigma=60.0 * ARCSEC), np.random.default_rng(seed))
        found = calibrated(log, flip_sigma=60.0 * ARCSEC)
        for item in found.parameters:
            if item.name.startswith("misalignment"):
                assert item.value is not None
                assert item.sigma is not None
                off.append(item.value - float(str(log.truth[item.name])))
                scores.append(off[-1] / item.sigma)
    assert 36.0 < float(np.sqrt(np.mean(np.square(off)))) < 49.0
    assert 0.75 < float(np.mean(np.square(scores))) < 1.3


def test_flips_of_half_a_degree_enter_the_scale_factor_and_not_the_bias() -> None:
    scale, bias, sigma = [], [], 0.0
    for seed in range(20):
        made = unit(noise=False, flip_sigma=math.radians(0.5))
        log = six_position_log(made, np.random.default_rng(seed))
        found = calibrated(log, flip_sigma=math.radians(0.5))
        scale += [
            value(found, f"scale_factor_{a}") - float(str(log.truth[f"scale_factor_{a}"]))
            for a in "xyz"
        ]
        bias += [value(found, f"bias_{a}") - float(str(log.truth[f"bias_{a}"])) for a in "xyz"]
        sigma = found.parameter("scale_factor_x").sigma or 0.0
    rms = float(np.sqrt(np.mean(np.square(scale))))
    assert rms == pytest.approx(93.0, rel=0.25)  # sigma^2 sqrt(1.5); sensors.md 91 ppm
    assert sigma == pytest.approx(93.3, rel=0.02)
    assert max(abs(b) for b in bias) < 0.004  # own pair; rate.md .0022 deg/h at one degree


def test_a_missing_pair_leaves_exactly_its_own_four_parameters() -> None:
    log = six_position_log(unit(), np.random.default_rng(1), positions=("y+", "y-", "z+", "z-"))
    found = calibrated(log)
    assert set(found.geometry.undetermined) == {
        "scale_factor_x", "misalignment_yx", "misalignment_zx", "bias_x",
    }  # fmt: skip
    assert not found.met
    assert value(found, "misalignment_xy") == pytest.approx(200.0, abs=2.0)
    assert value(found, "misalignment_xz") == pytest.approx(-100.0, abs=2.0)


def test_one_position_of_a_pair_needs_the_latitude_for_the_bias() -> None:
    log = six_position_log(
        unit(), np.random.default_rng(1), positions=("x+", "y+", "y-", "z+", "z-")
    )
    assert calibrated(log).geometry.undetermined == ("bias_x",)
    known = calibrated(log, latitude=math.radians(45.77))
    assert known.geometry.undetermined == ()
    assert value(known, "bias_x") == pytest.approx(5.0, abs=0.5)


def test_rounds_are_judged_against_the_stated_sigma() -> None:
    parts = []
    for k in range(3):
        made = unit(flip_sigma=60.0 * ARCSEC)
        log = six_position_log(made, np.random.default_rng(50 + k))
        columns = dict(log.columns)
        columns["time_s"] = columns["time_s"] + 5000.0 * k
        columns["round"] = np.full(columns["time_s"].size, k + 1.0)
        parts.append(SimulatedLog(columns, log.texts, log.truth))
    whole = SimulatedLog(
        {k: np.concatenate([p.columns[k] for p in parts]) for k in parts[0].columns},
        {"position": [w for p in parts for w in p.texts["position"]]},
        parts[0].truth,
    )
    honest = calibrated(whole, flip_sigma=60.0 * ARCSEC).extra["repeatability"]
    assert honest["rounds"] == 3
    assert honest["verdict"] == "agrees"
    assert calibrated(whole).extra["repeatability"]["verdict"] == "exceeds_model"


def test_a_table_that_counts_the_other_way_is_found_and_told() -> None:
    log = six_position_log(unit(), np.random.default_rng(1))
    columns = dict(log.columns)
    columns["table_rate_deg_s"] = -columns["table_rate_deg_s"]
    columns["table_angle_deg"] = -columns["table_angle_deg"] % 360.0
    found = calibrated(SimulatedLog(columns, log.texts, log.truth))
    assert "sense_of_rotation" in [w.code for w in found.warnings]
    assert value(found, "scale_factor_x") == pytest.approx(300.0, abs=10.0)


def test_a_position_that_gravity_contradicts_is_refused() -> None:
    log = six_position_log(unit(), np.random.default_rng(1))
    words = ["y+" if w == "x+" else "x+" if w == "y+" else w for w in log.texts["position"]]
    with pytest.raises(SurveyError, match="gravity contradicts the position"):
        calibrated(SimulatedLog(log.columns, {"position": words}, log.truth))


def test_a_saturated_axis_is_refused() -> None:
    log = six_position_log(unit(), np.random.default_rng(1))
    columns = dict(log.columns)
    columns["gyr_y_rad_s"] = np.clip(columns["gyr_y_rad_s"], -0.3, 0.3)
    with pytest.raises(SurveyError, match="saturated"):
        calibrated(SimulatedLog(columns, log.texts, log.truth))


def chamber(
    seed: int, *, latitude: float = 0.6, tilt_deg: float = 0.0
) -> tuple[SimulatedLog, SimulatedLog]:
    table = Table(latitude, tilt_along=math.radians(tilt_deg))
    made = replace(unit(), table=table)

    def at(node: float) -> tuple[Triad, Triad]:
        t = (node - 20.0) / 30.0
        bias = made.gyro.bias * (1.0 + 0.5 * t + 0.3 * t**2 - 0.2 * t**3)
        return replace(made.gyro, bias=bias), made.accelerometer

    rng = np.random.default_rng(seed)
    log = temperature_log(made, rng, nodes_c=(-10.0, 5.0, 20.0, 30.0, 40.0), at=at)
    return log, six_position_log(made, rng, positions=POSITIONS)


def test_the_chamber_gives_every_node_and_names_the_missing_misalignments() -> None:
    log, room = chamber(1)
    found = calibrate_temperature(
        as_read(log), TemperatureOptions(latitude=0.6, predict_at=(-10.0, 12.0))
    )
    truth = log.truth["nodes"]
    assert isinstance(truth, dict)
    assert len(found.extra["nodes"]) == 5
    for node in found.extra["nodes"]:
        for item in node["parameters"]:
            if not item["name"].startswith("accelerometer"):
                expected = truth[f"{node['temperature_c']:g}"][item["name"]]
                assert abs(item["value"] - expected) < 4.8 * item["sigma"], item["name"]
    assert set(found.geometry.undetermined) == {
        f"accelerometer_misalignment_{a}{b}" for a in "xyz" for b in "xyz" if a != b
    }
    assert found.extra["accelerometer_rank"] == {"rank": 9, "of": 12}
    assert not found.met
    with_room = calibrate_temperature(
        as_read(log), TemperatureOptions(latitude=0.6, room=resting_rows(as_read(room)))
    )
    assert with_room.met
    assert with_room.extra["accelerometer_rank"] == {"rank": 6, "of": 6}
    assert value(with_room, "accelerometer_scale_factor_z") == pytest.approx(2000.0, abs=600.0)


def test_neglecting_the_vertical_earth_rate_would_be_eight_degrees_per_hour() -> None:
    """FOG IMU of sensors.md: 7.97 deg/h at latitude 32 in the axis's own position, one of three."""
    log, _ = chamber(2, latitude=math.radians(32.0))
    right = calibrate_temperature(as_read(log), TemperatureOptions(latitude=math.radians(32.0)))
    wrong = calibrate_temperature(as_read(log), TemperatureOptions(latitude=0.0))
    assert value(wrong, "bias_x") - value(right, "bias_x") == pytest.approx(7.97 / 3.0, abs=0.01)


def test_a_temperature_outside_the_nodes_is_refused() -> None:
    log, _ = chamber(1)
    with pytest.raises(SurveyError, match="outside the nodes"):
        calibrate_temperature(as_read(log), TemperatureOptions(latitude=0.6, predict_at=(55.0,)))


def test_models_are_chosen_by_left_out_nodes_and_a_kink_is_not_called_cubic_by_its_fit() -> None:
    nodes = np.array([-10.0, 5.0, 20.0, 30.0, 40.0])
    rng = np.random.default_rng(4)
    smooth = np.column_stack([1.0 + 0.05 * nodes - 1e-3 * nodes**2 + 2e-5 * nodes**3] * 3)
    noisy = smooth + rng.normal(0.0, 0.01, (5, 3))
    assert chosen_model(compare_models(nodes, noisy)) == "cubic"
    line = np.column_stack([0.3 * nodes] * 3)
    straight = {c.model: c.held_out_rms for c in compare_models(nodes, line)}
    assert straight["linear"] == pytest.approx(0.0, abs=1e-9)
    interpolated = fitted("piecewise_linear", nodes, nodes**2)
    assert interpolated is not None
    assert float(interpolated(np.array([35.0]))[0]) == pytest.approx(1250.0)


def test_grey_model_reproduces_an_exponential_and_says_when_it_is_not_admissible() -> None:
    """Sensors.md 2c: an exponential is fitted and forecast to 1e-3."""
    t = np.arange(8.0)
    series = 3.0 * np.exp(0.12 * t)
    model = grey_model(t, series)
    assert model is not None
    assert model.admissible
    np.testing.assert_allclose(model.at(t[1:]), series[1:], rtol=3e-3)
    assert not ratios_admissible(np.array([1.0, 3.0, 1.0, 3.0, 1.0]))
    through_zero = grey_model(t, np.linspace(-1.0, 1.0, 8))
    assert through_zero is not None
    assert through_zero.shift > 0.0


def test_every_simulated_project_has_its_log_and_truth() -> None:
    files, truth = simulate_rate("rate", None, effects=(), rng=np.random.default_rng(1))
    assert set(files) == {"project.toml", "sensors/six-position.csv"}
    assert truth["simulated"] is True


def test_a_tilted_table_and_a_chamber_that_is_read_often_change_nothing() -> None:
    """Half a degree of tilt stands in the rests of the accelerometers: 1800" of misalignment."""
    log, room = chamber(3, tilt_deg=0.5)
    columns = dict(log.columns)
    rng = np.random.default_rng(4)
    read = columns["reference_temperature_c"] + 0.1 * rng.normal(size=columns["time_s"].size)
    columns["reference_temperature_c"] = read
    found = calibrate_temperature(
        as_read(replace(log, columns=columns)),
        TemperatureOptions(latitude=0.6, room=resting_rows(as_read(room))),
    )
    assert [round(node["temperature_c"]) for node in found.extra["nodes"]] == [-10, 5, 20, 30, 40]
    for item in found.parameters:
        if item.name.startswith("accelerometer_misalignment"):
            assert item.value is not None
            assert item.sigma is not None
            error = item.value - float(str(room.truth[item.name]))
            assert abs(error) < 4.0 * item.sigma, item.name


def test_samples_far_off_are_told_and_coarse_counts_are_none() -> None:
    """Three samples of 250 standard deviations; steps of two standard deviations of the noise."""
    log = as_read(six_position_log(unit(), np.random.default_rng(4)))
    gyro = log.columns["gyr_y_rad_s"]
    rows = np.flatnonzero(
        (np.array(log.texts["position"]) == "z+") & (log.columns["table_rate_deg_s"] > 19.9)
    )
    struck = gyro.copy()
    struck[rows[[20, 40, 60]]] += 500.0 * DEG_H
    coarse = np.round(gyro / (4.0 * DEG_H)) * 4.0 * DEG_H
    for values, wanted in ((gyro, ""), (struck, "gyr_y_rad_s 3"), (coarse, "")):
        found = calibrate_six_positions(
            replace(log, columns={**log.columns, "gyr_y_rad_s": values}), SixPositionOptions()
        )
        told = [w.text for w in found.warnings if w.code == "gross_samples"]
        assert len(told) == bool(wanted)
        assert all(wanted in text for text in told)
