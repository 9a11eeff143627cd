"""The one module that knows where things live outside of a project folder.

It names folders and makes none of them.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import surveyapp
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.files import shown, shown_path
from surveyapp.languages import said


def samples_folder() -> Path:
    """Folder of the sample projects: ``projects/`` of a checkout, else the package's own copy."""
    package = Path(surveyapp.__file__).resolve().parent
    checkout = package.parent / "projects"
    if checkout.is_dir() and (package.parent / "pyproject.toml").is_file():
        return checkout
    return package / "samples"


def sample_names() -> tuple[str, ...]:
    """Names of the sample projects, sorted."""
    folder = samples_folder()
    if not folder.is_dir():
        return ()
    return tuple(sorted(p.name for p in folder.iterdir() if (p / "project.toml").is_file()))


def copy_sample(name: str, folder: Path) -> Path:
    """Copy a sample below ``folder`` and return the copy: samples are never worked in.

    Raises
    ------
    SurveyError
        For an unknown sample, naming the nearest, and where the copy exists already.
    """
    names = sample_names()
    if name not in names:
        hint = nearest_names(name, names)
        raise SurveyError(Problem("there is no such sample", "", shown(name), "a sample", hint))
    target = folder / name
    try:
        shutil.copytree(
            samples_folder() / name,
            target,
            ignore=shutil.ignore_patterns("results", "ledger.jsonl", ".surveyapp.lock"),
        )
    except OSError as error:
        raise SurveyError(
            Problem(
                said("the sample cannot be copied ({strerror})", strerror=error.strerror or error),
                shown_path(target),
            )
        ) from None
    return target


def user_documents_folder() -> Path:
    """Folder in which copies of the samples are worked in; it need not exist."""
    import platformdirs

    return Path(platformdirs.user_documents_path()) / "surveyapp"


def user_config_folder() -> Path:
    """Folder for the user's own settings; it need not exist."""
    import platformdirs

    return Path(platformdirs.user_config_path("surveyapp", appauthor=False))


def read_expected(folder: Path) -> dict[str, Any]:
    """What the source of a sample printed (its ``expected.json``); empty where there is none."""
    path = folder / "expected.json"
    if not path.is_file():
        return {}
    value = json.loads(path.read_text(encoding="utf-8"))
    return dict(value)
