"""A project oriented and judged, once: the value that every command, screen and record is made of.

Nothing is read here: the project holds everything that its folder says.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surveyapp.core.checks.evidence import Evidence, TraverseEvidence
from surveyapp.core.checks.verdicts import verdicts, verdicts_of
from surveyapp.core.network.collector import paused_collection
from surveyapp.core.network.oriented import oriented_lines, with_shared_errors
from surveyapp.core.network.traverse_network import network_of
from surveyapp.core.orientation.outcome import outcome
from surveyapp.core.orientation.unfinished import waiting_sides, without_unfinished
from surveyapp.core.orientation.whole_project import Orientation, orient_project
from surveyapp.domain.advance import Advance, silent
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.project import Project
from surveyapp.domain.results import OrientationResult
from surveyapp.domain.subject import Subject
from surveyapp.domain.traverse import GyroConstant, Network, OrientedLine
from surveyapp.domain.warning import ResultWarning
from surveyapp.workflows.underground import breakthrough_evidence, shaft_evidence


@dataclass(frozen=True, slots=True)
class OrientedProject:
    """A project with its orientation: networks of its traverses come from here.

    Parameters
    ----------
    project : Project
        As read.
    orientation : Orientation
        Of its finished sessions.
    sides : tuple of OrientedLine
        Gyro sides for traverses.
    constants : tuple of GyroConstant
        That the sides share.
    notes : tuple of ResultWarning
        What a network with these sides must tell.
    """

    project: Project
    orientation: Orientation
    sides: tuple[OrientedLine, ...]
    constants: tuple[GyroConstant, ...]
    notes: tuple[ResultWarning, ...]

    def result(self, software: str = "") -> OrientationResult:
        """Sessions, constants and lines without any verdict."""
        return outcome(self.orientation, (), software=software)

    def network(self, traverse: str | None = None) -> Network:
        """Network of one traverse, or of all of them together, gyro sides included.

        Raises
        ------
        SurveyError
            No such traverse, or a gyro side that no session has oriented.
        """
        waiting = waiting_sides(self.project, self.orientation.project)
        found = network_of(self.project, traverse, self.sides, self.constants, waiting=waiting)
        told = (*found.warnings, *self.notes, *self._of_sides(found))
        return replace(found, warnings=tuple(dict.fromkeys(told)))

    def _of_sides(self, network: Network) -> list[ResultWarning]:
        """What the orientation tells of the gyro sides of a network and of their instruments."""
        used = {
            frozenset((row.at, row.to))
            for row in network.observations
            if row.kind is ObservationKind.GYRO
        }
        lines = [line.result for line in self.orientation.lines]
        sides = [line for line in lines if {line.station, line.target} in used]
        subjects = {line.subject for line in sides}
        subjects |= {Subject.of("instrument", line.instrument) for line in sides}
        return [item for item in self.orientation.warnings if item.subject in subjects]


@dataclass(frozen=True, slots=True)
class Computed:
    """A project oriented and judged.

    Parameters
    ----------
    oriented : OrientedProject
    evidence : Evidence
        What the checks have looked at.
    result : OrientationResult
        Sessions, constants, lines, every verdict.
    """

    oriented: OrientedProject
    evidence: Evidence
    result: OrientationResult

    @property
    def project(self) -> Project:
        """The project as read."""
        return self.oriented.project

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON: those of the result."""
        return self.result.to_dict()

    @property
    def orientation(self) -> Orientation:
        """The orientation of its finished sessions."""
        return self.oriented.orientation

    def network(self, traverse: str | None = None) -> Network:
        """Network of one traverse, or of all of them together, gyro sides included."""
        for item in self.evidence.traverses:
            if item.traverse.name == traverse:
                return item.network
        return self.oriented.network(traverse)


def generator_of(project: Project) -> np.random.Generator:
    """Random generator whose seed is the digest of the input: the same input, the same result."""
    return np.random.default_rng(int(project.digest[:16] or "0", 16))


@paused_collection()
def oriented(
    project: Project,
    *,
    estimator: str | None = None,
    session: str | None = None,
    keep: Collection[str] = (),
    all_if_none: bool = True,
    judged: bool = True,
    advance: Advance = silent,
) -> OrientedProject:
    """Orient the finished sessions of a project.

    Parameters
    ----------
    project : Project
    estimator : str or None
        For all sessions; None for the default of each method.
    session : str or None
        Orient its lines from this session alone as well.
    keep : collection of str
        Sessions that stay although they are not finished: their error is told.
    all_if_none : bool
        Where no session is finished, whether all are tried, so that what they lack is an error.
    judged : bool
        Whether it will be judged; without, no fit is tested, which takes half of the time.
    advance : callable
        Told how far it is.

    Raises
    ------
    SurveyError
        With the problems of all sessions together.
    """
    kept = without_unfinished(project, keep=keep)
    if all_if_none and not kept.sessions:
        kept = project
    run_model = None
    if any(item.effects for item in kept.sessions):
        from surveyapp.diagnosis.subjects.choice import modelled_run

        run_model = modelled_run
    found = orient_project(
        kept,
        generator_of(project),
        estimator=estimator,
        only=session,
        run_model=run_model,
        judged=judged,
        advance=advance,
    )
    sides, constants, warnings = oriented_lines([line.result for line in found.lines])
    gyro = {
        (row.at, row.to)
        for traverse in project.traverses
        for row in traverse.rows
        if row.kind is ObservationKind.GYRO
    }
    sides, constants = with_shared_errors((sides, constants), found.lines, found.deflections, gyro)
    left_out = kept.warnings[len(project.warnings) :]
    return OrientedProject(project, found, sides, constants, (*warnings, *left_out))


@paused_collection()
def judged(found: OrientedProject, *, software: str, session: str | None = None) -> Computed:
    """Judge an oriented project.

    Raises
    ------
    SurveyError
        If a traverse names a gyro side that no session has oriented.
    """
    project = found.project
    evidence = Evidence(
        project,
        found.orientation,
        tuple(
            TraverseEvidence(traverse, found.network(traverse.name))
            for traverse in project.traverses
            if traverse.rows
        ),
        breakthrough_evidence(found.orientation, project, software=software),
        shaft_evidence(project),
    )
    checks = verdicts(evidence)
    shown = checks if session is None else verdicts_of(checks, session)
    result = outcome(found.orientation, shown, software=software, only=session)
    return Computed(found, evidence, result)
