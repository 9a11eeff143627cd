"""Hand-held stops: the stated intervals hold their share (the campaign is bench rate_coverage)."""

from __future__ import annotations

import numpy as np
import pytest

from bench.rate_coverage import coverage_of, fog_station, headings, multi_position


@pytest.mark.statistical
def test_intervals_of_hand_held_stops_hold_the_truth() -> None:
    """Twelve records of 21 parameters: 1.96 sigma, few degrees of freedom counted in.

    The parameters of a record are correlated: a pooled share of .88 lies three of its standard
    deviations below .95. Without the accelerometers' uncertainty it was .91, single ones .84.
    """
    found = coverage_of(multi_position, 12, seed=3)
    assert len(found) == 21
    assert float(np.mean([share for share, _ in found.values()])) >= 0.88


@pytest.mark.statistical
def test_intervals_of_the_gyro_on_a_total_station_hold_the_truth() -> None:
    """Thirty records of three parameters: 24 and fewer of 30 have p = .003."""
    found = coverage_of(fog_station, 30, seed=3)
    assert set(found) == {"elevation", "instrument_constant", "scale_factor"}
    assert min(share for share, _ in found.values()) >= 0.83


@pytest.mark.statistical
def test_headings_by_indexing_are_covered_and_no_wrong_root_is_silent() -> None:
    """Sixty runs over five latitudes, three attitudes and two programmes: 50 and fewer p = .001."""
    share, wrong, told = headings(60, seed=3)
    assert wrong == 0
    assert told <= 6
    assert share >= 0.85
