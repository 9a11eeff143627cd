"""Covariances, global test and family level of sound networks by 2000 repetitions each.

The suite draws a seeded part; the bounds are 3.3 sigma of what each sum is distributed as.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from surveyapp.core.network import adjust
from tests.network.network_factory import make
from tests.network.repetitions import covariances, global_tests_failed

RUNS = 2000


def _line(what: str, found: float, *, expected: float, sigma: float) -> str:
    off = (found - expected) / sigma
    verdict = "met" if abs(off) < 3.3 else "NOT MET"
    return (
        f"{what}: {found:.1f}, expected {expected:.1f} +-{sigma:.1f}: {off:+.1f} sigma, {verdict}"
    )


def run() -> Iterator[str]:
    """A line for each promise."""
    found = covariances(RUNS, seed=20)
    yield _line("v'Pv", found.squares, expected=found.total, sigma=found.squares_sigma)
    yield _line(
        "e'Q^-1 e of points", found.distance, expected=found.mean, sigma=found.distance_sigma
    )
    wide = 5.0 * math.sqrt(2.0 / RUNS)
    values = ", ".join(f"{x:.3f}" for x in found.eigenvalues)
    yield f"eigenvalues of the empirical covariance: {values} (1 +-{wide:.3f})"
    spread = math.sqrt(RUNS * 0.05 * 0.95)
    failed = global_tests_failed(RUNS, seed=5)
    yield _line("global tests not met", failed, expected=0.05 * RUNS, sigma=spread)
    accused = sum(
        bool(adjust(network, relative=False).snooping.suspects)
        for network in (
            make(seed + 1000, ("angle", "distance"), points=6)[0] for seed in range(RUNS)
        )
    )
    most = 0.05 * RUNS + 3.3 * spread
    yield f"sound networks with a suspect: {accused}, at most {most:.0f} of {RUNS}"
