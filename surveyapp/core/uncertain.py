"""A value with its sources of error, kept apart until the end.

Every quantity of the reduction carries its error as signed contributions, one per independent
source. Sums and differences add the contributions of the same source with their signs, so that
what two quantities share (the deflection at one station, a torsion ratio, a constant) cancels or
adds as it does in nature; the budget of the grid azimuth is read off at the end.

Source of the effective degrees of freedom: Welch-Satterthwaite, JCGM 100:2008 (GUM), G.4.1.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.core.statistics.few_degrees import effective_dof, half_width95
from surveyapp.core.statistics.mixture import Mixture
from surveyapp_models.angles import wrap_pi


@dataclass(frozen=True, slots=True)
class Source:
    """One independent source of error.

    Parameters
    ----------
    name : str
        The kind of error in the trade's words; rows of the budget are made by it.
    entity : str
        Whose error it is: the id of a session, a station, an instrument, a line.
    dof : float
        Degrees of freedom of its estimate; infinite where it was stated beforehand.
    detail : str
        Tells several errors of one kind and entity apart.
    pool : str
        Sources of one name and pool have one estimate of their sigma: its degrees of freedom
        count once, however many of them there are. Empty: an estimate of its own.
    weight_ratio : float
        By which the contribution is multiplied where weights are made of it, and nowhere else.
    """

    name: str
    entity: str
    dof: float = math.inf
    detail: str = ""
    weight_ratio: float = 1.0
    pool: str = ""
    _hash: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        key = (self.name, self.entity, self.dof, self.detail, self.weight_ratio, self.pool)
        object.__setattr__(self, "_hash", hash(key))

    def __hash__(self) -> int:
        """Computed once: a line is summed over thousands of sources."""
        return self._hash

    def __reduce__(self) -> tuple[type[Source], tuple[str | float, ...]]:
        """Made anew where it is unpickled: every process hashes texts in its own way."""
        own = (self.name, self.entity, self.dof, self.detail, self.weight_ratio, self.pool)
        return Source, own


@dataclass(frozen=True, slots=True)
class Spread:
    """How the contributions of some sources are spread, where that is no normal distribution.

    Parameters
    ----------
    name : str
        Name of the sources whose place it takes in an interval.
    mixture : Mixture
        [rad].
    """

    name: str
    mixture: Mixture


@dataclass(frozen=True, slots=True)
class Uncertain:
    """A value [rad] with its contributions [rad].

    Parameters
    ----------
    value : float
        Not wrapped: wrapping is the business of whoever prints it.
    parts : mapping of Source to float
        Signed one-sigma contribution of each independent source.
    spread : Spread or None
        Of the one source that is not spread normally; only the interval depends on it.
    """

    value: float
    parts: Mapping[Source, float] = field(default_factory=dict)
    spread: Spread | None = None

    @property
    def variance(self) -> float:
        """Sum of the squared contributions [rad^2]."""
        return math.fsum(part * part for part in self.parts.values())

    @property
    def sigma(self) -> float:
        """Standard deviation [rad]."""
        return math.sqrt(self.variance)

    @property
    def dof(self) -> float:
        """Effective degrees of freedom (Welch-Satterthwaite); a pooled estimate counts once."""
        return effective_dof(self._estimates())

    def _estimates(self) -> list[tuple[float, float]]:
        """Variance [rad^2] and degrees of freedom of every estimate; what is known is one."""
        shared: dict[tuple[str, str], tuple[float, float]] = {}
        found: list[tuple[float, float]] = []
        known = 0.0
        for source, part in self.parts.items():
            if source.dof == math.inf:
                known += part * part
            elif not source.pool:
                found.append((part * part, source.dof))
            else:
                before, dof = shared.get((source.name, source.pool), (0.0, source.dof))
                shared[source.name, source.pool] = (before + part * part, min(dof, source.dof))
        return [*found, *shared.values(), (known, math.inf)]

    @property
    def interval95(self) -> float:
        """Half-width of the 95 % interval [rad]: see ``statistics.few_degrees``."""
        if self.spread is not None:
            others = self.without(self.spread.name)
            mixture = self.spread.mixture
            wider = student_quantile(0.975, max(others.dof, 1.0))
            wider /= student_quantile(0.975, max(mixture.dof, 1.0))
            beside = others.variance * max(wider, 1.0) ** 2
            if math.isfinite(beside):
                return mixture.half_width(beside)
        return half_width95(self._estimates())

    def only(self, *names: str) -> Uncertain:
        """Keep the contributions of the named sources alone."""
        return self._with({s: p for s, p in self.parts.items() if s.name in names})

    def without(self, *names: str) -> Uncertain:
        """Drop the contributions of the named sources."""
        return self._with({s: p for s, p in self.parts.items() if s.name not in names})

    def _with(self, parts: Mapping[Source, float]) -> Uncertain:
        """Other contributions; the spread stays while its source does."""
        spread = self.spread
        if spread is not None and not any(source.name == spread.name for source in parts):
            spread = None
        return Uncertain(self.value, parts, spread)

    def shifted(self, offset: float) -> Uncertain:
        """Add an exact offset [rad]."""
        return Uncertain(self.value + offset, self.parts, self.spread)

    def with_part(self, source: Source, contribution: float) -> Uncertain:
        """Add one contribution [rad]."""
        return combine([(1.0, self), (1.0, Uncertain(0.0, {source: contribution}))])

    def __add__(self, other: Uncertain) -> Uncertain:
        return combine([(1.0, self), (1.0, other)])

    def __sub__(self, other: Uncertain) -> Uncertain:
        return combine([(1.0, self), (-1.0, other)])


def combine(terms: Iterable[tuple[float, Uncertain]]) -> Uncertain:
    """Linear combination of uncertain values.

    Parameters
    ----------
    terms : iterable of (factor, Uncertain)

    Returns
    -------
    Uncertain
        Contributions of one source are added with their signs before anything is squared. A spread
        stays where only one is in the terms; several are taken for normal.
    """
    value = 0.0
    parts: dict[Source, float] = {}
    spreads: dict[int, tuple[float, Spread]] = {}
    for factor, term in terms:
        value += factor * term.value
        for source, part in term.parts.items():
            parts[source] = parts.get(source, 0.0) + factor * part
        if term.spread is not None:
            known = spreads.get(id(term.spread), (0.0, term.spread))[0]
            spreads[id(term.spread)] = (known + factor, term.spread)
    kept = {s: p for s, p in parts.items() if p != 0.0}
    return Uncertain(value, kept, _one_spread(list(spreads.values())))


def _one_spread(found: list[tuple[float, Spread]]) -> Spread | None:
    """The only spread of a combination, None where there are several or it drops out."""
    left = [(factor, spread) for factor, spread in found if abs(factor) > 1e-12]
    if len(left) != 1:
        return None
    factor, spread = left[0]
    if abs(factor - 1.0) < 1e-12:
        return spread
    return Spread(spread.name, spread.mixture.scaled(factor))


def aligned(directions: Sequence[Uncertain]) -> list[Uncertain]:
    """Directions [rad] moved by whole turns to within half a turn of the first one."""
    first = directions[0].value
    return [item.shifted(first + wrap_pi(item.value - first) - item.value) for item in directions]
