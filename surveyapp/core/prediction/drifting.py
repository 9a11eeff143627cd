"""What a constant may be at a far date if the instrument drifts; the average says how likely it is.

Determinations of one day leave the rate of a drift as open as it was before. Averaged over all that
may be at work a drift counts as often as the archive has taught, one time in twenty; whoever has
such an instrument wants to know what then. The rate is that of the archive: a size in standard
deviations of a determination over the span of a campaign, and spans of many lengths.

Source: the equations of ``members`` for one straight line beside a flat constant (prediction.md A,
equations 1 to 8).
"""

from __future__ import annotations

import numpy as np

from surveyapp.core.statistics.mixture import Mixture
from surveyapp.domain.priors import AMPLITUDES, NU0, Priors
from surveyapp_models.arrays import Floats

PACES_DAYS = (13.0, 26.0, 53.0, 107.0, 220.0)
"""Spans over which the campaigns of the archive have seen a drift of some size, evenly in their
logarithm: nineteen in twenty lie between."""
DRIFTS = ("drift", "bend")


def drift_share(priors: Priors) -> float:
    """How often an instrument drifts, before its determinations are looked at."""
    return sum(priors.share(unit) for unit in DRIFTS)


def if_it_drifts(
    values: Floats, sigmas: Floats | None, days: Floats, later: Floats, *, priors: Priors
) -> tuple[Mixture, ...]:
    """The constant at later days if the instrument drifts and nothing else is at work.

    Parameters
    ----------
    values, days : ndarray, shape (n,)
        Determinations [rad] and when they were made [d].
    sigmas : ndarray, shape (n,), or None
        Stated ones [rad]; None = the scatter alone.
    later : ndarray, shape (t,)
        [d].
    priors : Priors

    Returns
    -------
    tuple of Mixture
        One for each later day, its offsets being the values themselves [rad].
    """
    n = values.size
    unit = float(np.std(values, ddof=1)) if sigmas is None else float(np.median(sigmas))
    unit, before = (unit if unit > 0.0 else 1e-9), (0.0 if sigmas is None else NU0)
    w = np.ones(n) if sigmas is None else (unit / sigmas) ** 2
    total = float(w.sum())
    centre, middle = float(w @ values) / total, float(w @ days) / total
    y, x = (values - centre) / unit, days - middle
    seen, along, squares = float(w @ x**2), float(w @ (x * y)), float(w @ y**2)
    sizes = np.repeat(priors.sizes, len(PACES_DAYS)) / len(PACES_DAYS)
    rate = (2.0 * np.outer(AMPLITUDES, 1.0 / np.array(PACES_DAYS)).ravel()) ** 2
    precision = seen + 1.0 / rate
    slope = along / precision
    nu = before + n - 1.0
    spread = np.maximum(before + squares - along * slope, 1e-12)
    with np.errstate(divide="ignore"):
        log = np.log(sizes) - 0.5 * np.log1p(rate * seen) - 0.5 * nu * np.log(spread)
    weights = np.exp(log - log.max())
    weights /= weights.sum()
    level = spread / nu
    return tuple(
        Mixture(
            weights,
            centre + unit * slope * gap,
            unit**2 * level * (1.0 / total + gap * gap / precision),
            nu,
        )
        for gap in (later - middle).tolist()
    )


def half_width_about(found: Mixture, value: float, beside: float = 0.0) -> float:
    """Half-width about a value in which .95 lies [rad], beside an independent variance [rad^2]."""
    moved = Mixture(found.weights, found.offsets - value, found.variances, found.dof)
    return moved.half_width(beside)
