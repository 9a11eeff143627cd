"""The simulated campaign: every effect sits where its physics puts it, and the project is read."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp.core.orientation.campaign_columns import block_names
from surveyapp.core.simulate.campaign import (
    CAMPAIGN_EFFECTS,
    CampaignSpec,
    SimulatedCampaign,
    simulate_campaign,
)
from surveyapp.core.simulate.campaign_project import campaign_files
from surveyapp.core.simulate.kinds import KINDS, simulate_kind
from surveyapp.core.simulate.specification import Effect, parse_effect
from surveyapp.errors import SurveyError
from surveyapp.io.project import read_project
from surveyapp_models.angles import (
    ARCSEC,
    AngleUnit,
    circular_mean,
    parse_angle,
    wrap_pi,
    wrap_pi_array,
)


def quiet(*texts: str, **changes: Any) -> SimulatedCampaign:
    effects: tuple[Effect, ...] = tuple(parse_effect(text, CAMPAIGN_EFFECTS) for text in texts)
    spec = CampaignSpec(sigma_round=0.0, sigma_sight=0.0, effects=effects, **changes)
    return simulate_campaign(spec, np.random.default_rng(11))


def residual(made: SimulatedCampaign) -> np.ndarray:
    """Observed constant minus the undisturbed one; circle readings are rounded to 0.1"."""
    return wrap_pi_array(made.constant - made.spec.constant) / ARCSEC


def test_without_effects_the_constant_is_constant() -> None:
    assert np.max(np.abs(residual(quiet()))) < 0.15


def test_effects_of_the_instrument() -> None:
    made = quiet("temperature=1.5")
    assert np.allclose(residual(made), 1.5 * (made.temperature_c - 12.0), atol=0.15)
    assert np.ptp(made.temperature_c) > 10.0
    made = quiet("latitude=30")
    assert np.allclose(residual(made), 30.0 / np.cos(made.latitude), atol=0.15)
    made = quiet("time_drift=0.1")
    assert np.allclose(residual(made), 0.1 * made.elapsed_days, atol=0.15)
    made = quiet("transport_step=25,at=0.5")
    assert np.all((np.abs(residual(made)) < 0.15) | (np.abs(residual(made) - 25) < 0.15))
    assert np.all(np.diff(residual(made)) > -0.3)
    made = quiet("warm_up=40,tau_s=900")
    assert np.allclose(residual(made), 40 * np.exp(-made.running_s / 900.0), atol=0.15)
    made = quiet("gyro_block=20")
    hit = np.abs(residual(made) - 20) < 0.2
    assert set(made.block[hit]) == {int(made.drawn["gyro_block.block"])}
    assert hit.sum() >= 2


def test_circle_eccentricity_enters_through_both_readings() -> None:
    made = quiet("circle_eccentricity=10,phase=30")
    line, north = made.line_reading[:, 0, 0], made.north_reading[:, 0]
    expected = 10 * np.cos(math.radians(30)) * (np.sin(north) - np.sin(line))
    expected += 10 * np.sin(math.radians(30)) * (np.cos(north) - np.cos(line))
    assert np.allclose(residual(made), expected, atol=0.15)
    assert np.allclose(made.true_constant, made.spec.constant)


def test_line_offset_is_in_the_known_azimuth_only() -> None:
    made = quiet("line_offset=15,line=1")
    assert np.allclose(residual(made), np.where(made.line == 1, 15.0, 0.0), atol=0.15)
    assert np.allclose(made.true_constant, made.spec.constant)


@pytest.mark.statistical
def test_sigma_is_that_of_the_determination() -> None:
    spec = CampaignSpec(determinations=1500, surveys=0)
    made = simulate_campaign(spec, np.random.default_rng(3))
    score = wrap_pi_array(made.constant - made.true_constant) / made.sigma
    assert np.var(score) == pytest.approx(1.0, abs=4 * math.sqrt(2 / 1500))
    spec = CampaignSpec(
        determinations=1500,
        sigma_round=0.0,
        sigma_sight=0.0,
        effects=(parse_effect("autoregressive=5,rho=0.6", CAMPAIGN_EFFECTS),),
    )
    noise = residual(simulate_campaign(spec, np.random.default_rng(3)))
    assert np.std(noise) == pytest.approx(5.0, rel=0.12)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(0.6, abs=0.07)


@pytest.mark.parametrize("kind", ["reversal-run", "campaign"])
def test_simulated_projects_are_read_without_a_word(kind: str, tmp_path: Path) -> None:
    texts = [
        f"{effect.id}={0.001 if effect.to_internal == 1.0 else 3}"
        for effect in KINDS[kind]
        if effect.id != "one_sided_lag"
    ]
    files, truth = simulate_kind(kind, effects=texts, seed=5)
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    project = read_project(tmp_path)
    assert {session.id for session in project.sessions} == set(truth["sessions"])
    assert not project.warnings
    again, _ = simulate_kind(kind, effects=texts, seed=5)
    assert again == files
    for session in project.sessions:
        known = session.azimuth_known
        assert (known is None) == (session.purpose == "survey")
        if known is not None:
            stated = math.radians(truth["sessions"][session.id]["azimuth_deg"])
            station = (
                f"K{int(truth['drawn']['line_offset.line']) + 1}A" if kind == "campaign" else ""
            )
            offset = 3.0 * ARCSEC if session.station == station else 0.0
            assert wrap_pi(known - stated) == pytest.approx(offset, abs=2e-3 * ARCSEC)


def test_books_of_a_campaign_hold_its_determinations() -> None:
    spec = CampaignSpec(
        determinations=12, effects=(parse_effect("temperature=2", CAMPAIGN_EFFECTS),)
    )
    made = simulate_campaign(spec, np.random.default_rng(4))
    books = [text for name, text in campaign_files(made).items() if name.startswith("observ")]
    for index, text in enumerate(books):
        rows = list(csv.DictReader(io.StringIO(text)))
        north = [parse_angle(r["value"], AngleUnit.DMS) for r in rows if r["kind"] == "north"]
        sights = [
            parse_angle(r["value"], AngleUnit.DMS) - (math.pi if r["face"] == "R" else 0.0)
            for r in rows
            if r["kind"] == "backsight"
        ]
        gyro_azimuth = circular_mean(sights) - circular_mean(north)
        observed = wrap_pi(float(made.azimuth_known[index]) - gyro_azimuth)
        assert observed == pytest.approx(wrap_pi(float(made.constant[index])), abs=0.01 * ARCSEC)
        assert len(north) == made.rounds[index]
        middle = [float(r["elapsed_s"]) for r in rows if r["kind"] == "north"]
        assert np.mean(middle) == pytest.approx(made.running_s[index], abs=0.1)


def test_all_wrong_effects_are_named_together() -> None:
    with pytest.raises(SurveyError) as caught:
        simulate_kind("campaign", effects=["temprature=1", "time_drift=x"], seed=1)
    assert len(caught.value.problems) == 2
    with pytest.raises(SurveyError, match="reversal-run"):
        simulate_kind("reversal_run", effects=[], seed=1)


def test_a_block_of_work_goes_on_over_midnight_and_ends_with_a_pause() -> None:
    # 22:00, 23:30, 00:30 and 02:00 are one night shift; 09:00 begins a new block, 23:00 another.
    hours = (22.0, 23.5, 24.5, 26.0, 33.0, 34.0, 47.0)
    names = block_names([16000.0 + hour / 24.0 for hour in hours])
    assert names == ["day 16000"] * 4 + ["day 16001"] * 2 + ["day 16001 b"]
    assert block_names([None, 16000.9, None]) == ["", "day 16000", ""]
