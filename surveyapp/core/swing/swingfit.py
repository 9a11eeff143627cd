"""Full fit of a clamped swing: scale readings at turning points and timed passages together.

x(t) = B + A/cos(delta) s0 exp(-k tau) cos(w tau - delta), tau = t - t0, tan(delta) = k/w, so that
t0 is a turning point with the reading B + s0 A, the turning points follow each other by T/2, and
each loses the factor exp(-c), c = k T/2. A timed passage is observed as a TIME: its residual is
t_i - t(x_i), never a scale reading of the wrong size (physics.md 2.4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.core.swing.gyrofit import fit_damped_swing
from surveyapp_models.arrays import Floats

PARAMETERS = 5
MAX_ITERATIONS = 60


@dataclass(frozen=True, slots=True)
class ClampedSwing:
    """Observations of one clamped swing.

    Parameters
    ----------
    readings : ndarray, shape (n,)
        Scale readings at turning points [div].
    index : ndarray, shape (n,)
        Their numbers from the first one, missed ones counted.
    sides : ndarray, shape (n,)
        +1 larger reading, -1 smaller.
    passages_s : ndarray, shape (m,)
        Moments of timed passages [s].
    divisions : ndarray, shape (m,)
        Scale division passed [div].
    after : ndarray, shape (m,)
        Number of the turning point before each passage (-1 before the first).
    sigma_div, sigma_s : float
        Standard deviations a priori; their ratio sets the weights.
    first_side : float or None
        Side of the turning point with the number 0; None: the readings tell.
    """

    readings: Floats
    index: Floats
    sides: Floats
    passages_s: Floats
    divisions: Floats
    after: Floats
    sigma_div: float
    sigma_s: float
    first_side: float | None = None

    @property
    def count(self) -> int:
        """Number of observations."""
        return self.readings.size + self.passages_s.size


@dataclass(frozen=True, slots=True)
class ClampedFit:
    """Result of the full fit.

    Parameters
    ----------
    middle_div : float
        B [div].
    amplitude_div : float
        A at the first turning point [div].
    log_decrement : float
        c per half swing.
    period_s : float
        T [s]; 0 where there are no passages.
    reading_residuals : ndarray, shape (n,)
        [div].
    passage_residuals : ndarray, shape (m,)
        [s].
    cofactor_middle : float
        Variance of B divided by the variance of unit weight [div^2].
    unit_variance : float or None
        v'Pv / dof.
    dof : int
    jacobian : ndarray
        Whitened derivatives at the solution.
    converged : bool
    """

    middle_div: float
    amplitude_div: float
    log_decrement: float
    period_s: float
    reading_residuals: Floats
    passage_residuals: Floats
    cofactor_middle: float
    unit_variance: float | None
    dof: int
    jacobian: Floats
    converged: bool

    @property
    def whitened(self) -> Floats:
        """Residuals in units of their a-priori sigma, readings first."""
        return np.concatenate([self.reading_residuals, self.passage_residuals])


def shape(tau: Floats, *, decrement: float, period: float) -> tuple[Floats, Floats]:
    """Unit swing that turns at tau = 0, and its rate [1/s]."""
    w, k = 2.0 * math.pi / period, 2.0 * decrement / period
    delta = math.atan2(k, w)
    decay = np.exp(-k * tau) / math.cos(delta)
    phase = w * tau - delta
    return decay * np.cos(phase), -decay * (k * np.cos(phase) + w * np.sin(phase))


def _polarity(swing: ClampedSwing) -> float:
    """Side of the turning point with the number 0."""
    if swing.first_side is not None:
        return swing.first_side
    return float(swing.sides[0]) * (1.0 if int(swing.index[0]) % 2 == 0 else -1.0)


def passage_times(swing: ClampedSwing, parameters: Floats) -> tuple[Floats, Floats]:
    """Moments at which the swing passes each division, and its rate there [div/s]."""
    middle, amplitude, decrement, start, period = parameters.tolist()
    s0 = _polarity(swing)
    tau = (swing.after + 0.5) * 0.5 * period
    low, high = tau - 0.25 * period, tau + 0.25 * period
    for _ in range(60):
        unit, rate = shape(tau, decrement=decrement, period=period)
        gap = middle + amplitude * s0 * unit - swing.divisions
        speed = amplitude * s0 * rate
        rising = speed > 0.0
        high = np.where((gap > 0.0) == rising, tau, high)
        low = np.where((gap > 0.0) == rising, low, tau)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = tau - gap / speed
        inside = (newton >= low) & (newton <= high)  # at the root itself one of the two is tau
        step = np.where(inside, newton, 0.5 * (low + high)) - tau
        tau = tau + step
        if float(np.max(np.abs(step), initial=0.0)) < 1e-12 * period:
            break
    _, rate = shape(tau, decrement=decrement, period=period)
    return start + tau, amplitude * s0 * rate


def modelled(swing: ClampedSwing, parameters: Floats) -> tuple[Floats, Floats]:
    """Readings [div] and passage times [s] that the parameters B, A, c, t0, T predict."""
    middle, amplitude, decrement = parameters[:3].tolist()
    readings = middle + amplitude * swing.sides * np.exp(-decrement * swing.index)
    times, _ = passage_times(swing, parameters)
    return readings, times


def whitened_jacobian(swing: ClampedSwing, parameters: Floats) -> Floats:
    """Whitened derivatives by B, A, c, t0, T; readings first, then passages.

    Those of a passage are dt = -(dx at fixed time) / (rate).
    """
    _, amplitude, decrement, start, period = parameters.tolist()
    times, rate = passage_times(swing, parameters)
    tau = times - start
    s0 = _polarity(swing)

    def unit(c: float, full: float) -> Floats:
        return shape(tau, decrement=c, period=full)[0]

    by_decrement = (unit(decrement + 1e-6, period) - unit(decrement - 1e-6, period)) / 2e-6
    by_period = (unit(decrement, period + 1e-3) - unit(decrement, period - 1e-3)) / 2e-3
    moved = amplitude * s0
    fixed_time = [np.ones_like(tau), s0 * unit(decrement, period), moved * by_decrement]
    decay = swing.sides * np.exp(-decrement * swing.index)
    zero = np.zeros_like(decay)
    by_reading = [np.ones_like(decay), decay, -amplitude * swing.index * decay, zero, zero]
    by_time = [-column / rate for column in fixed_time]
    by_time += [np.ones_like(tau), -moved * by_period / rate]
    return np.column_stack(
        [
            np.concatenate([reading / swing.sigma_div, time / swing.sigma_s])
            for reading, time in zip(by_reading, by_time, strict=True)
        ]
    )


def _start(swing: ClampedSwing, period: float) -> Floats:
    """First guess: turning points give B, A, c; the passages t0."""
    if swing.readings.size >= 3:
        fit = fit_damped_swing(swing.readings, swing.index, swing.sides)
        middle, amplitude, decrement = fit.north, fit.amplitude, fit.log_decrement
        decrement = min(max(decrement, -0.05), 0.2)
    else:
        middle = float(swing.readings.mean())
        amplitude = 0.5 * float(np.ptp(swing.readings))
        decrement = 0.0
    guess = np.array([middle, amplitude, decrement, 0.0, period])
    times, _ = passage_times(swing, guess)
    guess[3] = float(np.mean(swing.passages_s - times))
    return guess


def estimate_period(swing: ClampedSwing) -> float | None:
    """Full period from passages of one division in one direction [s], None without a pair.

    The interval between passages two half swings apart is one period whatever the offset.
    """
    spans = []
    for i in range(swing.passages_s.size):
        for j in range(i + 1, swing.passages_s.size):
            halves = swing.after[j] - swing.after[i]
            if halves > 0 and halves % 2 == 0 and swing.divisions[i] == swing.divisions[j]:
                spans.append(2.0 * (swing.passages_s[j] - swing.passages_s[i]) / halves)
    return float(np.mean(spans)) if spans else None


def fit_clamped(swing: ClampedSwing, *, period_s: float) -> ClampedFit:
    """Least squares of B, A, damping, t0 and T from readings and passages.

    Parameters
    ----------
    swing : ClampedSwing
        At least 5 observations, passages among them, readings on both sides.
    period_s : float
        First guess of the full period [s].
    """
    parameters = _start(swing, period_s)
    observed = np.concatenate([swing.readings / swing.sigma_div, swing.passages_s / swing.sigma_s])
    converged = False
    for _ in range(MAX_ITERATIONS):
        jacobian = whitened_jacobian(swing, parameters)
        readings, times = modelled(swing, parameters)
        computed = np.concatenate([readings / swing.sigma_div, times / swing.sigma_s])
        step = np.linalg.lstsq(jacobian, observed - computed, rcond=None)[0]
        step[2] = min(max(float(step[2]), -0.3), 0.3)
        parameters = parameters + step
        if parameters[4] <= 0.0 or not np.all(np.isfinite(parameters)):
            break
        if float(np.max(np.abs(step) / np.array([1.0, 1.0, 1.0, period_s, period_s]))) < 1e-7:
            converged = True
            break
    readings, times = modelled(swing, parameters)
    jacobian = whitened_jacobian(swing, parameters)
    v_readings, v_times = swing.readings - readings, swing.passages_s - times
    dof = swing.count - PARAMETERS
    square = float(np.sum((v_readings / swing.sigma_div) ** 2))
    square += float(np.sum((v_times / swing.sigma_s) ** 2))
    inverse = np.linalg.pinv(jacobian)
    return ClampedFit(
        middle_div=float(parameters[0]),
        amplitude_div=float(parameters[1]),
        log_decrement=float(parameters[2]),
        period_s=float(parameters[4]),
        reading_residuals=v_readings,
        passage_residuals=v_times,
        cofactor_middle=float(inverse[0] @ inverse[0]),
        unit_variance=square / dof if dof > 0 else None,
        dof=dof,
        jacobian=jacobian,
        converged=converged and float(parameters[1]) > 0.0,
    )
