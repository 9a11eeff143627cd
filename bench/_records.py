"""Records for judging the diagnosis, from a generator of its own.

The runs come from an integrated equation of motion (the slow mode of a suspended gyro), not from
the columns that the engine fits; the campaigns from circumstances drawn at random. Declared
simulation, used by the benchmarks and by tests/closed_loop.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from surveyapp.diagnosis import CampaignDetermination, Case, TurningPoints
from surveyapp.diagnosis.subjects.campaign import campaign
from surveyapp.diagnosis.subjects.reversal_run import reversal_run
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

STEPS = 160
"""Runge-Kutta steps in a half swing."""


@dataclass(frozen=True)
class Truth:
    """What nature does in one line of the table; sizes in arc-seconds and half swings.

    ``amplitude`` is the first one [deg], within a tenth; ``damping_growth`` per half swing; a pulse
    lasts three to five half swings. ``one_sign``: an effect of one instrument, whose sign and time
    of warming up are those of all runs. Two effects at once are written ``one+other``.
    """

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
    damping_growth: float = 0.0
    pulse: float = 0.0
    gross: tuple[float, ...] = ()
    walk: float = 0.0
    ar1: float = 0.0
    noise: float = 4.0
    rounding: float = 0.1
    amplitude: float = 1.0
    one_sign: bool = False
    reference: tuple[float | None, float | None, float | None] = field(default=(None, None, None))


@dataclass(frozen=True)
class Runs:
    """Simulated turning points of many runs of one truth."""

    readings: Floats
    temperature: Floats
    north: Floats


def simulate(truth: Truth, runs: int, seed: int) -> Runs:
    """Integrate a'' + 2 k a' + b a'|a'| + f sign(a') + pi^2 sin(a - N) = 0, read its turns."""
    g = np.random.default_rng(seed)
    n = truth.size
    first = np.radians(truth.amplitude * g.uniform(0.9, 1.1, runs)) * g.choice([-1.0, 1.0], runs)
    decay = g.uniform(0.012, 0.02, runs)
    north = midpoint(truth, runs, g)
    temperature = g.uniform(10.0, 25.0, (runs, 1)) + temperature_walk(n, runs, g)
    change = g.uniform(0.3, 0.6, runs) * n
    h = 1.0 / STEPS
    friction = truth.friction * ARCSEC * np.pi**2 / 2.0
    drag = 0.75 * truth.drag

    def field_at(t: float) -> Floats:
        value = north(t)
        if truth.temperature:
            k = np.clip(t, 0.0, n + 1.0)
            low = int(k)
            part = k - low
            now = temperature[:, low] * (1.0 - part) + temperature[:, low + 1] * part
            value = value + truth.temperature * (now - temperature[:, :n].mean(axis=1))
        return value * ARCSEC

    def slope(t: float, a: Floats, v: Floats) -> tuple[Floats, Floats]:
        k = decay + truth.damping_change * (t > change) + truth.damping_growth * t
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


def temperature_walk(n: int, runs: int, g: np.random.Generator) -> Floats:
    """Temperatures at whole half swings: 1 to 3 K more at the end, drafts of 0.5 K [K]."""
    trend = g.uniform(1.0, 3.0, (runs, 1)) * np.linspace(0.0, 1.0, n + 3)
    return trend + 0.5 * g.standard_normal((runs, n + 3))


def noise_of(truth: Truth, runs: int, g: np.random.Generator) -> Floats:
    """White noise, or AR(1) of the same variance."""
    white = g.standard_normal((runs, truth.size))
    if not truth.ar1:
        return white
    for k in range(1, truth.size):
        white[:, k] = truth.ar1 * white[:, k - 1] + np.sqrt(1.0 - truth.ar1**2) * white[:, k]
    return white


def midpoint(truth: Truth, runs: int, g: np.random.Generator) -> Callable[[float], Floats]:
    """North of each run [arcsec] as a function of time."""
    n = truth.size
    sign = np.ones(runs) if truth.one_sign else g.choice([-1.0, 1.0], runs)
    when = g.uniform(0.25, 0.75, runs) * n
    period = g.uniform(0.3, 0.55, runs) * n
    phase = g.uniform(0.0, 2.0 * np.pi, runs)
    tau = g.uniform(2.0, 6.0, 1 if truth.one_sign else runs)
    latest = n - 7.0
    begin = g.uniform(min(2.0, latest), max(2.0, latest), runs) if truth.pulse else np.zeros(runs)
    end = begin + g.uniform(3.0, 5.0, runs) if truth.pulse else begin
    walk = np.cumsum(truth.walk * g.standard_normal((runs, n + 3)), axis=1)

    def north(t: float) -> Floats:
        value = truth.drift * t + truth.step * (t > when)
        value = value + truth.oscillation * np.cos(2.0 * np.pi * t / period + phase)
        value = value + truth.warm_up * np.exp(-t / tau)
        value = value + truth.pulse * ((t > begin) & (t < end))
        return np.asarray(sign * value + walk[:, min(int(t), n + 2)])

    return north


def problems(truth: Truth, runs: int, seed: int) -> tuple[list[Case], Floats]:
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
class CampaignTruth:
    """What nature does in one line of the table of campaigns; sizes in arc-seconds."""

    name: str
    size: int
    effect: str = ""
    temperature: float = 0.0
    latitude: float = 0.0
    drift: float = 0.0
    step: float = 0.0
    circle: float = 0.0
    line: float = 0.0
    block: float = 0.0
    warm_up: float = 0.0
    ar1: float = 0.0


def campaign_problem(truth: CampaignTruth, seed: int) -> tuple[Case, float]:
    """Simulate a campaign of three determinations a day; the constant averaged over it [rad]."""
    g = np.random.default_rng(seed)
    n = truth.size
    block = np.repeat(np.arange(n), 3)[:n]
    dates = np.sort(g.choice(3 * n, n, replace=False)) + 0.3
    days = dates[block] + np.tile([0.0, 0.05, 0.1], n)[:n]
    season = 8.0 * np.sin(2.0 * np.pi * days / 365.25 + g.uniform(0.0, 6.28))
    theta = 12.0 + season + (3.0 * g.standard_normal(n))[block] + 0.5 * g.standard_normal(n)
    line = g.integers(0, 4, n)
    latitude = np.radians(np.array([30.0, 36.0, 44.0, 50.0]))[line]
    target, north = g.uniform(0.0, 2.0 * np.pi, (2, n))
    running = g.uniform(200.0, 3000.0, n)
    sigma = g.choice([4.0, 5.0, 7.0], n)
    value = -12.0 + truth.temperature * (theta - 15.0) + truth.latitude / np.cos(latitude)
    value += truth.drift * days + truth.step * (days > days[g.integers(n // 3, 2 * n // 3)])
    value += truth.circle * (np.sin(north + 1.0) - np.sin(target + 1.0))
    value += truth.line * (line == g.integers(0, 4)) + truth.warm_up * np.exp(-running / 700.0)
    value += truth.block * (block == block[n // 2])
    noise = g.standard_normal(n)
    for k in range(1, n):
        noise[k] = truth.ar1 * noise[k - 1] + np.sqrt(1.0 - truth.ar1**2) * noise[k]
    observed = np.round(value + 4.8 * noise if truth.ar1 else value + sigma * noise, 1)
    stated = np.full(n, 4.8) if truth.ar1 else sigma
    made = [
        CampaignDetermination.at(
            float(observed[i]) * ARCSEC,
            sigma=float(stated[i]) * ARCSEC,
            elapsed_days=float(days[i]),
            line=f"line {line[i]}",
            temperature_c=float(theta[i]),
            latitude=float(latitude[i]),
            line_reading=float(target[i]),
            north_reading=float(north[i]),
            running_s=float(running[i]),
        )
        for i in range(n)
    ]
    weights = stated**-2 / np.sum(stated**-2)
    return campaign(made, instrument="simulated"), float(weights @ value) * ARCSEC
