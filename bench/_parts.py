"""A campaign in parts: from where, how many, how long; and faults that give the exit status.

``SURVEYAPP_FROM`` and ``SURVEYAPP_COUNT`` take a part of it, ``SURVEYAPP_SECONDS`` ends it after a
time. What was done is told with the number to go on from, so that a campaign of hours is run in
turns.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from dataclasses import dataclass, field


class FaultsFoundError(Exception):
    """A campaign that found a fault; its lines are printed and the exit status is 1."""

    def __init__(self, lines: list[str]) -> None:
        self.lines = lines
        super().__init__("\n".join(lines))


@dataclass(slots=True)
class Part:
    """The numbers of a part, handed out until the time is over.

    Parameters
    ----------
    whole : int
        How many the whole campaign has; those asked for beyond it are not tried.
    """

    whole: int
    first: int = field(init=False)
    end: int = field(init=False)
    deadline: float = field(init=False)
    done: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self.first = int(os.environ.get("SURVEYAPP_FROM", "0"))
        self.end = self.first + int(os.environ.get("SURVEYAPP_COUNT", self.whole - self.first))
        self.deadline = time.monotonic() + float(os.environ.get("SURVEYAPP_SECONDS", "inf"))

    def __iter__(self) -> Iterator[int]:
        for number in range(self.first, self.end):
            if time.monotonic() >= self.deadline:
                return
            yield number
            self.done += 1

    @property
    def told(self) -> str:
        """What was done, and where to go on where something is left."""
        upto = self.first + self.done
        if not self.done:
            return f"none from {self.first}"
        rest = f"; go on with SURVEYAPP_FROM={upto}" if upto < max(self.end, self.whole) else ""
        return f"{self.first} to {upto - 1}{rest}"
