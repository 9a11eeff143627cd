"""From readings to a name: a shifted gyro, diagnosed by the engine after the breakthrough."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.network import adjust
from surveyapp.core.penetration.evaluation import evaluate_miss
from surveyapp.core.penetration.explaining import (
    HeadingResiduals,
    NamedEffect,
    explain,
    movement,
    shifted_sides,
)
from surveyapp.core.penetration.mine import Mine, assemble
from surveyapp.core.penetration.rows import Row, RowKind
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.subjects.traverse import traverse
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.penetration import MeasuredMiss
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, Status
from surveyapp_models.angles import ARCSEC
from tests.penetration.mines import straight

K = ObservationKind
SIDES, OBSERVED = 20, (0, 5, 10, 14, 19)
OWN, SHARED, ANGLE, LENGTH = 15.0, 8.0, 7.0, 0.002
SHIFT, FIRST = 240.0, 10


def observed(gyros: str, *, shift: float, seed: int) -> Network:
    """A straight drive north; every gyro side from both ends; G is turned from side 10 on."""
    rng = np.random.default_rng(seed)
    names = [f"P{i}" for i in range(SIDES + 1)]
    free, fixed = Status.FREE, Status.FIXED
    points = [NetworkPoint("P0", 0.0, 0.0, status_e=fixed, status_n=fixed)]
    points += [NetworkPoint(name, status_e=free, status_n=free) for name in names[1:]]
    rows = []
    for i in range(1, SIDES):
        value = math.pi + ANGLE * ARCSEC * rng.normal()
        ends, sigma = (names[i], names[i + 1]), ANGLE * ARCSEC
        rows.append(Observation(K.ANGLE, *ends, value, sigma, back=names[i - 1]))
    for a, b in itertools.pairwise(names):
        rows.append(Observation(K.DISTANCE, a, b, 100.0 + LENGTH * rng.normal(), LENGTH))
    constants = {name: SHARED * ARCSEC * rng.normal() for name in gyros}
    for name in gyros:
        for i in OBSERVED:
            for start, end, azimuth in ((i, i + 1, 0.0), (i + 1, i, math.pi)):
                wrong = shift if name == "G" and i >= FIRST else 0.0
                value = azimuth + (wrong + OWN * rng.normal()) * ARCSEC - constants[name]
                sigma = OWN * ARCSEC
                rows.append(
                    Observation(
                        K.GYRO, names[start], names[end], value % math.tau, sigma, constant=name
                    )
                )
    known = tuple(GyroConstant(name, 0.0, SHARED * ARCSEC) for name in gyros)
    return Network(tuple(points), tuple(rows), constants=known)


def mine_of(gyros: str) -> Mine:
    """The same drive as the prediction knows it."""
    base = straight(SIDES, (0,), own=OWN, shared=SHARED)
    heading = base.headings[0]
    rows = tuple(row for row in heading.rows if row.kind is not RowKind.GYRO)
    rows += tuple(
        Row(RowKind.GYRO, i, OWN * ARCSEC, 0.0, forward, name)
        for name in gyros
        for i in OBSERVED
        for forward in (True, False)
    )
    headings = (replace(heading, rows=rows),)
    return assemble(base.plan, headings, dict.fromkeys(gyros, SHARED * ARCSEC), None)


def told(gyros: str, *, shift: float, seed: int) -> tuple[str, float, tuple[NamedEffect, ...]]:
    """Verdict after the breakthrough, the miss, and what the residuals have named."""
    network, mine = observed(gyros, shift=shift, seed=seed), mine_of(gyros)
    lateral = adjust(network).point(f"P{SIDES}").e
    assert lateral is not None
    miss = MeasuredMiss(lateral_m=lateral)
    made = diagnose(traverse(network), draws=1000)
    gyro = [row for row in network.observations if row.kind is K.GYRO]
    named = tuple(
        NamedEffect(
            item.effect,
            item.coefficients[0].value,
            shifted_sides(item.effect, {g[0]: g[1] for g in item.grid}, gyro),
        )
        for item in made.adopted
    )
    test = evaluate_miss(mine, miss)
    found = explain(mine, miss, test, [HeadingResiduals(0, "main", str(made.verdict), named)])
    return found.verdict, lateral, named


def test_a_shift_is_explained_where_a_second_gyro_separates_it() -> None:
    verdict, lateral, named = told("GH", shift=SHIFT, seed=5)
    assert [item.effect for item in named] == ["gyro_constant_shift"]
    assert named[0].value == pytest.approx(SHIFT, abs=40.0)
    assert named[0].sides is not None
    assert named[0].sides[0] == (f"P{FIRST}", f"P{FIRST + 1}", "G")
    assert abs(lateral) > 0.1
    assert verdict == "explained"


def test_what_a_shift_moves_is_what_the_adjustment_moves() -> None:
    """The same noise with and without the shift: the miss grows by the predicted movement."""
    clean, wrong = (
        adjust(observed("GH", shift=shift, seed=8)).point(f"P{SIDES}").e for shift in (0.0, SHIFT)
    )
    gyro = [row for row in observed("GH", shift=0.0, seed=8).observations if row.kind is K.GYRO]
    first = 1.0 + 2.0 * OBSERVED.index(FIRST)
    sides = shifted_sides("gyro_constant_shift", {"first_side": first}, gyro)
    moved = movement(mine_of("GH"), 0, NamedEffect("gyro_constant_shift", SHIFT, sides))
    assert clean is not None
    assert wrong is not None
    assert moved[0] == pytest.approx(wrong - clean, rel=2e-3)


def test_with_one_gyro_the_shift_stays_not_separable() -> None:
    verdict, _, _ = told("G", shift=SHIFT, seed=5)
    assert verdict == "not_separable"
