"""Compare the estimators of gyro north on turning points of the integrated motion.

``python -m scripts.compare_estimators`` prints what stands in docs/reference/estimators.md; the
page itself is written by ``scripts/generate_docs.py``. Nothing here is random but the reading
noise, whose seed is fixed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.core.simulate.disturbing import damped_gyro
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.core.swing.gyrofit import fit_damped_swing
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.gyro.integration import Disturbance, Start, TapeTop, integrate
from surveyapp_models.gyro.moments import directive_moment
from surveyapp_models.gyro.motion import Events, turning_points
from surveyapp_models.gyro.periods import tracking_period_s

RATIO = 0.99
AMPLITUDE = math.radians(1.0)
SIGMA_ARCSEC = 4.0
RUNS = 20000
FIT_RUNS = 300
DRIFT_ARCSEC = 2.0
QUADRATIC_ARCSEC = 0.2
LAG_LOSS_ARCSEC = 24.0
STEPS = 192
LONGEST = 10
SEED = 20260302


@dataclass(frozen=True)
class Filter:
    """A linear estimator: weights of successive turning points, sum 1."""

    name: str
    weights: tuple[float, ...]

    @property
    def vector(self) -> Floats:
        """Weights with sum 1."""
        values = np.array(self.weights)
        return np.asarray(values / values.sum())


def schuler_weights(points: int) -> tuple[float, ...]:
    """Weights of the mean of all overlapping Schuler means of ``points`` turning points."""
    weights = np.zeros(points)
    for first in range(points - 2):
        weights[first : first + 3] += (1.0, 2.0, 1.0)
    return tuple(weights)


FILTERS = (
    Filter("2 points", (1, 1)),
    Filter("3 points, Schuler (1-2-1)", (1, 2, 1)),
    Filter("4 points, mean of two Schuler means (1-3-3-1)", schuler_weights(4)),
    Filter("4 points, plain mean", (1, 1, 1, 1)),
    Filter("5 points, mean of three Schuler means (1-3-4-3-1)", schuler_weights(5)),
    Filter("5 points, binomial (1-4-6-4-1)", (1, 4, 6, 4, 1)),
    Filter("5 points, mean of side means (2-3-2-3-2)", (2, 3, 2, 3, 2)),
    *(Filter(f"{v} points, mean of {v - 2} Schuler means", schuler_weights(v)) for v in (6, 7, 8)),
)


def standard_error(weights: Floats) -> float:
    """Standard error over sigma for white noise."""
    return float(np.sqrt(np.sum(weights**2)))


def damping_bias(weights: Floats, ratio: float = RATIO) -> float:
    """Bias over the first amplitude under viscous damping."""
    return float(np.sum(weights * (-ratio) ** np.arange(weights.size)))


def quadratic_leak(weights: Floats) -> float:
    """Half the second moment of the weights about their centre [half swings squared]."""
    place = np.arange(weights.size) - 0.5 * (weights.size - 1)
    return 0.5 * float(np.sum(weights * place**2))


def undisturbed(
    ratio: float,
    *,
    drift_arcsec: float = 0.0,
    quadratic_arcsec: float = 0.0,
    lag_loss_arcsec: float = 0.0,
    count: int = LONGEST,
) -> tuple[Floats, Floats]:
    """Noise-free turning points [arcsec] of the integrated motion and north at their numbers.

    The drift is in arc-seconds per half swing, the quadratic one per half swing squared.
    """
    spec = SessionSpec(ratio=ratio, amplitude=AMPLITUDE)
    gyro = damped_gyro(spec)
    half = 0.5 * tracking_period_s(gyro, spec.latitude)
    moment = directive_moment(gyro, spec.latitude)

    def north(t: float | Floats) -> Floats:
        k = np.asarray(t) / half
        return np.asarray((drift_arcsec * k + quadratic_arcsec * k**2) * ARCSEC)

    phase = 0.25 * math.pi
    start = Start(
        np.array([AMPLITUDE * math.cos(phase)]),
        np.array([AMPLITUDE * math.sin(phase) * math.pi / half]),
        -0.25 * half,
    )
    motion = integrate(
        gyro,
        spec.latitude,
        start,
        duration_s=(count + 0.25) * half,
        step_s=half / STEPS,
        tape=TapeTop(lag=0.5 * lag_loss_arcsec * ARCSEC * moment / gyro.torsion),
        disturbance=Disturbance(torque=lambda t: moment * north(t)),
    )
    found: Events = turning_points(motion, count)
    return found.azimuth[0] / ARCSEC, north(np.asarray(np.arange(count) * half)) / ARCSEC


def bias_arcsec(weights: Floats, readings: Floats, north: Floats) -> float:
    """What the filter returns minus north at its own mid-time [arcsec]."""
    middle = 0.5 * (weights.size - 1)
    truth = float(np.interp(middle, np.arange(north.size), north))
    return float(weights @ readings[: weights.size]) - truth


def noise_ensemble() -> Floats:
    """Reading noise [arcsec], shape (runs, points)."""
    rng = np.random.default_rng(SEED)
    return SIGMA_ARCSEC * rng.normal(size=(RUNS, LONGEST))


def filter_table() -> list[tuple[str, list[float]]]:
    """Rows: se/sigma by formula and simulated; biases by damping, drift, quadratic, lag."""
    noise = noise_ensemble()
    damped, still = undisturbed(RATIO)
    drifting, moving = undisturbed(1.0, drift_arcsec=DRIFT_ARCSEC)
    bending, _ = undisturbed(1.0, quadratic_arcsec=QUADRATIC_ARCSEC)
    lagging, _ = undisturbed(1.0, lag_loss_arcsec=LAG_LOSS_ARCSEC)
    rows = []
    for item in FILTERS:
        w = item.vector
        # north at the middle between two turning points of a parabola is not their mean
        middle = 0.5 * (w.size - 1)
        curved = QUADRATIC_ARCSEC * middle**2
        amplitude = abs(damped[0])
        rows.append(
            (
                item.name,
                [
                    standard_error(w),
                    float(np.std(noise[:, : w.size] @ w)) / SIGMA_ARCSEC,
                    abs(damping_bias(w)) * amplitude,
                    abs(bias_arcsec(w, damped, still)),
                    bias_arcsec(w, drifting, moving),
                    2.0 * QUADRATIC_ARCSEC * quadratic_leak(w),
                    float(w @ bending[: w.size]) - curved,
                    abs(bias_arcsec(w, lagging, still)),
                ],
            )
        )
    return rows


def least_squares_cofactor(points: int, *, drift: bool = False) -> float:
    """se(N)/sigma at mid-time of the linearised fit of N, A, damping (and a drift of N)."""
    k = np.arange(points, dtype=np.float64)
    sign = (-1.0) ** k
    columns = [np.ones(points), sign, sign * k]
    if drift:
        columns.append(k - k.mean())
    r = np.linalg.qr(np.column_stack(columns), mode="r")
    inverse = np.linalg.solve(r, np.eye(len(columns)))
    return float(math.sqrt(np.sum(inverse[0] ** 2)))


def least_squares_table() -> list[tuple[int, list[float]]]:
    """Rows: points; se/sigma linearised, simulated; rms and bias under damping [arcsec]."""
    damped, _ = undisturbed(RATIO)
    lagging, _ = undisturbed(1.0, lag_loss_arcsec=LAG_LOSS_ARCSEC)
    noise = noise_ensemble()
    rows = []
    for points in (4, 5, 6, 7, 8, 10):
        k = np.arange(points, dtype=np.float64)
        sides = np.where(damped[:points] > 0.0, 1.0, -1.0)
        found = [
            fit_damped_swing(damped[:points] + noise[run, :points], k, sides).north
            for run in range(FIT_RUNS)
        ]
        rows.append(
            (
                points,
                [
                    least_squares_cofactor(points),
                    least_squares_cofactor(points, drift=True) if points > 4 else math.nan,
                    float(np.std(found)) / SIGMA_ARCSEC,
                    abs(fit_damped_swing(damped[:points], k, sides).north),
                    abs(fit_damped_swing(lagging[:points], k, sides).north),
                ],
            )
        )
    return rows


def naive_errors() -> list[tuple[int, list[float]]]:
    """Rows: points; true se/sigma of the mean of Schuler means, and the two usual mistakes."""
    noise = noise_ensemble() / SIGMA_ARCSEC
    rows = []
    for points in range(4, 9):
        means = (noise[:, : points - 2] + 2 * noise[:, 1 : points - 1] + noise[:, 2:points]) / 4
        scatter = np.sqrt(np.mean(np.var(means, axis=1, ddof=1)) / (points - 2))
        rows.append(
            (
                points,
                [
                    math.sqrt(16 * points - 44) / (4 * (points - 2)),
                    float(np.std(means.mean(axis=1))),
                    1.0 / (2.0 * math.sqrt(points - 2)),
                    float(scatter),
                ],
            )
        )
    return rows


def main() -> None:
    for name, values in filter_table():
        print(f"{name:52s}" + "".join(f"{value:9.4f}" for value in values))
    for points, values in least_squares_table():
        print(f"least squares {points:2d}" + "".join(f"{value:9.4f}" for value in values))
    for points, values in naive_errors():
        print(f"Schuler {points:2d}" + "".join(f"{value:9.4f}" for value in values))


if __name__ == "__main__":
    main()
