"""A user's own effects: a Python file named on the command line, never found by itself.

The file runs with the user's rights, as any script of theirs; this is why it must be named
explicitly each time and is never looked for in a project folder.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp_models.effects import CATALOGUE
from surveyapp_models.effects.effect import SUBJECTS, Effect


def load_effects(path: Path) -> tuple[Effect, ...]:
    """Read the effects of a file.

    Parameters
    ----------
    path : Path
        A Python file with ``EFFECTS``, a tuple of ``surveyapp_models.effects.Effect`` (or
        ``EFFECT``, a single one).

    Returns
    -------
    tuple of Effect

    Raises
    ------
    SurveyError
        If there is no such file, it cannot be run, holds no effect, or an id is taken.
    """
    if not path.is_file():
        raise SurveyError(Problem("there is no such file of effects", str(path)))
    spec = importlib.util.spec_from_file_location(f"surveyapp_user_effects_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise SurveyError(
            Problem("this is no Python file", str(path), path.suffix, "a file ending in .py")
        )
    module = importlib.util.module_from_spec(spec)
    written, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        spec.loader.exec_module(module)
    except Exception as fault:
        raise SurveyError(
            Problem(
                "the file of effects cannot be run",
                str(path),
                f"{type(fault).__name__}: {fault}",
                "a file that defines EFFECTS",
            )
        ) from fault
    finally:
        sys.dont_write_bytecode = written
    found = getattr(module, "EFFECTS", None)
    if found is None:
        found = (getattr(module, "EFFECT", None),)
    return _checked(tuple(found), path)


def _checked(found: tuple[object, ...], path: Path) -> tuple[Effect, ...]:
    effects = tuple(item for item in found if isinstance(item, Effect))
    faults = []
    if not effects or len(effects) != len(found):
        faults.append(
            Problem(
                "the file holds no effects",
                str(path),
                "no EFFECTS" if not effects else "something else among EFFECTS",
                "EFFECTS = (Effect(...), ...)",
                "Look at the reference of effects for the form.",
            )
        )
    taken = {(effect.subject, effect.id) for effect in CATALOGUE}
    for effect in effects:
        if (effect.subject, effect.id) in taken:
            faults.append(
                Problem(
                    "an effect with this id is already in the catalogue",
                    str(path),
                    f"{effect.subject}.{effect.id}",
                    "an id of its own",
                    nearest_names(effect.id, [i for s, i in taken if s == effect.subject]),
                )
            )
        taken.add((effect.subject, effect.id))
        if effect.subject not in SUBJECTS:
            faults.append(
                Problem(
                    "unknown subject of an effect",
                    str(path),
                    effect.subject,
                    ", ".join(SUBJECTS),
                )
            )
    if faults:
        raise SurveyError(faults)
    return effects
