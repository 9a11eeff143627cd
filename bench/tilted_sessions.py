"""Sessions with a tilted standing axis: error and coverage of the azimuth without and with levels.

z = 30 degrees, tilt of 10" along and across, a constant known to 12"; truth from exact rotations.
``SURVEYAPP_BENCH_RUNS`` sessions (1000).
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from surveyapp_models.arrays import Floats
from tests.sensors.test_tilted_sessions import azimuths

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "1000"))
AT_ONCE = 25


def _all(folder: Path, *, levels: bool) -> tuple[Floats, Floats]:
    parts = [
        azimuths(folder / f"{levels}-{k}", levels=levels, count=AT_ONCE, seed=k)
        for k in range(max(RUNS // AT_ONCE, 1))
    ]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def run() -> Iterator[str]:
    """Rms of the error, and shares of 95 % intervals that hold the truth."""
    with tempfile.TemporaryDirectory() as name:
        raw, wide = _all(Path(name), levels=False)
        corrected, sigma = _all(Path(name), levels=True)

    def told(errors: Floats, spread: Floats) -> str:
        rms = float(np.sqrt(np.mean(errors**2)))
        return f'rms {rms:.1f}", coverage {np.mean(np.abs(errors) <= 1.96 * spread):.3f}'

    yield f"{raw.size} sessions, tilt ignored: {told(raw, sigma)}"
    yield f"no level rows, the level's limit in the sigma: {told(raw, wide)}"
    yield f"level rows, compensated: {told(corrected, sigma)}"
