"""The circumstances of each determination: what the columns of a campaign say of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.campaign_columns import BY_NAME, COLUMNS, Place
from surveyapp.core.swing.session import ReducedSession
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Circumstances:
    """Circumstances of one determination.

    Parameters
    ----------
    order : float or None
        As stated: it stands in for time where no determination has a date.
    told : mapping of column to float or str
        By the names of ``COLUMNS``; what the project does not tell is not in it.
    """

    order: float | None
    told: Mapping[str, float | str]

    @classmethod
    def of(
        cls, columns: Mapping[str, float | str | None], order: float | None = None
    ) -> Circumstances:
        """Circumstances by the names of the columns, each in the unit of its column.

        Raises
        ------
        SurveyError
            If there is no such column, or a name stands for a number or the reverse.
        """
        problems = []
        for name, value in columns.items():
            column = BY_NAME.get(name)
            if column is None:
                hint = nearest_names(name, BY_NAME)
                problems.append(Problem("no such column of a campaign", name, name, "", hint))
            elif value is not None and isinstance(value, str) != column.named:
                expected = "a name" if column.named else f"a number [{column.unit}]"
                problems.append(
                    Problem("a column of a campaign has another kind", name, str(value), expected)
                )
        if problems:
            raise SurveyError(problems)
        return cls(order, {k: v for k, v in columns.items() if v is not None and v != ""})

    def number(self, column: str) -> float | None:
        """A number in the unit of its column, None where it is not told."""
        value = self.told.get(column)
        return None if isinstance(value, str) else value

    def name(self, column: str) -> str:
        """A name, empty where it is not told."""
        return str(self.told.get(column, ""))

    def undated(self, order: float | None) -> Circumstances:
        """Without the day, and with another order where one is given."""
        told = {name: value for name, value in self.told.items() if name != "elapsed_days"}
        return Circumstances(self.order if order is None else order, told)

    @property
    def time(self) -> float | None:
        """The day, where there is none the order."""
        day = self.number("elapsed_days")
        return self.order if day is None else day


def circumstances_of(places: Sequence[Place]) -> tuple[Circumstances, ...]:
    """Circumstances of the gyro azimuths of one instrument, which some columns see together."""
    values = {column.name: column.of(places) for column in COLUMNS}
    return tuple(
        Circumstances.of({name: values[name][i] for name in values}, place.session.order)
        for i, place in enumerate(places)
    )


def facts_of(
    reduced: Sequence[ReducedSession], instrument: str, positions: Mapping[str, Position]
) -> dict[tuple[str, str], Circumstances]:
    """Circumstances of every gyro azimuth of one instrument, by session and target."""
    places = [
        Place(item, target, positions[item.session.station])
        for item in reduced
        if item.session.instrument == instrument
        for target in item.targets
    ]
    return {
        (place.session.id, place.target.target): fact
        for place, fact in zip(places, circumstances_of(places), strict=True)
    }


def numbered(names: Sequence[str], known: Sequence[str] = ()) -> tuple[Floats, dict[float, str]]:
    """A column of names as numbers, in the order in which they come, and the name of each number.

    Parameters
    ----------
    names : sequence of str
    known : sequence of str
        Names that have the first numbers.
    """
    order = {name: float(i) for i, name in enumerate(dict.fromkeys([*known, *names]))}
    return np.array([order[name] for name in names]), {i: name for name, i in order.items()}


def columns_of(
    items: Sequence[Circumstances],
    *,
    known: Mapping[str, Sequence[str]] | None = None,
    time: Literal["days", "order", ""] = "",
) -> dict[str, Floats]:
    """Columns of a basis, one row for each determination; a gap is NaN.

    Parameters
    ----------
    items : sequence of Circumstances
    known : mapping of column to names, optional
        Names in the order in which they are numbered; further ones follow as they come.
    time : str
        What ``elapsed_days`` counts: days, or the stated order; empty = days if every item has
        them, else the order.
    """
    columns: dict[str, Floats] = {}
    for column in COLUMNS:
        name = column.name
        if column.named:
            columns[name], _ = numbered(
                [item.name(name) for item in items], (known or {}).get(name, ())
            )
        else:
            columns[name] = _numbers([item.number(name) for item in items])
    if time == "order" or (not time and bool(np.isnan(columns["elapsed_days"]).any())):
        columns["elapsed_days"] = _numbers([item.order for item in items])
    return columns


def _numbers(values: Sequence[float | None]) -> Floats:
    return np.array([math.nan if v is None else v for v in values], dtype=np.float64)
