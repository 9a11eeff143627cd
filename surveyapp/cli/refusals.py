"""A refusal as it is printed: in the reader's language; JSON and exit codes are the same for all.

What ``argparse`` says of itself is said in our words, so that it stands in the catalogue too.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from surveyapp.errors import SurveyError
from surveyapp.languages import joined, said, shown

_COUNTS: Final = {
    "expected one argument": said("it needs a value"),
    "expected at most one argument": said("it takes one value at most"),
    "expected at least one argument": said("it needs one value or more"),
}


def told(error: SurveyError) -> Iterator[str]:
    """Lines of an error in the language in use."""
    for problem in error.problems:
        yield shown(joined(": ", (problem.where, problem.what)) if problem.where else problem.what)
        if problem.found:
            yield "  " + shown(said("found: {text}", text=problem.found))
        if problem.expected:
            yield "  " + shown(said("expected: {text}", text=problem.expected))
        if problem.hint:
            yield "  " + shown(problem.hint)


def of_argparse(message: str) -> str:
    """A message of ``argparse`` as a text of the catalogue; one that is not known as it is."""
    if match := re.fullmatch(r"argument (\S+): not allowed with argument (.+)", message):
        return said("{option} does not go together with {other}", option=match[1], other=match[2])
    if match := re.fullmatch(r"one of the arguments (.+) is required", message):
        return said("one of {names} is needed", names=match[1])
    if match := re.fullmatch(r"argument (\S+): ignored explicit argument (.+)", message):
        return said("{option} takes no value: {value}", option=match[1], value=match[2])
    if match := re.fullmatch(r"argument (\S+): expected (\d+) arguments", message):
        return said("{option}: it needs {number} values", option=match[1], number=match[2])
    if match := re.fullmatch(r"argument ([^:]+): (.+)", message):
        return joined(": ", (match[1], _COUNTS.get(match[2], match[2])))
    return message
