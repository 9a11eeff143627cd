"""Which coordinates of which points the observations of a network touch."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.core.network.linearise import OFFSETS
from surveyapp.domain.observations import Observation


def touched(observations: Sequence[Observation]) -> dict[str, set[str]]:
    """Components (p = plane, h = height) of each point that any observation touches."""
    touched: dict[str, set[str]] = {}
    for obs in observations:
        parts = {"h" if component == 2 else "p" for _, component in OFFSETS[obs.kind]}
        for name in (obs.at, obs.back, obs.to):
            if name:
                touched.setdefault(name, set()).update(parts)
    return touched
