"""Allan deviation, overlapping or not, with intervals; of ten million samples in little memory.

Source: IEEE 952-1997 annex C; NIST SP 1065 (Riley 2008), equations of section 5.2 and the
equivalent degrees of freedom of table 5.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from surveyapp.domain.advance import PartDone
from surveyapp.domain.columns import PIECE, Room, in_memory, let_go, pieces
from surveyapp_models.arrays import Floats

Estimator = Literal["oadev", "adev"]

BLOCK: Final = 1 << 15
"""Samples of a block: three of them stay in the cache of a processor."""

HELD: Final = 16
"""Blocks after which the memory of a mapped series is given back."""

FEWEST: Final = 9
"""Samples below which there is no curve."""


@dataclass(frozen=True, slots=True)
class AllanCurve:
    """Allan deviation of a series.

    Parameters
    ----------
    taus : ndarray, shape (k,)
        Averaging times [s].
    deviation, low, high : ndarray, shape (k,)
        With the 95 % interval [unit of the series].
    factors : ndarray of int, shape (k,)
        Averaging times in samples.
    """

    taus: Floats
    deviation: Floats
    low: Floats
    high: Floats
    factors: tuple[int, ...]


def octaves(n: int) -> tuple[int, ...]:
    """Averaging factors 1, 2, 4 ... up to n / 4."""
    return tuple(1 << k for k in range(max(int(math.log2(n / 4.0)) + 1, 1))) if n >= 4 else ()


def phase_of(series: Floats, *, room: Room = in_memory) -> Floats:
    """Running sum of the series without its mean, begun with 0, shape (n + 1,).

    In blocks, so that nothing else of its length is made; ``room`` is where it lies.
    """
    n = series.size
    mean = float(sum(float(piece.sum()) for piece in pieces(series)) / n)
    store = room(n + 1)
    phase = np.asarray(store)
    phase[0] = 0.0
    total, start = 0.0, 0
    for part in pieces(series, BLOCK):
        piece = phase[start + 1 : start + part.size + 1]
        np.subtract(part, mean, out=piece)
        np.cumsum(piece, out=piece)
        piece += total
        total = float(piece[-1])
        start += part.size
        let_go(store)
    return store


def allan_variances(
    series: Floats,
    factors: Sequence[int],
    *,
    estimator: Estimator = "oadev",
    room: Room = in_memory,
    progress: PartDone | None = None,
) -> Floats:
    """Allan variance at each averaging factor, shape (k,) [unit^2 of the series].

    Parameters
    ----------
    series : ndarray, shape (n,)
    factors : sequence of int
        Averaging times in samples, each at most n / 2.
    estimator : str
        ``oadev`` (overlapping) or ``adev``.
    room : callable
        Where the running sum lies, which is as long as the series.
    progress : callable, optional
    """
    phase = phase_of(series, room=room)
    found = np.empty(len(factors))
    for index, m in enumerate(factors):
        if estimator == "adev":
            found[index] = _adjacent(phase, m)
        else:
            found[index] = _overlapping(phase, m)
        if progress is not None:
            progress((index + 1) / len(factors))
    return found


def _adjacent(phase: Floats, m: int) -> float:
    """The same of neighbouring means that share no sample."""
    total, terms = 0.0, 0
    for piece in pieces(phase, max(PIECE // m, 1) * m, overlap=2 * m):
        thin = piece[::m]
        second = thin[2:] - 2.0 * thin[1:-1] + thin[:-2]
        total, terms = total + float(second @ second), terms + second.size
    return total / (2.0 * m**2 * terms)


def _overlapping(phase: Floats, m: int) -> float:
    """Mean of (x[i + 2m] - 2 x[i + m] + x[i])^2 / 2 m^2."""
    terms = phase.size - 2 * m
    first, second = np.empty(min(BLOCK, terms)), np.empty(min(BLOCK, terms))
    total = 0.0
    plain, phase = phase, np.asarray(phase)
    for start in range(0, terms, BLOCK):
        size = min(BLOCK, terms - start)
        if start % (HELD * BLOCK) == 0:
            let_go(plain)
        a, b = first[:size], second[:size]
        middle = phase[start + m : start + m + size]
        np.subtract(phase[start + 2 * m : start + 2 * m + size], middle, out=a)
        np.subtract(middle, phase[start : start + size], out=b)
        np.subtract(a, b, out=a)
        total += float(a @ a)
    return total / (2.0 * m**2 * terms)


def allan_curve(
    series: Floats,
    *,
    rate_hz: float,
    factors: Sequence[int] | None = None,
    estimator: Estimator = "oadev",
    room: Room = in_memory,
    progress: PartDone | None = None,
) -> AllanCurve:
    """Allan deviation with 95 % intervals.

    Parameters
    ----------
    series : ndarray, shape (n,)
        Rates, accelerations or any other readings at a constant interval.
    rate_hz : float
    factors : sequence of int, optional
        By default ``octaves(n)``.
    estimator : str
    room : callable
        Where the running sum lies.
    progress : callable, optional

    Returns
    -------
    AllanCurve
    """
    chosen = tuple(octaves(series.size) if factors is None else factors)
    variance = allan_variances(series, chosen, estimator=estimator, room=room, progress=progress)
    deviation = np.sqrt(variance)
    freedom = np.array(
        [
            degrees_of_freedom(series.size + 1, m, slope, overlapping=estimator == "oadev")
            for m, slope in zip(chosen, _slopes(chosen, deviation), strict=True)
        ]
    )
    low, high = _interval(deviation, freedom)
    return AllanCurve(np.array(chosen) / rate_hz, deviation, low, high, chosen)


def _slopes(factors: Sequence[int], deviation: Floats) -> Floats:
    """Local slope of log deviation against log tau."""
    if len(factors) < 2 or np.any(deviation <= 0.0):
        return np.full(len(factors), -0.5)
    return np.asarray(np.gradient(np.log(deviation), np.log(np.array(factors, dtype=np.float64))))


def degrees_of_freedom(n: int, m: int, slope: float, *, overlapping: bool) -> float:
    """Equivalent degrees of freedom of an Allan variance, at least 1.

    Parameters
    ----------
    n : int
        Phases.
    m : int
        Averaging factor.
    slope : float
        Of the deviation against tau: decides which noise is assumed.
    overlapping : bool
    """
    if not overlapping:
        return max((n / m - 2.0) / 1.5, 1.0)
    if slope < -0.75:  # white phase noise: quantisation
        value = (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m))
    elif slope < -0.25:  # white noise of the rate
        value = (1.5 * (n - 1.0) / m - 2.0 * (n - 2.0) / n) * 4.0 * m**2 / (4.0 * m**2 + 5.0)
    elif slope < 0.25:  # flicker noise of the rate
        value = 2.0 * (n - 2.0) ** 2 / (2.3 * n - 4.9)
        if m > 1:
            value = 5.0 * n**2 / (4.0 * m * (n + 3.0 * m))
    else:  # random walk of the rate
        value = (n - 2.0) / m * ((n - 1.0) ** 2 - 3.0 * m * (n - 1.0) + 4.0 * m**2) / (n - 3.0) ** 2
    return max(value, 1.0)


def _interval(deviation: Floats, freedom: Floats) -> tuple[Floats, Floats]:
    from scipy.special import gammaincinv

    upper = 2.0 * gammaincinv(0.5 * freedom, 0.975)
    lower = 2.0 * gammaincinv(0.5 * freedom, 0.025)
    return (
        np.asarray(deviation * np.sqrt(freedom / upper)),
        np.asarray(deviation * np.sqrt(freedom / lower)),
    )
