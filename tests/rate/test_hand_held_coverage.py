"""Hand-held stops: the stated intervals hold their share (the campaign is bench rate_coverage)."""

from __future__ import annotations

import numpy as np
import pytest

from bench.rate import as_read
from bench.rate_coverage import (
    coverage_of,
    fog_station,
    headings,
    multi_position,
    six_position,
    temperature,
    temperature_alone,
)
from bench.rate_rank import counts
from surveyapp.core.sensors.rate.hand_forces import LEVELS, fit_forces
from surveyapp.core.sensors.rate.multi_position_log import held_stops
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp_models.arrays import Floats


@pytest.mark.statistical
def test_intervals_of_hand_held_stops_hold_the_truth() -> None:
    """Eight records of 21 parameters: 1.96 sigma, few degrees of freedom counted in.

    The parameters of a record are correlated: a pooled share of .86 lies three of its standard
    deviations below .95.
    """
    found = coverage_of(multi_position, 8, seed=3)
    assert len(found) == 21
    assert float(np.mean([share for share, _ in found.values()])) >= 0.86


@pytest.mark.statistical
def test_intervals_of_the_gyro_on_a_total_station_hold_the_truth() -> None:
    """Twenty records of three parameters: 14 and fewer of 20 have p = 3e-4."""
    found = coverage_of(fog_station, 20, seed=3)
    assert set(found) == {"elevation", "instrument_constant", "scale_factor"}
    assert min(share for share, _ in found.values()) >= 0.75


@pytest.mark.statistical
def test_headings_by_indexing_are_covered_and_no_wrong_root_is_silent() -> None:
    """Sixty runs over five latitudes, three attitudes and two programmes: 50 and fewer p = .001."""
    inside, wrong, told = headings(60, seed=3)
    assert wrong == 0
    assert told <= 6
    assert inside >= 51


@pytest.mark.statistical
def test_intervals_of_table_programmes_hold_the_truth() -> None:
    """Twenty-four records: the table's rate, flips, the static method; nodes and what lies between.

    Of 24 at .95 fewer than 17 have p < 1e-6 a parameter; the pooled share of 18 parameters below
    .88 has p < .001 even where half of them move together.
    """
    found = coverage_of(six_position, 24, seed=3)
    assert len(found) == 18
    assert min(share for share, _ in found.values()) >= 0.70
    assert 0.88 <= float(np.mean([share for share, _ in found.values()])) <= 0.995
    nodes = coverage_of(temperature, 8, seed=3)
    pooled = [share for name, (share, _) in nodes.items() if name.endswith("node")]
    assert len(pooled) == 24
    assert float(np.mean(pooled)) >= 0.86
    between = [share for name, (share, _) in nodes.items() if name.endswith("between")]
    assert float(np.mean(between)) >= 0.86
    alone = coverage_of(temperature_alone, 6, seed=3)
    assert {name.split(",")[0][-1] for name in alone} == {"x", "y", "z"}
    assert float(np.mean([share for share, _ in alone.values()])) >= 0.70


@pytest.mark.parametrize("tilt", [0.05, 0.14, 0.6, 1.2])
@pytest.mark.parametrize("bias", [-0.5, 0.03, 0.5])
def test_of_two_spheres_through_a_circle_of_stops_the_one_near_zero_is_taken(
    bias: float, tilt: float
) -> None:
    """Stops turned about z lie on a circle; the mirrored centre is 2 g cos(tilt) away.

    Without a word on scale and zero both fit exactly; half of the records took the mirror.
    """
    turns = np.linspace(0.3, 6.0, 9)
    level = np.column_stack([np.sin(turns), np.cos(turns)]) * np.sin(tilt)
    ups = np.column_stack([level, np.full(turns.size, np.cos(tilt))])
    noise = np.random.default_rng(7).normal(0.0, 1e-3, ups.shape)
    forces = 9.80665 * ups + [0.02, -0.03, bias] + noise
    for sign in (1.0, -1.0):  # the unit upside down, too
        for form in LEVELS:
            found = fit_forces(sign * forces, level=form, gravity=9.80665)
            assert abs(found.bias[2]) < 0.8, form


def test_a_turn_about_the_vertical_ends_a_stop_and_a_bump_does_not() -> None:
    """Gravity is where it was after both; two stops were one, whose rate was that of the turn."""
    rng = np.random.default_rng(5)
    hz, rest = 50.0, 200
    up = np.array([3.0, -2.0, 9.1])
    turn = 1.5 * np.sin(np.linspace(0.0, np.pi, 100)) ** 2  # half of two seconds: 1.5 rad
    bump = 2.0 * np.sin(np.linspace(0.0, 2.0 * np.pi, 20))  # there and back
    rates, forces = [], []
    for motion in (turn, bump, None):
        rates.append(np.zeros((rest, 3)))
        forces.append(np.tile(up, (rest, 1)))
        if motion is not None:
            rates.append(motion[:, None] * up / np.linalg.norm(up))
            forces.append(np.tile(up, (motion.size, 1)) + rng.normal(0.0, 1.0, (motion.size, 3)))
    rate, force = np.concatenate(rates), np.concatenate(forces)
    rate = rate + rng.normal(0.0, 1e-3, rate.shape)
    force = force + rng.normal(0.0, 0.01, force.shape)
    columns: dict[str, Floats] = {"time_s": np.arange(rate.shape[0]) / hz}
    columns |= {f"gyr_{a}_rad_s": rate[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": force[:, i] for i, a in enumerate("xyz")}
    found = held_stops(as_read(SimulatedLog(columns)))
    assert [stop.start < 300 for stop in found] == [True, False]
    assert max(float(np.abs(stop.rate).max()) for stop in found) < 0.01


@pytest.mark.statistical
def test_parameters_of_too_few_or_alike_stops_are_not_given() -> None:
    """About one axis next to nothing is given; what is given is within the tolerance."""
    total, given, wrong, _ = counts(10, one_axis=True, runs=6)
    assert 0 < given <= 0.3 * total
    assert wrong == 0
    total, given, wrong, _ = counts(12, one_axis=False, runs=3)
    assert given >= 0.8 * total
    assert wrong == 0
