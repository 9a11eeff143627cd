"""What nobody has seen: a later visit outside the range in which the determinations were made.

Inside their range determinations say that a cause is small; beyond it they say nothing. Every
member of the average, the base too, is given an effect there that begins at the edge of the range.
It changes no evidence, only the interval.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from surveyapp.core.prediction.kernels import COVARIATE_UNITS, TEMPERATURE_UNIT_K
from surveyapp.domain.priors import Priors
from surveyapp_models.arrays import Floats

SIZE = 1.5
"""Standard deviation of the effect in those of a determination, where the column lies one unit
(8 K) further out: the middle of the sizes (``AMPLITUDES``)."""
NEARBY = 0.375
"""Of the unit (3 K): so far outside nothing is told and nothing widened."""
CAUSES = {
    "temperature_c": ("temperature", TEMPERATURE_UNIT_K),
    **{name: ("covariate", unit) for name, unit in COVARIATE_UNITS.items()},
}
"""The cause that a column bears on, and what changes an effect of it by its size."""


def unseen(columns: Mapping[str, Floats], n: int, targets: Floats, priors: Priors) -> Floats:
    """Covariance that it adds between what is wanted, in squares of the median sigma.

    A cause that was named and taken out has a range of its own.

    Parameters
    ----------
    columns : mapping of ndarray, shape (n + q,)
        n determinations first.
    n : int
    targets : ndarray, shape (t, n + q)
    priors : Priors

    Returns
    -------
    ndarray, shape (t, t)
    """
    found = np.zeros((len(targets), len(targets)))
    for name, (cause, unit) in CAUSES.items():
        values = columns.get(name)
        if values is None or not np.isfinite(values).all() or priors.share(cause) <= 0.0:
            continue
        low, high = float(values[:n].min()), float(values[:n].max())
        near = NEARBY * unit
        far = targets @ (values - np.clip(values, low - near, high + near)) / unit
        found += SIZE**2 * far[:, None] * far[None, :]
    return found
