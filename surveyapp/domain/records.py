"""Results as flat records: what pandas, csv or a spreadsheet takes, one mapping a row.

Keys are those of the JSON; nested ones are joined by a point (``grid_azimuth.deg``). Lists of
values are joined by blanks, lists of objects have tables of their own and are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, Protocol, TypeVar

Cell = str | int | float | bool | None
_SIGNED: Final = re.compile(r"[+-](\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.IGNORECASE)


class Recorded(Protocol):
    """Anything with a JSON."""

    def to_dict(self) -> Mapping[str, Any]:
        """Keys of the JSON."""


ItemT = TypeVar("ItemT", bound=Recorded)


def flat(item: Mapping[str, Any]) -> dict[str, Cell]:
    """One row of a JSON object."""
    row: dict[str, Cell] = {}
    for key, value in item.items():
        if isinstance(value, Mapping):
            row |= {f"{key}.{name}": cell for name, cell in flat(value).items()}
        elif isinstance(value, list | tuple):
            if not any(isinstance(entry, Mapping | list | tuple) for entry in value):
                row[key] = " ".join("" if entry is None else str(entry) for entry in value)
        else:
            row[key] = value
    return row


def not_a_formula(text: str) -> str:
    """A text as a cell of CSV: one that a spreadsheet would take for a formula is quoted.

    A signed number is left alone; a name such as ``=1+2``, ``@SUM`` or ``-1-2`` is not.
    """
    formula = text[:1] in ("=", "@", "\t", "\r") or (
        text[:1] in ("+", "-") and not _SIGNED.fullmatch(text)
    )
    return f"'{text}" if formula else text


def rows_of(items: Sequence[Recorded]) -> list[dict[str, Cell]]:
    """One row an item."""
    return [flat(item.to_dict()) for item in items]


@dataclass(frozen=True, slots=True)
class Listing(Generic[ItemT]):
    """Several results of one kind, in order: a sequence with a JSON of its own.

    Parameters
    ----------
    schema, key : str
        Of the JSON: its name, and under which the items stand.
    items : tuple
    """

    schema: str
    key: str
    items: tuple[ItemT, ...]

    def __iter__(self) -> Iterator[ItemT]:
        return iter(self.items)

    def __len__(self) -> int:
        return len(self.items)

    def __getitem__(self, place: int) -> ItemT:
        return self.items[place]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"schema": self.schema, self.key: [item.to_dict() for item in self.items]}

    def rows(self) -> list[dict[str, Cell]]:
        """One flat record an item."""
        return rows_of(self.items)
