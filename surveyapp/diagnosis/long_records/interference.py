"""Interference lines of a sensor's record: single lines, families, and the noise without them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.long_records.averaged import BLOCK, averaged_spectrum
from surveyapp.diagnosis.long_records.families import Family, find_families
from surveyapp.diagnosis.long_records.linefit import fit_sines
from surveyapp.diagnosis.long_records.lines import even_grid, find_lines
from surveyapp.domain.line_spectrum import HarmonicFamily, InterferenceLine, Scatter
from surveyapp_models.arrays import Floats

LONGEST = 1 << 20
"""Samples up to which one transform serves."""
PLOT_POINTS = 256
BLOCK_S = 10.0
SAME_LINE = 2.0
"""Cycles over the record within which two lines are one."""


@dataclass(frozen=True, slots=True)
class Interference:
    """What was found in one column.

    Parameters
    ----------
    lines : tuple of InterferenceLine
    families : tuple of HarmonicFamily
    rest : ndarray, shape (n,)
        The column without its mean and its lines.
    unsearched : str
        Why no line could be looked for; empty if they were.
    """

    lines: tuple[InterferenceLine, ...]
    families: tuple[HarmonicFamily, ...]
    rest: Floats
    unsearched: str = ""


def find_interference(time_s: Floats, values: Floats) -> Interference:
    """Lines and families of a record of any length.

    Parameters
    ----------
    time_s, values : ndarray, shape (n,)
        Sorted by time.
    """
    centred = values - values.mean()
    grid = even_grid(time_s) if time_s.size > 64 else "fewer than 65 samples"
    if isinstance(grid, str):
        return Interference((), (), centred, grid)
    if values.size > LONGEST:
        return _long(time_s, centred)
    search = find_lines(time_s, centred, columns={}, effects=())
    families, sines, length = find_families(time_s, centred)
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


def _long(time_s: Floats, centred: Floats) -> Interference:
    """A very long record: averaged blocks; families among the lines that stand out."""
    step = float(time_s[-1] - time_s[0]) / (time_s.size - 1)
    size = 1 << 16
    pieces = (centred[k : k + size] for k in range(0, centred.size, size))
    seen = averaged_spectrum(pieces)
    resolution = 1.0 / (seen.block * step)
    lines = []
    for cycles, amplitude, p in seen.lines():
        k = min(max(round(cycles * seen.block), 1), seen.background.size - 1)
        noise = float(seen.background[k])
        sigma = math.sqrt(6.0 * noise / centred.size) / (math.pi * max(amplitude, 1e-300))
        spread = math.sqrt(2.0 * noise / centred.size)
        lines.append(InterferenceLine(cycles / step, sigma * resolution, amplitude, spread, p))
    families = _families_among(lines, 2.0 * resolution)
    rest = _without(centred, step, [line.frequency_hz for line in lines])
    return Interference(tuple(lines), families, rest)


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


def _without(values: Floats, step: float, frequencies: list[float]) -> Floats:
    """The record less its lines, fitted anew in each block: their phase may wander."""
    rest = values.copy()
    if not frequencies:
        return rest
    t = np.arange(BLOCK) * step
    columns = [f(2.0 * np.pi * w * t) for w in frequencies for f in (np.cos, np.sin)]
    design = np.column_stack(columns)
    for first in range(0, values.size, BLOCK):
        part = rest[first : first + BLOCK]
        here = design[: part.size]
        if part.size > 4 * here.shape[1]:
            solution, *_ = np.linalg.lstsq(here, part, rcond=None)
            part -= here @ solution
    return rest


def scatter_of(values: Floats, rest: Floats, *, rate_hz: float, unit: str) -> Scatter:
    """Standard deviations of samples and of 10 s means, with and without the lines."""
    count = max(round(BLOCK_S * rate_hz), 1)

    def of_means(series: Floats) -> float | None:
        whole = series[: series.size - series.size % count]
        if whole.size < 3 * count:
            return None
        return float(np.std(whole.reshape(-1, count).mean(axis=1), ddof=1))

    return Scatter(
        float(np.std(values, ddof=1)),
        float(np.std(rest, ddof=1)),
        of_means(values),
        of_means(rest),
        unit,
    )


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
    for k in range(count):
        part = values[k * block : (k + 1) * block]
        total += np.abs(np.fft.rfft(taper * (part - part.mean()))) ** 2
    density = total / count / float(np.sum(taper**2)) * 2.0 / rate_hz
    frequency = np.arange(density.size) * rate_hz / block
    bands = np.array_split(np.arange(1, density.size), min(PLOT_POINTS, density.size - 1))
    return (
        np.array([frequency[b[-1]] for b in bands]),
        np.array([density[b].max() for b in bands]),
    )
