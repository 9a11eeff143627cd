"""When a levelling phase counts as turned: false alarms at rest, and the least turn that is told.

``TURNED_SIGMAS`` and ``TURNED_LEAST`` of core/sensors/rate/level_phase. Units at rest whose noise
is white; and units that are turned once in the middle of the phase, by how much it takes until nine
of ten are told.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from surveyapp.core.sensors.rate.level_phase import still_ends
from surveyapp_models.arrays import Floats
from surveyapp_models.rate.attitude import STANDARD_GRAVITY

RUNS = 2000
ROWS = (100, 600, 6000)
NOISES = (0.0005, 0.005, 0.03)
"""Of a sample [m/s2]."""
TURNS = (0.01, 0.02, 0.05, 0.07, 0.1, 0.2, 0.5, 1.0, 2.0)
"""[degrees]"""


def turned(forces: Floats) -> bool:
    """Whether a phase is told to have been turned."""
    before, _ = still_ends(forces)
    return bool(before.stop < forces.shape[0])


def told(rng: np.random.Generator, *, rows: int, noise: float, turn: float, runs: int) -> float:
    """Share of phases called turned; the unit turns by that many degrees half-way."""
    found = 0
    for _ in range(runs):
        forces = rng.normal(0.0, noise, (rows, 3))
        forces[rows // 2 :, 0] += STANDARD_GRAVITY * math.sin(math.radians(turn))
        found += turned(forces)
    return found / runs


def run() -> Iterator[str]:
    """Every length and noise."""
    rng = np.random.default_rng(1)
    for rows in ROWS:
        for noise in NOISES:
            alarm = told(rng, rows=rows, noise=noise, turn=0.0, runs=RUNS)
            least = next(
                (t for t in TURNS if told(rng, rows=rows, noise=noise, turn=t, runs=100) >= 0.9),
                math.inf,
            )
            yield (
                f"{rows} rows of {noise:g} m/s2: called turned at rest {alarm:.4f}, "
                f"told in nine of ten from {least:g} degrees"
            )
