"""Limits of rest and of zero-velocity updates, by simulation.

Share of velocity innovations beyond their 99 % bound, of drives with sensors of four grades on
vehicles that shake, for the right gate and one that calls driving rest; and how often one cluster
of any of seven shapes is split in two (``CLEARLY_TWO``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from surveyapp.core.sensors.rate.still import (
    CLEARLY_TWO,
    Mask,
    _lower_cluster,
    bridged,
    motion_gate,
    rest_noise,
    statistic,
)
from surveyapp.core.sensors.rate.zero_velocity import in_memory, inertial_path
from surveyapp.core.simulate.rate.vehicle import Leg, VehicleRun, vehicle_log
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.triad import Triad

DRIVES = 18
GRADES = (0.3, 1.0, 2.0, 4.0)
"""Times .01 m/s2 and .001 rad/s a sample at 100 Hz."""
WRONG = 500.0
RECORDS = 60
HZ, WINDOW = 100.0, 15


def drive(seed: int, grade: float) -> tuple[Floats, Floats, Mask]:
    """Forces, rates and the truth of rest: four pushes of a second, turns and stops."""
    rng = np.random.default_rng([seed, int(10 * grade)])
    legs = [Leg("stationary", 6.0)]
    for _ in range(4):
        push = float(rng.uniform(0.2, 0.6))
        legs += [Leg("accelerating", 0.5, push), Leg("braking", 0.5, -push)]
        legs += [Leg("stationary", 2.0), Leg("turning", 1.0, turn=0.5 * math.pi)]
        legs.append(Leg("stationary", 2.0))
    gyro = Triad(bias=np.array([0.002, -0.001, 0.0015]), noise=0.001 * grade)
    run = VehicleRun(
        tuple(legs),
        heading=0.5,
        gyro=gyro,
        accelerometer=Triad(noise=0.01 * grade),
        shake=0.15 * max(grade, 1.0),
    )
    log = vehicle_log(run, rng)
    force = np.column_stack([log.columns[f"acc_{a}_m_s2"] for a in "xyz"])
    rate = np.column_stack([log.columns[f"gyr_{a}_rad_s"] for a in "xyz"])
    truth = np.concatenate(
        [np.full(round(leg.seconds * HZ), leg.state == "stationary") for leg in legs]
    )
    return force, rate, truth


def exceeding(seed: int, grade: float, factor: float) -> tuple[float, float]:
    """Share of innovations beyond the bound, and share of the record wrongly called rest."""
    force, rate, truth = drive(seed, grade)
    values = statistic(force, rate, rest_noise(force, rate, rate_hz=HZ), window=WINDOW)
    gate = motion_gate(values, window=WINDOW, false_alarm=0.01, factor=factor)
    still = bridged(values <= gate.threshold, rate_hz=HZ)
    path = inertial_path(in_memory(force, rate), still, interval_s=1.0 / HZ)
    return path.exceeding or 0.0, float(np.mean(still & ~truth))


def _correlated(rng: np.random.Generator, n: int) -> Floats:
    from scipy.signal import lfilter

    return np.asarray(lfilter([0.4], [1.0, -0.9], rng.normal(size=n)))


CLUSTERS: Mapping[str, Callable[[np.random.Generator, int], Floats]] = {
    "chi-square": lambda rng, n: np.log(rng.chisquare(87, n) / 87),
    "gamma 1": lambda rng, n: np.log(rng.gamma(1.0, 1.0, n)),
    "gamma 2": lambda rng, n: np.log(rng.gamma(2.0, 0.5, n)),
    "normal": lambda rng, n: rng.normal(0.0, 0.8, n),
    "half normal": lambda rng, n: 1.5 * np.abs(rng.normal(size=n)),
    "exponential": lambda rng, n: rng.exponential(1.0, n),
    "correlated": _correlated,
}
"""Shapes of the logarithm of the statistic where there is one state only."""


def split(name: str, size: int, runs: int) -> float:
    """Share of records of one cluster that are taken for two."""
    rng = np.random.default_rng(size)
    found = [
        _lower_cluster(CLUSTERS[name](rng, size), clearness=CLEARLY_TWO) is not None
        for _ in range(runs)
    ]
    return float(np.mean(found))


def run() -> Iterator[str]:
    """Innovations, then clusters."""
    for grade in GRADES:
        right = [exceeding(seed, grade, 1.0) for seed in range(DRIVES)]
        wrong = [exceeding(seed, grade, WRONG) for seed in range(DRIVES)]
        good = [share for share, off in right if off <= 0.02]
        bad = [share for share, off in wrong if off > 0.05]
        yield (
            f"grade {grade:g}: right gate {max(good):.3f} at most ({len(good)} drives), wrong "
            + (f"{min(bad):.3f} to {max(bad):.3f} ({len(bad)})" if bad else "never wrong")
        )
    for size in (100, 400, 2000):
        told = ", ".join(f"{name} {split(name, size, RECORDS):.2f}" for name in CLUSTERS)
        yield f"one cluster of {size} taken for two: {told}"
