"""The constant of a gyro on a total station against truth from attitudes, and the published one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveyapp.core.sensors.rate.fog_station import BothWays, combine, judge_scatter
from surveyapp.core.sensors.rate.fog_station_log import calibrate_fog_station
from surveyapp.core.sensors.rate.fog_station_plan import elevation_sigma, plan_fog_station
from surveyapp.core.simulate.rate.table_programmes import FogStationRun, TableRun, fog_station_log
from surveyapp.domain.calibration import Calibration
from surveyapp.errors import SurveyError
from surveyapp_models.angles import ARCSEC
from surveyapp_models.rate.fog_station import FogOnTelescope
from surveyapp_models.rate.turntable import Table
from tests.rate.logs import (
    PUBLISHED_CONSTANT,
    PUBLISHED_ELEVATION,
    PUBLISHED_READING,
    as_read,
    part_of,
    published_run,
)


def calibrated(spec: FogStationRun, seed: int, relative: float | None = None) -> Calibration:
    log = as_read(fog_station_log(spec, np.random.default_rng(seed)))
    return calibrate_fog_station(log, rule="increases", relative_rate_sigma=relative, problems=[])


def test_the_published_experiment_gives_171_07_49_and_its_scatter_exceeds_the_model() -> None:
    published = BothWays(
        1, 1, -0.12 * PUBLISHED_ELEVATION, 0.12 * PUBLISHED_ELEVATION, 1e-9, 1e-9,
        0.12 * PUBLISHED_ELEVATION / math.sin(PUBLISHED_ELEVATION),
        0.12 * PUBLISHED_ELEVATION / math.sin(PUBLISHED_ELEVATION),
        PUBLISHED_READING, 4.0, 4.0, 1e-6, 2400,
    )  # fmt: skip
    one = combine([published], rule="increases", relative_rate_sigma=0.0)
    assert one.constant == pytest.approx(PUBLISHED_CONSTANT, abs=1e-9)
    other = combine([published], rule="decreases", relative_rate_sigma=0.0)
    assert other.constant is not None
    assert math.degrees(other.constant) == pytest.approx(157.9297, abs=1e-4)  # 157-55-47
    for relative, model in ((4.2e-5, 0.70), (1e-4, 1.69)):
        noise = 0.016 * ARCSEC
        total = math.hypot(noise, math.tan(PUBLISHED_ELEVATION) * relative / math.sqrt(2.0))
        assert total / ARCSEC == pytest.approx(model, abs=0.015)
        found = judge_scatter(
            sd=4.8 * ARCSEC, count=20, model_sd=total, elevation=PUBLISHED_ELEVATION, noise_sd=noise
        )
        assert found.verdict == "exceeds_model"
        assert found.p is not None
        assert found.p < 0.001
        assert found.relative_rate_error_needed == pytest.approx(2.84e-4, rel=5e-3)


@pytest.mark.parametrize(
    ("relative", "model"), [(0.0, 0.016), (4.2e-5, 0.709), (1e-4, 1.688), (2.84e-4, 4.793)]
)
def test_scatter_of_twenty_sets_follows_equation_15(relative: float, model: float) -> None:
    """rate.md section 2; bounds from chi-square of 5 x 19 degrees of freedom at 1e-4."""
    squares = []
    for seed in range(5):
        found = calibrated(published_run(rate_error=relative), 100 + seed, relative)
        scatter = found.extra["scatter"]
        assert scatter["model_sd_arcsec"] == pytest.approx(model, rel=0.02, abs=2e-3)
        squares.append(scatter["sd_arcsec"] ** 2)
        elevation = found.parameter("elevation")
        assert elevation.value is not None
        assert elevation.sigma is not None
        assert abs(elevation.value - 23761.0) < 4.5 * elevation.sigma
    assert 0.72 < math.sqrt(float(np.mean(squares))) / model < 1.30


def test_an_undeclared_rate_error_of_the_published_size_is_always_found() -> None:
    for seed in range(5):
        found = calibrated(published_run(rate_error=2.84e-4), 200 + seed, 1e-4)
        scatter = found.extra["scatter"]
        assert scatter["verdict"] == "exceeds_model"
        assert scatter["p"] < 0.001
        assert scatter["relative_rate_error_needed"] == pytest.approx(2.84e-4, rel=0.75)
        assert not found.met


@pytest.mark.parametrize(("scale", "first", "second"), [(1e-4, 2.39, 0.001), (1e-3, 23.87, 0.025)])
def test_a_scale_error_is_in_the_first_pass_and_not_in_the_second(
    scale: float, first: float, second: float
) -> None:
    found = calibrated(published_run(scale=scale, passes=2), 7)
    sets = found.extra["sets"]
    truth = math.degrees(PUBLISHED_CONSTANT)

    def off(number: int) -> float:
        values = [s["instrument_constant_deg"] for s in sets if s["pass"] == number]
        return (float(np.mean(values)) - truth) * 3600.0

    assert off(1) == pytest.approx(first, abs=0.02)
    assert abs(off(2)) < second + 0.02
    constant, ppm = found.parameter("instrument_constant"), found.parameter("scale_factor")
    assert constant.value is not None
    assert constant.value == pytest.approx(truth, abs=0.015 / 3600.0)
    assert ppm.value is not None
    assert ppm.sigma is not None
    assert abs(ppm.value - scale * 1e6) < 4.5 * ppm.sigma
    assert found.value("elevation") == pytest.approx(23761.0, abs=0.02)


def test_one_and_two_thirds_turns_are_cut_to_one_and_all_samples_would_be_ten_seconds_off() -> None:
    run = TableRun(rate=math.radians(10.0), turns=1.67, interval_s=0.05, pause_s=1.0, ramp_s=0.5)
    fog = FogOnTelescope(constant=PUBLISHED_CONSTANT)
    worst_used, worst_all = 0.0, 0.0
    for azimuth in np.linspace(0.0, 6.0, 12):
        spec = FogStationRun(
            fog, Table(math.radians(34.0), azimuth=float(azimuth)), run, PUBLISHED_READING, sets=1
        )
        there, back = (fog_station_log(spec, np.random.default_rng(k)) for k in (3, 4))
        first = there.columns["time_s"] < 0.5 * there.columns["time_s"][-1]
        raw = type(there)(  # the way back begins at another azimuth
            {k: np.where(first, v, back.columns[k]) for k, v in there.columns.items()}
        )
        found = calibrate_fog_station(
            as_read(raw), rule="increases", relative_rate_sigma=None, problems=[]
        )
        assert found.extra["sets"][0]["turns_recorded"] == pytest.approx(1.67, abs=0.05)
        assert found.extra["sets"][0]["turns_used"] == pytest.approx(1.0, abs=0.01)
        value = found.value("elevation")
        assert value is not None
        worst_used = max(worst_used, abs(value - 23761.0))
        c = raw.columns
        ways = [
            float(c["gyr_x_rad_s"][c["table_rate_deg_s"] == s * 10.0].mean()) for s in (1.0, -1.0)
        ]
        naive = math.asin((ways[1] - ways[0]) / (2.0 * math.radians(10.0))) / ARCSEC
        worst_all = max(worst_all, abs(naive - 23761.0))
    assert worst_used < 0.39
    assert worst_all > 5.0


def test_less_than_a_turn_is_refused_unless_the_way_back_retraces_the_arc() -> None:
    run = TableRun(rate=math.radians(10.0), turns=0.6, interval_s=0.05, pause_s=1.0, ramp_s=0.05)
    spec = FogStationRun(
        FogOnTelescope(constant=PUBLISHED_CONSTANT),
        Table(0.6, azimuth=0.4),
        run,
        PUBLISHED_READING,
        sets=1,
    )
    raw = fog_station_log(spec, np.random.default_rng(3))
    found = calibrate_fog_station(
        as_read(raw), rule="increases", relative_rate_sigma=None, problems=[]
    )
    assert found.value("elevation") == pytest.approx(23761.0, abs=0.2)
    assert "retraced_arc" in [w.code for w in found.warnings]
    shifted = dict(raw.columns)
    back = shifted["table_rate_deg_s"] < 0.0
    shifted["table_angle_deg"] = (shifted["table_angle_deg"] + 180.0 * back) % 360.0
    with pytest.raises(SurveyError) as caught:
        calibrate_fog_station(
            as_read(type(raw)(shifted)), rule="increases", relative_rate_sigma=None, problems=[]
        )
    assert "less than one whole turn" in caught.value.problems[0].what


def test_one_sense_of_rotation_is_refused() -> None:
    raw = fog_station_log(published_run(), np.random.default_rng(1))
    one_way = part_of(raw, raw.columns["table_rate_deg_s"] >= 0.0)
    with pytest.raises(SurveyError, match="one sense of rotation only"):
        calibrate_fog_station(
            as_read(one_way), rule="increases", relative_rate_sigma=None, problems=[]
        )


def test_a_wrong_sign_of_the_nominal_rate_is_found_from_the_angle_and_told() -> None:
    raw = fog_station_log(published_run(), np.random.default_rng(1))
    columns = dict(raw.columns)
    columns["table_rate_deg_s"] = -columns["table_rate_deg_s"]
    found = calibrate_fog_station(
        as_read(type(raw)(columns)), rule="increases", relative_rate_sigma=None, problems=[]
    )
    assert "sense_of_rotation" in [w.code for w in found.warnings]
    assert found.value("elevation") == pytest.approx(23761.0, abs=0.1)


@pytest.mark.parametrize("missing", ["table_angle_deg", "table_rate_deg_s"])
def test_either_the_angle_or_the_rate_of_the_table_is_enough(missing: str) -> None:
    raw = fog_station_log(published_run(), np.random.default_rng(1))
    found = calibrate_fog_station(
        as_read(raw, without=[missing]), rule="increases", relative_rate_sigma=None, problems=[]
    )
    assert found.value("elevation") == pytest.approx(23761.0, abs=0.1)


def test_a_saturated_gyro_is_refused() -> None:
    raw = fog_station_log(published_run(), np.random.default_rng(1))
    columns = dict(raw.columns)
    columns["gyr_x_rad_s"] = np.clip(columns["gyr_x_rad_s"], -0.2, 0.2)
    with pytest.raises(SurveyError, match="saturated"):
        calibrate_fog_station(
            as_read(type(raw)(columns)), rule="increases", relative_rate_sigma=None, problems=[]
        )


def test_the_plan_has_the_figures_of_equation_15() -> None:
    """Sensors.md 2a: figures 4, 5 and 6 of the source."""
    cases = ((10, 10, 3.293), (10, 40, 2.770), (10, 300, 2.599), (30, 10, 2.662), (120, 10, 2.577))
    for rate, samples, expected in cases:
        sigma = elevation_sigma(
            elevation=math.radians(10.0),
            rate=math.radians(rate),
            samples=samples,
            relative_rate_sigma=1e-4,
        )
        assert sigma / ARCSEC == pytest.approx(expected, abs=2e-3)
    plan = plan_fog_station(relative_rate_sigma=1e-3)
    assert plan.sigma_arcsec == pytest.approx(25.72, abs=0.01)
    assert plan.second_pass_arcsec == pytest.approx(0.12, abs=0.005)
