"""Closures, compass rule and field checks on traverses that can be checked by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from surveyapp.core.checks.traverse_checks import forward_back
from surveyapp.core.network import adjust
from surveyapp.core.network.bowditch import CompassInput, compass_adjust, compass_rule
from surveyapp.core.network.closures import network_closures
from surveyapp.core.network.fieldchecks import (
    carried_azimuths,
    closure_measures,
    ellipse_measures,
    gyro_measures,
    repeated_angles,
    repeated_traverse,
    side_measures,
)
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.subject import Subject
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, Status

K = ObservationKind
ARC = math.pi / 648000.0
DEG = math.pi / 180.0
FIXED = (Status.FIXED, Status.FIXED)


def point(name: str, e: float | None = None, n: float | None = None) -> NetworkPoint:
    return NetworkPoint(name, e, n, None, *(FIXED if e is not None else ()))


def square(angle_errors: tuple[float, ...], length_errors: tuple[float, ...]) -> Network:
    """A square of 100 m, stations clockwise A (0, 0), B north, C, D; interior angles on the right.

    Angles are clockwise from the previous to the next station: 270 degrees outside.
    """
    names = "ABCD"
    observations = []
    for i, name in enumerate(names):
        back, fore = names[i - 1], names[(i + 1) % 4]
        value = 270.0 * DEG + angle_errors[i]
        observations.append(Observation(K.ANGLE, name, fore, value, 5 * ARC, back=back))
        length = 100.0 + length_errors[i]
        observations.append(Observation(K.DISTANCE, name, fore, length, 0.002))
    points = (point("A", 0.0, 0.0), point("B", 0.0, 100.0), point("C"), point("D"))
    return Network(points, tuple(observations))


def test_a_perfect_square_closes() -> None:
    loops = network_closures(square((0, 0, 0, 0), (0, 0, 0, 0)))
    assert len(loops) == 1
    # both known points belong to the ground: the route runs B-C-D-A
    assert loops[0].linear_m == pytest.approx(0.0, abs=1e-9)
    assert loops[0].angular == pytest.approx(0.0, abs=1e-12)
    assert loops[0].angles == 4


def test_the_angular_misclosure_is_the_sum_of_the_errors() -> None:
    errors = (3 * ARC, -10 * ARC, 4 * ARC, -7 * ARC)
    closure = network_closures(square(errors, (0, 0, 0, 0)))[0]
    assert abs(closure.angular or 0.0) == pytest.approx(10 * ARC, rel=1e-6)
    assert closure.angular_sigma == pytest.approx(10 * ARC)
    assert closure.passed is True
    large = network_closures(square((80 * ARC, 0, 0, 0), (0, 0, 0, 0)))[0]
    assert large.passed is False


def test_the_linear_misclosure_is_formed_after_the_angular_one_is_distributed() -> None:
    equal = (30 * ARC,) * 4
    loop = replace(square(equal, (0, 0, 0, 0)), points=tuple(point(name) for name in "ABCD"))
    closure = network_closures(loop)[0]
    assert abs(closure.angular or 0.0) == pytest.approx(120 * ARC, rel=1e-6)
    assert closure.linear_m == pytest.approx(0.0, abs=1e-9)
    route = network_closures(square(equal, (0, 0, 0, 0)))[0]
    assert route.kind == "connecting"
    assert route.linear_m == pytest.approx(0.0, abs=1e-9)


def test_a_free_loop_closes_without_coordinates() -> None:
    network = square((0, 0, 0, 0), (0.03, 0, 0, 0.04))
    free = replace(network, points=tuple(point(name) for name in "ABCD"))
    closure = network_closures(free)[0]
    assert closure.kind == "loop"
    assert closure.linear_m == pytest.approx(0.05, abs=1e-9)
    assert closure.length_m == pytest.approx(400.07)
    values = closure.to_dict()
    assert values["relative_1_in"] == pytest.approx(400.07 / 0.05)


def test_height_loops_and_routes() -> None:
    points = tuple(
        NetworkPoint(n, None, None, h, Status.UNUSED, Status.UNUSED, s)
        for n, h, s in (
            ("A", 10.0, Status.FIXED),
            ("B", None, Status.FREE),
            ("C", 13.0, Status.FIXED),
            ("D", None, Status.FREE),
        )
    )
    observations = (
        Observation(K.HEIGHT_DIFFERENCE, "A", "B", 1.0, 0.001),
        Observation(K.HEIGHT_DIFFERENCE, "B", "C", 2.004, 0.001),
        Observation(K.HEIGHT_DIFFERENCE, "B", "D", 5.0, 0.001),
        Observation(K.HEIGHT_DIFFERENCE, "D", "C", -3.0, 0.001),
    )
    found = network_closures(Network(points, observations))
    values = sorted(abs(item.height_m or 0.0) for item in found)
    assert values == pytest.approx([0.0, 0.004], abs=1e-12) or values == pytest.approx(
        [0.004, 0.004], abs=1e-12
    )


def test_the_compass_rule_shares_by_length() -> None:
    result = compass_rule(
        CompassInput(
            ("A", "B", "C"),
            (100.0, 300.0),
            (math.pi,),  # straight on
            math.pi / 2.0,
            None,
            1,
            (0.0, 0.0),
            (400.04, 0.08),
        )
    )
    # misclosure -0.04, -0.08 over 400 m: a quarter of it at B
    assert result.misclosure_e == pytest.approx(-0.04, abs=1e-12)
    assert result.e == pytest.approx((0.0, 100.01, 400.04), abs=1e-9)
    assert result.n == pytest.approx((0.0, 0.02, 0.08), abs=1e-9)
    assert result.relative_1_in == pytest.approx(400.0 / math.hypot(0.04, 0.08))


def test_the_compass_rule_meets_the_fixed_points_and_stays_near_least_squares() -> None:
    network = square((3 * ARC, -4 * ARC, 2 * ARC, 5 * ARC), (0.004, -0.003, 0.002, 0.001))
    (result,) = compass_adjust(network)
    assert result.stations[0] in ("A", "B")
    assert result.stations[-1] in ("A", "B")
    assert result.angular == pytest.approx(6 * ARC, abs=1e-10) or result.angular == pytest.approx(
        -6 * ARC, abs=1e-10
    )
    ends = {"A": (0.0, 0.0), "B": (0.0, 100.0)}
    assert (result.e[-1], result.n[-1]) == pytest.approx(ends[result.stations[-1]], abs=1e-9)
    adjusted = adjust(network)
    for name, e, n in zip(result.stations, result.e, result.n, strict=True):
        other = adjusted.point(name)
        assert math.hypot(e - (other.e or 0.0), n - (other.n or 0.0)) < 0.006


def test_the_same_angle_measured_again() -> None:
    first = Observation(K.ANGLE, "P", "Q", 3.0, ARC, back="O")
    again = replace(first, value=3.0 + 17 * ARC)
    (measured,) = repeated_angles([first, again])
    assert measured.quantity == "last_angle_again"
    assert measured.value == pytest.approx(17.0)
    assert repeated_angles([first]) == []


def zigzag(turn: float, stretch: float) -> Network:
    names = [f"T{i}" for i in range(5)]
    observations = [
        Observation(K.DISTANCE, names[i], names[i + 1], 80.0 * stretch, 0.002) for i in range(4)
    ]
    observations += [
        Observation(
            K.ANGLE, names[i], names[i + 1], math.pi + (-1) ** i * 0.3 + turn, ARC, names[i - 1]
        )
        for i in range(1, 4)
    ]
    points = (point("T0", 0.0, 0.0), *(point(name) for name in names[1:]))
    return Network(points, tuple(observations))


def test_an_open_traverse_measured_twice() -> None:
    measured = repeated_traverse(zigzag(0.0, 1.0), zigzag(4 * ARC, 1.0001), class_name="15sec")
    found = {item.quantity: item for item in measured}
    assert found["angular_closure_repeated"].value == pytest.approx(12.0)
    assert found["angular_closure_repeated"].variables == {"n": 6.0}
    ratio = found["relative_closure_repeated"].value
    assert ratio is not None
    assert 8000 < ratio < 13000  # 1 in 10 000 along the line, less where it bends
    assert found["angular_closure_repeated"].class_name == "15sec"


def gyro_line(second: float) -> Network:
    """North 5 legs straight; gyro on the first and the last leg, a constant of 10 arcsec."""
    names = [f"G{i}" for i in range(6)]
    observations = [
        Observation(K.ANGLE, names[i], names[i + 1], math.pi, 7 * ARC, names[i - 1])
        for i in range(1, 5)
    ]
    observations += [Observation(K.DISTANCE, names[i], names[i + 1], 60.0, 0.002) for i in range(5)]
    for i, extra in ((0, 0.0), (4, second)):
        observations.append(
            Observation(
                K.GYRO,
                names[i],
                names[i + 1],
                (0.02 + extra - 10 * ARC) % (2 * math.pi),
                15 * ARC,
                constant="G",
                convergence=0.02,
            )
        )
    points = (point("G0", 0.0, 0.0), *(point(name) for name in names[1:]))
    constants = (GyroConstant("G", 10 * ARC, 6 * ARC),)
    return Network(points, tuple(observations), constants=constants)


def test_gyro_against_traverse() -> None:
    (item,) = carried_azimuths(gyro_line(33 * ARC))
    assert item.difference == pytest.approx(33 * ARC, abs=1e-10)
    assert item.angles == 4
    # both sides share the constant: sqrt(15^2 + 15^2 + 4 * 7^2), the constant has no part in it
    assert item.sigma / ARC == pytest.approx(math.sqrt(2 * 225 + 4 * 49))
    (measured,) = gyro_measures(gyro_line(33 * ARC), class_name="7sec")
    assert measured.quantity == "gyro_against_traverse"
    assert measured.value == pytest.approx(33.0)
    assert measured.variables == {"n": 4.0}


def test_closures_become_what_a_rule_book_limits() -> None:
    closures = network_closures(square((9 * ARC, 0, 0, 0), (0.01, 0, 0, 0)))
    found = {item.quantity: item for item in closure_measures(closures, class_name="7sec")}
    assert found["angular_closure_closed"].value == pytest.approx(9.0)
    assert found["angular_closure_closed"].variables["n"] == 4.0
    ratio = found["relative_closure_closed"].value
    assert ratio is not None
    assert ratio > 10_000


def test_rule_book_limits_apply_to_closures() -> None:
    from surveyapp.core.tolerance import rule_book_checks
    from surveyapp.domain.rulebook import Limit, RuleBook

    closures = network_closures(square((40 * ARC, 0, 0, 0), (0, 0, 0, 0)))
    limit = Limit(
        id="closed",
        quantity="angular_closure_closed",
        limit="14 * sqrt(n)",
        unit="arcsec",
        clause="-",
        source="-",
        confirmed=True,
        class_name="7sec",
    )
    book = RuleBook(id="book", title="", source="", limits=(limit,))
    checks = rule_book_checks(book, closure_measures(closures, class_name="7sec"))
    assert [check.passed for check in checks] == [False]
    assert checks[0].limit == pytest.approx(28.0)


def test_forward_and_back_and_lengths_of_sides() -> None:
    network = square((0, 0, 0, 0), (0, 0, 0, 0))
    back = Observation(K.DISTANCE, "B", "A", 100.02, 0.002)
    again = replace(network, observations=(*network.observations, back))
    (check,) = forward_back(again, Subject.of("traverse", "main"))
    assert check.value == pytest.approx(20.0)
    assert check.limit == pytest.approx(3 * math.hypot(2.0, 2.0))
    assert check.passed is False
    short, long = side_measures(network)
    assert short.value == pytest.approx(100.0)
    assert long.value == pytest.approx(100.0)


def test_relative_ellipses_are_measured_for_the_rule_book() -> None:
    result = adjust(square((0, 0, 0, 0), (0, 0, 0, 0)))
    measures = ellipse_measures(result)
    assert {item.where for item in measures} == {"B-C", "C-D", "A-D"}
    assert all(item.variables["L"] == pytest.approx(0.1) for item in measures)
