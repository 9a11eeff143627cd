"""The five noise coefficients of IEEE 952 with their units, sigmas, and why one is not determined.

Q, N, B and K come from the spectrum, R from the slope. A ramp and a random walk raise the same end
of the curve: where the record cannot tell them apart both are null, and so for B and K.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.sensors.noise_spectrum import (
    ENTRY,
    NoiseFit,
    Spectrum,
    fit_noise,
    fit_terms,
    spectrum_of,
    unit_powers,
)
from surveyapp.domain.columns import pieces
from surveyapp_models.arrays import Floats

SYMBOLS: Final = ("Q", "N", "B", "K", "R")

FEWEST: Final = 200
"""Samples below which no coefficient is told from another."""

FEWEST_BINS: Final = 6

SIGNIFICANT: Final = 2.576
"""Slopes beyond so many sigma are real: p = .01, two-sided."""

USUAL_DISPERSION: Final = 0.77
"""Pearson chi-square per bin where the power laws hold: bins share tapers (simulated)."""

NO_POWER_LAW: Final = 10.0
"""Beyond it the spectrum is no sum of power laws, and its coefficients mean nothing."""

RED_SHARE: Final = 0.15
RED_SHAPE_KNOWN: Final = 0.1
"""How flicker and walk fall off towards half the rate depends on how the sampler averages: where
they have more than this share of the power there, the record is used up to a tenth of its rate,
below which the shapes of all samplers agree within 2 %."""

FLICKER_SLOPE: Final = 9.0 / math.pi
"""Variance of the slope of flicker noise: this times B^2 / T^2, (36/pi) times the integral of
j1(x)^2 / x = 1/4 over its spectrum B^2 / (2 pi f)."""


@dataclass(frozen=True, slots=True)
class Coefficient:
    """One coefficient in SI of its series; ``value`` None = not determined, ``reason`` why."""

    symbol: str
    value: float | None
    sigma: float | None
    reason: str | None


def coefficients_of(
    series: Floats, *, interval: float, highest_hz: float | None = None
) -> tuple[Coefficient, ...]:
    """Q [unit s], N [unit sqrt(s)], B [unit], K [unit/sqrt(s)], R [unit/s] of a series.

    Parameters
    ----------
    series : ndarray, shape (n,)
    interval : float
        [s]
    highest_hz : float or None
        Frequency up to which the series is used: of a filtered one its pass band.
    """
    if series.size < FEWEST:
        return nulls("record_too_short")
    found = _coefficients(series, interval, highest_hz)
    if highest_hz is None and _red_at_the_top(found, interval):
        return _coefficients(series, interval, RED_SHAPE_KNOWN / interval)
    return found


def _red_at_the_top(found: tuple[Coefficient, ...], interval: float) -> bool:
    """Whether flicker or walk has a part in the power at half the rate."""
    squares = np.array([(c.value or 0.0) ** 2 for c in found[:4]])
    parts = squares * unit_powers(np.array([0.5 / interval]), interval)[0]
    return float(parts[2:].sum()) > RED_SHARE * float(parts.sum())


def _coefficients(
    series: Floats, interval: float, highest_hz: float | None
) -> tuple[Coefficient, ...]:
    spectrum = spectrum_of(series, interval=interval).below(highest_hz)
    if spectrum.power.size < FEWEST_BINS:
        return nulls("no_power_law")
    plain = fit_noise(spectrum)
    if plain is None:
        return nulls("no_power")
    slope = _slope(series, interval)
    span = series.size * interval
    flat = spectrum_of(series, interval=interval, slope=slope * interval).below(highest_hz)
    level = fit_noise(flat)
    if level is None:
        return nulls("no_power")
    ramp = _judge_ramp(slope, span, flat, level)
    fit, source = (plain, spectrum) if ramp == "absent" else (level, flat)
    if fit.dispersion > NO_POWER_LAW:
        return nulls("no_power_law")
    return _named(fit, source, (ramp, slope, span))


def nulls(reason: str) -> tuple[Coefficient, ...]:
    """No coefficient is determined, all for one reason."""
    return tuple(Coefficient(symbol, None, None, reason) for symbol in SYMBOLS)


def _slope(series: Floats, interval: float) -> float:
    """Least-squares slope [unit/s]."""
    n = series.size
    moment, start = 0.0, 0
    for piece in pieces(series):
        moment += float((np.arange(start, start + piece.size) - 0.5 * (n - 1)) @ piece)
        start += piece.size
    return moment / (n * (n**2 - 1.0) / 12.0) / interval


def slope_variance(squares: Floats, span: float) -> float:
    """Variance of the least-squares slope of a noise [unit^2/s^2], over ``span`` [s].

    White noise 12 N^2 / T^3; random walk (6/5) K^2 / T; flicker in between. Quantisation adds
    nothing over many samples.
    """
    _, white, flicker, walk = squares
    return float(12.0 * white / span**3 + FLICKER_SLOPE * flicker / span**2 + 1.2 * walk / span)


def _judge_ramp(slope: float, span: float, flat: Spectrum, level: NoiseFit) -> str:
    """``absent``, ``determined`` or ``not_separable`` from a random walk."""
    if abs(slope) <= SIGNIFICANT * math.sqrt(slope_variance(level.squares, span)):
        return "absent"
    if level.squares[3] > 0.0 or "K" in _unclear(level, flat):
        return "not_separable"
    squares = level.squares.copy()
    squares[3] = _largest_walk(flat, level)
    if abs(slope) <= SIGNIFICANT * math.sqrt(slope_variance(squares, span)):
        return "not_separable"
    return "determined"


def _largest_walk(flat: Spectrum, level: NoiseFit) -> float:
    """K^2 that the detrended record still allows: its deviance rises by 3.84 there."""
    base = flat.design @ level.squares
    unit = flat.design[:, 3]
    lowest = float(np.max(base / unit)) * 1e-9
    for square in lowest * 10.0 ** np.arange(0.0, 12.0, 0.1):
        model = base + square * unit
        deviance = float(flat.freedom @ (np.log(model) + flat.power / model))
        if deviance > level.deviance + 3.84:
            return float(square)
    return math.inf


def _named(
    fit: NoiseFit, source: Spectrum, ramp: tuple[str, float, float]
) -> tuple[Coefficient, ...]:
    verdict, slope, span = ramp
    widened = math.sqrt(max(fit.dispersion / USUAL_DISPERSION, 1.0))
    unclear = _unclear(fit, source)
    found = []
    for index, symbol in enumerate(SYMBOLS[:4]):
        square = float(fit.squares[index])
        if symbol in unclear or (symbol == "K" and verdict == "not_separable"):
            found.append(Coefficient(symbol, None, None, "not_separable"))
        elif square > 0.0:
            value = math.sqrt(square)
            sigma = 0.5 * value * float(fit.relative[index]) * widened
            found.append(Coefficient(symbol, value, sigma, None))
        else:
            found.append(Coefficient(symbol, None, None, "not_significant"))
    if verdict == "determined":
        sigma = math.sqrt(slope_variance(fit.squares, span)) * widened
        found.append(Coefficient("R", abs(slope), sigma, None))
    else:
        reason = "not_separable" if verdict == "not_separable" else "not_significant"
        found.append(Coefficient("R", None, None, reason))
    return tuple(found)


def _unclear(fit: NoiseFit, source: Spectrum) -> set[str]:
    """B and K where one alone serves as well as the other."""
    present = tuple(int(i) for i in np.flatnonzero(fit.squares > 0.0))
    for here, other in ((2, 3), (3, 2)):
        if here in present and other not in present:
            exchanged = tuple(sorted([*(i for i in present if i != here), other]))
            rival = fit_terms(source, exchanged)
            if rival is not None and rival.deviance < fit.deviance + ENTRY:
                return {"B", "K"}
    return set()
