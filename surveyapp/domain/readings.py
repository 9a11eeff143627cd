"""The field book as it was observed: rows, their kinds and what became of struck ones.

A row is never changed. A struck row stays in the book; what counts is decided by the reader of
the book (``surveyapp.io.fieldbook``), which lists the rows that count in ``FieldBook.live``.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


class ReadingKind(StrEnum):
    """What a row of the field book is."""

    BACKSIGHT = "backsight"
    ZENITH = "zenith"
    REVERSAL = "reversal"
    MISSED = "missed"
    CLAMP = "clamp"
    SCALE_REVERSAL = "scale_reversal"
    TRANSIT = "transit"
    TAPE_ZERO = "tape_zero"
    AZIMUTH = "azimuth"
    NORTH = "north"
    LEVEL_ALONG = "level_along"
    LEVEL_ACROSS = "level_across"
    SUPPLY = "supply"
    TEMPERATURE = "temperature"
    NOTE = "note"
    STRIKE = "strike"
    UNSTRIKE = "unstrike"


class Dimension(StrEnum):
    """The physical quantity of a reading kind; it fixes the units a row may carry."""

    ANGLE = "angle"
    DIVISIONS = "divisions"
    TILT = "tilt"
    SUPPLY = "supply"
    TEMPERATURE = "temperature"
    NONE = "none"


COLUMNS = (
    "seq",
    "time",
    "elapsed_s",
    "kind",
    "value",
    "unit",
    "face",
    "side",
    "target",
    "temperature_c",
    "note",
)
"""Columns of a field book."""

QUANTITY: dict[ReadingKind, Dimension] = {
    ReadingKind.BACKSIGHT: Dimension.ANGLE,
    ReadingKind.ZENITH: Dimension.ANGLE,
    ReadingKind.REVERSAL: Dimension.ANGLE,
    ReadingKind.MISSED: Dimension.NONE,
    ReadingKind.CLAMP: Dimension.ANGLE,
    ReadingKind.SCALE_REVERSAL: Dimension.DIVISIONS,
    ReadingKind.TRANSIT: Dimension.DIVISIONS,
    ReadingKind.TAPE_ZERO: Dimension.DIVISIONS,
    ReadingKind.AZIMUTH: Dimension.ANGLE,
    ReadingKind.NORTH: Dimension.ANGLE,
    ReadingKind.LEVEL_ALONG: Dimension.TILT,
    ReadingKind.LEVEL_ACROSS: Dimension.TILT,
    ReadingKind.SUPPLY: Dimension.SUPPLY,
    ReadingKind.TEMPERATURE: Dimension.TEMPERATURE,
    ReadingKind.NOTE: Dimension.NONE,
    ReadingKind.STRIKE: Dimension.NONE,
    ReadingKind.UNSTRIKE: Dimension.NONE,
}

QUIET_KINDS = frozenset({ReadingKind.NOTE, ReadingKind.STRIKE, ReadingKind.UNSTRIKE})
"""Rows that say something and measure nothing."""

SWING_KINDS = frozenset(
    {
        ReadingKind.REVERSAL,
        ReadingKind.MISSED,
        ReadingKind.SCALE_REVERSAL,
        ReadingKind.TRANSIT,
        ReadingKind.AZIMUTH,
        ReadingKind.NORTH,
    }
)
"""The rows that make the observation itself; what stands above them is before, below them after."""


class Face(StrEnum):
    """Telescope face of a sight."""

    LEFT = "L"
    RIGHT = "R"


class Side(StrEnum):
    """Side of the swing: R = larger reading = east."""

    LEFT = "L"
    RIGHT = "R"


class Place(StrEnum):
    """Where a row stands relative to the observation itself."""

    BEFORE = "before"
    DURING = "during"
    AFTER = "after"


@dataclass(frozen=True, slots=True)
class Reading:
    """One row of the field book.

    Parameters
    ----------
    seq : int
        Number of the row, unique and increasing.
    kind : ReadingKind
        What was read.
    value : float or None
        Angle kinds [rad], scale kinds [div], levels [rad], temperature [degree Celsius], supply in
        ``unit``; None for ``missed``, ``note``, ``strike`` and ``unstrike``.
    text : str
        The value exactly as it stands in the book.
    unit : str
        The unit token in force: dms, gon, deg, div, arcsec, s, C, V, Hz, mA, or empty.
    time : datetime or None
        Moment with UTC offset.
    elapsed_s : float or None
        Seconds since the surveyor's own zero.
    face : Face or None
    side : Side or None
        As written; the reader of the book infers it for the live turning points.
    target : str
        Name of the sighted station, empty for the session's own target.
    temperature_c : float or None
    note : str
    line : int
        Line of the file, counted from 1 (the header is line 1).
    strikes : int or None
        For ``strike`` and ``unstrike``: the struck row's seq.
    """

    seq: int
    kind: ReadingKind
    value: float | None
    text: str = ""
    unit: str = ""
    time: datetime | None = None
    elapsed_s: float | None = None
    face: Face | None = None
    side: Side | None = None
    target: str = ""
    temperature_c: float | None = None
    note: str = ""
    line: int = 0
    strikes: int | None = None


@dataclass(frozen=True, slots=True)
class FieldBook:
    """A whole book: every row, and the rows that count in the order in which they count.

    Parameters
    ----------
    rows : tuple of Reading
        Everything that stands in the book, struck rows and strikes included.
    live : tuple of Reading
        The rows that count, in order of place: a successor stands at the place of the row that it
        replaces; a struck turning point without successor stands there as ``missed``. Turning
        points and tape zeros carry their side, inferred where the book has none.
    struck : tuple of int
        seq of every struck row.
    torn_tail : str or None
        What was moved aside because its newline was missing, else None.
    """

    rows: tuple[Reading, ...]
    live: tuple[Reading, ...]
    struck: tuple[int, ...] = ()
    torn_tail: str | None = None

    def of_kind(self, *kinds: ReadingKind) -> tuple[Reading, ...]:
        """Live rows of the given kinds, in order."""
        return tuple(row for row in self.live if row.kind in kinds)

    def place_of(self, row: Reading) -> Place:
        """Tell whether a live row stands before, during or after the observation itself.

        A ``missed`` row bounds nothing: it may stand among the tape zeros as well.
        """
        kinds = SWING_KINDS - {ReadingKind.MISSED}
        places = [i for i, other in enumerate(self.live) if other.kind in kinds]
        index = self.live.index(row)
        if not places or index < places[0]:
            return Place.BEFORE
        return Place.AFTER if index > places[-1] else Place.DURING
