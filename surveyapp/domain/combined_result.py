"""The azimuth of a side from all its lines: several instruments, forward and back, together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from surveyapp.domain.angle_result import AngleResult, finite
from surveyapp.domain.subject import Subject


@dataclass(frozen=True, slots=True)
class CombinedPart:
    """One line of a side and its weight in the mean (None: it has no sigma and is left out)."""

    station: str
    target: str
    instrument: str
    weight: float | None

    @property
    def name(self) -> str:
        """The line and its instrument, for people."""
        return f"{self.station}-{self.target} {self.instrument}"

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "station": self.station,
            "target": self.target,
            "instrument": self.instrument,
            "weight": finite(self.weight),
        }


@dataclass(frozen=True, slots=True)
class CombinedResult:
    """The lines of one side, tested against each other and combined where they agree.

    Parameters
    ----------
    station, target : str
        The way of the first line; lines the other way are turned by half a circle.
    lines : tuple of CombinedPart
    grid_azimuth : AngleResult or None
        None where the lines disagree.
    chi_square, probability : float
    dof : int
        One less than the lines that have a sigma.
    agree : bool
    """

    station: str
    target: str
    lines: tuple[CombinedPart, ...]
    grid_azimuth: AngleResult | None
    chi_square: float
    dof: int
    probability: float
    agree: bool

    @property
    def subject(self) -> Subject:
        """The side as a value."""
        return Subject.side(self.station, self.target)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "station": self.station,
            "target": self.target,
            "lines": [line.to_dict() for line in self.lines],
            "grid_azimuth": None if self.grid_azimuth is None else self.grid_azimuth.to_dict(),
            "chi_square": finite(self.chi_square),
            "dof": self.dof,
            "probability": finite(self.probability),
            "agree": self.agree,
        }
