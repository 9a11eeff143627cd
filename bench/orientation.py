"""Speed of the orientation: the fit against lmfit, whole sessions, and start-up of the program."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np

from surveyapp import api
from surveyapp.core.swing.gyrofit import fit_damped_swing
from surveyapp.io.locations import samples_folder


def seconds(function: Callable[[], object], repeat: int) -> float:
    """Median time of one call [s] over five rounds."""
    rounds = []
    for _ in range(5):
        start = time.perf_counter()
        for _ in range(repeat):
            function()
        rounds.append((time.perf_counter() - start) / repeat)
    return median(rounds)


def fit_against_lmfit() -> tuple[float, float]:
    """Seconds of one fit with covariance of a 20-point run: ours and lmfit's."""
    import lmfit

    rng = np.random.default_rng(1)
    k = np.arange(20.0)
    sides = np.where(k % 2 == 0, 1.0, -1.0)
    values = 12.0 + 3600.0 * sides * np.exp(-0.013 * k) + rng.normal(0.0, 4.0, k.size)
    parameters = lmfit.Parameters()
    parameters.add_many(("n", 0.0), ("a", 3000.0), ("c", 0.01))

    def residual(p: lmfit.Parameters) -> object:
        return p["n"] + p["a"] * sides * np.exp(-p["c"] * k) - values

    ours = seconds(lambda: fit_damped_swing(values, k, sides), 200)
    theirs = seconds(lambda: lmfit.minimize(residual, parameters), 20)
    return ours, theirs


def start_up(*arguments: str) -> float:
    """Median wall time of a fresh interpreter [s]."""
    rounds = []
    for _ in range(7):
        start = time.perf_counter()
        subprocess.run([sys.executable, *arguments], check=False, capture_output=True)
        rounds.append(time.perf_counter() - start)
    return median(rounds)


def run() -> list[str]:
    """Fit, throughput, start-up."""
    ours, theirs = fit_against_lmfit()
    sample = samples_folder() / "johannesburg-1966"
    project = api.open_project(sample)
    start = time.perf_counter()
    for _ in range(1000):
        api.orient(project)
    thousand = time.perf_counter() - start
    bare = start_up("-c", "pass")
    help_time = start_up("-m", "surveyapp", "--help")
    orient = start_up("-m", "surveyapp", "orient", str(sample))
    tongjin = start_up("-m", "surveyapp", "orient", str(Path(samples_folder()) / "tongjin-2015"))
    return [
        f"fit with covariance, 20 points: {ours * 1e3:.3f} ms; lmfit {theirs * 1e3:.2f} ms: "
        f"{theirs / ours:.0f} times faster (target 10)",
        f"1000 sessions of 20 points, oriented with their tests, one process: {thousand:.2f} s",
        f"--help: {(help_time - bare) * 1e3:.0f} ms above a bare interpreter of "
        f"{bare * 1e3:.0f} ms (target 60)",
        f"orient johannesburg-1966 (no crs): {orient * 1e3:.0f} ms",
        f"orient tongjin-2015 (with pyproj): {tongjin * 1e3:.0f} ms",
    ]
