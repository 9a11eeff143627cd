"""Sections 2.1 to 2.6 of the formula sheet, each figure by its own computation.

Weights are written down or built from overlapping Schuler means here; the motion comes from the
integrated equation.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from scripts import compare_estimators as compare
from surveyapp.core.simulate.specification import Noise, SessionSpec
from surveyapp.core.simulate.turning_points import simulate_turning_points
from surveyapp.core.swing.gyrofit import fit_damped_swing
from surveyapp_models.angles import ARCSEC
from surveyapp_models.gyro.integration import Start, TapeTop, integrate
from surveyapp_models.gyro.motion import DampedSwing, swing_position
from surveyapp_models.gyro.periods import clamped_period_s, tracking_period_s

DEGREE_ARCSEC = 3600.0


def schuler(points: int) -> np.ndarray:
    """[1 3 4 ... 4 3 1]/(4 (v - 2)) as the general formula prints it."""
    if points == 3:
        return np.array([1.0, 2.0, 1.0]) / 4.0
    inner = [4.0] * (points - 4)
    return np.array([1.0, 3.0, *inner, 3.0, 1.0]) / (4.0 * (points - 2))


TABLE = [
    # weights, se/sigma, bias/A as a function of q, bias for q = .99 and 1 degree ["], tolerance
    ((1, 1), 0.707, lambda q: (1 - q) / 2, 18.0, 0.05),
    ((1, 2, 1), 0.612, lambda q: (1 - q) ** 2 / 4, 0.09, 0.001),
    ((1, 3, 3, 1), 0.559, lambda q: (1 - q) ** 3 / 8, 0.0005, 6e-5),
    ((1, 1, 1, 1), 0.500, lambda q: (1 - q) * (1 + q**2) / 4, 18.0, 0.3),
    ((1, 3, 4, 3, 1), 0.500, lambda q: (1 - q) ** 2 / 12, 0.03, 0.001),
    ((1, 4, 6, 4, 1), 0.523, lambda q: (1 - q) ** 4 / 16, 0.0, 1e-5),
    ((2, 3, 2, 3, 2), 0.456, lambda q: 5 / 12 * (1 - q) ** 2, 0.15, 0.002),
]


@pytest.mark.parametrize(("weights", "error", "bias", "arcsec", "tolerance"), TABLE)
def test_table_of_reversal_estimators(
    weights: tuple[int, ...],
    error: float,
    bias: Callable[[float], float],
    arcsec: float,
    *,
    tolerance: float,
) -> None:
    w = np.array(weights, dtype=float) / sum(weights)
    assert math.sqrt(w @ w) == pytest.approx(error, abs=6e-4)
    for q in (0.99, 0.999):
        value = abs(w @ (-q) ** np.arange(w.size))
        assert value == pytest.approx(bias(q), rel=0.03)
    assert abs(w @ (-0.99) ** np.arange(w.size)) * DEGREE_ARCSEC == pytest.approx(
        arcsec, abs=tolerance
    )


def test_biases_of_the_integrated_motion_are_those_of_the_table() -> None:
    """Damping .01 and 1 degree; drift; lag both ways: the filters on integrated readings."""
    for name, values in compare.filter_table():
        _, _, formula, damped, drift, leak, curved, lag = values
        assert damped == pytest.approx(formula, rel=1e-3, abs=2e-4), name
        assert abs(drift) < 1e-3, name
        # the swing itself stays N''/pi^2 behind a curved drift
        assert curved == pytest.approx(leak - 2 * compare.QUADRATIC_ARCSEC / math.pi**2, abs=2e-3)
        plain = name in ("2 points", "4 points, plain mean")
        assert lag == pytest.approx(compare.LAG_LOSS_ARCSEC / 2 if plain else 0.0, abs=2e-3), name


@pytest.mark.statistical
def test_simulated_standard_errors_are_those_of_the_table() -> None:
    bound = 4.5 / math.sqrt(2 * compare.RUNS)
    for name, values in compare.filter_table():
        assert values[1] == pytest.approx(values[0], rel=bound), name
    for points, values in compare.naive_errors():
        assert values[1] == pytest.approx(values[0], rel=bound), points
        assert max(values[2], values[3]) < 0.68 * values[0]
    for points, values in compare.least_squares_table():
        assert values[2] == pytest.approx(values[0], rel=4.5 / math.sqrt(2 * compare.FIT_RUNS))
        assert values[3] < 1e-3, points


@pytest.mark.parametrize(
    ("points", "error"), [(4, 0.559), (5, 0.500), (6, 0.451), (7, 0.412), (8, 0.382)]
)
def test_general_schuler_formula(points: int, error: float) -> None:
    w = schuler(points)
    assert math.sqrt(w @ w) == pytest.approx(error, abs=6e-4)
    assert math.sqrt(16 * points - 44) / (4 * (points - 2)) == pytest.approx(
        math.sqrt(w @ w), rel=1e-12
    )
    overlapping = np.zeros(points)
    for i in range(points - 2):
        overlapping[i : i + 3] += np.array([1, 2, 1]) / (4 * (points - 2))
    assert np.allclose(w, overlapping)
    assert np.allclose(compare.Filter("", compare.schuler_weights(points)).vector, w)


def test_the_monograph_took_the_means_for_independent() -> None:
    """14.7cc, 7 points: printed 3.3cc, true 6.1cc."""
    assert 14.7 / (2 * math.sqrt(5)) == pytest.approx(3.3, abs=0.02)
    assert 14.7 * math.sqrt(float(schuler(7) @ schuler(7))) == pytest.approx(6.1, abs=0.05)


def least_squares_weights(points: int, *columns: np.ndarray) -> np.ndarray:
    """Weights by which N at mid-time is formed: first row of the pseudo-inverse."""
    k = np.arange(points, dtype=float)
    sign = (-1.0) ** k
    inverse = np.linalg.pinv(np.column_stack([np.ones(points), sign, *columns]))
    return np.asarray(inverse[0])


@pytest.mark.parametrize(
    ("points", "error"),
    [(4, 0.559), (5, 0.456), (6, 0.427), (7, 0.382), (8, 0.362), (10, 0.321)],
)
def test_least_squares_errors_and_free_drift(points: int, error: float) -> None:
    k = np.arange(points, dtype=float)
    damping = (-1.0) ** k * k
    w = least_squares_weights(points, damping)
    assert math.sqrt(w @ w) == pytest.approx(error, abs=6e-4)
    if points > 4:
        drifting = least_squares_weights(points, damping, k - k.mean())
        assert math.sqrt(drifting @ drifting) == pytest.approx(math.sqrt(w @ w), rel=1e-12)
    assert w @ (k - k.mean()) == pytest.approx(0.0, abs=1e-12)


def test_least_squares_is_one_three_three_one_and_one_two_one() -> None:
    k = np.arange(4, dtype=float)
    assert np.allclose(least_squares_weights(4, (-1.0) ** k * k) * 8, [1, 3, 3, 1])
    assert np.allclose(least_squares_weights(3) * 4, [1, 2, 1])
    five = np.arange(5, dtype=float)
    assert np.allclose(least_squares_weights(5, (-1.0) ** five * five) * 12, [2, 3, 2, 3, 2])


def test_quadratic_leak_of_schuler_means() -> None:
    for points, leak in ((3, 0.5), (4, 0.75), (5, 1.17)):
        place = np.arange(points) - (points - 1) / 2
        moment = float(schuler(points) @ place**2)
        assert moment / 2 == pytest.approx(leak / 2, abs=3e-3)


def test_source_000_schuler_figures() -> None:
    """Damping .005 per half swing, A = 3600": 9.0, .0225, 5.6e-5; plain least squares about 9."""
    u = np.asarray(3600.0 * (-0.995) ** np.arange(6), dtype=np.float64)
    assert abs(u[:2].mean()) == pytest.approx(9.0, abs=0.01)
    assert abs(schuler(3) @ u[:3]) == pytest.approx(0.0225, abs=1e-4)
    assert abs(schuler(4) @ u[:4]) == pytest.approx(5.6e-5, abs=1e-6)
    for points in (4, 6):
        assert abs(least_squares_weights(points) @ u[:points]) == pytest.approx(9.0, abs=0.1)
    k = np.arange(6, dtype=float)
    fitted = fit_damped_swing(u, k, np.sign(u))
    assert fitted.north == pytest.approx(0.0, abs=1e-6)


# --- 2.2 amplitude method, 2.3 transit method ---------------------------------------------------


def test_amplitude_method_error() -> None:
    """0.1 div, 600"/div, lambda .2: 44"; and by simulation of the readings."""
    assert 1.2 * 600 * math.sqrt(float(schuler(3) @ schuler(3))) * 0.1 == pytest.approx(44, abs=0.2)
    spec = SessionSpec(
        method="amplitude",
        points=3,
        noise=Noise(scale_div=0.1, scale_resolution_div=0.0),
    )
    made = simulate_turning_points(spec, 3000, np.random.default_rng(1))
    ratio = (
        tracking_period_s(spec.gyro, spec.latitude) / clamped_period_s(spec.gyro, spec.latitude)
    ) ** 2
    north = ratio * 600 * (made.readings @ schuler(3))
    assert np.std(north) == pytest.approx(44.1, rel=4 / math.sqrt(6000))


def test_transit_time_differences() -> None:
    three, five = np.array([-1, 2, -1]), np.array([-1, 3, -4, 3, -1]) / 3
    assert math.sqrt(three @ three) == pytest.approx(2.454, abs=0.006)
    assert math.sqrt(five @ five) == pytest.approx(2.0, rel=1e-12)
    # five passages: the mean of the three overlapping differences, of alternating sign
    rows = np.zeros((3, 5))
    for i in range(3):
        rows[i, i : i + 3] = three * (-1) ** i
    assert np.allclose(rows.mean(axis=0), five)
    for passages, north in ((three, 14.3), (five, 11.6)):
        error = 2.91 * 10 * 0.2 * math.sqrt(float(passages @ passages))
        assert error == pytest.approx(north, abs=0.06)


def test_transit_time_noise_by_simulation() -> None:
    spec = SessionSpec(method="transit", points=5, noise=Noise(time_s=0.2, time_resolution_s=0.0))
    made = simulate_turning_points(spec, 4000, np.random.default_rng(2))
    times = made.passage_time_s[:, 0]
    five = times @ np.array([-1, 3, -4, 3, -1]) / 3
    three = times[:, :3] @ np.array([-1, 2, -1])
    bound = 4 / math.sqrt(8000)
    assert np.std(five) == pytest.approx(0.4, rel=bound)
    assert np.std(three) == pytest.approx(0.2 * math.sqrt(6), rel=bound)


@pytest.mark.parametrize(
    ("ratio", "passages", "expected"),
    [(1.0, 3, 1.34), (1.0, 5, 1.34), (0.98, 3, 1.5), (0.98, 5, 1.7)],
)
def test_damping_hardly_disturbs_the_transit_method(
    ratio: float, passages: int, expected: float
) -> None:
    """q = .98 per half swing, 10' off, dt = 29 s: the error grows from 1.3" to 1.5 and 1.7"."""
    spec = SessionSpec(
        method="transit",
        points=5,
        ratio=ratio,
        clamp_offset=-600 * ARCSEC,
        amplitude=7.2 * 600 * ARCSEC,
        noise=Noise(time_s=0.0, time_resolution_s=0.0, scale_div=0.0, scale_resolution_div=0.0),
    )
    made = simulate_turning_points(spec, 1, np.random.default_rng(3))
    t1 = tracking_period_s(spec.gyro, spec.latitude)
    t2 = clamped_period_s(spec.gyro, spec.latitude)
    weights = np.array([-1, 2, -1]) if passages == 3 else np.array([-1, 3, -4, 3, -1]) / 3
    sign = 1.0 if made.passage_eastward[0, 0, 0] else -1.0
    difference = sign * float(made.passage_time_s[0, 0, :passages] @ weights)
    assert difference == pytest.approx(29.0, abs=1.2)
    # amplitude of the half swings between the timed passages
    amplitude = float(np.mean(np.abs(np.diff(made.readings[0, 1:passages])))) / 2
    c = math.pi / 2 * 600 * t1**2 / t2**3
    assert c * amplitude * difference - 600.0 == pytest.approx(expected, abs=0.05)


# --- 2.4 record length --------------------------------------------------------------------------


def error_of_centre(periods: float, phase: float, unknowns: int) -> float:
    """se(B) sqrt(n)/sigma for n equally spaced readings; B, 2 of the swing, T, damping."""
    t = np.linspace(0.0, 2 * math.pi * periods, 1501)
    c, s = np.cos(t + phase), np.sin(t + phase)
    columns = [np.ones_like(t), c, s, t * s, t * c][:unknowns]
    # derivative by the period is t sin, by the damping t cos, of a swing cos(t + phase)
    r = np.linalg.qr(np.column_stack(columns), mode="r")
    inverse = np.linalg.solve(r, np.eye(unknowns))
    return math.sqrt(float(np.sum(inverse[0] ** 2)) * t.size)


@pytest.mark.parametrize(
    ("periods", "known", "period_free", "damping_free"),
    [
        (0.5, 2.3, 45.0, 45.0),
        (0.75, 1.14, 7.8, 7.8),
        (1.0, 1.00, 2.2, 2.2),
        (1.25, 1.03, 1.13, 1.14),
        (1.5, 1.05, 1.05, 1.05),
        # over two periods 1.04 is the mean over the phases; the worst phase has 1.09
        (2.0, 1.00, 1.09, 1.09),
    ],
)
def test_error_against_length_of_record(
    periods: float, known: float, period_free: float, damping_free: float
) -> None:
    phases = np.linspace(0.0, math.pi, 181)
    worst = [max(error_of_centre(periods, p, u) for p in phases) for u in (3, 4, 5)]
    assert worst[0] == pytest.approx(known, rel=0.01)
    assert worst[1] == pytest.approx(period_free, rel=0.02)
    assert worst[2] == pytest.approx(damping_free, rel=0.02)


def test_a_timed_passage_weighs_by_its_time() -> None:
    """Var of x(t_i) - x_line is (dx/dt)^2 sigma_t^2: by simulation of noisy clocks."""
    swing = DampedSwing(0.0, 10.0, 0.0, 2 * math.pi / 388.3, -math.pi / 2)
    rng = np.random.default_rng(5)
    rate = 10.0 * 2 * math.pi / 388.3
    spread = np.std(swing_position(swing, 0.2 * rng.normal(size=20000)))
    assert spread == pytest.approx(rate * 0.2, rel=0.02)


# --- 2.5, 2.6 -----------------------------------------------------------------------------------


def test_tape_zero_figures() -> None:
    unspun = 3.0 * (-0.99) ** np.arange(3) + 0.4
    assert schuler(3) @ unspun == pytest.approx(0.4, abs=1e-4)


def test_pre_orientation_by_two_reversals() -> None:
    """A = 5 degrees, q = .99: 90"."""
    spec = SessionSpec(
        points=4,
        ratio=0.99,
        amplitude=math.radians(5.0),
        noise=Noise(reading=0.0, reading_resolution=0.0),
    )
    made = simulate_turning_points(spec, 1, np.random.default_rng(1))
    found = made.readings[0, :2].mean() - spec.circle_of_north
    assert found / ARCSEC == pytest.approx(90.0, abs=1.0)


def test_pre_orientation_by_a_quarter_of_the_period() -> None:
    """A quarter period after a reversal the line of sight is on north; 0.89' per s and degree."""
    spec = SessionSpec()
    period = tracking_period_s(spec.gyro, spec.latitude)
    motion = integrate(
        spec.gyro,
        spec.latitude,
        Start(np.array([math.radians(1.0)]), np.zeros(1)),
        duration_s=period / 2,
        step_s=period / 400,
        tape=TapeTop(),
    )
    at = int(np.argmin(np.abs(motion.time_s - period / 4)))
    assert abs(motion.azimuth[at, 0]) < 0.3 * ARCSEC * 60
    assert abs(motion.velocity[at, 0]) / ARCSEC / 60 == pytest.approx(0.89, abs=0.005)
