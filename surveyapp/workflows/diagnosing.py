"""Diagnose a project: choose the subject, run the engine, write what was adopted.

Every diagnosis is appended to the ledger; an adoption is written to the session (a run) or to the
instrument (a campaign), with the digest of the data that chose it, and the next ``orient`` uses it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from surveyapp.core.orientation import Orientation
from surveyapp.diagnosis.battery import channels
from surveyapp.diagnosis.engine import diagnose as run_engine
from surveyapp.diagnosis.problem import Problem
from surveyapp.diagnosis.result import Adoption, Diagnosis
from surveyapp.diagnosis.words import words_of
from surveyapp.domain.project import Project
from surveyapp.errors import Problem as InputProblem
from surveyapp.errors import SurveyError
from surveyapp.io.ledger import append_entry
from surveyapp.io.lock import ProjectLock
from surveyapp.io.writing import append_subtable
from surveyapp.workflows.choosing import Networks, Request, Subject, choose

RANGE_COLUMNS = ("temperature_c", "latitude", "elapsed_days", "running_s")


@dataclass(frozen=True, slots=True)
class Diagnosed:
    """A diagnosis and what was written of it, or the subjects to choose from.

    Parameters
    ----------
    diagnosis : Diagnosis or None
        None where a subject must be chosen first.
    subjects : tuple of Subject
    written : tuple of str
        Where adopted effects were written.
    words : tuple of str
        The diagnosis in plain sentences.
    channels : tuple of (name, before, after)
        Residuals in each channel before, and after with the best member of what cannot be told
        apart [SI].
    """

    diagnosis: Diagnosis | None
    subjects: tuple[Subject, ...] = ()
    written: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    channels: tuple[tuple[str, tuple[float, ...], tuple[float, ...]], ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.diagnose/1``."""
        if self.diagnosis is None:
            subjects = [subject.to_dict() for subject in self.subjects]
            return {"schema": "surveyapp.diagnose/1", "subjects": subjects}
        return {
            **self.diagnosis.to_dict(),
            "written": list(self.written),
            "words": list(self.words),
        }


def diagnose_project(
    orientation: Orientation,
    request: Request,
    *,
    folder: Path | None,
    adopt: bool,
    software: str,
    log: bool = True,
    now: datetime | None = None,
    networks: Networks | None = None,
) -> Diagnosed:
    """Diagnose, log, and adopt where asked.

    Parameters
    ----------
    orientation : Orientation
        The computed project.
    request : Request
    folder : Path or None
        The project folder; None writes nothing.
    adopt : bool
        Whether the effects that the engine names are written into the project.
    software : str
    log : bool
        Whether the diagnosis is appended to the ledger where the folder can be written.
    now : datetime, optional
        Moment of the adoption; the wall clock if absent.
    networks : callable, optional
        Networks of the traverses by name; needed to diagnose one.

    Raises
    ------
    SurveyError
        For an unknown subject, too few observations, or a folder that cannot be written.
    """
    chosen = choose(orientation, request, networks)
    if chosen.problem is None:
        if adopt:
            raise SurveyError(
                InputProblem(
                    "adopting needs one subject",
                    "diagnose --adopt",
                    "no --session or --campaign",
                    "one subject",
                    "Name it.",
                )
            )
        return Diagnosed(None, chosen.subjects)
    if adopt and chosen.problem.subject == "traverse":
        _refuse_adoption(chosen.problem.identity)
    diagnosis = run_engine(chosen.problem, confirm=chosen.confirm)
    moment = (now or datetime.now(UTC)).isoformat(timespec="seconds")
    written: tuple[str, ...] = ()
    if folder is not None and (adopt or log):
        written = _record(
            folder,
            diagnosis,
            effect_tables(diagnosis, chosen.problem, moment=moment, software=software)
            if adopt
            else (),
            already=_already(orientation.project, diagnosis),
            moment=moment,
            software=software,
        )
    words = tuple(words_of(diagnosis, chosen.problem))
    return Diagnosed(diagnosis, (), written, words, _channels(diagnosis, chosen.problem))


def _refuse_adoption(identity: str) -> None:
    raise SurveyError(
        InputProblem(
            "an effect of a traverse is mended at its source, not adopted",
            f"diagnose --adopt, {identity}",
            "--adopt with --traverse",
            "a corrected book, constant or setting",
            "Follow the remedy, enter the corrected values, adjust and diagnose again.",
        )
    )


def _channels(
    diagnosis: Diagnosis, problem: Problem
) -> tuple[tuple[str, tuple[float, ...], tuple[float, ...]], ...]:
    before = channels(problem, np.array([diagnosis.residuals_before]))
    after = channels(problem, np.array([diagnosis.residuals_best]))
    return tuple(
        (name, tuple(values[0].tolist()), tuple(after[name][0].tolist()))
        for name, values in before.items()
    )


def _need_writable(lock: ProjectLock, folder: Path) -> None:
    if not lock.writable:
        raise SurveyError(
            InputProblem(
                "the project is open elsewhere or cannot be written",
                str(folder),
                "a locked or read-only folder",
                "a folder that this program may write",
                "Close the other window and adopt again.",
            )
        )


def _already(project: Project, diagnosis: Diagnosis) -> frozenset[str]:
    """Ids of the effects that the session (a run) or the instrument (a campaign) has already."""
    if diagnosis.subject == "traverse":
        return frozenset()
    if diagnosis.subject == "reversal_run":
        return frozenset(effect.id for effect in project.session(diagnosis.identity).effects)
    return frozenset(effect.id for effect in project.instrument(diagnosis.instrument).effects)


def _record(
    folder: Path,
    diagnosis: Diagnosis,
    tables: Sequence[dict[str, object]],
    *,
    already: frozenset[str],
    moment: str,
    software: str,
) -> tuple[str, ...]:
    """Append to the ledger, and write every effect that is not adopted yet.

    A folder that cannot be written keeps no ledger; adopting in it is an error.
    """
    written = []
    wanted = [table for table in tables if table["id"] not in already]
    with ProjectLock(folder) as lock:
        if wanted:
            _need_writable(lock, folder)
        if not lock.writable:
            return ()
        append_entry(folder, "diagnosis", dict(diagnosis.ledger), at=moment, software=software)
        if diagnosis.subject == "reversal_run":
            parent = ("orientation", diagnosis.identity)
        else:
            parent = ("instrument", diagnosis.instrument)
        for table in wanted:
            append_subtable(folder / "project.toml", parent, "effect", table)
            entry = {"parent": list(parent), "effect": table}
            append_entry(folder, "adoption", entry, at=moment, software=software)
            written.append(f"project.toml, {parent[0]} {parent[1]}, effect {table['id']}")
    return tuple(written)


def effect_tables(
    diagnosis: Diagnosis, problem: Problem, *, moment: str, software: str
) -> tuple[dict[str, object], ...]:
    """The tables of every effect that the engine names, as they stand in project.toml."""
    return tuple(
        effect_table(item, problem, moment=moment, software=software) for item in diagnosis.adopted
    )


def effect_table(
    item: Adoption, problem: Problem, *, moment: str, software: str
) -> dict[str, object]:
    """The table of an adopted effect as it stands in project.toml."""
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
    table["sha256"] = record.data_sha256
    errors = {"before": record.before, "after": record.after, "confirm": record.confirm}
    table.update({name: number for name, number in errors.items() if number is not None})
    table["unit"] = record.unit
    table["adopted_at"] = moment
    table["software"] = software
    return table
