"""What an index run is made of and what comes out of it: stops, setting, roots.

Values only; how they are solved stands in ``indexing``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.rate.attitude import EULER_LIMIT, azimuth_of, euler_angles


@dataclass(frozen=True, slots=True)
class Stop:
    """Mean outputs at one index angle.

    Parameters
    ----------
    angle : float
        Of the index, clockwise as seen against the axis [rad].
    rate, rate_sigma : ndarray, shape (3,)
        [rad/s]
    force, force_sigma : ndarray, shape (3,)
        [m/s2]
    """

    angle: float
    rate: Floats
    rate_sigma: Floats
    force: Floats
    force_sigma: Floats


@dataclass(frozen=True, slots=True)
class Setting:
    """What is known beside the outputs.

    Parameters
    ----------
    latitude : float
        [rad]
    axis : int
        Index axis, 0, 1, 2 = x, y, z.
    gravity : float or None
        [m/s2]; None = the mean size of the forces.
    bias_prior : ndarray, shape (3,), or None
        [rad/s]
    bias_prior_sigma : ndarray, shape (3,)
        [rad/s]; infinite = no prior of this axis.
    index_sigma : float
        Of every index angle [rad].
    matrix : ndarray, shape (3, 3)
        Output matrix of the gyros, output = matrix rate + bias: axes that are not perpendicular,
        scale factors.
    """

    latitude: float
    axis: int = 2
    gravity: float | None = None
    bias_prior: Floats | None = None
    bias_prior_sigma: Floats = field(default_factory=lambda: np.zeros(3))
    index_sigma: float = 0.0
    matrix: Floats = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True, slots=True)
class Root:
    """One attitude that fits.

    Parameters
    ----------
    attitude : ndarray, shape (3, 3)
        Body at index angle 0 to east, north, up.
    bias : ndarray, shape (3,)
        [rad/s]
    chi_square : float
    covariance : ndarray, shape (6, 6)
        Rotation about east, north, up [rad] and biases [rad/s].
    profile_sigma : float or None
        Standard deviation of the heading from how far it may be turned [rad]; None where the
        covariance serves.
    """

    attitude: Floats
    bias: Floats
    chi_square: float
    covariance: Floats
    profile_sigma: float | None = None

    @property
    def vertical(self) -> bool:
        """Whether the body stands so steeply that its y axis has no azimuth worth the name."""
        return abs(euler_angles(self.attitude).pitch) > EULER_LIMIT

    @property
    def heading(self) -> float:
        """Azimuth of the body's y axis, of its z axis where that stands upright [rad]."""
        return azimuth_of(self.attitude[:, 2 if self.vertical else 1])

    def heading_sigma(self) -> float:
        """Standard deviation of ``heading`` [rad]."""
        if self.profile_sigma is not None:
            return self.profile_sigma
        pointer = self.attitude[:, 2 if self.vertical else 1]
        level = float(pointer[0] ** 2 + pointer[1] ** 2)
        # azimuth of exp([d]) p: d x p, projected on the direction clockwise of p
        clockwise = np.array([pointer[1], -pointer[0], 0.0]) / level
        gradient = np.cross(pointer, clockwise)
        return math.sqrt(max(float(gradient @ self.covariance[:3, :3] @ gradient), 0.0))


@dataclass(frozen=True, slots=True)
class Indexed:
    """All attitudes that fit, the best first.

    Parameters
    ----------
    roots : tuple of Root
        Distinct headings within the odds of the best, and the next one beyond.
    verdict : str
        resolved | ambiguous | undetermined: of the third axis and with it of the heading.
    two_axis_rate, two_axis_sigma : float
        Earth rate across the index axis [rad/s].
    residual_scale : float
        Factor on the sigmas because the stops scatter more than their samples allow; 1 = none.
    dof : int
    misfit : float
        Factor by which everything together fits worse than its sigmas allow; 1 = none. The
        sigmas are widened by it.
    """

    roots: tuple[Root, ...]
    verdict: str
    two_axis_rate: float
    two_axis_sigma: float
    residual_scale: float
    dof: int
    misfit: float = 1.0
