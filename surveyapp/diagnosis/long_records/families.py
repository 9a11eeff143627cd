"""Harmonic families: lines at a fundamental and its multiples that none of them shows alone.

A motor leaves lines at 1, 2, 3 ... times one frequency. Together they are found where each by
itself drowns. A single strong line is no family: the test leaves the strongest member out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.long_records.linefit import Sines, fit_sines
from surveyapp.diagnosis.long_records.lines import detrended, even_grid
from surveyapp.diagnosis.long_records.spectrum import LOWEST, Spectrum, exceedance, spectrum
from surveyapp_models.arrays import Floats

MEMBERS = (2, 3)
"""Numbers of harmonics that are tried; both are paid for."""
MOST_HARMONICS = 8
ALARM = 0.05


@dataclass(frozen=True, slots=True)
class Family:
    """A fundamental and its harmonics.

    Parameters
    ----------
    fundamental, sigma_fundamental : float
        Cycles per unit of the position.
    harmonics : tuple of int
        Multiples that are in it.
    p : float
        Probability that noise has such a family anywhere.
    """

    fundamental: float
    sigma_fundamental: float
    harmonics: tuple[int, ...]
    p: float


def without_strongest(total: Floats, members: int) -> Floats:
    """Tail of the sum of unit exponentials less the largest of them.

    Of two: the smaller, rate 2. Of three: the two smaller are a/3 and a/3 + b/2 (Renyi 1953), so
    their sum has the rates 3/2 and 2.
    """
    if members == 2:
        return np.asarray(np.exp(-2.0 * total))
    return np.asarray(4.0 * np.exp(-1.5 * total) - 3.0 * np.exp(-2.0 * total))


def _surprise(seen: Spectrum) -> Floats:
    """-ln of the probability of each frequency's power, 0 where none is looked for."""
    found = np.zeros(seen.power.size)
    part = seen.searched
    ratio = seen.power[part] / np.maximum(seen.background[part], 1e-300)
    found[part] = -np.log(exceedance(ratio, seen.window))
    return found


def strongest_family(seen: Spectrum) -> tuple[float, int, float] | None:
    """(fundamental in cycles over the record, harmonics, family-wise p) of the best family."""
    surprise = _surprise(seen)
    best: tuple[float, int, float] | None = None
    for members in MEMBERS:
        top = surprise.size - 3
        base = np.arange(seen.lowest * members, top + 1)  # the highest harmonic, in whole cycles
        if base.size == 0:
            continue
        parts = np.array(
            [surprise[np.rint(base * h / members).astype(np.intp)] for h in range(1, members + 1)]
        )
        rest = parts.sum(axis=0) - parts.max(axis=0)
        rest[_images(seen, base, members)] = 0.0
        k = int(np.argmax(rest))
        single = float(np.clip(without_strongest(rest[k : k + 1], members)[0], 0.0, 1.0))
        p = -math.expm1(len(MEMBERS) * base.size * math.log1p(-min(single, 1.0 - 1e-15)))
        if best is None or p < best[2]:
            best = (float(base[k]) / members, members, p)
    return best


def _images(seen: Spectrum, base: NDArray[np.intp], members: int) -> NDArray[np.bool_]:
    """Where gaps of the record repeat the noise of one member in another, shape of ``base``."""
    found = np.zeros(base.size, dtype=np.bool_)
    for apart in range(1, members):
        found |= seen.images[np.rint(base * apart / members).astype(np.intp)]
    return found


def find_families(
    position: Floats, values: Floats, *, most: int = 4, slowest: float = 0.0
) -> tuple[tuple[Family, ...], Sines | None, float]:
    """Harmonic families of a record, one after the other with those before taken out.

    Parameters
    ----------
    position, values : ndarray, shape (n,)
        Sorted.
    most : int
    slowest : float
        Cycles per unit of the position from which on fundamentals are looked for.

    Returns
    -------
    families : tuple of Family
    sines : Sines or None
        All of their lines over ``u``, the position from -1/2 to 1/2; None without any.
    length : float
        Of the record, in units of the position.
    """
    grid = even_grid(position)
    if isinstance(grid, str):
        return (), None, float(np.ptp(position))
    length = grid.step * grid.size
    u = (position - 0.5 * (position[0] + position[-1])) / length
    families: list[Family] = []
    cycles = np.zeros(0)
    rest = values
    for _ in range(most):
        lowest = max(LOWEST, math.ceil(slowest * length))
        seen = spectrum(*grid.spread(detrended(u, rest)), lowest=lowest)
        found = strongest_family(seen)
        if found is None or found[2] > ALARM:
            break
        fundamental, numbers = _members(seen, found[0], found[1])
        new = np.array([fundamental * h for h in numbers])
        apart = [f for f in new if cycles.size == 0 or float(np.abs(cycles - f).min()) >= 2.0]
        if not apart:
            break
        cycles = np.concatenate([cycles, apart])
        sines = fit_sines(u, values, cycles)
        families.append(
            _fitted(sines, fundamental, numbers, found[2], seen=seen, count=u.size, length=length)
        )
        rest = values - sines.at(u)
    return tuple(families), fit_sines(u, values, cycles) if cycles.size else None, length


def _members(seen: Spectrum, fundamental: float, members: int) -> tuple[float, tuple[int, ...]]:
    """Which multiples stand out, the higher ones by themselves, and the fundamental refined."""
    surprise = _surprise(seen)
    numbers = list(range(1, members + 1))
    for h in range(members + 1, MOST_HARMONICS + 1):
        k = round(h * fundamental)
        if k >= surprise.size - 3:
            break
        if surprise[max(k - 1, 0) : k + 2].max() > -math.log(ALARM / (3 * MOST_HARMONICS)):
            numbers.append(h)
    kept = [h for h in numbers if h > members or surprise[round(h * fundamental)] > 1.0]
    return fundamental, tuple(kept)


def _fitted(
    sines: Sines,
    fundamental: float,
    numbers: tuple[int, ...],
    p: float,
    *,
    seen: Spectrum,
    count: int,
    length: float,
) -> Family:
    """Fundamental as the weighted mean of its members' frequencies."""
    weight, total = 0.0, 0.0
    for h in numbers:
        i = int(np.argmin(np.abs(sines.cycles - h * fundamental)))
        k = int(np.clip(round(float(sines.cycles[i])), 1, seen.background.size - 1))
        noise, amplitude = float(seen.background[k]), float(sines.amplitude[i])
        sigma = math.sqrt(6.0 * noise / count) / (math.pi * max(amplitude, 1e-300)) / h
        weight += sigma**-2
        total += float(sines.cycles[i]) / h * sigma**-2
    return Family(total / weight / length, weight**-0.5 / length, numbers, p)
