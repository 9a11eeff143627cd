"""The field of deflections against its dense covariance, from the formula in plain loops."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.deflection_field import DeflectionField, deflection_field
from surveyapp.core.uncertain import Source, Uncertain, combine
from surveyapp.domain.project import Deflection, OrientationSession, Project, Station
from surveyapp.domain.readings import FieldBook
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

COUNT = 60
LENGTH_M = 3000.0
SIGMA = 5.0 * ARCSEC
CALIBRATED = (3, 17, 18, 59)


def survey(length_m: float = LENGTH_M) -> tuple[Project, dict[str, Position]]:
    """Sixty stations over 8 km by 8 km, two at one place, four with a calibration."""
    rng = np.random.default_rng(11)
    places = rng.uniform(0.0, 8000.0, (COUNT, 2))
    places[31] = places[30]
    stations = tuple(
        Station(f"P{i}", e=e, n=n, deflection=Deflection(sigma=SIGMA * (1.0 + 0.01 * i)))
        for i, (e, n) in enumerate(places.tolist())
    )
    sessions = tuple(
        OrientationSession(
            id=f"s{i}",
            station=f"P{i}",
            target=None,
            instrument="G",
            purpose="calibration" if i in CALIBRATED else "survey",
            method="automatic",
            book=FieldBook((), ()),
        )
        for i in range(COUNT)
    )
    project = Project(
        name="field", stations=stations, sessions=sessions, deflection_length_m=length_m
    )
    return project, {s.name: Position(None, None, s.e, s.n, None) for s in stations}


def dense(project: Project, length_m: float = LENGTH_M) -> Floats:
    """Covariance of one component at all stations [rad^2]."""
    result = np.zeros((COUNT, COUNT))
    for i, a in enumerate(project.stations):
        for j, b in enumerate(project.stations):
            apart = math.hypot((a.e or 0.0) - (b.e or 0.0), (a.n or 0.0) - (b.n or 0.0))
            alike = 1.0 if i == j else math.exp(-apart / length_m) if length_m else 0.0
            result[i, j] = alike * a.deflection.sigma * b.deflection.sigma
    return result


def components(field: DeflectionField) -> list[Uncertain]:
    return [Uncertain(0.0, field.sources[f"P{i}"]) for i in range(COUNT)]


def covariance(a: Uncertain, b: Uncertain) -> float:
    return math.fsum(part * b.parts.get(source, 0.0) for source, part in a.parts.items())


def test_variances_and_covariances_with_calibrations_are_those_of_the_dense_field() -> None:
    project, positions = survey()
    items = components(deflection_field(project, positions))
    expected = dense(project)
    for i in range(COUNT):
        assert items[i].variance == pytest.approx(expected[i, i], rel=1e-9)
        for j in CALIBRATED:
            found = covariance(items[i], items[j])
            assert found == pytest.approx(expected[i, j], rel=1e-9, abs=1e-9 * SIGMA**2)
        assert len(items[i].parts) <= len(CALIBRATED) + 1


def test_jointly_every_covariance_is_that_of_the_dense_field() -> None:
    project, positions = survey()
    field = deflection_field(project, positions)
    items = field.jointly(components(field))
    expected = dense(project)
    found = np.array([[covariance(a, b) for b in items] for a in items])
    assert np.max(np.abs(found - expected)) < 1e-9 * SIGMA**2


def test_difference_of_two_lines_has_the_variance_of_the_field() -> None:
    """2 sigma^2 (1 - exp(-d / L)) where the sigmas are alike; signs and factors stay."""
    project, positions = survey()
    field = deflection_field(project, positions)
    items = components(field)
    expected = dense(project)
    for i, j in ((0, 1), (5, 40), (30, 31), (3, 9), (17, 18)):
        a, b = combine([(0.7, items[i])]), combine([(-1.3, items[j])])
        a, b = field.jointly([a, b])
        variance = 0.49 * expected[i, i] + 1.69 * expected[j, j] - 2 * 0.91 * expected[i, j]
        assert (a + b).variance == pytest.approx(variance, rel=1e-8)


def test_other_sources_and_details_stay_as_they_are() -> None:
    project, positions = survey()
    field = deflection_field(project, positions)
    reading = Source("reading", "P0")
    xi, eta = Source("deflection", "P0", detail="xi"), Source("deflection", "P1", detail="eta")
    first, second = Uncertain(1.0, {reading: 0.5, xi: 0.2}), Uncertain(2.0, {eta: 0.3})
    there, back = field.jointly([first, second])
    assert (there.value, back.value) == (1.0, 2.0)
    assert there.parts[reading] == 0.5
    assert covariance(there, back) == 0.0
    assert back.variance == pytest.approx(0.09, rel=1e-12)


def test_without_a_length_every_station_has_its_own() -> None:
    project, positions = survey(0.0)
    field = deflection_field(project, positions)
    found = components(field)
    expected = dense(project, 0.0)
    joint = field.jointly(found)
    table = np.array([[covariance(a, b) for b in joint] for a in joint])
    assert np.max(np.abs(table - expected)) < 1e-9 * SIGMA**2


def test_places_of_the_earth_agree_with_the_great_circle() -> None:
    """Along and across the meridian at 60 degrees and over the date line: haversine distances."""
    project, _ = survey()
    rng = np.random.default_rng(12)
    north = math.radians(60.0) + rng.uniform(-6e-4, 6e-4, COUNT)
    east = np.remainder(math.pi + rng.uniform(-1.2e-3, 1.2e-3, COUNT) + math.pi, 2 * math.pi)
    east -= math.pi
    positions = {
        f"P{i}": Position(float(north[i]), float(east[i]), None, None, None) for i in range(COUNT)
    }
    field = deflection_field(project, positions)
    items = field.jointly(components(field))
    for i, j in ((0, 1), (2, 3), (3, 17), (20, 45), (44, 58)):
        half = math.sin((north[i] - north[j]) / 2) ** 2
        half += math.cos(north[i]) * math.cos(north[j]) * math.sin((east[i] - east[j]) / 2) ** 2
        apart = 2.0 * 6371000.0 * math.asin(math.sqrt(half))
        found = covariance(items[i], items[j]) / (items[i].sigma * items[j].sigma)
        assert found == pytest.approx(math.exp(-apart / LENGTH_M), rel=5e-3)
