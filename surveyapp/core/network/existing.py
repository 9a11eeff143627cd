"""Oriented lines against the azimuths of an existing traverse, with what the covariance says.

Two lines of one instrument share its constant: their difference is free of it. A common offset of
both then speaks against the constant (or the traverse's start), a difference between them does not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.core.network.oriented import oriented_lines
from surveyapp.domain.results import LineResult
from surveyapp_models.angles import RHO_ARCSEC, wrap_pi


@dataclass(frozen=True, slots=True)
class ExistingComparison:
    """Gyro minus existing azimuth of some lines.

    Parameters
    ----------
    sights : tuple of str
    differences : tuple of float
        [rad].
    covariance : tuple of tuple of float
        Of the gyro azimuths, shared constants included; the existing azimuths count as free of
        error [rad^2].
    between : tuple of (str, str, float, float)
        Lines that share a constant: their names, difference of their differences and its sigma
        [rad].
    statistic, probability : float
        d' C^-1 d and the probability of a larger one if only gyro errors were at work.
    """

    sights: tuple[str, ...]
    differences: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    between: tuple[tuple[str, str, float, float], ...]
    statistic: float
    probability: float

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON; arcsec."""
        lines = [
            {
                "line": sight,
                "gyro_minus_existing_arcsec": value * RHO_ARCSEC,
                "sigma_arcsec": math.sqrt(self.covariance[i][i]) * RHO_ARCSEC,
            }
            for i, (sight, value) in enumerate(zip(self.sights, self.differences, strict=True))
        ]
        between = [
            {
                "lines": [a, b],
                "difference_arcsec": value * RHO_ARCSEC,
                "sigma_arcsec": sigma * RHO_ARCSEC,
            }
            for a, b, value, sigma in self.between
        ]
        return {
            "lines": lines,
            "between": between,
            "statistic": self.statistic,
            "probability": self.probability,
        }


def against_existing(lines: Sequence[LineResult]) -> ExistingComparison | None:
    """Compare oriented lines with the grid azimuths that the existing coordinates give.

    Parameters
    ----------
    lines : sequence of LineResult

    Returns
    -------
    ExistingComparison or None
        None where no line has both azimuths.
    """
    usable = [
        line
        for line in lines
        if line.grid_azimuth is not None and line.existing_azimuth is not None
    ]
    sides, constants, _ = oriented_lines(usable)
    if not sides or len(sides) != len(usable):
        return None
    spread = {item.name: item.sigma or 0.0 for item in constants}
    names = [side.constant for side in sides]
    same = np.array([[a == b for b in names] for a in names], dtype=np.float64)
    shared = np.array([spread[name] for name in names])
    covariance = np.diag([side.sigma**2 for side in sides]) + same * np.outer(shared, shared)
    differences = np.array(
        [
            wrap_pi(line.grid_azimuth.value - line.existing_azimuth)
            for line in usable
            if line.grid_azimuth is not None and line.existing_azimuth is not None
        ]
    )
    sights = tuple(f"{side.station}-{side.target}" for side in sides)
    between = tuple(
        (
            sights[i],
            sights[j],
            float(differences[i] - differences[j]),
            math.hypot(sides[i].sigma, sides[j].sigma),
        )
        for i in range(len(sides))
        for j in range(i + 1, len(sides))
        if names[i] == names[j]
    )
    from scipy.special import chdtrc

    statistic = float(differences @ np.linalg.solve(covariance, differences))
    return ExistingComparison(
        sights,
        tuple(float(x) for x in differences),
        tuple(tuple(row) for row in covariance.tolist()),
        between,
        statistic,
        float(chdtrc(len(sides), statistic)),
    )
