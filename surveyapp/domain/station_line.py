"""A line as its two stations: their names may hold hyphens, so ``A-B`` alone does not tell it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final

SEPARATORS: Final = ("-", ",")
"""``A-B`` as people write it; ``A,B`` where hyphens in the names leave two meanings."""


@dataclass(frozen=True, slots=True, order=True)
class StationLine:
    """A line from a station to a target; back from there is another one.

    Parameters
    ----------
    station, target : str
    """

    station: str
    target: str

    def __str__(self) -> str:
        """For people: ``A-B``."""
        return f"{self.station}-{self.target}"

    @property
    def unmistakable(self) -> str:
        """As it is typed where ``A-B`` has two meanings: ``A,B``."""
        return f"{self.station},{self.target}"


def meanings(text: str, stations: Collection[str]) -> tuple[StationLine, ...]:
    """Every line between existing stations that a text may mean, in order."""
    known = set(stations)
    pairs = [
        StationLine(text[:place].strip(), text[place + 1 :].strip())
        for place, letter in enumerate(text)
        if letter in SEPARATORS
    ]
    return tuple(dict.fromkeys(p for p in pairs if p.station in known and p.target in known))
