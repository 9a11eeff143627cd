"""Does the model fit the run? Loud tests that need no hypothesis about the cause.

The null distributions of the lag-1 correlation and of the number of runs are simulated through the
projector of the fit and with the reading resolution in it, because residuals of a fit with three
parameters are correlated even where the readings are not. The draws are seeded from the readings
alone: the same readings have the same draws, whatever else stands in the project. In a project of
many sessions a run whose statistics lie amid the first draws is not drawn to the end: it passes,
and its critical values are not determined. Which effect is missing is the business of
``surveyapp.diagnosis``.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.statistics.distributions import (
    chi_square_quantile,
    normal_quantile,
    student_quantile,
)
from surveyapp.core.statistics.levels import FIT_KIND
from surveyapp_models.arrays import Floats

DRAWS = 10_000
MOST_DRAWS = 100_000
MANY_SESSIONS = 50
"""From here on most runs are passed by their first draws: 100,000 for each would take minutes."""
FIRST_DRAWS = 2000
AMID = 0.02
"""Share of the first draws that lies beyond a statistic on either side where it passes. The levels
are below FIT_KIND / MANY_SESSIONS = 1e-4 then: that 40 of 2000 draws lie where 1e-4 of all do has
a probability below 1e-70."""
LEAST_REDUNDANCY = 1e-6
"""Of a reading: one that the fit follows wherever it goes cannot be tested."""


@dataclass(frozen=True, slots=True)
class Judge:
    """Who judges the fits of a project: its random numbers and how many sessions there are.

    Parameters
    ----------
    rng : numpy.random.Generator or None
        For the null distributions; None: seeded from the readings of each fit.
    sessions : int
        Sessions that are tested; the level of each test is divided by it (Bonferroni).
    asked : bool
        Whether anybody looks at the tests; without, none is made.
    """

    rng: np.random.Generator | None = None
    sessions: int = 1
    asked: bool = True

    @property
    def significance(self) -> float:
        """Level of one test of one session."""
        return FIT_KIND / max(self.sessions, 1)

    def generator(self, readings: Floats) -> np.random.Generator:
        """Random numbers for the test of these readings."""
        if self.rng is not None:
            return self.rng
        digest = hashlib.sha256(np.ascontiguousarray(readings, dtype="<f8").tobytes()).digest()
        return np.random.default_rng(int.from_bytes(digest[:16], "little"))

    @property
    def draws(self) -> int:
        """Draws that resolve the level: ten beyond each critical value, if that is affordable."""
        return min(max(DRAWS, round(80.0 / self.significance)), MOST_DRAWS)


@dataclass(frozen=True, slots=True)
class FitTest:
    """One test of fit.

    Parameters
    ----------
    name : str
        ``chi_square``, ``size``, ``largest_residual``, ``lag1_correlation`` or ``runs``.
    value : float
        The statistic.
    low, high : float or None
        Critical values; the test passes within. None: not determined, it passes clearly.
    passed : bool
    point : int or None
        Place of the reading with the largest residual.
    at_limit : bool
        Whether the draws cannot tell on which side of its critical value the statistic lies.
    """

    name: str
    value: float
    low: float | None
    high: float | None
    passed: bool
    point: int | None = None
    at_limit: bool = False


def lag1_correlation(residuals: Floats) -> Floats:
    """Lag-1 correlation of each row of residuals, shape (..., n); 0 where all are zero."""
    squares = np.einsum("...i,...i->...", residuals, residuals)
    products = np.einsum("...i,...i->...", residuals[..., 1:], residuals[..., :-1])
    return np.asarray(np.divide(products, squares, out=np.zeros_like(squares), where=squares > 0))


def run_count(residuals: Floats) -> Floats:
    """Number of runs of equal sign in each row of residuals, shape (..., n)."""
    signs = residuals >= 0.0
    changes = np.count_nonzero(signs[..., 1:] != signs[..., :-1], axis=-1)
    return np.asarray(1.0 + changes, dtype=np.float64)


def goodness_of_fit(
    residuals: Floats,
    jacobian: Floats,
    judge: Judge,
    *,
    sigma: float | None,
    resolution: float,
    readings: Floats | None = None,
    bound: float | None = None,
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
    readings : ndarray, shape (n,)
        What the draws are seeded from; the residuals where absent.
    bound : float or None
        Standard deviation that no reading of the kind exceeds: tested where ``sigma`` is unknown.

    Returns
    -------
    tuple of FitTest
        Empty where there is no redundancy, or nobody asks; the serial tests need at least 3 degrees
        of freedom.
    """
    count, parameters = jacobian.shape
    dof = count - parameters
    tests: list[FitTest] = []
    if dof < 1 or not judge.asked:
        return ()
    squares = float(residuals @ residuals)
    known = sigma is not None and sigma > 0.0
    apriori = sigma if known else bound
    if apriori is not None and apriori > 0.0:
        variance = apriori**2 + resolution**2 / 12.0
        limit = chi_square_quantile(1.0 - judge.significance, dof)
        value = squares / variance
        name = "chi_square" if known else "size"
        tests.append(FitTest(name, value, None, limit, value <= limit))
    spread = math.hypot(sigma or 0.0, resolution / math.sqrt(12.0)) if known else None
    floor = max(resolution / math.sqrt(12.0), 1e-12 * math.sqrt(squares))
    tests.extend(_largest_residual(residuals, jacobian, judge, sigma=spread, floor=floor))
    if dof >= 3:
        rng = judge.generator(residuals if readings is None else readings)
        tests.extend(_serial_tests(residuals, jacobian, judge, resolution, rng=rng))
    return tuple(tests)


def _largest_residual(
    residuals: Floats, jacobian: Floats, judge: Judge, *, sigma: float | None, floor: float
) -> list[FitTest]:
    """The largest studentized residual: by the sigma that is known, else by the other readings.

    Source: Baarda (1968) w-test; Cook & Weisberg (1982), Residuals and influence in regression,
    2.2.10 (externally studentized). The level is divided by the number of readings.
    """
    count, parameters = jacobian.shape
    dof = count - parameters
    q = np.linalg.qr(jacobian)[0]
    redundancy = 1.0 - np.sum(q * q, axis=1)
    testable = redundancy > LEAST_REDUNDANCY
    if not np.any(testable) or (sigma is None and dof < 2):
        return []
    level = 0.5 * judge.significance / int(np.sum(testable))
    safe = np.where(testable, redundancy, 1.0)
    if sigma is not None:
        spread = np.full(count, sigma)
        limit = normal_quantile(1.0 - level)
    else:
        rest = np.maximum(residuals @ residuals - residuals**2 / safe, 0.0) / (dof - 1)
        spread = np.sqrt(np.maximum(rest, floor**2))
        limit = student_quantile(1.0 - level, float(dof - 1))
    ratios = np.where(testable, np.abs(residuals) / (spread * np.sqrt(safe)), 0.0)
    point = int(np.argmax(ratios))
    value = float(ratios[point])
    return [FitTest("largest_residual", value, None, limit, value <= limit, point)]


def _serial_tests(
    residuals: Floats,
    jacobian: Floats,
    judge: Judge,
    resolution: float,
    *,
    rng: np.random.Generator,
) -> list[FitTest]:
    count, parameters = jacobian.shape
    scale = float(np.sqrt(residuals @ residuals / (count - parameters)))
    scale = max(scale, resolution / np.sqrt(12.0), 1e-300)
    q = np.linalg.qr(jacobian)[0]

    def drawn(size: int) -> Floats:
        """Residuals of so many runs that the model fits, shape (size, n)."""
        draws = rng.standard_normal((size, count)) * scale
        if resolution > 0.0:
            draws /= resolution
            np.rint(draws, out=draws)
            draws *= resolution
        draws -= (draws @ q) @ q.T
        return np.asarray(draws)

    first = min(FIRST_DRAWS, judge.draws) if judge.sessions > MANY_SESSIONS else 0
    draws = drawn(first)
    if first:
        passed = [_amid(name, residuals, draws) for name in SERIAL]
        if None not in passed:
            return [test for test in passed if test is not None]
    draws = np.concatenate([draws, drawn(judge.draws - first)])
    tests = []
    for name, statistic in SERIAL.items():
        value = float(statistic(residuals))
        found = statistic(draws)
        tail = 0.5 * judge.significance
        low, high = np.quantile(found, [tail, 1.0 - tail]).tolist()
        at_limit = _at_limit(found, value, tail)
        tests.append(FitTest(name, value, low, high, low <= value <= high, at_limit=at_limit))
    return tests


SERIAL: Final[Mapping[str, Callable[[Floats], Floats]]] = {
    "lag1_correlation": lag1_correlation,
    "runs": run_count,
}


def _amid(name: str, residuals: Floats, draws: Floats) -> FitTest | None:
    """A test that is passed without its critical values; None where more draws are needed."""
    value, found = float(SERIAL[name](residuals)), SERIAL[name](draws)
    beyond = min(float(np.mean(found >= value)), float(np.mean(found <= value)))
    return FitTest(name, value, None, None, passed=True) if beyond >= AMID else None


def _at_limit(drawn: Floats, value: float, tail: float) -> bool:
    """Whether the draws beyond a value could as well lie on the other side of the level."""
    beyond = min(float(np.mean(drawn >= value)), float(np.mean(drawn <= value)))
    return abs(beyond - tail) < 2.0 * math.sqrt(tail / drawn.size)
