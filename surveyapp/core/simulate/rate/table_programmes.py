"""Logs of a rate table: six positions, positions over temperature, a gyro on a total station."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from surveyapp.core.simulate.rate.log import SimulatedLog, joined
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.fog_station import FogOnTelescope
from surveyapp_models.rate.triad import Triad
from surveyapp_models.rate.turntable import POSITIONS, Table, profile, seat, trapezoid

DEG_H = math.radians(1.0) / 3600.0
"""One degree per hour [rad/s]."""


@dataclass(frozen=True, slots=True)
class TableRun:
    """How the table is turned in each position.

    Parameters
    ----------
    rate : float
        [rad/s]
    turns : float
    interval_s : float
    pause_s, ramp_s : float
    rate_error : float
        Relative standard deviation of the table's rate, drawn anew for each way.
    """

    rate: float = math.radians(20.0)
    turns: float = 10.0
    interval_s: float = 0.05
    pause_s: float = 5.0
    ramp_s: float = 1.0
    rate_error: float = 0.0

    def rates(self) -> Floats:
        """Nominal rates clockwise, then anticlockwise, shape (n,) [rad/s]."""
        turning = self.turns * 2.0 * math.pi / self.rate
        one = trapezoid(
            self.rate,
            turning_s=turning,
            ramp_s=self.ramp_s,
            pause_s=self.pause_s,
            interval_s=self.interval_s,
        )
        return np.concatenate([one, -one])

    def true_rates(self, rng: np.random.Generator) -> Floats:
        """The same with the table's own errors."""
        nominal = self.rates()
        half = nominal.size // 2
        factors = 1.0 + self.rate_error * rng.normal(size=2)
        return np.concatenate([nominal[:half] * factors[0], nominal[half:] * factors[1]])


@dataclass(frozen=True, slots=True)
class ImuOnTable:
    """A unit on a table.

    Parameters
    ----------
    gyro, accelerometer : Triad
    table : Table
    run : TableRun
    flip_sigma : float
        Standard deviation of the seating about each body axis [rad].
    warm_up_s, static_s : float
        Rest before the first position, and before each.
    drift : float
        Of each gyro's bias [rad/s per s].
    """

    gyro: Triad
    accelerometer: Triad
    table: Table
    run: TableRun = field(default_factory=TableRun)
    flip_sigma: float = 0.0
    warm_up_s: float = 60.0
    static_s: float = 30.0
    drift: float = 0.0


def six_position_log(
    unit: ImuOnTable, rng: np.random.Generator, *, positions: tuple[str, ...] = POSITIONS
) -> SimulatedLog:
    """Warm-up, then whole turns both ways in each position."""
    parts = []
    begin = 0.0
    for k, position in enumerate(positions):
        rest = unit.static_s + (unit.warm_up_s if k == 0 else 0.0)
        part = _one_position(unit, position, rng, begin_s=begin, rest_s=rest)
        begin = float(part.columns["time_s"][-1]) + unit.run.interval_s
        parts.append(part)
    return joined(parts, gyro_truth(unit.gyro) | accelerometer_truth(unit.accelerometer))


def wrapped_degrees(angles: Floats) -> Floats:
    """Angle in the middle of each interval [deg], 0 to 360."""
    return np.asarray(np.rad2deg(0.5 * (angles[:-1] + angles[1:])) % 360.0)


def _one_position(
    unit: ImuOnTable, position: str, rng: np.random.Generator, *, begin_s: float, rest_s: float
) -> SimulatedLog:
    dt = unit.run.interval_s
    idle = np.zeros(round(rest_s / dt))
    nominal = np.concatenate([idle, unit.run.rates()])
    true = np.concatenate([idle, unit.run.true_rates(rng)])
    flip = quaternions.to_matrix(
        quaternions.from_rotation_vector(rng.normal(0.0, 1.0, 3) * unit.flip_sigma)
    )
    angles = profile(true, interval_s=dt)
    rates, forces = unit.table.motion(angles, interval_s=dt, mount=seat(position) @ flip)
    time = begin_s + (np.arange(nominal.size) + 0.5) * dt
    gyro = unit.gyro.output(rates, forces=forces, rng=rng) + unit.drift * time[:, None]
    acc = unit.accelerometer.output(forces, rng=rng)
    columns: dict[str, Floats] = {"time_s": np.asarray(time, dtype=np.float64)}
    columns |= {f"gyr_{a}_rad_s": gyro[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": acc[:, i] for i, a in enumerate("xyz")}
    columns["table_rate_deg_s"] = np.rad2deg(nominal)
    columns["table_angle_deg"] = wrapped_degrees(angles)
    return SimulatedLog(columns, {"position": [position] * nominal.size})


def gyro_truth(gyro: Triad) -> dict[str, object]:
    """The parameters of a gyro triad under their names in ``calibrate``."""
    truth: dict[str, object] = {}
    for i, a in enumerate("xyz"):
        truth[f"scale_factor_{a}"] = float(gyro.scale[i]) * 1e6
        truth[f"bias_{a}"] = float(gyro.bias[i]) / DEG_H
        for j, b in enumerate("xyz"):
            if i != j:
                truth[f"misalignment_{a}{b}"] = float(gyro.misalignment[i, j]) / ARCSEC
    return truth


def accelerometer_truth(accelerometer: Triad) -> dict[str, object]:
    """The same of an accelerometer triad."""
    truth: dict[str, object] = {}
    for i, a in enumerate("xyz"):
        truth[f"accelerometer_scale_factor_{a}"] = float(accelerometer.scale[i]) * 1e6
        truth[f"accelerometer_bias_{a}"] = float(accelerometer.bias[i])
        for j, b in enumerate("xyz"):
            if i != j:
                angle = float(accelerometer.misalignment[i, j]) / ARCSEC
                truth[f"accelerometer_misalignment_{a}{b}"] = angle
    return truth


def temperature_log(
    unit: ImuOnTable,
    rng: np.random.Generator,
    *,
    nodes_c: tuple[float, ...],
    at: Callable[[float], tuple[Triad, Triad]],
) -> SimulatedLog:
    """Rates both ways and one position in three directions at each chamber temperature.

    Parameters
    ----------
    unit : ImuOnTable
    rng : Generator
    nodes_c : tuple of float
    at : callable
        Gyro and accelerometer triad at a temperature [C].
    """
    parts = []
    truth: dict[str, object] = {}
    begin = 0.0
    for node in nodes_c:
        gyro, accelerometer = at(node)
        here = replace(unit, gyro=gyro, accelerometer=accelerometer)
        part = six_position_log(here, rng, positions=("x+", "y+", "z+"))
        columns = dict(part.columns)
        columns["time_s"] = columns["time_s"] + begin
        begin = float(columns["time_s"][-1]) + unit.run.interval_s
        size = columns["time_s"].size
        columns["reference_temperature_c"] = np.full(size, node)
        columns["temperature_c"] = np.full(size, node + 4.0)
        parts.append(SimulatedLog(columns, part.texts))
        truth[f"{node:g}"] = part.truth
    return joined(parts, {"nodes": truth})


@dataclass(frozen=True, slots=True)
class FogStationRun:
    """Repeats of the constant on a table.

    Parameters
    ----------
    fog : FogOnTelescope
    table : Table
    run : TableRun
    reading : float
        Of the vertical circle in the first pass [rad].
    sets, passes : int
        The second pass sets the circle to what the first pass found, as the surveyor would.
    """

    fog: FogOnTelescope
    table: Table
    run: TableRun
    reading: float
    sets: int = 3
    passes: int = 1


def fog_station_log(spec: FogStationRun, rng: np.random.Generator) -> SimulatedLog:
    """Turns both ways of every set and pass."""
    parts = []
    begin = 0.0
    dt = spec.run.interval_s
    for number in range(1, spec.passes + 1):
        reading = spec.reading
        if number > 1:  # what a gyro of this scale error shows as level
            sine = (1.0 + spec.fog.scale) * math.sin(_elevation(spec.fog, spec.reading))
            sign = 1.0 if spec.fog.reading_increases else -1.0
            reading = spec.reading + sign * math.asin(sine)
        for index in range(1, spec.sets + 1):
            nominal, true = spec.run.rates(), spec.run.true_rates(rng)
            angles = profile(true, interval_s=dt, start=rng.uniform(0.0, 2.0 * math.pi))
            rates = spec.fog.on_table(spec.table, angles, reading=reading, interval_s=dt)
            size = nominal.size
            columns = {
                "time_s": begin + (np.arange(size) + 0.5) * dt,
                "gyr_x_rad_s": spec.fog.output(rates, rng),
                "table_rate_deg_s": np.rad2deg(nominal),
                "table_angle_deg": wrapped_degrees(angles),
                "vertical_circle_deg": np.full(size, math.degrees(reading)),
                "set": np.full(size, float(index)),
                "pass": np.full(size, float(number)),
            }
            begin = float(columns["time_s"][-1]) + 0.5 * dt
            parts.append(SimulatedLog(columns))
    truth: Mapping[str, object] = {
        "instrument_constant_deg": math.degrees(spec.fog.constant),
        "elevation_arcsec": _elevation(spec.fog, spec.reading) / ARCSEC,
        "scale_factor": spec.fog.scale * 1e6,
        "relative_rate_error": spec.run.rate_error,
        "rule": "increases" if spec.fog.reading_increases else "decreases",
    }
    return joined(parts, truth)


def _elevation(fog: FogOnTelescope, reading: float) -> float:
    return math.asin(float(fog.axis(reading)[2]))
