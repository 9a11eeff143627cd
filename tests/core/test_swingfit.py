"""Passages of a clamped swing: the damped cosine passes the division there, in few steps."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveyapp.core.swing import swingfit
from surveyapp.core.swing.swingfit import ClampedSwing, passage_times
from surveyapp_models.arrays import Floats

PERIOD, DECREMENT, MIDDLE, AMPLITUDE, START = 388.3, 0.012, 0.7, 9.0, 1000.0


def swing(divisions: Floats) -> ClampedSwing:
    return ClampedSwing(
        readings=np.array([MIDDLE + AMPLITUDE]),
        index=np.array([0.0]),
        sides=np.array([1.0]),
        passages_s=np.zeros(divisions.size),
        divisions=divisions,
        after=np.arange(divisions.size, dtype=np.float64),
        sigma_div=0.05,
        sigma_s=0.2,
    )


@pytest.mark.parametrize("division", [0.0, 0.7, -4.0, 8.0])
def test_passages_lie_where_the_swing_is_in_a_handful_of_steps(
    monkeypatch: pytest.MonkeyPatch, division: float
) -> None:
    calls: list[int] = []
    unit = swingfit.shape

    def counted(tau: Floats, *, decrement: float, period: float) -> tuple[Floats, Floats]:
        calls.append(1)
        return unit(tau, decrement=decrement, period=period)

    monkeypatch.setattr(swingfit, "shape", counted)
    parameters = np.array([MIDDLE, AMPLITUDE, DECREMENT, START, PERIOD])
    times, _ = passage_times(swing(np.full(7, division)), parameters)
    # the same swing written out: x = B + A / cos(delta) exp(-k tau) cos(w tau - delta)
    w, k = 2.0 * math.pi / PERIOD, 2.0 * DECREMENT / PERIOD
    delta, tau = math.atan(k / w), times - START
    x = MIDDLE + AMPLITUDE / math.cos(delta) * np.exp(-k * tau) * np.cos(w * tau - delta)
    assert np.allclose(x, division, atol=1e-9)
    assert np.all((tau > np.arange(7) * PERIOD / 2) & (tau < np.arange(1, 8) * PERIOD / 2))
    assert len(calls) <= 12
