"""Finding north with a rate sensor: which method, what it needs, and the result.

One line of ``METHODS`` a method; the module behind it holds ``find(request) -> NorthResult``.
"""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import Final, cast

from surveyapp.domain.north import NorthResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import either, listed, said
from surveyapp.workflows.north.request import NorthRequest, declination_problems

METHODS: Final = {
    "fog-station": "fog_station",
    "indexing": "indexing",
    "rotation": "rotation",
}
"""Method to its module."""
OPTIONS: Final = {
    "fog-station": (
        "latitude",
        "constant_deg",
        "constant_sigma_arcsec",
        "approximate_north_deg",
        "rate_sigma_deg_h",
        "reading_from_elevation",
    ),
    "indexing": (
        "latitude",
        "bias_prior_deg_h",
        "bias_prior_sigma_deg_h",
        "index_axis",
        "index_sigma_deg",
        "second",
        "indexed",
        "track",
        "card",
    ),
    "rotation": (
        "latitude",
        "initial_heading_deg",
        "initial_heading_sigma_deg",
        "initial_reference",
        "declination",
        "card",
    ),
}
"""Method to what it asks for."""


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
    return replace(result, warnings=(*result.warnings, *_not_asked(request)))


def _not_asked(request: NorthRequest) -> list[ResultWarning]:
    """Options that were given and belong to another method."""
    known = OPTIONS[request.method]
    strange = [name for name, value in request.options.items() if name not in known and value]
    if not strange:
        return []
    text = said(
        "{method} does not ask for {options}: it was not looked at",
        method=request.method,
        options=listed("--" + name.replace("_", "-") for name in strange),
    )
    return [ResultWarning("option_not_used", text)]


__all__ = ["METHODS", "NorthRequest", "NorthResult", "find_north"]
