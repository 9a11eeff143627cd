"""Spectral lines of a long record: frequency, amplitude and the probability of a false alarm.

A line is named by what the catalogue says of its frequency or it stays unattributed. Lines are
taken out before block means are made, because they would come back in them at another frequency;
one that a covariate carries too is left to the effect of that covariate.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surveyapp.diagnosis.long_records.linefit import Sines, fit_sines
from surveyapp.diagnosis.long_records.spectrum import LOWEST, Spectrum, exceedance, spectrum
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Effect

ALARM = 0.05
"""Probability over all frequencies at which a peak is a line: that of the gate."""
MOST_LINES = 12
"""More of them are a band or a rattle, not lines."""
ROUNDS = 4
"""Weak lines show when the strong ones are gone."""
APART = 3.0
"""Cycles over the record within which the taper cannot tell two lines apart."""
JITTER = 0.1
"""Root mean square of the samples' distance from the even grid, in samples."""
LEAST_FILLED = 0.5
"""Share of an even grid that must hold samples."""


@dataclass(frozen=True, slots=True)
class SpectralLine:
    """One line.

    Parameters
    ----------
    frequency, sigma_frequency : float
        Cycles per unit of the position.
    amplitude, sigma_amplitude : float
        [SI].
    false_alarm : float
        Probability that noise has such a peak anywhere.
    effect : str
        Id of the effect that the catalogue has for this frequency; empty = unattributed.
    shared_with : str
        Column that carries the line too; it was then left in the record.
    """

    frequency: float
    sigma_frequency: float
    amplitude: float
    sigma_amplitude: float
    false_alarm: float
    effect: str = ""
    shared_with: str = ""

    def to_dict(self, scale: float) -> dict[str, Any]:
        """Keys of one entry of ``lines[]``; amplitudes in the printed unit."""
        return {
            "frequency": self.frequency,
            "sigma_frequency": self.sigma_frequency,
            "amplitude": self.amplitude / scale,
            "sigma_amplitude": self.sigma_amplitude / scale,
            "false_alarm": self.false_alarm,
            "effect": self.effect or None,
            "shared_with": self.shared_with or None,
        }


@dataclass(frozen=True, slots=True)
class LineSearch:
    """What was found.

    Parameters
    ----------
    lines : tuple of SpectralLine
        By frequency.
    signal : ndarray, shape (n,)
        What is to be taken out of the record, its mean not among it [SI].
    unsearched : str
        Why no lines could be looked for; empty if they were.
    crowded : bool
        Whether more stands out than can be lines.
    """

    lines: tuple[SpectralLine, ...]
    signal: Floats
    unsearched: str = ""
    crowded: bool = False


@dataclass(frozen=True, slots=True)
class Grid:
    """Even grid of a record: number of each sample on it and the spacing."""

    index: NDArray[np.intp]
    step: float

    @property
    def size(self) -> int:
        """Places of the grid."""
        return int(self.index[-1]) + 1

    def spread(self, values: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Values on the grid, 0 where a sample is missing, and where there is one."""
        full, filled = np.zeros(self.size), np.zeros(self.size, dtype=np.bool_)
        full[self.index] = values
        filled[self.index] = True
        return full, filled


def even_grid(position: Floats) -> Grid | str:
    """Grid of sorted positions, gaps allowed, or why there is none."""
    gaps = np.diff(position)
    middle = float(np.median(gaps))
    if not middle > 0.0:
        return "several samples have the same time"
    steps = np.rint(gaps / middle)
    if steps.min() < 1.0:
        return "the samples are not evenly spaced"
    index = np.concatenate([[0.0], np.cumsum(steps)])
    step = float((position[-1] - position[0]) / index[-1])
    off = position - position[0] - step * index
    if float(np.std(off)) > JITTER * step:
        return "the samples are not evenly spaced"
    if position.size < LEAST_FILLED * (index[-1] + 1.0):
        return "more than half of the samples are missing"
    return Grid(index.astype(np.intp), step)


def find_lines(
    position: Floats,
    values: Floats,
    *,
    columns: Mapping[str, Floats],
    effects: Sequence[Effect],
    slowest: float = 0.0,
) -> LineSearch:
    """Every line of a record.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Sorted.
    values : ndarray, shape (n,)
        Residuals of the model that stands [SI].
    columns : mapping
        Covariates that may carry a line too, each of shape (n,).
    effects : sequence of Effect
        Those that may name a line; their frequencies are in Hz, so the position must be seconds.
    slowest : float
        Cycles per unit of the position from which on lines are looked for.

    Returns
    -------
    LineSearch
    """
    grid = even_grid(position)
    if isinstance(grid, str):
        return LineSearch((), np.zeros(values.size), grid)
    u = (position - 0.5 * (position[0] + position[-1])) / (grid.step * grid.size)
    found = _Found(Sines(np.zeros(0), np.zeros(0), np.zeros(0)), ())
    crowded = False
    lowest = max(LOWEST, math.ceil(slowest * grid.step * grid.size))
    seen = spectrum(*grid.spread(detrended(u, values)), lowest=lowest)
    for _ in range(ROUNDS):
        peaks = _peaks(seen, found.sines.cycles)
        room = MOST_LINES - found.sines.cycles.size
        crowded = len(peaks) > room
        if not peaks[:room]:
            break
        begin = np.array([f for f, _ in peaks[:room]])
        sines = fit_sines(u, values, np.concatenate([found.sines.cycles, begin]))
        found = _Found(sines, (*found.alarms, *[p for _, p in peaks[:room]]))
        seen = spectrum(*grid.spread(detrended(u, values - sines.at(u))), lowest=lowest)
    carriers = _carriers(grid, u, found.sines.cycles, columns)
    named = [named_by(effects, columns, f / (grid.step * grid.size)) for f in found.sines.cycles]
    lines = _lines(grid, seen, found, tuple(zip(named, carriers, strict=True)))
    keep = np.array([not name for name in carriers], dtype=bool)
    out = Sines(found.sines.cycles[keep], found.sines.cosine[keep], found.sines.sine[keep])
    return LineSearch(lines, out.at(u), "", crowded)


@dataclass(frozen=True, slots=True)
class _Found:
    """Lines in the order in which they were found, with their false-alarm probabilities."""

    sines: Sines
    alarms: tuple[float, ...]


def detrended(u: Floats, values: Floats) -> Floats:
    """Values without their straight line."""
    centred = u - u.mean()
    slope = float(centred @ values) / float(centred @ centred)
    return np.asarray(values - values.mean() - slope * centred)


def _peaks(seen: Spectrum, known: Floats) -> list[tuple[float, float]]:
    """(cycles, false alarm) of the peaks that are not leakage of stronger ones, strongest first."""
    alarm = seen.false_alarm()
    high = np.flatnonzero(alarm <= ALARM)
    ratio = seen.power / np.maximum(seen.background, 1e-300)
    taken: list[int] = []
    for k in sorted(high.tolist(), key=lambda i: -float(seen.power[i])):
        if len(taken) > MOST_LINES:
            break
        leaked = sum(seen.power[i] * _leakage(abs(k - i)) for i in taken)
        if all(abs(k - f) >= APART for f in known) and seen.power[k] > 10.0 * leaked:
            taken.append(k)
    taken.sort(key=lambda i: -float(ratio[i]))
    return [(_between(seen, k), float(alarm[k])) for k in taken]


def _leakage(distance: float) -> float:
    """Envelope of the power that a line leaves at a distance, for the Hann taper; 1 nearby."""
    if distance < APART:
        return 1.0
    return float((2.0 / (math.pi * distance * (distance**2 - 1.0))) ** 2)


def _between(seen: Spectrum, k: int) -> float:
    """Frequency of a line from the two highest values beside it (Grandke 1983, Hann taper)."""
    size = np.abs(seen.transform)
    side = 1 if k + 1 < size.size and size[k + 1] >= size[k - 1] else -1
    ratio = float(size[k + side] / size[k])
    return k + side * max(0.0, (2.0 * ratio - 1.0) / (1.0 + ratio))


def _lines(
    grid: Grid, seen: Spectrum, found: _Found, names: Sequence[tuple[str, str]]
) -> tuple[SpectralLine, ...]:
    """Fitted sines with their sigmas; the noise of a line is the background at its frequency.

    sigma of an amplitude sqrt(2 S / n), of a frequency sqrt(6 S / n) / (pi A) cycles over the
    record: Rife and Boorstyn 1974, with the density S in place of a white variance.
    """
    length, count = grid.step * grid.size, grid.index.size
    result = []
    for i, cycles in enumerate(found.sines.cycles):
        k = int(np.clip(round(float(cycles)), 1, seen.background.size - 1))
        noise, amplitude = float(seen.background[k]), float(found.sines.amplitude[i])
        sigma = math.sqrt(6.0 * noise / count) / (math.pi * max(amplitude, 1e-300))
        result.append(
            SpectralLine(
                float(cycles) / length,
                sigma / length,
                amplitude,
                math.sqrt(2.0 * noise / count),
                found.alarms[i],
                *names[i],
            )
        )
    return tuple(sorted(result, key=lambda line: line.frequency))


def judges_lines(effect: Effect) -> bool:
    """Whether an effect is a line: it has a frequency to scan."""
    return any(g.unit == "Hz" for g in effect.grid)


def named_by(effects: Sequence[Effect], columns: Mapping[str, Floats], frequency: float) -> str:
    """Id of the first effect that has this frequency [Hz] on its grid, or an empty text.

    A continuous parameter covers everything between its ends; of a list, a value counts that lies
    within one cycle over the record.
    """
    for effect in effects:
        if any(need.name not in columns for need in effect.needs):
            continue
        for parameter in effect.grid:
            if parameter.unit != "Hz":
                continue
            values = parameter.values(columns)
            if values.size == 0:
                continue
            time = next((columns[n.name] for n in effect.needs if n.unit == "s"), None)
            near = 0.0 if time is None else 1.0 / max(float(np.ptp(time)), 1e-300)
            inside = parameter.continuous and values.min() <= frequency <= values.max()
            if inside or float(np.abs(values - frequency).min()) <= near:
                return effect.id
    return ""


def _carriers(
    grid: Grid, u: Floats, cycles: Floats, columns: Mapping[str, Floats]
) -> tuple[str, ...]:
    """Name of a column that has a line at the same frequency, or an empty text, for each line."""
    found = [""] * cycles.size
    if cycles.size == 0:
        return ()
    for name, values in columns.items():
        finite = np.isfinite(values)
        if not finite.any():
            continue
        filled = np.where(finite, values, values[finite].mean())
        rest = detrended(u, filled)
        if float(np.std(rest)) <= 1e-9 * float(np.abs(filled).max()):
            continue
        seen = spectrum(*grid.spread(rest))
        for i, f in enumerate(cycles):
            k = round(float(f))
            part = slice(max(k - 1, 1), k + 2)
            ratio = float((seen.power[part] / np.maximum(seen.background[part], 1e-300)).max())
            if 3.0 * float(exceedance(np.array(ratio), seen.window)) <= ALARM / cycles.size:
                found[i] = found[i] or name
    return tuple(found)
