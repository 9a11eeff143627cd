"""Pairs of faces that differ from all others of a file: a slip in one of the two readings.

Collimation and index are quantities of the instrument: all pairs of a file show the same, but for
their scatter. One that lies far outside of the others was misread or mistyped in one face, and the
mean of both hides half of it. The collimation is reduced to the horizon, c sin z.

Source: externally studentized residual of a mean, R. D. Cook, S. Weisberg (1982), Residuals and
influence in regression, 2.2.2, with Bonferroni's bound over all pairs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from surveyapp.core.statistics.distributions import student_quantile

LEVEL: Final = 0.01
"""Probability of accusing any pair of a file of sound readings."""
LEAST_PAIRS: Final = 8
_MOST: Final = 5
_LEAST_RAD: Final = math.radians(5.0 / 3600.0)
"""Below this nobody speaks of a slip, however well the others agree."""


def unlike(values: Sequence[float]) -> list[int]:
    """Places of values that do not belong to the others, the farthest first.

    Parameters
    ----------
    values : sequence of float
        Collimations or indices of all pairs of a file [rad].

    Returns
    -------
    list of int
        At most ``_MOST``; empty with fewer than ``LEAST_PAIRS`` values.
    """
    left = dict(enumerate(values))
    found: list[int] = []
    while len(left) >= LEAST_PAIRS and len(found) < _MOST:
        count = len(left)
        mean = math.fsum(left.values()) / count
        place = max(left, key=lambda i: abs(left[i] - mean))
        others = [value for i, value in left.items() if i != place]
        middle = math.fsum(others) / len(others)
        spread = math.sqrt(math.fsum((x - middle) ** 2 for x in others) / (len(others) - 1))
        gap = abs(left[place] - middle)
        critical = student_quantile(1.0 - LEVEL / (2.0 * count), count - 2)
        if gap < _LEAST_RAD or gap <= critical * spread * math.sqrt(1.0 + 1.0 / len(others)):
            break
        found.append(place)
        del left[place]
    return found
