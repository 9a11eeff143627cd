"""Errors of a gyro azimuth that no residual shows: levelling, graduation, twist, observer ...

Each is a term with its source on the budget, zero terms too. What two determinations share (an
observer, the change of the constant with temperature or latitude) is one source and cancels
between the known and the unknown line as far as their circumstances are the same.

Source: physics.md 1.5, 3.8 and section 4.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.lines import LineGeometry
from surveyapp.core.swing.levelling import session_tilt
from surveyapp.core.swing.session import ReducedSession, TargetReduction
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Project
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC

LEVEL_SIGMA: Final = 10.0 * ARCSEC
"""Half a division of a 20" plate level. Source: Coal Mine Surveying Regulations (China, 1989),
article 63: the bubble leaves its middle by half a division at most."""
LATITUDE_WARNING: Final = math.radians(1.0)
"""Lines further apart in latitude do not share a constant without a word."""

FAR_M: Final = 50_000.0
"""Lines further apart than any mine is wide: plumb lines have nothing in common any more (its
correlation length is 20 km), and a degree of a coordinate may be mistyped."""
EARTH_RADIUS_M: Final = 6371000.0


@dataclass(frozen=True, slots=True)
class Circumstance:
    """Where and how one gyro azimuth was observed."""

    card: InstrumentCard
    geometry: LineGeometry
    temperature_c: float | None


def with_error_terms(
    item: ReducedSession, target: TargetReduction, at: Circumstance
) -> TargetReduction:
    """Add every term to the gyro azimuth of one target."""
    azimuth = target.gyro_azimuth
    if azimuth is None:
        return target
    return replace(target, gyro_azimuth=azimuth + error_terms(item, target, at))


def error_terms(item: ReducedSession, target: TargetReduction, at: Circumstance) -> Uncertain:
    """Zero with the terms of one gyro azimuth [rad]."""
    session, sigma = item.session, at.card.sigma
    parts: dict[Source, float] = {}

    def add(name: str, entity: str, value: float) -> None:
        if value != 0.0:
            parts[Source(name, entity)] = value

    zenith = at.geometry.zenith
    level = LEVEL_SIGMA if sigma.level is None else sigma.level
    tilt = session_tilt(session, tape_zero=False)
    if tilt is not None:  # the readings tell the tilt; what remains is their own sigma
        level = tilt.sigma if tilt.logged else max(tilt.sigma, sigma.level or 0.0)
    # tilt across the sight times cot z: both faces have it alike
    add("levelling", session.id, level * abs(math.cos(zenith) / math.sin(zenith)))
    add("graduation", session.id, math.sqrt(2.0) * (sigma.graduation or 0.0))
    if target.sights is not None and target.sights.drift is None:
        add("twist", session.id, sigma.twist or 0.0)
    add("lateral refraction", _side(at.geometry), _refraction(item, at.card))
    add("observer", session.observer or "one observer", sigma.observer or 0.0)
    if at.temperature_c is not None:
        name = "temperature of the constant"
        add(name, session.instrument, (sigma.temperature or 0.0) * at.temperature_c)
    latitude = at.geometry.position.latitude
    if latitude is not None:
        name = "latitude of the constant"
        add(name, session.instrument, (sigma.latitude or 0.0) / math.cos(latitude))
    return Uncertain(0.0, parts)


def latitude_warnings(project: Project, positions: Mapping[str, Position]) -> list[ResultWarning]:
    """Surveys at another latitude than the calibrations of their instrument."""
    warnings = []
    for instrument in project.instruments:
        own = [s for s in project.sessions if s.instrument == instrument.id]
        known = [
            latitude
            for s in own
            if s.purpose == "calibration"
            and (latitude := positions[s.station].latitude) is not None
        ]
        far = {
            s.station
            for s in own
            if s.purpose == "survey"
            and known
            and (latitude := positions[s.station].latitude) is not None
            and min(abs(latitude - other) for other in known) > LATITUDE_WARNING
        }
        for station in sorted(far):
            text = said(
                "the constant of {id} was determined at another latitude than that of "
                "{station}: it changes by k (sec of the one - sec of the other); state k "
                "with sigma = {{ latitude_arcsec = ... }} of the instrument, or calibrate "
                "nearby",
                id=instrument.id,
                station=station,
            )
            subject = Subject.of("instrument", instrument.id)
            warnings.append(ResultWarning("constant_latitude", text, subject))
    return warnings


def distance_warnings(project: Project, positions: Mapping[str, Position]) -> list[ResultWarning]:
    """Surveys further from every calibration of their instrument than any mine is wide."""
    warnings = []
    for instrument in project.instruments:
        own = [s for s in project.sessions if s.instrument == instrument.id]
        known = {s.station for s in own if s.purpose == "calibration"}
        for station in sorted({s.station for s in own if s.purpose == "survey"} - known):
            apart = [
                distance
                for other in known
                if (distance := _apart_m(positions[station], positions[other])) is not None
            ]
            if not apart or min(apart) <= FAR_M:
                continue
            text = said(
                "{station} lies {distance:.0f} km from the nearest calibration of {instrument} by "
                "its coordinates: are they right? Convergence and deflection go with them",
                station=station,
                distance=min(apart) / 1000.0,
                instrument=instrument.id,
            )
            subject = Subject.of("station", station)
            warnings.append(ResultWarning("constant_far", text, subject))
    return warnings


def _apart_m(a: Position, b: Position) -> float | None:
    """Distance of two positions on the sphere [m], None where a latitude is not known."""
    if None in (a.latitude, a.longitude, b.latitude, b.longitude):
        return None
    north = (a.latitude or 0.0) - (b.latitude or 0.0)
    east = math.remainder((a.longitude or 0.0) - (b.longitude or 0.0), 2.0 * math.pi)
    middle = 0.5 * ((a.latitude or 0.0) + (b.latitude or 0.0))
    return EARTH_RADIUS_M * math.hypot(north, east * math.cos(middle))


def _side(geometry: LineGeometry) -> str:
    return "-".join(sorted((geometry.start.name, geometry.end.name)))


def _refraction(item: ReducedSession, card: InstrumentCard) -> float:
    """The session's own, else the card's: a sight along a wall is known to who set up there."""
    own = item.session.refraction_sigma
    return own if own is not None else card.sigma.refraction or 0.0
