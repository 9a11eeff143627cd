"""Survey sessions grouped to lines, each with the constant that it uses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from surveyapp.core.checks.blunders import azimuth_warnings
from surveyapp.core.orientation.calibration_sessions import centring_of, own_centring, rounds_of
from surveyapp.core.orientation.instrument_constant import Chosen, InstrumentConstant, choose
from surveyapp.core.orientation.lines import LineGeometry, OrientedLine, Round, orient_line
from surveyapp.core.orientation.predicted_lines import Key, PredictedLine, survey_groups
from surveyapp.core.orientation.prediction_notes import leaves_out
from surveyapp.core.orientation.running_constant import running_constant
from surveyapp.core.orientation.sequence import SessionOrder
from surveyapp.core.statistics.repeated import RunScatter
from surveyapp.core.swing.session import ReducedSession
from surveyapp.core.uncertain import Uncertain
from surveyapp.domain.project import Project, Station, grid_distance_m
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said


@dataclass(frozen=True, slots=True)
class SurveyedLines:
    """The reduced sessions of a project with what their lines need.

    Parameters
    ----------
    project : Project
    reduced : sequence of ReducedSession
    constants : sequence of InstrumentConstant
    geometry : mapping
        By session and target.
    scatters : mapping
        By instrument.
    stations : mapping
        By name, with positions in the grid.
    """

    project: Project
    reduced: Sequence[ReducedSession]
    constants: Sequence[InstrumentConstant]
    geometry: Mapping[tuple[str, str], LineGeometry]
    scatters: Mapping[str, RunScatter]
    stations: Mapping[str, Station]

    def oriented(
        self, predicted: Mapping[Key, PredictedLine], only: str | None = None
    ) -> tuple[tuple[OrientedLine, ...], list[ResultWarning]]:
        """Orient every line of the survey sessions; A-B and B-A are two lines.

        Parameters
        ----------
        predicted : mapping of line to PredictedLine
            Of ``predicted_lines``, for the same sessions.
        only : str or None
            Use this session alone.

        Raises
        ------
        SurveyError
            If a session asks for a constant that does not exist.
        """
        known = {
            constant.instrument.id: (
                constant,
                self.scatters[constant.instrument.id],
                SessionOrder.of(self.project, constant.instrument.id),
            )
            for constant in self.constants
        }
        calibrated = frozenset(s.id for s in self.project.sessions if s.purpose == "calibration")
        lines: list[OrientedLine] = []
        warnings: list[ResultWarning] = []
        problems: list[Problem] = []
        for key, members in survey_groups(self.reduced, only).items():
            _, target, instrument = key
            try:
                rounds = [
                    replace(
                        _round(
                            item,
                            azimuth,
                            known[instrument],
                            predicted.get(key),
                            stations=self.stations,
                        ),
                        levelling=item.levelling_of(target),
                    )
                    for item, azimuth in members
                ]
            except SurveyError as error:
                problems += error.problems
                continue
            first = members[0][0].session
            line = orient_line(
                self.geometry[first.id, target],
                rounds,
                instrument=instrument,
                centring=centring_of(self.project, first),
                calibration_sessions=calibrated,
                agreement_of=[azimuth for _, azimuth in members],
            )
            lines.append(_with_drift(line, predicted.get(key)))
            warnings += [
                warning.about(Subject.session(item.session, target))
                for item in rounds
                for warning in item.chosen.warnings
            ]
            warnings += _line_warnings(lines[-1])
        if problems:
            raise SurveyError(problems)
        return tuple(lines), warnings


def _with_drift(line: OrientedLine, predicted: PredictedLine | None) -> OrientedLine:
    """The line with what its constant may be if the instrument drifts, where it is predicted."""
    if predicted is None or line.result.constant_choice != "predicted":
        return line
    return replace(line, result=replace(line.result, if_drifting=predicted.drifting))


def _round(
    item: ReducedSession,
    azimuth: Uncertain,
    known: tuple[InstrumentConstant, RunScatter, SessionOrder],
    predicted: PredictedLine | None,
    *,
    stations: Mapping[str, Station],
) -> Round:
    session = item.session
    constant, scatter, order = known
    choice = session.constant_choice or constant.choice
    if choice.kind == "predicted" and predicted is not None:
        chosen = Chosen(predicted.constant, "predicted")
        own = predicted.scatter.applied(azimuth, session.id)
        return Round(session.id, own, chosen, rounds_of(item), own_centring(session))

    def distance_to(name: str) -> float | None:
        return grid_distance_m(stations[session.station], stations[name])

    running = None
    if choice.kind == "running":
        running = running_constant(constant, choice.count, block=order.block(session.id))
    if running is not None:
        own = scatter.applied(azimuth, session.id)
        return Round(
            session.id, own, Chosen(running, str(choice)), rounds_of(item), own_centring(session)
        )
    chosen = choose(
        constant,
        choice,
        moment=order.moment(session.id),
        block=order.block(session.id),
        distance_to=distance_to,
        where=said("session {id}", id=session.id),
    )
    if predicted is not None and chosen.value is not None and choice.kind != "known":
        told = leaves_out(
            str(choice), chosen.value, predicted.constant, said("session {id}", id=session.id)
        )
        chosen = replace(chosen, warnings=(*chosen.warnings, told))
    own = scatter.applied(azimuth, session.id)
    return Round(session.id, own, chosen, rounds_of(item), own_centring(session))


def _line_warnings(line: OrientedLine) -> list[ResultWarning]:
    result = line.result
    name = said("line {station}-{target}", station=result.station, target=result.target)
    warnings = []
    if result.true_azimuth is None:
        text = said(
            "{name}: the instrument {instrument} has no constant: no true azimuth",
            name=name,
            instrument=result.instrument,
        )
        warnings.append(ResultWarning("no_constant", text, result.subject))
    if result.convergence is None:
        text = said("{name}: no crs or no position: no convergence, no grid azimuth", name=name)
        warnings.append(ResultWarning("no_grid", text, result.subject))
    elif result.arc_to_chord is None:
        text = said("{name}: the target has no position: arc-to-chord taken as zero", name=name)
        warnings.append(ResultWarning("arc_to_chord_unknown", text, result.subject))
    if result.distance_m is None:
        text = said("{name}: its length is not known: centring is not in its sigma", name=name)
        warnings.append(ResultWarning("centring_unknown", text, result.subject))
    return [*warnings, *azimuth_warnings(result)]
