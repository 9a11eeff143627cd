"""What checks look at: values that were read and computed once, before anything is judged."""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.domain.penetration import Penetration
from surveyapp.domain.penetration_result import Prediction
from surveyapp.domain.project import Project
from surveyapp.domain.shaft_result import ShaftOrientation
from surveyapp.domain.traverse import Network
from surveyapp.domain.traverse_book import Traverse


@dataclass(frozen=True, slots=True)
class TraverseEvidence:
    """A traverse with its network, gyro sides included."""

    traverse: Traverse
    network: Network


@dataclass(frozen=True, slots=True)
class BreakthroughEvidence:
    """A breakthrough as planned and predicted.

    Parameters
    ----------
    plan : Penetration
    length_km : float or None
        Of all headings together; None without a prediction.
    prediction : Prediction or None
        None where it was refused.
    refused : str
        Why; empty otherwise.
    """

    plan: Penetration
    length_km: float | None = None
    prediction: Prediction | None = None
    refused: str = ""


@dataclass(frozen=True, slots=True)
class ShaftEvidence:
    """Shafts of a project.

    Parameters
    ----------
    shafts : tuple of ShaftOrientation
    refused : tuple of (id, why)
        Shafts through which nothing could be oriented.
    """

    shafts: tuple[ShaftOrientation, ...]
    refused: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Evidence:
    """Everything that a check may look at.

    Parameters
    ----------
    project : Project
        As read, unfinished sessions included.
    orientation : Orientation
        Of its finished sessions.
    traverses : tuple of TraverseEvidence
        Those with an observation.
    breakthrough : BreakthroughEvidence or None
        None without ``[penetration]``.
    shafts : ShaftEvidence or None
        None without ``[[shaft]]``.
    """

    project: Project
    orientation: Orientation
    traverses: tuple[TraverseEvidence, ...] = ()
    breakthrough: BreakthroughEvidence | None = None
    shafts: ShaftEvidence | None = None
