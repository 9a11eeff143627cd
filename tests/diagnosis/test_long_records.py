"""Records of many thousand samples: block means, spectral lines, and what is refused."""

from __future__ import annotations

import dataclasses
import json
import os
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from bench._long_records import (
    BEARING,
    NOISES,
    RAMP,
    SAMPLES,
    STEP_S,
    TEMPERATURE,
    TONE,
    autoregressive,
    flicker,
    rate_log,
    walk,
    white,
)
from surveyapp.diagnosis import CampaignDetermination, TurningPoints, diagnose
from surveyapp.diagnosis.long_records.blocks import block_means, runs_of, split
from surveyapp.diagnosis.long_records.lines import find_lines
from surveyapp.diagnosis.long_records.record import LONG, reduce_record
from surveyapp.diagnosis.long_records.spectrum import exceedance, median_bias, spectrum
from surveyapp.diagnosis.long_records.whiteness import whiteness
from surveyapp.diagnosis.plain_words import plain_words
from surveyapp.diagnosis.subjects.campaign import campaign
from surveyapp.diagnosis.subjects.reversal_run import reversal_run
from surveyapp.errors import SurveyError
from surveyapp.report.sections.diagnosis import blocks as report_blocks
from surveyapp_models.angles import ARCSEC, AngleUnit
from surveyapp_models.arrays import Floats

SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[2] / "../shared/data"))
STATIC = SHARED / "mpu6050_static" / "example_data_static_449s.csv"
DRAWS = 1000


def seconds(count: int) -> Floats:
    return np.asarray(STEP_S * np.arange(count), dtype=np.float64)


def most(runs: int, share: float = 0.05) -> int:
    """Count that is exceeded once in a thousand such trials."""
    return int(stats.binom.ppf(0.999, runs, share))


def codes(result: object) -> set[str]:
    return {w.code for w in result.warnings}  # type: ignore[attr-defined]


# --- the parts ---------------------------------------------------------------------------------


def test_the_bias_of_the_median_is_that_of_drawn_exponentials() -> None:
    g = np.random.default_rng(1)
    for window in (5, 61):
        drawn = np.median(g.exponential(size=(40_000, window)), axis=1)
        assert median_bias(window) == pytest.approx(drawn.mean(), abs=5.0 * drawn.std() / 200.0)


def test_the_tail_beside_a_median_is_that_of_drawn_exponentials() -> None:
    g = np.random.default_rng(2)
    window, runs = 11, 400_000
    drawn = g.exponential(size=(runs, window))
    ratio = drawn[:, 0] / np.median(drawn, axis=1) * median_bias(window)
    for level in (4.0, 8.0, 14.0):
        p = float(exceedance(np.array(level), window))
        assert np.mean(ratio >= level) == pytest.approx(p, abs=5.0 * np.sqrt(p / runs))


@pytest.mark.statistical
@pytest.mark.parametrize("kind", NOISES)
@pytest.mark.parametrize("n", [1001, 8000])
def test_the_highest_peak_of_noise_is_a_false_alarm_as_often_as_stated(kind: str, n: int) -> None:
    g = np.random.default_rng(3)
    runs = 300
    filled = np.ones(n, dtype=bool)
    u = np.linspace(-1.0, 1.0, n)
    least = []
    for _ in range(runs):
        y = NOISES[kind](n, g)
        y = y - np.polynomial.polynomial.polyval(u, np.polynomial.polynomial.polyfit(u, y, 1))
        least.append(spectrum(y, filled).false_alarm().min())
    for level in (0.05, 0.2, 0.5):
        assert np.sum(np.array(least) <= level) <= most(runs, level)
        assert np.sum(np.array(least) <= level) >= stats.binom.ppf(0.001, runs, 0.6 * level)


@pytest.mark.statistical
def test_white_block_means_are_called_white_at_the_stated_level() -> None:
    g = np.random.default_rng(4)
    ones = np.ones((100, 1))
    root = np.sqrt(g.integers(100, 500, 100) / 300.0)
    p = [whiteness(g.standard_normal(100) / root, ones, root, seed).p for seed in range(60)]
    assert stats.kstest(p, "uniform").pvalue > 1e-3


@pytest.mark.parametrize("change", [0.0, 1e3])
def test_no_drift_step_or_warm_up_is_taken_for_correlation(change: float) -> None:
    g = np.random.default_rng(5)
    x = np.arange(200.0)
    shape = change * (x + (x > 70.0) + np.exp(-x / 40.0))
    p = [
        whiteness(g.standard_normal(200) + shape, np.ones((200, 1)), np.ones(200), seed).p
        for seed in range(20)
    ]
    assert np.sum(np.array(p) <= 0.05) <= most(20)


def test_block_means_keep_the_value_and_its_sigma() -> None:
    g = np.random.default_rng(6)
    y = 3.0 + white(12_345, g)
    problem = rate_log(y)
    blocks = split(problem.position, runs_of(problem), 100)
    means = block_means(problem, blocks)
    assert means.size == 100
    assert blocks.counts.sum() == y.size
    result = diagnose(problem, draws=DRAWS)
    assert result.before.value.value == pytest.approx(y.mean(), abs=1e-12)
    assert result.averaged.value == pytest.approx(y.mean(), abs=1e-3)
    assert result.before.value.sigma == pytest.approx(1.0 / np.sqrt(y.size), rel=0.25)


def test_short_blocks_weigh_by_their_samples() -> None:
    g = np.random.default_rng(7)
    n = 20_000
    t = seconds(n)
    keep = (t < 60.0) | ((t > 100.3) & (g.random(n) < 0.4))
    problem = rate_log(white(n, g)[keep], t[keep])
    means = block_means(problem, split(problem.position, runs_of(problem), 80))
    assert means.weighted
    assert means.sigma is not None
    counts = (means.sigma**-2).round()
    assert counts.sum() == keep.sum()
    assert np.ptp(counts) > 0
    weighted = float(np.sum(counts * means.observations) / np.sum(counts))
    assert weighted == pytest.approx(problem.observations.mean(), abs=1e-12)


def test_rounding_stays_where_noise_does_not_dither_it() -> None:
    g = np.random.default_rng(8)
    for noise, stays in ((0.02, True), (1.0, False)):
        y = np.round(0.3 + noise * white(50_000, g))
        y[::2] += 0.0
        y[0] = 1.0
        problem = rate_log(y, resolution=1.0)
        means = block_means(problem, split(problem.position, runs_of(problem), 200))
        expected = 1.0 if stays else 1.0 / np.sqrt(250.0)
        assert means.resolution == pytest.approx(expected, rel=0.02)


# --- false alarms and detection ------------------------------------------------------------------


@pytest.mark.statistical
@pytest.mark.parametrize("kind", NOISES)
def test_noise_of_any_kind_is_no_named_drift(kind: str) -> None:
    g = np.random.default_rng(9)
    runs = 8  # of fewer samples than ``make bench`` has: they are as many blocks
    results = [diagnose(rate_log(NOISES[kind](30_000, g)), draws=DRAWS) for _ in range(runs)]
    assert sum(bool(r.adopted) for r in results) <= most(runs)
    assert sum(bool(r.lines) for r in results) <= most(runs)
    if kind == "white and random walk":
        assert {r.verdict for r in results} <= {"unattributed", "not_separable"}
    if kind in ("white", "AR(1) .9"):
        fired = sum(r.ledger["gates"][0]["p_family"] <= 0.05 for r in results)
        assert fired <= most(runs)


@pytest.mark.parametrize("noise", [white, autoregressive])
def test_a_true_drift_is_named_with_its_size(noise: object) -> None:
    g = np.random.default_rng(10)
    y = noise(SAMPLES, g)  # type: ignore[operator]
    density = 10.0 if noise is autoregressive else 1.0
    t = STEP_S * np.arange(SAMPLES)
    slope = 15.0 * density * np.sqrt(12.0 / SAMPLES) / (t[-1] / 3600.0)
    result = diagnose(rate_log(y + slope * (t - t.mean()) / 3600.0), draws=DRAWS)
    assert [item.effect for item in result.adopted] == ["bias_ramp"]
    found = result.adopted[0].coefficients[0]
    assert found.sigma is not None
    assert abs(found.value - slope) < 4.0 * found.sigma
    assert found.sigma == pytest.approx(slope / 15.0, rel=0.3)
    assert result.verdict == "explained"
    assert "block_means" in codes(result)


def test_a_walk_that_is_slower_than_fifty_blocks_ends_unnamed() -> None:
    g = np.random.default_rng(11)
    results = [diagnose(rate_log(walk(30_000, g, 100.0)), draws=DRAWS) for _ in range(6)]
    assert all(result.adopted == () for result in results)
    assert {result.verdict for result in results} <= {"unattributed", "not_separable"}
    red = [result for result in results if "blocks_not_white" in codes(result)]
    assert len(red) >= 4  # fifty blocks show it nineteen times of twenty
    assert not red[0].ledger["blocks"]["white"]
    assert [t["blocks"] for t in red[0].ledger["blocks"]["whiteness"]][-1] == 50
    assert "still correlated" in " ".join(plain_words(red[0], (RAMP,)))


# --- lines ---------------------------------------------------------------------------------------


def with_line(g: np.random.Generator, noise: Floats, amplitude: float, frequency: float) -> Floats:
    t = STEP_S * np.arange(noise.size)
    return np.asarray(noise + amplitude * np.cos(2.0 * np.pi * frequency * t + 6.0 * g.random()))


@pytest.mark.statistical
@pytest.mark.parametrize(("noise", "size"), [(white, 0.3), (flicker, 0.6)])
def test_a_line_is_found_with_its_frequency_and_amplitude(noise: object, size: float) -> None:
    g = np.random.default_rng(12)
    off = []
    for _ in range(30):
        y = with_line(g, noise(20_000, g), size, 7.137)  # type: ignore[operator]
        found = find_lines(seconds(y.size), y - y.mean(), columns={}, effects=[])
        line = min(found.lines, key=lambda item: abs(item.frequency - 7.137))
        off.append(
            (
                (line.frequency - 7.137) / line.sigma_frequency,
                (line.amplitude - size) / line.sigma_amplitude,
            )
        )
        assert line.false_alarm < 1e-3
    # bounds of chi square: the background that sigma comes from is good to a tenth
    for z in np.array(off).T:
        assert stats.chi2.ppf(0.0005, 30) / 1.3 < np.sum(z**2) < 1.3 * stats.chi2.ppf(0.9995, 30)


def test_a_slow_line_is_told_and_is_taken_out_of_the_blocks() -> None:
    g = np.random.default_rng(13)
    y = with_line(g, white(SAMPLES, g), 0.2, 0.137)
    result = diagnose(rate_log(y), draws=DRAWS)
    assert len(result.lines) == 1
    line = result.lines[0]
    assert abs(line.frequency - 0.137) < 4.0 * line.sigma_frequency
    assert abs(line.amplitude - 0.2) < 4.0 * line.sigma_amplitude
    assert result.verdict == "unattributed"
    assert result.adopted == ()
    assert result.before.value.value == pytest.approx(y.mean(), abs=1e-12)
    assert result.before.rms == pytest.approx(np.sqrt(200.0 / SAMPLES), rel=0.25)
    told = result.to_dict()
    assert told["lines"][0]["frequency_unit"] == "Hz"
    assert told["lines"][0]["effect"] is None
    json.dumps(told, allow_nan=False)
    json.dumps(result.ledger, allow_nan=False)
    words = plain_words(result, (RAMP,))
    assert any("0.137" in text and "no known cause" in text for text in words)
    section = report_blocks(result, words, {}, unit=AngleUnit.DMS)
    assert any("Spectral lines" in getattr(block, "text", "") for block in section)
    assert any("unattributed" in str(getattr(block, "rows", "")) for block in section)


def test_a_strong_line_is_one_line_and_hides_no_weak_one() -> None:
    g = np.random.default_rng(14)
    y = with_line(g, white(SAMPLES, g), 300.0, 12.4804)
    y = with_line(g, y, 0.05, 12.9)
    found = find_lines(seconds(y.size), y - y.mean(), columns={}, effects=[])
    assert [round(line.frequency, 3) for line in found.lines] == [12.48, 12.9]


def test_a_line_of_the_catalogue_gets_its_name() -> None:
    g = np.random.default_rng(15)
    y = with_line(g, white(SAMPLES, g), 0.2, 0.137)
    result = diagnose(rate_log(y, effects=(RAMP, TONE)), draws=DRAWS)
    assert result.lines[0].effect == "interference_line"
    assert result.verdict == "explained"
    verdicts = {c.effect: c.verdict for c in result.candidates}
    assert verdicts["interference_line"] == "candidate"


def test_a_line_that_the_temperature_has_too_is_left_to_it() -> None:
    g = np.random.default_rng(16)
    t = STEP_S * np.arange(SAMPLES)
    theta = 20.0 + np.sin(2.0 * np.pi * 0.05 * t) + 0.02 * white(SAMPLES, g)
    y = 0.1 * (theta - 20.0) + white(SAMPLES, g)
    effects = (RAMP, TEMPERATURE)
    result = diagnose(rate_log(y, effects=effects, columns={"temperature_c": theta}), draws=DRAWS)
    assert result.lines[0].shared_with == "temperature_c"
    assert [item.effect for item in result.adopted] == ["temperature"]
    found = result.adopted[0].coefficients[0]
    assert found.sigma is not None
    assert abs(found.value - 0.1) < 4.0 * found.sigma


# --- what records are like -----------------------------------------------------------------------


def test_a_gap_and_missing_values_are_said_and_do_no_harm() -> None:
    g = np.random.default_rng(17)
    t = STEP_S * np.arange(SAMPLES)
    slope = 30.0 * np.sqrt(12.0 / SAMPLES) / t[-1]
    y = white(SAMPLES, g) + slope * t
    y[500:700] = np.nan
    y[90_000] = np.inf
    keep = (t < 300.0) | (t > 480.0)
    clock = t.copy()
    clock[60_000] = np.nan
    result = diagnose(rate_log(y[keep], np.asarray(clock[keep], dtype=np.float64)), draws=DRAWS)
    assert [item.effect for item in result.adopted] == ["bias_ramp"]
    assert "202 samples" in next(w.text for w in result.warnings if w.code == "missing_samples")
    json.dumps(result.to_dict(), allow_nan=False)


def test_uneven_samples_are_blocked_in_time_and_have_no_spectrum() -> None:
    g = np.random.default_rng(18)
    t = np.cumsum(g.exponential(1.0, 20_000))
    result = diagnose(rate_log(white(t.size, g), t), draws=DRAWS)
    assert "no_spectrum" in codes(result)
    assert result.lines == ()
    assert result.verdict == "adequate"


def test_a_record_out_of_order_gives_the_same_blocks() -> None:
    g = np.random.default_rng(19)
    problem = rate_log(white(5000, g))
    mixed = g.permutation(5000)
    turned = dataclasses.replace(
        problem,
        observations=problem.observations[mixed],
        position=problem.position[mixed],
        columns={k: v[mixed] for k, v in problem.columns.items()},
    )
    one, two = reduce_record(problem).problem, reduce_record(turned).problem
    np.testing.assert_array_equal(one.observations, two.observations)


def test_fewer_than_fifty_blocks_are_refused() -> None:
    g = np.random.default_rng(20)
    problem = rate_log(white(5000, g))
    with pytest.raises(SurveyError, match="too few blocks"):
        block_means(problem, split(problem.position, runs_of(problem), 49))
    few = rate_log(white(5000, g), np.repeat(np.arange(40.0), 125))
    with pytest.raises(SurveyError, match="at least 50"):
        diagnose(few)


def test_a_record_that_stands_still_is_refused() -> None:
    with pytest.raises(SurveyError, match="does not vary"):
        diagnose(rate_log(np.full(5000, 3.1)))


def test_a_record_of_nothing_but_missing_values_is_refused() -> None:
    y = np.full(5000, np.nan)
    y[:40] = np.arange(40.0)
    with pytest.raises(SurveyError, match="too few samples that are numbers"):
        diagnose(rate_log(y))


def test_a_long_swing_is_refused() -> None:
    k = np.arange(float(LONG + 1))
    y = 1.0 + 0.017 * (-1.0) ** k + 1e-5 * np.random.default_rng(1).standard_normal(k.size)
    with pytest.raises(SurveyError, match="too many turning points"):
        diagnose(reversal_run(TurningPoints(list(y))))


# --- campaigns -----------------------------------------------------------------------------------


def determinations(n: int, lines: list[str], g: np.random.Generator) -> list[CampaignDetermination]:
    return [
        CampaignDetermination.at(
            5.0 * ARCSEC * g.standard_normal() + (12.0 * ARCSEC if line == "B" else 0.0),
            sigma=(4.0 + 2.0 * g.random()) * ARCSEC,
            elapsed_days=float(i),
            line=line,
        )
        for i, line in zip(range(n), lines, strict=True)
    ]


def test_a_campaign_is_blocked_within_its_lines() -> None:
    g = np.random.default_rng(21)
    made = determinations(900, ["A"] * 300 + ["B"] * 200 + ["A"] * 400, g)
    problem = campaign(made)
    record = reduce_record(problem)
    assert set(record.problem.columns["line"]) == {0.0, 1.0}
    result = diagnose(problem, draws=DRAWS)
    assert [item.effect for item in result.adopted] == ["line_offset"]
    assert "finer_than_blocks" in codes(result)  # every determination had a day of its own
    value = np.average(problem.observations, weights=problem.value_weights)
    assert result.before.value.value - problem.offset == pytest.approx(value, abs=1e-15)


def test_lines_in_turn_cannot_be_blocked() -> None:
    g = np.random.default_rng(22)
    with pytest.raises(SurveyError, match="change too often"):
        diagnose(campaign(determinations(900, ["A", "B"] * 450, g)))


def test_an_effect_of_what_varies_within_a_block_is_not_applicable() -> None:
    g = np.random.default_rng(23)
    bearing = 2.0 * np.pi * g.random(5000)
    problem = rate_log(white(5000, g), effects=(RAMP, BEARING), columns={"bearing": bearing})
    result = diagnose(problem, draws=DRAWS)
    item = next(c for c in result.candidates if c.effect == "bearing")
    assert item.verdict == "not_applicable"
    assert "within a block" in item.reason
    slow = 1e-3 * np.arange(5000.0) % (2.0 * np.pi)
    smooth = dataclasses.replace(problem, columns={**problem.columns, "bearing": slow})
    assert "bearing" in {e.id for e in reduce_record(smooth).problem.effects}


def test_short_records_are_diagnosed_as_before() -> None:
    g = np.random.default_rng(24)
    result = diagnose(rate_log(white(LONG, g)), draws=300)
    assert len(result.residuals_before) == LONG
    assert result.lines == ()
    assert result.to_dict()["lines"] == []
    assert "block_means" not in codes(result)
    assert "blocks" not in result.ledger


# --- cost ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [100_000, 1_000_000])
def test_a_long_record_takes_seconds_and_bounded_memory(n: int) -> None:
    g = np.random.default_rng(25)
    problem = rate_log(with_line(g, white(n, g), 0.2, 0.137))
    begin = time.process_time()
    diagnose(problem)
    assert time.process_time() - begin < 5.0
    tracemalloc.start()
    reduce_record(problem)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 200.0 * n + 100e6


@pytest.mark.shared_data
@pytest.mark.skipif(not STATIC.exists(), reason="the measured records are not there")
def test_a_measured_record_of_a_sensor_at_rest() -> None:
    counts = np.loadtxt(STATIC, delimiter=",", skiprows=5)
    unit = 3600.0 / 131.0
    found = {}
    for column, axis in ((3, "x"), (4, "y"), (5, "z")):
        problem = rate_log(counts[:, column] * unit, resolution=unit)
        found[axis] = diagnose(problem, draws=DRAWS)
    # the makers' record: a hum folded to 31 and 38 Hz, and a z axis that still drifts
    assert found["x"].lines == ()
    assert {round(line.frequency) for line in found["y"].lines} == {38}
    assert {round(line.frequency) for line in found["z"].lines} == {31}
    assert all(r.verdict in ("unattributed", "not_separable") for r in found.values())
    assert found["y"].verdict == "unattributed"
    assert [item.effect for item in found["z"].adopted] == ["bias_ramp"]
