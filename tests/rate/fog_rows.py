"""Rows that a gyro on a telescope gives at the four positions."""

from __future__ import annotations

import math

import numpy as np

from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp_models.rate.fog_station import FogOnTelescope


def fog_north_rows(
    fog: FogOnTelescope,
    *,
    north: float,
    latitude: float,
    readings: tuple[tuple[float, float, bool], ...],
    rng: np.random.Generator | None,
) -> SimulatedLog:
    """Rows of the four positions: (alidade reading, vertical reading, plunged) [rad].

    The alidade's circle reads ``north`` in the direction of astronomic north.
    """
    rates = []
    for alidade, vertical, _ in readings:
        rate = fog.at_rest(reading=vertical, alidade_azimuth=alidade - north, latitude=latitude)
        rates.append(float(fog.output(np.array([rate]), rng)[0]))
    columns = {
        "time_s": np.arange(len(readings)) * 120.0,
        "gyr_x_rad_s": np.array(rates),
        "horizontal_circle_deg": np.rad2deg([r[0] for r in readings]) % 360.0,
        "vertical_circle_deg": np.rad2deg([r[1] for r in readings]) % 360.0,
    }
    faces = ["R" if r[2] else "L" for r in readings]
    return SimulatedLog(columns, {"face": faces}, {"north_deg": math.degrees(north)})
