"""What a campaign effect may depend on: one entry a column, and that is all there is to add.

The diagnosis that finds an effect, the orientation that applies it, the prediction, the actions
that are proposed next, the trial of a user's own effect and the page of the reference all read
``COLUMNS``: they mean the same by a temperature, a line or a day.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date
from typing import Literal

import numpy as np

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.sequence import session_timestamp
from surveyapp.core.swing.session import ReducedSession, TargetReduction
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import SWING_KINDS, ReadingKind
from surveyapp.domain.station_line import StationLine
from surveyapp_models.arrays import Floats

SECONDS_PER_DAY = 86400.0
EPOCH_ORDINAL = date(1970, 1, 1).toordinal()
NOON = 0.5
"""Part of the day at which a session stands that has a date and no times [d]."""
BLOCK_GAP_DAYS = 0.25
"""A pause of six hours ends a block: a shift is one block, also over midnight of any zone."""
LEAST_TEMPERATURE_K = 5.0
"""Standard deviation of a temperature that nobody read, at least."""


@dataclass(frozen=True, slots=True)
class Place:
    """One gyro azimuth of the project: what a column may look at.

    Parameters
    ----------
    item : ReducedSession
    target : TargetReduction
        One of its targets.
    position : Position
        Of the station [rad].
    """

    item: ReducedSession
    target: TargetReduction
    position: Position

    @property
    def session(self) -> OrientationSession:
        """The session as it was observed."""
        return self.item.session


Name = str | StationLine
"""A name: a line is its two stations, never the text that people read."""
Told = float | Name | None
"""What a project tells of one determination: a number, a name, or nothing."""
Example = Callable[[np.random.Generator, int], Floats]
"""Made-up values of a column: generator, how many."""


@dataclass(frozen=True, slots=True)
class CampaignColumn:
    """A circumstance of determinations that an effect may read under ``name``.

    Parameters
    ----------
    name : str
        Key in the columns of an effect.
    unit : str
        As the effects that need it state it.
    meaning : str
        For the reference page.
    of : callable
        From all gyro azimuths of an instrument to what each of them tells, None where the project
        does not say; of a column of names "" as well.
    example : callable
        Values for the trial of a user's own effect.
    named : bool
        It numbers names: between two numbers lies nothing.
    later : str
        Of a visit that is only planned: the ``mean`` of all, as ``last``, or a ``new`` name.
    of_line : bool
        Belongs to the line: another line that was visited before has its value from there.
    mean_fills : bool
        Where less than half of the determinations lack it their mean stands in (and that is told).
    least_spread : float
        Standard deviation of what a later visit does not tell, at least [unit].
    """

    name: str
    unit: str
    meaning: str
    of: Callable[[Sequence[Place]], Sequence[Told]]
    example: Example
    named: bool = False
    later: Literal["mean", "last", "new"] = "mean"
    of_line: bool = False
    mean_fills: bool = False
    least_spread: float = 0.0


def each(of: Callable[[Place], Told]) -> Callable[[Sequence[Place]], Sequence[Told]]:
    """A column that looks at one determination at a time."""
    return lambda places: [of(place) for place in places]


def _within(low: float, high: float) -> Example:
    return lambda generator, n: np.asarray(generator.uniform(low, high, n))


def day_of(place: Place) -> float | None:
    """Days since 1970-01-01 UTC, from the times of the book or the date of the session."""
    session = place.session
    stamp = session_timestamp(session)
    if stamp is None and session.date is not None:
        stamp = (session.date.toordinal() - EPOCH_ORDINAL + NOON) * SECONDS_PER_DAY
    return None if stamp is None else stamp / SECONDS_PER_DAY


def line_of(place: Place) -> StationLine:
    """The line that was observed."""
    return StationLine(place.session.station, place.target.target)


def block_names(days: Sequence[float | None]) -> list[str]:
    """Name the block of work of each determination, by the day on which the block began.

    Parameters
    ----------
    days : sequence of float or None
        Days since 1970-01-01 UTC, in any order; None where unknown.

    Returns
    -------
    list of str
        ``day 16732``; a second block that begins on the same day is ``day 16732 b``.
    """
    known = sorted({day for day in days if day is not None})
    names: dict[float, str] = {}
    used: dict[int, int] = {}
    name = ""
    for i, day in enumerate(known):
        if i == 0 or day - known[i - 1] > BLOCK_GAP_DAYS:
            first = math.floor(day)
            used[first] = used.get(first, 0) + 1
            name = f"day {first}" + ("" if used[first] == 1 else f" {chr(96 + used[first])}")
        names[day] = name
    return ["" if day is None else names[day] for day in days]


def session_temperature(session: OrientationSession) -> float | None:
    """Mean temperature of a session [degree Celsius], None where none was read."""
    rows = session.book.live
    values = [row.temperature_c for row in rows if row.temperature_c is not None]
    if not values:
        temperatures = session.book.of_kind(ReadingKind.TEMPERATURE)
        values = [row.value for row in temperatures if row.value is not None]
    return sum(values) / len(values) if values else None


def _line_reading(place: Place) -> float | None:
    reading = place.target.line_reading
    return None if reading is None else reading.value


def _north_reading(place: Place) -> float | None:
    north = place.item.reduction.north
    return None if north is None else north.value


def _running(place: Place) -> float | None:
    rows = [row for row in place.session.book.live if row.kind in SWING_KINDS]
    values = [row.elapsed_s for row in rows if row.elapsed_s is not None]
    return sum(values) / len(values) if values and len(values) == len(rows) else None


def _supply(place: Place) -> float | None:
    rows = [r for r in place.session.book.of_kind(ReadingKind.SUPPLY) if r.unit == "V"]
    values = [row.value for row in rows if row.value is not None]
    return sum(values) / len(values) if values else None


SETTLED_H = 168.0
"""A week: what an instrument is taken for where nothing tells when it came to its first station."""


def hours_since_transport(places: Sequence[Place]) -> list[Told]:
    """As stated, else hours since the latest determination at another station.

    At the first station of a campaign nobody knows when it arrived: it counts as settled, so that
    those that follow can be judged.
    """
    found: list[Told] = []
    first: list[int] = []
    for place in places:
        stated, day = place.session.hours_since_transport, day_of(place)
        if stated is not None or day is None:
            found.append(stated)
            continue
        days = [(day_of(p), p.session.station) for p in places]
        elsewhere = [
            other
            for other, station in days
            if other is not None and other < day and station != place.session.station
        ]
        if not elsewhere:
            first.append(len(found))
        found.append(24.0 * (day - max(elsewhere)) if elsewhere else None)
    if any(value is not None for value in found):
        for row in first:
            found[row] = SETTLED_H
    return found


COLUMNS: tuple[CampaignColumn, ...] = (
    CampaignColumn(
        "temperature_c",
        "degree Celsius",
        "mean of the temperatures read during the session",
        each(lambda place: session_temperature(place.session)),
        lambda generator, n: np.asarray(15.0 + 5.0 * generator.normal(size=n)),
        mean_fills=True,
        least_spread=LEAST_TEMPERATURE_K,
    ),
    CampaignColumn(
        "latitude",
        "rad",
        "latitude of the station",
        each(lambda place: place.position.latitude),
        _within(math.radians(30.0), math.radians(60.0)),
        of_line=True,
    ),
    CampaignColumn(
        "line_reading",
        "rad",
        "circle reading of the line",
        each(_line_reading),
        _within(0.0, math.tau),
        later="last",
        of_line=True,
    ),
    CampaignColumn(
        "north_reading",
        "rad",
        "circle reading of gyro north",
        each(_north_reading),
        _within(0.0, math.tau),
        later="last",
        of_line=True,
    ),
    CampaignColumn(
        "running_s",
        "s since spin-up",
        "mean `elapsed_s` of the readings, where the book counts from the spin-up",
        each(_running),
        _within(60.0, 3600.0),
        mean_fills=True,
    ),
    CampaignColumn(
        "elapsed_days",
        "d",
        "days since 1970-01-01 UTC, from the times of the book or the date of the session; the "
        "stated order where a determination has neither",
        each(day_of),
        lambda generator, n: 20000.0 + 10.0 * np.arange(n) + generator.uniform(0.0, 9.0, n),
    ),
    CampaignColumn(
        "line",
        "number of the line",
        "the line, numbered in the order of the project",
        each(line_of),
        lambda generator, n: np.asarray(np.arange(n) // 2 % 4, dtype=np.float64),
        named=True,
        later="new",
    ),
    CampaignColumn(
        "block",
        "number of the block, in order of time",
        "the block of work: determinations with no pause of six hours between them",
        lambda places: block_names([day_of(place) for place in places]),
        lambda generator, n: np.asarray(np.arange(n) // 3, dtype=np.float64),
        named=True,
        later="new",
    ),
    CampaignColumn(
        "observer",
        "number of the observer",
        "`observer` of the session",
        each(lambda place: place.session.observer),
        lambda generator, n: np.asarray(np.arange(n) % 3, dtype=np.float64),
        named=True,
        later="last",
    ),
    CampaignColumn(
        "pressure_hpa",
        "hPa",
        "`pressure_hpa` of the session",
        each(lambda place: place.session.pressure_hpa),
        _within(940.0, 1030.0),
    ),
    CampaignColumn(
        "humidity_percent",
        "%",
        "`humidity_percent` of the session",
        each(lambda place: place.session.humidity_percent),
        _within(20.0, 95.0),
    ),
    CampaignColumn(
        "supply_v",
        "V",
        "mean of the `supply` rows in volts",
        each(_supply),
        _within(22.0, 28.0),
        later="last",
    ),
    CampaignColumn(
        "transport_h",
        "h since transport",
        "`hours_since_transport` of the session, else hours since the latest determination at "
        "another station; at the first station of all it counts as settled (a week)",
        hours_since_transport,
        _within(0.5, 72.0),
    ),
)
"""Every column, in the order in which they are handed over. A new one goes to the end."""
BY_NAME = {column.name: column for column in COLUMNS}
LABELLED = frozenset(column.name for column in COLUMNS if column.named)
"""Columns that number names."""
