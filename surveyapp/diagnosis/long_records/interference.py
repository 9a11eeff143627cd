"""Interference lines of a sensor's record: single lines, families, and the noise without them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.long_records.averaged import BLOCK, averaged_spectrum
from surveyapp.diagnosis.long_records.families import Family, find_families
from surveyapp.diagnosis.long_records.linefit import fit_sines
from surveyapp.diagnosis.long_records.lines import JITTER, LEAST_FILLED, even_grid, find_lines
from surveyapp.domain.columns import pieces
from surveyapp.domain.line_spectrum import HarmonicFamily, InterferenceLine, Scatter
from surveyapp_models.arrays import Floats

LONGEST = 1 << 20
"""Samples up to which one transform serves."""
PLOT_POINTS = 256
PIECE = 1 << 16
"""Samples that are looked at at once."""
BLOCK_S = 10.0
SAME_LINE = 2.0
"""Cycles over the record within which two lines are one."""


@dataclass(frozen=True, slots=True)
class Remainder:
    """A record without its lines, block by block: nothing of its length is made beside it.

    The lines are fitted anew in each block: over so long a time their phase may wander.

    Parameters
    ----------
    values : ndarray, shape (n,)
    step : float
        [s]
    frequencies : tuple of float
        [Hz]
    """

    values: Floats
    step: float
    frequencies: tuple[float, ...] = ()

    def __iter__(self) -> Iterator[Floats]:
        """Blocks of the record in order."""
        t = np.arange(BLOCK) * self.step
        waves = [f(2.0 * np.pi * w * t) for w in self.frequencies for f in (np.cos, np.sin)]
        design = np.column_stack([np.ones(BLOCK), *waves])
        for part in pieces(self.values, BLOCK):
            here = design[: part.size]
            if waves and part.size > 4 * here.shape[1]:
                solution, *_ = np.linalg.lstsq(here, part, rcond=None)
                part = part - here[:, 1:] @ solution[1:]
            yield part


@dataclass(frozen=True, slots=True)
class Interference:
    """What was found in one column.

    Parameters
    ----------
    lines : tuple of InterferenceLine
    families : tuple of HarmonicFamily
    rest : ndarray, shape (n,), or Remainder
        The column without its lines; of a long record block by block.
    unsearched : str
        Why no line could be looked for; empty if they were.
    """

    lines: tuple[InterferenceLine, ...]
    families: tuple[HarmonicFamily, ...]
    rest: Floats | Remainder
    unsearched: str = ""


def find_interference(time_s: Floats, values: Floats, *, slowest_hz: float = 0.0) -> Interference:
    """Lines and families of a record of any length.

    Parameters
    ----------
    time_s, values : ndarray, shape (n,)
        Sorted by time.
    slowest_hz : float
        Frequency from which on lines are looked for: of a record whose parts were levelled.
    """
    if values.size > LONGEST:
        return _long(time_s, values, slowest_hz)
    centred = values - values.mean()
    grid = even_grid(time_s) if time_s.size > 64 else "fewer than 65 samples"
    if isinstance(grid, str):
        return Interference((), (), centred, grid)
    search = find_lines(time_s, centred, columns={}, effects=(), slowest=slowest_hz)
    families, sines, length = find_families(time_s, centred, slowest=slowest_hz)
    singles = [
        InterferenceLine(
            line.frequency,
            line.sigma_frequency,
            line.amplitude,
            line.sigma_amplitude,
            line.false_alarm,
            _family_of(line.frequency, families, length),
        )
        for line in search.lines
    ]
    cycles = np.array([line.frequency for line in search.lines]) * length
    added: list[InterferenceLine] = []
    if sines is not None:
        new = [c for c in sines.cycles if np.abs(cycles - c).min(initial=9e9) > SAME_LINE]
        cycles = np.concatenate([cycles, new])
    u = (time_s - 0.5 * (time_s[0] + time_s[-1])) / length
    rest = centred
    if cycles.size:
        fitted = fit_sines(u, centred, cycles)
        rest = centred - fitted.at(u)
        noise = float(np.std(rest))
        for i in range(len(singles), cycles.size):
            f = float(fitted.cycles[i]) / length
            amplitude = float(fitted.amplitude[i])
            number = _family_of(f, families, length)
            sigma = math.sqrt(6.0 / values.size) * noise / (math.pi * max(amplitude, 1e-300))
            p = families[number].p if number is not None else 1.0
            spread = noise * math.sqrt(2.0 / values.size)
            added.append(InterferenceLine(f, sigma / length, amplitude, spread, p, number))
    told = tuple(
        HarmonicFamily(f.fundamental, f.sigma_fundamental, f.harmonics, f.p) for f in families
    )
    lines = tuple(sorted([*singles, *added], key=lambda line: line.frequency_hz))
    return Interference(lines, told, rest)


def _family_of(frequency: float, families: tuple[Family, ...], length: float) -> int | None:
    for i, family in enumerate(families):
        for h in family.harmonics:
            if abs(frequency - h * family.fundamental) * length <= SAME_LINE * max(h, 1):
                return i
    return None


def _long(time_s: Floats, values: Floats, slowest_hz: float) -> Interference:
    """A very long record: averaged blocks; families among the lines that stand out."""
    step = float(time_s[-1] - time_s[0]) / (time_s.size - 1)
    uneven = _uneven(time_s)
    if uneven:
        return Interference((), (), Remainder(values, step), uneven)
    middle = float(np.mean(values[:PIECE]))
    seen = averaged_spectrum(piece - middle for piece in pieces(values, PIECE))
    resolution = 1.0 / (seen.block * step)
    lines = []
    for cycles, amplitude, p in seen.lines():
        if cycles / step < slowest_hz:
            continue
        k = min(max(round(cycles * seen.block), 1), seen.background.size - 1)
        noise = float(seen.background[k])
        sigma = math.sqrt(6.0 * noise / values.size) / (math.pi * max(amplitude, 1e-300))
        spread = math.sqrt(2.0 * noise / values.size)
        lines.append(InterferenceLine(cycles / step, sigma * resolution, amplitude, spread, p))
    families = _families_among(lines, 2.0 * resolution)
    rest = Remainder(values, step, tuple(line.frequency_hz for line in lines))
    return Interference(tuple(lines), families, rest)


def _uneven(time_s: Floats) -> str:
    """Why a long record has no even grid, gaps allowed; empty if it has. As ``even_grid``."""
    usual = float(np.median(np.diff(time_s[:PIECE])))
    if not usual > 0.0:
        return "several samples have the same time"
    whole = 0.0
    for part in pieces(time_s, PIECE, overlap=1):
        steps = np.rint(np.diff(part) / usual)
        if steps.min() < 1.0:
            return "the samples are not evenly spaced"
        whole += float(steps.sum())
    if time_s.size < LEAST_FILLED * (whole + 1.0):
        return "more than half of the samples are missing"
    step = float(time_s[-1] - time_s[0]) / whole
    index, moments = 0.0, _Moments()
    for part in pieces(time_s, PIECE, overlap=1):
        numbers = index + np.cumsum(np.rint(np.diff(part) / usual))
        moments.add(part[1:] - time_s[0] - step * numbers)
        index = float(numbers[-1])
    return "the samples are not evenly spaced" if moments.sd(0) > JITTER * step else ""


class _Moments:
    """Mean and sum of squares about it, piece by piece (Chan, Golub and LeVeque 1983)."""

    def __init__(self) -> None:
        self.count, self.mean, self.squares = 0, 0.0, 0.0

    def add(self, part: Floats) -> None:
        """Take a piece in."""
        if part.size == 0:
            return
        mean = float(part.mean())
        off = mean - self.mean
        total = self.count + part.size
        self.squares += float(np.sum((part - mean) ** 2)) + off**2 * self.count * part.size / total
        self.mean += off * part.size / total
        self.count = total

    def sd(self, ddof: int) -> float:
        """Standard deviation of all pieces."""
        return math.sqrt(self.squares / max(self.count - ddof, 1))


def _families_among(lines: list[InterferenceLine], slack: float) -> tuple[HarmonicFamily, ...]:
    """Lines at small multiples of the lowest of them, each with its own small probability."""
    found, used = [], set()
    for i, base in enumerate(lines):
        if i in used:
            continue
        members = {1: i}
        for j in range(i + 1, len(lines)):
            h = round(lines[j].frequency_hz / base.frequency_hz)
            if 2 <= h <= 8 and abs(lines[j].frequency_hz - h * base.frequency_hz) <= slack * h:
                members.setdefault(h, j)
        if len(members) > 1:
            used |= set(members.values())
            p = min(1.0, max(lines[j].false_alarm_probability for j in members.values()))
            found.append(
                HarmonicFamily(base.frequency_hz, base.sigma_hz, tuple(sorted(members)), p)
            )
    return tuple(found)


def scatter_of(values: Floats, rest: Floats | Remainder, *, rate_hz: float, unit: str) -> Scatter:
    """Standard deviations of samples and of 10 s means, with and without the lines."""
    count = max(round(BLOCK_S * rate_hz), 1)
    before, before_10s = _scatter(pieces(values, PIECE), count)
    left = rest if isinstance(rest, Remainder) else pieces(rest, PIECE)
    after, after_10s = _scatter(left, count)
    return Scatter(before, after, before_10s, after_10s, unit)


def deviation_of(values: Floats) -> float:
    """Standard deviation of the samples of a record of any length."""
    samples = _Moments()
    for piece in pieces(values, PIECE):
        samples.add(piece)
    return samples.sd(1)


def _scatter(parts: Iterable[Floats], count: int) -> tuple[float, float | None]:
    """Standard deviation of samples and of means of ``count`` of them; None from too few."""
    samples, means = _Moments(), _Moments()
    held = np.zeros(0)
    for piece in parts:
        samples.add(piece)
        held = np.concatenate([held, piece])
        whole = held.size - held.size % count
        means.add(held[:whole].reshape(-1, count).mean(axis=1))
        held = held[whole:]
    return samples.sd(1), means.sd(1) if means.count >= 3 else None


def plotted_density(values: Floats, *, rate_hz: float) -> tuple[Floats, Floats]:
    """Power spectral density in at most 256 bands, each its largest value: lines stay visible.

    Returns
    -------
    frequency, density : ndarray
        Upper end of the bands [Hz], [unit^2/Hz].
    """
    block = min(values.size, 1 << 14)
    block -= block % 2
    if block < 16:
        return np.zeros(0), np.zeros(0)
    count = values.size // block
    taper = 0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(block) + 0.5) / block)
    total = np.zeros(block // 2 + 1)
    for part in pieces(values[: count * block], block):
        total += np.abs(np.fft.rfft(taper * (part - part.mean()))) ** 2
    density = total / count / float(np.sum(taper**2)) * 2.0 / rate_hz
    frequency = np.arange(density.size) * rate_hz / block
    bands = np.array_split(np.arange(1, density.size), min(PLOT_POINTS, density.size - 1))
    return (
        np.array([frequency[b[-1]] for b in bands]),
        np.array([density[b].max() for b in bands]),
    )
