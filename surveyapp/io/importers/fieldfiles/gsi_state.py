"""Where the reading of a GSI file stands: the station, the running number, what may be lost.

A station block that cannot be read takes along what follows; of a block beyond reading the running
numbers tell whether it may have been one.
"""

from __future__ import annotations

import re
from array import array
from collections import Counter
from dataclasses import dataclass, field
from typing import Final

from surveyapp.errors import Problem, SurveyError
from surveyapp.io.importers.fieldfiles.gathering import Gathering
from surveyapp.io.importers.fieldfiles.gsi_words import Layout, Word
from surveyapp.languages import said

MOST_LAYOUTS: Final = 1000
"""An instrument writes a handful of kinds of blocks; of garbage no more are kept."""
_MEASURED = re.compile(r"\s(?:21|22|31|32)\.")
_TWO_TENTHS_M: Final = 2e-4


@dataclass(slots=True)
class State:
    """Where the reading stands: the current station and what may have been lost."""

    gathered: Gathering
    station: str | None = None
    hi: float | None = None
    setup: int = 0
    lost: str = ""
    number: int | None = None
    doubtful: int = 0
    was_reading: bool = False
    previous: str = ""
    gaps: list[int] = field(default_factory=list)
    widths: set[int] = field(default_factory=set)
    conventions: set[str] = field(default_factory=set)
    codes: Counter[str] = field(default_factory=Counter)
    homeless: array[int] = field(default_factory=lambda: array("Q"))
    cut: frozenset[Layout] = frozenset()
    layouts: dict[Layout, int] = field(default_factory=dict)
    last: Layout | None = None
    heights: int = 0
    bare: list[tuple[int, str]] = field(default_factory=list)
    occupied: int = 0
    first_of: dict[Layout, int] = field(default_factory=dict)


def doubt(state: State, line: int, block: str) -> None:
    """What may have been lost with a block that cannot be read: the numbers will tell."""
    if block.lstrip("*").startswith("41") or re.search(r"\s8[4568]\.", block):
        lose(state, line)
        return
    state.doubtful, state.was_reading = line, _MEASURED.search(block) is not None
    if state.was_reading and state.number is not None:
        own = block.lstrip("*")[2:6]
        whole = own.isascii() and own.isdigit()
        state.number = int(own) if whole else (state.number + 1) % 10000


def follow_number(state: State, line: int, first: Word) -> None:
    """Follow the running number; behind a block beyond reading it tells whether one is missing."""
    number = int(first.info) if first.info.isdigit() else None
    known = number is not None and state.number is not None
    follows = number is not None and known and number == ((state.number or 0) + 1) % 10000
    if state.doubtful and not follows and (known or not state.was_reading):
        lose(state, state.doubtful)
    elif known and not follows and not (state.number == 9999 and number in (0, 1)):
        state.gaps.append(line)
    state.doubtful = 0
    state.number = number if number is not None else state.number


def lose(state: State, line: int) -> None:
    """A block that named a station, or may have: what follows has none."""
    state.lost = f"line {line} cannot be read and may have named the station"
    state.station = None


def occupy(state: State, line: int, name: str, hi: float | None) -> None:
    """Take a station; the same one with the same height goes on with its set-up."""
    same_height = (hi is None or state.hi is None or abs(hi - state.hi) < _TWO_TENTHS_M) and (
        hi is None
    ) == (state.hi is None)
    if state.lost or name != state.station or not same_height:
        state.setup += 1
    state.station, state.hi, state.lost, state.occupied = name, hi, "", line


def check_stations(state: State) -> None:
    """Refuse a file that names no station; codes that could be the station's are listed."""
    gathered, code = state.gathered, state.gathered.options.station_code
    codes = ", ".join(f"{name} ({count} times)" for name, count in state.codes.most_common())
    if code is not None and f"code {code}" not in state.conventions and not state.lost:
        raise SurveyError(
            Problem(
                "the file has no code block of this code",
                "station_code",
                code,
                said("one of the codes of the file: {codes}", codes=codes or "there is none"),
            )
        )
    if not state.conventions and state.homeless:
        raise SurveyError(
            Problem(
                "no station is named in the file",
                gathered.name,
                said("code blocks: {codes}", codes=codes)
                if codes
                else "neither station nor code blocks",
                "blocks 11 with 84 85 86 or 88, or code blocks 41 with `station_code` N",
                "Which code of your office opens a station?" if codes else "",
            )
        )
    for line in state.homeless:
        gathered.damaged(line, "a reading stands before any station", f"line {line}", "a station")


def check_heights(state: State) -> None:
    """A code block without word 43 was cut, if most of those of its code have one."""
    gathered = state.gathered
    if state.heights <= len(state.bare):
        return
    for line, setup in state.bare:
        gathered.damaged(line, "the station block is cut short before its word 43", f"line {line}")
        lost = [p for p in gathered.pointings if p.setup == setup]
        for pointing in lost:
            gathered.dependent(pointing.line, f"the station block of line {line} is cut short")
        gathered.pointings = [p for p in gathered.pointings if p.setup != setup]
