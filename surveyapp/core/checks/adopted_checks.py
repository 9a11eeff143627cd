"""Whether the adopted effects of a project can be used as they stand in project.toml.

They are written by ``diagnose --adopt`` and then lie in a file that anybody may edit: what no
longer fits its effect is refused, with everything wrong together, and what is only unknown is told.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from surveyapp.core.orientation.adopted import unknown_ranges, without_reference
from surveyapp.core.orientation.adopted_course import course_of, unexplained
from surveyapp.core.orientation.campaign_columns import LABELLED
from surveyapp.core.orientation.session_digest import sessions_digest
from surveyapp.domain.instrument import AdoptedEffect, Instrument
from surveyapp.domain.project import OrientationSession, Project
from surveyapp.domain.subject import Subject
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import listed, said
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Coefficient, Effect, SubjectId

CONTRADICTION = 0.01
"""Relative difference at which a stated sigma is not that of the covariance."""
HINT = said("Restore the table from the ledger, or take it out, diagnose again and adopt.")


def check_adopted(project: Project) -> list[ResultWarning]:
    """Check every adopted effect of a project.

    Returns
    -------
    list of ResultWarning
        ``adopted_data_changed``, ``course_not_explained``,
        ``adopted_without_reference``, ``effect_range_unknown``,
        ``known_constant_at_reference``.

    Raises
    ------
    SurveyError
        With everything that does not fit.
    """
    problems: list[Problem] = []
    warnings: list[ResultWarning] = []
    for instrument in project.instruments:
        where = said("instrument {id}", id=instrument.id)
        problems += _problems(instrument.effects, "campaign", where)
    for session in project.sessions:
        problems += _problems(
            session.effects, "reversal_run", said("orientation {id}", id=session.id)
        )
    if problems:
        raise SurveyError(problems)
    for instrument in project.instruments:
        warnings += _told(project, instrument)
    for session in project.sessions:
        warnings += unexplained(session)
        for adopted in session.effects:
            warnings += _changed(project, adopted, session)
    return warnings


def identity_of(adopted: AdoptedEffect, effect: Effect) -> tuple[object, ...]:
    """Two steps at different places are two effects; two temperatures are one twice."""
    scanned = {g.name for g in effect.grid if not g.continuous}
    return (adopted.id, *sorted((n, v) for n, v in adopted.grid if n in scanned))


def _problems(effects: Sequence[AdoptedEffect], subject: SubjectId, owner: str) -> list[Problem]:
    catalogue = {effect.id: effect for effect in of_subject(subject)}
    found: list[Problem] = []
    seen: Counter[tuple[object, ...]] = Counter()
    for adopted in effects:
        where = said("project.toml, {owner}, adopted effect {id}", owner=owner, id=adopted.id)
        effect = catalogue.get(adopted.id)
        if adopted.course and (effect is not None or subject != "reversal_run"):
            what = said("a saved course belongs to a run, and bears no name of the catalogue")
            found.append(Problem(what, where, adopted.id, "an id of its own, in a session"))
            continue
        effect = effect or course_of(adopted)
        if effect is None:
            hint = nearest_names(adopted.id, catalogue)
            found.append(
                Problem("an adopted effect is in no catalogue", where, adopted.id, "", hint)
            )
            continue
        seen[identity_of(adopted, effect)] += 1
        if seen[identity_of(adopted, effect)] == 2:
            text = said("an effect is adopted twice")
            found.append(Problem(text, where, "two tables", "one table", "Take one of them out."))
        found += _grid_problems(adopted, effect, where)
        found += _coefficient_problems(adopted, effect, where)
        found += _covariance_problems(adopted, where)
        if subject == "campaign":
            found += _column_problems(adopted, effect, where)
    return found


def occurrences(adopted: AdoptedEffect, effect: Effect) -> int:
    """How often an effect of a run stands in one table: several gross errors are one."""
    if adopted.coefficients:
        return max(1, len(adopted.coefficients) // len(effect.coefficients))
    return max(1, len(adopted.grid) // len(effect.grid)) if effect.grid else 1


def numbered(names: Sequence[str], count: int) -> list[str]:
    """Names of ``count`` occurrences of something: plain for one, else with their number."""
    if count == 1:
        return list(names)
    return [f"{name}_{k}" for k in range(1, count + 1) for name in names]


def _grid_problems(adopted: AdoptedEffect, effect: Effect, where: str) -> list[Problem]:
    expected = numbered([g.name for g in effect.grid], occurrences(adopted, effect))
    names = [name for name, _ in adopted.grid]
    if sorted(names) != sorted(expected):
        return [
            Problem(
                "the grid of an adopted effect does not fit it",
                where,
                ", ".join(names) or "no grid",
                ", ".join(expected) or "no grid",
                HINT,
            )
        ]
    return [
        Problem(
            said("{name} of an adopted effect is of the wrong kind", name=name),
            where,
            str(value),
            "a name in quotes" if name in LABELLED else "a number",
            HINT,
        )
        for name, value in adopted.grid
        if isinstance(value, str) != (name in LABELLED)
    ]


def _coefficient_problems(adopted: AdoptedEffect, effect: Effect, where: str) -> list[Problem]:
    if not adopted.coefficients and effect.subject == "reversal_run":
        return []  # the run is estimated anew in any case
    count = occurrences(adopted, effect)
    expected = numbered([c.name for c in effect.coefficients], count)
    names = [name for name, _, _, _ in adopted.coefficients]
    if names != expected:
        what = said("the coefficients of an adopted effect do not fit it")
        return [Problem(what, where, ", ".join(names) or "none", ", ".join(expected), HINT)]
    found = []
    for (name, value, sigma, unit), known in zip(
        adopted.coefficients, effect.coefficients * count, strict=True
    ):
        found += _value_problems(known, f"{where}, {name}", (value, sigma, unit))
    return found


def _value_problems(
    known: Coefficient, where: str, given: tuple[float, float, str]
) -> list[Problem]:
    value, sigma, unit = given
    found = []
    if unit != known.unit:
        what = said("the unit of an adopted coefficient is not that of its effect")
        found.append(Problem(what, where, unit or "no unit", known.unit, HINT))
    elif not known.low <= value <= known.high:
        found.append(
            Problem(
                "an adopted coefficient lies outside its plausible range",
                where,
                f"{value:g} {unit}",
                said("{low:g} to {high:g} {unit}", low=known.low, high=known.high, unit=known.unit),
                HINT,
            )
        )
    if not sigma > 0.0:
        what = said("an adopted coefficient has no sigma")
        found.append(Problem(what, where, f"{sigma:g}", "more than 0", HINT))
    return found


def _covariance_problems(adopted: AdoptedEffect, where: str) -> list[Problem]:
    if not adopted.covariance:
        return []
    matrix = np.array(adopted.covariance, dtype=np.float64)
    largest = float(np.abs(matrix).max())
    what = ""
    if float(np.abs(matrix - matrix.T).max()) > 1e-9 * largest:
        what = said("the covariance of an adopted effect is not symmetric")
    elif float(np.diag(matrix).min()) <= 0.0 or np.linalg.eigvalsh(matrix)[0] < -1e-9 * largest:
        what = said("the covariance of an adopted effect is not positive")
    else:
        sigmas = np.array([sigma for _, _, sigma, _ in adopted.coefficients])
        apart = np.abs(np.sqrt(np.diag(matrix)) - sigmas)
        if bool(np.any(apart > CONTRADICTION * sigmas)):
            what = said("sigma and covariance of an adopted effect contradict each other")
    found = str([list(row) for row in adopted.covariance])
    expected = said("a symmetric matrix, squares of the sigmas on its diagonal")
    return [Problem(what, where, found, expected, HINT)] if what else []


def _column_problems(adopted: AdoptedEffect, effect: Effect, where: str) -> list[Problem]:
    needs = [need.name for need in effect.needs]
    known = {*needs, "elapsed_days"} if "block" in needs else set(needs)
    found = [
        Problem("a range of an adopted effect is of no column of it", where, name, ", ".join(needs))
        for name, _, _ in adopted.valid
        if name not in known
    ]
    given = [name for name, _ in adopted.reference]
    expected = needs if effect.reference is not None else []
    if given and sorted(given) != sorted(expected):
        what = said("the reference of an adopted effect does not fit it")
        told = ", ".join(expected) or "none"
        found.append(Problem(what, where, ", ".join(given), told, HINT))
    return found


def _told(project: Project, instrument: Instrument) -> list[ResultWarning]:
    """What is not known of the adopted effects of an instrument, and what they mean for it."""
    found: list[ResultWarning] = []
    reference: dict[str, float] = {}
    for adopted in instrument.effects:
        name = said("instrument {id}: the adopted effect {id2}", id=instrument.id, id2=adopted.id)
        unknown = unknown_ranges(adopted)
        if unknown:
            text = said(
                "{name} has no valid range of {unknown}: nothing is corrected, and the "
                "whole effect enters the sigma",
                name=name,
                unknown=listed(unknown),
            )
            found.append(ResultWarning("effect_range_unknown", text))
        if without_reference(adopted):
            text = said(
                "{name} has no reference: its correction is relative to the mean of the "
                "sessions that are in the project, and a stated constant means no certain "
                "state; take it out, diagnose again and adopt",
                name=name,
            )
            found.append(ResultWarning("adopted_without_reference", text))
        reference |= dict(adopted.reference)
        found += _changed(project, adopted, None)
    if instrument.known_constant is not None and reference:
        states = ", ".join(f"{name} {value:.6g}" for name, value in reference.items())
        text = said(
            "instrument {id}: the stated constant counts for {states}, to which its "
            "adopted effects reduce every azimuth",
            id=instrument.id,
            states=states,
        )
        found.append(ResultWarning("known_constant_at_reference", text))
    return [item.about(Subject.of("instrument", instrument.id)) for item in found]


def _changed(
    project: Project, adopted: AdoptedEffect, session: OrientationSession | None
) -> list[ResultWarning]:
    """Whether the data that chose an effect are in the project, and no longer the same."""
    here = {item.id for item in project.sessions}
    gone = [name for name in adopted.sessions if name not in here]
    if not adopted.sessions or len(gone) == len(adopted.sessions):
        return []
    why = said("have been changed since")
    if gone:
        count = len(adopted.sessions)
        why = said(
            "are no longer complete: {gone} of {count} sessions are missing",
            gone=len(gone),
            count=count,
        )
    elif adopted.data_sha256 in (
        "",
        sessions_digest(project, adopted.sessions, run=session is not None),
    ):
        return []
    owner = "" if session is None else said("session {id}: ", id=session.id)
    text = said(
        "{owner}the data that chose the adopted effect {id} {why}: diagnose again "
        "without it, and adopt anew",
        owner=owner,
        id=adopted.id,
        why=why,
    )
    subject = None if session is None else Subject.session(session.id)
    return [ResultWarning("adopted_data_changed", text, subject)]


__all__ = ["check_adopted", "identity_of", "numbered", "occurrences"]
