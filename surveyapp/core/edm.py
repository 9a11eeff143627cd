"""Distances of an EDM on a line of pillars: reduction, constant, cyclic error, atmosphere.

The pillars' positions along the line are unknowns, so no reference lengths are needed. A pointing
repeated at once shares centring and atmosphere with its neighbour: rms values are those of all
readings, but constants and cyclic terms are judged on the means of the sights, else a tenth of a
millimetre looks proven by repetition alone.

Source: J. M. Rueger (1996), Electronic Distance Measurement, 4th ed., ch. 5 (atmosphere), 12, 13
(instrument errors, baselines).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats

EVIDENCE = 10.0
"""Difference of -2 log likelihood per sight mean above which one treatment of the atmosphere is
preferred without doubt (very strong, after Kass & Raftery 1995, J. Am. Stat. Assoc. 90, 773)."""
LEVEL = 0.05


@dataclass(frozen=True, slots=True)
class EdmReading:
    """One reading of a slope distance between two pillars.

    Parameters
    ----------
    start, end : str
    slope_m : float
    start_height_m, end_height_m : float
        Heights of instrument and reflector, pillar height included.
    temperature_c, pressure_hpa, humidity_percent : float
    """

    start: str
    end: str
    slope_m: float
    start_height_m: float
    end_height_m: float
    temperature_c: float = 12.0
    pressure_hpa: float = 1013.25
    humidity_percent: float = 60.0


@dataclass(frozen=True, slots=True)
class BaselineFit:
    """Adjusted baseline.

    Parameters
    ----------
    sigma0_m : float
        Standard deviation of one reading after the fit, sqrt(v'v/dof).
    dof : int
    terms : tuple of (name, value, sigma)
        Estimated terms in metres: constant, cyclic sine and cosine; sigma from the same fit.
    residuals : tuple of float
        [m].
    """

    sigma0_m: float
    dof: int
    terms: tuple[tuple[str, float, float], ...]
    residuals: tuple[float, ...]

    def term(self, name: str) -> tuple[float, float]:
        """Value and sigma of a term [m]."""
        return next((value, sigma) for label, value, sigma in self.terms if label == name)


@dataclass(frozen=True, slots=True)
class TermVerdict:
    """Whether a term is in the distances.

    Parameters
    ----------
    amplitude_m, sigma_m : float
        Size of the term and its standard deviation, from the means of the sights.
    statistic : float
        F of the term on the means of the sights.
    probability : float
        Of a larger F without the term.
    significant : bool
    """

    amplitude_m: float
    sigma_m: float
    statistic: float
    probability: float
    significant: bool


@dataclass(frozen=True, slots=True)
class AtmosphereVerdict:
    """Whether the instrument has already corrected the atmosphere.

    Parameters
    ----------
    as_read_m, corrected_m : float
        sigma0 of the distances as read and with the first velocity correction applied to them.
    evidence : float
        -2 log likelihood ratio on the means of the sights; positive = as read fits better.
    verdict : str
        ``already_applied`` | ``not_applied`` | ``not_separable``.
    """

    as_read_m: float
    corrected_m: float
    evidence: float
    verdict: str


def first_velocity_ppm(reading: EdmReading) -> float:
    """First velocity correction of an EDM set to 12 degrees, 1013.25 hPa, 60 % [ppm].

    Source: Leica Geosystems, TPS user manuals, atmospheric correction for 658 nm (after IAG 1999).
    """
    t = reading.temperature_c
    expanded = 1.0 + t / 273.15
    saturation = float(10.0 ** (7.5 * t / (237.3 + t) + 0.7857))
    return 286.338 - (
        0.29535 * reading.pressure_hpa / expanded
        - 4.126e-4 * reading.humidity_percent / expanded * saturation
    )


def horizontal_lengths(
    readings: Sequence[EdmReading], *, reduce: bool = True, correct_atmosphere: bool = False
) -> Floats:
    """Horizontal lengths of readings, shape (n,).

    Parameters
    ----------
    readings : sequence of EdmReading
    reduce : bool
        False takes slope distances for horizontal ones.
    correct_atmosphere : bool
        Apply the first velocity correction first.
    """
    slope = np.array([r.slope_m for r in readings])
    if correct_atmosphere:
        slope = slope * (1.0 + 1e-6 * np.array([first_velocity_ppm(r) for r in readings]))
    if not reduce:
        return slope
    rise = np.array([r.end_height_m - r.start_height_m for r in readings])
    return np.asarray(np.sqrt(slope**2 - rise**2), dtype=np.float64)


def _design(readings: Sequence[EdmReading], names: Sequence[str], order: Floats) -> Floats:
    number = {name: i for i, name in enumerate(names)}
    matrix = np.zeros((len(readings), len(names)))
    for row, reading in enumerate(readings):
        start, end = number[reading.start], number[reading.end]
        sign = 1.0 if order[end] > order[start] else -1.0
        matrix[row, end] += sign
        matrix[row, start] -= sign
    return matrix[:, 1:]


def _places(readings: Sequence[EdmReading], names: Sequence[str]) -> Floats:
    """Rough place of each pillar along the line, from the pillar that sees the farthest."""
    longest = max(readings, key=lambda r: r.slope_m)
    end = longest.start
    place = {end: 0.0}
    for reading in readings:
        if end in (reading.start, reading.end):
            other = reading.end if reading.start == end else reading.start
            place.setdefault(other, reading.slope_m)
    for _ in names:
        for reading in readings:
            for a, b in ((reading.start, reading.end), (reading.end, reading.start)):
                if a in place and b not in place:
                    far = place[longest.end]
                    inward = 1.0 if place[a] < far / 2.0 else -1.0
                    place[b] = place[a] + inward * reading.slope_m
    return np.array([place[name] for name in names])


def baseline_design(
    readings: Sequence[EdmReading],
    *,
    constant: bool = False,
    cyclic_unit_m: float | None = None,
) -> Floats:
    """Design of a line of pillars: their places but the first, constant, cyclic sine and cosine.

    Returns
    -------
    ndarray, shape (n, u)
    """
    names = sorted({name for r in readings for name in (r.start, r.end)})
    columns = [_design(readings, names, _places(readings, names))]
    if constant:
        columns.append(np.ones((len(readings), 1)))
    if cyclic_unit_m is not None:
        phase = 2.0 * math.pi * np.array([r.slope_m for r in readings]) / cyclic_unit_m
        columns.append(np.stack((np.sin(phase), np.cos(phase)), axis=1))
    return np.hstack(columns)


def fit_baseline(
    readings: Sequence[EdmReading],
    lengths: Floats,
    *,
    constant: bool = False,
    cyclic_unit_m: float | None = None,
) -> BaselineFit:
    """Adjust the pillars' positions and, where asked, instrument terms.

    Parameters
    ----------
    readings : sequence of EdmReading
    lengths : float array, shape (n,)
        Horizontal lengths [m].
    constant : bool
        Estimate an additive constant (read minus true).
    cyclic_unit_m : float or None
        Unit length of a cyclic term [m]; half the modulation wavelength.

    Returns
    -------
    BaselineFit

    Raises
    ------
    ValueError
        If the readings do not determine all terms.
    """
    matrix = baseline_design(readings, constant=constant, cyclic_unit_m=cyclic_unit_m)
    labels = ["constant"] * constant
    labels += ["cyclic_sin", "cyclic_cos"] * (cyclic_unit_m is not None)
    if np.linalg.matrix_rank(matrix) < matrix.shape[1] or len(matrix) <= matrix.shape[1]:
        raise ValueError("the readings do not determine all pillars and terms")
    q, r = np.linalg.qr(matrix)
    solution = np.linalg.solve(r, q.T @ lengths)
    residuals = matrix @ solution - lengths
    dof = len(matrix) - matrix.shape[1]
    sigma0 = math.sqrt(float(residuals @ residuals) / dof)
    sigma = sigma0 * np.linalg.norm(np.linalg.inv(r), axis=1)
    first = matrix.shape[1] - len(labels)
    terms = tuple(
        (label, float(solution[first + i]), float(sigma[first + i]))
        for i, label in enumerate(labels)
    )
    return BaselineFit(sigma0, dof, terms, tuple(float(v) for v in residuals))


def sight_means(
    readings: Sequence[EdmReading], lengths: Floats
) -> tuple[tuple[EdmReading, ...], Floats]:
    """Mean length of every pointing: what counts as one independent measurement.

    Readings of one sight that follow each other are one pointing; the same sight observed again
    later is another.
    """
    groups: list[list[int]] = []
    for i, reading in enumerate(readings):
        last = readings[groups[-1][0]] if groups else None
        if last is not None and _sight(last) == _sight(reading):
            groups[-1].append(i)
        else:
            groups.append([i])
    means = np.array([lengths[rows].mean() for rows in groups])
    return tuple(readings[rows[0]] for rows in groups), means


def _sight(reading: EdmReading) -> tuple[object, ...]:
    return reading.start, reading.end, reading.start_height_m, reading.end_height_m


def judge_terms(
    readings: Sequence[EdmReading],
    lengths: Floats,
    *,
    cyclic_unit_m: float | None = None,
    tried: int = 1,
) -> TermVerdict:
    """Judge the additive constant, or a cyclic term beside it, on the means of the sights.

    Parameters
    ----------
    readings, lengths
        As for ``fit_baseline``.
    cyclic_unit_m : float or None
        None: the constant is judged.
    tried : int
        Unit lengths among which this one was chosen: the probability is multiplied by their number
        (Bonferroni), so that a search pays for itself.

    Returns
    -------
    TermVerdict
    """
    from scipy.special import fdtrc

    sights, means = sight_means(readings, lengths)
    cyclic = cyclic_unit_m is not None
    without = fit_baseline(sights, means, constant=cyclic)
    with_it = fit_baseline(sights, means, constant=True, cyclic_unit_m=cyclic_unit_m)
    count = 2 if cyclic else 1
    squares = without.sigma0_m**2 * without.dof - with_it.sigma0_m**2 * with_it.dof
    statistic = squares / count / with_it.sigma0_m**2
    probability = min(1.0, tried * float(fdtrc(count, with_it.dof, max(statistic, 0.0))))
    if cyclic:
        (a, sa), (b, sb) = with_it.term("cyclic_sin"), with_it.term("cyclic_cos")
        size = math.hypot(a, b)
        sigma = math.hypot(a * sa, b * sb) / size if size > 0.0 else math.hypot(sa, sb)
    else:
        value, sigma = with_it.term("constant")
        size = abs(value)
    return TermVerdict(size, sigma, statistic, probability, probability <= LEVEL)


def judge_atmosphere(readings: Sequence[EdmReading]) -> AtmosphereVerdict:
    """Tell whether the instrument has already applied the atmospheric correction.

    Parameters
    ----------
    readings : sequence of EdmReading
        With temperature, pressure and humidity as measured.

    Returns
    -------
    AtmosphereVerdict
        The treatment under which the baseline fits; ``not_separable`` where the weather changed
        too little to tell.
    """
    squares, sigmas = [], []
    for correct in (False, True):
        lengths = horizontal_lengths(readings, correct_atmosphere=correct)
        sigmas.append(fit_baseline(readings, lengths).sigma0_m)
        sights, means = sight_means(readings, lengths)
        fit = fit_baseline(sights, means)
        squares.append((fit.sigma0_m**2 * fit.dof, len(sights)))
    (as_read, n), (corrected, _) = squares
    evidence = n * math.log(corrected / as_read)
    verdict = "not_separable"
    if abs(evidence) > EVIDENCE:
        verdict = "already_applied" if evidence > 0.0 else "not_applied"
    return AtmosphereVerdict(sigmas[0], sigmas[1], evidence, verdict)
