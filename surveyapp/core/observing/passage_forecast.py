"""The next timed passage of a clamped swing before it comes: when, which way, how surely.

Scale readings and passages so far are fitted by the damped swing of ``swingfit``; what is known
beforehand (the period T2 of the card at this latitude, a usual damping, an alidade set near north)
enters as an observation with its own sigma, so that the first passage already forecasts the next,
vaguely, and the later ones are forecast by the data alone. Nothing here knows a clock or a screen.

Source: physics.md 1.2, 1.4, 2.3, 2.4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from surveyapp.core.observing.forecast import LOG_DECREMENT, LOG_DECREMENT_SIGMA, STAMP_SIGMA_S
from surveyapp.core.observing.run_alert import Trouble
from surveyapp.core.statistics.distributions import student_quantile, student_tail
from surveyapp.core.swing.swingfit import (
    PARAMETERS,
    ClampedSwing,
    estimate_period,
    modelled,
    whitened_jacobian,
)
from surveyapp_models.arrays import Floats

MIDDLE_SIGMA_DIV: Final = 2.0
"""Middle of the swing before a reading tells it: pre-orientation within 10' (Coal Mine Surveying
Regulations 1989, Art. 63) is 0.8 div of 600"; this is wider, for those who set up in haste."""
AMPLITUDE_DIV: Final = 7.5
AMPLITUDE_SIGMA_DIV: Final = 4.0
"""Amplitude before a reading tells it: the scale ends at 15 div (physics.md 2.6)."""
ITERATIONS: Final = 40
CROSSING = 1.1
"""Least amplitude of a first guess in units of the middle: the swing crosses the line."""
LEAST_AMPLITUDE_DIV = 0.1
"""Least amplitude of a first guess [div]."""
MOST_DECREMENT_STEP = 0.1
"""Largest change of the logarithmic decrement in one iteration."""
SMALLEST_DOF: Final = 2
"""Degrees of freedom from which the residuals speak, as in the reduction."""
LEVEL: Final = 0.002
"""A clean passage is called mistimed in 2 of 1000: 1 % of an observation of five passages."""


@dataclass(frozen=True, slots=True)
class PassageForecast:
    """The next passage of a division.

    Parameters
    ----------
    after : int
        Number of the turning point before it.
    division : float
        [div].
    way : str
        R towards larger readings, L towards smaller; empty before a reading tells.
    moment_s : float
        On the clock of the passages.
    half_width_s : float
        Half-width of the 95 % interval.
    """

    after: int
    division: float
    way: Literal["L", "R", ""]
    moment_s: float
    half_width_s: float


@dataclass(frozen=True, slots=True)
class Known:
    """What is known of a swing beforehand.

    Parameters
    ----------
    period_s : float or None
        T2 at this latitude.
    share : float
        Doubt of it, as a share of it.
    floor : float
        Smallest standard deviation of unit weight: what rounding alone makes.
    """

    period_s: float | None
    share: float
    floor: float = 0.0


@dataclass(frozen=True, slots=True)
class PassageFit:
    """The swing as known from readings, passages and what is known beforehand.

    Parameters
    ----------
    swing : ClampedSwing
    parameters : ndarray, shape (5,)
        B [div], A [div], c per half swing, t0 [s], T [s].
    covariance : ndarray, shape (5, 5)
        With the variance of unit weight in it.
    unit : float
        Standard deviation of unit weight in force.
    dof : float
        Its degrees of freedom; infinite where the stated sigmas are taken.
    """

    swing: ClampedSwing
    parameters: Floats
    covariance: Floats
    unit: float
    dof: float

    def passage(self, after: int, division: float) -> tuple[float, float]:
        """Moment of a passage [s] and the standard deviation of timing it there."""
        one = replace(
            self.swing,
            readings=np.empty(0),
            index=np.empty(0),
            sides=np.empty(0),
            passages_s=np.zeros(1),
            divisions=np.array([division]),
            after=np.array([float(after)]),
            sigma_s=1.0,
            first_side=first_side(self.swing),
        )
        moment = float(modelled(one, self.parameters)[1][0])
        row = whitened_jacobian(one, self.parameters)[0]
        variance = float(row @ self.covariance @ row) + (self.unit * self.swing.sigma_s) ** 2
        return moment, math.sqrt(variance)

    def turning(self, index: int) -> tuple[float, float]:
        """Moment of a turning point [s] and the standard deviation of its stamp."""
        row = np.array([0.0, 0.0, 0.0, 1.0, 0.5 * index])
        variance = float(row @ self.covariance @ row) + STAMP_SIGMA_S**2
        return float(row @ self.parameters), math.sqrt(variance)


def first_side(swing: ClampedSwing) -> float:
    """Side of the turning point with the number 0; right where no reading tells."""
    if swing.first_side is not None:
        return swing.first_side
    if swing.sides.size == 0:
        return 1.0
    return float(swing.sides[0]) * (1.0 if int(swing.index[0]) % 2 == 0 else -1.0)


def fit_passages(swing: ClampedSwing, known: Known) -> PassageFit | None:
    """Fit the swing to what was read and to what is known beforehand.

    Parameters
    ----------
    swing : ClampedSwing
        Any number of readings, none included.
    known : Known

    Returns
    -------
    PassageFit or None
        None without a passage, without any period, or where nothing swings.
    """
    period = estimate_period(swing) or known.period_s
    if swing.passages_s.size == 0 or period is None:
        return None
    origin = float(swing.passages_s[0])
    swing = replace(swing, passages_s=swing.passages_s - origin, first_side=first_side(swing))
    prior = _prior(known)
    parameters = _converged(swing, _start(swing, period), prior)
    if parameters is None:
        return None
    residuals = _misfit(swing, parameters)
    dof = residuals.size - PARAMETERS
    unit, own = 1.0, math.inf
    if dof >= SMALLEST_DOF:
        unit = max(math.sqrt(float(residuals @ residuals) / dof), known.floor)
        own = float(dof)
    jacobian = np.vstack([whitened_jacobian(swing, parameters) / unit, prior[0]])
    inverse = np.linalg.pinv(jacobian)
    moved = parameters + np.array([0.0, 0.0, 0.0, origin, 0.0])
    back = replace(swing, passages_s=swing.passages_s + origin)
    return PassageFit(back, moved, inverse @ inverse.T, unit, own)


def _prior(known: Known) -> tuple[Floats, Floats]:
    """Rows and values of what is known beforehand, in units of its sigma."""
    values = [0.0, AMPLITUDE_DIV, LOG_DECREMENT]
    sigmas = [MIDDLE_SIGMA_DIV, AMPLITUDE_SIGMA_DIV, LOG_DECREMENT_SIGMA]
    places = [0, 1, 2]
    if known.period_s is not None:
        values.append(known.period_s)
        sigmas.append(known.share * known.period_s)
        places.append(4)
    rows = np.zeros((len(values), PARAMETERS))
    rows[range(len(values)), places] = 1.0 / np.array(sigmas)
    return rows, np.array(values) / np.array(sigmas)


def _start(swing: ClampedSwing, period: float) -> Floats:
    right, left = swing.readings[swing.sides > 0], swing.readings[swing.sides < 0]
    middle, amplitude = 0.0, AMPLITUDE_DIV
    if right.size and left.size:
        middle = 0.5 * float(right.mean() + left.mean())
        amplitude = 0.5 * float(right.mean() - left.mean())
    elif swing.readings.size:
        amplitude = float(np.abs(swing.readings).mean())
    amplitude = max(amplitude, CROSSING * abs(middle), LEAST_AMPLITUDE_DIV)
    guess = np.array([middle, amplitude, LOG_DECREMENT, 0.0, period])
    guess[3] = float(np.mean(swing.passages_s - modelled(swing, guess)[1]))
    return guess


def _misfit(swing: ClampedSwing, parameters: Floats) -> Floats:
    readings, times = modelled(swing, parameters)
    whitened: Floats = np.concatenate(
        [(swing.readings - readings) / swing.sigma_div, (swing.passages_s - times) / swing.sigma_s]
    )
    return whitened


def _converged(swing: ClampedSwing, start: Floats, prior: tuple[Floats, Floats]) -> Floats | None:
    """Gauss-Newton; None where it leaves what a swing can be."""
    parameters: Floats = start
    for _ in range(ITERATIONS):
        jacobian = np.vstack([whitened_jacobian(swing, parameters), prior[0]])
        misfit = np.concatenate(
            [_misfit(swing, parameters), prior[1] - prior[0] @ parameters],
        )
        step = np.linalg.lstsq(jacobian, misfit, rcond=None)[0]
        largest = 0.5 * parameters[1]
        step[:2] = np.clip(step[:2], -largest, largest)
        step[2] = float(np.clip(step[2], -MOST_DECREMENT_STEP, MOST_DECREMENT_STEP))
        parameters = np.asarray(parameters + step, dtype=np.float64)
        if not np.all(np.isfinite(parameters)) or min(parameters[1], parameters[4]) <= 0.0:
            return None
        scales = np.array([1.0, 1.0, 1.0, parameters[4], parameters[4]])
        if float(np.max(np.abs(step) / scales)) < 1e-8:
            return parameters
    return None


def forecast_passage(fit: PassageFit, after: int, division: float) -> PassageForecast:
    """Forecast the passage behind turning point ``after``.

    ``division`` is what one division of the scale is worth [rad].
    """
    moment, sigma = fit.passage(after, division)
    way: Literal["L", "R", ""] = ""
    if fit.swing.readings.size:
        from_right = (first_side(fit.swing) > 0.0) == (after % 2 == 0)
        way = "L" if from_right else "R"
    return PassageForecast(after, division, way, moment, student_quantile(0.975, fit.dof) * sigma)


def judge_last(
    fit: PassageFit | None, *, after: int, division: float, moment_s: float
) -> tuple[Trouble, float] | None:
    """Hold the passage timed last against its forecast from all that stood before it.

    Parameters
    ----------
    fit : PassageFit or None
        Of everything before this passage.
    after, division
        The passage as it is counted.
    moment_s : float
        As timed.

    Returns
    -------
    (trouble, p) or None
        ``MISSED`` where it comes half a swing or more later than counted, else ``MISTIMED`` (a
        passage pressed twice comes far too early); p is the probability of so large a deviation of
        a clean passage.

    ``division`` is what one division of the scale is worth [rad].
    """
    if fit is None:
        return None
    moment, sigma = fit.passage(after, division)
    p = 2.0 * student_tail(abs(moment_s - moment) / sigma, fit.dof)
    if p >= LEVEL:
        return None
    halves = round((moment_s - moment) / (0.5 * float(fit.parameters[4])))
    return (Trouble.MISSED if halves > 0 else Trouble.MISTIMED), p
