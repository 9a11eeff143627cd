"""Adopting what a diagnosis named: tables for project.toml, entries for the ledger.

All of it is written or nothing; what is not written is told with its reason.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from surveyapp.core.checks.adopted_checks import identity_of
from surveyapp.core.orientation.session_digest import sessions_digest
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.result import Adoption, Diagnosis
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.project import Project
from surveyapp.domain.sensor_entry import SensorLogEntry
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.filing.journal import write_together
from surveyapp.io.filing.ledger import append_entries
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.filing.seals import is_closed
from surveyapp.io.project import read_project
from surveyapp.io.writing import with_subtables
from surveyapp.languages import said
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect
from surveyapp_models.effects.recurrent import course_faults, recurrent_course


@dataclass(frozen=True, slots=True)
class NotWritten:
    """An effect that was not adopted although it was asked for; empty = no effect was named."""

    effect: str
    reason: str

    def to_dict(self) -> dict[str, str]:
        """Keys of the JSON."""
        return {"effect": self.effect, "reason": self.reason}

    def __str__(self) -> str:
        return f"{self.effect}: {self.reason}" if self.effect else self.reason


def adopted_before(project: Project, diagnosis: Diagnosis) -> tuple[AdoptedEffect, ...]:
    """Effects that the session (a run) or the instrument (a campaign) has already."""
    if diagnosis.subject == "traverse":
        return ()
    if diagnosis.subject == "reversal_run":
        return project.session(diagnosis.identity).effects
    return project.instrument(diagnosis.instrument).effects


def adopted_notes(diagnosis: Diagnosis, already: Sequence[AdoptedEffect]) -> list[ResultWarning]:
    """That effects are adopted already, and what the verdict is about then."""
    if not already:
        return []
    names = ", ".join(dict.fromkeys(effect.id for effect in already))
    if diagnosis.subject == "reversal_run":
        text = said(
            "Session {identity} has adopted {names} already, and orient uses it; "
            "this diagnosis is about the run without it, so that it is found again.",
            identity=diagnosis.identity,
            names=names,
        )
    else:
        text = said(
            "Instrument {instrument} has adopted {names} already; the "
            "determinations are reduced by it before they are diagnosed, and what "
            "is found here is what is left.",
            instrument=diagnosis.instrument,
            names=names,
        )
    return [ResultWarning("already_adopted", text)]


def tables_to_adopt(
    project: Project,
    diagnosis: Diagnosis,
    problem: Case,
    already: Sequence[AdoptedEffect],
) -> tuple[list[dict[str, object]], tuple[NotWritten, ...]]:
    """Tables of the named effects that can be adopted, and why others cannot."""
    catalogue = {effect.id: effect for effect in of_subject(problem.subject)}
    owner = diagnosis.instrument if problem.subject == "campaign" else diagnosis.identity
    tables: list[dict[str, object]] = []
    refused = []
    if not diagnosis.adopted and already:
        reason = f"already adopted by {owner}, and no further effect is named: nothing was written"
        refused += [NotWritten(name, reason) for name in dict.fromkeys(e.id for e in already)]
    elif not diagnosis.adopted:
        refused.append(NotWritten("", "no effect is named: nothing was written"))
    for item in diagnosis.adopted:
        effect = catalogue.get(item.effect) or _saved_course(item.effect, problem)
        if effect is None:
            reason = "an effect of your own is in no catalogue, and orient could not use it"
            refused.append(NotWritten(item.effect, reason))
            continue
        table = effect_table(item, problem, project)
        if effect.course:
            table |= {"course": [list(place) for place in effect.course], "run": effect.run}
        place = tuple(dict(cast("Mapping[str, float | str]", table.get("grid", {}))).items())
        wanted = identity_of(AdoptedEffect(item.effect, grid=place), effect)
        if any(_same(wanted, other, effect, problem) for other in already):
            reason = f"already adopted by {owner}: nothing was written"
            refused.append(NotWritten(item.effect, reason))
            continue
        tables.append(table)
    return tables, tuple(refused)


def _saved_course(name: str, problem: Case) -> Effect | None:
    """A course that was saved from a run: it is data, which the project can carry; else None.

    What a file calls one is believed only where its columns are those of the course.
    """
    effect = next((item for item in problem.effects if item.id == name), None)
    if effect is None or problem.half_swing is None or course_faults(effect.course):
        return None
    saved = recurrent_course(name, effect.course, run=effect.run)
    columns = {"half_swing": problem.half_swing}
    same = np.allclose(saved.basis(columns), effect.basis(columns), atol=1e-9)
    return saved if same and effect.subject == saved.subject else None


def _same(wanted: tuple[object, ...], other: AdoptedEffect, effect: Effect, problem: Case) -> bool:
    """Whether an effect has been adopted before; a bare run shows the same one again."""
    if problem.subject == "reversal_run":
        return other.id == effect.id
    return other.id == effect.id and identity_of(other, effect) == wanted


def record(
    project: Project,
    diagnosis: Diagnosis,
    tables: Sequence[Mapping[str, object]],
    *,
    moment: str,
    software: str,
) -> tuple[tuple[str, ...], list[ResultWarning]]:
    """Write the adopted effects and append to the ledger: all of it, or nothing.

    A folder that cannot be written keeps no ledger, and says so; adopting in it is an error, and so
    is adopting where a session that the effect would change is closed, or where the project is no
    longer the one that was diagnosed.
    """
    parent = ("orientation", diagnosis.identity)
    if diagnosis.subject != "reversal_run":
        parent = ("instrument", diagnosis.instrument)
    return record_under(project, parent, diagnosis.ledger, tables, moment=moment, software=software)


def record_under(
    project: Project,
    parent: tuple[str, str],
    ledger: Mapping[str, Any],
    tables: Sequence[Mapping[str, object]],
    *,
    moment: str,
    software: str,
) -> tuple[tuple[str, ...], list[ResultWarning]]:
    """``record`` for a table of project.toml: its kind and its id, such as a sensor log."""
    folder = Path(project.path)
    entries: list[tuple[str, Mapping[str, Any]]] = [("diagnosis", dict(ledger))]
    entries += [("adoption", {"parent": list(parent), "effect": table}) for table in tables]
    with ProjectLock(folder) as lock:
        if tables:
            _need_writable(lock, folder)
            _need_unchanged(project, parent)
        if not lock.writable:
            return (), []
        if not tables:
            try:
                append_entries(folder, entries, at=moment, software=software)
            except SurveyError as error:
                text = said("The diagnosis is in no ledger: {what}.", what=error.problems[0].what)
                return (), [ResultWarning("ledger_not_written", text)]
            return (), []
        after = with_subtables(folder / "project.toml", parent, "effect", tables)
        write_together(
            folder, after, lambda: append_entries(folder, entries, at=moment, software=software)
        )
    place = f"project.toml, {parent[0]} {parent[1]}, effect"
    return tuple(f"{place} {table['id']}" for table in tables), []


def effect_table(item: Adoption, problem: Case, project: Project) -> dict[str, object]:
    """The table of an adopted effect as it stands in project.toml, without moment and software."""
    record = item.record
    labels: Mapping[str, Mapping[float, str]] = problem.grid_labels
    grid: dict[str, object] = {
        name: labels.get(name, {}).get(value, value) if isinstance(value, float) else value
        for name, value in record.grid
    }
    table: dict[str, object] = {
        "id": record.id,
        "coefficients": {
            name: {"value": value, "sigma": sigma, "unit": unit}
            for name, value, sigma, unit in record.coefficients
        },
    }
    if grid:
        table["grid"] = grid
    if record.covariance:
        table["covariance"] = [list(row) for row in record.covariance]
    if record.valid:
        table["valid"] = {name: [low, high] for name, low, high in record.valid}
    if record.reference:
        table["reference"] = dict(record.reference)
    if record.time:
        table["time"] = record.time
    sessions = _sessions_of(problem, project)
    run = problem.subject == "reversal_run"
    table["sessions"] = sessions
    table["sha256"] = sessions_digest(project, sessions, run=run) or record.data_sha256
    errors = {"before": record.before, "after": record.after, "confirm": record.confirm}
    table.update({name: number for name, number in errors.items() if number is not None})
    table["unit"] = record.unit
    return table


def sensor_tables(
    adopted: Sequence[AdoptedEffect], entry: SensorLogEntry
) -> tuple[list[dict[str, object]], tuple[NotWritten, ...]]:
    """Tables of what was named in a sensor's log, and why others are not written."""
    known = {effect.id for effect in of_subject("compass")}
    known |= {effect.id for subject in ("tilt", "rate") for effect in of_subject(subject)}
    already = {effect.id for effect in entry.effects}
    tables: list[dict[str, object]] = []
    refused = []
    if not adopted:
        refused.append(NotWritten("", "no effect is named: nothing was written"))
    for item in adopted:
        if item.id in already:
            reason = f"already adopted by sensor log {entry.id}: nothing was written"
            refused.append(NotWritten(item.id, reason))
        elif item.id not in known:
            refused.append(NotWritten(item.id, "an effect of your own is in no catalogue"))
        else:
            tables.append(_plain_table(item))
    return tables, tuple(refused)


def _plain_table(item: AdoptedEffect) -> dict[str, object]:
    table: dict[str, object] = {
        "id": item.id,
        "coefficients": {
            name: {"value": value, "sigma": sigma, "unit": unit}
            for name, value, sigma, unit in item.coefficients
        },
    }
    if item.grid:
        table["grid"] = dict(item.grid)
    if item.valid:
        table["valid"] = {name: [low, high] for name, low, high in item.valid}
    table["sha256"] = item.data_sha256
    errors = {"before": item.before, "after": item.after, "confirm": item.confirm}
    table.update({name: number for name, number in errors.items() if number is not None})
    table["unit"] = item.unit
    return table


def _sessions_of(problem: Case, project: Project) -> list[str]:
    """Sessions whose data a case is made of: a run itself, or those of a campaign."""
    if problem.subject == "reversal_run":
        return [problem.identity]
    named = {member.id for member in problem.members}
    return [session.id for session in project.sessions if session.id in named]


def _need_writable(lock: ProjectLock, folder: Path) -> None:
    if not lock.writable:
        raise SurveyError(
            Problem(
                "the project is open elsewhere or cannot be written",
                str(folder),
                "a locked or read-only folder",
                "a folder that this program may write",
                "Reopen the project first: it is closed."
                if lock.closed
                else "Close the other window and adopt again.",
            )
        )


def _need_unchanged(project: Project, parent: tuple[str, str]) -> None:
    """Under the lock: nothing was changed since it was read, and no closed session would be."""
    folder = Path(project.path)
    kind, name = parent
    touched = [s.id for s in project.sessions if name in (s.id, s.instrument)]
    if kind == "orientation":
        touched = [name]
    closed = [session for session in touched if is_closed(folder, session)]
    if closed:
        raise SurveyError(
            Problem(
                "a closed session would be changed by this effect",
                f"{kind} {name}",
                ", ".join(closed),
                "open sessions",
                "Reopen the session first; the ledger keeps the reason.",
            )
        )
    if read_project(folder, repair=False).digest != project.digest:
        raise SurveyError(
            Problem(
                "the project was changed while it was diagnosed",
                str(folder),
                "other files than those that were read",
                "the project as it was diagnosed",
                "Diagnose it again.",
            )
        )
