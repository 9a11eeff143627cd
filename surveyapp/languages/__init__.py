"""The languages of the screens and the record: English, and catalogues beside this module.

Texts are written in English where they arise (``said``); the screens and the record show them with
``shown`` in the language in use. JSON, files and ids stay English, so that what a script reads does
not depend on who runs it. Numbers keep the decimal point in every language.
"""

from __future__ import annotations

import gettext
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path
from typing import Final

from surveyapp.languages.po_file import read_po, translations
from surveyapp.languages.said import (
    Said,
    counted,
    either,
    joined,
    listed,
    said,
    said_each,
    sentence,
    some,
    term,
)

__all__ = [
    "LANGUAGES",
    "Said",
    "counted",
    "current",
    "either",
    "in_language",
    "joined",
    "listed",
    "preferred",
    "said",
    "said_each",
    "term",
    "sentence",
    "shown",
    "some",
    "translated",
    "use",
]

LANGUAGES: Final[Mapping[str, str]] = {
    "en": "English",
    "de": "Deutsch",
    "ru": "Русский",
    "zh": "中文",
}
"""Code and own name of every language."""
_VARIABLES: Final = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")
_ENGLISH_NAMES: Final = {"german": "de", "russian": "ru", "chinese": "zh", "english": "en"}
_current: ContextVar[str] = ContextVar("language", default="")
_chosen = ["en"]
"""The language of the process, also of its threads; a context may use another for a while."""


def current() -> str:
    """Code of the language in use."""
    return _current.get() or _chosen[0]


def use(language: str) -> None:
    """Show texts in a language from now on; an unknown one is English."""
    _chosen[0] = language if language in LANGUAGES else "en"


@contextmanager
def in_language(language: str) -> Iterator[None]:
    """Show texts in a language for a while."""
    token = _current.set(language if language in LANGUAGES else "en")
    try:
        yield
    finally:
        _current.reset(token)


def preferred(setting: str = "", environment: Mapping[str, str] | None = None) -> str:
    """Code of the language wished for: the user's setting, else that of the locale.

    Parameters
    ----------
    setting : str
        As the user has chosen it; empty or unknown: the locale decides.
    environment : mapping or None
        Variables of the environment; None: those of the process. ``LANGUAGE`` (a list with
        colons) goes before ``LC_ALL``, ``LC_MESSAGES`` and ``LANG``, as with ``gettext``.
    """
    if setting in LANGUAGES:
        return setting
    variables = os.environ if environment is None else environment
    for name in _VARIABLES:
        value = variables.get(name, "")
        if not value:
            continue
        for item in value.split(":"):
            if (code := _code(item)) in LANGUAGES:
                return code
        if name != "LANGUAGE":
            return "en"
    return _of_system() if environment is None else "en"


def _code(locale_name: str) -> str:
    """Code of a name such as ``de_DE.UTF-8``, ``zh-Hans`` or ``German_Germany``."""
    first = locale_name.replace("-", "_").split("_")[0].split(".")[0].lower()
    return _ENGLISH_NAMES.get(first, first)


def _of_system() -> str:
    """Where no variable tells (Windows): what the system says."""
    import locale

    try:
        name = locale.getlocale()[0] or ""
    except ValueError:
        return "en"
    code = _code(name)
    return code if code in LANGUAGES else "en"


@lru_cache(maxsize=len(LANGUAGES))
def catalogue(language: str) -> gettext.NullTranslations:
    """The translations of a language; a catalogue that cannot be read leaves English."""
    if language == "en":
        return gettext.NullTranslations()
    try:
        text = (Path(__file__).parent / f"{language}.po").read_text(encoding="utf-8")
        return translations(read_po(text))
    except (OSError, ValueError, SyntaxError):
        return gettext.NullTranslations()


def _translate(template: str, plural: str | None, count: int) -> str:
    found = catalogue(current())
    if plural is not None:
        return found.ngettext(template, plural, count)
    return found.gettext(template) if template else ""


def shown(text: str) -> str:
    """A text as it is shown: ``Said`` in the language in use, everything else as it is."""
    return text.told(_translate) if isinstance(text, Said) else text


def translated(text: str) -> str:
    """A text of the catalogue by its English: for names and texts kept as plain strings."""
    return shown(text) if isinstance(text, Said) else _translate(text, None, 0)
