"""Diagnose a project: choose the subject, run the engine, write what was adopted.

Every diagnosis is appended to the ledger; an adoption is written to the session (a run) or to the
instrument (a campaign), with the digest of the data that chose it, and the next ``orient`` uses it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.diagnosis.battery import channels
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose as run_engine
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.result import Diagnosis
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.outputs import write_output
from surveyapp.languages import said
from surveyapp.workflows.adopting import (
    NotWritten,
    adopted_before,
    adopted_notes,
    record,
    tables_to_adopt,
)
from surveyapp.workflows.choosing import Diagnosable, Networks, Request, choose
from surveyapp.workflows.saving_shape import shape_text


@dataclass(frozen=True, slots=True)
class Diagnosed:
    """A diagnosis and what was written of it, or the subjects to choose from.

    Parameters
    ----------
    diagnosis : Diagnosis or None
        None where a subject must be chosen first.
    subjects : tuple of Diagnosable
    written : tuple of str
        Where adopted effects were written.
    not_written : tuple of NotWritten
        Named effects that should have been adopted and were not, and why.
    words : tuple of str
        The diagnosis in plain sentences.
    channels : tuple of (name, before, after)
        Residuals in each channel before, and after with the best member of what cannot be told
        apart [SI].
    """

    diagnosis: Diagnosis | None
    subjects: tuple[Diagnosable, ...] = ()
    written: tuple[str, ...] = ()
    not_written: tuple[NotWritten, ...] = ()
    words: tuple[str, ...] = ()
    channels: tuple[tuple[str, tuple[float, ...], tuple[float, ...]], ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.diagnose/1``."""
        if self.diagnosis is None:
            subjects = [subject.to_dict() for subject in self.subjects]
            schema = "surveyapp.diagnose/1"
            return {"schema": schema, "subjects": subjects, "words": list(self.words)}
        return {
            **self.diagnosis.to_dict(),
            "written": list(self.written),
            "not_written": [item.to_dict() for item in self.not_written],
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
    save_shape: Path | None = None,
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
    save_shape : Path, optional
        Where an unnamed shape of a run is saved as an effect of the user's own.

    Raises
    ------
    SurveyError
        For an unknown subject, too few observations, or a folder that cannot be written.
    """
    chosen = choose(orientation, request, networks)
    problem = chosen.problem
    if problem is None:
        if adopt or save_shape is not None:
            raise SurveyError(_no_one_subject(chosen.subjects))
        nothing = () if chosen.subjects else (NO_SUBJECTS,)
        return Diagnosed(None, chosen.subjects, words=nothing)
    if adopt and problem.subject == "traverse":
        _refuse_adoption(problem.identity)
    diagnosis = run_engine(problem, confirm=chosen.confirm)
    if save_shape is not None:
        write_output(save_shape, shape_text(problem).encode("utf-8"))
    already = adopted_before(orientation.project, diagnosis)
    notes = adopted_notes(diagnosis, already)
    tables: list[dict[str, object]] = []
    refused: tuple[NotWritten, ...] = ()
    if adopt:
        tables, refused = tables_to_adopt(orientation.project, diagnosis, problem, already)
    written: tuple[str, ...] = ()
    if folder is not None and (adopt or log):
        moment = (now or datetime.now(UTC)).isoformat(timespec="seconds")
        stamped = [{**t, "adopted_at": moment, "software": software} for t in tables]
        written, more = record(
            orientation.project, diagnosis, stamped, moment=moment, software=software
        )
        notes += more
    told = [note.text for note in notes] + words_of(diagnosis, problem)
    told += [f"Not written: {item}." for item in refused]
    return Diagnosed(
        replace(diagnosis, warnings=(*diagnosis.warnings, *notes)),
        written=written if save_shape is None else (*written, str(save_shape)),
        not_written=refused,
        words=tuple(told),
        channels=_channels(diagnosis, problem),
    )


NO_SUBJECTS = (
    "Nothing in this project can be diagnosed by itself: that needs a session with turning points "
    "(reversal rows), an instrument with three sessions or more, a traverse, or a sensor log."
)


def _no_one_subject(subjects: Sequence[Diagnosable]) -> Problem:
    if not subjects:
        return Problem(
            "there is nothing to diagnose, and so nothing to adopt",
            "diagnose, adopt",
            "no subject",
            "a session with turning points, an instrument with three sessions, or a traverse",
        )
    return Problem(
        "adopting needs one subject",
        "diagnose, adopt",
        "no session, campaign or traverse",
        "one subject",
        "Name it.",
    )


def _refuse_adoption(identity: str) -> None:
    raise SurveyError(
        Problem(
            "an effect of a traverse is mended at its source, not adopted",
            said("diagnose, adopt, {identity}", identity=identity),
            "adopting for a traverse",
            "a corrected book, constant or setting",
            "Follow the remedy, enter the corrected values, adjust and diagnose again.",
        )
    )


def _channels(
    diagnosis: Diagnosis, problem: Case
) -> tuple[tuple[str, tuple[float, ...], tuple[float, ...]], ...]:
    before = channels(problem, np.array([diagnosis.residuals_before]))
    after = channels(problem, np.array([diagnosis.residuals_best]))
    return tuple(
        (name, tuple(values[0].tolist()), tuple(after[name][0].tolist()))
        for name, values in before.items()
    )
