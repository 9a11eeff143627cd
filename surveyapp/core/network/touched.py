"""Which coordinates of which points the observations of a network touch."""

from __future__ import annotations

from collections.abc import Sequence

from surveyapp.domain.observations import Observation, ObservationKind


def touched(observations: Sequence[Observation]) -> dict[str, set[str]]:
    """Components (p = plane, h = height) of each point that any observation touches."""
    height = {
        ObservationKind.HEIGHT_DIFFERENCE,
        ObservationKind.COORDINATE_H,
        ObservationKind.VECTOR_H,
    }
    both = {ObservationKind.SLOPE_DISTANCE, ObservationKind.ZENITH}
    touched: dict[str, set[str]] = {}
    for obs in observations:
        parts = {"h"} if obs.kind in height else {"p", "h"} if obs.kind in both else {"p"}
        for name in (obs.at, obs.back, obs.to):
            if name:
                touched.setdefault(name, set()).update(parts)
    return touched
