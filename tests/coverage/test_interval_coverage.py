"""interval95_arcsec holds the truth: the integrated equation, a field book, the public command.

Bounds: with 240 runs and a true coverage of 95 % the share lies between 89.6 and 98.7 % with
probability 0.999 (binomial); the campaign of ``make bench`` has 1000 runs a method.
"""

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from scipy.special import bdtrik

from bench._coverage_lines import LINES as FURTHER
from bench.coverage import azimuth_of, campaign, further, judged, write_files
from surveyapp import api
from surveyapp.core.simulate.specification import SwingMethod

RUNS = 240
LOW, HIGH = (float(bdtrik(p, RUNS, 0.95)) / RUNS for p in (0.0005, 0.9995))


def test_bounds_are_those_of_the_binomial_distribution() -> None:
    assert pytest.approx(0.95 - 3.29 * math.sqrt(0.95 * 0.05 / RUNS), abs=1e-2) == LOW
    assert HIGH < 0.995


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("method", "seed", "sigma_about"),
    [("tracking", 11, 3.0), ("amplitude", 12, 6.0), ("transit", 13, 4.5), ("full_fit", 14, 4.5)],
)
def test_interval_holds_the_truth(method: SwingMethod, seed: int, sigma_about: float) -> None:
    for item in campaign(method, RUNS, seed):
        assert LOW <= item.share <= HIGH
        assert abs(item.bias_in_sigma) < 0.3
        # the sigma is the scatter: chi-square bounds of a variance from 240 runs, 99.9 %, widened
        # by the scatter of the sigmas themselves (few degrees of freedom)
        ratio = float(np.std(item.errors) / np.sqrt(np.mean(item.sigmas**2)))
        assert 0.82 < ratio < 1.18
        assert float(np.mean(item.sigmas)) < sigma_about


FEW = {"gyro": 100, "grid": 30, "combined": 120}
"""Runs of a further line in the suite; the bench has 1000 (docs/reference/coverage.md)."""


@pytest.mark.statistical
@pytest.mark.parametrize("place", range(len(FURTHER)), ids=[line.name for line in FURTHER])
def test_interval_holds_what_a_session_does_not_show(place: int) -> None:
    line = FURTHER[place]
    found, silent = further(line, FEW[line.quantity], 40 + place)
    # a true share of 93 % or more lies above with a probability of 0.9995
    size = found.errors.size
    assert round(found.share * size) >= bdtrik(0.0005, size, 0.93)
    assert abs(found.bias_in_sigma) < 3.5 / math.sqrt(size)
    # lines of one side are found to disagree in 5 % of all cases
    assert silent <= bdtrik(0.9995, FEW[line.quantity], 0.05)


def test_leaving_out_the_tests_of_fit_changes_no_azimuth() -> None:
    line = FURTHER[0]
    with tempfile.TemporaryDirectory() as name:
        drawn = next(line.draw(1, np.random.default_rng(3)))
        write_files(Path(name), drawn.files)
        whole = azimuth_of(api.orient(name).to_dict(), line.quantity)
        found = judged(Path(name), drawn, line.quantity)
    assert whole is not None
    assert found is not None
    assert found[1:] == (whole["sigma_arcsec"], whole["interval95_arcsec"])
