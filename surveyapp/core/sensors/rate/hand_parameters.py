"""Parameters of a hand-held unit under their names, those without a value with the reason why."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from surveyapp.core.sensors.rate.hand_forces import LEVELS, PARAMETERS, ForceModel
from surveyapp.core.sensors.rate.hand_held import RateModel
from surveyapp.core.sensors.rate.needed import tolerance_of
from surveyapp.core.sensors.rate.parameters import DEG_H, PPM
from surveyapp.core.statistics.distributions import NORMAL_95, student_quantile
from surveyapp.domain.calibration import SensorParameter
from surveyapp.languages import counted, said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

FORCE_NAMES = (
    *(f"accelerometer_bias_{a}" for a in "xyz"),
    *(f"accelerometer_scale_factor_{a}" for a in "xyz"),
    *(f"accelerometer_misalignment_{pair}" for pair in ("yx", "zx", "zy")),
)
LEAST_TURNS = 6
"""Turns below which the nine elements of the gyros are not determined."""


def widened(dof: int) -> float:
    """Factor on a sigma of few degrees of freedom that makes 1.96 sigma the 95 % interval."""
    return student_quantile(0.975, max(dof, 1)) / student_quantile(0.975, 1e6)


def needed(
    parameters: Sequence[SensorParameter], count: int, of: Literal["stops", "turns"]
) -> list[SensorParameter]:
    """The parameters, without those whose interval is no narrower than any unit's tolerance."""
    found = []
    for item in parameters:
        limit = tolerance_of(item.name)
        half = None if item.sigma is None else NORMAL_95 * item.sigma
        if item.value is not None and limit is not None and half is not None and half > limit:
            word = counted("{count} stop", "{count} stops", count=count)
            if of == "turns":
                word = counted("{count} turn", "{count} turns", count=count)
            why = said(
                "{word} leave it open by {half:.3g} {unit}, more than the {limit:.3g} {unit} that "
                "is known of any unit",
                word=word,
                half=half,
                limit=limit,
                unit=item.unit,
            )
            found.append(SensorParameter(item.name, None, None, item.unit, why))
        else:
            found.append(item)
    return found


def why_none(name: str, *, model: ForceModel, stops: int, turns: int) -> str:
    """Why a parameter has no value."""
    if not name.startswith("accelerometer"):
        return said(
            "{turns} turns without a gap or a saturated gyro; {needed} and more are needed",
            turns=turns,
            needed=LEAST_TURNS,
        )
    size = "three_scales" if "scale" in name else "misalignment"
    if stops <= PARAMETERS[size] + 1:
        return said(
            "{stops} stops; a model is judged at stops left out, and this one takes {needed}",
            stops=stops,
            needed=PARAMETERS[size] + 2,
        )
    return said(
        "stops that were left out are predicted best by the model {level}, which has it not",
        level=model.level,
    )


def force_parameters(model: ForceModel, covariance: Floats) -> list[SensorParameter]:
    """Bias, scale factor and misalignment of the accelerometers, as far as the model has them.

    Parameters
    ----------
    model : ForceModel
    covariance : ndarray, shape (9, 9)
        Of all nine, what the model omits counted in.
    """
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0)) * widened(model.dof)
    sigma = [float(s) if model.dof > 0 else None for s in spread]
    level = LEVELS.index(model.level)
    found = []
    for k, name in enumerate(FORCE_NAMES):
        unit, scale = ("m/s2", 1.0) if k < 3 else ("ppm", PPM) if k < 6 else ("arcsec", ARCSEC)
        if k >= (3, 6, 9)[level]:
            found.append(SensorParameter(name, None, None, unit))
            continue
        value = float(model.vector[k]) - (1.0 if 3 <= k < 6 else 0.0)
        one = sigma[k]
        found.append(
            SensorParameter(name, value / scale, None if one is None else one / scale, unit)
        )
    return found


def rate_parameters(
    gyro: RateModel | None, bias: Floats, sigma_bias: Floats
) -> list[SensorParameter]:
    """Scale factor, misalignment and bias of the gyros.

    Parameters
    ----------
    gyro : RateModel or None
    bias, sigma_bias : ndarray, shape (3,)
        [rad/s]
    """
    found = []
    for i, a in enumerate("xyz"):
        value = None if gyro is None else (float(gyro.output[i, i]) - 1.0) / PPM
        sigma = None if gyro is None else _spread(gyro, 3 * i + i) / PPM
        found.append(SensorParameter(f"scale_factor_{a}", value, sigma, "ppm"))
    for i, a in enumerate("xyz"):
        for j, b in enumerate("xyz"):
            if i == j:
                continue
            value = None if gyro is None else float(gyro.output[i, j] / gyro.output[i, i]) / ARCSEC
            sigma = None if gyro is None else _spread(gyro, 3 * i + j) / ARCSEC
            found.append(SensorParameter(f"misalignment_{a}{b}", value, sigma, "arcsec"))
    found += [
        SensorParameter(f"bias_{a}", float(bias[i]) / DEG_H, float(sigma_bias[i]) / DEG_H, "deg/h")
        for i, a in enumerate("xyz")
    ]
    return found


def _spread(gyro: RateModel, index: int) -> float:
    return math.sqrt(max(float(gyro.covariance[index, index]), 0.0)) * widened(gyro.dof)
