"""The residual battery: that something is there, not what.

Every p value comes from Monte Carlo through the model's own projector and with the rounding of the
readings in it, never from an asymptotic table. A swing has two channels: the side-weighted
residual (amplitude law, damping, follow-up) and its Schuler mean (drift, step, period). Advisory.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.compare import orthonormal_design
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.gate import rounding_of
from surveyapp.diagnosis.nulls import Noise, residual_draws
from surveyapp_models.arrays import Floats

DRAWS = 1000
LAGS = 4


@dataclass(frozen=True, slots=True)
class BatteryTest:
    """One statistic of one channel with its p value."""

    channel: str
    name: str
    statistic: float
    p: float


def channels(problem: Case, residuals: Floats) -> dict[str, Floats]:
    """Channels of residuals (d, n): the only one, or amplitude and midpoint of a swing."""
    if problem.side is None:
        return {"residual": residuals}
    schuler = (residuals[:, :-2] + 2.0 * residuals[:, 1:-1] + residuals[:, 2:]) / 4.0
    return {"amplitude": residuals * problem.side, "midpoint": schuler}


def durbin_watson(v: Floats) -> Floats:
    """Distance of the Durbin-Watson statistic from 2."""
    total = np.maximum((v**2).sum(axis=1), 1e-300)
    return np.asarray(np.abs((np.diff(v, axis=1) ** 2).sum(axis=1) / total - 2.0))


def ljung_box(v: Floats) -> Floats:
    """Ljung and Box 1978 over up to four lags."""
    n = v.shape[1]
    total = np.maximum((v**2).sum(axis=1), 1e-300)
    lags = range(1, min(LAGS, n - 2) + 1)
    parts = [((v[:, lag:] * v[:, :-lag]).sum(axis=1) / total) ** 2 / (n - lag) for lag in lags]
    return np.asarray(n * (n + 2.0) * np.sum(parts, axis=0))


def runs(v: Floats) -> Floats:
    """Fewness or abundance of runs of equal sign, as a distance from the middle."""
    changes = (np.diff(np.signbit(v), axis=1)).sum(axis=1)
    return np.asarray(np.abs(changes - 0.5 * (v.shape[1] - 1)))


def largest(v: Floats) -> Floats:
    """Largest standardized residual."""
    spread = np.sqrt(np.maximum((v**2).mean(axis=1), 1e-300))
    return np.asarray(np.abs(v).max(axis=1) / spread)


def periodogram_peak(v: Floats) -> Floats:
    """Highest peak of the periodogram relative to its sum."""
    power = np.abs(np.fft.rfft(v, axis=1)[:, 1:]) ** 2
    return np.asarray(power.max(axis=1) / np.maximum(power.sum(axis=1), 1e-300))


def normality(v: Floats) -> Floats:
    """Jarque and Bera 1980, from skewness and kurtosis."""
    centred = v - v.mean(axis=1, keepdims=True)
    spread = np.sqrt(np.maximum((centred**2).mean(axis=1, keepdims=True), 1e-300))
    z = centred / spread
    skew, kurtosis = (z**3).mean(axis=1), (z**4).mean(axis=1)
    return np.asarray(v.shape[1] / 6.0 * (skew**2 + 0.25 * (kurtosis - 3.0) ** 2))


STATISTICS = (
    ("Durbin-Watson", durbin_watson),
    ("Ljung-Box", ljung_box),
    ("runs", runs),
    ("largest residual", largest),
    ("periodogram peak", periodogram_peak),
    ("normality", normality),
)


def run_battery(problem: Case, fit: Fit, seed: int) -> tuple[BatteryTest, ...]:
    """Apply every statistic to every channel of the residuals of a fit."""
    generator = np.random.default_rng(seed)
    q = orthonormal_design(fit)
    rounding = rounding_of(problem, fit)
    noise = Noise(DRAWS, rounding, problem.root_weights, own_scales=problem.own_scales)
    order = np.argsort(problem.position, kind="stable")
    if problem.series is not None:
        order = np.lexsort((problem.position, problem.series))
    draws = channels(problem, residual_draws(q, noise, generator)[:, order])
    seen = channels(problem, fit.residual[None, order])
    found = []
    for channel, values in seen.items():
        if values.shape[1] < 4:
            continue
        for name, statistic in STATISTICS:
            observed = float(statistic(values)[0])
            null = statistic(draws[channel])
            p = (1.0 + float((null >= observed * (1.0 - 1e-12)).sum())) / (DRAWS + 1.0)
            found.append(BatteryTest(channel, name, observed, p))
    return tuple(found)
