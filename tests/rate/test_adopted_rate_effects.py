"""What was adopted for the log of a rate sensor is taken out of it by the commands after it."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.sensors.rate.adopted import (
    StopDatum,
    adopted_flip_sigma,
    adopted_parameters,
    without_effects,
)
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from tests.cli.command import run as surveyapp
from tests.rate.test_table_columns import DEG_H, table_log

DEG_S = math.radians(1.0)


def adopted(identity: str, *grid: tuple[str, float], **values: float) -> AdoptedEffect:
    """An effect as project.toml has it."""
    return AdoptedEffect(
        identity, tuple((name, value, 0.1 * abs(value), "") for name, value in values.items()), grid
    )


def recorded() -> SensorLog:
    """Six positions with a warming sensor, accelerometers and a fluxgate."""
    log = table_log()
    rng = np.random.default_rng(1)
    more = {"temperature_c": 20.0 + 5.0 * np.linspace(0.0, 1.0, log.size)}
    more |= {f"acc_{a}_m_s2": rng.normal(0.0, 5.0, log.size) for a in "xyz"}
    more |= {f"mag_{a}_uT": rng.normal(0.0, 50.0, log.size) for a in "xyz"}
    return replace(log, columns={**log.columns, **more})


DATUM = StopDatum(rows=((100, 200), (300, 380)), middle_s=150.0, temperature_c=22.0, table=True)


def put_in(log: SensorLog, identity: str) -> Floats:
    """What an effect of that kind adds to gyro x [rad/s], written out by hand."""
    time, c = log.columns["time_s"], log.columns
    inside = np.zeros(log.size)
    inside[300:380] = 1.0
    in_x = np.array([word[0] == "x" for word in log.texts["position"]])
    wave = np.cos(2.0 * np.pi * 1.7 * (time - 10.0)) * ((time >= 10.0) & (time <= 200.0))
    shifts: dict[str, Floats] = {
        "bias_ramp": 2e-3 * DEG_S * (time - 150.0) / 60.0,
        "temperature": 3e-4 * DEG_S * (c["temperature_c"] - 22.0),
        "g_sensitivity": 1e-4 * DEG_S * c["acc_y_m_s2"],
        "magnetic_sensitivity": 1e4 * DEG_H * 1e-6 * c["mag_x_uT"],
        "scale_asymmetry": 0.5 * 200e-6 * np.deg2rad(np.abs(c["table_rate_deg_s"])) * in_x,
        "gross_error": 1e-3 * DEG_S * inside,
        "interference_line": 2e-3 * DEG_S * wave,
    }
    return shifts[identity]


EFFECTS = (
    adopted("bias_ramp", x=2e-3, y=0.0, z=0.0),
    adopted("temperature", x=3e-4, y=0.0, z=0.0),
    adopted("g_sensitivity", xy=1e-4),
    adopted("magnetic_sensitivity", x=1e4),
    adopted("scale_asymmetry", x=200.0),
    adopted("gross_error", ("row", 4.0), error=1e-3),
    adopted(
        "interference_line", ("frequency_hz", 1.7), ("begin_s", 10.0), ("end_s", 200.0),
        cosine_x=2e-3,
    ),
)  # fmt: skip


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda e: e.id)
def test_what_an_effect_put_in_is_taken_out_to_the_last_digit(effect: AdoptedEffect) -> None:
    log = recorded()
    struck = log.columns["gyr_x_rad_s"] + put_in(log, effect.id)
    clean, told = without_effects(
        replace(log, columns={**log.columns, "gyr_x_rad_s": struck}), [effect], DATUM
    )
    assert [w.code for w in told] == ["adopted_applied"]
    for a in "xyz":
        name = f"gyr_{a}_rad_s"
        assert np.allclose(clean.columns[name], log.columns[name], rtol=0.0, atol=1e-15)


def test_what_cannot_be_taken_out_is_told_with_its_reason() -> None:
    log = recorded()
    bare = replace(log, columns={k: v for k, v in log.columns.items() if k[:4] != "mag_"})
    other = replace(adopted("bias_ramp", x=1.0), data_sha256="0" * 64)
    effects = [
        adopted("magnetic_sensitivity", x=1e4),
        other,
        adopted("flip_error", ("place", 1.0), next=60.0, after_next=-80.0),
        adopted("interference_line", ("frequency_hz", 1.7), cosine_x=2e-3),
    ]
    clean, told = without_effects(replace(bare, sha256="1" * 64), effects, DATUM)
    assert [w.code for w in told] == ["adopted_not_applied"] * 4
    assert "mag_x_uT" in told[0].text
    assert "another state" in told[1].text
    assert "sigmas" in told[2].text
    assert np.array_equal(clean.columns["gyr_x_rad_s"], log.columns["gyr_x_rad_s"])
    # the difference of two seats: 60 and 80 arcsec are a flip of 50
    assert adopted_flip_sigma(effects) / ARCSEC == pytest.approx(50.0)


def test_terms_of_the_sensor_stand_among_its_parameters() -> None:
    """1e-4 deg/s per m/s2 are .36 deg/h per m/s2 and 3.53 deg/h per g."""
    found = adopted_parameters([EFFECTS[2], EFFECTS[4]])
    assert [p.name for p in found] == ["g_sensitivity_xy", "scale_factor_asymmetry_x"]
    assert [p.unit for p in found] == ["deg/h/g", "ppm"]
    assert found[0].value == pytest.approx(0.36 * 9.80665)
    assert found[1].value == 200.0


def test_an_asymmetric_scale_is_in_the_bias_until_it_is_adopted(tmp_path: Path) -> None:
    """200 ppm of 20 deg/s are 7.2 deg/h in the mean of both ways; the biases are 5, -3, 2."""
    folder = tmp_path / "unit"
    surveyapp("simulate", "rate", folder, "--effect", "scale_asymmetry=2e-4", "--seed", "5")
    options = ("calibrate", "rate", folder, "--sensor", "six-position", "--json")
    before = {p["name"]: p for p in surveyapp(*options).json["parameters"]}
    assert before["bias_x"]["value"] == pytest.approx(5.0 + 7.2, abs=0.2)
    named = surveyapp("diagnose", folder, "--sensor", "six-position", "--adopt", "--json").json
    assert [a["effect"] for a in named["adopted"]] == ["scale_asymmetry"]
    done = surveyapp(*options).json
    after = {p["name"]: p for p in done["parameters"]}
    for a, truth in zip("xyz", (5.0, -3.0, 2.0), strict=True):
        assert after[f"bias_{a}"]["value"] == pytest.approx(truth, abs=0.25)
        one = after[f"scale_factor_asymmetry_{a}"]
        assert abs(one["value"] - 200.0) < 4.0 * one["sigma"]
    assert "adopted_applied" in [w["code"] for w in done["warnings"]]
    noise = ("allan", folder, "--sensor", "six-position", "--column", "gyr_x_rad_s", "--json")
    assert "adopted_not_applied" in [w["code"] for w in surveyapp(*noise).json["warnings"]]
    log = folder / "sensors/six-position.csv"
    log.write_text(log.read_text() + "\n")
    again = surveyapp(*options).json
    assert "adopted_not_applied" in [w["code"] for w in again["warnings"]]


def test_a_record_at_rest_is_diagnosed_and_compensated_by_a_fluxgate(tmp_path: Path) -> None:
    """.01 deg/h per uT are 1e4 deg/h/T; 50 uT switched to and fro are half a deg/h each way."""
    folder = tmp_path / "rest"
    effect = ("--effect", "magnetic_sensitivity=0.01")
    surveyapp("simulate", "rate", folder, "--programme", "static", *effect, "--seed", "2")
    found = surveyapp("diagnose", folder, "--sensor", "static", "--adopt", "--json").json
    assert [a["effect"] for a in found["adopted"]] == ["magnetic_sensitivity"]
    assert "one_rest" in [w["code"] for w in found["warnings"]]
    for c in found["adopted"][0]["coefficients"]:
        assert abs(c["value"] - 1e4) < 4.0 * c["sigma"]
    card = tmp_path / "card.toml"
    surveyapp("simulate", "rate", tmp_path / "table", "--seed", "2")
    surveyapp("calibrate", "rate", tmp_path / "table", "--sensor", "six-position", "--card", card)
    out = tmp_path / "out.csv"
    done = surveyapp(
        "compensate", "rate", folder, "--sensor", "static", "--card", card, "-o", out, "--json"
    )
    assert "adopted_applied" in [w["code"] for w in done.json["warnings"]]
    raw = np.loadtxt(folder / "sensors/static.csv", delimiter=",", skiprows=1)
    names = (folder / "sensors/static.csv").read_text().split("\n", 1)[0].split(",")
    field = raw[:, names.index("mag_x_uT")]
    shown = np.loadtxt(out, delimiter=",", skiprows=1)[:, 1]
    slopes = [
        np.polyfit(field, x, 1)[0] / DEG_H for x in (raw[:, names.index("gyr_x_rad_s")], shown)
    ]
    assert slopes[0] == pytest.approx(0.01, rel=0.1)
    assert abs(slopes[1]) < 1e-3


def test_spectrum_and_motion_are_of_the_log_without_them(tmp_path: Path) -> None:
    """A line of 1.5 deg/h at 10 Hz; gyro z of a drive answers .5 deg/s per m/s2 of braking."""
    rest = tmp_path / "rest"
    effect = ("--effect", "interference_line=1.5", "--seed", "3")
    surveyapp("simulate", "rate", rest, "--programme", "static", *effect)
    spectrum = ("spectrum", rest, "--sensor", "static", "--column", "gyr_x_rad_s", "--json")
    before = surveyapp(*spectrum).json
    surveyapp("diagnose", rest, "--sensor", "static", "--adopt", "--json")
    after = surveyapp(*spectrum).json
    assert len(before["lines"]) == 1
    assert not after["lines"]
    assert after["sd"]["before"] == pytest.approx(before["sd"]["after"], rel=1e-3)

    drive = tmp_path / "drive"
    surveyapp("simulate", "vehicle", drive, "--seed", "2")
    motion = ("motion", drive, "--sensor", "vehicle", "--path", "--from", "0,0,30", "--json")
    clean = surveyapp(*motion).json
    log = drive / "sensors/vehicle.csv"
    names = log.read_text().split("\n", 1)[0]
    rows = np.loadtxt(log, delimiter=",", skiprows=1)
    where = names.split(",").index
    rows[:, where("gyr_z_rad_s")] += np.radians(0.5) * rows[:, where("acc_y_m_s2")]
    np.savetxt(log, rows, delimiter=",", header=names, comments="", fmt="%.12g")
    bent = surveyapp(*motion).json["path"]["end_m"]
    along = '[[sensor_log.effect]]\nid = "g_sensitivity"\nunit = "deg/s"\n'
    along += 'coefficients = { zy = { value = 0.5, sigma = 1e-4, unit = "deg/s/(m/s2)" } }\n'
    with (drive / "project.toml").open("a") as project:
        project.write(along)
    told = surveyapp(*motion).json
    assert "adopted_applied" in [w["code"] for w in told["warnings"]]
    assert told["path"]["end_m"] == pytest.approx(clean["path"]["end_m"], abs=1e-3)
    assert math.dist(bent, clean["path"]["end_m"]) > 0.1
