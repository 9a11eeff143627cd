"""A measured sensor log of the samples, before and after, as ``surveyapp demo`` prints it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class BeforeAfter:
    """One quantity without and with what was found; None where there is no such number."""

    quantity: str
    before: float | None
    after: float | None
    unit: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "quantity": self.quantity,
            "before": self.before,
            "after": self.after,
            "unit": self.unit,
        }


@dataclass(frozen=True, slots=True)
class DemonstratedSensor:
    """A measured sensor log.

    Parameters
    ----------
    name, title : str
        Of the sample.
    folder : str
    numbers : tuple of BeforeAfter
    named : str
        What the model lacks, as the diagnosis names it; empty where none was asked.
    words : tuple of str
        What is to be known beside the numbers.
    """

    name: str
    title: str
    folder: str
    numbers: tuple[BeforeAfter, ...]
    named: str = ""
    words: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "title": self.title,
            "folder": self.folder,
            "numbers": [item.to_dict() for item in self.numbers],
            "named": self.named,
            "words": list(self.words),
        }
