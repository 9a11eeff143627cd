"""Simulated sessions made into a whole project that the program can read.

Both lines lie on the central meridian of the project's own grid and the plumb lines are without
deflection, so that the grid azimuth is the astronomic one: what is judged is the orientation.
Text only: whoever calls writes the files.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta
from typing import Any, Literal

import numpy as np

from surveyapp.core.simulate.session import SimulatedSession, book_text, simulate_session
from surveyapp.core.simulate.specification import Effect, SessionSpec
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, wrap_two_pi
from surveyapp_models.constants import WGS84
from surveyapp_models.gyro.periods import clamped_period_s, tracking_period_s, unspun_period_s

CENTRAL_MERIDIAN_DEG = 25.0
SIGHT_LENGTH_M = 300.0
PERIOD_SIGMA_S = 0.1


@dataclass(frozen=True, slots=True)
class ProjectSession:
    """A simulated session in its place.

    Parameters
    ----------
    id : str
    purpose : {"calibration", "survey"}
    station, target : str
    simulated : SimulatedSession
    """

    id: str
    purpose: Literal["calibration", "survey"]
    station: str
    target: str
    simulated: SimulatedSession


@dataclass(frozen=True, slots=True)
class SimulatedProject:
    """A simulated project.

    Parameters
    ----------
    name : str
    sessions : tuple of ProjectSession
    card : str
        Text of the instrument card.
    """

    name: str
    sessions: tuple[ProjectSession, ...]
    card: str


def simulate_reversal_project(
    survey: SessionSpec,
    rng: np.random.Generator,
    *,
    name: str = "Simulated reversal runs",
    calibrations: int = 2,
    surveys: int = 2,
    calibration_latitude: float | None = None,
    calibration_effects: Sequence[Effect] = (),
) -> SimulatedProject:
    """Simulate a project: rounds on a known line, rounds on the line that is to be found.

    Parameters
    ----------
    survey : SessionSpec
        The survey sessions, with their effects; a second one can confirm what the first shows. A
        moment that is given holds for the first of them: in the others the event comes at another.
    rng : numpy.random.Generator
    name : str
    calibrations, surveys : int
        Sessions on each line.
    calibration_latitude : float, optional
        Of the known line and of the card's periods [rad]; the survey's own if absent.
    calibration_effects : sequence of Effect
        None by default: the known side was observed undisturbed.

    Returns
    -------
    SimulatedProject
    """
    latitude = survey.latitude if calibration_latitude is None else calibration_latitude
    known = dataclasses.replace(survey, latitude=latitude, effects=tuple(calibration_effects))
    unknown_azimuth = wrap_two_pi(survey.line_azimuth + 0.7)
    sessions = []
    for index in range(calibrations):
        spec = _moved(known, index, rng)
        sessions.append(
            ProjectSession(
                f"cal-{index + 1}", "calibration", "K1", "K2", simulate_session(spec, rng)
            )
        )
    for index in range(surveys):
        moved = _moved(survey, calibrations + index, rng)
        spec = dataclasses.replace(moved, line_azimuth=unknown_azimuth)
        if index > 0:
            spec = dataclasses.replace(spec, effects=tuple(_elsewhen(e) for e in spec.effects))
        sessions.append(
            ProjectSession(f"run-{index + 1}", "survey", "U1", "U2", simulate_session(spec, rng))
        )
    return SimulatedProject(name, tuple(sessions), card_text(known, rng))


def _moved(spec: SessionSpec, index: int, rng: np.random.Generator) -> SessionSpec:
    """The next round: later, and on another part of the circle."""
    return dataclasses.replace(
        spec,
        start=spec.start + timedelta(hours=3 * index),
        circle_of_north=wrap_two_pi(spec.circle_of_north + float(rng.uniform(-0.5, 0.5))),
        first_east=bool(rng.random() < 0.5),
    )


def _elsewhen(effect: Effect) -> Effect:
    """The effect with its moment left to chance: no event comes twice at one place of a run."""
    return dataclasses.replace(
        effect, options=tuple((name, v) for name, v in effect.options if name != "at")
    )


def project_files(project: SimulatedProject) -> dict[str, str]:
    """Return the text of each file of the project by its relative path, the truth not included."""
    files = {"project.toml": _project_toml(project), "cards/simulated-gyro.toml": project.card}
    for session in project.sessions:
        files[f"observations/{session.id}.csv"] = book_text(session.simulated.rows)
    return files


def project_truth(project: SimulatedProject) -> dict[str, Any]:
    """Return the truth of every session, for a file that no other command reads."""
    return {
        "schema": "surveyapp.truth/1",
        "origin": "simulated from the integrated two-axis equation of motion",
        "sessions": {
            session.id: {
                "station": session.station,
                "target": session.target,
                "purpose": session.purpose,
                **session.simulated.truth,
            }
            for session in project.sessions
        },
    }


def card_text(spec: SessionSpec, rng: np.random.Generator) -> str:
    """Card of the simulated instrument, its periods measured with their stated sigma."""
    periods = [
        period + float(rng.normal(scale=PERIOD_SIGMA_S))
        for period in (
            tracking_period_s(spec.gyro, spec.latitude),
            clamped_period_s(spec.gyro, spec.latitude),
            unspun_period_s(spec.gyro),
        )
    ]
    noise = spec.noise
    return f"""id = "simulated-gyro"
title = "Simulated gyro attachment"
kind = "suspended"
source = "simulated: periods measured with the stated sigma on the simulated instrument"
scale_value_arcsec = {spec.scale_value * RHO_ARCSEC:.6f}

[period]
latitude_deg = {math.degrees(spec.latitude):.9f}
tracking_s = {periods[0]:.3f}
clamped_s = {periods[1]:.3f}
unspun_s = {periods[2]:.3f}
sigma_s = {PERIOD_SIGMA_S}

[sigma]
reversal_arcsec = {noise.reading * RHO_ARCSEC:.3f}
scale_div = {noise.scale_div}
time_s = {noise.time_s}

[range]
latitude_max_deg = 75.0
"""


def toml_head(name: str, card: str) -> str:
    """Return the head of a simulated project.toml: its grid and its one instrument."""
    return (
        "# Simulated: made by the program, not observed.\n"
        "format = 1\n"
        f'name = "{name}"\n'
        f'crs = "+proj=tmerc +lat_0=0 +lon_0={CENTRAL_MERIDIAN_DEG:g} +k=1 +x_0=500000 +y_0=0 '
        '+ellps=WGS84 +units=m +type=crs"\n'
        'angle_unit = "dms"\n\n'
        f'[[instrument]]\nid = "G1"\ncard = "{card}"\nserial = "simulated"\n'
    )


def _project_toml(project: SimulatedProject) -> str:
    lines = {session.station: session for session in project.sessions}
    parts = [toml_head(project.name, "cards/simulated-gyro.toml")]
    parts += [
        station_pair(
            (session.station, session.target),
            latitude=session.simulated.spec.latitude,
            azimuth=session.simulated.spec.line_azimuth,
            known=session.purpose == "calibration",
        )
        for session in lines.values()
    ]
    parts += [_orientation(session) for session in project.sessions]
    return "\n".join(parts)


def station_pair(names: tuple[str, str], *, latitude: float, azimuth: float, known: bool) -> str:
    """Return the two stations of a line that begins on the central meridian, angles [rad].

    The target of a line that is sought has the coordinates of an old plan, to 1e-6 degree (0.1 m):
    exact ones would give the truth away.
    """
    longitude = math.radians(CENTRAL_MERIDIAN_DEG)
    end = direct_position(latitude, longitude, azimuth=azimuth, distance_m=SIGHT_LENGTH_M)
    text = ""
    for name, (lat, lon) in zip(names, ((latitude, longitude), end), strict=True):
        digits = 6 if name == names[1] and not known else 12
        text += (
            f'[[station]]\nname = "{name}"\n'
            f"lat = {math.degrees(lat):.{digits}f}\nlon = {math.degrees(lon):.{digits}f}\n"
            "deflection = { xi_arcsec = 0.0, eta_arcsec = 0.0, sigma_arcsec = 0.0 }\n\n"
        )
    return text.rstrip("\n") + "\n"


def direct_position(
    latitude: float, longitude: float, *, azimuth: float, distance_m: float
) -> tuple[float, float]:
    """Return latitude and longitude [rad] of the end of a short line on WGS 84.

    Gauss's mid-latitude formulae, good to 1e-4 arc-second of azimuth over a few hundred metres.
    """
    squared = WGS84.first_eccentricity_squared
    north = east = turn = 0.0
    for _ in range(6):
        middle = latitude + 0.5 * north
        bracket = 1.0 - squared * math.sin(middle) ** 2
        normal = WGS84.semi_major_m / math.sqrt(bracket)
        meridian = normal * (1.0 - squared) / bracket
        north = distance_m * math.cos(azimuth + 0.5 * turn) / meridian
        east = distance_m * math.sin(azimuth + 0.5 * turn) / (normal * math.cos(middle))
        turn = east * math.sin(middle)
    return latitude + north, longitude + east


def _orientation(session: ProjectSession) -> str:
    spec = session.simulated.spec
    method = "transit" if spec.method == "full_fit" else spec.method
    known = ""
    if session.purpose == "calibration":
        azimuth = format_angle(wrap_two_pi(spec.line_azimuth), AngleUnit.DMS, 3)
        known = f'azimuth_known = "{azimuth}"\nazimuth_known_sigma_arcsec = 0.0\n'
    temperature = ""
    if spec.temperature_span_c > 0.0:
        temperature = f"reference_temperature_c = {spec.temperature_c}\n"
    return (
        f'[[orientation]]\nid = "{session.id}"\n'
        f'station = "{session.station}"\ntarget = "{session.target}"\n'
        f'instrument = "G1"\nmethod = "{method}"\npurpose = "{session.purpose}"\n'
        f"date = {spec.start.date().isoformat()}\n{known}{temperature}"
        f'book = "observations/{session.id}.csv"\n'
    )
