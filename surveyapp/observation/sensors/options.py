"""Options of a task on a sensor log, told in one line under the names of the command line.

``key=value`` each: ``latitude=47.1 programme=six-position unit.out=LSB map.time_s=t``.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from surveyapp import api
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.decimals import typed_number
from surveyapp.languages import said

_NUMBER, _TEXT, _FLAG = "number", "text", "flag"
_CALIBRATE: Final = {
    "heading_limit_deg": _NUMBER,
    "declination": _TEXT,
    "reference_temperature_c": _NUMBER,
    "programme": _TEXT,
    "latitude": _NUMBER,
    "flip_sigma_arcsec": _NUMBER,
    "table_rate_relative_sigma": _NUMBER,
    "predict_at": _TEXT,
    "room": _TEXT,
    "gravity_m_s2": _NUMBER,
    "reading_from_elevation": _TEXT,
}
_NORTH: Final = {
    "method": _TEXT,
    "latitude": _NUMBER,
    "constant_deg": _NUMBER,
    "constant_sigma_arcsec": _NUMBER,
    "approximate_north_deg": _NUMBER,
    "rate_sigma_deg_h": _NUMBER,
    "bias_prior_deg_h": _TEXT,
    "bias_prior_sigma_deg_h": _NUMBER,
    "index_sigma_deg": _NUMBER,
    "initial_heading_deg": _NUMBER,
    "initial_heading_sigma_deg": _NUMBER,
    "initial_reference": _TEXT,
    "reading_from_elevation": _TEXT,
    "card": _TEXT,
    "index_axis": _TEXT,
    "second": _TEXT,
    "indexed": _TEXT,
    "declination": _TEXT,
    "track": _FLAG,
}
OPTIONS: Final[Mapping[str, Mapping[str, str]]] = {
    "calibrate": {"kind": _TEXT, **_CALIBRATE},
    "allan": {"column": _TEXT, "estimator": _TEXT},
    "filter": {"column": _TEXT, "filter": _TEXT, "q": _NUMBER, "r": _NUMBER, "seed": _NUMBER},
    "spectrum": {
        "column": _TEXT,
        "against": _TEXT,
        "field_uT": _NUMBER,
        "sensitivity": _NUMBER,
        "shielding": _NUMBER,
    },
    "motion": {
        "false_alarm": _NUMBER,
        "path": _FLAG,
        "from": _TEXT,
        "to": _TEXT,
        "snap": _FLAG,
        "snap_power_cycle": _TEXT,
        "still_gate_factor": _NUMBER,
    },
    "north": _NORTH,
    "plan": {"grade": _TEXT, "latitude": _NUMBER, "want_deg": _NUMBER},
    "diagnose": {},
    "add": {
        "id": _TEXT,
        "kind": _TEXT,
        "programme": _TEXT,
        "instrument": _TEXT,
        "serial": _TEXT,
        "latitude": _NUMBER,
        "day": _TEXT,
        "declination_deg": _NUMBER,
        "declination_sigma_deg": _NUMBER,
        "heading_limit_deg": _NUMBER,
        "reading_from_elevation": _TEXT,
        "flip_sigma_arcsec": _NUMBER,
        "table_rate_relative_sigma": _NUMBER,
        "gravity_m_s2": _NUMBER,
        "method": _TEXT,
        "room": _TEXT,
        "note": _TEXT,
    },
}
"""Task to its options, each with the kind of its value."""


@dataclass(frozen=True, slots=True)
class ToldOptions:
    """One line of options: those of the task, and how the columns are to be understood."""

    own: Mapping[str, object] = field(default_factory=dict)
    log: api.LogOptions = field(default_factory=api.LogOptions)


def told_options(task: str, text: str) -> ToldOptions:
    """Options from one line.

    Raises
    ------
    SurveyError
        For what is no option of the task; all together.
    """
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise SurveyError(
            Problem(said("a quote is open ({error})", error=error), "options", text)
        ) from None
    known = OPTIONS[task]
    own: dict[str, object] = {}
    parts: dict[str, dict[str, str]] = {"map": {}, "unit": {}, "scale": {}}
    rows: dict[str, float] = {}
    problems: list[Problem] = []
    for word in words:
        key, sign, value = word.partition("=")
        prefix, dot, name = key.partition(".")
        name_of_option = key.replace("-", "_")
        if dot and prefix in parts and value:
            parts[prefix][name] = value
        elif name_of_option in ("rate_hz", "header_rows") and sign:
            rows[name_of_option] = _number(key, value, problems)
        elif known.get(name_of_option) == _FLAG and (value or not sign):
            own[name_of_option] = _flag(key, value or "true", problems)
        elif name_of_option in known and sign and value:
            number = known[name_of_option] == _NUMBER
            own[name_of_option] = _number(key, value, problems) if number else value
        else:
            problems.append(_unknown(word, name_of_option, task))
    scale = {
        name: _number(f"scale.{name}", text, problems) for name, text in parts["scale"].items()
    }
    if problems:
        raise SurveyError(problems)
    header = rows.get("header_rows")
    log = api.LogOptions(
        parts["map"],
        parts["unit"],
        scale,
        rows.get("rate_hz"),
        None if header is None else int(header),
    )
    return ToldOptions(own, log)


def _number(name: str, text: str, problems: list[Problem]) -> float:
    try:
        return typed_number(text)
    except ValueError:
        problems.append(
            Problem("this is no number", said("options, {name}", name=name), text, "a number")
        )
        return math.nan


def _flag(name: str, text: str, problems: list[Problem]) -> bool:
    """A word alone is true, as an option of the command line is that takes no value."""
    if text.lower() not in ("true", "false"):
        problems.append(
            Problem(
                "this is neither true nor false",
                said("options, {name}", name=name),
                text,
                "true, false",
            )
        )
    return text.lower() == "true"


def _unknown(word: str, name: str, task: str) -> Problem:
    known = [*OPTIONS[task], "map.", "unit.", "scale.", "rate_hz", "header_rows"]
    shown = ", ".join(key.replace("_", "-") for key in OPTIONS[task]) or "none of its own"
    return Problem(
        said("there is no such option of {task}", task=task),
        "options",
        word,
        said(
            "key=value: {shown}; map.CANON=COLUMN, unit.COLUMN=UNIT, scale.COLUMN=VALUE",
            shown=shown,
        ),
        nearest_names(name, known),
    )
