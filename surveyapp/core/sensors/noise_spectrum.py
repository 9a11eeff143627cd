"""Noise coefficients from the spectrum: which of the power laws a series holds, and how much.

Power of a series y at the interval dt, s = sin(pi f dt), per sample (IEEE 952 annex C in discrete
form): quantisation Q^2 4 s^2 / dt^2; white N^2 / dt; flicker B^2 / (2 s); random walk
K^2 dt / (4 s^2). The spectrum is estimated with sine tapers (Riedel and Sidorenko 1995), which hold
back the leakage of a random walk, and fitted by the likelihood of Whittle: the Allan variances of
different times are far from independent, bins of a spectrum are nearly so, and that is what makes
the sigmas honest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import Final

import numpy as np

from surveyapp.domain.columns import PIECE, pieces
from surveyapp_models.arrays import Floats

TERMS: Final = ("Q", "N", "B", "K")
TAPERS: Final = 5
LONGEST: Final = 1 << 17
"""Samples of one transform; a longer series is cut into pieces and, for slow parts, averaged."""

BINS_PER_OCTAVE: Final = 6
LARGEST_FREEDOM: Final = 4000.0
"""No bin is trusted better than 2.2 %: a model is no truer than that."""

ENTRY: Final = 8.0
"""A term is in where it lowers minus twice the log likelihood by more: by simulation an absent
term enters in about .01 of records (chi-square alone, 6.63, counts each term for itself)."""

ROUNDS: Final = 60


@dataclass(frozen=True, slots=True)
class Spectrum:
    """Binned power per sample.

    Parameters
    ----------
    design : ndarray, shape (k, 4)
        Mean power of each term of unit coefficient in each bin.
    power : ndarray, shape (k,)
    freedom : ndarray, shape (k,)
        Degrees of freedom of each bin.
    frequency : ndarray, shape (k,)
        Mean frequency of each bin [Hz].
    """

    design: Floats
    power: Floats
    freedom: Floats
    frequency: Floats

    def below(self, highest_hz: float | None) -> Spectrum:
        """The bins up to a frequency [Hz]; None = all of them."""
        if highest_hz is None:
            return self
        kept = self.frequency <= highest_hz
        return Spectrum(
            self.design[kept], self.power[kept], self.freedom[kept], self.frequency[kept]
        )


@dataclass(frozen=True, slots=True)
class NoiseFit:
    """Squares of the coefficients.

    Parameters
    ----------
    squares : ndarray, shape (4,)
        Q^2 [unit^2 s^2], N^2 [unit^2 s], B^2 [unit^2], K^2 [unit^2 / s]; 0 = not in the model.
    relative : ndarray, shape (4,)
        Relative standard deviation of each square; inf where it is 0.
    deviance : float
        Minus twice the log likelihood.
    dispersion : float
        Pearson chi-square per degree of freedom: 1 where the power laws fit.
    """

    squares: Floats
    relative: Floats
    deviance: float
    dispersion: float


def unit_powers(frequency: Floats, interval: float) -> Floats:
    """Power per sample of each term of unit coefficient, shape (k, 4).

    Parameters
    ----------
    frequency : ndarray, shape (k,)
        [Hz], more than 0 and at most half the rate.
    interval : float
        [s]
    """
    s = np.sin(np.pi * frequency * interval)
    one = np.ones(frequency.size)
    return np.column_stack(
        [4.0 * s**2 / interval**2, one / interval, 0.5 / s, interval / (4.0 * s**2)]
    )


@lru_cache(maxsize=2)
def sine_tapers(n: int) -> Floats:
    """The first sine tapers, shape (TAPERS, n); not to be written into."""
    t = np.arange(1, n + 1)
    k = np.arange(1, TAPERS + 1)[:, None]
    found: Floats = np.sqrt(2.0 / (n + 1)) * np.sin(np.pi * k * t / (n + 1))
    found.flags.writeable = False
    return found


def _neighbours(largest: int) -> Floats:
    """Covariance of the estimates of frequencies j bins apart, relative, j = 0, 1, ..."""
    tapers = sine_tapers(256)
    phase = np.exp(-2j * np.pi * np.arange(largest)[:, None] * np.arange(256) / 256)
    total = np.zeros(largest)
    for a in tapers:
        for b in tapers:
            total += np.abs(phase @ (a * b)) ** 2
    return total / TAPERS**2


_CORRELATION: Final = _neighbours(12)


FIRST: Final = 2
"""First frequency of a transform that is used: below it the mean that was taken out rules."""

NEAR: Final = 48
"""Frequencies near zero at which the window of the tapers is allowed for."""


@lru_cache(maxsize=1)
def near_zero() -> Floats:
    """Mean tapered power over the power at the frequency itself, of B and of K, shape (NEAR, 2).

    A window of finite width sees the steep part of a spectrum too high. The series has its mean
    taken out, so that the window is zero at frequency zero, where a random walk has its pole.
    """
    n, pad = 1024, 16
    t = np.arange(n)
    frequency = np.fft.fftfreq(n * pad)
    frequency[0] = 1.0
    s = np.abs(np.sin(np.pi * frequency))
    powers = np.column_stack([0.5 / s, 0.25 / s**2])
    ratio = np.ones((NEAR, 2))
    for j in range(1, NEAR):
        total = np.zeros(2)
        for taper in sine_tapers(n):
            weight = taper * np.exp(-2j * np.pi * j * t / n)
            window = np.abs(np.fft.fft(weight - weight.mean(), n * pad)) ** 2
            total += window @ powers / (n * pad)
        here = math.sin(math.pi * j / n)
        ratio[j] = total / TAPERS / np.array([0.5 / here, 0.25 / here**2])
    return ratio


def freedom_of(count: int, stretches: int) -> float:
    """Degrees of freedom that so many neighbouring frequencies of so many stretches add.

    Neighbours share tapers: each counts for the share that is its own, so that the sum over bins
    is right although bins are fitted as if they were independent.
    """
    return 2.0 * stretches * count / float(_CORRELATION[0] + 2.0 * _CORRELATION[1:].sum())


def _transforms(series: Floats, length: int, slope: float) -> tuple[Floats, int]:
    """Mean power of pieces of a length at its frequencies, shape (length // 2 + 1,)."""
    tapers = sine_tapers(length)
    count = series.size // length
    power = np.zeros(length // 2 + 1)
    for number, piece in enumerate(pieces(series[: count * length], length)):
        level = piece
        if slope != 0.0:
            level = piece - slope * np.arange(number * length, (number + 1) * length)
        level = level - level.mean()
        for taper in tapers:
            power += np.abs(np.fft.rfft(level * taper)) ** 2
    return power / (TAPERS * max(count, 1)), count


def _averaged(series: Floats, factor: int, slope: float) -> Floats:
    """Means of so many samples each, without the slope."""
    whole = series.size // factor * factor
    size = max(PIECE // factor, 1) * factor
    parts = [piece.reshape(-1, factor).mean(axis=1) for piece in pieces(series[:whole], size)]
    means = np.concatenate(parts)
    if slope != 0.0:
        means -= slope * (factor * np.arange(means.size) + 0.5 * (factor - 1))
    return means


def _binned(
    power: Floats, band: tuple[float, float], grid: tuple[float, int, int]
) -> list[tuple[Floats, float, float, float]]:
    """Bins of equal width in log frequency between two frequencies [Hz]."""
    interval, length, stretches = grid
    frequency = np.arange(power.size) / (length * interval)
    usable = (frequency > band[0]) & (frequency <= band[1])
    usable[:FIRST] = False
    index = np.flatnonzero(usable)
    if not index.size:
        return []
    number = np.floor(np.log2(frequency[index]) * BINS_PER_OCTAVE).astype(int)
    found = []
    for bin_number in np.unique(number):
        members = index[number == bin_number]
        powers = unit_powers(frequency[members], interval)
        near = members < NEAR
        powers[near, 2:] *= near_zero()[members[near]]
        design = powers.mean(axis=0)
        freedom = min(freedom_of(members.size, stretches), LARGEST_FREEDOM)
        centre = float(frequency[members].mean())
        found.append((design, float(power[members].mean()), freedom, centre))
    return found


def spectrum_of(series: Floats, *, interval: float, slope: float = 0.0) -> Spectrum:
    """Binned spectrum of a series.

    Parameters
    ----------
    series : ndarray, shape (n,)
    interval : float
        [s]
    slope : float
        Taken out of the series first [unit per sample].

    Returns
    -------
    Spectrum
        Power per sample of the series itself; what was averaged for the slow part is scaled back.
    """
    bins: list[tuple[Floats, float, float, float]] = []
    top, current, step = 0.5 / interval, series, interval
    while True:
        length = min(LONGEST, current.size)
        power, count = _transforms(current, length, slope)
        last = length == current.size
        lowest = 0.0 if last else 64.0 / (length * step)
        bins += _binned(power, (lowest, top), (step, length, count))
        if last:
            break
        top = lowest
        factor = 1 << max(int(math.log2(0.05 / (lowest * step))), 1)
        current = _averaged(current, factor, slope)
        step, slope = step * factor, 0.0
    return Spectrum(
        np.array([b[0] for b in bins]),
        np.array([b[1] for b in bins]),
        np.array([b[2] for b in bins]),
        np.array([b[3] for b in bins]),
    )


def fit_terms(spectrum: Spectrum, terms: tuple[int, ...]) -> NoiseFit | None:
    """Fit the squares of some terms by scoring in their logarithms; None where one vanishes."""
    design = spectrum.design[:, terms]
    weights = 0.5 * spectrum.freedom
    scale = design * (weights / np.maximum(spectrum.power, 1e-300))[:, None]
    start = weights.sum() / (scale.sum(axis=0) * len(terms))
    x = np.log(np.maximum(start, 1e-300))
    deviance = _deviance(spectrum, design @ np.exp(x))
    for _ in range(ROUNDS):
        model = design @ np.exp(x)
        share = design * np.exp(x) / model[:, None]
        gradient = share.T @ (weights * (spectrum.power / model - 1.0))
        information = (share * weights[:, None]).T @ share
        step = np.linalg.lstsq(information, gradient, rcond=1e-12)[0]
        step = np.clip(step, -2.0, 2.0)
        for _ in range(12):
            trial = _deviance(spectrum, design @ np.exp(x + step))
            if trial <= deviance + 1e-12:
                break
            step = 0.5 * step
        change, deviance = deviance - trial, min(trial, deviance)
        x = x + step
        if change < 1e-9 and float(np.max(np.abs(step))) < 1e-4:
            break
    return _fitted(spectrum, terms, x, deviance)


def _fitted(
    spectrum: Spectrum, terms: tuple[int, ...], x: Floats, deviance: float
) -> NoiseFit | None:
    design = spectrum.design[:, terms]
    weights = 0.5 * spectrum.freedom
    model = design @ np.exp(x)
    share = design * np.exp(x) / model[:, None]
    if float(np.min(share.max(axis=0))) < 1e-3:
        return None
    information = (share * weights[:, None]).T @ share
    if np.linalg.cond(information) > 1e12:
        return None
    covariance = np.linalg.inv(information)
    pearson = float(weights @ (spectrum.power / model - 1.0) ** 2)
    freedom = max(spectrum.power.size - len(terms), 1)
    squares, relative = np.zeros(4), np.full(4, np.inf)
    squares[list(terms)] = np.exp(x)
    relative[list(terms)] = np.sqrt(np.diag(covariance))
    return NoiseFit(squares, relative, deviance, pearson / freedom)


def _deviance(spectrum: Spectrum, model: Floats) -> float:
    return float(spectrum.freedom @ (np.log(model) + spectrum.power / model))


def fit_noise(spectrum: Spectrum, *, allowed: tuple[int, ...] = (0, 1, 2, 3)) -> NoiseFit | None:
    """The set of terms that the spectrum asks for, each by more than ``ENTRY``.

    Parameters
    ----------
    spectrum : Spectrum
    allowed : tuple of int
        Places in ``TERMS``.

    Returns
    -------
    NoiseFit or None
        None where there is no power at all.
    """
    if not np.all(spectrum.power > 0.0) or spectrum.power.size < 4:
        return None
    best: tuple[float, NoiseFit] | None = None
    for size in range(1, len(allowed) + 1):
        for terms in combinations(allowed, size):
            fit = fit_terms(spectrum, terms)
            if fit is None:
                continue
            score = fit.deviance + ENTRY * size
            if best is None or score < best[0]:
                best = (score, fit)
    return None if best is None else best[1]
