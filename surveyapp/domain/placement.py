"""Further gyro sides and other measures: what ``predict --plan`` finds. Metres, 1 sigma lateral."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True, slots=True)
class PlannedSide:
    """A gyro side that a plan adds."""

    at: str
    to: str
    instrument: str

    def to_dict(self) -> dict[str, str]:
        """Keys of the JSON."""
        return {"at": self.at, "to": self.to, "instrument": self.instrument}


@dataclass(frozen=True, slots=True)
class Placement:
    """One placement of further gyro sides.

    Parameters
    ----------
    added : tuple of PlannedSide
    lateral_m, gain_m : float
        1 sigma with them, and by how much it falls.
    method : str
        ``exact``: the best of all; ``exchange``: greedy and single exchanges.
    """

    added: tuple[PlannedSide, ...]
    lateral_m: float
    gain_m: float
    method: Literal["exact", "exchange"]

    @property
    def sides_observed(self) -> int:
        """Cost in determinations."""
        return len(self.added)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "added": [side.to_dict() for side in self.added],
            "lateral_m": self.lateral_m,
            "gain_m": self.gain_m,
            "sides_observed": self.sides_observed,
            "method": self.method,
        }


@dataclass(frozen=True, slots=True)
class Measure:
    """Something else than further sides that would help.

    Parameters
    ----------
    kind : str
        angles | gyro | reciprocal | second_instrument | second_survey | calibration_rounds.
    lateral_m, gain_m : float
    sides_observed : int
        Further determinations of gyro sides that it costs.
    text : str
    """

    kind: str
    lateral_m: float
    gain_m: float
    sides_observed: int
    text: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "kind": self.kind,
            "lateral_m": self.lateral_m,
            "gain_m": self.gain_m,
            "sides_observed": self.sides_observed,
            "text": self.text,
        }


@dataclass(frozen=True, slots=True)
class LeastProgramme:
    """Fewest further gyro sides with which the tolerance is met."""

    sides: int
    lateral_m: float
    added: tuple[PlannedSide, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "sides": self.sides,
            "lateral_m": self.lateral_m,
            "added": [side.to_dict() for side in self.added],
        }


@dataclass(frozen=True, slots=True)
class PlacementPlan:
    """What ``--plan K`` finds.

    Parameters
    ----------
    placements : tuple of Placement
        Best first, each of exactly K sides.
    least : LeastProgramme or None
    why : str
        Why there is no least programme; empty where there is one.
    measures : tuple of Measure
        Best first.
    """

    placements: tuple[Placement, ...] = ()
    least: LeastProgramme | None = None
    why: str = ""
    measures: tuple[Measure, ...] = ()
