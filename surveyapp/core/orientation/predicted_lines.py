"""The lines of a project with the constants that are predicted for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.circumstances import Circumstances, facts_of
from surveyapp.core.orientation.instrument_constant import InstrumentConstant
from surveyapp.core.orientation.predicted_constant import predict_constants, predictable
from surveyapp.core.orientation.prediction_notes import Wanted, too_few
from surveyapp.core.statistics.repeated import RunScatter, run_scatter, weights_of
from surveyapp.core.swing.session import ReducedSession
from surveyapp.core.uncertain import Uncertain, aligned
from surveyapp.domain.priors import DEFAULT_PRIORS
from surveyapp.domain.station_line import StationLine
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning

Key = tuple[str, str, str]
"""Station, target and instrument of a line."""
Members = list[tuple[ReducedSession, Uncertain]]


@dataclass(frozen=True, slots=True)
class PredictedLine:
    """The constant of a line and what each of its runs has beside its stated sigma.

    ``drifting`` is the half-width of its 95 % interval if the instrument drifts [rad], None where
    the determinations are not far from it in time.
    """

    constant: Uncertain
    scatter: RunScatter
    drifting: float | None = None


def survey_groups(reduced: Sequence[ReducedSession], only: str | None) -> dict[Key, Members]:
    """Survey sessions by line."""
    groups: dict[Key, Members] = {}
    for item in reduced:
        session = item.session
        if session.purpose != "survey" or (only is not None and session.id != only):
            continue
        for target in item.targets:
            if target.gyro_azimuth is not None:
                key = (session.station, target.target, session.instrument)
                groups.setdefault(key, []).append((item, target.gyro_azimuth))
    return groups


def predicted_lines(
    reduced: Sequence[ReducedSession],
    constants: Sequence[InstrumentConstant],
    positions: Mapping[str, Position],
    only: str | None,
) -> tuple[tuple[InstrumentConstant, ...], dict[Key, PredictedLine], list[ResultWarning]]:
    """The constants with their average over the campaign, and that of every survey line.

    Where an instrument has too few determinations it is passed on as it is.

    Parameters
    ----------
    only : str or None
        Survey lines with this session alone.
    """
    groups = survey_groups(reduced, only)
    found: list[InstrumentConstant] = []
    lines: dict[Key, PredictedLine] = {}
    warnings: list[ResultWarning] = []
    for constant in constants:
        name = constant.instrument.id
        if not predictable(constant):
            found.append(constant)
            if any(instrument == name for _, _, instrument in groups):
                warnings += too_few(constant)
            continue
        facts = facts_of(reduced, name, positions)
        own = {key: members for key, members in groups.items() if key[2] == name}
        wanted = [_wanted(key, members, facts) for key, members in own.items()]
        result = predict_constants(
            constant, facts, wanted, constant.instrument.priors or DEFAULT_PRIORS
        )
        # the lines repeat themselves too: whichever of both tells of more
        seen = run_scatter([aligned([a for _, a in members]) for members in own.values()])
        scatter = seen if seen.sigma > result.scatter.sigma else result.scatter
        for key, value, half in zip(own, result.lines, result.drifting, strict=True):
            lines[key] = PredictedLine(value, scatter, half)
        if constant.choice.kind == "predicted" or constant.instrument.constant_choice is None:
            warnings += [item.about(Subject.of("instrument", name)) for item in result.warnings]
        found.append(replace(constant, average=result.average))
    return tuple(found), lines, warnings


def _wanted(key: Key, members: Members, facts: Mapping[tuple[str, str], Circumstances]) -> Wanted:
    station, target, _ = key
    weights = weights_of(aligned([azimuth for _, azimuth in members]))
    visits = [facts[item.session.id, target] for item, _ in members]
    return Wanted(StationLine(station, target), tuple(zip(weights, visits, strict=True)))
