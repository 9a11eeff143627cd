"""What of a project is handed to other programs: adjusted points, observations, their sigmas."""

from __future__ import annotations

from dataclasses import replace

from surveyapp.core.geodesy.mine import grid_of
from surveyapp.core.geodesy.position import position_of
from surveyapp.core.network import adjust
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.exported import ExportedPoint, ExportedSurvey
from surveyapp.domain.observations import ANGULAR, Observation, ObservationKind
from surveyapp.domain.project import Project
from surveyapp.domain.traverse import Network
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import SurveyError
from surveyapp.languages import said

K = ObservationKind


def _adjusted(network: Network) -> tuple[AdjustmentResult | None, list[ResultWarning]]:
    try:
        return adjust(network, relative=False), []
    except SurveyError as refused:
        text = said(
            "the network cannot be adjusted, coordinates are those of the project: {refused}",
            refused=refused,
        )
        return None, [ResultWarning("not_adjusted", text)]


def _as_azimuths(network: Network) -> tuple[list[Observation], list[ResultWarning]]:
    """Gyro sides as grid azimuths, the sigma of a known constant in theirs."""
    constants = {item.name: item for item in network.constants}
    found, lost = [], []
    for obs in network.observations:
        if obs.kind is not K.GYRO:
            found.append(obs)
            continue
        constant = constants[obs.constant]
        if constant.sigma is None:
            lost.append(f"{obs.at}-{obs.to}")
            continue
        found.append(
            replace(
                obs,
                kind=K.AZIMUTH,
                value=obs.value + constant.value - obs.convergence,
                sigma=(obs.sigma**2 + constant.sigma**2) ** 0.5,
            )
        )
    if not lost:
        return found, []
    text = said("gyro sides without a known constant are left out: {names}", names=", ".join(lost))
    return found, [ResultWarning("gyro_left_out", text)]


def _points(
    project: Project, result: AdjustmentResult | None
) -> tuple[list[ExportedPoint], list[str]]:
    grid = grid_of(project)
    adjusted = {} if result is None else {point.name: point for point in result.points}
    points, lost = [], []
    for station in project.stations:
        own = adjusted.get(station.name)
        e, n, h = station.e, station.n, station.h
        if own is not None and own.e is not None and own.n is not None:
            e, n = own.e, own.n
            h = own.h if own.h is not None else h
        place = position_of(replace(station, e=e, n=n, latitude=None, longitude=None), grid)
        if e is None or n is None:
            place = position_of(station, grid)
        if place.e is None or place.n is None:
            lost.append(station.name)
            continue
        points.append(
            ExportedPoint(
                name=station.name,
                e=place.e,
                n=place.n,
                h=h,
                fixed=station.fixed,
                ellipse=None if own is None else own.ellipse,
                latitude=station.latitude if place.latitude is None else place.latitude,
                longitude=station.longitude if place.longitude is None else place.longitude,
            )
        )
    return points, lost


def _pairs(
    observations: list[Observation], kinds: frozenset[ObservationKind] | None
) -> list[tuple[str, str]]:
    """Pairs of points joined by observations, each once, in order."""
    found: dict[frozenset[str], tuple[str, str]] = {}
    for obs in observations:
        if kinds is not None and obs.kind not in kinds:
            continue
        for name in (obs.to, obs.back):
            if name:
                found.setdefault(frozenset((obs.at, name)), (obs.at, name))
    return list(found.values())


def exported_survey(project: Project, network: Network | None) -> ExportedSurvey:
    """Everything that a file for another program can be made of.

    Parameters
    ----------
    project : Project
    network : Network or None
        Of all its traverses, gyro sides included; None without a traverse.

    Returns
    -------
    ExportedSurvey
        Adjusted where that is possible; a station without coordinates is left out and told.

    Raises
    ------
    SurveyError
        If the project's grid cannot be used.
    """
    result, warnings = (None, []) if network is None else _adjusted(network)
    points, lost = _points(project, result)
    observations: list[Observation] = []
    gyro = [(s.station, s.target) for s in project.sessions if s.target and s.purpose == "survey"]
    if network is not None:
        observations, told = _as_azimuths(network)
        warnings += told
        gyro += [(o.at, o.to) for o in network.observations if o.kind is K.GYRO]
    if lost:
        text = said("stations without coordinates are left out: {names}", names=", ".join(lost))
        warnings.append(ResultWarning("station_left_out", text))
    return ExportedSurvey(
        name=project.name,
        crs=project.crs or "",
        points=tuple(points),
        observations=tuple(observations),
        sides=tuple(_pairs(observations, ANGULAR | {K.DISTANCE, K.SLOPE_DISTANCE})),
        gyro=tuple(dict.fromkeys(gyro)),
        warnings=tuple(warnings),
    )
