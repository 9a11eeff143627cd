"""Properties that hold for every instrument and every latitude."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveyapp_models.gyro.coefficients import (
    torsion_ratio_from_periods,
    transfer_torsion_ratio,
    transfer_transit_coefficient,
    transit_coefficient_at_latitude,
    transit_coefficient_from_periods,
)
from surveyapp_models.gyro.estimates import Estimate
from surveyapp_models.gyro.periods import (
    clamped_period_s,
    tracking_period_s,
    transfer_clamped_period,
    transfer_tracking_period,
    unspun_period_s,
)
from surveyapp_models.gyro.suspended import gyro_from_periods

latitudes = st.floats(-75.0, 75.0).map(math.radians)
periods = st.tuples(st.floats(300.0, 900.0), st.floats(0.6, 0.99), st.floats(20.0, 60.0)).map(
    lambda p: (p[0], p[0] * p[1], p[2])
)


@settings(deadline=None, max_examples=60)
@given(periods, latitudes)
def test_parameters_and_periods_are_inverse(
    three: tuple[float, float, float], latitude: float
) -> None:
    t1, t2, t0 = three
    gyro = gyro_from_periods(tracking_s=t1, clamped_s=t2, unspun_s=t0, latitude=latitude)
    assert tracking_period_s(gyro, -latitude) == pytest.approx(t1, rel=1e-9)
    assert clamped_period_s(gyro, -latitude) == pytest.approx(t2, rel=1e-9)
    assert unspun_period_s(gyro) == pytest.approx(t0, rel=1e-9)


@settings(deadline=None, max_examples=60)
@given(periods, latitudes, latitudes, latitudes)
def test_transfer_does_not_depend_on_the_way(
    three: tuple[float, float, float], here: float, between: float, there: float
) -> None:
    t1, t2 = Estimate(three[0], 0.2), Estimate(three[1], 0.2)

    def moved(a: Estimate, b: Estimate, start: float, end: float) -> tuple[Estimate, Estimate]:
        return (
            transfer_tracking_period(a, latitude=start, to_latitude=end),
            transfer_clamped_period(b, a, latitude=start, to_latitude=end),
        )

    direct = moved(t1, t2, here, there)
    detour = moved(*moved(t1, t2, here, between), between, there)
    assert detour[0].value == pytest.approx(direct[0].value, rel=1e-9)
    assert detour[1].value == pytest.approx(direct[1].value, rel=1e-9)
    back = moved(*direct, there, here)
    assert back[1].value == pytest.approx(t2.value, rel=1e-9)


@settings(deadline=None, max_examples=60)
@given(periods, latitudes, latitudes)
def test_lambda_and_c_carried_are_those_of_the_periods_carried(
    three: tuple[float, float, float], here: float, there: float
) -> None:
    t1, t2 = Estimate(three[0], 0.0), Estimate(three[1], 0.0)
    t1_there = transfer_tracking_period(t1, latitude=here, to_latitude=there)
    t2_there = transfer_clamped_period(t2, t1, latitude=here, to_latitude=there)
    ratio = torsion_ratio_from_periods(t1, t2)
    carried = transfer_torsion_ratio(ratio, latitude=here, to_latitude=there)
    assert carried.value == pytest.approx(
        torsion_ratio_from_periods(t1_there, t2_there).value, rel=1e-6
    )
    c = transit_coefficient_from_periods(t1, t2, scale_value=1.0)
    by_ratio = transfer_transit_coefficient(c, ratio, latitude=here, to_latitude=there).value
    by_periods = transit_coefficient_from_periods(t1_there, t2_there, scale_value=1.0).value
    at_once = transit_coefficient_at_latitude(
        t1, t2, scale_value=1.0, latitude=here, to_latitude=there
    ).value
    assert by_ratio == pytest.approx(by_periods, rel=1e-9)
    assert at_once == pytest.approx(by_periods, rel=1e-9)
