"""A survey as it is handed to other programs: points, observations and what was left out."""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.domain.adjustment import Ellipse
from surveyapp.domain.observations import Observation
from surveyapp.domain.warning import ResultWarning


@dataclass(frozen=True, slots=True)
class ExportedPoint:
    """A point with its best coordinates.

    Parameters
    ----------
    name : str
    e, n : float
        Adjusted where the point was adjusted, else as given [m].
    h : float or None
        Height [m].
    fixed : bool
    ellipse : Ellipse or None
        Standard ellipse of an adjusted point.
    latitude, longitude : float or None
        In the datum of the project's grid [rad].
    """

    name: str
    e: float
    n: float
    h: float | None
    fixed: bool
    ellipse: Ellipse | None = None
    latitude: float | None = None
    longitude: float | None = None


@dataclass(frozen=True, slots=True)
class ExportedSurvey:
    """Everything that a file for another program can be made of.

    Parameters
    ----------
    name : str
    crs : str
        As written in the project; empty without one.
    points : tuple of ExportedPoint
        Points with plane coordinates.
    observations : tuple of Observation
        As given, with their effective sigma.
    sides : tuple of (str, str)
        Pairs of points that an observation joins, each once.
    gyro : tuple of (str, str)
        Lines oriented by gyro.
    warnings : tuple of ResultWarning
    """

    name: str
    crs: str
    points: tuple[ExportedPoint, ...]
    observations: tuple[Observation, ...] = ()
    sides: tuple[tuple[str, str], ...] = ()
    gyro: tuple[tuple[str, str], ...] = ()
    warnings: tuple[ResultWarning, ...] = ()

    def place(self) -> dict[str, ExportedPoint]:
        """Points by name."""
        return {point.name: point for point in self.points}


@dataclass(frozen=True, slots=True)
class Written:
    """Text of a file, how many items stand in it, and what it could not hold."""

    text: str
    items: int
    warnings: tuple[ResultWarning, ...] = ()
