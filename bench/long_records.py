"""False alarms, detection and cost of long records, at 100 000 samples.

Noise of four kinds without any effect: how often the gate fires, a drift is named, a line is told.
A drift and a line of known size: how often they are found, and how far off. Bounds of the suite's
subset are binomial; these are the figures themselves.
"""

from __future__ import annotations

import functools
import resource
import time
from collections.abc import Callable, Iterator

import numpy as np

from bench._long_records import NOISES, SAMPLES, STEP_S, rate_log, walk, white
from surveyapp.diagnosis import Diagnosis, diagnose
from surveyapp_models.arrays import Floats

RUNS = 100
DRAWS = 1000
CASES: dict[str, Callable[[int, np.random.Generator], Floats]] = {
    **NOISES,
    "white and the walk most like a drift": functools.partial(walk, size=0.045),
    "white and a small walk": functools.partial(walk, size=0.1),
    "white and a large walk": functools.partial(walk, size=10.0),
}


def share(results: list[Diagnosis], test: Callable[[Diagnosis], bool]) -> str:
    return f"{np.mean([test(result) for result in results]):.2f}"


def noise_line(name: str, results: list[Diagnosis]) -> str:
    cells = [
        name,
        share(results, lambda r: r.ledger["gates"][0]["p_family"] <= 0.05),
        share(results, lambda r: bool(r.adopted)),
        share(results, lambda r: bool(r.lines)),
        share(results, lambda r: r.ledger["blocks"]["white"]),
        f"{np.median([r.ledger['blocks']['count'] for r in results]):.0f}",
    ]
    return "| " + " | ".join(cells) + " |"


def drift_line(sigmas: float, generator: np.random.Generator) -> str:
    """A drift over the record of so many sigmas of its own estimate, in white noise."""
    t = STEP_S * np.arange(SAMPLES)
    slope = sigmas * np.sqrt(12.0 / SAMPLES) * 3600.0 / t[-1]
    results = [
        diagnose(rate_log(white(SAMPLES, generator) + slope * t / 3600.0), draws=DRAWS)
        for _ in range(RUNS)
    ]
    detected = share(results, lambda r: r.verdict != "adequate")
    right = share(results, lambda r: [a.effect for a in r.adopted] == ["bias_ramp"])
    return f"| drift of {sigmas:g} sigma | {detected} | {right} |"


def tone_line(amplitude: float, generator: np.random.Generator) -> str:
    """A line at 0.137 Hz in white noise of 1."""
    t = STEP_S * np.arange(SAMPLES)
    found, off = 0, []
    for _ in range(RUNS):
        phase = 2.0 * np.pi * (0.137 * t + generator.random())
        values = white(SAMPLES, generator) + amplitude * np.cos(phase)
        lines = diagnose(rate_log(values), draws=DRAWS).lines
        near = [line for line in lines if abs(line.frequency - 0.137) < 5.0 * line.sigma_frequency]
        found += bool(near)
        off += [
            (
                (line.frequency - 0.137) / line.sigma_frequency,
                (line.amplitude - amplitude) / line.sigma_amplitude,
            )
            for line in near
        ]
    z = np.sqrt(np.mean(np.square(off), axis=0)) if off else np.full(2, np.nan)
    return f"| line of {amplitude:g} | {found / RUNS:.2f} | {z[0]:.2f} | {z[1]:.2f} |"


def cost_line(n: int, generator: np.random.Generator) -> str:
    problem = rate_log(white(n, generator))
    begin = time.perf_counter()
    diagnose(problem)
    seconds = time.perf_counter() - begin
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    return f"| {n} samples | {seconds:.1f} s | {most:.0f} MB at most so far |"


def run() -> Iterator[str]:
    """Yield the lines of the tables."""
    generator = np.random.default_rng(2026)
    for n in (100_000, 1_000_000):
        yield cost_line(n, generator)
    yield "| noise | gate fires | drift named | line told | blocks white | blocks |"
    for name, noise in CASES.items():
        results = [diagnose(rate_log(noise(SAMPLES, generator)), draws=DRAWS) for _ in range(RUNS)]
        yield noise_line(name, results)
    yield "| in white noise | detected | named |"
    for sigmas in (5.0, 8.0, 15.0):
        yield drift_line(sigmas, generator)
    yield "| in white noise | found | frequency off by sigmas | amplitude off by sigmas |"
    for amplitude in (0.02, 0.03, 0.05):
        yield tone_line(amplitude, generator)
