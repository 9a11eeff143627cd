"""The language of the screens and the record: an option, else the user's setting, else the locale.

JSON is English, so that a script reads the same everywhere; refusals, and results that are made of
the blocks of the record, are said to a person, in the language wished for.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Final

from surveyapp import languages

SCREENS: Final = "surveyapp.tui"


def add_language(parser: argparse.ArgumentParser) -> None:
    """Declare the option."""
    parser.add_argument(
        "--language",
        choices=tuple(languages.LANGUAGES),
        help="of the record (default: as set on the screens, else of the locale)",
    )


def wished(option: str | None = None) -> str:
    """Code of the language wished for."""
    from surveyapp.io.settings import read_settings

    return option or languages.preferred(read_settings().language)


@contextmanager
def in_wished() -> Iterator[None]:
    """Say texts in the language wished for; whatever is wrong with the setting, they are said."""
    try:
        language = wished()
    except (OSError, ValueError):
        language = languages.preferred()
    with languages.in_language(language):
        yield


def run_screens(run: Callable[[ModuleType], int]) -> int:
    """Run the screens in the language wished for, and again when another one was chosen there.

    Their texts are read when their modules are loaded, so these are loaded anew.
    """
    while True:
        languages.use(wished())
        from surveyapp.tui import app

        code = run(app)
        if code != app.OTHER_LANGUAGE:
            return code
        for name in [name for name in sys.modules if name.startswith(SCREENS)]:
            del sys.modules[name]
