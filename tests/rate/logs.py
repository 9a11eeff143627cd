"""Simulated logs as the program reads them, without a file between."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.table_programmes import DEG_H, FogStationRun, TableRun
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.fog_station import FogOnTelescope
from surveyapp_models.rate.turntable import Table

PUBLISHED_READING = math.radians(164.0 + 31.0 / 60.0 + 48.0 / 3600.0)
PUBLISHED_ELEVATION = 23761.0 * ARCSEC
PUBLISHED_CONSTANT = math.radians(171.0 + 7.0 / 60.0 + 49.0 / 3600.0)
SAMPLE_NOISE = 0.05 * DEG_H * math.sqrt(1000.0)
"""Of a gyro of 0.05 deg/h over 10 s, sampled at 100 Hz (equation 13 of source 001)."""


def as_read(log: SimulatedLog, *, without: Sequence[str] = ()) -> SensorLog:
    """The log as a file of it would be read."""
    columns = {k: np.asarray(v) for k, v in log.columns.items() if k not in without}
    time = columns["time_s"]
    return SensorLog(
        id="log",
        columns=columns,
        units=dict.fromkeys(columns, "1"),
        size=time.size,
        texts={k: tuple(v) for k, v in log.texts.items()},
        rate_hz=1.0 / float(np.median(np.diff(time))) if time.size > 1 else None,
        path="log.csv",
    )


def part_of(log: SimulatedLog, rows: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> SimulatedLog:
    """Some rows of a log."""
    columns: dict[str, Floats] = {k: v[rows] for k, v in log.columns.items()}
    texts = {k: [w for w, keep in zip(v, rows, strict=True) if keep] for k, v in log.texts.items()}
    return SimulatedLog(columns, texts, log.truth)


def published_run(*, rate_error: float = 0.0, scale: float = 0.0, passes: int = 1) -> FogStationRun:
    """The experiment of source 001: 20 repeats at 120 deg/s, 1200 samples each way."""
    fog = FogOnTelescope(
        constant=PUBLISHED_CONSTANT, bias=1.0 * DEG_H, noise=SAMPLE_NOISE, scale=scale
    )
    run = TableRun(
        rate=math.radians(120.0),
        turns=4.0,
        interval_s=0.01,
        pause_s=0.5,
        ramp_s=0.5,
        rate_error=rate_error,
    )
    table = Table(math.radians(34.0), azimuth=1.0, tilt_along=0.0)
    return FogStationRun(fog, table, run, PUBLISHED_READING, sets=20, passes=passes)
