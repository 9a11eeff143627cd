"""Output matrices and zeros of a unit from the parameters of its card."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from surveyapp.core.sensors.rate.parameters import AXES, DEG_H, PPM
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

Values = Mapping[str, float | None]


def card_matrix(values: Values) -> tuple[Floats, Floats]:
    """Output matrix of the gyros and bias [rad/s] of a card; what it lacks is nominal.

    Source 002 numbers its matrix K_ij from input i to output j; the card's ``misalignment_xy`` is
    the output x for a rate about y, so that its matrix is the source's transposed.

    Parameters
    ----------
    values : mapping of str to float or None
        ``scale_factor_x`` [ppm], ``misalignment_xy`` [arcsec], ``bias_x`` [deg/h].
    """
    return _matrix(values, ""), np.array([values.get(f"bias_{a}") or 0.0 for a in AXES]) * DEG_H


def card_forces(values: Values) -> tuple[Floats, Floats]:
    """Output matrix of the accelerometers and bias [m/s2]; what the card lacks is nominal.

    Parameters
    ----------
    values : mapping of str to float or None
        ``accelerometer_scale_factor_x`` [ppm], ``accelerometer_misalignment_xy`` [arcsec],
        ``accelerometer_bias_x`` [m/s2].
    """
    bias = np.array([values.get(f"accelerometer_bias_{a}") or 0.0 for a in AXES])
    return _matrix(values, "accelerometer_"), bias


def _matrix(values: Values, kind: str) -> Floats:
    """K (1 + E)."""
    cross = np.eye(3)
    for i, a in enumerate(AXES):
        for j, b in enumerate(AXES):
            if i != j:
                cross[i, j] = (values.get(f"{kind}misalignment_{a}{b}") or 0.0) * ARCSEC
    scale = [1.0 + (values.get(f"{kind}scale_factor_{a}") or 0.0) * PPM for a in AXES]
    return np.asarray(np.array(scale)[:, None] * cross)
