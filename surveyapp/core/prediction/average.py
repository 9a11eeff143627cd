"""The constant predicted at later visits, averaged over the base model and all its rivals.

Every rival is a Gaussian process with a flat constant below it; what it explains of the
determinations weighs it, what it may do until the later visit widens the interval. The base stays a
member always, and "none of these" (a slow change, a walk) is one too. Nothing is chosen.

Source: prediction.md A, equations 1 to 10; O'Hagan & Forster (2004), Bayesian Inference, 11.11
(conjugate analysis with a flat mean); Hoeting et al. (1999), Statist. Sci. 14, 382-417 (averaging).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.prediction.members import Determinations, Members, members
from surveyapp.core.statistics.mixture import Mixture
from surveyapp.domain.priors import BASE, Priors
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Predicted:
    """The averaged prediction.

    Parameters
    ----------
    values : ndarray, shape (t,)
        [rad].
    readings : ndarray, shape (t,)
        Standard deviation that the scatter of the determinations makes if nothing is missing [rad].
    causes : ndarray, shape (t, t)
        Covariance that not knowing the cause adds [rad^2].
    mixtures : tuple of Mixture
        Of the causes alone about each value, beside the readings [rad].
    carried : ndarray, shape (t, r)
        Shared contributions as they arrive in each value [rad].
    weights : mapping of unit to float
        How much of the average each cause has after the determinations were looked at.
    dof : float
        Of the scatter.
    excess : float
        Standard deviation that every determination has beside its stated one, or 0 [rad]: what the
        next one will have too.
    """

    values: Floats
    readings: Floats
    causes: Floats
    mixtures: tuple[Mixture, ...]
    carried: Floats
    weights: Mapping[str, float]
    dof: float
    excess: float

    def half_width(self, target: int = 0, beside: float = 0.0) -> float:
        """Half-width of the 95 % interval [rad] beside an independent variance [rad^2]."""
        own = float(self.readings[target]) ** 2
        return self.mixtures[target].half_width(own + beside)

    def with_targets(self, rows: Mapping[int, int], other: Predicted) -> Predicted:
        """The same with some targets as another prediction has them; ``rows`` tells where.

        What is common to two targets (``causes``) stays.
        """
        values, readings, carried = (x.copy() for x in (self.values, self.readings, self.carried))
        mixtures = list(self.mixtures)
        for place, own in rows.items():
            values[place], readings[place] = other.values[own], other.readings[own]
            carried[place], mixtures[place] = other.carried[own], other.mixtures[own]
        return replace(
            self, values=values, readings=readings, carried=carried, mixtures=tuple(mixtures)
        )


def predict(data: Determinations, priors: Priors) -> Predicted:
    """Predict the constant at every target."""
    return averaged(members(data, priors))


def averaged(found: Members) -> Predicted:
    """Average the members by their weights."""
    w, unit = found.weights, found.unit
    mean = w @ found.means
    apart = found.means - mean
    base = found.units.index(BASE)
    readings = found.covariance[base] - found.beyond[base]
    total = np.einsum("m,mij->ij", w, found.covariance) + np.einsum("m,mi,mj->ij", w, apart, apart)
    shares: dict[str, float] = {}
    for name, weight in zip(found.units, w, strict=True):
        shares[name] = shares.get(name, 0.0) + float(weight)
    own = np.diagonal(readings)
    mixtures = tuple(
        Mixture(
            w,
            unit * apart[:, t],
            unit**2 * np.maximum(found.covariance[:, t, t] - own[t], 0.0),
            found.dof,
        ).main()
        for t in range(mean.size)
    )
    return Predicted(
        values=unit * mean,
        readings=unit * np.sqrt(own),
        causes=unit**2 * (total - readings),
        mixtures=mixtures,
        carried=unit * np.einsum("m,mtr->tr", w, found.carried),
        weights=shares,
        dof=found.dof,
        excess=unit * math.sqrt(max(float(w @ found.noise) - 1.0, 0.0)),
    )


__all__ = ["Determinations", "Members", "Predicted", "averaged", "members", "predict"]
