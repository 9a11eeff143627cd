"""Figures of rate.md for calibrating rate sensors, beside what the program reaches.

The published experiment and its scatter, scale errors and part turns of a gyro on a total station,
north with its constant, flips in six positions, compensation over temperature, the grey model,
families of interference lines. The table of docs/explanation/rate-sensors.md.
``SURVEYAPP_BENCH_RUNS`` scales the numbers of records (1 = those of the reference),
``SURVEYAPP_BENCH_PARTS`` names some of the parts.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.rate import as_read
from surveyapp.core.sensors.rate.compensation import (
    ModelName,
    chosen_model,
    compare_models,
    fitted,
    grey_model,
    ratios_admissible,
)
from surveyapp.core.sensors.rate.fog_north import Position, solve_north
from surveyapp.core.sensors.rate.fog_station_log import calibrate_fog_station
from surveyapp.core.sensors.rate.six_position_log import (
    SixPositionOptions,
    calibrate_six_positions,
)
from surveyapp.core.simulate.rate.recipes import example_unit
from surveyapp.core.simulate.rate.table_programmes import (
    DEG_H,
    FogStationRun,
    TableRun,
    fog_station_log,
    six_position_log,
)
from surveyapp.diagnosis.long_records.families import strongest_family
from surveyapp.diagnosis.long_records.interference import find_interference, scatter_of
from surveyapp.diagnosis.long_records.lines import detrended
from surveyapp.diagnosis.long_records.spectrum import spectrum
from surveyapp.domain.calibration import Calibration
from surveyapp_models.angles import ARCSEC, wrap_pi
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.fog_station import FogOnTelescope
from surveyapp_models.rate.turntable import Table

SCALE = float(os.environ.get("SURVEYAPP_BENCH_RUNS", "1"))
READING = math.radians(164.0 + 31.0 / 60.0 + 48.0 / 3600.0)
ELEVATION = 23761.0 * ARCSEC
RATE_HZ = 100.0
NODES_C = np.array([-10.0, 5.0, 20.0, 30.0, 40.0])
INNER_C = np.linspace(-10.0, 40.0, 101)


def runs(of_reference: int) -> int:
    """Records of a figure."""
    return max(round(of_reference * SCALE), 2)


def experiment(
    *, error: float = 0.0, scale: float = 0.0, sets: int = 20, passes: int = 1, noise: bool = True
) -> FogStationRun:
    """The experiment of source 001: 120 deg/s, 1200 samples each way at 100 Hz."""
    fog = FogOnTelescope(
        constant=READING + ELEVATION,
        bias=1.0 * DEG_H,
        scale=scale,
        noise=0.05 * DEG_H * math.sqrt(1000.0) if noise else 0.0,
    )
    run = TableRun(
        rate=math.radians(120.0), turns=4.0, interval_s=0.01, pause_s=0.5, ramp_s=0.5,
        rate_error=error,
    )  # fmt: skip
    table = Table(math.radians(34.0), azimuth=1.0)
    return FogStationRun(fog, table, run, READING, sets=sets, passes=passes)


def constant(spec: FogStationRun, seed: int, relative: float) -> Calibration:
    """What the program makes of one log of it."""
    log = fog_station_log(spec, np.random.default_rng(seed))
    return calibrate_fog_station(
        as_read(log), rule="increases", relative_rate_sigma=relative, problems=[]
    )


def scatter() -> Iterator[str]:
    """Repeats against equation 15, and the published scatter undeclared."""
    count = runs(40)
    for error in (0.0, 4.2e-5, 1e-4, 2.84e-4):
        spec = experiment(error=error)
        found = [constant(spec, k, error).extra["scatter"] for k in range(count)]
        model = float(np.mean([f["model_sd_arcsec"] for f in found]))
        shown = math.sqrt(float(np.mean([f["sd_arcsec"] ** 2 for f in found])))
        yield f'  rate error {error:g}: model {model:.3f}", simulated {shown:.3f}"'
    hidden = [constant(spec, k, 4.2e-5).extra["scatter"] for k in range(count)]
    small = sum(f["p"] < 0.001 for f in hidden)
    needed = float(np.median([f["relative_rate_error_needed"] for f in hidden]))
    yield f"  2.84e-4 undeclared: p < .001 in {small} of {count}; error needed {needed:.3g}"


def two_passes() -> Iterator[str]:
    """A scale error in the first pass, and what two passes leave; then with the table's error."""
    for scale, error in ((1e-4, 0.0), (1e-3, 0.0), (1e-3, 4.2e-5)):
        spec = experiment(scale=scale, error=error, sets=3, passes=2)
        rows: list[tuple[float, float, float]] = []
        for k in range(runs(40)):
            found = constant(spec, k, 0.0)
            by_pass = [[s for s in found.extra["sets"] if s["pass"] == number] for number in (1, 2)]
            off = [float(np.mean([s["instrument_constant_deg"] for s in part])) for part in by_pass]
            truth = math.degrees(spec.fog.constant)
            ppm = found.value("scale_factor") or 0.0
            first, second = (3600.0 * (v - truth) for v in off)
            rows.append((first, second, ppm * 1e-6 - scale))
        first, second, left = np.mean(rows, axis=0).tolist()
        sd = float(np.std([r[1] for r in rows], ddof=1))
        spread = float(np.std([r[2] for r in rows], ddof=1))
        yield (
            f'  scale error {scale:g}, rate error {error:g}: first pass off {first:.2f}", '
            f'second {second:.3f}" (sd {sd:.3f}"); scale factor off {left:.1e}, sd {spread:.1e}'
        )


def part_turns() -> Iterator[str]:
    """1.67 turns at 10 deg/s, the way back from another azimuth: whole turns, and all samples."""
    used, every = [], []
    spec = experiment(sets=1, noise=False)
    run = replace(
        spec.run, rate=math.radians(10.0), turns=1.67, interval_s=0.05, pause_s=1.0, ramp_s=0.5
    )
    for azimuth in np.arange(0.0, 360.0, 20.0):
        table = replace(spec.table, azimuth=math.radians(float(azimuth)))
        here = replace(spec, run=run, table=table)
        there, back = (fog_station_log(here, np.random.default_rng(k)) for k in (3, 4))
        first = there.columns["time_s"] < 0.5 * there.columns["time_s"][-1]
        columns = {k: np.where(first, v, back.columns[k]) for k, v in there.columns.items()}
        found = calibrate_fog_station(
            as_read(replace(there, columns=columns)),
            rule="increases",
            relative_rate_sigma=0.0,
            problems=[],
        )
        used.append((found.value("elevation") or 0.0) - 23761.0)
        rate, shown = columns["table_rate_deg_s"], columns["gyr_x_rad_s"]
        means = [float(shown[np.isclose(rate, r)].mean()) for r in (10.0, -10.0)]
        sine = (means[1] - means[0]) / (2.0 * math.radians(10.0))
        every.append(math.asin(sine) / ARCSEC - 23761.0)
    worst = [float(np.abs(v).max()) for v in (used, every)]
    yield f'  whole turns used: {worst[0]:.2f}" at most; all samples: {worst[1]:.1f}"'


def norths() -> Iterator[str]:
    """Four positions, and two with the constant, from the direct equation of rate.md."""
    rng = np.random.default_rng(3)
    sigma = 0.05 * DEG_H
    for degrees in (0.0, 35.0, 60.0, -35.0):
        latitude, off = math.radians(degrees), {4: [], 2: []}  # type: ignore[var-annotated]
        for _ in range(runs(300)):
            north = rng.uniform(0.0, 2.0 * math.pi)
            for count, cells in off.items():
                tilt = rng.normal(0.0, 5.0 * ARCSEC) if count == 2 else 20.0 * ARCSEC
                rows = _positions(rng, north, latitude, tilt)[:count]
                found = solve_north(
                    rows,
                    latitude=latitude,
                    approximate_north=north + 0.05,
                    rate_sigma=sigma,
                    constant=READING if count == 2 else None,
                    constant_sigma=5.0 * ARCSEC,
                )
                cells.append(wrap_pi((found.north or 0.0) - north) / ARCSEC)
        theory = 0.05 / (2.0 * 15.0411 * math.cos(latitude)) / ARCSEC
        four, two = (math.sqrt(float(np.mean(np.square(off[k])))) for k in (4, 2))
        yield (
            f'  latitude {degrees:g}: four positions {four:.0f}" (theory {theory:.0f}"), '
            f'two {two:.0f}"'
        )


def _positions(
    rng: np.random.Generator, north: float, latitude: float, tilt: float
) -> list[Position]:
    """East and west, both faces, at the constant's reading: rate.md's direct rates."""
    rows = []
    level, vertical = 7.292115e-5 * math.cos(latitude), 7.292115e-5 * math.sin(latitude)
    collimation = 0.0
    for side in (0.5, 1.5):
        for plunged in (False, True):
            alidade = north + side * math.pi
            sign = -1.0 if plunged else 1.0
            turn = math.pi if plunged else 0.0
            azimuth = side * math.pi + turn + sign * collimation
            rate = level * math.cos(azimuth) * math.cos(tilt) + vertical * sign * math.sin(tilt)
            rate += 2.0 * DEG_H + rng.normal(0.0, 0.05 * DEG_H)
            rows.append(Position(rate, alidade, READING + turn, plunged))
    return rows


def flips() -> Iterator[str]:
    """Seating errors in six positions: misalignments, scale factors, biases."""
    unit = example_unit({}, TableRun(turns=2.0, interval_s=0.25, pause_s=1.0))
    unit = replace(unit, warm_up_s=10.0, static_s=20.0, gyro=replace(unit.gyro, noise=0.0))
    for degrees in (1.0 / 60.0, 0.5, 1.0):
        here = replace(unit, flip_sigma=math.radians(degrees))
        off: dict[str, list[float]] = {"E": [], "K": [], "own": [], "static": []}
        for seed in range(runs(20)):
            log = six_position_log(here, np.random.default_rng(seed))
            found = calibrate_six_positions(
                as_read(log), SixPositionOptions(flip_sigma=math.radians(degrees))
            )
            for item in found.parameters:
                error = (item.value or 0.0) - float(str(log.truth[item.name]))
                kind = {"m": "E", "s": "K", "b": "own"}[item.name[0]]
                off[kind].append(error)
            for item in found.extra["traditional"]["parameters"]:
                if item["name"].startswith("bias"):
                    off["static"].append(item["value"] - float(str(log.truth[item["name"]])))
        rms = {k: math.sqrt(float(np.mean(np.square(v)))) for k, v in off.items()}
        worst = {k: float(np.abs(v).max()) for k, v in off.items()}
        yield (
            f'  flips of {60.0 * degrees:.0f}\': E rms {rms["E"]:.0f}", worst {worst["E"]:.0f}"; '
            f"K rms {rms['K']:.1f}, worst {worst['K']:.0f} ppm; bias rms, own pair "
            f"{rms['own']:.4f}, static pair {rms['static']:.3f} deg/h"
        )


def curves(kind: str, rng: np.random.Generator) -> Callable[[Floats], Floats]:
    """A bias over the chamber's range [deg/h]: cubic, exponential, or with a kink."""
    a = rng.normal(0.0, 1.0, 4)
    if kind == "cubic":
        return lambda t: (
            2.0 * (a[0] + a[1] * _u(t) + 0.6 * a[2] * _u(t) ** 2 + 0.3 * a[3] * _u(t) ** 3)
        )
    if kind == "exponential":
        growth = rng.uniform(0.3, 1.2) * rng.choice([-1.0, 1.0])
        return lambda t: a[0] + 2.0 * a[1] * np.exp(growth * _u(t))
    at = rng.uniform(0.0, 30.0)
    return lambda t: a[0] + 2.0 * a[1] * _u(t) + 3.0 * a[2] * np.maximum(t - at, 0.0) / 25.0


def _u(t: Floats) -> Floats:
    return np.asarray((t - 15.0) / 25.0)


def temperatures() -> Iterator[str]:
    """Rms over the range of each model, and of the one that leaving a node out chooses.

    Three gyros a unit, as the program compares them.
    """
    names: Sequence[ModelName] = ("none", "linear", "piecewise_linear", "cubic", "grey")
    for kind in ("cubic", "exponential", "kink"):
        rng = np.random.default_rng(5)
        total: dict[str, float] = dict.fromkeys((*names, "chosen"), 0.0)
        count = runs(400)
        for _ in range(count):
            truths = [curves(kind, rng) for _ in range(3)]
            values = np.column_stack([t(NODES_C) for t in truths])
            values += rng.normal(0.0, 0.02, values.shape)
            best = chosen_model(compare_models(NODES_C, values))
            for name in names:
                square = 0.0
                for k, truth in enumerate(truths):
                    function = fitted(name, NODES_C, values[:, k])
                    shown = values[:, k].mean() if function is None else function(INNER_C)
                    square += float(np.mean(np.square(shown - truth(INNER_C)))) / 3.0
                total[name] += square
                total["chosen"] += square if name == best else 0.0
        cells = ", ".join(f"{k} {math.sqrt(v / count):.3f}" for k, v in total.items())
        yield f"  {kind}: {cells} deg/h"


def grey() -> Iterator[str]:
    """GM(1,1) on curves through zero: admissible or not, and whether it forecasts better.

    Eight temperatures; the last three are foretold from the first five, as sensors.md 2c has it, by
    the grey model and by a quadratic.
    """
    rng = np.random.default_rng(6)
    raw = shifted = 0
    better: dict[bool, list[bool]] = {True: [], False: []}
    count = runs(400)
    nodes = np.linspace(-10.0, 40.0, 8)
    for k in range(count):
        values = curves(("cubic", "exponential", "kink")[k % 3], rng)(nodes)
        values = values - values.mean() + rng.normal(0.0, 0.02, nodes.size)
        raw += ratios_admissible(values[:5])
        model = grey_model(nodes[:5], values[:5])
        if model is None:
            continue
        shifted += model.admissible
        quadratic = np.polynomial.Polynomial.fit(nodes[:5], values[:5], 2)
        rest = [float(np.mean((f(nodes[5:]) - values[5:]) ** 2)) for f in (model.at, quadratic)]
        better[model.admissible].append(rest[0] < rest[1])
    shares = {k: float(np.mean(v)) if v else math.nan for k, v in better.items()}
    yield (
        f"  of {count} curves through zero {raw} admissible as they stand, {shifted} shifted; "
        f"better than a quadratic in {shares[True]:.2f} of the admissible, "
        f"{shares[False]:.2f} of the others"
    )


def record(seed: int, amplitude: float, background: str, count: int = 6000) -> Floats:
    """A minute at 100 Hz with 12.48, 24.96 and 37.44 Hz, scaled to one."""
    rng = np.random.default_rng(seed)
    values = rng.normal(0.0, 1.0, count)
    if background != "white":
        shape = np.fft.rfft(values)
        f = np.fft.rfftfreq(count, 1.0 / RATE_HZ)
        gain = 1.0 / np.abs(1.0 - 0.7 * np.exp(-2j * np.pi * f / RATE_HZ))
        if background == "resonance":
            gain = np.sqrt(1.0 + 4.0 * np.exp(-(((f - 20.0) / 5.0) ** 2)))
        values = np.fft.irfft(shape * gain, count)
        values /= values.std()
    t = np.arange(count) / RATE_HZ
    for h in (1, 2, 3):
        values += amplitude * np.cos(2.0 * np.pi * 12.48 * h * t + rng.uniform(0.0, 6.28))
    return np.asarray(values)


def family_p(values: Floats) -> float:
    """Probability that noise has such a family."""
    u = np.arange(values.size) / values.size - 0.5
    found = strongest_family(spectrum(detrended(u, values), np.ones(values.size, dtype=bool)))
    return 1.0 if found is None else found[2]


def interference() -> Iterator[str]:
    """False alarms over three backgrounds, families found, and what removing them does."""
    count = runs(1500)
    for background in ("white", "red", "resonance"):
        p = np.array([family_p(record(k, 0.0, background)) for k in range(count)])
        yield (
            f"  {background}, {count} records: false alarms {np.mean(p <= 0.05):.3f} at .05, "
            f"{np.mean(p <= 0.01):.3f} at .01"
        )
    cells = []
    for amplitude in (0.2, 0.12, 0.08):
        p = np.array([family_p(record(k, amplitude, "white")) for k in range(runs(300))])
        cells.append(f"{np.mean(p <= 0.05):.2f} at {amplitude:g} sd")
    yield f"  a family of three lines is found: {', '.join(cells)}"
    values = record(5, 0.2, "red", 60_000)
    rest = find_interference(np.arange(values.size) / RATE_HZ, values).rest
    told = scatter_of(values, rest, rate_hz=RATE_HZ, unit="1")
    change = (told.after_10s or 0.0) / (told.before_10s or 1.0) - 1.0
    yield f"  removing it changes the scatter of 10 s means by {100.0 * change:+.1f} %"


PARTS: Mapping[str, Callable[[], Iterator[str]]] = {
    "scatter": scatter,
    "two_passes": two_passes,
    "part_turns": part_turns,
    "norths": norths,
    "flips": flips,
    "temperatures": temperatures,
    "grey": grey,
    "interference": interference,
}


def run() -> Iterator[str]:
    """Every figure, or those that SURVEYAPP_BENCH_PARTS names."""
    wanted = os.environ.get("SURVEYAPP_BENCH_PARTS", "").split()
    for name, part in PARTS.items():
        if not wanted or name in wanted:
            yield name.replace("_", " ")
            yield from part()
