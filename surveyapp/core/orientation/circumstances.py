"""The circumstances of each determination: what the columns of a campaign say of it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.campaign_columns import BY_NAME, COLUMNS, Name, Place, Told
from surveyapp.core.swing.session import ReducedSession
from surveyapp.domain.station_line import StationLine
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import either, said
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Circumstances:
    """Circumstances of one determination.

    Parameters
    ----------
    order : float or None
        As stated: it stands in for time where no determination has a date.
    told : mapping of column to float or name
        By the names of ``COLUMNS``; what the project does not tell is not in it.
    """

    order: float | None
    told: Mapping[str, float | Name]

    @classmethod
    def of(cls, columns: Mapping[str, Told], order: float | None = None) -> Circumstances:
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
            elif value is not None and isinstance(value, str | StationLine) != column.named:
                expected = "a name" if column.named else said("a number [{unit}]", unit=column.unit)
                problems.append(
                    Problem("a column of a campaign has another kind", name, str(value), expected)
                )
        if problems:
            raise SurveyError(problems)
        return cls(order, {k: v for k, v in columns.items() if v is not None and v != ""})

    def number(self, column: str) -> float | None:
        """A number in the unit of its column, None where it is not told."""
        value = self.told.get(column)
        return None if isinstance(value, str | StationLine) else value

    def name(self, column: str) -> Name:
        """A name, empty where it is not told."""
        value = self.told.get(column, "")
        return value if isinstance(value, str | StationLine) else ""

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


def numbered(names: Sequence[Name], known: Sequence[Name] = ()) -> tuple[Floats, dict[float, str]]:
    """A column of names as numbers, in the order in which they come, and the text of each number.

    Parameters
    ----------
    names : sequence of name
    known : sequence of name
        Names that have the first numbers.
    """
    order = {name: float(i) for i, name in enumerate(dict.fromkeys([*known, *names]))}
    texts = texts_of(order)
    return np.array([order[name] for name in names]), {i: texts[name] for name, i in order.items()}


def texts_of(names: Iterable[Name]) -> dict[Name, str]:
    """A text for each name, no two alike: lines that both read A-B-C are A,B-C and A-B,C."""
    every = dict.fromkeys(names)
    count = Counter(str(name) for name in every)
    alike = {name for name in every if count[str(name)] > 1}
    return {
        name: name.unmistakable if name in alike and isinstance(name, StationLine) else str(name)
        for name in every
    }


def name_of(text: str, names: Iterable[Name]) -> Name:
    """The one name that a text means; the text itself where it means none of them.

    Raises
    ------
    SurveyError
        If it means several lines.
    """
    found = [
        name
        for name in dict.fromkeys(names)
        if str(name) == text or (isinstance(name, StationLine) and name.unmistakable == text)
    ]
    if len(found) > 1:
        expected = either(x.unmistakable for x in found if isinstance(x, StationLine))
        hint = "Write the station and the target with a comma between them."
        raise SurveyError(Problem("this name means several lines", "line", text, expected, hint))
    return found[0] if found else text


def columns_of(
    items: Sequence[Circumstances],
    *,
    known: Mapping[str, Sequence[Name]] | None = None,
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
