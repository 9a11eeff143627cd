"""How often each cause is at work and how large it is, before the determinations are looked at.

The defaults were learned once from an archive of simulated campaigns (docs/explanation/
prediction.md); an archive of real campaigns replaces them by ``diagnose --archive``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

AMPLITUDES = (0.7, 1.5, 3.0, 7.0)
"""Sizes of one cause in standard deviations of a determination."""
PAIR_AMPLITUDES = (1.5, 4.5)
"""The same where two causes act at once."""
BASE = "base"
PAIRS = "pairs"
STEP = "step"
GROSS = "gross_error"
UNITS = (
    BASE,
    "drift",
    "bend",
    "temperature",
    "curve",
    "latitude",
    "warm_up",
    "circle",
    "line",
    "day",
    "covariate",
    "excess",
    "walk",
    "slow",
    STEP,
    GROSS,
    PAIRS,
)
NU0 = 8.0
"""Degrees of freedom with which the stated sigma of a determination counts."""
CLEAN_SHARE = 0.60
"""Share of campaigns at which nothing is at work: the dial between narrow intervals on clean data
and honest ones on the others, set on programmes of another make than those that judge it
(``bench/_programmes.py``, docs/explanation/prediction.md)."""
LEARNED: Mapping[str, float] = MappingProxyType(
    {
        "drift": 0.05,
        "bend": 0.015,
        "temperature": 0.03,
        "curve": 0.015,
        "latitude": 0.02,
        "warm_up": 0.02,
        "circle": 0.015,
        "line": 0.02,
        "day": 0.05,
        "covariate": 0.02,
        "excess": 0.01,
        "walk": 0.03,
        "slow": 0.13,
        STEP: 0.03,
        GROSS: 0.01,
        PAIRS: 0.08,
    }
)
"""The causes beside each other, learned by expectation and maximization; those below .03 share what
is left. ``covariate`` is whatever else a project tells of its determinations (pressure, humidity,
supply voltage): no archive told it, and it counts as much as the latitude does."""
DEFAULT_SHARES: Mapping[str, float] = MappingProxyType(
    {
        BASE: CLEAN_SHARE,
        **{name: (1.0 - CLEAN_SHARE) * v / sum(LEARNED.values()) for name, v in LEARNED.items()},
    }
)
"""Prior share of every unit; sum 1."""
_SIZES = (0.33, 0.28, 0.36, 0.04)
DEFAULT_SIZES = tuple(share / sum(_SIZES) for share in _SIZES)
"""Shares of ``AMPLITUDES`` as learned, rounded; sum 1."""


@dataclass(frozen=True, slots=True)
class Priors:
    """Prior shares.

    Parameters
    ----------
    shares : mapping of unit to float
        Of every campaign, what share is explained by it; sum 1.
    sizes : tuple of float
        Shares of ``AMPLITUDES``; sum 1.
    origin : str
        Where they come from, for people.
    sessions : int
        Determinations that they were learned from; 0 = the defaults.
    scatter : float or None
        Standard deviation of the constant within the campaigns of the archive beside the stated
        sigmas [rad], whatever its causes; None = nobody knows. It serves where there are too few
        determinations to predict from.
    """

    shares: Mapping[str, float] = field(default_factory=lambda: DEFAULT_SHARES)
    sizes: tuple[float, ...] = DEFAULT_SIZES
    origin: str = "defaults of the program, learned from simulated campaigns"
    sessions: int = 0
    scatter: float | None = None

    def __post_init__(self) -> None:
        unknown = set(self.shares) - set(UNITS)
        if unknown:
            raise ValueError(f"priors of unknown causes: {sorted(unknown)}")
        if not self.shares.get(BASE, 0.0) > 0.0:
            raise ValueError("the base model needs a prior above 0")
        if len(self.sizes) != len(AMPLITUDES) or min(self.sizes) < 0.0:
            raise ValueError("one prior for each size")

    def share(self, unit: str) -> float:
        """Prior share of one unit."""
        return float(self.shares.get(unit, 0.0))

    def without(self, units: frozenset[str]) -> Priors:
        """The same without some units: an effect that was named and taken out."""
        kept = {name: value for name, value in self.shares.items() if name not in units}
        return replace(self, shares=kept)


DEFAULT_PRIORS = Priors()
