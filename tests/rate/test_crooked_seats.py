"""No position seated like the others: the natural flip error, named and in the sigmas."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.sensors.rate.adopted import adopted_flip_sigma
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.recipes import PROGRAMMES
from surveyapp.core.simulate.rate.table_programmes import DEG_H, six_position_log
from surveyapp.core.simulate.specification import Effect
from surveyapp.diagnosis.crooked_seats import Seats
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.rate_stops import stops_of
from surveyapp.diagnosis.subjects.rate import seats_of
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.workflows.rate_case import case_of_log
from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.rate.flip_error import SEAT_SD
from tests.cli.command import run as surveyapp
from tests.rate.logs import as_read
from tests.rate.test_table_programmes import calibrated, unit

LATITUDE = math.radians(45.77)
RECORDS = 40


def seats(seed: int, arcsec: float) -> tuple[Seats | None, SimulatedLog]:
    made = unit(flip_sigma=arcsec * ARCSEC, tilt_deg=0.3)
    log = six_position_log(made, np.random.default_rng(seed))
    stops, _, _ = stops_of(as_read(log), latitude=LATITUDE)
    return seats_of(stops), log


def adopted(found: Seats) -> AdoptedEffect:
    error = found.sd / math.sqrt(2.0 * found.effective)
    size = (SEAT_SD, found.sd / ARCSEC, error / ARCSEC, "arcsec")
    return AdoptedEffect("flip_error", (size,))


def test_seats_of_a_minute_are_found_and_the_intervals_hold_the_truth() -> None:
    """60 arcsec about either axis in 40 records of one round: six combinations of seats each.

    The mean square has 240 degrees of freedom: 60^2 within 24 % (2.6 sigmas). The six
    misalignments of a record share one estimate: 38 of 40 expected, 31 and fewer have p < 1e-4
    for independent ones; with their correlation the bound is 0.89.
    """
    squares, inside = [], []
    for seed in range(RECORDS):
        found, log = seats(seed, 60.0)
        assert found is not None
        assert found.effective == 6
        squares.append((found.sd / ARCSEC / 60.0) ** 2)
        flip = adopted_flip_sigma([adopted(found)])
        for item in calibrated(log, flip_sigma=flip).parameters:
            if item.name.startswith("misalignment"):
                assert item.value is not None
                assert item.sigma is not None
                off = item.value - float(str(log.truth[item.name]))
                inside.append(abs(off) <= 1.96 * item.sigma)
    assert float(np.mean(squares)) == pytest.approx(1.0, abs=0.24)
    assert float(np.mean(inside)) >= 0.89


def test_a_well_seated_unit_has_no_seats() -> None:
    """At .001 each, one of 40 has p = .04, two p < .001."""
    assert sum(seats(seed, 0.0)[0] is not None for seed in range(RECORDS)) <= 1


def test_named_adopted_and_counted(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    assert (
        surveyapp("simulate", "rate", folder, "--effect", "flip_error=60", "--seed", "6").code == 0
    )
    call = ("diagnose", folder, "--sensor", "six-position", "--json")
    found = surveyapp(*call, "--adopt").json
    assert [item["effect"] for item in found["adopted"]] == ["flip_error"]
    assert found["after"]["loo_rms"] < 0.2 * found["before"]["loo_rms"]
    told = surveyapp("calibrate", "rate", folder, "--sensor", "six-position", "--json").json
    size = found["adopted"][0]["coefficients"][0]["value"]
    widened = 2.4469 / 1.9600 * size  # Student's quantile of six degrees of freedom
    one = next(p for p in told["parameters"] if p["name"] == "misalignment_xy")
    assert one["sigma"] == pytest.approx(widened / math.sqrt(2.0), rel=0.02)


def test_a_second_effect_is_named_beside_the_seats_of_one_round() -> None:
    """Twelve unknowns of the unit and six of the seats are half of the 36 rows of one round."""
    rng = np.random.default_rng([3, 9])
    effects = [Effect("flip_error", 60.0 * ARCSEC), Effect("bias_ramp", 10.0 * DEG_H / 3600.0)]
    log = PROGRAMMES["rate"]["six-position"][0](effects, rng)
    made = case_of_log(as_read(log), SensorLogEntry("log", "rate", "", latitude_deg=45.77))
    assert made.finished is not None
    found, _ = made.finished(diagnose(made.case, advise=False))
    assert {a.effect for a in found.adopted} == {"flip_error", "bias_ramp"}
