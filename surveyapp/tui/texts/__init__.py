"""Every text that the screens show, in English; what is read here is in the language in use.

One module a group of screens; whoever shows a text writes ``texts.NAME`` and need not know which.
Texts with braces are filled by ``str.format``. No text is made anywhere else in ``surveyapp.tui``.
The translations stand in ``surveyapp/languages``.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from surveyapp.languages import current, in_language, translated

if TYPE_CHECKING:
    from surveyapp.tui.texts.common import *
    from surveyapp.tui.texts.exchange import *
    from surveyapp.tui.texts.forms import *
    from surveyapp.tui.texts.habits import *
    from surveyapp.tui.texts.penetration import *
    from surveyapp.tui.texts.project import *
    from surveyapp.tui.texts.result import *
    from surveyapp.tui.texts.sensors import *
    from surveyapp.tui.texts.session import *

_MODULES: Final = (
    "common",
    "exchange",
    "forms",
    "habits",
    "penetration",
    "project",
    "result",
    "sensors",
    "session",
)
"""Modules of texts; no name stands in two of them."""


def modules() -> tuple[str, ...]:
    """Names of the modules of texts that ``texts.NAME`` looks into."""
    return _MODULES


def __getattr__(name: str) -> Any:
    """A text, or a table of texts, in the language in use."""
    if not name.isupper():
        raise AttributeError(name)
    return _in_language(name, current())


@cache
def _in_language(name: str, language: str) -> Any:
    for module in modules():
        found = vars(import_module(f"{__name__}.{module}")).get(name)
        if found is not None:
            with in_language(language):
                return told(found)
    raise AttributeError(f"no text {name}")


def told(value: Any) -> Any:
    """A text in the language in use; of a table its texts, not its keys."""
    if isinstance(value, str):
        return translated(value)
    if isinstance(value, dict):
        return {key: told(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return tuple(told(item) for item in value)
    return value
