"""The simulator: what it makes is what its specification says, and its books can be reduced.

The reductions here are written out from the formula sheet on purpose: they do not use the
program's own estimators.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import math
import tomllib
from typing import Any, Literal

import numpy as np
import pytest

from surveyapp.core.simulate.project import (
    direct_position,
    project_files,
    project_truth,
    simulate_reversal_project,
)
from surveyapp.core.simulate.session import (
    book_text,
    simulate_session,
    simulate_sessions,
)
from surveyapp.core.simulate.specification import (
    RUN_EFFECTS,
    Effect,
    Noise,
    SessionSpec,
    parse_effect,
)
from surveyapp.core.simulate.turning_points import SimulatedPoints, simulate_turning_points
from surveyapp.domain.readings import COLUMNS
from surveyapp.errors import SurveyError
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, AngleUnit, parse_angle, wrap_pi
from surveyapp_models.gyro.periods import clamped_period_s, tracking_period_s

QUIET = Noise(
    reading=0.0,
    reading_resolution=0.0,
    sight=0.0,
    scale_div=0.0,
    scale_resolution_div=0.0,
    time_s=0.0,
    time_resolution_s=0.0,
    temperature_c=0.0,
    temperature_resolution_c=0.0,
)


def fit_run(readings: np.ndarray) -> np.ndarray:
    """Least squares of N + A (-q)^k for each run: columns N, A, q, rms."""
    count = readings.shape[1]
    k = np.arange(count)
    results = []
    for row in readings:
        unknown = np.array([row.mean(), 0.5 * (row[0] - row[1]), 0.995])
        for _ in range(10):
            swing = (-1.0) ** k * unknown[2] ** k
            design = np.column_stack([np.ones(count), swing, unknown[1] * swing * k / unknown[2]])
            left = row - unknown[0] - unknown[1] * swing
            unknown = unknown + np.linalg.lstsq(design, left, rcond=None)[0]
        left = row - unknown[0] - unknown[1] * (-1.0) ** k * unknown[2] ** k
        results.append([*unknown, math.sqrt(left @ left / count)])
    return np.array(results)


def signature(
    *effects: Effect, points: int = 20, **changes: Any
) -> tuple[np.ndarray, np.ndarray, SimulatedPoints]:
    """Noise-free run: (Schuler means minus their mean, amplitude losses, bias of the fit)."""
    spec = SessionSpec(points=points, noise=QUIET, ratio=1.0, effects=effects)
    spec = dataclasses.replace(spec, **changes)
    made = simulate_turning_points(spec, 1, np.random.default_rng(5))
    row = made.readings[0] - spec.circle_of_north
    schuler = (row[:-3] + 3 * row[1:-2] + 3 * row[2:-1] + row[3:]) / 8
    half = np.abs(np.diff(row)) / 2
    return schuler / ARCSEC, -np.diff(half) / ARCSEC, made


def test_an_undisturbed_run_is_the_damped_swing() -> None:
    spec = SessionSpec(points=20, noise=QUIET, ratio=0.99)
    made = simulate_turning_points(spec, 3, np.random.default_rng(1))
    fitted = fit_run(made.readings)
    assert np.allclose(fitted[:, 0], spec.circle_of_north, atol=0.02 * ARCSEC)
    # the amplitude follows q^k to the amplitude term of the period: A^2/16 of the decrement
    assert np.allclose(fitted[:, 2], 0.99, atol=2e-6)
    assert np.all(fitted[:, 3] < 0.05 * ARCSEC)
    period = tracking_period_s(spec.gyro, spec.latitude)
    assert np.mean(np.diff(made.time_s)) == pytest.approx(period / 2, rel=3e-4)
    assert abs(made.time_s[0, 0]) < 0.02 * period
    assert np.abs(made.motion[0, 0] - spec.circle_of_north) == pytest.approx(
        spec.first_amplitude, rel=3e-3
    )


def test_reading_noise_has_the_stated_size() -> None:
    made = simulate_turning_points(SessionSpec(points=20), 400, np.random.default_rng(2))
    sigma = np.std(made.readings - made.motion) / ARCSEC
    assert sigma == pytest.approx(4.0, abs=4 * 4.0 / math.sqrt(2 * 8000))
    fitted = fit_run(made.readings)
    score = (fitted[:, 0] - made.gyro_north.mean(axis=1)) / (4 * ARCSEC / math.sqrt(20))
    assert np.mean(score) == pytest.approx(0.0, abs=4 / math.sqrt(400))
    # 3 unknowns cost N under one percent at 20 points
    assert np.var(score) == pytest.approx(1.0, abs=4 * math.sqrt(2 / 400))


def test_each_effect_has_its_signature() -> None:
    still, loss, _ = signature()
    assert np.ptp(still) < 0.02
    assert np.max(np.abs(loss)) < 0.05
    means, loss, made = signature(parse_effect("midpoint_drift=2"))
    assert np.allclose(np.diff(means), 2.0, atol=0.02)
    assert np.allclose(np.diff(made.gyro_north[0]) / ARCSEC, 2.0, atol=0.02)
    means, _, _ = signature(parse_effect("midpoint_step=25,at=0.5"))
    assert means[0] == pytest.approx(0.0, abs=0.1)
    assert means[-1] == pytest.approx(25.0, abs=0.1)
    means, _, _ = signature(parse_effect("warm_up=70,tau=5"))
    # quasi-static: mean over the swings, e-fold in five half swings
    assert np.allclose(means[1:] / means[:-1], math.exp(-0.2), atol=0.01)
    _, loss, _ = signature(parse_effect("dry_friction=20"))
    assert np.allclose(loss, 20.0, atol=0.3)
    _, loss, made = signature(parse_effect("quadratic_drag=0.01"))
    amplitude = np.abs(made.motion[0] - made.midpoint[0])
    expected = 0.01 * amplitude**2 / math.radians(2.0) / ARCSEC
    assert np.allclose(loss, (expected[1:-1]), rtol=0.02)
    _, loss, _ = signature(parse_effect("damping_break=0.01,at=0.5"))
    assert np.max(np.abs(loss[:7])) < 0.1
    assert np.allclose(loss[11] / 7200.0, 0.01, rtol=0.05)
    means, _, made = signature(parse_effect("amplitude_asymmetry=40"), ratio=0.97)
    assert means[0] - means[-1] == pytest.approx(40 * (0.97**3 - 0.97**35), rel=0.03)
    shift = (made.run_north[0] - made.gyro_north[0]) / ARCSEC
    assert shift.mean() == pytest.approx(means.mean(), abs=1.0)
    assert np.allclose(made.gyro_north, math.radians(100.0))
    means, loss, _ = signature(parse_effect("one_sided_lag=20"))
    assert np.allclose(means, -10.0, atol=0.3)
    assert np.allclose(loss, 20.0, atol=0.3)


def test_uneven_follow_up_changes_the_amplitude_only() -> None:
    spec = SessionSpec(
        points=20, noise=QUIET, ratio=1.0, effects=(parse_effect("tracking_jitter=15"),)
    )
    made = simulate_turning_points(spec, 200, np.random.default_rng(5))
    swing = np.abs(np.diff(made.readings, axis=1)) / 2 / ARCSEC
    loss = np.diff(swing, axis=1)
    # half a difference of neighbours averages two half swings
    assert np.std(loss) == pytest.approx(15.0 / math.sqrt(2), rel=0.06)
    assert np.allclose(made.midpoint, spec.circle_of_north)


@pytest.mark.parametrize("method", ["tracking", "amplitude"])
def test_twist_of_the_tripod_takes_circle_and_line_along(
    method: Literal["tracking", "amplitude"],
) -> None:
    spec = SessionSpec(
        method=method, points=9, noise=QUIET, ratio=1.0, effects=(parse_effect("tripod_twist=40"),)
    )
    made = simulate_turning_points(spec, 1, np.random.default_rng(5))
    north = (made.gyro_north[0] - spec.circle_of_north) / ARCSEC
    assert north[0] - north[-1] == pytest.approx(40.0, abs=0.2)
    row = made.readings[0]
    if method == "amplitude":
        t1 = tracking_period_s(spec.gyro, spec.latitude)
        t2 = clamped_period_s(spec.gyro, spec.latitude)
        row = spec.circle_of_north + spec.clamp_offset + (t1 / t2) ** 2 * spec.scale_value * row
    means = (row[:-3] + 3 * row[1:-2] + 3 * row[2:-1] + row[3:]) / 8 - spec.circle_of_north
    assert np.allclose(np.diff(means) / ARCSEC, -5.0, atol=0.05)
    session = simulate_session(spec, np.random.default_rng(5))
    left = [parse_angle(r["value"], AngleUnit.DMS) for r in session.rows if r["face"] == "L"]
    assert (left[0] - left[1]) / ARCSEC > 40.0
    assert np.mean(left) - spec.collimation == pytest.approx(
        math.radians(session.truth["line_reading_deg"]), abs=1.5 * ARCSEC
    )


def test_temperature_effect_follows_the_thermometer() -> None:
    means, _, made = signature(parse_effect("temperature=15"), temperature_span_c=1.0)
    warmth = made.temperature_c[0] - 15.0
    assert np.ptp(warmth) > 0.3
    smooth = (warmth[:-3] + 3 * warmth[1:-2] + 3 * warmth[2:-1] + warmth[3:]) / 8
    assert np.allclose(means, 15.0 * smooth, atol=0.06 * np.ptp(15.0 * warmth) + 0.1)
    assert np.allclose((made.gyro_north[0] - math.radians(100)) / ARCSEC, 15 * warmth, atol=0.02)


@pytest.mark.statistical
def test_random_paths_have_the_stated_spread() -> None:
    rng = np.random.default_rng(8)
    spec = SessionSpec(points=12, noise=QUIET, effects=(parse_effect("random_walk=9"),))
    north = simulate_turning_points(spec, 400, rng).gyro_north / ARCSEC
    steps = np.diff(north, axis=1)
    assert np.std(steps) == pytest.approx(9.0, rel=4 / math.sqrt(2 * steps.size) + 0.01)
    spec = dataclasses.replace(spec, effects=(parse_effect("autoregressive=9,rho=0.5"),))
    north = simulate_turning_points(spec, 400, rng).gyro_north / ARCSEC - math.degrees(1) * 0
    north = north - math.radians(100.0) / ARCSEC
    assert np.std(north) == pytest.approx(9.0, rel=0.06)
    correlation = np.mean(north[:, 1:] * north[:, :-1]) / np.mean(north**2)
    assert correlation == pytest.approx(0.5, abs=0.05)


def test_gross_errors_are_readings_only() -> None:
    spec = SessionSpec(points=12, noise=QUIET, effects=(parse_effect("gross_error=60,count=3"),))
    made = simulate_turning_points(spec, 50, np.random.default_rng(3))
    error = (made.readings - made.motion) / ARCSEC
    assert np.all(np.sum(np.abs(error) > 1.0, axis=1) == 3)
    assert np.allclose(np.abs(error[np.abs(error) > 1.0]), 60.0)


# --- books reduced by hand ----------------------------------------------------------------------


def values(rows: tuple[dict[str, str], ...], kind: str) -> np.ndarray:
    found = [row for row in rows if row["kind"] == kind]
    if found and found[0]["unit"] == "dms":
        return np.array([parse_angle(row["value"], AngleUnit.DMS) for row in found])
    return np.array([float(row["value"]) for row in found])


def zero_by_hand(readings: np.ndarray) -> float:
    x = readings
    return float(np.mean([(x[i] + 2 * x[i + 1] + x[i + 2]) / 4 for i in range(len(x) - 2)]))


@pytest.mark.parametrize("degrees", [0.0, -26.0, 47.0, 63.0, -75.0])
@pytest.mark.parametrize("method", ["tracking", "amplitude", "transit"])
def test_noise_free_books_reduce_to_the_truth(
    method: Literal["tracking", "amplitude", "transit"], degrees: float
) -> None:
    """Formulae of section 1.4 by hand, clamp 8' off, tape zero drifting from .3 to .5 div."""
    spec = SessionSpec(
        method=method,
        first_east=degrees > 40.0,
        latitude=math.radians(degrees),
        points=6 if method == "tracking" else 5,
        noise=QUIET,
        constant=-30 * ARCSEC,
        tape_zero_div=(0.3, 0.5),
        circle_of_north=math.radians(359.999),
    )
    made = simulate_session(spec, np.random.default_rng(4))
    mu = spec.scale_value
    t1 = tracking_period_s(spec.gyro, spec.latitude)
    t2 = clamped_period_s(spec.gyro, spec.latitude)
    ratio = (t1 / t2) ** 2 - 1
    zeros = values(made.rows, "tape_zero")
    zero = 0.5 * (zero_by_hand(zeros[:5]) + zero_by_hand(zeros[5:]))
    if method == "tracking":
        u = values(made.rows, "reversal")
        u = u[0] + np.array([wrap_pi(x - u[0]) for x in u])
        four = [(u[i] + 3 * u[i + 1] + 3 * u[i + 2] + u[i + 3]) / 8 for i in range(3)]
        north = float(np.mean(four)) - ratio * mu * zero
    else:
        x = values(made.rows, "scale_reversal")
        clamp = float(values(made.rows, "clamp")[0])
        if method == "amplitude":
            centre = (x[0] + 3 * x[1] + 4 * x[2] + 3 * x[3] + x[4]) / 12
        else:
            t = [float(r["elapsed_s"]) for r in made.rows if r["kind"] == "transit"]
            # five passages: mean of the three time differences, east minus west
            sign = 1.0 if x[1] > 0 else -1.0
            span = sign * (-t[0] + 3 * t[1] - 4 * t[2] + 3 * t[3] - t[4]) / 3.0
            amplitude = np.mean(np.abs(np.diff(x[1:-1]))) / 2
            centre = amplitude * math.sin(math.pi * span / (2 * t2))
        north = clamp + (1 + ratio) * mu * centre - ratio * mu * zero
    error = wrap_pi(north - math.radians(made.truth["gyro_north_deg"])) / ARCSEC
    # the drift of the zero is linear, the readings are symmetric about mid-run but for the lead
    assert abs(error) < (1.0 if method == "transit" else 0.3)


def test_sights_carry_collimation_and_the_line() -> None:
    spec = SessionSpec(noise=QUIET, collimation=8 * ARCSEC, line_azimuth=4.0)
    made = simulate_session(spec, np.random.default_rng(4))
    left = [parse_angle(r["value"], AngleUnit.DMS) for r in made.rows if r["face"] == "L"]
    right = [parse_angle(r["value"], AngleUnit.DMS) for r in made.rows if r["face"] == "R"]
    assert len(left) == len(right) == 2
    for a, b in zip(left, right, strict=True):
        assert wrap_pi(a - b + math.pi) / 2 == pytest.approx(8 * ARCSEC, abs=0.1 * ARCSEC)
        mean = a - wrap_pi(a - b + math.pi) / 2
        expected = math.radians(made.truth["line_reading_deg"])
        assert wrap_pi(mean - expected) == pytest.approx(0.0, abs=0.1 * ARCSEC)


def test_book_columns_order_and_sides() -> None:
    spec = SessionSpec(points=7, missed=(2,), effects=(parse_effect("midpoint_drift=3"),))
    made = simulate_session(spec, np.random.default_rng(6))
    rows = list(csv.DictReader(io.StringIO(book_text(made.rows))))
    assert tuple(rows[0]) == COLUMNS
    assert [int(row["seq"]) for row in rows] == list(range(1, len(rows) + 1))
    elapsed = [float(row["elapsed_s"]) for row in rows]
    assert elapsed == sorted(elapsed)
    kinds = [row["kind"] for row in rows]
    assert kinds.count("missed") == 1
    assert kinds.index("missed") == kinds.index("reversal") + 2
    sides = [row["side"] for row in rows if row["kind"] == "reversal"]
    assert sides == ["R", "L", "L", "R", "L", "R"]
    assert all("+00:00" in row["time"] for row in rows)


def test_side_follows_the_reading_where_the_scale_is_reversed() -> None:
    for scale in (600.0, -600.0):
        spec = SessionSpec(method="amplitude", points=5, scale_value=scale * ARCSEC)
        made = simulate_session(spec, np.random.default_rng(6))
        turns = [row for row in made.rows if row["kind"] == "scale_reversal"]
        for row in turns:
            assert (row["side"] == "R") == (float(row["value"]) > 0.0)


def test_full_fit_times_several_lines() -> None:
    spec = SessionSpec(method="full_fit", points=4, lines_div=(-3.0, 0.0, 3.0))
    made = simulate_session(spec, np.random.default_rng(6))
    transits = [row for row in made.rows if row["kind"] == "transit"]
    assert sorted({row["value"] for row in transits}) == ["-3", "0", "3"]
    assert len(transits) == 12


def test_sessions_of_an_ensemble_differ_in_noise_and_agree_in_kind() -> None:
    spec = SessionSpec(method="transit", points=5, effects=(parse_effect("midpoint_step=20"),))
    made = simulate_sessions(spec, 8, np.random.default_rng(2))
    assert len(made) == 8
    assert len({book_text(session.rows) for session in made}) == 8
    assert len({session.truth["drawn"]["midpoint_step.at"] for session in made}) == 8
    kinds = [[row["kind"] for row in session.rows] for session in made]
    assert all(kind == kinds[0] for kind in kinds)


def test_same_seed_same_book() -> None:
    spec = SessionSpec(effects=(parse_effect("random_walk=5"), parse_effect("midpoint_step=20")))
    texts = [book_text(simulate_session(spec, np.random.default_rng(9)).rows) for _ in range(2)]
    assert texts[0] == texts[1]


def test_project_text_is_complete() -> None:
    spec = SessionSpec(latitude=math.radians(-26.0), effects=(parse_effect("midpoint_step=20"),))
    project = simulate_reversal_project(
        spec, np.random.default_rng(9), calibration_latitude=math.radians(47.0)
    )
    files, truth = project_files(project), project_truth(project)
    table = tomllib.loads(files["project.toml"])
    assert table["format"] == 1
    for item in table["orientation"]:
        assert item["book"] in files
        assert ("azimuth_known" in item) == (item["purpose"] == "calibration")
    card = tomllib.loads(files["cards/simulated-gyro.toml"])
    assert card["period"]["latitude_deg"] == 47.0
    assert card["period"]["tracking_s"] == pytest.approx(425.4, abs=0.5)
    sessions = truth["sessions"]
    assert set(sessions) == {"cal-1", "cal-2", "run-1", "run-2"}
    assert sessions["cal-1"]["effects"] == []
    assert sessions["run-1"]["effects"][0]["size"] == pytest.approx(20.0)
    assert 0.0 < sessions["run-1"]["drawn"]["midpoint_step.at"] < 1.0


def test_direct_position_lies_in_the_asked_azimuth() -> None:
    """Back by the small-figure radii of curvature at the middle: a plain hand check."""
    lat, lon = direct_position(math.radians(60), 0.4, azimuth=1.0, distance_m=300.0)
    middle = 0.5 * (lat + math.radians(60))
    bracket = 1 - 0.00669438 * math.sin(middle) ** 2
    east = (lon - 0.4) * 6378137 / math.sqrt(bracket) * math.cos(middle)
    north = (lat - math.radians(60)) * 6378137 * (1 - 0.00669438) / bracket**1.5
    assert math.hypot(east, north) == pytest.approx(300.0, abs=1e-4)
    assert math.atan2(east, north) * RHO_ARCSEC == pytest.approx(
        (1.0 + 0.5 * (lon - 0.4) * math.sin(middle)) * RHO_ARCSEC, abs=0.1
    )


# --- what is refused ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("midpoint_drft=2", "midpoint_drift"),
        ("midpoint_drift=", "not a number"),
        ("midpoint_drift=nan", "not a number"),
        ("midpoint_step=2,on=3", "unknown option"),
    ],
)
def test_effects_that_cannot_be_read(text: str, words: str) -> None:
    with pytest.raises(SurveyError, match=words):
        parse_effect(text)


def test_impossible_specifications_name_all_problems() -> None:
    with pytest.raises(SurveyError) as caught:
        SessionSpec(points=2, ratio=1.2, latitude=math.pi / 2)
    assert [problem.where for problem in caught.value.problems] == ["points", "ratio", "latitude"]
    with pytest.raises(SurveyError, match="does not reach"):
        SessionSpec(method="transit", amplitude=300 * ARCSEC)


def test_every_effect_kind_can_be_simulated_in_every_method() -> None:
    rng = np.random.default_rng(1)
    for method in ("tracking", "amplitude", "transit", "full_fit"):
        for kind in RUN_EFFECTS:
            size = 0.001 if kind.to_internal == 1.0 else 10.0
            spec = SessionSpec(
                method=method,
                points=6,
                effects=(parse_effect(f"{kind.id}={size}"),),
                temperature_span_c=1.0,
            )
            assert len(simulate_session(spec, rng).rows) > 12


def test_an_event_comes_at_another_point_of_the_second_run() -> None:
    spec = dataclasses.replace(SessionSpec(), effects=(parse_effect("midpoint_step=25,at=0.5"),))
    made = simulate_reversal_project(spec, np.random.default_rng(4))
    runs = [s.simulated.truth for s in made.sessions if s.purpose == "survey"]
    places = [truth["drawn"]["midpoint_step.at"] for truth in runs]
    assert places[0] == 0.5
    assert places[1] != 0.5
