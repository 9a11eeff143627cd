"""A fibre-optic gyro clamped on the telescope of a total station.

The telescope turns about the horizontal trunnion axis, the alidade about the vertical axis; where
the gyro's axis then points follows from these rotations alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.rate.attitude import attitude_matrix, axis_rotation, earth_rate
from surveyapp_models.rate.turntable import Table


@dataclass(frozen=True, slots=True)
class FogOnTelescope:
    """The gyro on the telescope.

    Parameters
    ----------
    constant : float
        Vertical-circle reading at which the gyro's axis is parallel to the horizontal circle [rad].
    collimation : float
        Angle of its axis to the right of the telescope's vertical plane [rad].
    scale : float
        Scale factor - 1.
    bias, noise : float
        [rad/s]
    reading_increases : bool
        Whether the reading increases as the axis goes from elevation to the horizontal (rule 1).
    """

    constant: float
    collimation: float = 0.0
    scale: float = 0.0
    bias: float = 0.0
    noise: float = 0.0
    reading_increases: bool = True

    def axis(self, reading: float) -> Floats:
        """Direction of the gyro's axis at a circle reading: right, forward, up, shape (3,)."""
        level = np.array([np.sin(self.collimation), np.cos(self.collimation), 0.0])
        lowered = reading - self.constant
        if not self.reading_increases:
            lowered = -lowered
        return np.asarray(axis_rotation(0, -lowered) @ level)

    def output(self, rates: Floats, rng: np.random.Generator | None) -> Floats:
        """What the gyro shows for rates along its axis [rad/s], shape (n,)."""
        out = (1.0 + self.scale) * rates + self.bias
        return out if rng is None else np.asarray(out + rng.normal(0.0, self.noise, rates.shape))

    def at_rest(self, *, reading: float, alidade_azimuth: float, latitude: float) -> float:
        """Rate along the axis with the table and the alidade at rest [rad/s]."""
        pointing = attitude_matrix(heading=alidade_azimuth) @ self.axis(reading)
        return float(pointing @ earth_rate(latitude))

    def on_table(
        self, table: Table, angles: Floats, *, reading: float, interval_s: float
    ) -> Floats:
        """Rates along the axis while the table turns, shape (n,) [rad/s]."""
        rates, _ = table.motion(angles, interval_s=interval_s, mount=np.eye(3))
        return np.asarray(rates @ self.axis(reading))
