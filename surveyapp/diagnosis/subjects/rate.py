"""A rate sensor as a subject: the outputs of its stops, a row for each gyro.

A stop is a rest in some attitude, or whole turns of a table at a known rate. The base model is
bias, scale factor and misalignment; of rests alone it is the bias.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.action import Action, last_rows
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.subject import Record, Subject, case_of
from surveyapp.errors import Problem, SurveyError
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Columns, Effect
from surveyapp_models.effects.rate import (
    AXIS,
    DEG_S,
    ELAPSED,
    FIELDS,
    FORCES,
    INPUTS,
    PLACE,
    STOP,
    TEMPERATURE,
    by_axis,
)

LEAST_STOPS = 4


@dataclass(frozen=True, slots=True)
class RateStop:
    """What the gyros showed at one stop.

    Parameters
    ----------
    output : ndarray, shape (3,)
        [rad/s]; what is known of the earth rate taken out.
    elapsed_s : float
    force : ndarray, shape (3,), or None
        [m/s2]
    known : ndarray, shape (3,), or None
        Known rate of the body [rad/s]; None = at rest.
    place : int or None
        Position on the table.
    temperature_c : float or None
    field : ndarray, shape (3,), or None
        [T]
    label : str
    """

    output: Floats
    elapsed_s: float
    force: Floats | None = None
    known: Floats | None = None
    place: int | None = None
    temperature_c: float | None = None
    field: Floats | None = None
    label: str = ""


def rest_base(columns: Columns, /) -> Floats:
    """A bias for each gyro, shape (n, 3)."""
    return by_axis(columns, np.ones(columns["axis"].size))


def turned_base(columns: Columns, /) -> Floats:
    """Bias and response to the known rates of each gyro, shape (n, 12)."""
    rates = [by_axis(columns, columns[f"input_{a}"]) for a in "xyz"]
    return np.column_stack([rest_base(columns), *rates])


def _repeated(columns: Columns) -> dict[str, Floats]:
    """Rows of one more stop as the last one was."""
    rows = last_rows(columns, 3)
    return {**rows, "axis": np.arange(3.0)}


def _upside_down(columns: Columns, /) -> dict[str, Floats] | None:
    """The last stop with every force reversed."""
    if "force_x" not in columns:
        return None
    rows = _repeated(columns)
    return {**rows, **{f"force_{a}": -rows[f"force_{a}"] for a in "xyz"}}


def _warmer(columns: Columns, /) -> dict[str, Floats] | None:
    """The last stop five kelvin warmer."""
    if "temperature_c" not in columns:
        return None
    rows = _repeated(columns)
    return {**rows, "temperature_c": rows["temperature_c"] + 5.0}


ACTIONS = (
    Action("upside_down", "repeat the last stop upside down", _upside_down),
    Action("warmer", "repeat the last stop 5 K warmer", _warmer),
)
COLUMNS = (AXIS, STOP, ELAPSED, TEMPERATURE, *FORCES, *INPUTS, *FIELDS, PLACE)


def rate_subject(*, turned: bool) -> Subject:
    """The subject of stops at rest, or of stops on a table that turned."""
    biases = tuple(f"bias_{a}" for a in "xyz")
    matrix = tuple(f"response_{a}{b}" for b in "xyz" for a in "xyz")
    names = (*biases, *matrix) if turned else biases
    return Subject(
        id="rate",
        title="a rate sensor",
        value_name="the mean bias of the three gyros",
        columns=COLUMNS,
        base=turned_base if turned else rest_base,
        base_names=names,
        effects=of_subject("rate"),
        value=tuple(1.0 / 3.0 if k < 3 else 0.0 for k in range(len(names))),
        actions=ACTIONS,
        unit="deg/s",
        scale=DEG_S,
        position="elapsed_s",
    )


def rate_case(stops: Sequence[RateStop], *, identity: str, extra: tuple[Effect, ...] = ()) -> Case:
    """The case of the stops of a record.

    Raises
    ------
    SurveyError
        If there are too few.
    """
    if len(stops) < LEAST_STOPS:
        raise SurveyError(
            Problem(
                "too few stops to diagnose", identity, str(len(stops)), f"{LEAST_STOPS} or more"
            )
        )
    turned = any(s.known is not None for s in stops)
    count = len(stops)

    def each(values: Sequence[float]) -> Floats:
        return np.repeat(np.array(values, dtype=np.float64), 3)

    columns: dict[str, Floats] = {
        "axis": np.tile(np.arange(3.0), count),
        "stop": each([k + 1.0 for k in range(count)]),
        "elapsed_s": each([s.elapsed_s - stops[0].elapsed_s for s in stops]),
    }
    for name, values in (
        ("force", [s.force for s in stops]),
        ("field", [s.field for s in stops]),
        ("input", [np.zeros(3) if s.known is None else s.known for s in stops] if turned else []),
    ):
        kept = [v for v in values if v is not None]
        if kept and len(kept) == count:
            table = np.array(kept)
            columns |= {f"{name}_{a}": each(table[:, i].tolist()) for i, a in enumerate("xyz")}
    temperatures = [s.temperature_c for s in stops if s.temperature_c is not None]
    if len(temperatures) == count and np.ptp(temperatures) > 0.0:
        columns["temperature_c"] = each(temperatures)
    places = [float(s.place) for s in stops if s.place is not None]
    if len(places) == count:
        columns["place"] = each(places)
    record = Record(
        np.concatenate([s.output for s in stops]),
        columns,
        identity=identity,
        labels=tuple(
            f"{s.label or f'stop {k + 1}'}, gyro {a}" for k, s in enumerate(stops) for a in "xyz"
        ),
        groups=columns["stop"],
        extra=extra,
    )
    return case_of(rate_subject(turned=turned), record)
