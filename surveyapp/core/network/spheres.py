"""Points that only slope distances reach: on spheres around three or more known points.

Three spheres meet in two points, mirror images in the plane of their centres.
"""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np

from surveyapp.core.network.model import Model
from surveyapp.core.network.sketch import Positions
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Network, Status
from surveyapp_models.arrays import Floats

K = ObservationKind
ALIKE = 10.0
"""A place whose distances fit ten times worse may still be right: the adjustment decides."""


def on_spheres(
    network: Network,
    model: Model,
    plane: Positions,
    heights: dict[str, float],
    *,
    lower: bool = False,
) -> tuple[Positions, dict[str, float], bool]:
    """Place points that only slope distances reach, from at least three known points.

    Where the upper and the lower of two serve alike, ``lower`` decides; told by the last value.
    """
    doubtful = False
    reach: dict[str, dict[str, float]] = defaultdict(dict)
    for obs in model.observations:
        if obs.kind is K.SLOPE_DISTANCE:
            reach[obs.at][obs.to] = obs.value
            reach[obs.to][obs.at] = obs.value
    plane, heights = dict(plane), dict(heights)
    for _ in network.points:
        placed = False
        for point in network.points:
            name = point.name
            spatial = point.status_h in (Status.FREE, Status.CONSTRAINED)
            if not spatial or (name in plane and name in heights):
                continue
            near = [o for o in reach.get(name, {}) if o in plane and o in heights]
            fix = three_spheres(
                np.array([[plane[o].real, plane[o].imag, heights[o]] for o in near]),
                np.array([reach[name][o] for o in near]),
            )
            if fix is not None:
                doubtful = doubtful or fix[1] is not None
                at = fix[1] if lower and fix[1] is not None else fix[0]
                plane.setdefault(name, complex(at[0], at[1]))
                heights.setdefault(name, float(at[2]))
                placed = True
        if not placed:
            break
    return plane, heights, doubtful


def three_spheres(centres: Floats, radii: Floats) -> tuple[Floats, Floats | None] | None:
    """Point at the given distances from three or more points, the better or the upper of two.

    The second is the other one, where it serves as well.
    """
    if len(centres) < 3:
        return None
    base = centres[0]
    gaps = centres[1:] - base
    right = 0.5 * (radii[0] ** 2 - radii[1:] ** 2 + np.einsum("ni,ni->n", gaps, gaps))
    _, singular, axes = np.linalg.svd(gaps)
    if len(singular) < 2 or singular[1] < 1e-6 * singular[0]:
        return None
    flat = axes[:2]
    foot = np.linalg.lstsq(gaps @ flat.T, right, rcond=None)[0] @ flat
    up = axes[2] if axes[2][2] >= 0.0 else -axes[2]
    rise = math.sqrt(max(radii[0] ** 2 - float(foot @ foot), 0.0))
    choices = (base + foot + rise * up, base + foot - rise * up)
    misfit = [float(np.abs(np.linalg.norm(c - centres, axis=1) - radii).sum()) for c in choices]
    good, other = (1, 0) if misfit[1] < 0.5 * misfit[0] else (0, 1)
    alike = misfit[other] <= ALIKE * misfit[good] + 1e-6 * float(radii.sum()) and rise > 0.0
    return np.asarray(choices[good]), np.asarray(choices[other]) if alike else None
