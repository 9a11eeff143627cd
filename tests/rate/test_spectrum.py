"""Interference lines: families that hold their false-alarm probability, and what they do not do."""

from __future__ import annotations

import numpy as np
import pytest

from surveyapp.diagnosis.long_records.averaged import averaged_spectrum
from surveyapp.diagnosis.long_records.families import strongest_family
from surveyapp.diagnosis.long_records.interference import find_interference, scatter_of
from surveyapp.diagnosis.long_records.lines import detrended
from surveyapp.diagnosis.long_records.spectrum import spectrum
from surveyapp_models.arrays import Floats

RATE_HZ = 100.0
FUNDAMENTAL_HZ = 12.48


def record(seed: int, *, amplitude: float, count: int = 6000, background: str = "white") -> Floats:
    rng = np.random.default_rng(seed)
    values = rng.normal(0.0, 1.0, count)
    if background == "red":
        for k in range(1, count):
            values[k] += 0.7 * values[k - 1]
        values /= float(np.std(values))
    t = np.arange(count) / RATE_HZ
    for h in (1, 2, 3):
        phase = rng.uniform(0.0, 6.28)
        values += amplitude * np.cos(2.0 * np.pi * FUNDAMENTAL_HZ * h * t + phase)
    return values


def family_p(values: Floats) -> float:
    u = np.arange(values.size) / values.size - 0.5
    found = strongest_family(spectrum(detrended(u, values), np.ones(values.size, dtype=bool)))
    assert found is not None
    return found[2]


@pytest.mark.parametrize("background", ["white", "red"])
def test_noise_has_a_family_as_rarely_as_stated(background: str) -> None:
    """300 records; the upper bounds are binomial at 1e-3."""
    p = [family_p(record(k, amplitude=0.0, background=background)) for k in range(300)]
    assert sum(v <= 0.05 for v in p) <= 28
    assert sum(v <= 0.01 for v in p) <= 10


@pytest.mark.parametrize(("amplitude", "least"), [(0.2, 0.99), (0.12, 0.90), (0.08, 0.24)])
def test_a_family_of_three_lines_is_found(amplitude: float, least: float) -> None:
    """rate.md: 1.00, .83, .24 at amplitude .2, .12, .08 of the noise."""
    found = [family_p(record(k, amplitude=amplitude)) <= 0.05 for k in range(100)]
    assert float(np.mean(found)) >= least


def test_one_strong_line_is_a_line_and_no_family() -> None:
    rng = np.random.default_rng(1)
    t = np.arange(6000) / RATE_HZ
    alone = 0
    for _ in range(60):
        values = rng.normal(0.0, 1.0, t.size) + 2.0 * np.sin(2.0 * np.pi * 12.483 * t)
        alone += family_p(values) <= 0.05
    assert alone <= 9  # binomial at 1e-3 of 60 at .05


def test_the_three_lines_of_the_source_and_the_means_that_they_leave_alone() -> None:
    values = record(5, amplitude=0.4, count=30000)
    time = np.arange(values.size) / RATE_HZ
    found = find_interference(time, values)
    assert [round(line.frequency_hz, 2) for line in found.lines] == [12.48, 24.96, 37.44]
    for line, h in zip(found.lines, (1, 2, 3), strict=True):
        assert abs(line.frequency_hz - h * FUNDAMENTAL_HZ) < 4.5 * line.sigma_hz
        assert line.amplitude == pytest.approx(0.4, abs=4.5 * line.sigma_amplitude)
        assert line.false_alarm_probability < 1e-6
    assert found.families[0].harmonics == (1, 2, 3)
    assert found.families[0].fundamental_hz == pytest.approx(FUNDAMENTAL_HZ, abs=1e-3)
    scatter = scatter_of(values, found.rest, rate_hz=RATE_HZ, unit="1")
    assert scatter.before == pytest.approx(np.sqrt(1.0 + 3 * 0.08), rel=0.02)
    assert scatter.after == pytest.approx(1.0, rel=0.02)
    assert scatter.before_10s is not None
    assert scatter.after_10s is not None
    assert scatter.after_10s / scatter.before_10s == pytest.approx(1.0, abs=0.03)


def test_weak_members_come_with_their_family() -> None:
    values = record(3, amplitude=0.1)
    found = find_interference(np.arange(values.size) / RATE_HZ, values)
    assert len(found.families) == 1
    assert {line.family for line in found.lines} == {0}
    assert len(found.lines) == len(found.families[0].harmonics)


def test_an_averaged_spectrum_finds_weak_lines_in_a_stream() -> None:
    rng = np.random.default_rng(2)
    t = np.arange(1 << 18) / RATE_HZ
    values = rng.normal(0.0, 1.0, t.size) + 0.05 * np.cos(2.0 * np.pi * 12.483 * t + 1.0)
    seen = averaged_spectrum([values[:1000], values[1000:]], block=1 << 13)
    lines = seen.lines()
    assert len(lines) == 1
    assert lines[0][0] * RATE_HZ == pytest.approx(12.483, abs=2e-3)
    assert lines[0][1] == pytest.approx(0.05, rel=0.2)
