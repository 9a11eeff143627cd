"""What a card of a gyro is good for: drift since it was written, biases over temperature."""

from __future__ import annotations

import math
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.sensors.rate.card_drift import drift_from
from surveyapp.core.sensors.rate.card_temperature import model_of
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.io.sensor_cards import read_sensor_card
from tests.cli.command import run as surveyapp
from tests.rate.test_rotation_and_plan import turned_log

DEG_H = math.radians(1.0) / 3600.0


def test_a_change_beyond_both_sigmas_is_a_drift_and_one_within_is_none() -> None:
    """Three sigma of two parameters: p = .0027 is below .025."""
    old = SensorCard(
        "old",
        "t",
        "rate",
        "s",
        (
            SensorParameter("bias_x", 5.0, 0.3, "deg/h"),
            SensorParameter("bias_y", 1.0, 0.3, "deg/h"),
        ),
        calibrated_on=date(2026, 1, 1),
    )
    new = (
        SensorParameter("bias_x", 6.5, 0.4, "deg/h"),
        SensorParameter("bias_y", 1.4, 0.4, "deg/h"),
        SensorParameter("bias_z", 1.4, 0.4, "deg/h"),
    )
    found = drift_from(new, old, date(2026, 4, 11))
    assert found["verdict"] == "drifted"
    assert found["days"] == 100
    x, y = found["parameters"]
    assert (x["change"], x["sigma"]) == pytest.approx((1.5, 0.5))
    assert x["p"] == pytest.approx(0.0026998, rel=1e-4)  # normal, both tails
    assert x["per_month"] == pytest.approx(1.5 * 30.44 / 100.0)
    assert y["p"] > 0.3
    assert drift_from(new[1:], old, None)["verdict"] == "within_sigmas"


def test_a_card_of_the_chamber_follows_the_temperature_through_a_rotation(tmp_path: Path) -> None:
    """The chamber's biases, four hundred times as steep, on a run that warms by 12 K.

    With the card's model the heading is carried right, at one temperature it is off by the rest.
    """
    chamber, room = tmp_path / "t", tmp_path / "six"
    assert surveyapp("simulate", "rate", chamber, "--programme", "temperature").code == 0
    assert surveyapp("simulate", "rate", room).code == 0
    card = tmp_path / "unit.toml"
    made = surveyapp(
        "calibrate", "rate", chamber, "--room", room / "sensors/six-position.csv", "--card", card
    )
    assert made.code == 0, made.err
    model = model_of(read_sensor_card(card).extra)
    assert model is not None
    assert model.nodes["temperature_c"] - model.nodes["reference_temperature_c"] == pytest.approx(
        np.full(5, 4.0), abs=0.1
    )
    log = turned_log(turn_deg=48.6)
    warm = 24.0 + 12.0 * np.clip((log.columns["time_s"] - 60.0) / 20.0, 0.0, 1.0)
    bias, told = model.at({"temperature_c": warm}, where="log")
    assert bias is not None
    assert told == "temperature_c"
    columns = {**log.columns, "temperature_c": warm}
    for i, a in enumerate("xyz"):
        columns[f"gyr_{a}_rad_s"] = columns[f"gyr_{a}_rad_s"] + 400.0 * (bias[:, i] - bias[0, i])
    text = card.read_text(encoding="utf-8")
    strong = []
    for line in text.splitlines():
        name = line.split(" = ")[0]
        if name in ("bias_x", "bias_y", "bias_z") and "[" in line:
            values = [400.0 * float(v) for v in line.split("[")[1].rstrip("]").split(",")]
            line = f"{name} = {values}"
        strong.append(line)
    card.write_text("\n".join(strong) + "\n", encoding="utf-8")
    headings = {}
    for name, held in (("with", columns), ("without", {**columns, "temperature_c": warm * 0 + 24})):
        file = tmp_path / f"{name}.csv"
        file.write_text(SimulatedLog(held, log.texts).csv(), encoding="utf-8")
        done = surveyapp(
            *("north", file, "--method", "rotation", "--card", card, "--json"),
            *("--initial-heading-deg", "77", "--initial-reference", "GRID"),
        )
        assert done.code == 0, done.err
        headings[name] = done.json["heading"]["deg"]
        assert done.json["steps"][7]["bias_model"] == model.model
    assert headings["with"] == pytest.approx(125.6, abs=0.05)
    assert abs(headings["without"] - 125.6) > 0.3
    hot = tmp_path / "hot.csv"
    hot.write_text(
        SimulatedLog({**columns, "temperature_c": warm + 40.0}, log.texts).csv(), encoding="utf-8"
    )
    refused = surveyapp(
        *("north", hot, "--method", "rotation", "--card", card),
        *("--initial-heading-deg", "77", "--initial-reference", "GRID"),
    )
    assert refused.code == 2
    assert "outside the nodes" in refused.err
    again = surveyapp(
        *("calibrate", "rate", room, "--against", card, "--latitude", "45.77", "--json")
    )
    assert again.code == 0, again.err
    assert again.json["drift"][0]["card"] == "unit"
    assert surveyapp("calibrate", "rate", room, "--against", tmp_path / "no.toml").code == 2
