"""Later visits outside of the temperatures and the days of the determinations."""

from __future__ import annotations

import numpy as np
import pytest

from surveyapp.core.prediction.average import Determinations, predict
from surveyapp.core.prediction.unseen import unseen
from surveyapp.domain.priors import AMPLITUDES, DEFAULT_PRIORS


def test_beyond_the_range_counts_what_the_determinations_leave_open_of_a_coefficient() -> None:
    """Against the closed form of one coefficient beside a mean, and its limits."""
    theta = np.array([10.0, 12.0, 14.0, 16.0, 30.0])
    y, d = np.array([0.3, -0.2, 0.1, -0.2]), np.ones(4)
    targets = np.eye(5)[4:]
    [part] = unseen({"temperature_c": theta}, y, d, targets, priors=DEFAULT_PRIORS)
    x = (theta[:4] - 13.0) / 8.0
    size = float(np.dot(DEFAULT_PRIORS.sizes, np.square(AMPLITUDES)))
    # ridge regression: inverse of the normal equations with the prior's precision
    spread = 1.0 / (x @ x + 1.0 / size)
    expected = (spread + (spread * (x @ (y - y.mean()))) ** 2) * ((30.0 - 16.0) / 8.0) ** 2
    assert part.covariance[0, 0] == pytest.approx(expected)
    assert part.causes == {"temperature", "curve"}
    # a wide range leaves nothing open, one temperature everything
    wide = unseen({"temperature_c": theta * 100.0}, y, d, targets, priors=DEFAULT_PRIORS)
    assert wide[0].covariance[0, 0] < 0.2 * 175.0**2
    one = np.array([10.0, 10.0, 10.0, 10.0, 18.0])
    [none] = unseen({"temperature_c": one}, y, d, targets, priors=DEFAULT_PRIORS)
    assert none.covariance[0, 0] == pytest.approx(size, rel=2e-3)
    assert not unseen({"temperature_c": theta}, y, d, np.eye(5)[:1], priors=DEFAULT_PRIORS)


def test_determinations_of_a_day_do_not_know_the_season() -> None:
    """The interval grows with the gap to them, and for many of them no less than for few."""
    halves = {}
    for n in (8, 20):
        days = np.concatenate([np.linspace(0.0, 0.3, n), [1.0, 30.0, 120.0]])
        columns = {"elapsed_days": days, "block": np.concatenate([np.zeros(n), [1.0, 2.0, 3.0]])}
        y = 5.0 * np.random.default_rng(n).standard_normal(n)
        targets = np.eye(n + 3)[n:]
        data = Determinations(y, np.full(n, 5.0), columns, targets, np.zeros((n, 0)))
        found = predict(data, DEFAULT_PRIORS)
        halves[n] = [found.half_width(t) for t in range(3)]
        assert halves[n][0] < halves[n][1] < halves[n][2]
    # what a month may bring is in no determination: their number does not narrow it
    assert halves[20][2] > 0.7 * halves[8][2]


@pytest.mark.parametrize(("kelvins", "share"), [(0.5, 0.0274), (3.0, 0.632), (8.0, 0.999)])
def test_the_edge_of_a_range_is_known_to_three_kelvins(kelvins: float, share: float) -> None:
    """What lies just outside may be inside: 1 - exp(-(a / 3 K)^2) of the distance counts."""
    y, d, targets = np.array([0.3, -0.2, 0.1, -0.2]), np.ones(4), np.eye(5)[4:]
    theta = np.array([10.0, 12.0, 14.0, 16.0])
    parts = [
        unseen({"temperature_c": np.append(theta, t)}, y, d, targets, priors=DEFAULT_PRIORS)[0]
        for t in (16.0 + kelvins, 36.0)
    ]
    near, far = (float(np.sqrt(part.covariance[0, 0])) for part in parts)
    assert near / far == pytest.approx(share * kelvins / 20.0, rel=0.01)
