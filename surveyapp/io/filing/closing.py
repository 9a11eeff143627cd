"""Closing and reopening a project or a session: one entry in the ledger, or nothing at all.

Everything is computed before the single append, so that a crash at any moment leaves the project
as it was: open and whole.
"""

from __future__ import annotations

from pathlib import Path

from surveyapp.domain.filing import ClosingResult
from surveyapp.domain.project import Project
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.filing.ledger import append_entry, read_ledger
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.filing.seals import CLOSING, REOPENING, changes, closings_in_force, seal_of
from surveyapp.io.filing.witness import add_witness, head_of
from surveyapp.io.project import read_project
from surveyapp.languages import joined, said


def close_project(
    folder: Path, *, session: str | None, by: str, note: str, at: str, software: str
) -> ClosingResult:
    """Close a project, or one session of it.

    Raises
    ------
    SurveyError
        If it cannot be read, is closed already, is open elsewhere, or cannot be written.
    """
    with ProjectLock(folder, even_closed=True) as lock:
        _writable(lock)
        project = read_project(folder, repair=True)
        _known(project, session)
        ledger = read_ledger(folder)
        in_force = closings_in_force(ledger)
        for name in {"", session or ""} & set(in_force):
            raise SurveyError(
                Problem(
                    "it is closed already",
                    _where(name),
                    said("closed at {at}", at=in_force[name].at),
                    "an open project or session",
                    "surveyapp reopen DIR --reason TEXT opens it again",
                )
            )
        if ledger.faults or ledger.tail_altered:
            found = joined("; ", ledger.faults) or said("the newline of the last line was changed")
            raise SurveyError(
                Problem(
                    "the ledger was changed",
                    "ledger.jsonl",
                    found,
                    "a whole ledger",
                    "keep the damaged file aside, and restore the ledger from a copy",
                )
            )
        data = {**seal_of(folder, ledger, session), "by": by, "note": note}
        data["input_sha256"] = project.digest
        entry = append_entry(folder, CLOSING, data, at=at, software=software)
        add_witness(folder, entry)
    return ClosingResult(
        action=CLOSING,
        scope=str(data["scope"]),
        session=session or "",
        at=at,
        by=by,
        reason=note,
        seal=str(data["seal"]),
        head=head_of(entry.sha256),
        files=len(data["files"]),
        found=(),
        entry=entry.seq,
    )


def reopen_project(
    folder: Path, *, session: str | None, by: str, reason: str, at: str, software: str
) -> ClosingResult:
    """Reopen a closed project or session; what was changed meanwhile is written down.

    Raises
    ------
    SurveyError
        If it is not closed, no reason is given, or the ledger cannot be written.
    """
    if not reason.strip():
        raise SurveyError(
            Problem("a reopening needs a reason", "reason", "", "one sentence for the ledger")
        )
    with ProjectLock(folder, even_closed=True) as lock:
        _writable(lock)
        in_force = closings_in_force(read_ledger(folder))
        name = session or ""
        if name not in in_force:
            known = ", ".join(_where(item) for item in in_force) or "nothing"
            raise SurveyError(
                Problem(
                    "it is not closed",
                    _where(name),
                    "",
                    "a closed one",
                    said("Closed: {known}", known=known),
                )
            )
        found = changes(folder, in_force[name])
        data = {
            "scope": "project" if session is None else "session",
            "session": name,
            "by": by,
            "reason": reason,
            "found": found,
        }
        entry = append_entry(folder, REOPENING, data, at=at, software=software)
        add_witness(folder, entry)
    return ClosingResult(
        action=REOPENING,
        scope=str(data["scope"]),
        session=name,
        at=at,
        by=by,
        reason=reason,
        seal="",
        files=0,
        found=tuple(found),
        entry=entry.seq,
    )


def _where(session: str) -> str:
    return f"session {session}" if session else "project"


def _writable(lock: ProjectLock) -> None:
    if not lock.writable:
        read_project(lock.folder, repair=False)  # a folder that is no project is told as such
        raise SurveyError(
            Problem(
                "the project cannot be written to",
                str(lock.folder),
                "another program has it open, or the folder is read-only",
                "a project folder that nobody else has open",
            )
        )


def _known(project: Project, session: str | None) -> None:
    names = [item.id for item in project.sessions]
    if session is not None and session not in names:
        raise SurveyError(
            Problem(
                "there is no session of this name",
                "session",
                session,
                "the id of a session",
                nearest_names(session, names),
            )
        )
