"""Gyros and accelerometers of another arrangement, from turns made with Rodrigues' formula."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from surveyapp.core.sensors.rate.hand_held import Turn
from surveyapp.core.sensors.rate.turn_axes import axes_problems
from surveyapp_models.arrays import Floats

Change = Callable[[Floats, Floats], tuple[Floats, Floats]]


def turns(change: Change) -> list[Turn]:
    """Eight turns about any axis, each of one rate, of rates and directions of up so changed."""
    rng = np.random.default_rng(4)
    found = []
    for _ in range(8):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        angle, up = rng.uniform(1.2, 2.0), rng.normal(size=3)
        up /= np.linalg.norm(up)
        # the body turned by angle about axis: in it, up turned back
        x, y, z = axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        back = np.eye(3) - math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
        rates = np.tile(axis * angle / 2.0, (200, 1))
        rates, ups = change(rates, np.array([up, back @ up]))
        found.append(Turn(rates, ups[0], ups[1], 0.01))
    return found


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda w, u: (w * [-1.0, 1.0, 1.0], u), "gyr (-x, y, z)"),
        (lambda w, u: (w[:, [1, 0, 2]], u), "gyr (y, x, z)"),
        (lambda w, u: (w, u[:, [1, 0, 2]]), "acc (y, x, z)"),
        (lambda w, u: (w, u[:, [2, 0, 1]]), "gyr (z, x, y)"),
    ],
)
def test_the_arrangement_that_carries_gravity_is_told(change: Change, expected: str) -> None:
    (problem,) = axes_problems(turns(change), "log.csv")
    assert expected in problem.expected


@pytest.mark.parametrize(("unit", "factor"), [("deg/s", 1.0), ("deg/h", 3600.0)])
def test_another_unit_is_told(unit: str, factor: float) -> None:
    (problem,) = axes_problems(turns(lambda w, u: (np.degrees(w) * factor, u)), "log.csv")
    assert unit in problem.found


def test_what_a_calibration_is_for_is_let_through() -> None:
    """Scale factors 3 % off and axes crossed by a degree."""
    matrix = np.array([[1.03, 0.017, 0.0], [-0.017, 0.97, 0.0], [0.0, 0.017, 1.0]])
    assert axes_problems(turns(lambda w, u: (w @ matrix.T, u)), "log.csv") == []
