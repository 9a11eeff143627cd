"""The model that a run is shown and judged by: the damped swing, or that with adopted effects.

The effects and their fit are known to the diagnosis, which is above; it hands the result in.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from surveyapp.core.swing.gyrofit import DampedFit
from surveyapp.core.swing.sights import TripodTwist
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import OrientationSession
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class ModelledNorth:
    """A run estimated by a model with adopted effects.

    Parameters
    ----------
    value, sigma : float
        North averaged over the run [rad].
    dof : float
    residuals : ndarray, shape (n,)
        Observed minus modelled [rad].
    design : ndarray, shape (n, p)
        Derivatives of the turning points by the parameters of the model.
    amplitude : float
        At the first turning point [rad].
    damping_ratio : float
        Amplitude ratio of one half swing.
    """

    value: float
    sigma: float
    dof: float
    residuals: Floats
    design: Floats
    amplitude: float
    damping_ratio: float


RunModel = Callable[
    [OrientationSession, InstrumentCard, float | None, TripodTwist | None], ModelledNorth
]
"""Estimates a run with its adopted effects; handed in from above, where the effects are known."""


@dataclass(frozen=True, slots=True)
class ShownModel:
    """The model that the session shows and is judged by: the damped swing, or that with effects."""

    residuals: Floats
    design: Floats
    dof: int
    amplitude: float
    damping_ratio: float

    @property
    def variance(self) -> float | None:
        """Variance of one reading, None without redundancy."""
        return float(self.residuals @ self.residuals) / self.dof if self.dof > 0 else None

    @property
    def residual_rms(self) -> float:
        """sqrt(v'v / n)."""
        return math.sqrt(float(self.residuals @ self.residuals) / self.residuals.size)


def shown_model(
    fit: DampedFit, index: Floats, sides: Floats, modelled: ModelledNorth | None
) -> ShownModel:
    """The damped swing, or the model with adopted effects where there are any."""
    if modelled is None:
        jacobian = fit.jacobian(index, sides)
        return ShownModel(fit.residuals, jacobian, fit.dof, fit.amplitude, fit.damping_ratio)
    return ShownModel(
        modelled.residuals,
        modelled.design,
        math.floor(modelled.dof),
        modelled.amplitude,
        modelled.damping_ratio,
    )
