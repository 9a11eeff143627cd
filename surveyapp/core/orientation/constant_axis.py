"""The instrument constant through time as an axis: where each determination stands on it.

Days where the sessions say when they were observed, else their order. Nothing here draws.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime
from typing import Final

from surveyapp.domain.results import Determination

HOUR: Final = 3600.0
DAY: Final = 24.0 * HOUR
STEPS: Final = tuple(HOUR * n for n in (1, 3, 6, 12)) + tuple(
    DAY * n for n in (1, 2, 5, 10, 30, 90, 180, 365, 1825)
)
"""Distances of the ticks [s]."""
EPOCH: Final = date(1970, 1, 1).toordinal() * DAY
LARGEST_ORDER: Final = 1000.0 * DAY
"""Below it a moment is no time since 1970 but the stated order of a session."""


@dataclass(frozen=True, slots=True)
class ConstantAxis:
    """Places of determinations, and ticks to read them by.

    Parameters
    ----------
    dated : bool
        Whether places are days; else they tell the order.
    places : tuple of float
        One for each determination [s] or [-].
    ticks : tuple of (float, str)
        Place and label.
    """

    dated: bool
    places: tuple[float, ...]
    ticks: tuple[tuple[float, str], ...]


def calendar_moment(moment_s: float) -> datetime | None:
    """The moment of a session in UTC, None where only its order is known.

    Parameters
    ----------
    moment_s : float
        As ``Determination.moment_s`` has it: seconds since 1970, or days since year 1 in seconds
        where the sessions have dates only.
    """
    if moment_s < LARGEST_ORDER:
        return None
    return datetime.fromtimestamp(moment_s - EPOCH if moment_s >= EPOCH else moment_s, tz=UTC)


def constant_axis(items: Sequence[Determination], *, most_ticks: int) -> ConstantAxis:
    """Lay the determinations of one instrument along an axis.

    Parameters
    ----------
    items : sequence of Determination
        At least one.
    most_ticks : int
        As many labels as there is room for.
    """
    stamps = [item.moment_s for item in items if item.moment_s is not None]
    if len(stamps) < len(items) or len(set(stamps)) < 2:
        places = tuple(float(number) for number in range(1, len(items) + 1))
        return ConstantAxis(False, places, _numbers(places, most_ticks))
    moments = [calendar_moment(stamp) for stamp in stamps]
    days = [moment.timestamp() for moment in moments if moment is not None]
    if len(days) < len(stamps):
        return ConstantAxis(False, tuple(stamps), _numbers(stamps, most_ticks))
    return ConstantAxis(True, tuple(days), _dates(min(days), max(days), most_ticks))


def _numbers(places: Sequence[float], most: int) -> tuple[tuple[float, str], ...]:
    ordered = sorted(set(places))
    every = math.ceil(len(ordered) / max(most, 1))
    return tuple((place, f"{place:g}") for place in ordered[::every])


def _dates(low: float, high: float, most: int) -> tuple[tuple[float, str], ...]:
    step = next((s for s in STEPS if (high - low) / s < max(most - 1, 1)), STEPS[-1])
    pattern = "%Y-%m-%d" if step >= DAY else "%m-%d %H:%M"
    ticks = [step * k for k in range(math.ceil(low / step), math.floor(high / step) + 1)]
    if len(ticks) < 2:
        ticks = [low, high]
    return tuple((tick, datetime.fromtimestamp(tick, tz=UTC).strftime(pattern)) for tick in ticks)
