"""Three filters on one description of a state: Kalman, Sage-Husa adaptive Kalman, particles.

State: x[k+1] = x[k] + w, w ~ (0, q); reading y[k] = x[k] + v, v ~ (0, r), variances in the unit of
the readings squared, per sample. The Kalman filter keeps its variance by the Joseph form; the
adaptive one estimates r from its innovations and keeps it positive; the particle filter resamples
when its weights degenerate. A filter that lost the series says so.

Sources: Kalman 1960; Joseph form, Bucy and Joseph 1968; Sage and Husa 1969; Gordon, Salmond and
Smith 1993.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from surveyapp.domain.advance import PartDone
from surveyapp_models.arrays import Floats

FilterName = Literal["kalman", "sage-husa", "particle"]
FILTERS: Final[tuple[FilterName, ...]] = ("kalman", "sage-husa", "particle")

FORGETTING: Final = 0.99
"""Forgetting factor b of the adaptive filter; d_k = (1 - b) / (1 - b^(k+1))."""

LEAST_SHARE: Final = 0.01
"""The adaptive r never falls below this share of the stated one: it stays positive."""

PARTICLES: Final = 300
RESAMPLE_BELOW: Final = 0.5
"""Share of the particles that the effective number may fall to before they are drawn anew."""

LOST: Final = 6.0
"""Innovations beyond so many sigma, sustained, are divergence."""

LOST_FOR: Final = 20
"""Samples in a row."""

BLOCK: Final = 1 << 16
"""Samples that are taken at once, so that nothing but the result has the length of a series."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class LocalLevel:
    """The state-space description that all three filters work on.

    Parameters
    ----------
    q : float
        Variance of the step of the state per sample [unit^2].
    r : float
        Variance of a reading [unit^2].
    """

    q: float
    r: float

    @property
    def steady_variance(self) -> float:
        """Variance of the estimate in the steady state [unit^2]: P^2 + q P - q r = 0."""
        return 0.5 * (-self.q + math.sqrt(self.q**2 + 4.0 * self.q * self.r))

    @property
    def steady_gain(self) -> float:
        """Gain of the steady state: P / r."""
        return self.steady_variance / self.r


@dataclass(frozen=True, slots=True)
class Filtered:
    """A filtered series.

    Parameters
    ----------
    estimate, variance : ndarray, shape (n,)
    lost_at : int or None
        First sample of sustained innovations beyond ``LOST`` sigma.
    lost : int
        Samples of which that is true.
    resamplings : int or None
        Of the particle filter.
    degenerate : int or None
        Samples at which every weight vanished.
    """

    estimate: Floats
    variance: Floats
    lost_at: int | None = None
    lost: int = 0
    resamplings: int | None = None
    degenerate: int | None = None


def run_filter(
    name: FilterName,
    series: Floats,
    model: LocalLevel,
    rng: np.random.Generator,
    *,
    progress: PartDone | None = None,
) -> Filtered:
    """Filter a series from its first reading on.

    Parameters
    ----------
    name : str
        One of ``FILTERS``.
    series : ndarray, shape (n,)
    model : LocalLevel
    rng : numpy.random.Generator
        Of the particle filter.
    progress : callable, optional
    """
    if name == "kalman":
        return kalman(series, model)
    if name == "sage-husa":
        return sage_husa(series, model, progress=progress)
    return particles(series, model, rng, progress=progress)


def kalman(series: Floats, model: LocalLevel) -> Filtered:
    """Kalman filter; the gains are those of the exact recursion until they stand still.

    In the steady state the estimate is an exponential mean, computed for the whole rest at once.
    """
    n = series.size
    estimate, variance = np.empty(n), np.empty(n)
    x, p, q, r = float(series[0]), model.r, model.q, model.r
    estimate[0], variance[0] = x, p
    beyond = np.zeros(n, dtype=bool)
    steady = model.steady_variance
    k = 1
    while k < n and abs(p - steady) > 1e-14 * steady:
        p += q
        gain = p / (p + r)
        nu = float(series[k]) - x
        beyond[k] = abs(nu) > LOST * math.sqrt(p + r)
        x += gain * nu
        p = (1.0 - gain) ** 2 * p + gain**2 * r  # Joseph form
        estimate[k], variance[k] = x, p
        k += 1
    if k < n:
        variance[k:] = p
        _steady(series[k:], estimate[k:], beyond[k:], (x, p + q, r))
    return _checked(estimate, variance, beyond)


def _steady(
    series: Floats, estimate: Floats, beyond: Mask, state: tuple[float, float, float]
) -> None:
    """The steady state from estimate, predicted variance and r on, block by block."""
    from scipy.signal import lfilter

    x, predicted, r = state
    gain = predicted / (predicted + r)
    limit = LOST * math.sqrt(predicted + r)
    for start in range(0, series.size, BLOCK):
        piece = series[start : start + BLOCK]
        made, _ = lfilter([gain], [1.0, gain - 1.0], piece, zi=np.array([(1.0 - gain) * x]))
        estimate[start : start + BLOCK] = made
        before = np.concatenate([[x], made[:-1]])
        beyond[start : start + BLOCK] = np.abs(piece - before) > limit
        x = float(made[-1])


def _values(series: Floats, progress: PartDone | None) -> Iterator[float]:
    """The readings after the first as plain numbers, a block of them at a time."""
    for start in range(1, series.size, BLOCK):
        yield from series[start : start + BLOCK].tolist()
        if progress is not None:
            progress(min((start + BLOCK) / series.size, 1.0))


def sage_husa(series: Floats, model: LocalLevel, *, progress: PartDone | None = None) -> Filtered:
    """Adaptive Kalman filter: r follows the innovations, guarded so that it stays positive.

    R_k = (1 - d) R + d max(nu^2 - P, share R_0), d = (1 - b) / (1 - b^(k+1)).
    """
    n = series.size
    estimate, variance, beyond = np.empty(n), np.empty(n), np.zeros(n, dtype=bool)
    x, p, q, r = float(series[0]), model.r, model.q, model.r
    estimate[0], variance[0] = x, p
    least, power = LEAST_SHARE * model.r, FORGETTING
    for k, value in enumerate(_values(series, progress), start=1):
        p += q
        nu = value - x
        power *= FORGETTING
        d = (1.0 - FORGETTING) / (1.0 - power)
        r = (1.0 - d) * r + d * max(nu * nu - p, least)
        total = p + r
        if nu * nu > LOST**2 * total:
            beyond[k] = True
        gain = p / total
        x += gain * nu
        p = (1.0 - gain) ** 2 * p + gain * gain * r
        estimate[k], variance[k] = x, p
    return _checked(estimate, variance, beyond)


def particles(
    series: Floats,
    model: LocalLevel,
    rng: np.random.Generator,
    *,
    count: int = PARTICLES,
    progress: PartDone | None = None,
) -> Filtered:
    """Bootstrap particle filter with systematic resampling.

    Where every weight vanishes the particles are drawn anew about the reading, which is counted.
    """
    n = series.size
    estimate, variance, beyond = np.empty(n), np.empty(n), np.zeros(n, dtype=bool)
    step, scale = math.sqrt(model.q), -0.5 / model.r
    cloud = float(series[0]) + math.sqrt(model.r) * rng.standard_normal(count)
    log_weight = np.zeros(count)
    weight = np.full(count, 1.0 / count)
    noise = np.empty(count)
    ladder = np.arange(count) / count
    resamplings = degenerate = 0
    estimate[0], variance[0] = float(cloud.mean()), model.r
    for k, value in enumerate(_values(series, progress), start=1):
        rng.standard_normal(out=noise)
        noise *= step
        cloud += noise
        spread = variance[k - 1] + model.q + model.r
        beyond[k] = abs(value - float(weight @ cloud)) > LOST * math.sqrt(spread)
        np.subtract(cloud, value, out=noise)
        np.multiply(noise, noise, out=noise)
        noise *= scale
        log_weight += noise
        largest = float(log_weight.max())
        if largest < -700.0:
            degenerate += 1
            cloud = value + math.sqrt(model.r) * rng.standard_normal(count)
            log_weight[:] = 0.0
            largest = 0.0
        np.subtract(log_weight, largest, out=log_weight)
        np.exp(log_weight, out=weight)
        weight /= float(weight.sum())
        mean = float(weight @ cloud)
        np.subtract(cloud, mean, out=noise)
        np.multiply(noise, noise, out=noise)
        estimate[k], variance[k] = mean, float(weight @ noise)
        if 1.0 / float(weight @ weight) < RESAMPLE_BELOW * count:
            resamplings += 1
            total = np.cumsum(weight)
            total[-1] = 1.0
            cloud = cloud[np.searchsorted(total, ladder + rng.random() / count)]
            log_weight[:] = 0.0
            weight[:] = 1.0 / count
    found = _checked(estimate, variance, beyond)
    return Filtered(
        found.estimate, found.variance, found.lost_at, found.lost, resamplings, degenerate
    )


def _checked(estimate: Floats, variance: Floats, beyond: Mask) -> Filtered:
    """Find sustained innovations that the filter cannot explain."""
    places = np.flatnonzero(beyond)
    last = places[LOST_FOR - 1 :]
    runs = last - places[: last.size] == LOST_FOR - 1
    first = int(places[np.argmax(runs)]) if runs.any() else None
    return Filtered(estimate, variance, first, int(places.size))


def step_lag(
    name: FilterName,
    model: LocalLevel,
    *,
    sigmas: float,
    rng: np.random.Generator,
    longest: int = 20_000,
) -> float | None:
    """Samples until a filter has followed 90 % of a step of so many sqrt(r), in noise.

    Returns
    -------
    float or None
        Median of three noises (the Kalman filter is linear: of none); None = not within
        ``longest``.
    """
    length = min(max(int(8.0 / model.steady_gain), 100), longest)
    settle = min(length, 4000)
    while True:
        lags = [
            _one_lag(name, model, sigmas * math.sqrt(model.r), (settle, length, rng))
            for _ in range(1 if name == "kalman" else 3)
        ]
        median = float(np.median(lags))
        if math.isfinite(median):
            return median
        if length >= longest:
            return None
        length = min(4 * length, longest)


def _one_lag(
    name: FilterName,
    model: LocalLevel,
    height: float,
    trial: tuple[int, int, np.random.Generator],
) -> float:
    settle, length, rng = trial
    series = np.zeros(settle + length)
    if name != "kalman":
        series = math.sqrt(model.r) * rng.standard_normal(settle + length)
    series[settle:] += height
    estimate = run_filter(name, series, model, rng).estimate
    reached = np.flatnonzero(estimate[settle:] >= 0.9 * height)
    return float(reached[0] + 1) if reached.size else math.inf
