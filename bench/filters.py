"""The three filters at four settings: what the Allan deviation loses, and after how many samples.

``SURVEYAPP_BENCH_RUNS`` series a line (5) of 1e5 samples of quantisation, white and flicker noise.
"B of five powers" is what a fit of the five power laws to the filtered curve would print as the
bias instability: the number that makers reduce. "B below the corner" is what ``filter`` prints.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator

import numpy as np
from scipy.optimize import nnls

from surveyapp.core.sensors.allan import allan_curve, octaves
from surveyapp.core.sensors.filters import FILTERS, FilterName, LocalLevel, run_filter, step_lag
from surveyapp.core.sensors.noise_coefficients import coefficients_of
from surveyapp.core.simulate.sensors import flicker_noise
from surveyapp.workflows.filtering import LONGEST_LAG, PASS_BAND, STEP_SIGMAS
from surveyapp_models.arrays import Floats

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "5"))
SAMPLES = 100_000
SHARES = (0.1, 0.01, 0.001, 1e-4)
TAUS = (1, 16, 128, 1024, 8192)
TRUTH = {"Q": 0.5, "N": 1.0, "B": 0.3}
"""Per sample: sigma of a reading by quantisation, white noise, and the flicker floor."""


def series_of(seed: int) -> Floats:
    """One simulated series."""
    rng = np.random.default_rng([seed, 17])
    series = TRUTH["Q"] * np.diff(rng.normal(size=SAMPLES + 1))
    series += TRUTH["N"] * rng.normal(size=SAMPLES)
    return np.asarray(series + TRUTH["B"] * flicker_noise(SAMPLES, rng))


def five_powers(series: Floats) -> float:
    """B of a fit of 3Q^2/t^2 + N^2/t + (2 ln 2/pi) B^2 + K^2 t/3 + R^2 t^2/2, relative weights."""
    factors = octaves(series.size)
    variance = allan_curve(series, rate_hz=1.0, factors=factors).deviation ** 2
    tau = np.array(factors, dtype=np.float64)
    flat = np.full(tau.size, 2.0 * math.log(2.0) / math.pi)
    terms = np.column_stack([3.0 / tau**2, 1.0 / tau, flat, tau / 3.0, tau**2 / 2.0])
    solution, _ = nnls(terms / variance[:, None], np.ones(tau.size))
    return math.sqrt(solution[2])


def below_corner(series: Floats, highest_hz: float | None) -> float | None:
    """B as the program determines it, None where the record does not tell."""
    found = coefficients_of(series, interval=1.0, highest_hz=highest_hz)
    return next(item.value for item in found if item.symbol == "B")


def _change(after: float | None, before: float | None) -> float:
    if after is None or before is None or before == 0.0:
        return math.nan
    return 100.0 * (after / before - 1.0)


def line(name: FilterName, share: float) -> str:
    """One filter at one q / r."""
    ratios, powers, told = [], [], []
    for seed in range(RUNS):
        series = series_of(seed)
        r = 0.5 * float(np.mean(np.diff(series) ** 2))
        model = LocalLevel(share * r, r)
        after = run_filter(name, series, model, np.random.default_rng(seed)).estimate
        curves = [allan_curve(x, rate_hz=1.0, factors=TAUS).deviation for x in (series, after)]
        ratios.append(curves[1] / curves[0])
        powers.append(_change(five_powers(after), five_powers(series)))
        corner = PASS_BAND * model.steady_gain / (2.0 * math.pi)
        told.append(_change(below_corner(after, corner), below_corner(series, None)))
    lags = [
        step_lag(
            name,
            LocalLevel(share, 1.0),
            sigmas=sigmas,
            rng=np.random.default_rng(1),
            longest=LONGEST_LAG,
        )
        for sigmas in STEP_SIGMAS
    ]
    known = [value for value in told if math.isfinite(value)]
    own = f"{np.mean(known):+.0f} % ({len(known)} of {RUNS})" if known else "not determined"
    cells = " ".join(f"{value:.3f}" for value in np.mean(ratios, axis=0))
    steps = "/".join("never" if lag is None else f"{lag:.0f}" for lag in lags)
    return (
        f"{name} q/r {share:g}: lag at 2/20 sigma {steps}; deviation ratio at "
        f"{', '.join(str(t) for t in TAUS)} samples {cells}; B of five powers "
        f"{np.mean(powers):+.0f} %, B below the corner {own}"
    )


def run() -> Iterator[str]:
    """Every line."""
    for name in FILTERS:
        for share in SHARES:
            yield line(name, share)
