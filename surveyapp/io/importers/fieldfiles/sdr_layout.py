"""Columns of an SDR file: how wide they are, how its records usually look, and which are torn.

A field book is written by a machine: records of a kind are equally long or all trimmed, values
have equally many decimals and begin where their column begins. What differs was damaged. Which
record a torn one was, and so what is lost with it, is guessed only towards losing more.

Sources: Nikon and Spectra Precision manuals, SDR record formats; MicroSurvey, SDR format.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

KINDS: Final = ("02", "03", "08", "09")
"""Records whose columns are known: names, values, whether a text follows."""
_FIELDS: Final = {"02": (1, 4, True), "03": (0, 1, False), "08": (1, 3, True), "09": (2, 3, True)}
_BACK: Final = (2, 2, False)
"""Record 07: station, back sight, azimuth and circle reading; it is not used."""
TEXT: Final = 16
_SIGNATURES: Final = (
    *("00NM", "01NM", "02TP", "02NM", "02KI", "03NM", "06NM", "07TP", "07NM", "07KI"),
    *("08KI", "08TP", "08NM", "09F1", "09F2", "09MC", "10NM", "12SC", "13PC", "13TS", "13NM"),
)
_EMBEDDED: Final = re.compile(r"(0[1-389]|13)(?:NM|TP|KI|F1|F2|MC|PC)(?=[-+ 0-9A-Z])")
_MOST_STATIONS: Final = 10_000
_USUAL: Final = 0.9
_LEAST: Final = 4


class RecordError(ValueError):
    """A record that cannot be read: what is wrong with it."""


@dataclass(slots=True)
class Shape:
    """How the records of one file look.

    Parameters
    ----------
    version : str
    name, value : int
        Widths of names and values.
    lengths : dict
        Length of each kind, where nearly all its records are padded to the same.
    last : dict
        Last column of each kind that nearly all its records fill.
    decimals : dict
        Decimals of nearly all values of each column of each kind.
    right : bool
        Whether values stand at the right end of their columns.
    dotted : bool
        Whether values below one are written without a zero.
    stations : Counter
        How often each station is named by readings.
    """

    version: str
    name: int
    value: int
    lengths: dict[str, int] = field(default_factory=dict)
    last: dict[str, int] = field(default_factory=dict)
    decimals: dict[tuple[str, int], int] = field(default_factory=dict)
    right: bool = False
    dotted: bool = False
    stations: Counter[str] = field(default_factory=Counter)

    def full(self, kind: str) -> int:
        """Bytes of a record up to the end of its last value."""
        names, values, _ = _FIELDS.get(kind, _BACK)
        return 4 + names * self.name + values * self.value

    def fields(self, kind: str, line: str) -> Iterator[str]:
        """Values of a record as they stand in their columns."""
        names, values, _ = _FIELDS[kind]
        start = 4 + names * self.name
        for place in range(start, start + values * self.value, self.value):
            yield line[place : place + self.value]

    def names(self, line: str, count: int) -> list[str]:
        """Names of a record.

        Raises
        ------
        RecordError
            If one has a hole in it.
        """
        found = [line[4 + i * self.name : 4 + (i + 1) * self.name].strip() for i in range(count)]
        for name in found:
            if "  " in name:
                raise RecordError(said("a name has a gap: {name}", name=name))
        return found

    def number(self, line: str, kind: str, place: int, what: str) -> float | None:
        """A value of a record, None where its column is empty.

        Raises
        ------
        RecordError
            If it is no number, or does not look like those of the file.
        """
        start = 4 + _FIELDS[kind][0] * self.name + place * self.value
        cell = line[start : start + self.value]
        text = cell.strip()
        if not text:
            return None
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or not text[-1].isdigit():
            raise RecordError(said("{what} is no number: {text}", what=what, text=text))
        if text.lstrip("+-").startswith(".") and not self.dotted:
            raise RecordError(
                said("{what} has lost the digit before its point: {text}", what=what, text=text)
            )
        if cell[0] == " " and not self.right:
            raise RecordError(
                said("{what} does not begin in its column: {text}", what=what, text=text)
            )
        places, usual = _decimals(text), self.decimals.get((kind, place))
        fills = len(text) >= self.value
        if usual is not None and (places > usual if fills else places != usual):
            raise RecordError(
                said(
                    "{what} has {places} decimals instead of {usual}: {text}",
                    what=what,
                    places=places,
                    usual=usual,
                    text=text,
                )
            )
        return value

    def alone(self, kind: str, line: str) -> None:
        """Refuse a line whose end was lost, so that a second record stands in it.

        Raises
        ------
        RecordError
            With what is wrong.
        """
        names = _FIELDS[kind][0] if kind in _FIELDS else 0
        if _EMBEDDED.search(line, 4 + names * self.name) is not None:
            raise RecordError("two records stand in one line")

    def check(self, kind: str, line: str) -> None:
        """Refuse a record that is longer or shorter than those of its kind.

        Raises
        ------
        RecordError
            With what is wrong.
        """
        origin = line[2:4]
        if not (origin == "  " or (origin.isalnum() and origin[0].isalpha())):
            raise RecordError(
                said("the record {kind} has no origin: {line}", kind=kind, line=line[:8])
            )
        self.alone(kind, line)
        usual, full = self.lengths.get(kind), self.full(kind)
        filled = [i for i, cell in enumerate(self.fields(kind, line)) if cell.strip()]
        if (usual is not None and len(line) < usual) or max(filled, default=-1) < self.last.get(
            kind, 0
        ):
            raise RecordError(said("the record {kind} is cut short", kind=kind))
        longest = full + (TEXT if _FIELDS[kind][2] else 0)
        shifted = (
            usual is not None and len(line) > usual and (usual > full or not line[full:].strip())
        )
        if len(line.rstrip()) > longest or shifted:
            raise RecordError(said("the record {kind} is too long", kind=kind))


def shape_of(lines: Iterable[str], where: str) -> Shape:
    """Widths from the header, and how complete records look.

    Parameters
    ----------
    lines : iterable of str
        Every line of the file.
    where : str
        What messages call it.

    Raises
    ------
    SurveyError
        Without a header of a known version.
    """
    found: Shape | None = None
    seen = _Seen()
    first = ""
    for line in lines:
        kind = line[:2]
        if found is not None and kind in _FIELDS:
            seen.take(found, kind, line)
        elif found is None and kind == "00":
            first = line
            found = _version(line)
            if found is None:
                break
    if found is None:
        raise SurveyError(
            Problem(
                "the file has no header of SDR33 or SDR20",
                where,
                first.strip()[:40] or "no record 00",
                "a record 00 with the version SDR33 or SDR20",
            )
        )
    seen.tell(found)
    return found


@dataclass(slots=True)
class _Seen:
    """What the records of a file have been like so far."""

    lengths: dict[str, Counter[int]] = field(default_factory=dict)
    last: dict[str, Counter[int]] = field(default_factory=dict)
    decimals: dict[tuple[str, int], Counter[int]] = field(default_factory=dict)
    starts: Counter[bool] = field(default_factory=Counter)
    dotted: Counter[bool] = field(default_factory=Counter)

    def take(self, shape: Shape, kind: str, line: str) -> None:
        """Count a record."""
        self.lengths.setdefault(kind, Counter())[len(line)] += 1
        last = -1
        for place, cell in enumerate(shape.fields(kind, line)):
            text = cell.strip()
            if text:
                last = place
                if len(text) < shape.value:
                    self.decimals.setdefault((kind, place), Counter())[_decimals(text)] += 1
                    self.starts[cell[0] == " "] += 1
                    bare = text.lstrip("+-")
                    if bare.startswith(("0.", ".")):
                        self.dotted[bare[0] == "."] += 1
        self.last.setdefault(kind, Counter())[last] += 1
        if kind == "09" and len(shape.stations) < _MOST_STATIONS:
            shape.stations[line[4 : 4 + shape.name].strip()] += 1

    def tell(self, shape: Shape) -> None:
        """Put what nearly all records have into the shape."""
        whole: Counter[int] = Counter()
        for counts in self.decimals.values():
            whole.update(counts)
        every = _usual(whole)
        for kind in self.lengths:
            length, last = _usual(self.lengths[kind]), _usual(self.last[kind])
            if length is not None and length >= shape.full(kind):
                shape.lengths[kind] = length
            if last is not None:
                shape.last[kind] = last
        for column, own in self.decimals.items():
            usual = _usual(own)
            if usual is None and every is not None and own.total() < _LEAST:
                usual = every if 2 * own[every] > own.total() else None
            if usual is not None:
                shape.decimals[column] = usual
        shape.dotted = self.dotted[True] > self.dotted[False]
        shape.right = self.starts[True] > self.starts[False]


def _version(header: str) -> Shape | None:
    version = header[4:20].upper()
    if version.startswith("SDR33"):
        return Shape("SDR33", 16, 16)
    if version.startswith("SDR2"):
        return Shape("SDR20", 4, 10)
    return None


def _usual(counts: Counter[int]) -> int | None:
    """What nearly all have, of enough of them."""
    total = sum(counts.values())
    if total < _LEAST:
        return None
    most, number = counts.most_common(1)[0]
    return most if number >= min(_USUAL * total, total - 1) else None


def _decimals(text: str) -> int:
    return len(text.rpartition(".")[2]) if "." in text else 0


def header_digits(line: str) -> str:
    """The five digits of units and order of a header; empty where they do not stand there."""
    digits = line[40:45]
    tail = line[45:].strip()
    whole = len(digits) == 5 and digits.isdigit() and line[39:40] == " "
    return digits if whole and (not tail or (tail.isdigit() and len(tail) == 1)) else ""


def may_have_been(line: str) -> frozenset[str]:
    """Kinds of records that a torn line may hold: by its first letters, and by what stands inside.

    Empty where nothing is like any kind: it may have been each.
    """
    begin = {signature[:2] for signature in _SIGNATURES if _alike(signature, line)}
    if line[:4] in _SIGNATURES:
        begin = {line[:2]}
    inside = {match[1] for match in _EMBEDDED.finditer(line, 4)}
    return frozenset(begin | inside) if begin else frozenset()


def _alike(signature: str, line: str) -> bool:
    """Whether a line begins so but for one letter that is changed, lost or too many."""
    if sum(a != b for a, b in zip(signature, line[:4].ljust(4), strict=True)) <= 1:
        return True
    shorter = {signature[:i] + signature[i + 1 :] for i in range(4)}
    return line[:3] in shorter or any(
        line[:i] + line[i + 1 : 5] == signature for i in range(min(5, len(line)))
    )
