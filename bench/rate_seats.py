"""Crooked seats in every position of one round: how often they are found, and what beside them.

The level of ``surveyapp/diagnosis/crooked_seats.py`` against two others, over seats of several
sizes; then effects beside seats of 60", named or not. ``SURVEYAPP_BENCH_RUNS`` records a cell
(200).
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import replace
from unittest.mock import patch

import numpy as np

from bench.rate import as_read
from bench.rate_log_loop import SIZES
from surveyapp.core.simulate.rate.recipes import LATITUDE, PROGRAMMES
from surveyapp.core.simulate.specification import Effect
from surveyapp.diagnosis import crooked_seats
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.rate_stops import stops_of
from surveyapp.diagnosis.subjects.rate import seats_of
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.workflows import rate_case
from surveyapp_models.angles import ARCSEC

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
LEVELS = (0.05, 0.01, crooked_seats.ALARM)
SEATS = (0.0, 0.25, 0.5, 1.0, 60.0)
"""Arc-seconds: the noise of a stop is .25\" of the table's rate."""
BESIDE = ("", "scale_asymmetry", "temperature", "bias_ramp", "magnetic_sensitivity", "gross_error")


def _log(seed: int, arcsec: float, effect: str = "") -> SensorLog:
    rng = np.random.default_rng([seed, 9])
    effects = [Effect("flip_error", arcsec * ARCSEC)]
    effects += [Effect(effect, SIZES[effect])] if effect else []
    log = as_read(PROGRAMMES["rate"]["six-position"][0](effects, rng))
    return replace(log, path="log")


def found_at(arcsec: float) -> list[float]:
    """Share of records with seats at each level."""
    counts = np.zeros(len(LEVELS))
    for seed in range(RUNS):
        stops, _, _ = stops_of(_log(seed, arcsec), latitude=LATITUDE)
        for k, level in enumerate(LEVELS):
            with patch.object(crooked_seats, "ALARM", level):
                counts[k] += seats_of(stops) is not None
    return [float(c) for c in counts / RUNS]


def named_beside(effect: str) -> list[float]:
    """Shares of records with the seats and the effect named, and with a wrong name."""
    right = wrong = 0
    entry = SensorLogEntry("log", "rate", "", latitude_deg=math.degrees(LATITUDE))
    wanted = {"flip_error", effect} - {""}
    for seed in range(RUNS):
        made = rate_case.case_of_log(_log(seed, 60.0, effect), entry)
        found = diagnose(made.case, advise=False)
        if made.finished is not None:
            found, _ = made.finished(found)
        names = {a.effect for a in found.adopted}
        right += names == wanted
        wrong += bool(names - wanted)
    return [right / RUNS, wrong / RUNS]


def run() -> Iterator[str]:
    """Both tables."""
    yield f"{RUNS} records a cell: seats found at levels {', '.join(f'{x:g}' for x in LEVELS)}"
    for arcsec in SEATS:
        yield f'  {arcsec:g}": {" / ".join(f"{s:.3f}" for s in found_at(arcsec))}'
    yield 'beside seats of 60": rightly / wrongly named'
    for effect in BESIDE:
        yield f"  {effect or 'nothing'}: {' / '.join(f'{s:.2f}' for s in named_beside(effect))}"
