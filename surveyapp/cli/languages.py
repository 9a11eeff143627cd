"""The language of the screens and the record: an option, else the user's setting, else the locale.

What the other commands print is English, so that a script reads the same everywhere.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
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
