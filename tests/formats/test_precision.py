"""Sigmas of a field file: faces and sets pooled, by a two-way table and against the truth."""

from __future__ import annotations

import math
import random

import pytest

from surveyapp.core.fieldfile.precision import (
    circle_precision,
    distance_precision,
    face_precision,
    zenith_precision,
)
from surveyapp.core.fieldfile.reduction import reduce_file
from surveyapp.domain.fieldfile import Face, FieldFile, Pointing, ReducedSet

READING = 1e-5
LENGTH_M = 1e-3
INDEX = 3e-5


def simulated(seed: int, setups: int, rounds: int, targets: int) -> tuple[ReducedSet, ...]:
    """Readings of one face with sigma READING [rad] and LENGTH_M, the circle turned each round."""
    draw = random.Random(seed)
    pointings: list[Pointing] = []
    for setup in range(setups):
        rays = [1.5 * j for j in range(targets)]
        for k in range(rounds):
            turn = 0.1 + 0.7 * k
            faces: tuple[Face, Face] = ("L", "R")
            for face in faces:
                for j, ray in enumerate(rays):
                    side = 0.0 if face == "L" else math.pi
                    hz = (ray + turn + side + draw.gauss(0.0, READING)) % (2.0 * math.pi)
                    sd = 100.0 + j + draw.gauss(0.0, LENGTH_M)
                    v = (1.5 if face == "L" else 2.0 * math.pi - 1.5) + INDEX
                    v += draw.gauss(0.0, READING)
                    name = f"S{setup}"
                    pointings.append(
                        Pointing(
                            len(pointings) + 1,
                            name,
                            f"T{j}",
                            str(setup),
                            face,
                            hz,
                            v,
                            sd,
                            None,
                            1.5,
                            1.6,
                        )
                    )
    return reduce_file(FieldFile("gsi", "", tuple(pointings)))[0]


def test_degrees_of_freedom_of_faces_and_sets() -> None:
    """Of s set-ups, r rounds, t targets, from faces and between sets.

    Directions s r (t - 1) and s (r - 1) (t - 1), zenith angles s r (t - 1) and s (r - 1) t,
    distances s r t and s (r - 1) t.
    """
    sets = simulated(1, setups=4, rounds=3, targets=2)
    directions, distances = face_precision(sets), distance_precision(sets)
    assert directions is not None
    assert distances is not None
    assert directions.dof == 4 * 3 * 1 + 4 * 2 * 1
    assert distances[1] == 4 * 3 * 2 + 4 * 2 * 2
    zeniths = zenith_precision(sets)
    assert zeniths is not None
    assert zeniths[1] == 4 * 3 * 1 + 4 * 2 * 2


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_the_pool_is_the_sigma_of_a_mean_of_two_faces(seed: int) -> None:
    """Within the 99.9 % bounds of chi-square; a mean of both faces has sigma / root 2."""
    sets = simulated(seed, setups=200, rounds=3, targets=3)
    directions, distances = face_precision(sets), distance_precision(sets)
    zeniths = zenith_precision(sets)
    assert directions is not None
    assert distances is not None
    assert zeniths is not None
    for found, dof, true in (
        (directions.direction, directions.dof, READING),
        (distances[0], distances[1], LENGTH_M),
        (zeniths[0], zeniths[1], READING),
    ):
        assert abs((found * math.sqrt(2.0) / true) ** 2 - 1.0) < 3.3 * math.sqrt(2.0 / dof)


def test_a_small_traverse_pools_both_circles() -> None:
    """Four set-ups of one round: 4 degrees of freedom each are too few, 8 together are enough."""
    squares = []
    for seed in range(40):
        sets = simulated(100 + seed, setups=4, rounds=1, targets=2)
        assert face_precision(sets) is None
        assert zenith_precision(sets) is None
        both = circle_precision(sets)
        assert both is not None
        assert both.dof == 8
        squares.append((both.direction * math.sqrt(2.0) / READING) ** 2)
    # chi-square with 320 degrees of freedom, 99.9 %
    assert abs(sum(squares) / len(squares) - 1.0) < 3.3 * math.sqrt(2.0 / 320)
