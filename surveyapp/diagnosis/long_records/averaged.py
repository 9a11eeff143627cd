"""Spectrum of a record that is too long for one transform: blocks of it, averaged.

Memory does not grow with the record. A line keeps its height while the noise about the background
becomes smaller, so that weak lines are found as well as by one long transform, at a frequency that
is told to a fraction of the block's resolution.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.statistics.distributions import chi_square_tail
from surveyapp.diagnosis.long_records.spectrum import LOWEST, hann
from surveyapp_models.arrays import Floats

BLOCK = 1 << 18
"""Samples of one transform."""
HALF_WINDOW = 50
"""Frequencies on either side behind the background of one."""
GUARD = 3
"""Of them nearest to the frequency itself, which the taper shares with it."""


@dataclass(frozen=True, slots=True)
class AveragedSpectrum:
    """Mean periodogram of the blocks.

    Parameters
    ----------
    power, background : ndarray, shape (m,)
        Of white noise its variance [SI^2].
    blocks, block : int
        How many, and samples of each.
    """

    power: Floats
    background: Floats
    blocks: int
    block: int

    def lines(self, *, alarm: float = 0.05) -> list[tuple[float, float, float]]:
        """(cycles per sample, amplitude, false-alarm probability) of each line, by frequency.

        The mean of K exponentials over the background is chi-square with 2 K degrees of freedom.
        """
        ratio = self.power / np.maximum(self.background, 1e-300)
        top = self.power.size - 2
        peaks = np.flatnonzero((ratio[1:-1] >= ratio[:-2]) & (ratio[1:-1] > ratio[2:])) + 1
        peaks = peaks[(peaks >= LOWEST) & (peaks < top)]
        count = max(top - LOWEST, 1)
        found: list[tuple[float, float, float]] = []
        taken: list[int] = []
        for k in sorted(peaks.tolist(), key=lambda i: -float(ratio[i])):
            single = chi_square_tail(2.0 * self.blocks * float(ratio[k]), 2.0 * self.blocks)
            p = -math.expm1(count * math.log1p(-min(single, 1.0 - 1e-15)))
            if p > alarm:
                break
            if any(abs(k - i) <= GUARD for i in taken):
                continue
            taken.append(k)
            found.append((*self._located(k), p))
        return sorted(found)

    def _located(self, k: int) -> tuple[float, float]:
        """Frequency and amplitude of a peak from its two highest bins (Grandke 1983, Hann)."""
        size = np.sqrt(np.maximum(self.power - self.background, 0.0))
        side = 1 if size[k + 1] >= size[k - 1] else -1
        ratio = float(size[k + side] / max(size[k], 1e-300))
        shift = max(0.0, (2.0 * ratio - 1.0) / (1.0 + ratio))
        # power of a sine A at the centre of a bin: A^2 n / 6 with the Hann taper's sums
        lobe = _lobe(shift)
        amplitude = float(size[k]) / lobe * math.sqrt(6.0 / self.block)
        return (k + side * shift) / self.block, amplitude


def _lobe(shift: float) -> float:
    """Height of the Hann taper's lobe at a distance in bins, 1 at the centre."""
    if abs(shift) < 1e-9:
        return 1.0
    return math.sin(math.pi * shift) / (math.pi * shift) / (1.0 - shift**2)


def averaged_spectrum(pieces: Iterable[Floats], *, block: int = BLOCK) -> AveragedSpectrum:
    """Mean periodogram of a stream.

    Parameters
    ----------
    pieces : iterable of ndarray
        The record in order, in pieces of any length, evenly sampled.
    block : int
        Samples of one transform; the rest of the record that fills none is left out.
    """
    taper = hann(block)
    weight = float(np.sum(taper**2))
    total: Floats | None = None
    count = 0
    held = np.empty(block)
    filled = 0
    u = np.arange(block) - 0.5 * (block - 1)
    spread = float(u @ u)
    for piece in pieces:
        start = 0
        while start < piece.size:
            take = min(block - filled, piece.size - start)
            held[filled : filled + take] = piece[start : start + take]
            filled, start = filled + take, start + take
            if filled == block:
                rest = held - held.mean()
                rest -= u * (float(u @ rest) / spread)
                transform: NDArray[np.complex128] = np.fft.rfft(taper * rest)
                power = (transform.real**2 + transform.imag**2) / weight
                total = power if total is None else total + power
                count, filled = count + 1, 0
    if total is None:
        raise ValueError(f"the record holds fewer than {block} samples")
    mean = total / count
    # the median of chi-square of 2 K over its mean (Wilson and Hilferty 1931)
    lower = (1.0 - 1.0 / (9.0 * count)) ** 3
    return AveragedSpectrum(mean, _background(mean) / lower, count, block)


def _background(power: Floats) -> Floats:
    """Median of the neighbours, their nearest left out."""
    window = 2 * HALF_WINDOW + 1
    padded = np.pad(power, HALF_WINDOW, mode="reflect")
    views = np.lib.stride_tricks.sliding_window_view(padded, window)
    result = np.empty_like(power)
    for first in range(0, power.size, 4096):
        part = views[first : first + 4096]
        outer = np.concatenate(
            [part[:, : HALF_WINDOW - GUARD], part[:, HALF_WINDOW + GUARD + 1 :]], axis=1
        )
        result[first : first + 4096] = np.median(outer, axis=1)
    return result
