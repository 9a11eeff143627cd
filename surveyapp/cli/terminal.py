"""Whether there is a terminal that the screens can be drawn on."""

from __future__ import annotations

import os
import sys

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said


def need_terminal() -> None:
    """Refuse to open the screens where nobody could see or work them.

    Raises
    ------
    SurveyError
        If input or output is no terminal.
    """
    shown_on = sys.__stdout__ if os.name == "nt" else sys.__stderr__
    for stream, name in ((sys.__stdin__, "standard input"), (shown_on, "the output")):
        if stream is None or stream.closed or not stream.isatty():
            raise SurveyError(
                Problem(
                    "the screens need a terminal",
                    "surveyapp",
                    said("{name} is none", name=name),
                    "a terminal for keys and screens",
                    "The other commands need none: surveyapp --help lists them.",
                )
            )
