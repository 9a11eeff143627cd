"""Limits of rest and of zero-velocity updates, by simulation.

Drives with sensors of four grades, on vehicles that shake and on one that does not: what share of
the motion a gate calls rest, the right one and wider ones, what share of the velocity innovations
lies beyond the 99 % bound then, and in what share of the drives that tells. A gate is wrong where
it calls motion rest: how much wider it must be for that depends on the quotient of shaking and
noise. And how often one cluster of any of seven shapes is split in two (``CLEARLY_TWO``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from itertools import product

import numpy as np

from bench.rate import as_read
from surveyapp.core.sensors.rate.motion_pieces import ACCELEROMETERS, GYROS, states_of
from surveyapp.core.sensors.rate.still import CLEARLY_TWO, FALSE_ALARM, Mask, _lower_cluster
from surveyapp.core.sensors.rate.zero_velocity import TOLERATED, in_memory, inertial_path
from surveyapp.core.simulate.rate.vehicle import Leg, VehicleRun, vehicle_log
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.triad import Triad

DRIVES = 18
GRADES = (0.3, 1.0, 2.0, 4.0)
"""Times .01 m/s2 and .001 rad/s a sample at 100 Hz."""
FACTORS = (1.0, 50.0, 100.0, 500.0, 2000.0)
"""Of the threshold."""
SHAKES = (0.15, 0.6, 0.0)
"""Vibration while moving, standard deviation [m/s2]."""
RECORDS = 60
HZ = 100.0


def drive(seed: int, *, grade: float, shake: float) -> tuple[SensorLog, Mask]:
    """A log and the truth of rest: four pushes of a second, turns and stops."""
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
        shake=shake,
    )
    truth = np.concatenate(
        [np.full(round(leg.seconds * HZ), leg.state == "stationary") for leg in legs]
    )
    return as_read(vehicle_log(run, rng)), truth


def exceeding(seed: int, *, grade: float, factor: float, shake: float) -> tuple[float, float]:
    """Share of innovations beyond the bound, and share of the motion that is called rest."""
    log, truth = drive(seed, grade=grade, shake=shake)
    rests = states_of(log, false_alarm=FALSE_ALARM, factor=factor).rests
    force, rate = (
        np.column_stack([log.columns[c] for c in names]) for names in (ACCELEROMETERS, GYROS)
    )
    path = inertial_path(in_memory(force, rate), rests, interval_s=1.0 / HZ)
    return path.exceeding or 0.0, float(np.mean(rests.mask()[~truth]))


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
    for shake, grade, factor in product(SHAKES, GRADES, FACTORS):
        found = np.array(
            [exceeding(k, grade=grade, factor=factor, shake=shake) for k in range(DRIVES)]
        )
        share = float(np.mean(found[:, 0] > TOLERATED))
        yield (
            f"shaking {shake:g} m/s2, grade {grade:g}, gate times {factor:g}: of the motion called "
            f"rest {found[:, 1].min():.3f} to {found[:, 1].max():.3f}, innovations beyond "
            f"{found[:, 0].min():.3f} to {found[:, 0].max():.3f}, told {share:.2f}"
        )
    for size in (100, 400, 2000):
        told = ", ".join(f"{name} {split(name, size, RECORDS):.2f}" for name in CLUSTERS)
        yield f"one cluster of {size} taken for two: {told}"
