"""A user's own effects: a Python file named on the command line, never found by itself.

The file runs with the user's rights, as any script of theirs; this is why it must be named
explicitly each time and is never looked for in a project folder. Whatever it does wrong is told
with the file, the effect and what was wrong: it is input, and no fault of the program.
"""

from __future__ import annotations

import contextlib
import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

from surveyapp.diagnosis.candidates import AMPLITUDE_SHAPES
from surveyapp.diagnosis.plain_words import NOISE_AND_SHAPES
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.user_effects.calls import FAULTS, guarded, told
from surveyapp.io.user_effects.form import form_problems
from surveyapp.io.user_effects.probe import COLUMNS, probe_problems
from surveyapp.languages import said
from surveyapp_models.effects import CATALOGUE
from surveyapp_models.effects.effect import Effect

_ID = re.compile(r"[a-z][a-z0-9_]{0,59}")
_RESERVED = frozenset(NOISE_AND_SHAPES) | AMPLITUDE_SHAPES
"""Ids of generic shapes and of noise."""


def load_effects(path: Path, *, only_known_columns: bool = False) -> tuple[Effect, ...]:
    """Read the effects of a file, try each, and guard what is called later.

    Parameters
    ----------
    path : Path
        A Python file with ``EFFECTS``, a tuple of ``surveyapp_models.effects.Effect`` (or
        ``EFFECT``, a single one).
    only_known_columns : bool
        Whether the columns are those of a project, so that a need of any other is an error; a
        script may hand over covariates of its own.

    Returns
    -------
    tuple of Effect
        Their functions get read-only arrays and raise a SurveyError for anything that goes wrong
        in them.

    Raises
    ------
    SurveyError
        If there is no such file, it cannot be run, holds no effect, or an effect of it cannot be
        used; with everything that is wrong.
    """
    if not path.is_file():
        raise SurveyError(Problem("there is no such file of effects", str(path)))
    module = _run(path)
    effects = _found(module, path)
    problems = [problem for effect in effects for problem in form_problems(effect, str(path))]
    if not problems:
        problems += _id_problems(effects, path)
        for effect in effects:
            problems += _column_problems(effect, path) if only_known_columns else []
    if not problems:
        problems += [item for effect in effects for item in probe_problems(effect, str(path))]
    if problems:
        raise SurveyError(problems)
    return tuple(guarded(effect, str(path)) for effect in effects)


def _run(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"surveyapp_user_effects_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise SurveyError(
            Problem("this is no Python file", str(path), path.suffix, "a file ending in .py")
        )
    module = importlib.util.module_from_spec(spec)
    written, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        with contextlib.redirect_stdout(sys.stderr):
            spec.loader.exec_module(module)
    except FAULTS as fault:
        raise SurveyError(
            Problem(
                "the file of effects cannot be run",
                str(path),
                told(fault),
                "a file that defines EFFECTS",
            )
        ) from None
    finally:
        sys.dont_write_bytecode = written
    return module


def _found(module: ModuleType, path: Path) -> tuple[Effect, ...]:
    found = getattr(module, "EFFECTS", None)
    if found is None:
        found = (getattr(module, "EFFECT", None),)
    items = tuple(found) if isinstance(found, tuple | list) else ()
    effects = tuple(item for item in items if isinstance(item, Effect))
    if effects and len(effects) == len(items):
        return effects
    wrong = "no EFFECTS"
    if effects:
        wrong = "something else among EFFECTS"
    elif not isinstance(found, tuple | list):
        wrong = f"EFFECTS is {type(found).__name__}"
    raise SurveyError(
        Problem(
            "the file holds no effects",
            str(path),
            wrong,
            "EFFECTS = (Effect(...), ...)",
            "Look at the reference of effects for the form.",
        )
    )


def _id_problems(effects: tuple[Effect, ...], path: Path) -> list[Problem]:
    taken = {effect.id for effect in CATALOGUE} | _RESERVED
    problems = []
    for effect in effects:
        if _ID.fullmatch(effect.id) is None:
            expected = "lower-case letters, digits and underscores, a letter first"
            what = "this is no id of an effect"
            problems.append(Problem(what, str(path), repr(effect.id)[:80], expected))
        elif effect.id in taken:
            problems.append(
                Problem(
                    "an effect with this id is already in the catalogue",
                    str(path),
                    f"{effect.subject}.{effect.id}",
                    "an id of its own",
                    nearest_names(effect.id, taken),
                )
            )
        taken.add(effect.id)
    return problems


def _column_problems(effect: Effect, path: Path) -> list[Problem]:
    known = COLUMNS.get(effect.subject)
    if known is None:
        return []
    return [
        Problem(
            "an effect needs a column that no project has",
            said("{path}, effect {id}", path=path, id=effect.id),
            need.name,
            said("a column of {subject}", subject=effect.subject),
            nearest_names(need.name, known),
        )
        for need in effect.needs
        if need.name not in known
    ]
