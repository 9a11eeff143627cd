"""When a parameter of a hand-held unit counts as determined: predicted sigma against a need.

The need is stated: what is known of any unit before it was calibrated at all. A record whose 95 %
interval is no narrower than that tells nothing. The tolerances are those that makers state of
micro-mechanical units: sensitivity 3 %, cross-axis sensitivity 2 %, zero 80 thousandths of gravity
(InvenSense, product specification MPU-6000 and MPU-6050, tables of gyroscope and accelerometer).
``bench rate_rank`` shows what the rule does to simulated records.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from surveyapp.core.sensors.rate.parameters import PPM
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

SCALE_TOLERANCE: Final = 0.03
CROSS_TOLERANCE: Final = 0.02
ZERO_TOLERANCE: Final = 0.08 * STANDARD_GRAVITY_M_S2
"""Of an accelerometer [m/s2]."""
TOLERANCES: Final = {
    "accelerometer_bias": ZERO_TOLERANCE,
    "accelerometer_scale_factor": SCALE_TOLERANCE / PPM,
    "accelerometer_misalignment": CROSS_TOLERANCE / ARCSEC,
    "scale_factor": SCALE_TOLERANCE / PPM,
    "misalignment": CROSS_TOLERANCE / ARCSEC,
}
"""Half the interval that makers leave open, by the beginning of the name [unit of the value]."""
_FLOOR: Final = 1e-9


def tolerance_of(name: str) -> float | None:
    """Need of a parameter in its own unit; None where none is stated."""
    return TOLERANCES.get(name.rsplit("_", 1)[0])


def covariance_of(jacobian: Floats) -> Floats:
    """Covariance of a fit with noise of one, shape (p, p); what nothing tells has a huge variance.

    A pseudo-inverse would call certain what the rows do not see.

    Parameters
    ----------
    jacobian : ndarray, shape (n, p)
    """
    count = jacobian.shape[1]
    size = np.linalg.norm(jacobian, axis=0)
    size = np.maximum(size, _FLOOR * max(float(size.max(initial=0.0)), 1e-300))
    _, s, right = np.linalg.svd(jacobian / size, full_matrices=True)
    s = np.append(s, np.zeros(max(count - s.size, 0)))[:count]
    s = np.maximum(s, _FLOOR * max(float(s.max(initial=0.0)), 1e-300))
    return np.asarray((right.T / s**2) @ right / np.outer(size, size))
