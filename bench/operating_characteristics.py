"""Detection, naming, false alarms and coverage of the diagnosis, on runs it has never seen.

The runs come from an integrated equation of motion (the slow mode of a suspended gyro), not from
the columns that the engine fits. Writes docs/reference/operating-characteristics.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis import Diagnosis, Problem, TurningPoints, diagnose, reversal_run
from surveyapp_models.angles import ARCSEC

Array = NDArray[np.float64]
STEPS = 160
"""Runge-Kutta steps in a half swing."""


@dataclass(frozen=True)
class Truth:
    """What nature does in one line of the table; sizes in arc-seconds and half swings."""

    name: str
    size: int
    effect: str = ""
    drift: float = 0.0
    step: float = 0.0
    oscillation: float = 0.0
    warm_up: float = 0.0
    temperature: float = 0.0
    friction: float = 0.0
    drag: float = 0.0
    damping_change: float = 0.0
    gross: tuple[float, ...] = ()
    walk: float = 0.0
    ar1: float = 0.0
    noise: float = 4.0
    rounding: float = 0.1
    reference: tuple[float | None, float | None, float | None] = field(default=(None, None, None))


@dataclass(frozen=True)
class Runs:
    """Simulated turning points of many runs of one truth."""

    readings: Array
    temperature: Array
    north: Array


def simulate(truth: Truth, runs: int, seed: int) -> Runs:
    """Integrate a'' + 2 k a' + b a'|a'| + f sign(a') + pi^2 sin(a - N) = 0, read its turns."""
    g = np.random.default_rng(seed)
    n = truth.size
    first = np.radians(g.uniform(0.9, 1.1, runs)) * g.choice([-1.0, 1.0], runs)
    decay = g.uniform(0.012, 0.02, runs)
    north = midpoint(truth, runs, g)
    temperature = g.uniform(10.0, 25.0, (runs, 1)) + temperature_walk(n, runs, g)
    change = g.uniform(0.3, 0.6, runs) * n
    h = 1.0 / STEPS
    friction = truth.friction * ARCSEC * np.pi**2 / 2.0
    drag = 0.75 * truth.drag

    def field_at(t: float) -> Array:
        value = north(t)
        if truth.temperature:
            k = np.clip(t, 0.0, n + 1.0)
            low = int(k)
            part = k - low
            now = temperature[:, low] * (1.0 - part) + temperature[:, low + 1] * part
            value = value + truth.temperature * (now - temperature[:, :n].mean(axis=1))
        return value * ARCSEC

    def slope(t: float, a: Array, v: Array) -> tuple[Array, Array]:
        k = decay + truth.damping_change * (t > change)
        moment = np.pi**2 * np.sin(a - field_at(t))
        return v, -2.0 * k * v - drag * v * np.abs(v) - friction * np.tanh(v / 1e-6) - moment

    a, v, t = first + field_at(0.0), np.zeros(runs), 0.0
    turns = np.full((runs, n), np.nan)
    times = np.full((runs, n), np.nan)
    turns[:, 0], times[:, 0] = a, 0.0
    count = np.ones(runs, dtype=int)
    while count.min() < n:
        k1 = slope(t, a, v)
        k2 = slope(t + 0.5 * h, a + 0.5 * h * k1[0], v + 0.5 * h * k1[1])
        k3 = slope(t + 0.5 * h, a + 0.5 * h * k2[0], v + 0.5 * h * k2[1])
        k4 = slope(t + h, a + h * k3[0], v + h * k3[1])
        na = a + h / 6.0 * (k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0])
        nv = v + h / 6.0 * (k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1])
        turned = (v != 0.0) & (np.sign(nv) != np.sign(v)) & (count < n)
        for i in np.flatnonzero(turned):
            s = v[i] / (v[i] - nv[i])
            turns[i, count[i]] = a[i] + 0.5 * v[i] * s * h
            times[i, count[i]] = t + s * h
            count[i] += 1
        a, v, t = na, nv, t + h
    readings = turns / ARCSEC + truth.noise * noise_of(truth, runs, g)
    for size in truth.gross:
        at = np.array([g.integers(0, n) for _ in range(runs)])
        readings[np.arange(runs), at] += size * g.choice([-1.0, 1.0], runs)
    readings = np.round(readings / truth.rounding) * truth.rounding
    paths = np.stack([field_at(x) / ARCSEC for x in range(n)], axis=1)
    return Runs(readings * ARCSEC, temperature[:, :n], paths.mean(axis=1))


def temperature_walk(n: int, runs: int, g: np.random.Generator) -> Array:
    """Temperatures at whole half swings: 1 to 3 K more at the end, wandering by 0.25 K [K]."""
    trend = g.uniform(1.0, 3.0, (runs, 1)) * np.linspace(0.0, 1.0, n + 3)
    return trend + np.cumsum(0.25 * g.standard_normal((runs, n + 3)), axis=1)


def noise_of(truth: Truth, runs: int, g: np.random.Generator) -> Array:
    """White noise, or AR(1) of the same variance."""
    white = g.standard_normal((runs, truth.size))
    if not truth.ar1:
        return white
    for k in range(1, truth.size):
        white[:, k] = truth.ar1 * white[:, k - 1] + np.sqrt(1.0 - truth.ar1**2) * white[:, k]
    return white


def midpoint(truth: Truth, runs: int, g: np.random.Generator) -> Callable[[float], Array]:
    """North of each run [arcsec] as a function of time."""
    n = truth.size
    sign = g.choice([-1.0, 1.0], runs)
    when = g.uniform(0.25, 0.75, runs) * n
    period = g.uniform(0.3, 0.55, runs) * n
    phase = g.uniform(0.0, 2.0 * np.pi, runs)
    tau = g.uniform(2.0, 6.0, runs)
    walk = np.cumsum(truth.walk * g.standard_normal((runs, n + 3)), axis=1)

    def north(t: float) -> Array:
        value = truth.drift * t + truth.step * (t > when)
        value = value + truth.oscillation * np.cos(2.0 * np.pi * t / period + phase)
        value = value + truth.warm_up * np.exp(-t / tau)
        return np.asarray(sign * value + walk[:, min(int(t), n + 2)])

    return north


def problems(truth: Truth, runs: int, seed: int) -> tuple[list[Problem], Array]:
    """Problems of a line and the true north averaged over each run [rad]."""
    made = simulate(truth, runs, seed)
    with_temperature = truth.effect == "temperature"
    found = []
    for readings, temperature in zip(made.readings, made.temperature, strict=True):
        covariates = {"temperature_c": temperature} if with_temperature else {}
        points = TurningPoints(
            list(readings), covariates=covariates, resolution=truth.rounding * ARCSEC
        )
        found.append(reversal_run(points))
    return found, made.north * ARCSEC


@dataclass(frozen=True)
class Line:
    """Outcome of one line."""

    truth: Truth
    runs: int
    detected: float
    right: float
    wrong: float
    covered: float
    covered_base: float


def evaluate(truth: Truth, runs: int, seed: int, draws: int = 1000) -> tuple[Line, list[Diagnosis]]:
    """Diagnose every run of a line."""
    made, north = problems(truth, runs, seed)
    results = [diagnose(problem, draws=draws) for problem in made]
    names = [{item.effect for item in result.adopted} for result in results]
    expected = {truth.effect} - {""}
    detected = np.mean([result.verdict != "adequate" for result in results])
    right = np.mean([bool(expected) and expected <= found for found in names])
    wrong = np.mean([bool(found - expected) for found in names])

    def inside(value: float, half: float | None, true: float) -> bool:
        return abs(np.angle(np.exp(1j * (value - true)))) <= (half or 0.0)

    pairs = list(zip(results, north, strict=True))
    covered = np.mean([inside(r.averaged.value, r.averaged.interval95, t) for r, t in pairs])
    base = np.mean([inside(r.before.value.value, r.before.value.interval95, t) for r, t in pairs])
    line = Line(
        truth, runs, float(detected), float(right), float(wrong), float(covered), float(base)
    )
    return line, results


REFERENCE = (
    Truth("none", 8, reference=(0.06, None, None)),
    Truth("none", 12, reference=(0.06, None, None)),
    Truth("none", 20, reference=(0.06, None, None)),
    Truth("none", 45, reference=(0.06, None, None)),
    Truth("none, read to 10 arcsec", 8, rounding=10.0, reference=(0.17, None, None)),
    Truth("none, read to 10 arcsec", 12, rounding=10.0, reference=(0.06, None, None)),
    Truth("drift 1", 20, "midpoint_drift", drift=1.0, reference=(1.0, 0.54, 0.04)),
    Truth("drift 1", 45, "midpoint_drift", drift=1.0, reference=(1.0, 1.0, 0.0)),
    Truth("drift 2", 20, "midpoint_drift", drift=2.0, reference=(1.0, 0.96, 0.04)),
    Truth("drift 4", 20, "midpoint_drift", drift=4.0, reference=(1.0, 0.96, 0.04)),
    Truth("step 25", 12, "midpoint_step", step=25.0, reference=(1.0, 1.0, 0.0)),
    Truth("step 25", 20, "midpoint_step", step=25.0, reference=(1.0, 1.0, 0.04)),
    Truth("step 25", 45, "midpoint_step", step=25.0, reference=(1.0, 0.96, 0.04)),
    Truth("step 12", 20, "midpoint_step", step=12.0, reference=(1.0, 0.62, 0.04)),
    Truth(
        "oscillation 35", 20, "secondary_oscillation", oscillation=35.0, reference=(1.0, 0.96, 0.04)
    ),
    Truth(
        "oscillation 22", 45, "secondary_oscillation", oscillation=22.0, reference=(1.0, 1.0, 0.0)
    ),
    Truth("warm-up 70", 20, "warm_up", warm_up=70.0, reference=(1.0, 0.67, 0.08)),
    Truth("warm-up 70", 45, "warm_up", warm_up=70.0, reference=(1.0, 1.0, 0.0)),
    Truth("temperature 15/K", 20, "temperature", temperature=15.0, reference=(1.0, 1.0, 0.0)),
    Truth("temperature 15/K", 45, "temperature", temperature=15.0, reference=(1.0, 1.0, 0.0)),
    Truth("dry friction 14", 20, "dry_friction", friction=14.0, reference=(0.92, 0.12, 0.04)),
    Truth("dry friction 20", 20, "dry_friction", friction=20.0, reference=(1.0, 0.58, 0.04)),
    Truth("dry friction 30", 20, "dry_friction", friction=30.0, reference=(1.0, 0.96, 0.04)),
    Truth("quadratic drag .2", 20, "quadratic_drag", drag=0.2, reference=(0.17, 0.04, 0.0)),
    Truth("quadratic drag .4", 20, "quadratic_drag", drag=0.4, reference=(0.96, 0.50, 0.04)),
    Truth("quadratic drag .8", 20, "quadratic_drag", drag=0.8, reference=(1.0, 0.88, 0.04)),
    Truth("gross error 30", 20, "gross_error", gross=(30.0,), reference=(0.92, 0.79, 0.0)),
    Truth("gross error 60", 20, "gross_error", gross=(60.0,), reference=(1.0, 1.0, 0.0)),
    Truth("two gross errors 60", 20, "gross_error", gross=(60.0,) * 2, reference=(1.0, 1.0, 0.0)),
    Truth(
        "three gross errors 60", 20, "gross_error", gross=(60.0,) * 3, reference=(0.50, 0.46, 0.0)
    ),
    Truth("three gross errors 60", 45, "gross_error", gross=(60.0,) * 3, reference=(1.0, 1.0, 0.0)),
    Truth("random walk 9", 20, walk=9.0, reference=(0.71, None, 0.08)),
    Truth("random walk 9", 45, walk=9.0, reference=(0.71, None, 0.12)),
    Truth("AR(1) rho .5", 20, ar1=0.5),
    Truth("AR(1) rho .5", 45, ar1=0.5),
    Truth("AR(1) rho .8", 20, ar1=0.8),
    Truth("AR(1) rho .8", 45, ar1=0.8),
    Truth("damping change .002", 8, "damping_break", damping_change=0.002, noise=5.0),
    Truth("damping change .002", 20, "damping_break", damping_change=0.002, noise=5.0),
    Truth("drift 3", 8, "midpoint_drift", drift=3.0, noise=5.0, reference=(None, 0.14, None)),
    Truth("drift 3", 12, "midpoint_drift", drift=3.0, noise=5.0, reference=(None, 0.52, None)),
    Truth("warm-up 40", 20, "warm_up", warm_up=40.0, noise=5.0, reference=(None, 0.48, None)),
    Truth(
        "gross error 35", 8, "gross_error", gross=(35.0,), noise=5.0, reference=(None, 0.55, None)
    ),
    Truth(
        "gross error 35", 12, "gross_error", gross=(35.0,), noise=5.0, reference=(None, 0.83, None)
    ),
)
