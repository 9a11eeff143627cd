"""How a session chooses its constant: ``constant_choice`` as a value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, get_args

from surveyapp.domain.station_line import StationLine

Word = Literal["predicted", "pooled", "interpolated", "nearest", "known"]
CHOICES: Final[tuple[Word, ...]] = get_args(Word)
RUNNING: Final = "running:"
LINE: Final = "line:"
MOST_RUNNING: Final = 1000
FORMS: Final = " | ".join(CHOICES) + " | running:5 | line:A-B"
"""Everything that ``constant_choice`` may say."""


@dataclass(frozen=True, slots=True)
class ConstantChoice:
    """Which constant a session uses.

    Parameters
    ----------
    kind : str
        A word of ``CHOICES``, ``running`` or ``line``.
    count : int
        Of ``running``: how many determinations on either side.
    line : StationLine or None
        Of ``line``: the calibration line.
    """

    kind: Word | Literal["running", "line"]
    count: int = 0
    line: StationLine | None = None

    def __str__(self) -> str:
        """As project.toml writes it: ``pooled``, ``running:5``, ``line:A-B``."""
        if self.kind == "running":
            return f"{RUNNING}{self.count}"
        return f"{LINE}{self.line}" if self.kind == "line" else self.kind


def word_of(text: str) -> ConstantChoice | None:
    """The choice that a text makes without naming a line; None where it makes none."""
    for word in CHOICES:
        if text == word:
            return ConstantChoice(word)
    count = _running_count(text)
    return None if count is None else ConstantChoice("running", count)


def _running_count(text: str) -> int | None:
    """How many determinations on either side ``running:5`` takes; None for other texts."""
    digits = text.removeprefix(RUNNING)
    if digits == text or not (digits.isascii() and digits.isdecimal()):
        return None
    count = int(digits[:6])
    return count if 1 <= count <= MOST_RUNNING else None
