"""The surveyor's own editor in front of the screens: they step back, and come again after it."""

from __future__ import annotations

import subprocess
from pathlib import Path

from textual.app import App, SuspendNotSupported

from surveyapp.errors import SurveyError
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.languages import shown
from surveyapp.observation.by_hand import Edited, begin_edit, editor_command, end_edit
from surveyapp.tui import texts


def edit_by_hand(app: App[int], folder: str, name: str, session: str | None) -> str:
    """Edit a file of a project, and say what became of it.

    Raises
    ------
    SurveyError
        If the file may not be edited, or if there is no editor.
    """
    place = Path(folder)
    edit = begin_edit(place, name, session=session)
    command = editor_command()
    with ProjectLock(place) as lock:
        if not lock.writable:
            return texts.EDIT_ELSEWHERE
        try:
            with app.suspend():
                code = subprocess.run([*command, str(edit.path)], check=False).returncode
        except SuspendNotSupported:
            return texts.EDIT_NO_TERMINAL
        except OSError as error:
            return texts.EDIT_FAILED.format(editor=command[0], reason=error.strerror or error)
        told = _told(end_edit(edit), name)
    return f"{told} {texts.EDIT_CODE.format(editor=command[0], code=code)}" if code else told


def _told(edited: Edited, name: str) -> str:
    if edited.change == "changed":
        return texts.EDIT_CHANGED.format(file=name, copy=edited.copy)
    pattern = texts.EDIT_APPENDED if edited.change == "appended" else texts.EDIT_UNCHANGED
    return pattern.format(file=name)


def first_problem(error: SurveyError) -> str:
    """The first problem of an error in one sentence."""
    problem = error.problems[0]
    where = f"{shown(problem.where)}: " if problem.where else ""
    return f"{where}{shown(problem.what)}. {shown(problem.hint)}".strip()
