"""Sines of unknown frequency in a record of any length, jointly with its offset and slope.

Normal equations are summed over pieces of the record, so that memory does not grow with it. Which
frequencies to begin with is decided elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats

PIECE = 65_536
"""Samples held as columns at once."""
ITERATIONS = 4
"""Gauss-Newton steps; from within half a frequency three reach the rounding."""


@dataclass(frozen=True, slots=True)
class Sines:
    """Fitted sines over ``u``, the position over the record from -1/2 to 1/2.

    Parameters
    ----------
    cycles : ndarray, shape (l,)
        Over the record.
    cosine, sine : ndarray, shape (l,)
        [SI].
    """

    cycles: Floats
    cosine: Floats
    sine: Floats

    @property
    def amplitude(self) -> Floats:
        """Amplitudes [SI]."""
        return np.hypot(self.cosine, self.sine)

    def at(self, u: Floats) -> Floats:
        """Sum of the sines, shape (n,) [SI]."""
        total = np.zeros(u.size)
        for f, c, s in zip(self.cycles, self.cosine, self.sine, strict=True):
            phase = 2.0 * np.pi * f * u
            total += c * np.cos(phase) + s * np.sin(phase)
        return total


def fit_sines(u: Floats, values: Floats, cycles: Floats) -> Sines:
    """Least squares of sines, an offset and a slope, beginning at given frequencies.

    Parameters
    ----------
    u : ndarray, shape (n,)
        From -1/2 to 1/2.
    values : ndarray, shape (n,)
        [SI].
    cycles : ndarray, shape (l,)
        Beginnings, each within half a cycle over the record of its line.

    Returns
    -------
    Sines
    """
    start = np.asarray(cycles, dtype=np.float64)
    found = Sines(start, np.zeros(start.size), np.zeros(start.size))
    for iteration in range(ITERATIONS):
        solution = _solve(u, values, found, frequencies=iteration > 0)
        count = start.size
        cosine, sine = solution[2 : 2 + count], solution[2 + count : 2 + 2 * count]
        if iteration == 0:
            found = Sines(start, cosine, sine)
            continue
        shift = np.clip(solution[2 + 2 * count :], -0.5, 0.5)
        moved = np.clip(found.cycles + shift, start - 1.0, start + 1.0)
        found = Sines(moved, cosine, sine)
    last = _solve(u, values, found, frequencies=False)
    return Sines(found.cycles, last[2 : 2 + start.size], last[2 + start.size :])


def _solve(u: Floats, values: Floats, sines: Sines, *, frequencies: bool) -> Floats:
    """Offset, slope, cosines, sines and shifts of the frequencies of one linearised fit."""
    count = 2 + (3 if frequencies else 2) * sines.cycles.size
    normal, right = np.zeros((count, count)), np.zeros(count)
    for begin in range(0, u.size, PIECE):
        part = u[begin : begin + PIECE]
        phase = 2.0 * np.pi * np.multiply.outer(part, sines.cycles)
        cos, sin = np.cos(phase), np.sin(phase)
        columns = [np.ones((part.size, 1)), part[:, None], cos, sin]
        if frequencies:
            slope = 2.0 * np.pi * part[:, None] * (sines.sine * cos - sines.cosine * sin)
            columns.append(slope)
        design = np.hstack(columns)
        normal += design.T @ design
        right += design.T @ values[begin : begin + PIECE]
    norms = np.sqrt(np.diag(normal))
    norms = np.where(norms > 0.0, norms, 1.0)
    scaled = np.linalg.lstsq(normal / np.outer(norms, norms), right / norms, rcond=1e-12)[0]
    return np.asarray(scaled / norms)
