"""Networks that cannot be adjusted are refused by name; gross errors are found and named."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from surveyapp.core.network import adjust
from surveyapp.core.network.snooping import data_snooping
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network, NetworkPoint, Status
from surveyapp.errors import SurveyError
from tests.network.network_factory import ARC, make

K = ObservationKind


def test_an_unconnected_network_is_named_so() -> None:
    one, _ = make(1, ("direction", "distance"))
    two, _ = make(2, ("direction", "distance"), datum="free")
    names = {point.name: f"X{point.name}" for point in two.points}
    island = tuple(
        replace(p, name=names[p.name], status_e=Status.FREE, status_n=Status.FREE)
        for p in two.points
    )
    moved = tuple(replace(o, at=names[o.at], to=names[o.to]) for o in two.observations)
    both = Network(one.points + island, one.observations + moved)
    with pytest.raises(SurveyError) as refused:
        adjust(both)
    text = str(refused.value)
    assert "not connected" in text
    assert "point XP0" in text
    assert "point P1" not in text.replace("XP1", "")


def test_no_datum_is_said() -> None:
    network, _ = make(3, ("direction", "distance"))
    free = tuple(replace(p, status_e=Status.FREE, status_n=Status.FREE) for p in network.points)
    with pytest.raises(SurveyError, match="no datum"):
        adjust(replace(network, points=free))


def test_one_fixed_point_without_azimuth_is_an_incomplete_datum() -> None:
    network, _ = make(3, ("direction", "distance"))
    points = (
        network.points[0],
        *(replace(p, status_e=Status.FREE, status_n=Status.FREE) for p in network.points[1:]),
    )
    with pytest.raises(SurveyError, match="not determined"):
        adjust(replace(network, points=points))


def test_a_point_on_a_single_distance_is_named() -> None:
    network, _ = make(4, ("direction", "distance"))
    hanging = NetworkPoint("HANG", 1500.0, 2500.0)
    extra = Observation(K.DISTANCE, "P1", "HANG", 600.0, 0.003)
    with pytest.raises(SurveyError) as refused:
        adjust(
            replace(
                network,
                points=(*network.points, hanging),
                observations=(*network.observations, extra),
            )
        )
    assert "HANG" in str(refused.value)
    assert "point P1" not in str(refused.value)


def test_a_large_network_names_its_hanging_point_too() -> None:
    network, _ = make(4, ("direction", "distance"), points=120)
    hanging = NetworkPoint("HANG", 1500.0, 2500.0)
    extra = Observation(K.DISTANCE, "P1", "HANG", 600.0, 0.003)
    with pytest.raises(SurveyError) as refused:
        adjust(
            replace(
                network,
                points=(*network.points, hanging),
                observations=(*network.observations, extra),
            )
        )
    assert "HANG" in str(refused.value)
    assert "point P1:" not in str(refused.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"to": "A"}, "itself"),
        ({"value": 0.0}, "no length"),
        ({"value": -3.0}, "no length"),
        ({"value": math.nan}, "no number"),
        ({"sigma": 0.0}, "not positive"),
        ({"kind": K.ANGLE, "back": "B"}, "same"),
        ({"kind": K.ANGLE}, "back sight"),
        ({"to": ""}, "target"),
    ],
)
def test_impossible_observations_refuse_themselves(change: dict[str, object], words: str) -> None:
    good = Observation(K.DISTANCE, "A", "B", 10.0, 0.001)
    with pytest.raises(SurveyError) as refused:
        replace(good, **change)  # type: ignore[arg-type]
    assert words in str(refused.value)


def test_two_points_of_one_name_are_refused() -> None:
    network, _ = make(3, ("distance",))
    with pytest.raises(SurveyError, match="one name"):
        replace(network, points=(*network.points, network.points[0]))


def test_observations_that_contradict_the_geometry_do_not_converge_silently() -> None:
    points = (
        NetworkPoint("A", 0.0, 0.0, None, Status.FIXED, Status.FIXED),
        NetworkPoint("B", 1000.0, 0.0, None, Status.FIXED, Status.FIXED),
        NetworkPoint("C", 500.0, 0.01, None),
    )
    observations = (
        Observation(K.DISTANCE, "A", "C", 400.0, 0.001),
        Observation(K.DISTANCE, "B", "C", 400.0, 0.001),
    )
    with pytest.raises(SurveyError) as refused:  # two circles that do not meet
        adjust(Network(points, observations))
    assert "point C" in str(refused.value)
    assert "does not converge" in str(refused.value)


def test_what_does_not_settle_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("surveyapp.core.network.gaussnewton.MOST_ITERATIONS", 1)
    network, _ = make(3, ("direction", "distance"))
    far = tuple(
        p if p.status_e is Status.FIXED else replace(p, e=(p.e or 0) + 30.0, n=(p.n or 0) - 20.0)
        for p in network.points
    )
    with pytest.raises(SurveyError, match="does not converge"):
        adjust(replace(network, points=far))


def test_ten_percent_of_gross_errors_are_found_and_named() -> None:
    found = wrong = planted = 0
    for seed in range(6):
        network, truth = make(seed + 50, ("direction", "distance"), points=16)
        rng = np.random.default_rng(seed)
        count = len(network.observations)
        bad = set(rng.choice(count, size=count // 10, replace=False).tolist())
        observations = list(network.observations)
        for i in bad:
            obs = observations[i]
            size = 60 * obs.sigma * rng.uniform(1.0, 4.0) * rng.choice((-1, 1))
            observations[i] = replace(obs, value=obs.value + float(size))
        result = data_snooping(replace(network, observations=tuple(observations)))
        named = {item.place for item in result.removed}
        found += len(named & bad)
        wrong += len(named - bad)
        planted += len(bad)
        good = result.adjustment
        assert good.global_test.ratio is not None
        assert good.global_test.ratio < 1.3
        for point in good.points:
            assert point.e == pytest.approx(truth[point.name][0], abs=0.03)
    assert found >= 0.97 * planted
    assert wrong <= 0.03 * planted


@pytest.mark.statistical
def test_the_family_level_is_kept() -> None:
    accused = 0
    for seed in range(120):
        network, _ = make(seed + 1000, ("angle", "distance"), points=6)
        accused += bool(adjust(network, relative=False).snooping.suspects)
    # at most 5 % by Bonferroni: binomial(120, 0.05) stays below 15 with 99.9 %; bench repetitions
    # draws 2000
    assert accused < 15


def test_a_planted_error_of_the_detectable_size_is_detected_as_often_as_stated() -> None:
    from surveyapp.core.network.quality import noncentrality

    assert noncentrality() == pytest.approx(4.13, abs=0.005)
    network, _ = make(77, ("direction", "distance"), points=9, noise=False)
    quiet = adjust(network)
    target = next(o for o in quiet.observations if o.kind is K.DISTANCE and o.redundancy > 0.3)
    rng = np.random.default_rng(3)
    detected = 0
    for _ in range(100):
        observations = tuple(
            replace(
                o,
                value=o.value
                + rng.normal(0.0, o.sigma)
                + (target.mdb or 0.0) * (i == target.place),
            )
            for i, o in enumerate(network.observations)
        )
        result = adjust(replace(network, observations=observations), relative=False)
        w = result.observations[target.place].standardized or 0.0
        detected += abs(w) > 3.2905  # 0.1 %
    # binomial(100, 0.8): 99.9 % within 65 .. 92
    assert 65 <= detected <= 92


def test_a_wrong_unit_shows_as_gross() -> None:
    network, _ = make(12, ("direction", "distance"), points=9)
    i = next(k for k, o in enumerate(network.observations) if o.kind is K.DISTANCE)
    wrong = list(network.observations)
    wrong[i] = replace(wrong[i], value=wrong[i].value * 3.28084)
    result = adjust(replace(network, observations=tuple(wrong)))
    assert result.global_test.passed is False
    assert result.snooping.suspects[0].place == i
    assert result.snooping.suspects[0].estimated_error == pytest.approx(
        wrong[i].value - network.observations[i].value, rel=0.01
    )
    kept = adjust(replace(network, observations=tuple(wrong), tolerance_m=1.0))
    assert kept.global_test.passed is not False
    assert any(warning.code == "gross_errors_left_out" for warning in kept.warnings)


def test_angles_are_compared_around_the_full_circle() -> None:
    network, _ = make(31, ("direction", "distance"))
    turned = tuple(
        replace(o, value=o.value + 2.0 * math.pi) if o.kind is K.DIRECTION else o
        for o in network.observations
    )
    a, b = adjust(network), adjust(replace(network, observations=turned))
    assert a.points[3].e == pytest.approx(b.points[3].e, abs=1e-9)
    assert max(abs(o.residual) for o in b.observations if o.angular) < 100 * ARC
