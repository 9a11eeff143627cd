"""A saved course was itself estimated from a run: its error is no second effect.

Beside a fit in which it has the size b, its errors are columns b L of unit variance. They enter the
likelihood in place of the plain sum of squares, and what lies along them and is larger than the
noise counts for no other cause.

Source: Fuller (1987), Measurement Error Models, 1.2 (the error of a regressor adds b^2 of its
variance to the noise); Harville (1977), J. Am. Stat. Assoc. 72, 320-338 (likelihood of variances).
"""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats

VARIANCES = 60
"""Values of the variance of the noise that are tried."""
NOTHING = 1e-12


def beside(errors: Floats, design: Floats) -> Floats:
    """What a design leaves of error columns, as orthogonal columns, shape (n, q)."""
    q, _ = np.linalg.qr(design)
    left = errors - q @ (q.T @ errors)
    u, s, _ = np.linalg.svd(left, full_matrices=False)
    return np.asarray(u * s)


def information_beside(
    residual: Floats, hidden: Floats, *, parameters: float, floor: float, scale: float
) -> float:
    """BIC with the errors of a course in the covariance: least over the variance of the noise.

    Parameters
    ----------
    residual : ndarray, shape (n,)
        Weighted [SI].
    hidden : ndarray, shape (n, q)
        Orthogonal columns of one standard deviation each [SI].
    parameters : float
        Everything paid for.
    floor : float
        Smallest variance of the noise [SI^2].
    scale : float
        SI value of the unit in which the likelihood is counted.

    Returns
    -------
    float
        n log(v'Pv / n) + p log n where there is no error.
    """
    n = residual.size
    size = np.sqrt((hidden**2).sum(axis=0))
    kept = size > NOTHING * scale
    along = (residual @ hidden[:, kept] / size[kept]) ** 2
    total = float(residual @ residual)
    rest = max(total - float(along.sum()), 0.0)
    low = max(floor, (1e-6 * scale) ** 2)
    variance = np.geomspace(low, max(total / n, 2.0 * low), VARIANCES)
    wide = variance[:, None] + size[kept] ** 2
    minus = (n - along.size) * np.log(variance / scale**2) + np.log(wide / scale**2).sum(axis=1)
    minus += rest / variance + (along / wide).sum(axis=1) - n
    return float(minus.min() + parameters * np.log(n))


def larger_than_noise(hidden: Floats, variance: float) -> Floats:
    """The error columns that exceed the noise of a reading, as orthonormal columns."""
    size = np.sqrt((hidden**2).sum(axis=0))
    kept = size**2 > max(variance, NOTHING)
    return np.asarray(hidden[:, kept] / size[kept])
