"""The Curtin baseline: reduction, constant, cyclic term and the atmosphere trap."""

from __future__ import annotations

import csv
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.edm import (
    EdmReading,
    first_velocity_ppm,
    fit_baseline,
    horizontal_lengths,
    judge_atmosphere,
    judge_terms,
)

SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[3] / "shared" / "data"))
FOLDER = SHARED / "edm_baseline_curtin"
STEM = "CURT_baseline_calibration_"

measured = [
    pytest.mark.shared_data,
    pytest.mark.skipif(not FOLDER.is_dir(), reason="the measured baseline is not here"),
]


def rows(name: str) -> list[dict[str, str]]:
    with (FOLDER / f"{STEM}{name}.csv").open(encoding="utf-8-sig") as stream:
        return list(csv.DictReader(stream))


def curtin() -> list[EdmReading]:
    level = {r["pillar_name"]: float(r["pillar_rl"]) for r in rows("level_observation")}
    return [
        EdmReading(
            r["from_pillar"],
            r["to_pillar"],
            float(r["slope_distance"]),
            level[r["from_pillar"]] + float(r["height_of_instrument"]),
            level[r["to_pillar"]] + float(r["height_of_target"]),
            float(r["temperature"]),
            float(r["pressure"]),
            float(r["humidity"]),
        )
        for r in rows("edm_observation")
    ]


class TestCurtin:
    pytestmark = measured

    def test_the_published_sequence_of_rms_values(self) -> None:
        readings = curtin()
        assert len(readings) == 457
        flat = fit_baseline(readings, horizontal_lengths(readings, reduce=False))
        reduced = fit_baseline(readings, horizontal_lengths(readings))
        cyclic = fit_baseline(
            readings, horizontal_lengths(readings), constant=True, cyclic_unit_m=1.5
        )
        assert flat.sigma0_m * 1e3 == pytest.approx(1.944, abs=5e-4)
        assert reduced.sigma0_m * 1e3 == pytest.approx(0.390, abs=5e-4)
        assert cyclic.sigma0_m * 1e3 == pytest.approx(0.384, abs=6e-4)

    def test_the_constant_is_there_with_its_sigma_and_is_not_significant(self) -> None:
        readings = curtin()
        lengths = horizontal_lengths(readings)
        value, sigma = fit_baseline(readings, lengths, constant=True).term("constant")
        assert value * 1e3 == pytest.approx(-0.044, abs=1e-3)
        assert sigma * 1e3 == pytest.approx(0.035, abs=1e-3)
        assert not judge_terms(readings, lengths).significant

    def test_the_cyclic_term_does_not_survive_the_means_of_the_sights(self) -> None:
        readings = curtin()
        verdict = judge_terms(readings, horizontal_lengths(readings), cyclic_unit_m=1.5)
        assert 0.05e-3 < verdict.amplitude_m < 0.2e-3
        assert 0.05e-3 < verdict.sigma_m < 0.1e-3
        assert not verdict.significant

    def test_the_atmosphere_must_not_be_applied_twice(self) -> None:
        verdict = judge_atmosphere(curtin())
        assert verdict.as_read_m * 1e3 == pytest.approx(0.390, abs=5e-4)
        assert verdict.corrected_m * 1e3 == pytest.approx(1.101, abs=5e-4)
        assert verdict.verdict == "already_applied"


def simulated(
    seed: int, *, cyclic_m: float = 0.0, applied: bool = True, constant_m: float = 0.0
) -> list[EdmReading]:
    rng = np.random.default_rng(seed)
    places = np.array([0.0, 22.4, 87.9, 230.1, 401.3, 640.6])
    readings = []
    for i in range(len(places)):
        for j in range(len(places)):
            if i == j:
                continue
            true = float(abs(places[j] - places[i]))
            weather = EdmReading(
                str(i), str(j), true, 0.0, 0.0, float(rng.uniform(5, 30)), 1000.0, 50.0
            )
            ppm = 0.0 if applied else first_velocity_ppm(weather)
            phase = 2.0 * np.pi * true / 1.5
            shared = rng.normal(0.0, 0.3e-3)  # centring and weather of the sight
            readings += [
                replace(
                    weather,
                    slope_m=float(
                        (true + shared + constant_m + cyclic_m * np.sin(phase)) / (1 + ppm * 1e-6)
                        + rng.normal(0.0, 0.1e-3)
                    ),
                )
                for _ in range(5)
            ]
    return readings


@pytest.mark.statistical
def test_a_cyclic_term_is_rarely_found_where_there_is_none() -> None:
    found = sum(
        judge_terms(r := simulated(seed), horizontal_lengths(r), cyclic_unit_m=1.5).significant
        for seed in range(200)
    )
    # binomial(200, 0.05): 99.9 % of the mass lies below 22
    assert found < 22


def test_a_large_cyclic_term_and_a_constant_are_found() -> None:
    readings = simulated(1, cyclic_m=1.5e-3, constant_m=2e-3)
    lengths = horizontal_lengths(readings)
    cyclic = judge_terms(readings, lengths, cyclic_unit_m=1.5)
    assert cyclic.significant
    assert cyclic.amplitude_m == pytest.approx(1.5e-3, abs=4 * cyclic.sigma_m)
    assert judge_terms(readings, lengths).significant


@pytest.mark.parametrize(
    ("applied", "verdict"), [(True, "already_applied"), (False, "not_applied")]
)
def test_the_atmosphere_verdict_tells_both_cases(applied: bool, verdict: str) -> None:
    assert judge_atmosphere(simulated(5, applied=applied)).verdict == verdict
