"""Effects of points, prisms and temperature in a traverse; repeated pointings count once."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from bench._traverses import Undeclared, simulated
from surveyapp.core.network.model import compile_network
from surveyapp.core.network.observation_equations import linearised
from surveyapp.core.network.solving import solve_network
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.diagnosis.subjects.traverse import traverse
from surveyapp.diagnosis.subjects.traverse_columns import observation_columns
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network, Status

K = ObservationKind
SIDES = np.array([110.0, 40, 150, 60, 25, 130, 80, 170, 35, 90, 145, 55, 120, 75])


def clean(seed: int = 1, *, gyro_every: int = 1) -> Network:
    rng = np.random.default_rng(seed)
    return simulated(rng, Undeclared(), SIDES, gyro_every=gyro_every, overlaps=True)


def changed(network: Network, change: dict[int, Observation]) -> Network:
    rows = tuple(change.get(i, obs) for i, obs in enumerate(network.observations))
    return dataclasses.replace(network, observations=rows)


def names(result: Diagnosis) -> set[str]:
    named = {item.effect for item in result.adopted}
    return named | {i for item in result.ambiguous for i in item.any_of}


def test_shifts_of_points_are_the_derivatives_of_the_observations() -> None:
    """Against differences of the observation equations, every point moved by a millimetre."""
    network = clean()
    model = compile_network(network)
    values = solve_network(network, model).values
    columns = observation_columns(network, model, values).columns
    rows = [i for i, o in enumerate(model.observations) if o.kind in (K.ANGLE, K.DISTANCE, K.GYRO)]
    for number in range(1, len(network.points) + 1):
        for offset, axis in ((0, "east"), (1, "north")):
            parts = []
            for step in (-1e-3, 1e-3):
                moved = values.copy()
                moved[3 * (number - 1) + offset] += step
                parts.append(linearised(model, moved)[0])
            numeric = (parts[1] - parts[0]) / 2e-3
            own = sum(
                np.where(columns[role] == number, columns[f"by_{role}_{axis}"], 0.0)
                for role in ("station", "target", "backsight")
            )
            assert np.asarray(own)[rows] == pytest.approx(numeric[rows], abs=1e-6)


def test_a_fixed_point_that_moved_is_found() -> None:
    network = clean()
    points = [
        dataclasses.replace(p, e=p.e + 0.08, n=p.n - 0.05) if i == 1 and p.e and p.n else p
        for i, p in enumerate(network.points)
    ]
    result = diagnose(traverse(dataclasses.replace(network, points=tuple(points))), draws=1000)
    assert "fixed_point" in names(result)
    verdicts = {c.effect: c.verdict for c in result.candidates}
    assert verdicts["fixed_point"] in ("adopted", "not_separable")


def test_a_station_beside_its_mark_is_found() -> None:
    network = clean(3)
    at = network.observations[30].at
    model = compile_network(network)
    values = solve_network(network, model).values
    columns = observation_columns(network, model, values).columns
    shift = 0.03 * columns["by_station_east"] + 0.02 * columns["by_station_north"]
    change = {
        i: dataclasses.replace(obs, value=obs.value + float(shift[i]))
        for i, obs in enumerate(network.observations)
        if obs.at == at
    }
    result = diagnose(traverse(changed(network, change)), draws=1000)
    assert "station_centring" in names(result)
    named = next((a for a in result.adopted if a.effect == "station_centring"), None)
    if named is not None:
        found = {c.name: (c.value, c.sigma or 0.0) for c in named.coefficients}
        for name, truth in (("east", 30.0), ("north", 20.0)):
            assert abs(found[name][0] - truth) < 4.0 * found[name][1]


def noted(network: Network, rng: np.random.Generator, *, rate: float, prism: float) -> Network:
    """Every distance with its temperature and prism, and what they do to it [1/K, m]."""
    change = {}
    for i, obs in enumerate(network.observations):
        if obs.kind is not K.DISTANCE:
            continue
        theta, second = float(rng.uniform(5.0, 30.0)), bool(rng.random() < 0.3)
        value = obs.value * (1.0 + rate * (theta - 17.0)) + prism * second
        note = f"temp={theta:.1f} prism={'B' if second else 'A'}"
        change[i] = dataclasses.replace(obs, value=value, note=note)
    return changed(network, change)


def test_another_constant_of_one_prism_is_named() -> None:
    network = noted(clean(5), np.random.default_rng(5), rate=0.0, prism=0.0174)
    result = diagnose(traverse(network), draws=1000)
    (item,) = result.adopted
    assert item.effect == "prism_constant"
    value = item.coefficients[0]
    assert abs(value.value - 17.4) < 4.0 * (value.sigma or 0.0)
    clean_result = diagnose(
        traverse(noted(clean(6), np.random.default_rng(6), rate=0.0, prism=0.0)), draws=1000
    )
    assert clean_result.adopted == ()


def test_temperature_times_length_is_tried_only_where_it_is_told() -> None:
    network = noted(clean(7), np.random.default_rng(7), rate=5e-6, prism=0.0)
    result = diagnose(traverse(network), draws=1000)
    verdicts = {c.effect: c.verdict for c in result.candidates}
    assert verdicts["distance_temperature"] != "not_applicable"
    silent = diagnose(traverse(clean(7)), draws=1000)
    verdicts = {c.effect: c.verdict for c in silent.candidates}
    assert verdicts["distance_temperature"] == "not_applicable"
    assert verdicts["prism_constant"] == "not_applicable"


def test_repeated_readings_of_one_pointing_count_once() -> None:
    network = clean(9)
    rows: list[Observation] = []
    for obs in network.observations:
        rows += [obs] * (4 if obs.kind is K.DISTANCE else 1)
    many = dataclasses.replace(network, observations=tuple(rows))
    one, four = traverse(network), traverse(many)
    assert one.size == four.size
    assert four.observations == pytest.approx(one.observations, abs=1e-6)
    assert "repeated_pointings" in {w.code for w in four.warnings}


def test_free_points_are_no_fixed_points() -> None:
    problem = traverse(clean())
    fixed = {i for i, p in enumerate(clean().points, start=1) if p.status_e is Status.FIXED}
    marked = problem.columns["station"][problem.columns["station_fixed"] > 0.0]
    assert {int(v) for v in marked} <= fixed


def test_errors_of_an_instrument_are_not_in_what_another_one_observed() -> None:
    network = clean()
    angles = [i for i, obs in enumerate(network.observations) if obs.kind is K.ANGLE]
    lengths = [i for i, obs in enumerate(network.observations) if obs.kind is K.DISTANCE]
    other = {angles[2], lengths[0], lengths[5]}
    noted = {i: dataclasses.replace(network.observations[i], note="instrument=B") for i in other}
    told = traverse(changed(network, noted)).columns
    plain = traverse(network).columns
    for i in (*angles, *lengths):
        name = "sights_turned" if i in angles else "distance_m"
        assert told[name][i] == pytest.approx(0.0 if i in other else plain[name][i], rel=1e-9)
    # where one instrument is named throughout, nothing changes
    every = {
        i: dataclasses.replace(obs, note="instrument=A")
        for i, obs in enumerate(network.observations)
    }
    same = traverse(changed(network, every)).columns
    assert same["distance_m"] == pytest.approx(plain["distance_m"], rel=1e-12)
