"""Calibration sessions to determinations of the instrument constant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from surveyapp.core.orientation.instrument_constant import Calibration
from surveyapp.core.orientation.known_azimuth import KnownError, known_error
from surveyapp.core.orientation.lines import LineGeometry, known_astronomic
from surveyapp.core.orientation.sequence import SessionOrder
from surveyapp.core.statistics.repeated import RunScatter
from surveyapp.core.swing.automatic import stated_rounds
from surveyapp.core.swing.session import ReducedSession
from surveyapp.domain.project import Centring, OrientationSession, Project, grid_bearing
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi

LARGEST_SHIFT_M = 0.1
"""Coordinates of mine stations are wrong by less [m]: beyond, one of the two is mistyped."""


def calibrations_of(
    project: Project,
    reduced: Sequence[ReducedSession],
    instrument: str,
    geometry: Mapping[tuple[str, str], LineGeometry],
    *,
    scatter: RunScatter,
) -> tuple[list[Calibration], list[ResultWarning]]:
    """Every determination of the constant of one instrument.

    A session is unusable, and a warning says so, where the grid azimuth of its line is not known,
    where there is no grid to form astronomic terms, or where it yields no gyro azimuth.
    """
    order = SessionOrder.of(project, instrument)
    found: list[Calibration] = []
    warnings: list[ResultWarning] = []
    assumed: dict[frozenset[str], ResultWarning] = {}
    for item in reduced:
        session = item.session
        if session.instrument != instrument or session.purpose != "calibration":
            continue
        for target in item.targets:
            line = geometry[session.id, target.target]
            bearing = grid_bearing(line.start, line.end)
            own = session.azimuth_known if target.target == session.target else None
            grid_azimuth = own if own is not None else bearing
            if grid_azimuth is None or target.gyro_azimuth is None:
                warnings.append(_unusable(session, target.target, said("its azimuth is not known")))
                continue
            known = known_error(project, session, line)
            true = known_astronomic(line, grid_azimuth, known.error)
            if true is None:
                warnings.append(
                    _unusable(session, target.target, said("no crs gives its convergence"))
                )
                continue
            for told in _assumed(session, target.target, known):
                assumed.setdefault(frozenset((session.station, target.target)), told)
            if own is not None and bearing is not None:
                warnings += _contradiction(session, line, wrap_pi(own - bearing))
            gyro = scatter.applied(target.gyro_azimuth, session.id)
            centring = line.centring(centring_of(project, session), own=own_centring(session))
            value = true - gyro + centring
            found.append(
                Calibration(
                    session=session.id,
                    station=session.station,
                    target=target.target,
                    value=value.shifted(wrap_pi(value.value) - value.value),
                    phase=order.phase(session.id),
                    block=order.block(session.id),
                    moment=order.moment(session.id),
                    rounds=rounds_of(item),
                    known_azimuth=grid_azimuth,
                    from_coordinates=bearing,
                    distance_m=line.distance_m,
                )
            )
    return found, [*warnings, *assumed.values()]


def _unusable(session: OrientationSession, target: str, why: str) -> ResultWarning:
    text = said(
        "session {id}, line {station}-{target}: no constant from it: {why}",
        id=session.id,
        station=session.station,
        target=target,
        why=why,
    )
    return ResultWarning("calibration_unusable", text, Subject.session(session.id, target))


def _contradiction(
    session: OrientationSession, line: LineGeometry, apart: float
) -> list[ResultWarning]:
    """Tell of a known azimuth that no error of the coordinates explains."""
    if not line.distance_m or abs(apart) * line.distance_m <= LARGEST_SHIFT_M:
        return []
    text = said(
        "session {id}: the known azimuth of {station}-{target} wins over the "
        'coordinates, which give {apart:+.1f}": {distance_m:.2f} m at the target',
        id=session.id,
        station=session.station,
        target=session.target,
        apart=-apart * RHO_ARCSEC,
        distance_m=abs(apart) * line.distance_m,
    )
    return [ResultWarning("azimuth_known_differs", text, Subject.session(session.id))]


def _assumed(session: OrientationSession, target: str, known: KnownError) -> list[ResultWarning]:
    """Ask for the sigma of a known azimuth that nobody states."""
    if known.origin != "default":
        return []
    text = said(
        "line {station}-{target}: nobody states how well its azimuth is known: "
        '+-{sigma:.1f}" is assumed; state azimuth_known_sigma_arcsec, sigma_m of '
        "its stations, or station_sigma_m of the project",
        station=session.station,
        target=target,
        sigma=known.error.sigma * RHO_ARCSEC,
    )
    subject = Subject.side(session.station, target)
    return [ResultWarning("known_azimuth_sigma_assumed", text, subject)]


def own_centring(session: OrientationSession) -> str | None:
    """The session whose centring error is its own, None where it stands as the others did."""
    return session.id if session.recentred else None


def rounds_of(item: ReducedSession) -> int:
    """Rounds that a session stands for: delivered rounds, else the run itself."""
    if item.session.method != "automatic":
        return 1
    return stated_rounds(item.session) or item.reduction.points_used


def centring_of(project: Project, session: OrientationSession) -> Centring:
    """Centring of a session: its own where it states one, else the project's."""
    own = dict(session.override).get("centring")
    return own if isinstance(own, Centring) else project.centring
