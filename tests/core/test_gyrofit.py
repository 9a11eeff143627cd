import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveyapp.core.swing.gyrofit import (
    design,
    fit_damped_swing,
    schuler_means,
    unwrap,
)

JOHANNESBURG = (  # Williams & Belling 1967, p. 273: 20 turning points of a Wild GAK1
    "179-01-56 181-17-26 179-06-05 181-12-59 179-11-16 181-07-43 179-12-42 181-06-52 "
    "179-13-42 181-05-58 179-14-35 181-04-50 179-14-58 181-04-32 179-15-39 181-03-56 "
    "179-15-59 181-03-39 179-16-19 181-03-02"
)


def schuler_standard_error(points: int, sigma: float) -> float:
    """Standard error of the mean of all overlapping Schuler means.

    The means share readings: dividing the scatter by the root of their number is wrong by a factor
    of up to two.

    Parameters
    ----------
    points : int
        Number of consecutive turning points, at least 3.
    sigma : float
        Standard deviation of one turning point.

    Source: physics.md 2.1, se = sigma sqrt(16 v - 44) / (4 (v - 2)) for v >= 4; sqrt(6)/4 sigma
    for v = 3.
    """
    if points < 3:
        raise ValueError("a Schuler mean needs three turning points")
    if points == 3:
        return sigma * math.sqrt(6.0) / 4.0
    return sigma * math.sqrt(16.0 * points - 44.0) / (4.0 * (points - 2))


def seconds(text: str) -> np.ndarray:
    return np.array(
        [
            sum(
                float(part) * 60**power
                for part, power in zip(item.split("-"), (2, 1, 0), strict=True)
            )
            for item in text.split()
        ]
    )


def test_johannesburg_schuler_and_least_squares() -> None:
    u = seconds(JOHANNESBURG)
    k = np.arange(20.0)
    means, weights = schuler_means(u, k)
    assert means.size == 18
    # printed weighted mean 180-10-06; from these 20 readings 06.6
    assert means.mean() - (180 * 3600 + 600) == pytest.approx(6.6, abs=0.05)
    assert np.sqrt(weights @ weights) == pytest.approx(schuler_standard_error(20, 1.0), rel=1e-12)
    fit = fit_damped_swing(u - u[0], k, np.where(k % 2 == 0, -1.0, 1.0))
    # diagnosis.md: exponential damping, rms 119.7", N = +3.5 (29)
    assert fit.residual_rms == pytest.approx(119.7, abs=0.05)
    assert fit.north + u[0] - (180 * 3600 + 600) == pytest.approx(3.5, abs=0.05)
    assert fit.variance is not None
    assert math.sqrt(fit.variance * fit.cofactor[0, 0]) == pytest.approx(29.0, abs=0.5)


def test_schuler_means_wander_by_the_printed_minute_of_arc() -> None:
    # p. 273: "a range of nearly one minute of arc occurs in the Schuler means"
    means, _ = schuler_means(seconds(JOHANNESBURG), np.arange(20.0))
    assert float(np.ptp(means)) == pytest.approx(60.0, abs=3.0)


def test_gi_b1_equilibria_and_zeros_as_printed() -> None:
    u = seconds("112-23-58 107-57-34 112-23-50 107-57-43 112-23-55 107-57-47")
    means, _ = schuler_means(u, np.arange(6.0))
    assert (means - (110 * 3600 + 600)).tolist() == [44.0, 44.25, 47.75, 50.0]
    zeros, _ = schuler_means(np.array([11.4, -7.4, 10.9, -7.1, 10.4, -6.8]), np.arange(6.0))
    assert zeros.tolist() == pytest.approx([1.875, 1.825, 1.775, 1.725])


def test_fit_equals_lmfit() -> None:
    import lmfit

    rng = np.random.default_rng(5)
    k = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 7.0, 8.0, 9.0, 11.0])
    sides = np.where(k % 2 == 0, 1.0, -1.0)
    values = 12.0 + 3600.0 * sides * np.exp(-0.013 * k) + rng.normal(0.0, 4.0, k.size)
    own = fit_damped_swing(values, k, sides)
    model = lmfit.Model(lambda k, n, a, c: n + a * sides * np.exp(-c * k), independent_vars=["k"])
    peer = model.fit(values, k=k, n=0.0, a=3000.0, c=0.01)
    assert own.north == pytest.approx(peer.params["n"].value, abs=1e-4)
    assert own.log_decrement == pytest.approx(peer.params["c"].value, abs=1e-7)
    assert own.variance is not None
    sigma = math.sqrt(own.variance * own.cofactor[0, 0])
    assert sigma == pytest.approx(peer.params["n"].stderr, rel=1e-3)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(
    north=st.floats(-100.0, 100.0),
    amplitude=st.floats(500.0, 20000.0),
    decrement=st.floats(0.0, 0.1),
    count=st.integers(4, 45),
    first=st.sampled_from([-1.0, 1.0]),
)
def test_exact_swing_is_recovered(
    north: float, amplitude: float, decrement: float, count: int, *, first: float
) -> None:
    k = np.arange(float(count))
    sides = first * np.where(k % 2 == 0, 1.0, -1.0)
    fit = fit_damped_swing(north + amplitude * sides * np.exp(-decrement * k), k, sides)
    assert fit.converged
    assert fit.north == pytest.approx(north, abs=1e-6 * amplitude)
    assert fit.log_decrement == pytest.approx(decrement, abs=1e-8)


def test_design_equals_central_differences() -> None:
    k, sides = np.arange(7.0), np.array([1.0, -1, 1, -1, 1, -1, 1])
    point = np.array([3.0, 1000.0, 0.02])

    def model(p: np.ndarray) -> np.ndarray:
        return np.asarray(p[0] + p[1] * sides * np.exp(-p[2] * k))

    analytic = design(k, sides, amplitude=1000.0, log_decrement=0.02)
    for i, step in enumerate((1e-3, 1e-2, 1e-7)):
        shift = np.zeros(3)
        shift[i] = step
        numeric = (model(point + shift) - model(point - shift)) / (2 * step)
        assert analytic[:, i] == pytest.approx(numeric, rel=1e-6, abs=1e-6)


def test_schuler_standard_error_of_the_sheet() -> None:
    # physics.md 2.1: .559 .500 .451 .412 .382 for 4..8 points, .612 for 3
    for points, printed in zip(
        range(3, 9), (0.612, 0.559, 0.500, 0.451, 0.412, 0.382), strict=True
    ):
        assert schuler_standard_error(points, 1.0) == pytest.approx(printed, abs=6e-4)


def test_a_missed_point_breaks_the_schuler_chain_but_not_the_fit() -> None:
    k = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 6.0])
    sides = np.where(k % 2 == 0, 1.0, -1.0)
    values = 10.0 + 100.0 * sides * 0.99**k
    means, weights = schuler_means(values, k)
    assert means.size == 2
    assert weights.sum() == pytest.approx(1.0)
    assert fit_damped_swing(values, k, sides).north == pytest.approx(10.0, abs=1e-7)


def test_unwrap_crosses_the_zero_of_the_circle() -> None:
    readings = np.radians([359.5, 0.7, 359.6, 0.6])
    assert np.degrees(unwrap(readings)).tolist() == pytest.approx([0.0, 1.2, 0.1, 1.1])


def test_one_sided_points_are_refused() -> None:
    with pytest.raises(ValueError, match="both sides"):
        fit_damped_swing(np.ones(4), np.arange(4.0), np.ones(4))
