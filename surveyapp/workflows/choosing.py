"""Which subject of a project is diagnosed, and the problem that it makes.

The names come from the command line or a screen; what is missing or ambiguous is told with the
subjects to choose from. Nothing is diagnosed or written here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.swing.sights import tripod_twist
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.subjects.choice import (
    LEAST_CAMPAIGN,
    campaign_problem,
    is_run,
    run_problem,
)
from surveyapp.diagnosis.subjects.traverse import traverse as traverse_problem
from surveyapp.domain.project import Project
from surveyapp.domain.subject import SubjectKeyword
from surveyapp.domain.traverse import Network
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said
from surveyapp_models.effects.effect import Effect

Networks = Callable[[str], Network]
"""From the name of a traverse to its network, gyro sides included."""


@dataclass(frozen=True, slots=True)
class Diagnosable:
    """Something in a project that can be diagnosed.

    Parameters
    ----------
    keyword : str
        ``session``, ``campaign``, ``traverse``, ``sensor``: under which ``diagnose`` takes its id.
    id : str
    observations : int or None
        None of a sensor's log, which is not read for a list.
    """

    keyword: SubjectKeyword
    id: str
    observations: int | None

    def __iter__(self) -> Iterator[str]:
        """Keyword and id, for ``for keyword, name in subjects(...)``."""
        return iter((self.keyword, self.id))

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"option": f"--{self.keyword}", "id": self.id, "observations": self.observations}


def subjects_of(project: Project) -> tuple[Diagnosable, ...]:
    """Everything in a project that can be diagnosed by itself."""
    found = [
        Diagnosable("session", session.id, len(session.book.live))
        for session in project.sessions
        if is_run(session)
    ]
    for instrument in project.instruments:
        count = sum(session.instrument == instrument.id for session in project.sessions)
        if count >= LEAST_CAMPAIGN:
            found.append(Diagnosable("campaign", instrument.id, count))
    found += [Diagnosable("traverse", item.name, len(item.rows)) for item in project.traverses]
    return tuple(found)


def sensors_of(project: Project) -> tuple[Diagnosable, ...]:
    """The sensor logs of a project, which ``diagnose`` takes by ``--sensor``."""
    return tuple(Diagnosable("sensor", entry.id, None) for entry in project.sensor_logs)


@dataclass(frozen=True, slots=True)
class Request:
    """What is to be diagnosed.

    Parameters
    ----------
    session, campaign, traverse : str or None
        At most one of them.
    confirm : str or None
        A second run or traverse; for a campaign the session from which on determinations only
        confirm.
    effects : tuple of Effect
        The user's own.
    """

    session: str | None = None
    campaign: str | None = None
    confirm: str | None = None
    effects: tuple[Effect, ...] = ()
    traverse: str | None = None

    @property
    def subjects(self) -> int:
        """How many subjects are named."""
        return sum(item is not None for item in (self.session, self.campaign, self.traverse))


@dataclass(frozen=True, slots=True)
class Chosen:
    """The problem and its confirming set, or the subjects where one must be chosen."""

    problem: Case | None
    confirm: Case | None = None
    subjects: tuple[Diagnosable, ...] = ()


def choose(orientation: Orientation, request: Request, networks: Networks | None = None) -> Chosen:
    """Find what a request means in a project."""
    project = orientation.project
    if not request.subjects:
        subjects = subjects_of(project)
        if len(subjects) != 1:
            return Chosen(None, subjects=(*subjects, *sensors_of(project)))
        only = subjects[0]
        request = replace(
            request,
            session=only.id if only.keyword == "session" else None,
            campaign=only.id if only.keyword == "campaign" else None,
            traverse=only.id if only.keyword == "traverse" else None,
        )
    if request.subjects > 1:
        found = "several of session, campaign and traverse"
        raise SurveyError(Problem("one subject at a time", "diagnose", found, "one"))
    if request.traverse is not None:
        return _chosen_traverse(project, request, networks)
    if request.campaign is not None:
        names = [instrument.id for instrument in project.instruments]
        _require(request.campaign, names, "campaign", "instrument")
        return Chosen(
            *campaign_problem(
                orientation,
                request.campaign,
                extra=request.effects,
                confirm_from=request.confirm,
            )
        )
    problem = _run(orientation, request.session or "", "session", request.effects)
    if request.confirm is None:
        return Chosen(problem)
    return Chosen(problem, _run(orientation, request.confirm, "confirm", request.effects))


def _chosen_traverse(project: Project, request: Request, networks: Networks | None) -> Chosen:
    traverses = {item.name: item for item in project.traverses}

    def problem(name: str, option: str) -> Case:
        _require(name, list(traverses), option, "traverse")
        if networks is None:
            raise ValueError("a traverse needs its network")
        return traverse_problem(
            networks(name),
            name=f"traverse {name}",
            atmosphere_applied=traverses[name].atmosphere_applied,
            extra=request.effects,
            gyro_sigma=_gyro_sigma(project),
        )

    first = problem(request.traverse or "", "traverse")
    if request.confirm is None:
        return Chosen(first)
    return Chosen(first, problem(request.confirm, "confirm"))


def _gyro_sigma(project: Project) -> float | None:
    """The best stated sigma of a gyro azimuth [rad], for advice on traverses without one."""
    stated = [item.card.sigma.azimuth for item in project.instruments]
    return min((value for value in stated if value), default=None)


def _run(orientation: Orientation, identity: str, option: str, effects: tuple[Effect, ...]) -> Case:
    project = orientation.project
    _require(identity, [session.id for session in project.sessions], option, "session")
    session = project.session(identity)
    sights = [
        target.sights
        for item in orientation.sessions
        if item.session.id == identity
        for target in item.targets
        if target.sights is not None
    ]
    return run_problem(
        session,
        project.instrument(session.instrument).card,
        latitude=orientation.positions[session.station].latitude,
        twist=tripod_twist(sights),
        extra=effects,
    )


def _require(name: str, known: list[str], where: str, kind: str) -> None:
    if name not in known:
        hint = nearest_names(name, known)
        raise SurveyError(
            Problem(
                said("there is no {kind} of this name", kind=kind),
                where,
                name,
                said("the name of a known {kind}", kind=kind),
                hint,
            )
        )
