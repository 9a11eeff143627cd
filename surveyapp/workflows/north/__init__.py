"""Finding north with a rate sensor: which method, what it needs, and the result.

One line of ``METHODS`` a method; the module behind it holds ``find(request) -> NorthResult``.
"""

from __future__ import annotations

import importlib
from typing import Final, cast

from surveyapp.domain.north import NorthResult
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import either
from surveyapp.workflows.north.request import NorthRequest, declination_problems

METHODS: Final = {
    "fog-station": "fog_station",
    "indexing": "indexing",
    "rotation": "rotation",
}
"""Method to its module."""


def find_north(request: NorthRequest) -> NorthResult:
    """Find north by the method of the request.

    Raises
    ------
    SurveyError
    """
    if request.method not in METHODS:
        found = request.method or ""
        what = "there is no such method" if found else "which method?"
        hint = nearest_names(found, METHODS) if found else ""
        raise SurveyError(Problem(what, "method", found, either(METHODS), hint))
    problems = declination_problems(request)
    module = importlib.import_module(f"{__name__}.{METHODS[request.method]}")
    try:
        result = cast("NorthResult", module.find(request))
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems:
        raise SurveyError(problems)
    return result


__all__ = ["METHODS", "NorthRequest", "NorthResult", "find_north"]
