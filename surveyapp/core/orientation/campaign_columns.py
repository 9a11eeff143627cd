"""What a campaign effect may depend on: the circumstances of each determination.

One place collects them from the reduced sessions, for the diagnosis that finds an effect and for
the orientation that applies it: both must mean the same by a temperature, a line or a day.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from typing import Literal

import numpy as np

from surveyapp.core.geodesy import Position
from surveyapp.core.orientation.sequence import session_timestamp
from surveyapp.core.swing.session import ReducedSession, TargetReduction
from surveyapp.domain.project import OrientationSession
from surveyapp.domain.readings import SWING_KINDS, ReadingKind
from surveyapp_models.arrays import Floats

SECONDS_PER_DAY = 86400.0
EPOCH_ORDINAL = date(1970, 1, 1).toordinal()
BLOCK_GAP_DAYS = 0.25
"""A pause of six hours ends a block: a shift is one block, also over midnight of any zone."""
LABELLED = frozenset({"line", "block"})
"""Columns that number names: between two numbers lies nothing."""
NUMBERS = ("temperature_c", "latitude", "line_reading", "north_reading", "running_s")


@dataclass(frozen=True, slots=True)
class Circumstances:
    """Circumstances of one determination; None where the project does not tell.

    Parameters
    ----------
    elapsed_days : float or None
        Days since 1970-01-01 UTC, from the times of the book or the date of the session.
    order : float or None
        As stated.
    line : str
        ``station-target``.
    block : str
        The block of work, named by the day on which it began (UTC); empty without a day.
    temperature_c : float or None
        Mean of the temperatures read.
    latitude : float or None
        [rad].
    line_reading, north_reading : float or None
        Circle readings [rad].
    running_s : float or None
        Mean elapsed_s of the observation: seconds since spin-up where the book counts from it.
    """

    elapsed_days: float | None
    order: float | None
    line: str
    block: str
    temperature_c: float | None
    latitude: float | None
    line_reading: float | None
    north_reading: float | None
    running_s: float | None


def circumstances(
    item: ReducedSession, target: TargetReduction, *, latitude: float | None
) -> Circumstances:
    """Collect the circumstances of one target of a reduced session; ``in_blocks`` names blocks."""
    session = item.session
    stamp = session_timestamp(session)
    if stamp is None and session.date is not None:
        stamp = (session.date.toordinal() - EPOCH_ORDINAL) * SECONDS_PER_DAY + 0.5 * SECONDS_PER_DAY
    days = None if stamp is None else stamp / SECONDS_PER_DAY
    north = item.reduction.north
    return Circumstances(
        elapsed_days=days,
        order=session.order,
        line=f"{session.station}-{target.target}",
        block="",
        temperature_c=session_temperature(session),
        latitude=latitude,
        line_reading=None if target.line_reading is None else target.line_reading.value,
        north_reading=None if north is None else north.value,
        running_s=_running(session),
    )


def facts_of(
    reduced: Sequence[ReducedSession], instrument: str, positions: Mapping[str, Position]
) -> dict[tuple[str, str], Circumstances]:
    """Circumstances of every gyro azimuth of one instrument, by session and target."""
    places = [
        (item, target)
        for item in reduced
        if item.session.instrument == instrument
        for target in item.targets
    ]
    facts = in_blocks(
        [
            circumstances(item, target, latitude=positions[item.session.station].latitude)
            for item, target in places
        ]
    )
    return {
        (item.session.id, target.target): fact
        for (item, target), fact in zip(places, facts, strict=True)
    }


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


def in_blocks(items: Sequence[Circumstances]) -> tuple[Circumstances, ...]:
    """The same circumstances with their block of work, which only all of them together tell."""
    names = block_names([item.elapsed_days for item in items])
    return tuple(replace(item, block=name) for item, name in zip(items, names, strict=True))


def session_temperature(session: OrientationSession) -> float | None:
    """Mean temperature of a session [degree Celsius], None where none was read."""
    rows = session.book.live
    values = [row.temperature_c for row in rows if row.temperature_c is not None]
    if not values:
        temperatures = session.book.of_kind(ReadingKind.TEMPERATURE)
        values = [row.value for row in temperatures if row.value is not None]
    return sum(values) / len(values) if values else None


def _running(session: OrientationSession) -> float | None:
    rows = [row for row in session.book.live if row.kind in SWING_KINDS]
    values = [row.elapsed_s for row in rows if row.elapsed_s is not None]
    return sum(values) / len(values) if values and len(values) == len(rows) else None


def columns_of(
    items: Sequence[Circumstances],
    *,
    lines: Sequence[str] = (),
    blocks: Sequence[str] = (),
    time: Literal["days", "order", ""] = "",
) -> dict[str, Floats]:
    """Columns of a basis, one row for each determination; a gap is NaN.

    Parameters
    ----------
    items : sequence of Circumstances
    lines, blocks : sequence of str
        Names in the order in which they are numbered; further ones follow as they come.
    time : str
        What ``elapsed_days`` counts: days, or the stated order; empty = days if every item has
        them, else the order.
    """
    columns = {
        name: np.array(
            [math.nan if (v := getattr(item, name)) is None else v for item in items],
            dtype=np.float64,
        )
        for name in NUMBERS
    }
    days = [item.elapsed_days for item in items]
    if time == "order" or (not time and any(day is None for day in days)):
        days = [item.order for item in items]
    columns["elapsed_days"] = np.array(
        [math.nan if day is None else day for day in days], dtype=np.float64
    )
    for name, known in (("line", lines), ("block", blocks)):
        values = [str(getattr(item, name)) for item in items]
        order = list(dict.fromkeys([*known, *values]))
        columns[name] = np.array([float(order.index(value)) for value in values])
    return columns
