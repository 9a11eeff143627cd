"""Clamped methods through the public route, and what is refused."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.plan import plan_methods
from surveyapp.core.simulate.project import project_files, project_truth, simulate_reversal_project
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.errors import SurveyError
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC
from tests.api.projects import CARD, GYRO, rows, write

POSITION = '[[station]]\nname = "A"\nlat = 47.0\nlon = 9.0\n'


def clamped(method: str) -> str:
    return (
        POSITION
        + GYRO
        + f'[[orientation]]\nid = "run"\nstation = "A"\ninstrument = "G1"\nmethod = "{method}"\n'
        'purpose = "survey"\nbook = "observations/run.csv"\n'
    )


def make(folder: Path, spec: SessionSpec, seed: int, **counts: Any) -> dict[str, dict[str, float]]:
    project = simulate_reversal_project(spec, np.random.default_rng(seed), **counts)
    for name, text in project_files(project).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    truth: dict[str, dict[str, float]] = json.loads(json.dumps(project_truth(project)["sessions"]))
    return truth


def test_amplitude_method_by_hand(tmp_path: Path) -> None:
    # N = N' + (1 + lambda) mu B - lambda mu d with mu = 600", B = 1 div, d = 0.5 div
    zeros = ["tape_zero,5.5", "tape_zero,-4.5", "tape_zero,5.5"]
    book = rows(
        *zeros,
        "clamp,100-00-00",
        "scale_reversal,7",
        "scale_reversal,-5",
        "scale_reversal,7",
        *zeros,
    )
    result = api.orient(write(tmp_path, clamped("amplitude"), {"run": book}))
    ratio = (425.4 / 388.3) ** 2 - 1
    expected = 100.0 + ((1 + ratio) * 600.0 * 1.0 - ratio * 600.0 * 0.5) / 3600.0
    north = result.sessions[0].gyro_north
    assert north is not None
    assert math.degrees(north.value) == pytest.approx(expected, abs=1e-9)
    # physics.md 2.2: se = (1 + lambda) mu 0.612 sigma_x, and the tape zero's own
    own = (1 + ratio) * 600.0 * math.sqrt(6) / 4 * 0.02
    assert north.sigma * RHO_ARCSEC > own
    assert north.sigma * RHO_ARCSEC == pytest.approx(own, rel=0.05)


def test_transit_method_by_hand(tmp_path: Path) -> None:
    # B = a sin(pi dt / 2 T2): a swing about +1 div of amplitude 8, T2 = 388 s
    period, middle, amplitude = 388.0, 1.0, 8.0
    phase = math.acos(-middle / amplitude) * period / (2 * math.pi)  # from a right turning point
    times = [phase, period - phase, period + phase]
    lines = ["clamp,100-00-00", f"scale_reversal,{middle + amplitude},,R"]
    book = rows(*lines).splitlines()
    for k, t in enumerate(times):
        book.append(f"{len(book)},,{100 + t:.4f},transit,0,,,,,,")
        if k < 2:
            side = -1 if k == 0 else 1
            letter = "R" if side > 0 else "L"
            book.append(f"{len(book)},,,scale_reversal,{middle + side * amplitude},,,{letter},,,")
    folder = write(tmp_path, clamped("transit"), {"run": "\n".join(book) + "\n"})
    result = api.orient(folder, estimator="transit").sessions[0]
    ratio = (425.4 / 388.3) ** 2 - 1
    assert result.gyro_north is not None
    expected = 100.0 + (1 + ratio) * 600.0 * middle / 3600.0
    assert math.degrees(result.gyro_north.value) == pytest.approx(expected, abs=2e-6)
    shown = {name: value for name, value, _ in result.quantities}
    # physics.md 1.4: the linear form is larger by (pi dt / 2 T2)^2 / 6 relative
    excess = shown["linear minus arcsine"] / middle
    turn = math.pi * shown["time difference east minus west"] / (2 * period)
    assert excess == pytest.approx(turn**2 / 6, rel=0.02)


@pytest.mark.parametrize(
    ("method", "book", "message"),
    [
        ("amplitude", ["scale_reversal,7", "scale_reversal,-5", "scale_reversal,7"], "clamped"),
        (
            "amplitude",
            ["clamp,100-00-00", "scale_reversal,40", "scale_reversal,-5", "scale_reversal,39"],
            "beyond the scale",
        ),
        ("amplitude", ["clamp,100-00-00", "scale_reversal,7"], "too few scale_reversal"),
        (
            "transit",
            ["clamp,100-00-00", "scale_reversal,7", "scale_reversal,-5", "scale_reversal,7"],
            "transit",
        ),
        (
            "amplitude",
            ["clamp,100-00-00", "clamp,102-00-00", "scale_reversal,7", "scale_reversal,-5"],
            "different readings",
        ),
    ],
)
def test_impossible_clamped_sessions(
    tmp_path: Path, method: str, book: list[str], message: str
) -> None:
    folder = write(tmp_path, clamped(method), {"run": rows(*book)})
    with pytest.raises(SurveyError, match=message):
        api.orient(folder)


def test_transit_without_times_and_out_of_order(tmp_path: Path) -> None:
    head = ["clamp,100-00-00", "scale_reversal,7"]
    without = rows(*head, "transit,0", "scale_reversal,-5", "transit,0", "scale_reversal,7")
    with pytest.raises(SurveyError, match="elapsed_s"):
        api.orient(write(tmp_path / "1", clamped("transit"), {"run": without}))
    lines = rows(*head).splitlines()
    for moment, reading in ((200.0, "-5"), (150.0, "7"), (300.0, "-5")):
        lines.append(f"{len(lines)},,{moment},transit,0,,,,,,")
        lines.append(f"{len(lines)},,,scale_reversal,{reading},,,,,,")
    with pytest.raises(SurveyError, match="elapsed_s"):
        api.orient(write(tmp_path / "2", clamped("transit"), {"run": "\n".join(lines) + "\n"}))


def test_card_with_t2_longer_than_t1_is_refused(tmp_path: Path) -> None:
    card = CARD.replace("tracking_s = 425.4", "tracking_s = 380.0")
    book = rows("reversal,99-00-00", "reversal,101-00-00", "reversal,99-00-10")
    with pytest.raises(SurveyError, match="380"):
        api.orient(write(tmp_path, clamped("tracking"), {"run": book}, card=card))


def test_card_whose_c_contradicts_its_periods_names_both_numbers(tmp_path: Path) -> None:
    # C for a half difference of the times is twice too large: 5.82 against 2.91 "/(div s)
    card = CARD + "[transit]\nc_arcsec_per_div_s = 5.82\n"
    book = rows("reversal,99-00-00", "reversal,101-00-00", "reversal,99-00-10")
    with pytest.raises(SurveyError, match=r"5\.82") as caught:
        api.orient(write(tmp_path, clamped("tracking"), {"run": book}, card=card))
    assert "2.91" in str(caught.value)


def test_card_of_47_degrees_used_far_away(tmp_path: Path) -> None:
    """The card's values are carried to the station: without it the azimuth would be off by 30"."""
    for latitude in (-26.0, 63.0):
        spec = SessionSpec(
            method="amplitude",
            latitude=math.radians(latitude),
            points=12,
            clamp_offset=480.0 * ARCSEC,
            tape_zero_div=(0.4, 0.4),
        )
        folder = tmp_path / str(latitude)
        project = simulate_reversal_project(
            spec,
            np.random.default_rng(4),
            calibrations=1,
            surveys=1,
            calibration_latitude=math.radians(47.0),
        )
        for name, text in project_files(project).items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        truth = json.loads(json.dumps(project_truth(project)["sessions"]))["run-1"]
        line = api.orient(folder).lines[0].to_dict()["true_azimuth"]
        error = (line["deg"] - truth["azimuth_deg"]) * 3600.0
        assert abs(error) < 4.0 * line["sigma_arcsec"]
        assert line["sigma_arcsec"] < 12.0


def test_two_clampings_confirm_the_torsion_ratio(tmp_path: Path) -> None:
    spec = SessionSpec(method="amplitude", points=12, clamp_offset=700.0 * ARCSEC)
    make(tmp_path, spec, 1, calibrations=0, surveys=1)
    other = replace(spec, clamp_offset=-700.0 * ARCSEC)
    second = simulate_reversal_project(other, np.random.default_rng(2), calibrations=0, surveys=1)
    book = project_files(second)["observations/run-1.csv"]
    (tmp_path / "observations" / "run-2.csv").write_text(book)
    toml = (tmp_path / "project.toml").read_text()
    start = toml.index("[[orientation]]")
    (tmp_path / "project.toml").write_text(toml + "\n" + toml[start:].replace("run-1", "run-2"))
    check = next(c for c in api.orient(tmp_path).checks if c.rule == "torsion_ratio.clampings")
    assert check.passed is True
    assert "0.20" in check.text
    wrong = (tmp_path / "cards" / "simulated-gyro.toml").read_text()
    (tmp_path / "cards" / "simulated-gyro.toml").write_text(
        wrong.replace("scale_value_arcsec = 600", "scale_value_arcsec = 630")
    )
    check = next(c for c in api.orient(tmp_path).checks if c.rule == "torsion_ratio.clampings")
    assert check.passed is False


def test_two_turning_points_are_a_pre_orientation(tmp_path: Path) -> None:
    book = rows("reversal,359-00-00", "reversal,5-00-00")
    result = api.orient(write(tmp_path, clamped("tracking"), {"run": book}))
    session = result.sessions[0]
    assert session.estimator == "two turning points"
    assert session.gyro_north is not None
    assert math.degrees(session.gyro_north.value) == pytest.approx(2.0)
    # A (1 - q) / 2 with A = 3 degrees, q = .98: 108"
    assert session.gyro_north.sigma * RHO_ARCSEC == pytest.approx(108.0, abs=0.5)
    assert any(w.code == "pre_orientation" for w in result.warnings)


def test_plan_promises_what_simulated_sessions_keep(tmp_path: Path) -> None:
    spec = SessionSpec(method="tracking", points=12, latitude=math.radians(55.0))
    make(tmp_path, spec, 3, calibrations=0, surveys=1)
    card = api.open_project(tmp_path).instruments[0].card
    plans = plan_methods(card, latitude=math.radians(55.0), wanted=5.0 * ARCSEC)
    tracking = next(item for item in plans if item.method == "tracking")
    assert tracking.enough
    assert tracking.minutes is not None
    sigmas = []
    for seed in range(12):
        folder = tmp_path / f"run-{seed}"
        make(folder, replace(spec, points=tracking.points), seed, calibrations=0, surveys=1)
        north = api.orient(folder).sessions[0].gyro_north
        assert north is not None
        sigmas.append(north.sigma)
    # the planned sigma is the root mean square of the achieved ones: chi-square, 12 runs of 3 dof
    ratio = float(np.sqrt(np.mean(np.square(sigmas)))) / tracking.sigma
    assert 0.55 < ratio < 1.45


def test_plan_refuses_an_interval_that_is_none(tmp_path: Path) -> None:
    make(tmp_path, SessionSpec(points=6), 3, calibrations=0, surveys=1)
    with pytest.raises(SurveyError, match="interval"):
        api.plan(tmp_path, interval_arcsec=0.0)
