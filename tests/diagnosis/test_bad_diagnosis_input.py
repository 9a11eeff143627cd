"""Bad input ends in a verdict or in an error that says what is missing, never in a number."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from surveyapp.diagnosis import CampaignDetermination, TurningPoints, diagnose
from surveyapp.diagnosis.subjects.campaign import campaign
from surveyapp.diagnosis.subjects.reversal_run import reversal_run
from surveyapp.errors import SurveyError
from surveyapp_models.angles import ARCSEC
from tests.diagnosis.measured_runs import gi_b1, johannesburg


def verdict_of(result_candidates: object, effect: str) -> tuple[str, str]:
    for item in result_candidates:  # type: ignore[attr-defined]
        if item.effect == effect:
            return item.verdict, item.reason
    raise AssertionError(effect)


def test_three_turning_points_are_refused() -> None:
    with pytest.raises(SurveyError, match="too few turning points"):
        reversal_run(johannesburg(3))


@pytest.mark.parametrize("count", [4, 5, 6, 7])
def test_few_turning_points_never_yield_a_name(count: int) -> None:
    result = diagnose(reversal_run(johannesburg(count)), draws=500)
    assert result.adopted == ()
    assert "no_names" in [w.code for w in result.warnings]
    json.dumps(result.to_dict(), allow_nan=False)


def test_equal_turning_points_are_refused() -> None:
    with pytest.raises(SurveyError, match="do not swing"):
        reversal_run(TurningPoints([1.0] * 8))


def test_two_points_on_one_side_are_refused() -> None:
    right = [k % 2 == 0 for k in range(20)]
    right[4] = not right[4]
    with pytest.raises(SurveyError, match="one side follow each other"):
        reversal_run(dataclasses.replace(johannesburg(), right=right))


def test_a_covariate_with_one_value_is_not_applicable() -> None:
    points = dataclasses.replace(johannesburg(), covariates={"temperature_c": [20.0] * 20})
    result = diagnose(reversal_run(points), draws=500)
    verdict, reason = verdict_of(result.candidates, "temperature")
    assert verdict == "not_applicable"
    assert "one value" in reason


def test_missing_temperatures_are_counted() -> None:
    theta = [20.0 + 0.1 * k for k in range(20)]
    theta[3] = theta[7] = float("nan")
    points = dataclasses.replace(johannesburg(), covariates={"temperature_c": theta})
    result = diagnose(reversal_run(points), draws=500)
    verdict, reason = verdict_of(result.candidates, "temperature")
    assert verdict == "not_applicable"
    assert "2 of 20" in reason
    json.dumps(result.to_dict(), allow_nan=False)


def test_a_second_set_of_another_instrument_is_refused() -> None:
    with pytest.raises(SurveyError, match="another instrument"):
        diagnose(reversal_run(johannesburg()), confirm=reversal_run(gi_b1()))


def test_no_times_is_said() -> None:
    result = diagnose(reversal_run(gi_b1()), draws=500)
    assert "no_times" in [w.code for w in result.warnings]


def test_a_campaign_needs_sigmas_when_it_is_short_and_all_or_none() -> None:
    with pytest.raises(SurveyError, match="no stated sigmas"):
        campaign([CampaignDetermination.at(0.0), CampaignDetermination.at(1e-5)])
    with pytest.raises(SurveyError, match="others have none"):
        campaign([CampaignDetermination.at(0.0, sigma=1e-5), CampaignDetermination.at(1e-5)])
    with pytest.raises(SurveyError, match="too few determinations"):
        campaign([CampaignDetermination.at(0.0, sigma=1e-5)])


def test_tongjin_two_constants_are_not_separable() -> None:
    # Printed constants of the two surface lines, three rounds each of at most 5 arcsec.
    sigma = 5.0 / np.sqrt(3.0) * ARCSEC
    result = diagnose(
        campaign(
            [
                CampaignDetermination.at(
                    -9.72 * ARCSEC, sigma=sigma, order=1.0, line="G3007-G3006"
                ),
                CampaignDetermination.at(
                    -24.27 * ARCSEC, sigma=sigma, order=2.0, line="G3024-G3022"
                ),
            ],
            instrument="HGG05 15001",
        )
    )
    assert result.adopted == ()
    assert result.verdict == "not_separable"
    assert set(result.ambiguous[0].any_of) == {"line_offset", "transport_step", "time_drift"}
    assert "first line" in result.ambiguous[0].separate_by
    assert "opposite order" in result.ambiguous[0].separate_by
    # What is unattributed widens sigma: half of 14.55 arcsec, not 5 / sqrt(6).
    assert result.averaged.sigma == pytest.approx(14.55 / 2.0 * ARCSEC, rel=1e-6)
    json.dumps(result.to_dict(), allow_nan=False)


def test_tongjin_agrees_when_its_sigmas_are_large() -> None:
    determinations = [
        CampaignDetermination.at(-9.72 * ARCSEC, sigma=15.0 * ARCSEC, order=1.0, line="a"),
        CampaignDetermination.at(-24.27 * ARCSEC, sigma=15.0 * ARCSEC, order=2.0, line="b"),
    ]
    assert diagnose(campaign(determinations)).verdict == "adequate"
