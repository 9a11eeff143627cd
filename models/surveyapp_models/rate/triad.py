"""Three gyros or three accelerometers: what they put out when they are turned or accelerated.

Input axes that are not quite perpendicular, scale factors that are not quite one, biases, and the
effects of IEEE Std 952 that a simple calibration lacks. Terms follow IEEE Std 952 and 1554.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.rate.attitude import STANDARD_GRAVITY


def _zeros() -> Floats:
    return np.zeros(3)


def _square() -> Floats:
    return np.zeros((3, 3))


@dataclass(frozen=True, slots=True)
class Triad:
    """Errors of a triad, zero = none.

    Output i = K_i (u_i + sum_j E_ij u_j) + D_i + ..., u the true input (sensors.md 2b).

    Parameters
    ----------
    scale : ndarray, shape (3,)
        K - 1.
    misalignment : ndarray, shape (3, 3)
        E_ij [rad]; diagonal zero.
    bias : ndarray, shape (3,)
        [SI]
    g_sensitivity : ndarray, shape (3, 3)
        Of a gyro [rad/s per g]: axis i for specific force along j.
    asymmetry : ndarray, shape (3,)
        Relative excess of the scale factor for a positive against a negative input.
    magnetic_sensitivity : ndarray, shape (3,)
        Output i per field along i [SI per T].
    noise : float
        White noise of a sample, standard deviation [SI].
    """

    scale: Floats = field(default_factory=_zeros)
    misalignment: Floats = field(default_factory=_square)
    bias: Floats = field(default_factory=_zeros)
    g_sensitivity: Floats = field(default_factory=_square)
    asymmetry: Floats = field(default_factory=_zeros)
    magnetic_sensitivity: Floats = field(default_factory=_zeros)
    noise: float = 0.0

    def matrix(self) -> Floats:
        """K (1 + E), shape (3, 3)."""
        return np.asarray((1.0 + self.scale)[:, None] * (np.eye(3) + self.misalignment))

    def output(
        self,
        inputs: Floats,
        *,
        forces: Floats | None = None,
        field_t: Floats | None = None,
        rng: np.random.Generator | None = None,
    ) -> Floats:
        """What the triad shows.

        Parameters
        ----------
        inputs : ndarray, shape (n, 3)
            Rates of the body in inertial space [rad/s], or specific forces [m/s2].
        forces : ndarray, shape (n, 3), optional
            Specific force, for the g-sensitivity.
        field_t : ndarray, shape (n, 3), optional
            Magnetic flux density in the body [T].
        rng : Generator, optional
            Without it no noise.

        Returns
        -------
        ndarray, shape (n, 3)
        """
        along = inputs @ self.matrix().T
        out = along + 0.5 * self.asymmetry * np.abs(along) + self.bias
        if forces is not None:
            out = out + (forces / STANDARD_GRAVITY) @ self.g_sensitivity.T
        if field_t is not None:
            out = out + self.magnetic_sensitivity * field_t
        if rng is not None and self.noise > 0.0:
            out = out + rng.normal(0.0, self.noise, out.shape)
        return np.asarray(out)


def magnetic_bias(field: float, *, sensitivity: float, shielding: float = 1.0) -> float:
    """Bias of a fibre-optic gyro in a magnetic field (Faraday effect), bias = S B / shielding.

    Parameters
    ----------
    field : float
        Flux density along the sensitive direction [T].
    sensitivity : float
        [rad/s per T]
    shielding : float
        Factor by which a mu-metal shield weakens the field, 1 = none.
    """
    return sensitivity * field / shielding
