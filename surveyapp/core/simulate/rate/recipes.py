"""Simulated logs of rate sensors by the kind that the command line names, as small projects."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from surveyapp.core.simulate.rate.disturbed import (
    NODES_C,
    disturbed,
    sizes_of,
    struck,
    switched_field,
)
from surveyapp.core.simulate.rate.effect_kinds import (
    FOG_EFFECTS,
    HAND_EFFECTS,
    INDEXING_EFFECTS,
    STATIC_EFFECTS,
    TABLE_EFFECTS,
    VEHICLE_EFFECTS,
)
from surveyapp.core.simulate.rate.indexing import IndexingRun, indexing_log, indexing_sets
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.core.simulate.rate.table_programmes import (
    DEG_H,
    FogStationRun,
    ImuOnTable,
    TableRun,
    fog_station_log,
    six_position_log,
    temperature_log,
)
from surveyapp.core.simulate.rate.vehicle import (
    HandRun,
    VehicleRun,
    hand_held_log,
    usual_drive,
    vehicle_log,
)
from surveyapp.core.simulate.specification import Effect, EffectKind
from surveyapp.errors import Problem, SurveyError
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.fog_station import FogOnTelescope
from surveyapp_models.rate.triad import Triad
from surveyapp_models.rate.turntable import Table

LATITUDE: Final = math.radians(45.77)
"""Of source 003."""


def example_unit(sizes: Mapping[str, float], run: TableRun) -> ImuOnTable:
    """A fibre-optic unit with errors of a usual size, and the effects that are asked for."""
    g = np.zeros((3, 3))
    g[0, 1], g[2, 0] = sizes.get("g_sensitivity", 0.0), 0.5 * sizes.get("g_sensitivity", 0.0)
    gyro = Triad(
        scale=np.array([300e-6, -200e-6, 500e-6]),
        misalignment=np.array([[0.0, 200.0, -100.0], [50.0, 0.0, 80.0], [-30.0, 60.0, 0.0]])
        * ARCSEC,
        bias=np.array([5.0, -3.0, 2.0]) * DEG_H,
        g_sensitivity=g,
        asymmetry=np.full(3, sizes.get("scale_asymmetry", 0.0)),
        noise=2.0 * DEG_H,
    )
    accelerometer = Triad(
        scale=np.array([1e-3, -5e-4, 2e-3]),
        misalignment=np.array([[0.0, 100.0, -200.0], [300.0, 0.0, 80.0], [-30.0, 60.0, 0.0]])
        * ARCSEC,
        bias=np.array([0.05, -0.03, 0.02]),
        noise=0.01,
    )
    return ImuOnTable(
        gyro,
        accelerometer,
        Table(LATITUDE, azimuth=2.39, tilt_along=math.radians(0.3)),
        replace(run, rate_error=sizes.get("rate_error", 0.0)),
        flip_sigma=sizes.get("flip_error", 0.0),
        warm_up_s=120.0,
        drift=sizes.get("bias_ramp", 0.0),
    )


def _six_positions(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    sizes = sizes_of(effects)
    log = six_position_log(example_unit(sizes, TableRun(turns=4.0, interval_s=0.1)), rng)
    return disturbed(log, effects, rng)


def _temperature(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    unit = example_unit(sizes_of(effects), TableRun(turns=2.0, interval_s=0.1, pause_s=2.0))
    unit = replace(unit, warm_up_s=10.0, static_s=10.0, table=Table(LATITUDE, azimuth=0.7))

    def at(node: float) -> tuple[Triad, Triad]:
        t = (node - 20.0) / 30.0
        bias = unit.gyro.bias + np.array([3.0, -2.0, 1.0]) * DEG_H * (t + 0.4 * t**2 - 0.2 * t**3)
        force = unit.accelerometer.bias + np.array([0.01, 0.02, -0.01]) * t
        return replace(unit.gyro, bias=bias), replace(unit.accelerometer, bias=force)

    return struck(temperature_log(unit, rng, nodes_c=NODES_C, at=at), effects, rng)


def _static(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    """Half an hour at rest at 10 Hz, a fluxgate beside the gyros in a field that is switched."""
    sizes = sizes_of(effects)
    time: Floats = (np.arange(18_000.0) + 0.5) * 0.1
    unit = example_unit({}, TableRun())
    forces = np.tile([0.2, -0.1, 9.80], (time.size, 1))
    rates = unit.gyro.output(np.zeros((time.size, 3)), forces=forces, rng=rng)
    columns: dict[str, Floats] = {"time_s": time}
    columns |= {
        f"gyr_{a}_rad_s": rates[:, i] + sizes.get("bias_ramp", 0.0) * time
        for i, a in enumerate("xyz")
    }
    shown = forces + rng.normal(0.0, 0.01, forces.shape)
    columns |= {f"acc_{a}_m_s2": shown[:, i] for i, a in enumerate("xyz")}
    if "gross_error" in sizes:
        begin = rng.uniform(0.1, 0.9) * float(time[-1])
        struck = (time >= begin) & (time < begin + 60.0)
        columns["gyr_x_rad_s"] = columns["gyr_x_rad_s"] + sizes["gross_error"] * struck
    kept = [e for e in effects if e.id != "gross_error"]
    if "magnetic_sensitivity" not in sizes:
        columns |= switched_field(columns, 0.0, [f"gyr_{a}_rad_s" for a in "xyz"], rng)
    log = disturbed(SimulatedLog(columns, {}, {}), kept, rng)
    truth = {f"bias_{a}": float(unit.gyro.bias[i]) / DEG_H for i, a in enumerate("xyz")}
    return SimulatedLog(log.columns, log.texts, truth | {"effects": sizes})


def _fog_station(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    sizes = sizes_of(effects)
    fog = FogOnTelescope(
        constant=math.radians(171.0 + 7.0 / 60.0 + 49.0 / 3600.0),
        scale=sizes.get("scale_factor", 0.0),
        bias=1.0 * DEG_H,
        noise=0.05 * DEG_H * math.sqrt(1000.0),
    )
    run = TableRun(
        rate=math.radians(120.0),
        turns=4.0,
        interval_s=0.01,
        pause_s=1.0,
        ramp_s=0.5,
        rate_error=sizes.get("rate_error", 0.0),
    )
    reading = fog.constant - 23761.0 * ARCSEC
    spec = FogStationRun(fog, Table(math.radians(34.0)), run, reading, sets=8, passes=2)
    log = fog_station_log(spec, rng)
    columns = dict(log.columns)
    drift = sizes.get("bias_ramp", 0.0) * columns["time_s"]
    struck = (columns["set"] == 3.0) & (columns["table_rate_deg_s"] > 0.0)
    off = sizes.get("gross_error", 0.0) * struck
    columns["gyr_x_rad_s"] = columns["gyr_x_rad_s"] + drift + off
    kept = [e for e in effects if e.id in ("temperature", "interference_line")]
    log = disturbed(SimulatedLog(columns, log.texts, log.truth), kept, rng)
    return SimulatedLog(log.columns, log.texts, dict(log.truth) | {"effects": sizes})


def _indexing_unit(sizes: Mapping[str, float], rng: np.random.Generator) -> IndexingRun:
    g = np.zeros((3, 3))
    g[0, 1], g[2, 0] = sizes.get("g_sensitivity", 0.0), 0.5 * sizes.get("g_sensitivity", 0.0)
    return IndexingRun(
        latitude=math.radians(35.0),
        heading=rng.uniform(0.0, 2.0 * math.pi),
        pitch=math.radians(6.0),
        roll=math.radians(-3.0),
        gyro=Triad(
            bias=rng.normal(0.0, 5.0, 3) * DEG_H,
            noise=0.05 * DEG_H * math.sqrt(600.0),
            g_sensitivity=g,
        ),
        accelerometer=Triad(bias=np.array([0.01, -0.02, 0.0]), noise=0.01),
        index_error=sizes.get("index_error", 0.0),
    )


def _indexing(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    sizes = sizes_of(effects)
    log = indexing_log(_indexing_unit(sizes, rng), rng)
    return SimulatedLog(log.columns, log.texts, dict(log.truth) | {"effects": sizes})


def _indexing_stops(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    """Six stops of a vehicle; at the third the index axis is level and points east-west."""
    sizes = sizes_of(effects)
    first = _indexing_unit(sizes, rng)
    bias = first.gyro.bias
    runs = []
    for k in range(6):
        bias = bias + rng.normal(0.0, 0.02, 3) * DEG_H
        if k == 1:
            bias = bias + np.array([sizes.get("bias_step", 0.0), 0.0, 0.0])
        bad = k == 2
        runs.append(
            replace(
                first,
                heading=math.radians(90.0) if bad else rng.uniform(0.0, 2.0 * math.pi),
                pitch=math.radians(89.0) if bad else math.radians(rng.uniform(-8.0, 8.0)),
                gyro=replace(first.gyro, bias=bias),
            )
        )
    log = indexing_sets(runs, rng, every_s=1200.0)
    return SimulatedLog(log.columns, log.texts, dict(log.truth) | {"effects": sizes})


def _vehicle(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    sizes = sizes_of(effects)
    noise = sizes.get("noise", 1.0)
    cycle = sizes.get("power_cycle")
    run = VehicleRun(
        legs=usual_drive(),
        heading=math.radians(30.0),
        gyro=Triad(
            bias=np.array([0.002, -0.001, 0.0015 + sizes.get("gyro_drift", 0.0)]),
            noise=0.001 * noise,
        ),
        accelerometer=Triad(noise=0.02 * noise),
        shake=0.15 * noise,
        power_cycle_after=None if cycle is None else round(cycle),
    )
    log = vehicle_log(run, rng)
    return SimulatedLog(log.columns, log.texts, dict(log.truth) | {"effects": sizes})


def hand_run(sizes: Mapping[str, float], rng: np.random.Generator) -> HandRun:
    """A micro-mechanical unit with the effects that are asked for."""
    stops = round(sizes.get("stops", 18.0))
    sensitivity = rng.normal(0.0, 1.0, (3, 3)) * sizes.get("g_sensitivity", 0.0) * 9.80665
    seconds = stops * 6.0 - 2.0
    return HandRun(
        gyro=Triad(
            scale=np.array([0.01, -0.008, 0.005]),
            misalignment=np.array([[0.0, 0.01, -0.006], [0.004, 0.0, 0.02], [-0.01, 0.005, 0.0]]),
            bias=np.radians([0.3, -0.5, 0.2]),
            g_sensitivity=sensitivity,
            asymmetry=np.full(3, sizes.get("scale_asymmetry", 0.0)),
            noise=math.radians(0.05),
        ),
        accelerometer=Triad(
            scale=np.array([2e-3, -5e-3, 1e-3]),
            misalignment=np.array([[0.0] * 3, [3e-3, 0.0, 0.0], [5e-3, -4e-3, 0.0]]),
            bias=np.array([0.05, -0.08, 0.03]),
            noise=0.01,
        ),
        stops=stops,
        ramp=sizes.get("bias_ramp", 0.0) / seconds,
        temperature=sizes.get("temperature", 0.0),
        walk=math.radians(0.006),
        random_walk=sizes.get("random_walk", 0.0),
        gross=sizes.get("gross_error", 0.0),
    )


def _hand_held(effects: Sequence[Effect], rng: np.random.Generator) -> SimulatedLog:
    sizes = sizes_of(effects)
    log = hand_held_log(hand_run(sizes, rng), rng)
    return SimulatedLog(log.columns, log.texts, dict(log.truth) | {"effects": sizes})


Recipe = Callable[[Sequence[Effect], np.random.Generator], SimulatedLog]

PROGRAMMES: Final[Mapping[str, Mapping[str, tuple[Recipe, tuple[EffectKind, ...]]]]] = {
    "rate": {
        "six-position": (_six_positions, TABLE_EFFECTS),
        "temperature": (
            _temperature,
            tuple(e for e in TABLE_EFFECTS if e.id not in ("temperature", "bias_ramp")),
        ),
        "static": (_static, STATIC_EFFECTS),
        "multi-position": (_hand_held, HAND_EFFECTS),
    },
    "fog-station": {"": (_fog_station, FOG_EFFECTS)},
    "indexing": {
        "one-stop": (_indexing, INDEXING_EFFECTS[:2]),
        "several-stops": (_indexing_stops, INDEXING_EFFECTS),
    },
    "vehicle": {"": (_vehicle, VEHICLE_EFFECTS)},
}
"""Kind of log to its programmes, the first one the default, and the effects that each knows."""

_ENTRY_KEYS: Final[Mapping[str, str]] = {
    "indexing": 'method = "indexing"\n',
    "fog-station": 'reading_from_elevation = "increases"\n',
    "vehicle": 'programme = "motion"\npath = true\n',
}


def effects_of(kind: str, programme: str | None) -> tuple[EffectKind, ...]:
    """The effects that a programme knows.

    Raises
    ------
    SurveyError
        If there is no such programme.
    """
    return _chosen(kind, programme)[1][1]


def _chosen(kind: str, programme: str | None) -> tuple[str, tuple[Recipe, tuple[EffectKind, ...]]]:
    known = PROGRAMMES[kind]
    name = next(iter(known)) if programme is None else programme
    if name not in known:
        expected = " or ".join(known) or "no programme"
        raise SurveyError(Problem("there is no such programme", "programme", name, expected))
    return name, known[name]


def simulate_rate(
    kind: str, programme: str | None, *, effects: Sequence[Effect], rng: np.random.Generator
) -> tuple[dict[str, str], dict[str, Any]]:
    """A project with one sensor log, and the truth.

    Parameters
    ----------
    kind : str
        A key of ``PROGRAMMES``.
    programme : str or None
        None = the first.
    effects : sequence of Effect
    rng : Generator

    Returns
    -------
    files : dict
        Relative path to text.
    truth : dict
    """
    name, (recipe, _) = _chosen(kind, programme)
    log = recipe(effects, rng)
    identity = name or kind
    lines = [
        "format = 1",
        f'name = "Simulated {identity}, not observed"',
        "",
        "[[sensor_log]]",
        f'id = "{identity}"',
        f'kind = "{"rate" if kind != "fog-station" else kind}"',
        f'file = "sensors/{identity}.csv"',
    ]
    if name and kind == "rate" and name != "static":
        lines.append(f'programme = "{name}"')
    latitude = log.truth.get("latitude_deg", math.degrees(LATITUDE))
    if kind != "fog-station":
        lines.append(f"latitude_deg = {latitude}")
    project = "\n".join(lines) + "\n" + _ENTRY_KEYS.get(kind, "")
    files = {"project.toml": project, f"sensors/{identity}.csv": log.csv()}
    return files, {"kind": kind, "programme": name, "simulated": True, **log.truth}
