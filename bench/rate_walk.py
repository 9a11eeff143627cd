"""What three gyros at rest can tell of a drift and a walk: the rule of naming, and its limits.

Nothing of the program: ideal records of 12, 18 and 30 stops (a bias for each gyro, white noise
from stop to stop), written as Gaussian processes whose likelihood is in closed form. For each line:
share of records named a drift.

* The rule of ``surveyapp.diagnosis.wandering``: drift and walk of unknown size, odds of two to one,
  and seen at all (5 % of white records are).
* The same at other odds, beside the walk of all sizes that is mistaken most.
* What a drift or a walk that is *common* to the gyros would change: a prior share of the variance
  that all have in common, unknown as well. Allowed for the drift alone it names more drifts and
  every common walk; allowed for both it gains nothing.
* An oracle that knows the sizes of both, where at most .15 of the walks are named.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from surveyapp_models.arrays import Floats

RUNS = 3000
NOISE = float(np.sqrt(0.006**2 + 0.05**2 / 187.0 + (0.00418 * np.cos(np.radians(35.0))) ** 2 / 3.0))
"""Of a stop [deg/s]: its own, the mean of its samples, and the earth's level rate, whose direction
in the body nobody knows."""
MINUTES = 0.1
"""From stop to stop."""
WALKS = (0.003, 0.006, 0.01)
"""A stop [deg/s]."""
EVERY_WALK = (0.0005, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.01)
RAMPS = (0.008, 0.02)
"""[deg/s per minute]"""
FREE, COMMON = (0.0,), (0.0, 0.5, 0.9, 0.99)
"""Share of the variance that the three gyros have in common."""
STEPS = np.geomspace(0.01, 30.0, 12)
SIGNALS = np.geomspace(0.05, 30.0, 12)
ODDS = 2.0
WRONG = 0.15


@dataclass(frozen=True, slots=True)
class Process:
    """A drift or a walk of the gyros: sizes, eigenvalues (m,) and vectors (m, m) in time."""

    sizes: Floats
    values: Floats
    vectors: Floats

    def evidence(self, seen: Floats, shares: Sequence[float]) -> Floats:
        """Log marginal likelihood of records (N, 3, m), sizes and shares averaged."""
        return _mean_of([self.likelihood(seen, s, c) for s in self.sizes for c in shares])

    def likelihood(self, seen: Floats, size: float, share: float) -> Floats:
        """Log likelihood, the white variance taken out."""
        between = np.array([1.0 - share, 1.0 - share, 1.0 + 2.0 * share])
        variance = 1.0 + size * between[:, None] * self.values
        squares = ((seen @ self.vectors) ** 2 / variance).sum(axis=(1, 2))
        dof = seen.shape[1] * seen.shape[2]
        return np.asarray(-0.5 * dof * np.log(squares) - 0.5 * np.log(variance).sum())


def _mean_of(logs: Sequence[Floats]) -> Floats:
    table = np.array(logs)
    top = table.max(axis=0)
    return np.asarray(top + np.log(np.exp(table - top).mean(axis=0)))


class Gyros:
    """Three gyros over a number of stops, their biases taken out."""

    def __init__(self, stops: int) -> None:
        time = np.arange(stops) * MINUTES
        contrasts = np.linalg.svd(np.eye(stops) - 1.0 / stops)[0][:, : stops - 1]
        self.time = contrasts.T @ time
        numbers = np.arange(stops)
        self.walk = contrasts.T @ (np.minimum.outer(numbers, numbers) + 1.0) @ contrasts
        self.turn = np.linalg.eigh(np.ones((3, 3)))[1]  # two differences, then what is common
        drift = np.outer(self.time, self.time) * stops / float(self.time @ self.time)
        self.drifts = Process(SIGNALS, *np.linalg.eigh(drift))
        self.walks = Process(STEPS, *np.linalg.eigh(self.walk))

    def records(self, signal: Floats, rng: np.random.Generator) -> Floats:
        """Signals (N, 3 or 1, m) and noise, in differences and common part, shape (N, 3, m)."""
        noise = NOISE * rng.standard_normal((RUNS, 3, self.time.size))
        return np.asarray(np.einsum("ij,njm->nim", self.turn.T, noise + signal))

    def ramp(self, size: float, signs: str, rng: np.random.Generator) -> Floats:
        """Drifts of one size, alike or each of a sign of its own."""
        of = np.ones((RUNS, 3)) if signs == "alike" else rng.choice([-1.0, 1.0], (RUNS, 3))
        return np.asarray(size * of[:, :, None] * self.time)

    def wander(self, size: float, kind: str, rng: np.random.Generator) -> Floats:
        """Walks, one for all or one for each."""
        drawn = rng.standard_normal((RUNS, 1 if kind == "one for all" else 3, self.time.size))
        return np.asarray(size * drawn @ np.linalg.cholesky(self.walk).T)


RULES = {
    "each gyro its own": (FREE, FREE),
    "drifts may be common": (COMMON, FREE),
    "drifts and walks may be": (COMMON, COMMON),
}


def named(gyros: Gyros, rule: tuple[Sequence[float], Sequence[float]]) -> dict[str, float]:
    """Share of records that a rule names a drift, by what they are."""
    rng = np.random.default_rng(gyros.time.size)

    def judged(signal: Floats) -> tuple[Floats, Floats]:
        seen = gyros.records(signal, rng)
        drift = gyros.drifts.evidence(seen, rule[0])
        white = gyros.drifts.likelihood(seen, 0.0, 0.0)
        return drift - gyros.walks.evidence(seen, rule[1]), drift - white

    least = float(np.quantile(judged(np.zeros((1, 1, 1)))[1], 0.95))
    found = {}
    for size, signs in product(RAMPS, ("alike", "signs of their own")):
        odds, gain = judged(gyros.ramp(size, signs, rng))
        found[f"ramp {size:g} {signs}"] = float(np.mean((odds >= np.log(ODDS)) & (gain > least)))
    for kind, size in product(("each", "one for all"), WALKS):
        odds, gain = judged(gyros.wander(size, kind, rng))
        found[f"walk {size:g} {kind}"] = float(np.mean((odds >= np.log(ODDS)) & (gain > least)))
    return found


def worst(gyros: Gyros, odds: float) -> tuple[float, float, float]:
    """Share of the slow drift that is named at some odds, the walk named most, and its share."""
    rng = np.random.default_rng([gyros.time.size, 1])

    def judged(signal: Floats) -> tuple[Floats, Floats]:
        seen = gyros.records(signal, rng)
        drift = gyros.drifts.evidence(seen, FREE)
        return drift - gyros.walks.evidence(seen, FREE), drift - gyros.drifts.likelihood(
            seen, 0.0, 0.0
        )

    least = float(np.quantile(judged(np.zeros((1, 1, 1)))[1], 0.95))

    def share(signal: Floats) -> float:
        found, gain = judged(signal)
        return float(np.mean((found >= np.log(odds)) & (gain > least)))

    mistaken = {size: share(gyros.wander(size, "each", rng)) for size in EVERY_WALK}
    size = max(mistaken, key=lambda walk: mistaken[walk])
    return share(gyros.ramp(RAMPS[0], "alike", rng)), size, mistaken[size]


def oracle(gyros: Gyros, ramp: float, walk: float, share: float) -> float:
    """Share of drifts named by who knows the sizes and names .15 of the walks.

    ``share``: 0 where each gyro has a drift of its own, near 1 where all have one.
    """
    rng = np.random.default_rng([gyros.time.size, int(1e4 * ramp), int(1e4 * walk)])
    drift = (ramp / NOISE) ** 2 * float(gyros.time @ gyros.time) / (gyros.time.size + 1.0)
    step = (walk / NOISE) ** 2

    def odds(signal: Floats) -> Floats:
        seen = gyros.records(signal, rng) / NOISE
        return _known(gyros.drifts, seen, drift, share) - _known(gyros.walks, seen, step, 0.0)

    wrong = odds(gyros.wander(walk, "each", rng))
    right = odds(gyros.ramp(ramp, "alike" if share else "signs of their own", rng))
    return float(np.mean(right > np.quantile(wrong, 1.0 - WRONG)))


def _known(process: Process, seen: Floats, size: float, share: float) -> Floats:
    between = np.array([1.0 - share, 1.0 - share, 1.0 + 2.0 * share])
    variance = 1.0 + size * between[:, None] * process.values
    squares = ((seen @ process.vectors) ** 2 / variance).sum(axis=(1, 2))
    return np.asarray(-0.5 * squares - 0.5 * np.log(variance).sum())


def run() -> Iterator[str]:
    """Rules, then the oracle."""
    for stops in (12, 18, 30):
        gyros = Gyros(stops)
        for name, rule in RULES.items():
            told = ", ".join(f"{what} {share:.2f}" for what, share in named(gyros, rule).items())
            yield f"{stops} stops, {name}: {told}"
        for odds in (1.0, ODDS):
            right, size, wrong = worst(gyros, odds)
            told = f"ramp {RAMPS[0]:g} {right:.2f}, mistaken most: walk {size:g} {wrong:.2f}"
            yield f"{stops} stops, odds of {odds:g}: {told}"
        for share, who in ((0.0, "a drift for each"), (0.999, "one drift for all")):
            told = ", ".join(
                f"ramp {r:g} against walk {w:g}: {oracle(gyros, r, w, share):.2f}"
                for r, w in product(RAMPS, WALKS)
            )
            yield f"{stops} stops, oracle, {who}: {told}"
