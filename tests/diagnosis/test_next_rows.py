"""What to observe next at a traverse and at a record of any subject."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from bench._advice import MOST, TRAVERSES, traverse_visits
from bench._traverses import ARC, Undeclared, simulated
from surveyapp import api
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.next_rows import rows_advice
from surveyapp.diagnosis.outlook import ActionResult, Outlook
from surveyapp.diagnosis.subjects.traverse import traverse
from surveyapp.diagnosis.subjects.traverse_actions import TraversePlanner
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import Network, NetworkPoint, Status
from surveyapp.observation.next_action import next_actions
from surveyapp.tui.views.progress import WIDTH, next_lines

K = ObservationKind
SIGMA = 5.0 * ARC


def advised(case: Case) -> Outlook:
    found = rows_advice(case, np.random.default_rng(1))
    assert found is not None
    return found


def by_id(case: Case) -> dict[str, ActionResult]:
    return {item.action: item for item in advised(case).actions}


def spur() -> Network:
    """One side from a fixed line, its angle observed twice: the azimuth has the sigma of a mean."""
    fixed = Status.FIXED
    points = (
        NetworkPoint("A", 0.0, 0.0, None, fixed, fixed),
        NetworkPoint("B", 0.0, 100.0, None, fixed, fixed),
        NetworkPoint("C", 100.0, 0.0),
    )
    rows = (
        Observation(K.ANGLE, "A", "C", math.pi / 2.0 + 0.5 * SIGMA, SIGMA, back="B"),
        Observation(K.ANGLE, "A", "C", math.pi / 2.0 - 0.5 * SIGMA, SIGMA, back="B"),
        Observation(K.DISTANCE, "A", "C", 100.0, 0.002),
    )
    return Network(points, rows)


def test_where_nothing_can_be_missing_it_is_the_mean_of_one_angle_more() -> None:
    case = dataclasses.replace(traverse(spur()), effects=())
    found = advised(case)
    again = by_id(case)["repeat_angle"]
    # conjugate analysis with 8 degrees of freedom of the stated sigma: one condition of .5 squares
    scale = math.sqrt((8.0 + 0.5) / 9.0)
    assert found.interval == pytest.approx(
        student_quantile(0.975, 9.0) * scale * SIGMA / math.sqrt(2.0), rel=1e-3
    )
    # the mean of three, the scale drawn: its mean is that of the root of (8.5 + s^2 F) / 10
    g = np.random.default_rng(2)
    s2 = 8.5 / g.chisquare(9.0, 200_000)
    then = np.mean(np.sqrt((8.5 + s2 * g.chisquare(1.0, s2.size)) / 10.0))
    expected = student_quantile(0.975, 10.0) * then * SIGMA / math.sqrt(3.0)
    assert again.interval95 == pytest.approx(float(expected), rel=0.03)
    assert again.separation == 1.0
    assert again.information == 0.0
    # a distance says nothing of an azimuth
    assert by_id(case)["repeat_distance"].interval95 > 0.95 * found.interval


LENGTHS = np.random.default_rng(5).uniform(80.0, 300.0, 9)


def of(wrong: Undeclared, **how: object) -> Case:
    return traverse(simulated(np.random.default_rng(4), wrong, LENGTHS, **how))


def test_what_turns_back_and_what_bends_are_told_apart_by_turning_back() -> None:
    case = of(Undeclared(bending=10.0), walls=True, zig_zag=False)
    found = advised(case)
    assert found.actions[0].action == "opposite_angle"
    # the same angle in the same sense repeats both: most of the doubt stays
    doubt = 1.0 - found.actions[0].separation
    assert doubt < 0.3 * (1.0 - by_id(case)["repeat_angle"].separation)


def test_a_slip_is_found_where_it_is() -> None:
    case = of(Undeclared(), gross=(6, 8.0))
    # the seventh observation is the angle at P7
    assert " at P7" in advised(case).actions[0].text


def test_a_shifted_constant_is_proved_by_the_constant() -> None:
    found = advised(of(Undeclared(shift=60.0)))
    best = {item.action for item in found.actions[:3]}
    assert best & {"constant_again", "repeat_gyro", "gyro_side"}


def test_a_further_gyro_narrows_the_least_certain_side() -> None:
    case = of(Undeclared())
    found = advised(case)
    assert found.unit == "arcsec"
    side = found.wanted.split()[3].rstrip(",")
    gyro = min(found.actions, key=lambda item: item.interval95)
    assert gyro.interval95 < 0.97 * found.interval
    told = diagnose(case)
    assert any(side in text for text in told.advice)
    keys = told.to_dict()["actions"][0]
    assert "interval95_arcsec" in keys
    assert 1.0 < keys["interval95_arcsec"] < 60.0


def test_after_an_automatic_gyro_the_screen_says_what_its_campaign_needs(tmp_path: Path) -> None:
    folder = tmp_path / "campaign"
    api.simulate("campaign", folder, effects=["temperature=1.5"], seed=3)
    project = api.open_project(folder)
    actions = next_actions(project, project.sessions[-1].id)
    assert {item.action for item in actions} >= {"warmer", "other_line", "month"}
    assert all(len(line) <= WIDTH for line in next_lines(actions, shown=6))


def test_offers_at_once_are_offers_one_by_one() -> None:
    """And a basis that takes a mean over the rows takes that of the record."""
    network = simulated(np.random.default_rng(4), Undeclared(), LENGTHS)
    noted = tuple(
        dataclasses.replace(obs, note=f"temp={10 + k % 7}") if obs.kind is K.DISTANCE else obs
        for k, obs in enumerate(network.observations)
    )
    case = traverse(dataclasses.replace(network, observations=noted))
    assert case.planner is not None
    planner = case.planner()
    assert isinstance(planner, TraversePlanner)
    here, more = planner.adjusted.columns, planner.more
    for name in ("distance_scale", "angle_bias"):
        effect = planner.effects[name]
        at_once = planner.rows_of(effect, {})
        for i in range(0, len(planner.offers), 7):
            table = {key: np.append(here[key], new[i]) for key, new in more.items()}
            assert at_once[i] == pytest.approx(effect.basis(table)[-1], rel=1e-12)
    observed = here["distance_m"] > 0.0
    mean = here["distance_temperature_c"][observed].mean()
    expected = more["distance_m"] * (more["distance_temperature_c"] - mean)
    found = planner.rows_of(planner.effects["distance_temperature"], {})[:, 0]
    assert found == pytest.approx(expected, rel=1e-9)


def test_advice_saves_observations() -> None:
    """Nine traverses along a wall, a part of ``closing_the_loop``: chance needs twice as many."""
    name = next(iter(TRAVERSES))
    advised, random = (
        sum(min(traverse_visits(name, i, advised=how), MOST) for i in range(9))
        for how in (True, False)
    )
    assert 2 * advised < random
