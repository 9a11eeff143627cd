"""Which parameters of hand-held stops count as determined: what the rule does to simulated records.

The rule is that of ``core/sensors/rate/needed``: half the 95 % interval against a stated tolerance.
For each number of stops, turned about any axis or about one axis only, ``SURVEYAPP_BENCH_RUNS``
records (40), each of a unit drawn from the tolerances (half widths of 95 %): the share of
parameters that are given, the share of these that are off by more than the tolerance (at most .05
by the rule), the share whose interval holds the truth.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bench._stored import stored
from bench.rate import as_read
from surveyapp.core.sensors.rate.multi_position_log import (
    MultiPositionOptions,
    calibrate_multi_position,
)
from surveyapp.core.sensors.rate.needed import (
    CROSS_TOLERANCE,
    SCALE_TOLERANCE,
    ZERO_TOLERANCE,
    tolerance_of,
)
from surveyapp.core.simulate.rate.recipes import hand_run
from surveyapp.core.simulate.rate.vehicle import HandRun, hand_held_log
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "40"))
STOPS = (5, 6, 7, 8, 10, 12, 18)


def drawn(run: HandRun, rng: np.random.Generator) -> HandRun:
    """The run with a unit of errors as large as makers leave open."""

    def some(half: float, *shape: int) -> Floats:
        return rng.normal(0.0, half / NORMAL_95, shape)

    gyro = replace(
        run.gyro,
        scale=some(SCALE_TOLERANCE, 3),
        misalignment=some(CROSS_TOLERANCE, 3, 3) * (1.0 - np.eye(3)),
    )
    accelerometer = replace(
        run.accelerometer,
        bias=some(ZERO_TOLERANCE, 3),
        scale=some(SCALE_TOLERANCE, 3),
        misalignment=some(CROSS_TOLERANCE, 3, 3) * np.tri(3, k=-1),
    )
    return replace(run, gyro=gyro, accelerometer=accelerometer)


def counts(stops: int, *, one_axis: bool, runs: int) -> list[int]:
    """Parameters, given ones, ones off by more than the tolerance, intervals that hold."""
    found = np.zeros(4, dtype=np.int64)
    for k in range(runs):
        rng = np.random.default_rng([9, stops, k, int(one_axis)])
        run = replace(hand_run({"stops": float(stops)}, rng), interval_s=0.04, warmth=0.0)
        run = drawn(run, rng)
        log = hand_held_log(replace(run, one_axis=one_axis), rng)
        try:
            result = calibrate_multi_position(as_read(log), MultiPositionOptions(run.latitude))
        except SurveyError:
            continue
        for item in result.parameters:
            limit = tolerance_of(item.name)
            if limit is None:
                continue
            found[0] += 1
            if item.value is None or item.sigma is None:
                continue
            off = abs(item.value - float(str(log.truth[item.name])))
            found[1:] += [1, off > limit, off <= NORMAL_95 * item.sigma]
    return found.tolist()


def run() -> Iterator[str]:
    """Every number of stops."""
    for one_axis in (False, True):
        about = "one axis" if one_axis else "any axis"
        for stops in STOPS:
            total, given, wrong, held = stored(
                f"rate_rank {about} {stops}",
                RUNS,
                lambda stops=stops, one_axis=one_axis: counts(stops, one_axis=one_axis, runs=RUNS),  # type: ignore[misc]
            )
            yield (
                f"{stops} stops about {about}: given {given / max(total, 1):.2f}, off by more than "
                f"the tolerance {wrong / max(given, 1):.3f}, held {held / max(given, 1):.2f}"
            )
