"""Effects of a traverse: found where the geometry allows it, else called not separable."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

from bench._traverses import ARC, Undeclared, folder_text, simulated
from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.network import adjust
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.loop import search
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.diagnosis.subjects.traverse import (
    TRANSFORM,
    traverse,
)
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Network, Status
from surveyapp.errors import SurveyError

DRAWS = 1000
SIDES = np.array([110.0, 40, 150, 60, 25, 130, 80, 170, 35, 90, 145, 55, 120, 75])
ALIKE = np.full(14, 100.0)
UNEVEN = np.array([100.0] + [15.0, 400.0] * 6 + [100.0])


def found(network: Network) -> Diagnosis:
    return diagnose(traverse(network), draws=DRAWS)


def names_of(result: Diagnosis) -> set[str]:
    return {item.effect for item in result.adopted}


def sets_of(result: Diagnosis) -> set[str]:
    return {name for item in result.ambiguous for name in item.any_of}


def test_conditions_are_what_the_adjustment_says() -> None:
    network = simulated(np.random.default_rng(1), Undeclared(), SIDES)
    result, problem = adjust(network), traverse(network)
    assert problem.size - 1 == result.dof
    conditions = problem.observations[1:]
    ratio = math.sqrt(float(conditions @ conditions) / (problem.size - 1))
    assert ratio == pytest.approx(result.global_test.ratio, rel=1e-6)
    weakest = max(
        (p for p in result.points if p.ellipse is not None),
        key=lambda p: p.ellipse.a_m if p.ellipse is not None else 0.0,
    )
    assert problem.labels[0] == f"place of {weakest.name}"
    transform = problem.columns[TRANSFORM]
    # an orthonormal base of what the unknowns leave: unit covariance of independent observations
    sigma = problem.columns["own_sigma"].copy()
    sigma[-1] = 5.0 * ARC  # the gyro's constant
    covariance = (transform * sigma**2) @ transform.T
    np.testing.assert_allclose(covariance, np.eye(problem.size), atol=1e-9)


def test_a_gyro_shift_an_angle_bias_and_a_slip_are_named_with_their_size() -> None:
    rng = np.random.default_rng(3)
    result = found(simulated(rng, Undeclared(shift=90.0), SIDES))
    assert names_of(result) == {"gyro_constant_shift"}
    shift = result.adopted[0].coefficients[0]
    assert shift.value == pytest.approx(90.0, abs=3.5 * (shift.sigma or 0.0))
    result = found(simulated(rng, Undeclared(bias=20.0), SIDES))
    assert names_of(result) == {"angle_bias"}
    assert result.adopted[0].coefficients[0].value == pytest.approx(20.0, abs=8.0)
    network = simulated(rng, Undeclared(), SIDES, gross=(20, 14.0))
    problem = traverse(network)
    result = diagnose(problem, draws=DRAWS)
    assert names_of(result) == {"gross_error"}
    assert result.adopted[0].grid[0][1] == 21.0
    assert network.observations[20].where in " ".join(words_of(result, problem))


@pytest.mark.parametrize("wrong", [Undeclared(scale=200.0), Undeclared(constant=12.0)])
def test_scale_and_constant_cannot_be_told_apart_where_sides_are_alike(wrong: Undeclared) -> None:
    result = found(simulated(np.random.default_rng(4), wrong, ALIKE))
    assert result.verdict == "not_separable"
    assert not names_of(result) & {"distance_scale", "distance_constant"}
    assert {"distance_scale", "distance_constant"} <= sets_of(result)
    assert any("short and long distances" in item.separate_by for item in result.ambiguous)
    assert any("atmosphere was corrected twice" in text for text in result.remedy)


def test_distances_over_two_sides_tell_the_constant_from_the_scale() -> None:
    pair, named = {"distance_scale", "distance_constant"}, 0
    for seed in range(8):
        for wrong, right in (
            (Undeclared(scale=200.0), "distance_scale"),
            (Undeclared(constant=10.0), "distance_constant"),
        ):
            rng = np.random.default_rng(seed)
            result = found(simulated(rng, wrong, UNEVEN, overlaps=True))
            names = names_of(result) & pair
            assert names <= {right}
            assert right in names | {n for s in sets_of(result) for n in s.split(" + ")}
            named += right in names
    assert named >= 12  # of 16


def test_refraction_is_told_from_a_bias_by_zig_zag_only() -> None:
    named = together = 0
    wrong = Undeclared(bending=50.0)
    for seed in range(8):
        rng = np.random.default_rng(seed)
        zig = found(simulated(rng, wrong, SIDES, gyro_every=1, walls=True))
        named += "lateral_refraction" in names_of(zig)
        slight = Undeclared(bending=8.0)  # 16" in every angle but the first
        wall = found(simulated(rng, slight, ALIKE, zig_zag=False, walls=True, gyro_every=99))
        assert "angle_bias" not in names_of(wall)
        together += {"angle_bias", "lateral_refraction"} <= sets_of(wall)
    assert named >= 6
    assert together >= 6
    unsaid = traverse(simulated(rng, wrong, SIDES))
    missing = {c.effect: c for c in diagnose(unsaid, draws=200).candidates}["lateral_refraction"]
    assert missing.verdict == "not_applicable"


def test_quiet_traverses_stay_quiet() -> None:
    fired = sum(
        search(
            traverse(simulated(np.random.default_rng(100 + seed), Undeclared(), SIDES)),
            draws=DRAWS,
            confirm=None,
        )
        .gates[0]
        .fired
        for seed in range(60)
    )
    assert fired <= 9  # binomial(60, 0.05): more than 9 in 0.1 % of cases


def test_a_second_traverse_confirms() -> None:
    rng = np.random.default_rng(8)
    first = traverse(simulated(rng, Undeclared(bias=25.0), SIDES))
    second = traverse(simulated(rng, Undeclared(bias=25.0), SIDES[::-1]))
    result = diagnose(first, confirm=second, draws=DRAWS)
    assert names_of(result) == {"angle_bias"}
    assert result.after.confirm_rms is not None
    assert result.before.confirm_rms is not None
    assert result.after.confirm_rms < result.before.confirm_rms


def test_every_trial_is_in_units_of_sigma_and_the_place_is_told() -> None:
    problem = traverse(
        simulated(np.random.default_rng(3), Undeclared(bias=20.0), SIDES), atmosphere_applied=True
    )
    result = diagnose(problem, draws=DRAWS)
    value = result.to_dict()["before"]["value"]
    assert set(value) == {"sigma", "sigma_sigma", "interval95_sigma"}
    words = " ".join(words_of(result, problem))
    assert "least certain point" in words
    assert "nothing is corrected again" in words


def test_what_nothing_controls_or_is_too_much_is_refused() -> None:
    network = simulated(np.random.default_rng(1), Undeclared(), SIDES[:4])
    end = network.points[-1]
    free = dataclasses.replace(end, status_e=Status.FREE, status_n=Status.FREE)
    last = dataclasses.replace(network.points[-2], status_e=Status.FREE, status_n=Status.FREE)
    angles = [o for o in network.observations if o.kind is ObservationKind.ANGLE][:2]
    sides = [o for o in network.observations if o.kind is ObservationKind.DISTANCE][::2]
    open_one = dataclasses.replace(
        network,
        points=(*network.points[:-2], last, free)[:4],
        observations=(*angles, *sides[:2]),
        constants=(),
    )
    with pytest.raises(SurveyError, match="nothing controls"):
        traverse(open_one)


def test_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    network = simulated(np.random.default_rng(3), Undeclared(bias=25.0), SIDES)
    toml, book = folder_text(network)
    (tmp_path / "observations").mkdir()
    (tmp_path / "project.toml").write_text(toml, encoding="utf-8")
    (tmp_path / "observations" / "main.csv").write_text(book, encoding="utf-8")
    assert [tuple(item) for item in api.subjects(tmp_path)] == [("traverse", "main")]
    assert main(["diagnose", str(tmp_path), "--traverse", "main", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["subject"] == "traverse"
    assert told["unit"] == "sigma"
    assert any(w["code"] == "atmosphere_applied" for w in told["warnings"])
    assert (tmp_path / "ledger.jsonl").exists()
    assert main(["diagnose", str(tmp_path)]) == 0  # the only subject
    assert "traverse main" in capsys.readouterr().out
    assert main(["diagnose", str(tmp_path), "--traverse", "mian"]) == 2
    assert "main" in capsys.readouterr().err
    assert main(["diagnose", str(tmp_path), "--adopt"]) == 2
    assert "mended at its source" in capsys.readouterr().err
    assert not math.isnan(told["before"]["rms"])
