"""Parts of a field file that is larger than one traverse book: by lines, between set-ups.

A project reads its books whole, so that the readings of one import are bounded; a larger file is
taken over in parts, and these are the lines where it can be parted.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said, some

MOST_READINGS: Final = 300_000
"""Readings of one import: what they become stays below the largest book in most files."""
PART: Final = 100_000
"""Readings of a suggested part: also with one face each its book is no larger than one may be."""
_SHOWN: Final = 40


@dataclass(slots=True)
class Parts:
    """Mutable, private to one reading."""

    readings: int = 0
    left_out: int = 0
    ends: list[tuple[int, int]] = field(default_factory=list)
    _setup: str = ""
    _first: int = 1
    _inside: int = 0
    _opened: int = 0
    _before: int = 0
    _last: int = 0

    def takes(self, line: int, setup: str) -> bool:
        """Count a reading; whether it is one of those that are kept."""
        self.readings += 1
        if setup != self._setup:
            self._setup, self._opened, self._before = setup, line, self._inside
        self._inside += 1
        if self._inside > PART:
            self._part(line)
        self._last = line
        if self.readings > MOST_READINGS:
            self.left_out += 1
            return False
        return True

    def _part(self, line: int) -> None:
        """Close a part before the set-up that does not fit; before this line if it never would."""
        whole = self._opened > self._first and self._before > 0
        end = self._opened - 1 if whole else line - 1
        self.ends.append((self._first, end))
        self._first = end + 1
        self._inside = self._inside - self._before if whole else 1
        self._before = 0

    def found(self) -> tuple[tuple[int, int], ...]:
        """First and last line of each part."""
        return (*self.ends, (self._first, max(self._last, self._first)))

    def problem(self, name: str) -> Problem:
        """What is told about a file that is too large for one import."""
        return Problem(
            "the file holds more readings than one traverse",
            name,
            said("{readings} readings", readings=self.readings),
            said("at most {most_readings}", most_readings=MOST_READINGS),
            parts_hint(self.found()),
        )


def parts_hint(parts: tuple[tuple[int, int], ...]) -> str:
    """How to take a large file over in parts."""
    listed = some([f"{first}-{last}" for first, last in parts], _SHOWN)
    return said(
        "`lines` A-B takes a part, each as a `traverse` of its own; parts between set-ups: "
        "{listed}",
        listed=listed,
    )


def line_range(text: str | None, option: str) -> tuple[int, int] | None:
    """Lines as they are told, ``A-B``.

    Parameters
    ----------
    text : str or None
    option : str
        What messages call the option.

    Raises
    ------
    SurveyError
        For what is no pair of lines in order.
    """
    if text is None:
        return None
    first, sign, last = text.partition("-")
    whole = sign and first.isascii() and first.isdigit() and last.isascii() and last.isdigit()
    if not whole or len(text) > 30 or not 1 <= int(first) <= int(last):
        raise SurveyError(
            Problem("these are no lines", option, text[:40], "first-last, like 1-500")
        )
    return int(first), int(last)
