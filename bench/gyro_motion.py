"""The simulator's integrator against scipy's adaptive one on the slow equation, same accuracy."""

from __future__ import annotations

import math
import time

import numpy as np

from surveyapp.core.simulate.specification import SessionSpec, default_gyro
from surveyapp.core.simulate.turning_points import simulate_turning_points
from surveyapp_models.angles import ARCSEC
from surveyapp_models.gyro.integration import Start, integrate
from surveyapp_models.gyro.moments import directive_moment, effective_inertia
from surveyapp_models.gyro.motion import turning_points
from surveyapp_models.gyro.periods import tracking_period_s

RUNS = 400
POINTS = 20


def run() -> list[str]:
    from scipy.integrate import solve_ivp

    gyro, latitude, amplitude = default_gyro(), math.radians(47.0), math.radians(2.0)
    square = directive_moment(gyro, latitude) / effective_inertia(gyro, latitude)
    period = tracking_period_s(gyro, latitude)
    duration = 0.5 * (POINTS + 0.5) * period

    begin = time.perf_counter()
    start = Start(np.full(RUNS, amplitude), np.zeros(RUNS))
    motion = integrate(gyro, latitude, start, duration_s=duration, step_s=period / 96)
    ours = turning_points(motion, POINTS).azimuth[0]
    ensemble = time.perf_counter() - begin

    def slope(t: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], -square * math.sin(y[0])

    def turned(t: float, y: np.ndarray) -> float:
        return float(y[1])

    begin = time.perf_counter()
    peer = solve_ivp(
        slope,
        (0.0, duration),
        (amplitude, 0.0),
        method="DOP853",
        rtol=1e-9,
        atol=1e-12,
        events=turned,
    )
    single = time.perf_counter() - begin
    theirs = np.array([y[0] for y in peer.y_events[0] if abs(y[0]) > 0.0])[-POINTS:]
    size = min(len(ours), len(theirs))
    worst = float(np.max(np.abs(np.abs(ours[:size]) - np.abs(theirs[:size])))) / ARCSEC

    begin = time.perf_counter()
    simulate_turning_points(SessionSpec(points=POINTS), RUNS, np.random.default_rng(1))
    whole = time.perf_counter() - begin
    return [
        f"{RUNS} runs of {POINTS} turning points, two-axis: {ensemble:.3f} s "
        f"({ensemble / RUNS * 1e3:.3f} ms a run)",
        f"one run, slow equation, scipy DOP853: {single * 1e3:.1f} ms; "
        f"ratio per run {single / (ensemble / RUNS):.0f}",
        f'largest difference of a turning point: {worst:.4f}"',
        f"with noise, temperature and truth: {whole:.3f} s",
    ]
