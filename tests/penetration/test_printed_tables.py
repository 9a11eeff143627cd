"""Every row of the tables of test values that the model of breakthroughs was given.

Straight drives, sides of 100 m, angles 7", the meeting point is the last station; lateral 1 sigma
in metres to the printed digits. The columns were computed by another program.
"""

import math

import numpy as np
import pytest

from surveyapp.core.penetration.covariance import (
    contributions,
    estimator,
    refraction_columns,
    total,
)
from surveyapp.core.penetration.sections import sectioned
from surveyapp.domain.penetration import DeflectionField, HeadingStart, Wall
from surveyapp_models.angles import ARCSEC
from surveyapp_models.sight_refraction import curvature_per_gradient, sight_displacement
from tests.penetration.mines import lateral, straight

# sides, gyro: A, B, C, A + wall, B + wall, B twice, wall alone, reciprocal wall, A by the formula
ROWS = [
    (20, (0,), ".2227 .2358 .2227 .2944 .3045 .1756 .1926 .1829 .2227"),
    (20, (0, 10, 19), ".0946 .1224 .1137 .0950 .1226 .1024 .0084 -.0012 .0966"),
    (40, (0, 39), ".3150 .3511 .3335 .3156 .3516 .2714 .0193 .0000 .3150"),
    (40, (0, 20), ".2915 .3302 .3092 .3904 .4201 .2580 .2598 .2405 .2966"),
    (40, (0, 10, 20, 30, 39), ".1458 .2129 .2009 .1468 .2136 .1863 .0175 -.0017 .1477"),
]
C_OWN = math.sqrt(15.0**2 - 8.0**2)


def wall_alone(sides: int, gyro: tuple[int, ...], wall: tuple[Wall, ...] = ()) -> float:
    mine = straight(sides, gyro, gradient=0.1, wall=wall)
    ((_, column),) = refraction_columns(mine, estimator(mine))
    return 0.1 * float(column[0])


@pytest.mark.parametrize(("sides", "gyro", "printed"), ROWS)
def test_lateral_sigma_of_the_layouts(sides: int, gyro: tuple[int, ...], printed: str) -> None:
    values = [float(text) for text in printed.split()]
    found = [
        lateral(straight(sides, gyro)),
        lateral(straight(sides, gyro, shared=8.0)),
        lateral(straight(sides, gyro, own=C_OWN, shared=8.0)),
        lateral(straight(sides, gyro, gradient=0.1)),
        lateral(straight(sides, gyro, shared=8.0, gradient=0.1)),
        lateral(straight(sides, gyro, shared=8.0, surveys=2)),
        wall_alone(sides, gyro),
    ]
    assert found == pytest.approx(values[:7], abs=0.5e-4 + 1e-9)


@pytest.mark.parametrize(("sides", "gyro", "printed"), ROWS)
def test_sectioned_formula(sides: int, gyro: tuple[int, ...], printed: str) -> None:
    mine = straight(sides, gyro)
    found = sectioned(mine, contributions(mine))
    assert found.valid
    assert found.lateral_m == pytest.approx(float(printed.split()[-1]), abs=0.5e-4)


@pytest.mark.parametrize(("sides", "gyro", "printed"), ROWS)
def test_reciprocal_gyro_sides_along_a_wall(
    sides: int, gyro: tuple[int, ...], printed: str
) -> None:
    """The printed figures hold for a MEAN of both ends of 15": two rows of 15" sqrt 2."""
    mine = straight(sides, gyro, own=15.0 * math.sqrt(2.0), gradient=0.1, reciprocal=True)
    ((_, column),) = refraction_columns(mine, estimator(mine))
    assert 0.1 * float(column[0]) == pytest.approx(float(printed.split()[7]), abs=0.5e-4)


@pytest.mark.parametrize(("sides", "gyro", "printed"), ROWS)
def test_zigzag_leaves_nothing_of_a_wall(sides: int, gyro: tuple[int, ...], printed: str) -> None:
    wall: tuple[Wall, ...] = tuple("right" if i % 2 else "left" for i in range(sides + 1))
    assert wall_alone(sides, gyro, wall) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("sides", "gyro", "printed"),
    [
        (20, (0, 10, 19), (0.0360, 0.0259, 0.0155)),
        (40, (0, 20), (0.0845, 0.0634, 0.0387)),
        (40, (0, 10, 20, 30, 39), (0.0862, 0.0695, 0.0445)),
    ],
)
def test_deflection_with_a_correlation_length(
    sides: int, gyro: tuple[int, ...], printed: tuple[float, ...]
) -> None:
    for length, value in zip((1e3, 3e3, 1e4), printed, strict=True):
        field = DeflectionField(5.0 * ARCSEC, length, math.radians(45.0), "P0")
        (part,) = [
            p
            for p in contributions(straight(sides, gyro, deflection=field))
            if p.source == "deflection"
        ]
        assert part.sigmas[0] == pytest.approx(value, abs=0.5e-4)


@pytest.mark.parametrize(("kilometres", "printed"), [(2, 0.1926), (4, 0.7703)])
def test_one_wall_from_a_start_azimuth(kilometres: int, printed: float) -> None:
    sides = 10 * kilometres
    mine = straight(sides, (), gradient=0.1, start=HeadingStart(0.0))
    ((_, column),) = refraction_columns(mine, estimator(mine))
    curvature = curvature_per_gradient(pressure_hpa=1013.25, temperature_c=15.0)
    length = 1000.0 * kilometres
    # kappa L^2/2 and half a side of the first angle that is not there
    closed = 0.5 * curvature * 0.1 * length**2
    assert closed == pytest.approx(printed, abs=0.5e-4)
    assert 0.1 * float(column[0]) == pytest.approx(closed * (1.0 - 1.0 / sides), rel=1e-6)


def test_zigzag_from_a_start_azimuth() -> None:
    """Angles +-kappa s/3 alternating move the end by kappa s L/6: 0.0032 m at 2 km."""
    wall: tuple[Wall, ...] = tuple("right" if i % 2 else "left" for i in range(21))
    mine = straight(20, (), gradient=0.1, wall=wall, start=HeadingStart(0.0))
    ((_, column),) = refraction_columns(mine, estimator(mine))
    assert abs(0.1 * float(column[0])) == pytest.approx(0.0032, abs=0.5e-4)


@pytest.mark.parametrize(
    ("ends", "printed"), [((1.0, 1.0), 9.93005), ((1.0, -1.0), 3.31002), ((1.0, 0.0), 6.62003)]
)
def test_sight_displacement_is_the_integrated_ray(
    ends: tuple[float, float], printed: float
) -> None:
    curvature = curvature_per_gradient(pressure_hpa=1013.25, temperature_c=15.0)
    assert curvature == pytest.approx(9.6285e-7, abs=6e-12)
    closed = sight_displacement(
        100.0, at_station=curvature * ends[0], at_target=curvature * ends[1]
    )
    assert closed / ARCSEC == pytest.approx(printed, abs=2e-5)
    # y'' = kappa(s), y(0) = y(100) = 0, summed twice by the trapezoidal rule
    s = np.linspace(0.0, 100.0, 20001)
    kappa = curvature * (ends[0] + (ends[1] - ends[0]) * s / 100.0)
    step = s[1]
    slope = np.concatenate(([0.0], np.cumsum(0.5 * step * (kappa[1:] + kappa[:-1]))))
    offset = float(np.sum(0.5 * step * (slope[1:] + slope[:-1])))
    assert offset / 100.0 == pytest.approx(closed, rel=1e-7)


def test_budget_adds_in_squares() -> None:
    field = DeflectionField(5.0 * ARCSEC, 3000.0, math.radians(45.0), "P0")
    mine = straight(40, (0, 20), shared=8.0, gradient=0.1, bent=True, deflection=field)
    parts = contributions(mine)
    plane, _ = total(parts)
    for axis in (0, 1):
        squares = sum(part.sigmas[axis] ** 2 for part in parts)
        assert squares == pytest.approx(float(plane[axis, axis]), rel=1e-12)


@pytest.mark.parametrize(
    ("angle", "levers", "printed"), [(20.0, 2950e4, 0.1387), (5.0, 353e4, 0.0010)]
)
def test_soviet_instruction_1985(angle: float, levers: float, printed: float) -> None:
    """Appendix 29: m^2/rho^2 times the sum of the squared levers, halved by two surveys.

    A drive of 20 sides of 100 m has 2470e4 m^2; its angles are scaled to the printed sum.
    """
    mine = straight(20, (), angle=angle, surveys=2, start=HeadingStart(0.0))
    (part,) = [p for p in contributions(mine) if p.source == "angles"]
    assert part.sigmas[0] ** 2 * levers / 2470e4 == pytest.approx(printed, abs=0.5e-4)
