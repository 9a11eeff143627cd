"""How far each frequency of a long record stands out of the smooth background beside it.

The background is a running median, which a line does not lift, so that the noise may be white,
correlated or 1/f. That it is itself an estimate from a few frequencies is in the false-alarm
probability exactly, not by simulation. Knows no model and fits no line.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from surveyapp_models.arrays import Floats

WINDOW = 61
"""Frequencies of one running median; they lie two apart, so the median spans twice as many."""
FIRST_BAND = 32
"""Frequencies below this number of cycles share one band of the coarse background."""
LOWEST = 13
"""Cycles over the record from which on a line is looked for; fewer are a shape of the record."""
LEAST_BACKGROUND = 2 * LOWEST
"""Frequencies that a background needs."""
IMAGE = 0.15
"""Correlation of the noise at two frequencies from which on they are no two witnesses. In the
pauses of a total station's log .05 to 1 give the same alarms and families (``bench
rate_line_constants``)."""
STRIDE = 6
"""The running median is taken at every sixth frequency: a tenth of its window."""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """Periodogram of a uniformly sampled record and its background.

    Parameters
    ----------
    transform : ndarray of complex, shape (m,)
        Of the tapered record, at 0, 1, 2 ... cycles over the record.
    power : ndarray, shape (m,)
        Mean square density: of white noise its variance [SI^2].
    background : ndarray, shape (m,)
        The same, lines left out [SI^2].
    window : int
        Frequencies behind each value of the background.
    lowest : int
        Cycles over the record from which on a line is looked for.
    images : ndarray of bool, shape (m,)
        Differences of frequency at which the gaps of the record repeat each other's noise.
    """

    transform: NDArray[np.complex128]
    power: Floats
    background: Floats
    window: int
    lowest: int
    images: NDArray[np.bool_]

    @property
    def searched(self) -> slice:
        """Frequencies at which a line is looked for: not the slowest ones, not the last two."""
        return slice(self.lowest, max(self.power.size - 2, self.lowest))

    def false_alarm(self) -> Floats:
        """Probability that noise stands out as much at any frequency, shape (m,); 1 elsewhere."""
        found = np.ones(self.power.size)
        part = self.searched
        count = found[part].size
        if count:
            background = np.maximum(self.background[part], 1e-300)
            tail = exceedance(self.power[part] / background, self.window)
            found[part] = -np.expm1(count * np.log1p(-np.minimum(tail, 1.0 - 1e-15)))
        return found


def median_bias(window: int) -> float:
    """Mean of the median of an odd number of unit exponentials.

    Source: Allen, Anderson, Brady, Brown and Creighton 2012, appendix B (there of a periodogram):
    1 - 1/2 + 1/3 - ... + 1/n.
    """
    k = np.arange(1.0, window + 1.0)
    return float(np.sum(np.where(k % 2.0 == 1.0, 1.0, -1.0) / k))


def exceedance(ratio: Floats, window: int) -> Floats:
    """Probability that noise reaches a ratio of power to background at one frequency.

    The power of noise is exponential. The median M of ``window = 2 m + 1`` of them, one of which
    is the frequency itself and large, is the sum of E_j / j for j = m ... 2 m with independent
    exponentials E_j (Renyi 1953, order statistics), and E exp(-s M) the product of j / (j + s).

    Parameters
    ----------
    ratio : ndarray
        Power / (M / median_bias).
    window : int

    Returns
    -------
    ndarray
    """
    half = (window - 1) // 2
    s = np.asarray(ratio, dtype=np.float64) / median_bias(window)
    total = np.zeros_like(s)
    for j in range(max(half, 1), 2 * half + 1):
        total += np.log1p(s / j)
    return np.asarray(np.maximum(np.exp(-total), 1e-300))


def hann(count: int) -> Floats:
    """Periodic Hann taper: a strong line or an offset of the ends does not leak over the rest."""
    return np.asarray(0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(count) + 0.5) / count))


def spectrum(values: Floats, filled: NDArray[np.bool_], *, lowest: int = LOWEST) -> Spectrum:
    """Periodogram and background of a detrended record on a uniform grid.

    Parameters
    ----------
    values : ndarray, shape (n,)
        0 where a sample is missing [SI].
    filled : ndarray of bool, shape (n,)
    lowest : int
        Cycles over the record from which on a line is looked for; the record may have been levelled
        below, so that the power there is not that of its noise and has no part in the background.

    Returns
    -------
    Spectrum
    """
    taper = hann(values.size)
    transform = np.fft.rfft(taper * values)
    power = np.abs(transform) ** 2 / float(np.sum(taper[filled] ** 2))
    first = min(lowest - LOWEST, max(power.size - LEAST_BACKGROUND, 0))
    background = np.empty_like(power)
    background[first:], window = _background(power[first:])
    background[:first] = background[first]
    images = np.zeros(power.size, dtype=np.bool_)
    if not filled.all():
        gaps = np.abs(np.fft.rfft(np.where(filled, taper**2, 0.0)))
        images = gaps > IMAGE * gaps[0]
    return Spectrum(transform, power, background, window, lowest, images)


def _background(power: Floats) -> tuple[Floats, int]:
    """Running median over the record flattened by a coarse background, and its window."""
    coarse = _coarse(power)
    flat = power / coarse
    result = np.empty_like(power)
    # Neighbours share the taper: every second frequency is independent (correlation 1/36).
    half = (power.size - 1) // 2
    window = min(WINDOW, half - 1 if half % 2 == 0 else half)
    for parity in (1, 2):
        result[parity::2] = _running_median(flat[parity::2], window)
    result[0] = result[1] if result.size > 1 else 1.0
    return np.asarray(result * coarse / median_bias(window)), window


def _running_median(values: Floats, window: int) -> Floats:
    starts = np.unique(np.append(np.arange(0, values.size - window, STRIDE), values.size - window))
    views = np.lib.stride_tricks.sliding_window_view(values, window)[starts]
    medians = np.median(views, axis=1)
    wanted = np.clip(np.arange(values.size) - window // 2, 0, values.size - window)
    nearest = np.clip(np.searchsorted(starts, wanted - STRIDE // 2), 0, starts.size - 1)
    return np.asarray(medians[nearest])


def _coarse(power: Floats) -> Floats:
    """Mean logarithm of the power in octaves, joined by straight lines over log frequency.

    It takes the slope out of the median's window and need not be right in level.
    """
    cycles = np.arange(1.0, power.size)
    logs = np.log(np.maximum(power[1:], 1e-300))
    edges = [2]
    step = FIRST_BAND
    while step < power.size // 2:
        edges.append(step)
        step *= 2
    edges.append(power.size)
    at = np.log(cycles)
    centres = [float(at[a - 1 : b - 1].mean()) for a, b in pairwise(edges)]
    levels = [float(logs[a - 1 : b - 1].mean()) for a, b in pairwise(edges)]
    return np.asarray(np.exp(np.append(levels[0], _piecewise(at, centres, levels))))


def _piecewise(at: Floats, centres: list[float], levels: list[float]) -> Floats:
    """Straight lines through the levels, the first and the last continued."""
    if len(centres) < 2:
        return np.full(at.size, levels[0])
    c, v = np.array(centres), np.array(levels)
    i = np.clip(np.searchsorted(c, at) - 1, 0, c.size - 2)
    slope = (v[i + 1] - v[i]) / (c[i + 1] - c[i])
    return np.asarray(v[i] + slope * (at - c[i]))
