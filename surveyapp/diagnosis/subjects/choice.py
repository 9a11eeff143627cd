"""From a project to what the engine diagnoses: a reversal run, or the campaign of an instrument.

A campaign consists of the determinations of the instrument constant; where an instrument was
never calibrated, of its repeated azimuths of one line.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from surveyapp.core.checks.adopted_checks import occurrences
from surveyapp.core.orientation.adopted import SOURCE
from surveyapp.core.orientation.adopted_course import courses_of
from surveyapp.core.orientation.campaign_columns import Name
from surveyapp.core.orientation.circumstances import Circumstances, facts_of
from surveyapp.core.orientation.set_ups import one_a_set_up
from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.core.statistics.repeated import SHARED
from surveyapp.core.swing.run_model import ModelledNorth
from surveyapp.core.swing.run_points import turning_points, without_tape_drift, without_twist
from surveyapp.core.swing.sights import TripodTwist, moments
from surveyapp.core.swing.tracking import tape_zero_of
from surveyapp.core.uncertain import Uncertain
from surveyapp.diagnosis.candidates import Candidate, all_candidates
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit, Member, fit_members
from surveyapp.diagnosis.run_value import value_of
from surveyapp.diagnosis.subjects.campaign import CampaignDetermination, campaign
from surveyapp.diagnosis.subjects.reversal_run import TurningPoints, reversal_run
from surveyapp.domain.instrument import AdoptedEffect, InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import ReadingKind
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said
from surveyapp_models.angles import wrap_pi
from surveyapp_models.effects.effect import Effect

LEAST_CAMPAIGN = 3
"""Sessions from which an instrument counts as a campaign by itself (design.md section 5)."""


def is_run(session: OrientationSession) -> bool:
    """Whether a session is a reversal run."""
    return bool(session.book.of_kind(ReadingKind.REVERSAL))


def run_problem(
    session: OrientationSession,
    card: InstrumentCard,
    *,
    latitude: float | None,
    twist: TripodTwist | None = None,
    extra: tuple[Effect, ...] = (),
) -> Case:
    """The turning points of one session as a problem.

    Parameters
    ----------
    session : OrientationSession
    card : InstrumentCard
    latitude : float or None
        [rad], for the drift of the tape zero, which is known and taken out first.
    twist : TripodTwist or None
        Turning of the tripod that the sights tell: known and taken out as well.
    extra : tuple of Effect
        The user's own; the courses that the session has adopted are tried in any case.

    Raises
    ------
    SurveyError
        If the session has no turning points on the circle, or too few.
    """
    if not is_run(session):
        raise SurveyError(
            Problem(
                "only a reversal run can be diagnosed by itself",
                said("session {id}", id=session.id),
                said("method {method} without reversal rows", method=session.method),
                "turning points on the circle",
                "Diagnose the campaign of its instrument instead.",
            )
        )
    points = turning_points(session)
    zero, coefficient, _, _ = tape_zero_of(session, card, points.rows, latitude)
    points = without_twist(without_tape_drift(points, zero, coefficient), twist)
    times = moments(points.rows)
    temperature = [
        math.nan if row.temperature_c is None else row.temperature_c for row in points.rows
    ]
    known = not all(math.isnan(value) for value in temperature)
    own = {effect.id for effect in extra}
    carried = tuple(item for item in courses_of(session.effects) if item.id not in own)
    return reversal_run(
        TurningPoints(
            readings=(points.origin + points.values).tolist(),
            count=points.index.tolist(),
            right=(points.sides > 0).tolist(),
            elapsed_s=None if times is None else (times - times[0]).tolist(),
            covariates={"temperature_c": temperature} if known else {},
            resolution=points.resolution,
            sigma=card.sigma.reversal,
            reference_temperature_c=session.reference_temperature_c,
            instrument=session.instrument,
            identity=session.id,
        ),
        (*extra, *carried),
    )


def adopted_fit(problem: Case, effects: Sequence[AdoptedEffect]) -> Fit:
    """Fit of a run with its adopted effects in the model, all estimated anew.

    Raises
    ------
    SurveyError
        If an adopted effect is none of the subject's, or its columns are missing.
    """
    base = fit_members(problem, ())
    known = {
        candidate.id: candidate
        for candidate in all_candidates(problem, base.theta)
        if candidate.kind == "named" and candidate.count == 1
    }
    members = []
    for adopted in effects:
        candidate = known.get(adopted.id)
        if candidate is None or candidate.missing:
            raise SurveyError(
                Problem(
                    "an adopted effect cannot be applied to this run",
                    problem.identity,
                    adopted.id if candidate is None else f"{adopted.id}: {candidate.missing}",
                    hint=nearest_names(adopted.id, known),
                )
            )
        members += [Member(candidate, place) for place in _places(candidate, adopted)]
    return fit_members(problem, members, base.theta)


def _places(candidate: Candidate, adopted: AdoptedEffect) -> list[int]:
    """Grid points of an adopted effect, one for each time that it occurs."""
    grid = {name: value for name, value in adopted.grid if not isinstance(value, str)}
    count = 1 if candidate.effect is None else occurrences(adopted, candidate.effect)
    places = []
    for k in range(1, count + 1):
        distances = [
            sum(abs(grid.get(n if count == 1 else f"{n}_{k}", v) - v) for n, v in point.items())
            for point in candidate.points
        ]
        places.append(int(np.argmin(distances)))
    return places


def modelled_run(
    session: OrientationSession,
    card: InstrumentCard,
    latitude: float | None,
    twist: TripodTwist | None = None,
) -> ModelledNorth:
    """Observed north of a session with its adopted effects, before the tape-zero correction.

    ``latitude`` [rad].
    """
    problem = run_problem(session, card, latitude=latitude, twist=twist)
    fit = adopted_fit(problem, session.effects)
    value = value_of(problem, fit)
    first, decay = (0.0, 0.0) if fit.theta is None else (float(fit.theta[0]), float(fit.theta[1]))
    return ModelledNorth(
        value=value.value + problem.offset,
        sigma=value.sigma,
        dof=value.dof,
        residuals=fit.residual,
        design=fit.design,
        amplitude=abs(first),
        damping_ratio=math.exp(-decay),
    )


def determinations(orientation: Orientation, instrument: str) -> tuple[CampaignDetermination, ...]:
    """Every determination of the constant of one instrument, in order of time where it is known.

    The sigma is that of what belongs to one determination alone: centring, deflection and the
    known azimuth are the line's own, and whether a line stands off is to be found, not assumed.
    Several lines sighted from one set-up are one determination.
    """
    by_key = facts_of(orientation.sessions, instrument, orientation.positions)
    constant = next(c for c in orientation.constants if c.instrument.id == instrument)
    found = []
    lines: dict[str, list[str]] = {}
    for calibration in constant.calibrations:
        lines.setdefault(calibration.session, []).append(str(calibration.line))
    for calibration, facts in one_a_set_up(constant.calibrations, by_key):
        own = calibration.value.without(
            *SHARED, said("run-to-run scatter"), said("{source} outside its range", source=SOURCE)
        )
        label = f"{calibration.session} ({' + '.join(lines[calibration.session])})"
        subject = Subject.session(calibration.session, calibration.target)
        found.append(_determination(calibration.value.value, own, facts, subject, label=label))
    return _in_time(found if found else _azimuths(orientation, instrument, by_key))


def _in_time(items: Sequence[CampaignDetermination]) -> tuple[CampaignDetermination, ...]:
    """In order of time, whatever the order of the project's tables.

    Where every date is the same (or none is known) the sequence stands in for time.
    """
    if len({item.day for item in items}) > 1:
        if any(item.day is None for item in items):
            return tuple(items)
        return tuple(sorted(items, key=lambda item: (item.day or 0.0, item.label)))
    stated = all(item.circumstances.order is not None for item in items)
    return tuple(
        replace(item, circumstances=item.circumstances.undated(None if stated else float(place)))
        for place, item in enumerate(items)
    )


def _azimuths(
    orientation: Orientation,
    instrument: str,
    by_key: dict[tuple[str, str], Circumstances],
) -> list[CampaignDetermination]:
    """Repeated gyro azimuths of the most often observed line of an uncalibrated instrument."""
    lines: dict[Name, list[CampaignDetermination]] = {}
    for item in orientation.sessions:
        if item.session.instrument != instrument:
            continue
        for target in item.targets:
            if target.gyro_azimuth is None:
                continue
            facts = by_key[item.session.id, target.target]
            members = lines.setdefault(facts.name("line"), [])
            value = target.gyro_azimuth.value
            if members:
                first = -members[0].value
                value = first + wrap_pi(value - first)
            # a larger gyro azimuth is a smaller constant
            subject = Subject.session(item.session.id, target.target)
            own = target.gyro_azimuth
            members.append(_determination(-value, own, facts, subject, label=subject.id))
    longest: list[CampaignDetermination] = []
    for members in lines.values():
        longest = members if len(members) > len(longest) else longest
    return longest


def _determination(
    value: float, own: Uncertain, facts: Circumstances, subject: Subject, *, label: str
) -> CampaignDetermination:
    sigma = own.sigma
    stated = sigma if 0.0 < sigma < math.inf else None
    return CampaignDetermination(value, stated, facts, label, subject)


def campaign_problem(
    orientation: Orientation,
    instrument: str,
    *,
    extra: tuple[Effect, ...] = (),
    confirm_from: str | None = None,
) -> tuple[Case, Case | None]:
    """The campaign of one instrument, and the part of it that is held back to confirm.

    Parameters
    ----------
    confirm_from : str or None
        Session from which on the determinations choose nothing and only confirm.

    Raises
    ------
    SurveyError
        If there are too few determinations, or no such session among them.
    """
    items = determinations(orientation, instrument)
    reference = next(
        (
            session.reference_temperature_c
            for session in orientation.project.sessions
            if session.instrument == instrument and session.reference_temperature_c is not None
        ),
        None,
    )
    cut = len(items)
    if confirm_from is not None:
        sessions = ["" if item.subject is None else item.subject.id for item in items]
        if confirm_from not in sessions:
            raise SurveyError(
                Problem(
                    "the confirming session is no determination of this instrument",
                    "confirm",
                    confirm_from,
                    said("a calibration session of {instrument}", instrument=instrument),
                    nearest_names(confirm_from, sessions),
                )
            )
        cut = sessions.index(confirm_from)
        _check_parts(cut, len(items), confirm_from)
    named = _value_told(orientation, instrument)
    first, *later = (
        named(campaign(part, instrument=instrument, reference_temperature_c=reference, extra=extra))
        for part in (items[:cut], items[cut:])
        if part
    )
    return first, next(iter(later), None)


def _value_told(orientation: Orientation, instrument: str) -> Callable[[Case], Case]:
    """What names the value of a campaign that has repeated azimuths in place of constants."""
    constant = next(c for c in orientation.constants if c.instrument.id == instrument)

    def named(case: Case) -> Case:
        if constant.calibrations:
            return case
        text = said(
            "{instrument} has no determination of its constant: repeated gyro azimuths of one line "
            "are compared, and the value is their mean with its sign turned",
            instrument=instrument,
        )
        return replace(
            case,
            value_name=said("minus the gyro azimuth of the line"),
            warnings=(*case.warnings, ResultWarning("azimuths_for_constants", text)),
        )

    return named


def _check_parts(cut: int, count: int, confirm_from: str) -> None:
    """Both parts of a campaign must be campaigns, in order of time."""
    if min(cut, count - cut) < 2:
        raise SurveyError(
            Problem(
                "the confirming session leaves no two parts of the campaign",
                "confirm",
                said(
                    "{confirm_from}: {cut} determinations before it, {value} from it on",
                    confirm_from=confirm_from,
                    cut=cut,
                    value=count - cut,
                ),
                "at least 2 in each part; from 8 before it on an effect can be named",
                "Name the session from which on, in time, the determinations only confirm.",
            )
        )
