"""Effects of channels side by side, weighed with their coefficients drawn.

Such an effect has a coefficient or more in each channel. BIC charges every one what it costs where
it is seen as well as anything can be: nine of them more than an effect brings that noise shows once
in thousands of records, and a gross error, charged for two, goes before it. So the coefficients
are drawn from a normal distribution of one unknown size, as the steps of a walk are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surveyapp.diagnosis.candidates import Candidate
from surveyapp.diagnosis.case import Case, unit_variance
from surveyapp.diagnosis.stochastic import effects_gain
from surveyapp_models.arrays import Floats


def is_drawn(problem: Case, candidate: Candidate) -> bool:
    """Whether an effect is weighed so: several coefficients, none of one observation alone."""
    if problem.series is None or candidate.is_law or unit_variance(problem) is not None:
        return False
    single = candidate.effect is not None and candidate.effect.acts_on == "observation"
    return candidate.size > 1 and not single


def drawn_gain(problem: Case, J: Floats, effects: Sequence[Floats], residual: Floats) -> float:
    """BIC that effects bring beside a design, their coefficients drawn.

    Parameters
    ----------
    problem : Case
        With channels.
    J : ndarray, shape (n, p)
        Design (weighted).
    effects : sequence of ndarray, shape (n, k)
        Columns of each (weighted).
    residual : ndarray, shape (n,)
        Of the design alone.
    """
    if problem.series is None:
        return 0.0
    channels = np.isfinite(problem.series)
    each = int(channels.sum()) // max(np.unique(problem.series[channels]).size, 1)
    floor = max(problem.noise_floor, 1e-6 * problem.scale) ** 2
    return effects_gain(J, effects, residual, each=each, floor=floor)
