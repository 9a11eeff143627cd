"""Places that a mutation went through unnoticed: each with a value known from elsewhere."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import bisect

from surveyapp.core.network.spheres import three_spheres
from surveyapp.core.observing.by_method import progress_of
from surveyapp.core.statistics import levels
from surveyapp.core.statistics.repeated import between_variance
from surveyapp.core.swing.card_physics import card_at
from surveyapp.core.swing.clamped import circle_resolution
from surveyapp.core.swing.goodness import Judge
from surveyapp.core.swing.session import reduce_swing
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.diagnosis.long_records.blocks import split
from surveyapp.domain.instrument import InstrumentCard, Periods
from surveyapp.domain.project import Method, OrientationSession
from surveyapp.io.fieldbook.reading import interpret
from surveyapp_models.angles import ARCSEC, AngleUnit

HEAD = "seq,elapsed_s,kind,value,unit\n"


def session(*rows: str, method: Method = "amplitude") -> OrientationSession:
    text = HEAD + "".join(f"{i},{row}\n" for i, row in enumerate(rows, 1))
    book, _ = interpret(text, angle_unit=AngleUnit.DMS, where="book")
    return OrientationSession(
        id="r", station="A", instrument="G", method=method, purpose="survey", book=book
    )


def card(**periods: float) -> InstrumentCard:
    return InstrumentCard(
        id="g",
        title="G",
        kind="suspended",
        source="a test",
        scale_value=600.0 * ARCSEC,
        torsion_lambda=0.2,
        periods=Periods(math.radians(47.0), **periods),
    )


@pytest.mark.parametrize(("degrees", "clamped"), [(47.0, 388.333), (60.0, 440.374), (0.0, 329.549)])
def test_the_clamped_period_follows_from_the_tracking_period(
    degrees: float, clamped: float
) -> None:
    """Table of physics: T1 = 425.397 s and lambda = 0.2 at 47 degrees (integrated motion)."""
    found = card_at(card(tracking_s=425.397), math.radians(degrees)).clamped_s
    assert found is not None
    assert found.value == pytest.approx(clamped, abs=0.002)


@pytest.mark.parametrize(("degrees", "tracking"), [(47.0, 425.397), (60.0, 496.823)])
def test_the_tracking_period_and_the_clamped_one_tell_the_same_gyro(
    degrees: float, tracking: float
) -> None:
    found = card_at(card(tracking_s=425.397, clamped_s=388.333), math.radians(degrees))
    assert found.tracking_s is not None
    assert found.tracking_s.value == pytest.approx(tracking, abs=0.001)


def test_the_period_on_the_screen_is_twice_the_half_swing() -> None:
    rows = ["0,clamp,0-00-00,dms"]
    rows += [f"{100 + 190 * k},scale_reversal,{'-' if k % 2 else ''}8.0,div" for k in range(5)]
    made = progress_of(
        session(*rows), card(), np.random.default_rng(1), latitude=math.radians(47.0)
    )
    assert made.period_s == pytest.approx(380.0, abs=0.5)


@pytest.mark.parametrize("first", [1.0, -1.0])
def test_more_time_on_the_east_side_moves_north_to_the_east(first: float) -> None:
    """Three passages, the swing 2 dt longer on one side: B = a sin(pi dt / (2 T2)), by hand."""
    dt, a, half = 8.0, 6.0, 194.0
    east = half + 0.5 * dt
    west = half - 0.5 * dt
    lengths = (east, west) if first > 0 else (west, east)
    t1, t2 = 100.0, 100.0 + lengths[0]
    t3 = t2 + lengths[1]
    rows = [
        "0,clamp,359-58-00,dms",
        f",scale_reversal,{-first * a},div",
        f"{t1},transit,0,div",
        f",scale_reversal,{first * a},div",
        f"{t2},transit,0,div",
        f",scale_reversal,{-first * a},div",
        f"{t3},transit,0,div",
        f",scale_reversal,{first * a},div",
    ]
    made = session(*rows, method="transit")
    judge = Judge(np.random.default_rng(1))
    known = card(clamped_s=388.0)
    found = reduce_swing(made, known, judge, latitude=math.radians(47.0), estimator="transit")
    middle = a * math.sin(math.pi * dt / (2.0 * 388.0))
    expected = -120.0 + 1.2 * 600.0 * middle
    assert found.north is not None
    north = (math.degrees(found.north.value) * 3600.0 + 648000.0) % 1296000.0 - 648000.0
    assert north == pytest.approx(expected, abs=0.6)


@pytest.mark.parametrize(
    ("text", "unit", "arcsec"),
    [
        ("12.34", "gon", 32.4),
        ("12.345", "deg", 3.6),
        ("12-34-56.0", "dms", 0.1),
        ("12", "gon", 3240),
    ],
)
def test_one_clamp_reading_is_as_fine_as_its_last_digit(
    text: str, unit: str, arcsec: float
) -> None:
    """1 gon = 3240", 1 degree = 3600": by definition."""
    made = session(f"0,clamp,{text},{unit}")
    assert circle_resolution(made, made.book.rows) / ARCSEC == pytest.approx(arcsec, rel=1e-9)


@pytest.mark.parametrize("height", [4.0, -4.0])
def test_three_distances_place_a_point_above_and_a_fourth_decides(height: float) -> None:
    truth = np.array([3.0, 2.0, height])
    centres = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0]])
    three = three_spheres(centres, np.linalg.norm(centres - truth, axis=1))
    assert three is not None
    assert three[0] == pytest.approx([3.0, 2.0, 4.0], abs=1e-9)
    assert three[1] == pytest.approx([3.0, 2.0, -4.0], abs=1e-9)
    four = np.vstack([centres, [5.0, 5.0, 1.0]])
    found = three_spheres(four, np.linalg.norm(four - truth, axis=1))
    assert found is not None
    assert found[0] == pytest.approx(truth, abs=1e-9)
    assert found[1] is None


def test_blocks_share_each_stretch_in_equal_times() -> None:
    """A record that does not begin at zero, in two stretches: by a loop over the samples."""
    g = np.random.default_rng(3)
    first = 5000.0 + np.sort(g.uniform(0.0, 60.0, 300))
    second = 9000.0 + np.sort(g.uniform(0.0, 120.0, 500))
    position = np.concatenate([first, second])
    runs = np.array([0, 300], dtype=np.intp)
    blocks = split(position, runs, 18)
    assert blocks.first.size == 18
    expected = []
    for start, values, parts in ((0, first, 6), (300, second, 12)):
        length = (values[-1] - values[0]) / parts
        number = [min(int((v - values[0]) / length), parts - 1) for v in values]
        expected += [start + number.index(k) for k in range(parts)]
    assert blocks.first.tolist() == expected


def test_the_shares_of_the_level_sum_to_no_more_than_the_whole() -> None:
    """Four kinds of fit, the constants, nine other families: the docstrings of ``levels``."""
    whole = 4 * levels.FIT_KIND + levels.CONSTANT_SHARE + 9 * levels.FAMILY_SHARE
    assert whole <= levels.PROJECT_LEVEL


def test_the_scatter_of_runs_of_one_sigma_is_known_in_closed_form() -> None:
    """Own variances v: the extra one is sum of squares / wanted - v; three runs clearly apart."""
    values, own = [0.0, 30.0, 75.0], 4.0
    group = [Uncertain(x, {Source("rounds", f"s{i}"): own}) for i, x in enumerate(values)]
    squares = sum((x - 35.0) ** 2 for x in values)
    found = between_variance([group], probability=0.0)
    assert found == pytest.approx(squares / 2.0 - own**2, rel=1e-12)
    # of unlike variances: the same sum of squares, by the bisection of scipy
    unlike = [Uncertain(x, {Source("rounds", f"s{i}"): 3.0 + i}) for i, x in enumerate(values)]

    def excess(extra: float) -> float:
        weights = 1.0 / (np.array([9.0, 16.0, 25.0]) + extra)
        mean = weights @ np.array(values) / weights.sum()
        return float(weights @ (np.array(values) - mean) ** 2) - 2.0

    assert between_variance([unlike], probability=0.0) == pytest.approx(
        bisect(excess, 0.0, 1e5, xtol=1e-9), rel=1e-9
    )
    assert between_variance([group[:2]], probability=0.0) > 0.0
    close = [Uncertain(x / 100.0, item.parts) for x, item in zip(values, group, strict=True)]
    assert between_variance([close], probability=0.0) == 0.0
