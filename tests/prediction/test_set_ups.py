"""Several lines sighted from one set-up are one determination of the constant."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveyapp.core.orientation.circumstances import Circumstances
from surveyapp.core.orientation.instrument_constant import Calibration, InstrumentConstant
from surveyapp.core.orientation.predicted_constant import predict_constants, predictable
from surveyapp.core.orientation.prediction_notes import Wanted
from surveyapp.core.orientation.set_ups import one_a_set_up
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import Instrument, InstrumentCard
from surveyapp.domain.station_line import StationLine
from surveyapp_models.angles import ARCSEC

SESSIONS, SWING, SIGHT = 8, 5.0 * ARCSEC, 1.0 * ARCSEC


def calibrations(targets: int) -> tuple[InstrumentConstant, dict[tuple[str, str], Circumstances]]:
    """Eight set-ups; the swing errs in all lines of a set-up alike, each sight by itself."""
    g = np.random.default_rng(4)
    made, facts = [], {}
    for k in range(SESSIONS):
        name = f"cal-{k}"
        swing = SWING * g.standard_normal()
        sights = SIGHT * g.standard_normal(3)
        for t, sight in enumerate(sights[:targets]):
            target = f"T{t}"
            parts = {
                Source("turning points", name): SWING,
                Source("sights", name, detail=target): SIGHT,
            }
            value = Uncertain(float(swing + sight), parts)
            made.append(
                Calibration(name, "P", target, value, "before", float(k), 1, 0.0, None, 200.0)
            )
            facts[name, target] = Circumstances.of(
                {
                    "elapsed_days": 3.0 * k,
                    "line": target,
                    "line_reading": float(t),
                    "temperature_c": 10.0 + k,
                }
            )
    card = InstrumentCard("c", "c", "suspended", "test")
    found = InstrumentConstant(Instrument("G", card), tuple(made), (), None, None, None, None)
    return found, facts


@pytest.mark.parametrize("targets", [2, 3])
def test_more_targets_make_the_sights_smaller_and_not_the_swing(targets: int) -> None:
    one, several = calibrations(1), calibrations(targets)
    merged = one_a_set_up(several[0].calibrations, several[1])
    assert len(merged) == several[0].set_ups == SESSIONS
    sigma = math.hypot(SWING, SIGHT / math.sqrt(targets))
    assert [item.value.sigma for item, _ in merged] == pytest.approx([sigma] * SESSIONS)
    told = merged[0][1]
    assert told.name("line") == " + ".join(f"T{t}" for t in range(targets))
    assert told.number("line_reading") is None
    assert told.number("temperature_c") == 10.0
    halves = [predict_constants(*part, []).average.interval95 for part in (one, several)]
    # as twenty-four independent ones they would be narrower by a half
    assert halves[1] == pytest.approx(halves[0], rel=0.15)


def test_two_set_ups_with_three_lines_each_predict_nothing() -> None:
    found, _ = calibrations(3)
    few = InstrumentConstant(
        found.instrument, found.calibrations[:6], (), None, None, None, found.calibrations[0].value
    )
    assert few.set_ups == 2
    assert not predictable(few)


def test_beyond_the_temperatures_of_the_determinations_the_interval_widens() -> None:
    found, facts = calibrations(1)
    halves = {}
    for degrees in (13.0, 19.0, 28.0, 36.0):
        told: dict[str, float | str] = {
            "elapsed_days": 25.0,
            "line": "L",
            "line_reading": 1.0,
            "temperature_c": degrees,
        }
        line = Wanted(StationLine("U", "V"), ((1.0, Circumstances.of(told)),))
        halves[degrees] = predict_constants(found, facts, [line]).lines[0].interval95
    # 10 to 17 C were seen; a coefficient that they leave open counts 11 and 19 K beyond
    assert halves[19.0] < 1.6 * halves[13.0]
    assert halves[28.0] > 1.5 * halves[13.0]
    assert halves[36.0] > halves[28.0] + 0.4 * (halves[28.0] - halves[13.0])
