"""Bandwidth of a sensor from its step response or from a frequency sweep.

A first-order low-pass is fitted, and a second-order one beside it; the one with the smaller BIC
gives the frequency at which the amplitude has fallen by 3 dB.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.sensor_log import SensorLog
from surveyapp_models.arrays import Floats

Model = Callable[[Floats], Floats]


def bandwidth(log: SensorLog, rows: Floats) -> SensorParameter:
    """-3 dB frequency [Hz] of the rows of the dynamic test; null where they do not tell."""
    null = SensorParameter("bandwidth", None, None, "Hz")
    if np.count_nonzero(rows) < 6:
        return null
    output = log.columns["output"][rows]
    frequency = log.columns.get("frequency_hz")
    if frequency is not None and np.all(np.isfinite(frequency[rows])):
        found = _from_sweep(frequency[rows], np.abs(output))
    else:
        time = log.columns.get("time_s")
        if time is None or not np.all(np.isfinite(time[rows])):
            return null
        found = _from_step(time[rows], output)
    if found is None:
        return null
    return SensorParameter("bandwidth", found[0], found[1], "Hz")


def first_order_gain(frequency: Floats, corner: float) -> Floats:
    """|H| of a first-order low-pass with its -3 dB frequency [Hz]."""
    return np.asarray(1.0 / np.sqrt(1.0 + (frequency / corner) ** 2))


def second_order_gain(frequency: Floats, natural: float, damping: float) -> Floats:
    """|H| of a second-order low-pass with natural frequency [Hz] and damping ratio."""
    x = frequency / natural
    return np.asarray(1.0 / np.sqrt((1.0 - x**2) ** 2 + (2.0 * damping * x) ** 2))


def corner_of(natural: float, damping: float) -> float:
    """-3 dB frequency of a second-order low-pass [Hz]."""
    c = 1.0 - 2.0 * damping**2
    return natural * math.sqrt(c + math.sqrt(c**2 + 1.0))


def _from_sweep(frequency: Floats, amplitude: Floats) -> tuple[float, float] | None:
    if np.any(frequency <= 0.0) or np.any(amplitude <= 0.0) or np.unique(frequency).size < 4:
        return None
    top = float(np.median(np.sort(amplitude)[-3:]))
    below = frequency[amplitude < top / math.sqrt(2.0)]
    guess = float(below.min()) if below.size else float(frequency.max())

    def first(x: Floats) -> Floats:
        return np.asarray(np.exp(x[0]) * first_order_gain(frequency, math.exp(x[1])) - amplitude)

    def second(x: Floats) -> Floats:
        gain = second_order_gain(frequency, math.exp(x[1]), math.exp(x[2]))
        return np.asarray(np.exp(x[0]) * gain - amplitude)

    start = [math.log(top), math.log(guess)]
    return _better(first, second, start, [*start, math.log(0.7)])


def _from_step(time: Floats, output: Floats) -> tuple[float, float] | None:
    tenth = max(output.size // 10, 2)
    low, high = float(np.mean(output[:tenth])), float(np.mean(output[-tenth:]))
    if low == high:
        return None
    risen = np.flatnonzero((output - low) / (high - low) > 0.5)
    span = float(time[-1] - time[0])
    if not risen.size or span <= 0.0:
        return None
    at = float(time[risen[0]])
    guess = [low, high - low, at - 0.02 * span, math.log(0.1 * span)]

    def first(x: Floats) -> Floats:
        t = np.maximum(time - x[2], 0.0) / math.exp(min(x[3], 50.0))
        return np.asarray(x[0] + x[1] * -np.expm1(-t) - output)

    def second(x: Floats) -> Floats:
        damping, omega = math.exp(min(x[4], 20.0)), math.exp(min(-x[3], 50.0))
        t = np.maximum(time - x[2], 0.0) * omega
        root = np.sqrt(complex(damping**2 - 1.0 + 1e-12))
        p, q = -damping + root, -damping - root
        response = 1.0 - (q * np.exp(p * t) - p * np.exp(q * t)) / (q - p)
        return np.asarray(x[0] + x[1] * response.real - output)

    return _better(first, second, guess, [*guess, math.log(0.8)], step=True)


def _better(
    first: Model, second: Model, start: list[float], start2: list[float], *, step: bool = False
) -> tuple[float, float] | None:
    """Corner and sigma of the model with the smaller BIC."""
    from scipy.optimize import least_squares

    best: tuple[float, float, float] | None = None
    for model, guess in ((first, start), (second, start2)):
        solution = least_squares(model, guess, x_scale="jac", max_nfev=400)
        n, p = solution.fun.size, len(guess)
        total = float(solution.fun @ solution.fun)
        if n <= p or not np.all(np.isfinite(solution.x)):
            continue
        bic = n * math.log(max(total, 1e-300) / n) + p * math.log(n)

        def corner(x: Floats, second_order: bool = model is second) -> float:
            if step:
                base = math.exp(-x[3]) / (2.0 * math.pi)
                return corner_of(base, math.exp(x[4])) if second_order else base
            base = math.exp(x[1])
            return corner_of(base, math.exp(x[2])) if second_order else base

        try:
            value = corner(solution.x)
            gradient = np.array(
                [(corner(solution.x + h) - corner(solution.x - h)) / 2e-6 for h in 1e-6 * np.eye(p)]
            )
        except OverflowError:
            continue
        _q, r = np.linalg.qr(solution.jac)
        if np.min(np.abs(np.diag(r))) < 1e-12 * np.max(np.abs(np.diag(r))):
            continue
        spread = np.linalg.solve(r.T, gradient)
        sigma = math.sqrt(float(spread @ spread) * total / (n - p))
        if best is None or bic < best[0]:
            best = (bic, value, sigma)
    return None if best is None else (best[1], best[2])
