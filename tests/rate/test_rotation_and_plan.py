"""North carried through a rotation, its decision table, and the planner of stops."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveyapp.api import plan_north_stops
from surveyapp.core.sensors.rate.card_values import card_matrix
from surveyapp.core.sensors.rate.rotation import (
    RotationOptions,
    find_heading,
    level_case,
)
from surveyapp.core.sensors.rate.stop_plan import pointing
from surveyapp.core.simulate.rate.log import SimulatedLog
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import attitude_matrix, attitude_quaternion, sensed
from tests.rate.logs import as_read


def turned_log(*, turn_deg: float) -> SimulatedLog:
    """A tilted unit of heading 77 degrees that is turned clockwise about the vertical."""
    heading, pitch, roll = (math.radians(v) for v in (77.0, 12.0, -9.0))
    dt = 0.1
    counts = {"warm-up": 200, "filter": 200, "level": 200, "run": 600}
    own = np.zeros((sum(counts.values()), 3))
    down = attitude_matrix(heading=heading, pitch=pitch, roll=roll).T @ [0.0, 0.0, -1.0]
    own[650:1050] = down * math.radians(turn_deg) / 40.0
    start = attitude_quaternion(heading=heading, pitch=pitch, roll=roll)
    attitude = quaternions.integrate(own, interval_s=dt, start=start)[:-1]
    earth, forces = sensed(attitude, latitude=math.radians(35.0))
    bias = np.array([2e-5, -1e-5, 3e-5])
    columns: dict[str, Floats] = {"time_s": np.asarray(np.arange(own.shape[0]) * dt)}
    columns |= {f"gyr_{a}_rad_s": own[:, i] + earth[:, i] + bias[i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_m_s2": forces[:, i] for i, a in enumerate("xyz")}
    words = [name for name, count in counts.items() for _ in range(count)]
    return SimulatedLog(columns, {"phase": words})


def test_the_heading_is_carried_and_only_a_magnetic_one_takes_a_declination() -> None:
    """Sensors.md 2c: a compass heading of 125.600 and a declination of -2.6 give 123.000."""
    log = as_read(turned_log(turn_deg=48.6))
    options = RotationOptions(
        heading=math.radians(77.0), reference="MAGNETIC", declination=math.radians(-2.6)
    )
    found = find_heading(log, options)
    assert found.direction.deg == pytest.approx(123.0, abs=0.05)
    assert found.direction.reference == "ASTRONOMIC"
    levelling = found.extra["levelling"]
    assert levelling["case"] == "A4"
    assert [turn["axis"] for turn in levelling["rotations"]] == ["y", "x"]
    assert levelling["rotations"][0]["deg"] == pytest.approx(9.0, abs=0.01)
    assert [step["step"] for step in found.extra["steps"]] == list(range(101, 114))
    kept = find_heading(log, RotationOptions(heading=math.radians(77.0), reference="GRID"))
    assert kept.direction.reference == "GRID"
    assert kept.direction.deg == pytest.approx(125.6, abs=0.05)


LATITUDE = math.radians(35.0)
POLE = 7.292115e-5 * np.array([0.0, math.cos(LATITUDE), math.sin(LATITUDE)])


def rotation(vector: Floats) -> Floats:
    """Rodrigues' formula, nothing of the program's quaternions."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return np.asarray(np.eye(3) + turn)


def moved_log(moves: list[tuple[str, Floats, float]]) -> tuple[SimulatedLog, Floats]:
    """A unit of heading 77, pitch 12, roll -9 degrees, moved about axes of the body or the world.

    Of each move: b or n, the whole turn [rad], seconds. The log, and the attitude at its end.
    """
    h, p, r = (math.radians(v) for v in (77.0, 12.0, -9.0))
    e = np.eye(3)
    c = rotation(-h * e[2]) @ rotation(p * e[0]) @ rotation(r * e[1])
    dt, bias = 0.1, np.array([2e-5, -1e-5, 3e-5])
    words = ["warm-up"] * 200 + ["filter"] * 200 + ["level"] * 200
    rates, forces = [c.T @ POLE] * 600, [c.T @ (9.80665 * e[2])] * 600
    for frame, turn, seconds in moves:
        for _ in range(round(seconds / dt)):
            own = turn / seconds if frame == "b" else c.T @ turn / seconds
            rates.append(own + c.T @ POLE)
            forces.append(c.T @ (9.80665 * e[2]))
            words.append("run")
            c = c @ rotation(own * dt)
    columns: dict[str, Floats] = {"time_s": np.asarray(np.arange(len(words)) * dt)}
    for i, a in enumerate("xyz"):
        columns[f"gyr_{a}_rad_s"] = np.array(rates)[:, i] + bias[i]
        columns[f"acc_{a}_m_s2"] = np.array(forces)[:, i]
    return SimulatedLog(columns, {"phase": words}), np.asarray(c)


X, Y, Z = np.eye(3)


@pytest.mark.parametrize(
    "moves",
    [
        # the levelling turns of source 002 are in the record, then the unit is turned
        [
            ("b", math.radians(9.0) * Y, 10.0),
            ("b", math.radians(-12.0) * X, 10.0),
            ("n", math.radians(-120.0) * Z, 30.0),
        ],
        [("b", math.radians(-120.0) * Z, 30.0)],
        # turned, and then at rest for ten minutes in which the earth turns by 2.5 degrees
        [("n", math.radians(-90.0) * Z, 30.0), ("b", 0.0 * Z, 600.0)],
        [("b", math.radians(40.0) * X, 30.0), ("b", 0.0 * Z, 300.0)],
    ],
)
def test_the_attitude_after_the_run_is_that_of_the_body(
    moves: list[tuple[str, Floats, float]],
) -> None:
    """Heading and quaternion of the body itself, whatever was turned in the record."""
    log, truth = moved_log(moves)
    options = RotationOptions(heading=math.radians(77.0), reference="ASTRONOMIC", latitude=LATITUDE)
    found = find_heading(as_read(log), options)
    heading = math.degrees(math.atan2(truth[0, 1], truth[1, 1])) % 360.0
    assert found.direction.deg == pytest.approx(heading, abs=1e-3)
    attitude = quaternions.to_matrix(np.array(found.extra["attitude_quaternion"]))
    np.testing.assert_allclose(attitude, truth, atol=2e-5)
    assert found.extra["levelling"]["case"] == "A4"


def test_a_unit_that_is_levelled_within_the_phase_is_seen_before_and_after() -> None:
    """The tilt to take out is that of the beginning, the run goes on from the end."""
    rest, turned = 0.0 * Z, math.radians(-120.0) * Z
    log, end = moved_log(
        [
            ("b", rest, 20.0),
            ("b", math.radians(9.0) * Y, 10.0),
            ("b", math.radians(-12.0) * X, 10.0),
            ("b", rest, 20.0),
            ("n", turned, 30.0),
        ]
    )
    words = list(log.texts["phase"])
    words[600:1200] = ["level"] * 600
    options = RotationOptions(heading=math.radians(77.0), reference="ASTRONOMIC", latitude=LATITUDE)
    found = find_heading(as_read(SimulatedLog(log.columns, {"phase": words})), options)
    assert found.extra["levelling"]["pitch_deg"] == pytest.approx(12.0, abs=1e-6)
    assert found.extra["levelling"]["roll_deg"] == pytest.approx(-9.0, abs=1e-6)
    assert [w.code for w in found.warnings].count("level_turned") == 1
    wanted = math.degrees(math.atan2(end[0, 1], end[1, 1])) % 360.0
    assert found.direction.deg == pytest.approx(wanted, abs=0.01)


def test_without_a_latitude_the_sigma_holds_what_the_earth_did() -> None:
    """A unit that is pitched for five minutes sees another part of the earth's rate."""
    moves = [("b", math.radians(40.0) * X, 30.0), ("b", 0.0 * Z, 600.0)]
    log, truth = moved_log(moves)
    heading = math.degrees(math.atan2(truth[0, 1], truth[1, 1])) % 360.0
    options = RotationOptions(heading=math.radians(77.0), reference="ASTRONOMIC")
    found = find_heading(as_read(log), options)
    off = abs(float(found.direction.deg or 0.0) - heading)
    sigma = float(found.direction.sigma_arcsec or 0.0) / 3600.0
    assert 0.05 < off < 3.0 * sigma < 10.0
    assert any(w.code == "rest_rate" for w in found.warnings)


@pytest.mark.parametrize(
    ("pitch", "roll", "case"),
    [(0.0, 0.0, "A1"), (0.0, 0.1, "A2"), (0.1, 0.0, "A3"), (0.1, 0.1, "A4"), (2e-3, 0.1, "A2")],
)
def test_the_decision_table_and_zero_below_three_sigmas(
    pitch: float, roll: float, case: str
) -> None:
    assert level_case(pitch, roll, 1e-3).case == case


def test_the_matrix_of_a_card_is_the_sources_transposed() -> None:
    """w = K^-T (reading - bias): K_xy of the source is what y shows of a rate about x."""
    matrix, bias = card_matrix({"misalignment_yx": 3600.0, "bias_z": 1.0, "scale_factor_x": 1e4})
    reading = matrix @ np.array([1.0, 2.0, 3.0]) + bias
    assert reading[1] == pytest.approx(2.0 + math.radians(1.0))
    assert reading[0] == pytest.approx(1.01)
    back = np.linalg.solve(matrix, reading - bias)
    np.testing.assert_allclose(back, [1.0, 2.0, 3.0], atol=1e-12)


def test_a_record_without_its_run_is_refused() -> None:
    log = turned_log(turn_deg=10.0)
    words = ["level" if w == "run" else w for w in log.texts["phase"]]
    with pytest.raises(SurveyError, match="a phase is missing"):
        find_heading(
            as_read(SimulatedLog(log.columns, {"phase": words})),
            RotationOptions(heading=0.0, reference="GRID"),
        )


def test_the_planner_has_the_figures_of_the_contract() -> None:
    """rate.md: latitude 35, .15 deg/sqrt(h), 10/100/300 s: 13.2/4.2/2.4 degrees."""
    plan = plan_north_stops(latitude_deg=35.0, want_deg=5.0)
    heading = {row.stop_s: row.heading_sd_deg for row in plan.rows}
    assert heading[10.0] == pytest.approx(13.2, abs=0.05)
    assert heading[100.0] == pytest.approx(4.2, abs=0.05)
    assert heading[300.0] == pytest.approx(2.4, abs=0.05)
    assert {row.stop_s for row in plan.rows if row.enough} == {100.0, 170.0, 200.0, 300.0}
    with pytest.raises(SurveyError):
        plan_north_stops(latitude_deg=35.0, grade="brass")


@pytest.mark.parametrize(
    ("bias", "latitude", "theta"),
    [(0.2, 0, 0.76), (0.2, 45, 1.08), (20.0, 0, 53.1), (0.263, 0, 1.0)],
)
def test_pointing_is_an_arctangent(bias: float, latitude: int, theta: float) -> None:
    """Sensors.md 2d: arcsin would give 90 degrees at the whole earth rate, the text says 45."""
    found = math.degrees(pointing(bias, latitude=math.radians(latitude)))
    assert found == pytest.approx(theta, abs=0.06)
