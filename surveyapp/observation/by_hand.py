"""A file of the project in the surveyor's own editor: what may be edited, and what became of it.

Nothing is lost by it: where more was changed than lines added at the end, the file as it stood
before is kept beside it under a hidden name.
"""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from surveyapp.domain.project import Project
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import read_inside, shown
from surveyapp.io.filing.seals import is_closed
from surveyapp.io.guarded import checked_inside, is_regular
from surveyapp.io.tomltext import atomic_write
from surveyapp.languages import said

PROJECT_FILE: Final = "project.toml"
_EDITORS: Final = ("nano", "vim", "vi", "emacs")
_WINDOWS: Final = ("notepad",)
Change = Literal["unchanged", "appended", "changed"]


@dataclass(frozen=True, slots=True)
class HandEdit:
    """A file that is about to be edited.

    Parameters
    ----------
    folder : Path
    name : str
        Relative to the folder.
    before : bytes
        As it stood.
    """

    folder: Path
    name: str
    before: bytes

    @property
    def path(self) -> Path:
        """The file itself."""
        return self.folder / self.name


@dataclass(frozen=True, slots=True)
class Edited:
    """What became of a file in the editor; ``copy`` names the file as it stood before."""

    change: Change
    copy: str = ""


def editor_command(
    environment: Mapping[str, str] | None = None,
    which: Callable[[str], str | None] = shutil.which,
) -> tuple[str, ...]:
    """Command of the surveyor's editor: $VISUAL, $EDITOR, else one that is installed.

    Raises
    ------
    SurveyError
        If there is none.
    """
    values = os.environ if environment is None else environment
    for name in ("VISUAL", "EDITOR"):
        words = _words(values.get(name, ""))
        if words:
            return words
    found = next((e for e in (_WINDOWS if os.name == "nt" else _EDITORS) if which(e)), None)
    if found is None:
        raise SurveyError(
            Problem(
                said("no editor is known"),
                "$EDITOR",
                "",
                said("the command of a text editor"),
                said("set EDITOR, for instance to nano, and begin again"),
            )
        )
    return (found,)


def _words(text: str) -> tuple[str, ...]:
    try:
        words = shlex.split(text, posix=sys.platform != "win32")
    except ValueError:
        words = text.split()
    return tuple(word.strip('"') for word in words)


def file_of(project: Project | None, session: str | None, error: SurveyError | None) -> str:
    """Which file is meant: the book of a session, the one that a problem names, else the project's.

    Parameters
    ----------
    project : Project or None
    session : str or None
        The session under the cursor.
    error : SurveyError or None
        Why the project cannot be used.
    """
    if error is not None:
        for problem in error.problems:
            for place in problem.where.split(", "):
                if place.endswith((".csv", ".toml")):
                    return place
    if project is not None and session is not None:
        return project.session(session).book_path
    return PROJECT_FILE


def begin_edit(folder: Path, name: str, *, session: str | None = None) -> HandEdit:
    """Look at a file before it is edited.

    Raises
    ------
    SurveyError
        If it lies outside of the folder or is no text file, or if what it belongs to is closed.
    """
    if is_closed(folder, session):
        raise SurveyError(
            Problem(
                said("it is closed: nothing may be written to it"),
                name,
                "",
                said("an open project or session"),
                said("surveyapp reopen DIR --reason TEXT opens it again"),
            )
        )
    checked_inside(folder, name, where=name)
    if not is_regular(folder / name):
        raise SurveyError(
            Problem(said("this is no text file"), name, shown(name), said("a regular file"))
        )
    return HandEdit(folder, name, read_inside(folder, name, where=name))


def end_edit(edit: HandEdit) -> Edited:
    """Tell what became of a file; keep it as it stood where more than lines at its end changed.

    Raises
    ------
    SurveyError
        If the copy cannot be written.
    """
    try:
        now = read_inside(edit.folder, edit.name, where=edit.name)
    except SurveyError:
        now = b""  # taken away, or no text any more: the copy is all the more needed
    if now == edit.before:
        return Edited("unchanged")
    if now.startswith(edit.before) and edit.before.endswith(b"\n"):
        return Edited("appended")
    parent = edit.path.parent
    names = (f".{edit.path.name}.before-edit-{k}" for k in range(1, 10_000))
    copy = next(name for name in names if not os.path.lexists(parent / name))
    atomic_write(parent / copy, edit.before)
    return Edited("changed", (parent / copy).relative_to(edit.folder).as_posix())
