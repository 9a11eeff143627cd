"""The result at a physical datum, no more certain than the models that do about as well agree.

One model's sigma says how well its own coefficients are known. Where other sets within the margin
hold the same effect beside other partners, they put the datum elsewhere: that spread belongs to it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.run_value import Value, datum_values

LEAST_SHARE = 1e-3
"""Of the best set's weight: what is less likely says nothing of a datum."""


def datum_with_rivals(
    problem: Case, fit: Fit, near: Sequence[Fit]
) -> tuple[tuple[str, str, Value], ...]:
    """(effect, state, value) of a fit, its sigma widened by the sets that compete with it.

    Parameters
    ----------
    problem : Case
    fit : Fit
    near : sequence of Fit
        Sets within the margin, the fit itself among them or not.
    """
    states = datum_values(problem, fit)
    others = [f for f in near if f.noise is None and f.key != fit.key]
    rivals = [(f, datum_values(problem, f)) for f in others]
    found = []
    for effect, text, value in states:
        apart, weights = [0.0], [1.0]
        for rival, theirs in rivals:
            share = math.exp(-0.5 * min(max(rival.score - fit.score, -50.0), 50.0))
            own = [v.value for e, t, v in theirs if (e, t) == (effect, text)]
            if own and share > LEAST_SHARE:
                apart.append(own[0] - value.value)
                weights.append(share)
        between = float(np.average(np.square(apart), weights=weights))
        sigma = math.sqrt(value.sigma**2 + between)
        found.append((effect, text, Value(value.value, sigma, value.dof)))
    return tuple(found)
