"""Rows of a dividing-head log: which tests they belong to, and what is wrong with them."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import counted, said
from surveyapp_models.arrays import Floats

TESTS: Final = ("static", "transverse", "reversal", "zero", "capacitance", "dynamic")
RANGES: Final = {1: 90, 2: 30, 3: 15}
"""Set of the static test to its range in degrees."""


def rows_of(log: SensorLog, test: str) -> Floats:
    """Mask of the rows of a test, shape (n,)."""
    return np.array([name == test for name in log.texts["test"]])


def check_rows(log: SensorLog) -> None:
    """Refuse unknown tests, and rows that lack what their test needs.

    Raises
    ------
    SurveyError
        All of them together.
    """
    problems = [
        Problem(
            "there is no such test", log.path, name, " | ".join(TESTS), nearest_names(name, TESTS)
        )
        for name in sorted(set(log.texts["test"]) - set(TESTS))
    ]
    needs = {
        "static": ("set", "angle_deg", "output"),
        "transverse": ("angle_deg", "flip", "output"),
        "reversal": ("flip", "output"),
        "zero": ("output",),
        "capacitance": ("set", "frequency_hz", "impedance_ohm"),
        "dynamic": ("output",),
    }
    for test, columns in needs.items():
        rows = rows_of(log, test)
        if not np.any(rows):
            continue
        for column in columns:
            values = log.columns.get(column)
            if values is None:
                hint = said("`columns` {column}=COLUMN names it", column=column)
                what = said("the test {test} needs the column {column}", test=test, column=column)
                problems.append(Problem(what, log.path, "", column, hint))
                continue
            bad = np.flatnonzero(rows & ~np.isfinite(values))
            if bad.size:
                what = counted(
                    "{column} is not a number in {count} row of the test {test}",
                    "{column} is not a number in {count} rows of the test {test}",
                    count=bad.size,
                    column=column,
                    test=test,
                )
                where = said(
                    "{where}, line {line}", where=log.path, line=log.first_line + int(bad[0])
                )
                problems.append(Problem(what, where, "NaN or an empty cell", "a number"))
            elif column == "output" and test in ("static", "transverse"):
                problems += _constant(test, values[rows], log.path)
            elif (test, column) in _CODES:
                problems += _unknown_codes((test, column), values[rows], log.path)
    problems += _strange_angles(log)
    if problems:
        raise SurveyError(problems)


_CODES: Final = {
    ("static", "set"): (1.0, 2.0, 3.0),
    ("transverse", "flip"): (0.0, 1.0),
    ("reversal", "flip"): (0.0, 1.0),
    ("capacitance", "set"): (1.0, 2.0),
}


def _unknown_codes(cell: tuple[str, str], values: Floats, where: str) -> list[Problem]:
    """Numbers of sets and flips that mean nothing would leave their rows out unseen."""
    test, column = cell
    known = _CODES[cell]
    strange = sorted(set(values.tolist()) - set(known))
    if not strange:
        return []
    expected = " or ".join(f"{value:g}" for value in known)
    found = ", ".join(f"{value:g}" for value in strange)
    what = said("{column} of the test {test} is unknown", column=column, test=test)
    return [Problem(what, where, found, expected)]


def _strange_angles(log: SensorLog) -> list[Problem]:
    """Angles of a range that are far smaller or larger than it: radians, or another set."""
    number, angle = log.columns.get("set"), log.columns.get("angle_deg")
    if number is None or angle is None:
        return []
    problems = []
    for code, span in RANGES.items():
        rows = rows_of(log, "static") & (number == code)
        size = float(np.max(np.abs(angle[rows]))) if np.any(rows) else span
        if math.isfinite(size) and not 0.1 * span <= size <= 1.1 * span:
            what = said(
                "the angles of set {code} are not those of +-{span} degrees", code=code, span=span
            )
            found, hint = f"up to {size:g}", "are they in degrees? `units` COLUMN=rad"
            problems.append(Problem(what, log.path, found, said("up to {span}", span=span), hint))
    return problems


def _constant(test: str, values: Floats, where: str) -> list[Problem]:
    if values.size < 2 or float(np.ptp(values)) > 0.0:
        return []
    found, hint = f"{values[0]:g}", "is the sensor connected?"
    what = said("output is constant in the test {test}", test=test)
    return [Problem(what, where, found, "it varies", hint)]
