"""Damaged lines of one field file: each with its problem, and of a flood the numbers alone.

A file of 100 MB that is damaged all over must be answered too: what is kept stays bounded.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

HINT: Final = "`skip_damaged` leaves such lines out and lists them"
MOST_NAMED: Final = 1000
"""So many damaged lines are told with what is wrong; further ones by their numbers."""
FLOOD: Final = 200_000
"""A file with more lines to be left out is none of its format, or beyond use."""


@dataclass(slots=True)
class Damage:
    """Mutable, private to one reading."""

    named: list[Problem] = field(default_factory=list)
    further: array[int] = field(default_factory=lambda: array("Q"))

    def __bool__(self) -> bool:
        return bool(self.named)

    def add(self, line: int, problem: Problem) -> None:
        """Note a damaged line."""
        if len(self.named) < MOST_NAMED:
            self.named.append(problem)
        else:
            self.further.append(line)

    def refuse_flood(self, count: int, name: str) -> None:
        """Give a file up of which more is damage than can be listed.

        Raises
        ------
        SurveyError
            From ``FLOOD`` lines on.
        """
        if count >= FLOOD:
            found, expected = said("{number} lines so far", number=count), "a file of this format"
            what = "more lines would be left out than can be listed"
            hint = "Is it a file of this format?"
            raise SurveyError([*self.named[:10], Problem(what, name, found, expected, hint)])

    def problems(self, name: str) -> list[Problem]:
        """Every damaged line, with what to do about it."""
        told = [Problem(p.what, p.where, p.found, p.expected, HINT) for p in self.named]
        if self.further:
            what = said("{size} further lines are damaged", size=len(self.further))
            told.append(
                Problem(
                    what,
                    said("{name}, lines {lines}", name=name, lines=ranges(self.further)),
                    "",
                    "",
                    HINT,
                )
            )
        return told


def ranges(lines: Iterable[int]) -> str:
    """Numbers of lines as text, runs as ``first-last``."""
    runs: list[list[int]] = []
    for line in sorted(set(lines)):
        if runs and line == runs[-1][1] + 1:
            runs[-1][1] = line
        else:
            runs.append([line, line])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)
