"""Position of points below a shaft: what surface, plumbing and the survey below make of it.

Both wires join the frames: the middle of their line carries the place, the line its direction. A
wire that stands off by e in each axis moves the middle of two by e / sqrt2 and turns their line by
sqrt2 e / c, and the two are independent (sum and difference of two equal errors), so a point at
the distance d from the middle has from the plumbing

    sigma_E^2 + sigma_N^2 = e^2 + 2 (e d / c)^2.

Surface and underground add what their rows do to the same function of their places. The surface
points with coordinates count as free of error: the position is relative to them.

Source: derived here from physics.md section 6.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from surveyapp.core.shafts.plane import Place, PlaneSolution, bearing, length
from surveyapp.domain.shaft import Shaft
from surveyapp.domain.shaft_result import PlumbedPoint
from surveyapp.errors import SurveyError
from surveyapp.languages import said

Places = Mapping[str, Place]


def carried_place(surface: Places, underground: Places, wires: Sequence[str], name: str) -> Place:
    """Place of an underground point in the frame of the surface [m]."""
    up, low = _middle(surface, wires), _middle(underground, wires)
    turn = bearing(surface, wires[0], wires[1]) - bearing(underground, wires[0], wires[1])
    e, n = underground[name][0] - low[0], underground[name][1] - low[1]
    cos, sin = math.cos(turn), math.sin(turn)
    return up[0] + e * cos + n * sin, up[1] - e * sin + n * cos


def _middle(places: Places, wires: Sequence[str]) -> Place:
    first, second = places[wires[0]], places[wires[1]]
    return (first[0] + second[0]) / 2.0, (first[1] + second[1]) / 2.0


def plumbed_points(
    shaft: Shaft, surface: PlaneSolution, underground: PlaneSolution
) -> tuple[PlumbedPoint, ...]:
    """Ends of the oriented side whose place the book determines, with their sigma.

    A point that was oriented and not measured to has an azimuth and no place: it is left out.
    """
    found = []
    for name in shaft.orient:
        try:
            variance = _variance(shaft, surface, underground, name)
        except SurveyError:
            continue
        e, n = carried_place(surface.places, underground.places, shaft.wires, name)
        found.append(PlumbedPoint(name, e, n, math.sqrt(variance)))
    return tuple(found)


def _variance(shaft: Shaft, surface: PlaneSolution, underground: PlaneSolution, name: str) -> float:
    """sigma_E^2 + sigma_N^2 of a point [m2].

    Raises
    ------
    SurveyError
        If one of the networks does not determine it.
    """
    up, low, wires = surface.places, underground.places, shaft.wires
    e, n = (low[name][i] - _middle(low, wires)[i] for i in (0, 1))
    apart = math.hypot(e, n) / length(up, *wires)
    variance = shaft.sigma_plumb_m**2 * (1.0 + 2.0 * apart**2)
    for i in (0, 1):
        above = surface.per_row(
            lambda p, i=i: carried_place(p, low, wires, name)[i],  # type: ignore[misc]
            said("the place of {name}", name=name),
        )
        below = underground.per_row(
            lambda p, i=i: carried_place(up, p, wires, name)[i],  # type: ignore[misc]
            said("the place of {name}", name=name),
        )
        variance += float(above @ above) + float(below @ below)
    return variance
