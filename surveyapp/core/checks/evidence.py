"""What checks look at: values that were read and computed once, before anything is judged."""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.core.orientation.whole_project import Orientation
from surveyapp.domain.project import Project
from surveyapp.domain.traverse import Network
from surveyapp.domain.traverse_book import Traverse


@dataclass(frozen=True, slots=True)
class TraverseEvidence:
    """A traverse with its network, gyro sides included."""

    traverse: Traverse
    network: Network


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
    """

    project: Project
    orientation: Orientation
    traverses: tuple[TraverseEvidence, ...] = ()
