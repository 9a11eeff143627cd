"""A result is never written over what it was computed from.

What was observed exists once. A file to be written may replace an earlier result, never the input
of the command, nor the record of a project: project.toml, ledger, books, logs, imported files.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown_path
from surveyapp.io.guarded import outside_problem, place_inside
from surveyapp.io.project_files import PROJECT_FILE
from surveyapp.io.tomltext import atomic_write

RECORD: Final = frozenset({PROJECT_FILE, "ledger.jsonl", "closings.txt", "observations", "imports"})
"""First parts of names that hold the record of a project."""


def check_output(path: Path, inputs: Iterable[Path] = (), *, named: bool = True) -> None:
    """Refuse a name that holds an input, or the record of a project.

    ``named`` refuses what project.toml names as well: a result that it may name is replaced.

    Raises
    ------
    SurveyError
    """
    what = None
    try:
        _refuse_outside(path)
        if not path.exists():
            return
        if any(item.exists() and item.samefile(path) for item in inputs):
            what = "the result would replace what it was computed from"
        elif _is_record(path.resolve(), named=named):
            what = "the result would replace a file of the project's record"
    except (OSError, ValueError, RuntimeError):
        return  # the write itself tells what the system refuses
    if what is not None:
        expected, hint = "a name of its own for the result", "nothing was written"
        raise SurveyError(Problem(what, shown_path(path), path.name, expected, hint))


def write_output(
    path: Path, data: bytes, *, inputs: Iterable[Path] = (), named: bool = True
) -> None:
    """Write a result as a whole, never over an input or the record of a project.

    Raises
    ------
    SurveyError
    """
    check_output(path, inputs, named=named)
    atomic_write(path, data)


def _refuse_outside(path: Path) -> None:
    """A result in a project folder is written there, whatever links its folders are."""
    whole = Path(os.path.abspath(path))  # noqa: PTH100 - links must not be followed yet
    for folder in whole.parents:
        if (folder / PROJECT_FILE).is_file():
            name = whole.relative_to(folder).as_posix()
            if place_inside(folder, name) is None:
                raise SurveyError(outside_problem(name, where=shown_path(folder)))
            return


def _is_record(path: Path, *, named: bool) -> bool:
    """Whether a file belongs to what its project's folder records, or is named in project.toml."""
    for folder in path.parents:
        project = folder / PROJECT_FILE
        if project.is_file():
            name = path.relative_to(folder)
            quoted = f'"{name.as_posix()}"'.encode()
            return name.parts[0] in RECORD or (named and quoted in project.read_bytes())
    return False
