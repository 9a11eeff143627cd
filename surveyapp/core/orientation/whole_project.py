"""A whole project: sessions, constants, oriented lines. The order of the computation, no formula.

Problems of all sessions are collected before anything is raised.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.checks.adopted_checks import check_adopted
from surveyapp.core.checks.blunders import (
    place_warnings,
    refuse_one_place,
    refuse_other_convergence,
    stated_convergence,
)
from surveyapp.core.geodesy import (
    MAX_LATITUDE_DEG,
    WARN_LATITUDE_DEG,
    Grid,
    Position,
    grid_of,
    latitude_problem,
    position_of,
)
from surveyapp.core.orientation.adopted import apply_adopted
from surveyapp.core.orientation.assumed_shares import with_shares
from surveyapp.core.orientation.calibration_sessions import calibrations_of
from surveyapp.core.orientation.campaign_columns import session_temperature
from surveyapp.core.orientation.deflection_field import DeflectionField, deflection_field
from surveyapp.core.orientation.error_terms import (
    Circumstance,
    distance_warnings,
    latitude_warnings,
    with_error_terms,
)
from surveyapp.core.orientation.instrument_constant import (
    InstrumentConstant,
    determine,
)
from surveyapp.core.orientation.lines import (
    LineGeometry,
    OrientedLine,
    line_geometry,
)
from surveyapp.core.orientation.pooled_weights import with_pooled_weights
from surveyapp.core.orientation.pooled_zeros import with_pooled_tape_zeros
from surveyapp.core.orientation.predicted_lines import predicted_lines
from surveyapp.core.orientation.repeated_runs import run_groups, scatter_of
from surveyapp.core.orientation.scatter_sigma import with_scatter_sigma, without_answered
from surveyapp.core.orientation.sequence import date_warnings
from surveyapp.core.orientation.survey_lines import SurveyedLines
from surveyapp.core.statistics.repeated import RunScatter
from surveyapp.core.swing.goodness import Judge
from surveyapp.core.swing.run_model import RunModel
from surveyapp.core.swing.session import (
    ReducedSession,
    SightSigma,
    collect_sights,
    known_target,
    pooled_sight_sigma,
    reduce_swing,
    reduce_targets,
    sight_resolution,
)
from surveyapp.core.swing.sights import SightSet, tripod_twist, zenith_angle
from surveyapp.domain.advance import Advance, silent
from surveyapp.domain.project import OrientationSession, Project, Station
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said


@dataclass(frozen=True, slots=True)
class Orientation:
    """A computed project, contributions still apart: results and checks are made from it.

    ``lines`` are those of all survey sessions; ``shown_lines`` those of the one session that was
    asked for, from it alone, and the same as ``lines`` where none was.
    """

    project: Project
    grid: Grid | None
    positions: Mapping[str, Position]
    sessions: tuple[ReducedSession, ...]
    sight_sigmas: Mapping[str, SightSigma]
    scatters: Mapping[str, RunScatter]
    constants: tuple[InstrumentConstant, ...]
    lines: tuple[OrientedLine, ...]
    shown_lines: tuple[OrientedLine, ...]
    warnings: tuple[ResultWarning, ...]
    deflections: DeflectionField


def orient_project(
    project: Project,
    rng: np.random.Generator,
    *,
    estimator: str | None = None,
    only: str | None = None,
    run_model: RunModel | None = None,
    judged: bool = True,
    advance: Advance = silent,
) -> Orientation:
    """Reduce every session, determine the constants, orient every line.

    Parameters
    ----------
    project : Project
    rng : numpy.random.Generator
        For the null distributions of the tests of fit.
    estimator : str or None
        For all sessions; None for the default of each method.
    only : str or None
        Orient lines with this survey session alone as well; the constants come from all
        calibrations.
    run_model : callable or None
        Estimates runs with adopted effects.
    judged : bool
        Whether somebody will judge it; without, no fit is tested.
    advance : callable
        Told how many sessions are reduced.

    Raises
    ------
    SurveyError
        With the problems of all sessions together.
    """
    grid = grid_of(project)
    positions = {station.name: position_of(station, grid) for station in project.stations}
    stations = {s.name: _with_position(s, positions[s.name]) for s in project.stations}
    warnings = [*project.warnings, *check_adopted(project)]
    judge = Judge(sessions=sum(s.method != "automatic" for s in project.sessions), asked=judged)
    setting = _Setting(project, positions, stations, judge, estimator, run_model)
    reduced, sigmas = _reduce_all(setting, advance)
    measured = reduced = with_pooled_weights(with_pooled_tape_zeros(reduced))
    for instrument in project.instruments:
        reduced, found = apply_adopted(instrument, reduced, positions)
        warnings += found
    deflections = deflection_field(project, positions)
    geometry = _geometries(reduced, stations, grid, positions, field=deflections)
    reduced = _with_terms(project, reduced, geometry)
    warnings += latitude_warnings(project, positions)
    warnings += distance_warnings(project, positions)
    groups = {item.id: run_groups(project, reduced, item.id) for item in project.instruments}
    reduced, more = with_scatter_sigma(project, reduced, groups)
    measured = without_answered(measured, reduced)
    warnings += more
    scatters = {
        item.id: scatter_of(run_groups(project, reduced, item.id)) for item in project.instruments
    }
    refuse_one_place(geometry)
    refuse_other_convergence(project, geometry)
    warnings += place_warnings(list(geometry.values()), grid)
    constants, more = _constants(project, reduced, geometry, scatters)
    warnings += more
    known, predicted, more = predicted_lines(reduced, constants, positions, None)
    warnings += more
    surveyed = SurveyedLines(project, reduced, known, geometry, scatters, stations)
    lines, more = surveyed.oriented(predicted)
    shown = lines
    if only is not None:
        predicted = predicted_lines(reduced, constants, positions, only)[1]
        shown, more = surveyed.oriented(predicted, only)
    warnings += more
    return Orientation(
        project,
        grid,
        positions,
        measured,
        sigmas,
        scatters,
        known,
        lines,
        shown,
        with_shares(project, warnings, lines),
        deflections,
    )


def _constants(
    project: Project,
    reduced: Sequence[ReducedSession],
    geometry: Mapping[tuple[str, str], LineGeometry],
    scatters: Mapping[str, RunScatter],
) -> tuple[list[InstrumentConstant], list[ResultWarning]]:
    constants = []
    warnings: list[ResultWarning] = []
    for instrument in project.instruments:
        calibrations, more = calibrations_of(
            project, reduced, instrument.id, geometry, scatter=scatters[instrument.id]
        )
        warnings += more
        constants.append(determine(instrument, calibrations))
    return constants, warnings


def _with_terms(
    project: Project,
    reduced: Sequence[ReducedSession],
    geometry: Mapping[tuple[str, str], LineGeometry],
) -> tuple[ReducedSession, ...]:
    """Every gyro azimuth with the errors that no residual shows."""
    found = []
    for item in reduced:
        card = project.instrument(item.session.instrument).card
        temperature = session_temperature(item.session)
        targets = tuple(
            with_error_terms(
                item,
                target,
                Circumstance(card, geometry[item.session.id, target.target], temperature),
            )
            for target in item.targets
        )
        found.append(replace(item, targets=targets))
    return tuple(found)


def _with_position(station: Station, at: Position) -> Station:
    return replace(station, e=at.e, n=at.n, latitude=at.latitude, longitude=at.longitude)


@dataclass(frozen=True, slots=True)
class _Setting:
    """What the reduction of every session needs."""

    project: Project
    positions: Mapping[str, Position]
    stations: Mapping[str, Station]
    judge: Judge
    estimator: str | None
    run_model: RunModel | None


def _reduce_all(
    setting: _Setting, advance: Advance
) -> tuple[tuple[ReducedSession, ...], dict[str, SightSigma]]:
    problems: list[Problem] = []
    sights: dict[str, dict[str, SightSet]] = {}
    for session in setting.project.sessions:
        try:
            known_target(session, setting.stations)
            sights[session.id] = collect_sights(session)
        except SurveyError as error:
            problems += error.problems
    sigmas = _sight_sigmas(setting.project, sights)
    reduced = []
    for place, session in enumerate(setting.project.sessions):
        advance("sessions reduced", place, len(setting.project.sessions))
        if session.id not in sights:
            continue
        try:
            sigma = sigmas[session.instrument]
            reduced.append(_reduce_one(setting, session, sights[session.id], sigma))
        except SurveyError as error:
            problems += error.problems
    if problems:
        raise SurveyError(problems)
    return tuple(reduced), sigmas


def _sight_sigmas(
    project: Project, sights: Mapping[str, Mapping[str, SightSet]]
) -> dict[str, SightSigma]:
    result = {}
    for instrument in project.instruments:
        own = [s for s in project.sessions if s.instrument == instrument.id and s.id in sights]
        result[instrument.id] = pooled_sight_sigma(
            [item for session in own for item in sights[session.id].values()],
            resolution=min(
                (sight_resolution(session) for session in own if sights[session.id]), default=0.0
            ),
            fallback=instrument.card.sigma.reversal,
        )
    return result


def _reduce_one(
    setting: _Setting,
    session: OrientationSession,
    sights: Mapping[str, SightSet],
    sigma: SightSigma,
) -> ReducedSession:
    card = setting.project.instrument(session.instrument).card
    latitude = setting.positions[session.station].latitude
    warnings = _latitude_warnings(session, latitude, card.valid.latitude_max)
    warnings += date_warnings(session)
    reduction = reduce_swing(
        session,
        card,
        setting.judge,
        latitude=latitude,
        estimator=setting.estimator,
        run_model=setting.run_model,
        twist=tripod_twist(list(sights.values())),
    )
    targets = reduce_targets(
        session, reduction, sights, sigma=sigma, stations=setting.stations, card=card
    )
    if not targets:
        text = said("session {id}: no sight of a target: gyro north only, no line", id=session.id)
        warnings.append(ResultWarning("no_line", text, Subject.session(session.id)))
    for target in targets:
        if target.sights is not None and target.sights.collimation is None:
            text = said(
                "session {id}: {target} was sighted in one face only: the collimation "
                "error stays in the line",
                id=session.id,
                target=target.target,
            )
            subject = Subject.session(session.id, target.target)
            warnings.append(ResultWarning("one_face", text, subject))
    own = Subject.session(session.id)
    told = tuple(item.about(own) for item in (*reduction.warnings, *warnings))
    return ReducedSession(session, reduction, targets, told)


def _latitude_warnings(
    session: OrientationSession, latitude: float | None, allowed: float | None
) -> list[ResultWarning]:
    """Refuse or warn of a latitude; the card's own limit replaces the general 75 degrees."""
    if latitude is None:
        text = said(
            "session {id}: the latitude of {station} is not known: card values hold "
            "for their own latitude",
            id=session.id,
            station=session.station,
        )
        return [ResultWarning("latitude_unknown", text, Subject.session(session.id))]
    degrees = abs(math.degrees(latitude))
    limit = MAX_LATITUDE_DEG if allowed is None else math.degrees(allowed)
    if degrees > limit:
        problem = latitude_problem(
            latitude,
            said("session {id}, station {station}", id=session.id, station=session.station),
        )
        if problem is None:
            problem = Problem(
                what="the station lies beyond the latitude for which the instrument is made",
                where=said(
                    "session {id}, station {station}", id=session.id, station=session.station
                ),
                found=said("latitude {latitude:.4f} degrees", latitude=math.degrees(latitude)),
                expected=said("at most {limit:g} degrees (the instrument's [range])", limit=limit),
                hint="Check the coordinates or the instrument's latitude_max_deg.",
            )
        raise SurveyError(problem)
    if degrees > WARN_LATITUDE_DEG:
        text = said(
            "session {id}: latitude {latitude:.2f} degrees: the meridian-seeking "
            "moment is {latitude2:.0%} of that at the equator",
            id=session.id,
            latitude=math.degrees(latitude),
            latitude2=math.cos(latitude),
        )
        return [ResultWarning("latitude_high", text, Subject.session(session.id))]
    return []


def _geometries(
    reduced: Sequence[ReducedSession],
    stations: Mapping[str, Station],
    grid: Grid | None,
    positions: Mapping[str, Position],
    *,
    field: DeflectionField,
) -> dict[tuple[str, str], LineGeometry]:
    """Geometry of every sighted line by (session, target); sessions alike have the same one."""
    result = {}
    known: dict[tuple[object, ...], LineGeometry] = {}
    for item in reduced:
        session = item.session
        stated = stated_convergence(session, stations[session.station])
        for target in item.targets:
            zenith = zenith_angle(session.book, target.target, default_target=session.target)
            key = (session.station, target.target, zenith, stated)
            if key not in known:
                known[key] = line_geometry(
                    stations[session.station],
                    stations[target.target],
                    grid=grid,
                    positions=positions,
                    zenith=zenith,
                    stated=stated,
                    deflection_sources=field.sources[session.station],
                )
            result[session.id, target.target] = known[key]
    return result
