"""Does the model fit the run? Three loud tests that need no hypothesis about the cause.

The null distributions of the lag-1 correlation and of the number of runs are simulated through the
projector of the fit and with the reading resolution in it, because residuals of a fit with three
parameters are correlated even where the readings are not. Which effect is missing is the business
of ``surveyapp.diagnosis``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveyapp.core.statistics.distributions import chi_square_quantile
from surveyapp.core.statistics.levels import LOUD
from surveyapp_models.arrays import Floats

DRAWS = 2000
MOST_DRAWS = 40_000


@dataclass(frozen=True, slots=True)
class Judge:
    """Who judges the fits of a project: its random numbers and how many sessions there are.

    Parameters
    ----------
    rng : numpy.random.Generator
    sessions : int
        Sessions that are tested; the level of each test is divided by it (Bonferroni).
    """

    rng: np.random.Generator
    sessions: int = 1

    @property
    def significance(self) -> float:
        """Level of one test of one session."""
        return LOUD / max(self.sessions, 1)

    @property
    def draws(self) -> int:
        """Draws that resolve the level: ten beyond each critical value, if that is affordable."""
        return min(max(DRAWS, round(20.0 / self.significance)), MOST_DRAWS)


@dataclass(frozen=True, slots=True)
class FitTest:
    """One test of fit.

    Parameters
    ----------
    name : str
        ``chi_square``, ``lag1_correlation`` or ``runs``.
    value : float
        The statistic.
    low, high : float or None
        Critical values; the test passes within.
    passed : bool
    """

    name: str
    value: float
    low: float | None
    high: float | None
    passed: bool


def lag1_correlation(residuals: Floats) -> Floats:
    """Lag-1 correlation of each row of residuals, shape (..., n); 0 where all are zero."""
    squares = np.sum(residuals * residuals, axis=-1)
    products = np.sum(residuals[..., 1:] * residuals[..., :-1], axis=-1)
    return np.asarray(np.divide(products, squares, out=np.zeros_like(squares), where=squares > 0))


def run_count(residuals: Floats) -> Floats:
    """Number of runs of equal sign in each row of residuals, shape (..., n)."""
    signs = residuals >= 0.0
    return np.asarray(1.0 + np.sum(signs[..., 1:] != signs[..., :-1], axis=-1), dtype=np.float64)


def goodness_of_fit(
    residuals: Floats,
    jacobian: Floats,
    judge: Judge,
    *,
    sigma: float | None,
    resolution: float,
) -> tuple[FitTest, ...]:
    """Test the residuals of one fit.

    Parameters
    ----------
    residuals : ndarray, shape (n,)
        Observed minus fitted, any unit.
    jacobian : ndarray, shape (n, p)
        Derivatives at the solution.
    judge : Judge
    sigma : float or None
        A-priori standard deviation of one reading from the card; without it there is no
        chi-square test.
    resolution : float
        Reading resolution, same unit, 0 if unknown.

    Returns
    -------
    tuple of FitTest
        Empty where there is no redundancy; the serial tests need at least 3 degrees of freedom.
    """
    count, parameters = jacobian.shape
    dof = count - parameters
    tests: list[FitTest] = []
    if dof < 1:
        return ()
    squares = float(residuals @ residuals)
    if sigma is not None and sigma > 0.0:
        variance = sigma**2 + resolution**2 / 12.0
        limit = chi_square_quantile(1.0 - judge.significance, dof)
        value = squares / variance
        tests.append(FitTest("chi_square", value, None, limit, value <= limit))
    if dof >= 3:
        tests.extend(_serial_tests(residuals, jacobian, judge, resolution))
    return tuple(tests)


def _serial_tests(
    residuals: Floats, jacobian: Floats, judge: Judge, resolution: float
) -> list[FitTest]:
    count, parameters = jacobian.shape
    scale = float(np.sqrt(residuals @ residuals / (count - parameters)))
    draws = judge.rng.standard_normal((judge.draws, count)) * max(
        scale, resolution / np.sqrt(12.0), 1e-300
    )
    if resolution > 0.0:
        draws = np.round(draws / resolution) * resolution
    q = np.linalg.qr(jacobian)[0]
    draws -= (draws @ q) @ q.T
    tests = []
    for name, statistic in (("lag1_correlation", lag1_correlation), ("runs", run_count)):
        value = float(statistic(residuals))
        low, high = np.quantile(
            statistic(draws), [0.5 * judge.significance, 1.0 - 0.5 * judge.significance]
        ).tolist()
        tests.append(FitTest(name, value, low, high, low <= value <= high))
    return tests
