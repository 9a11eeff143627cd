"""Linearity of a tilt sensor: how far its static test stands off from its own line."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.core.sensors.linear import LinearFit, fit_linear
from surveyapp.domain.calibration import SensorParameter
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Line:
    """E = K0 + K1 sin(angle) of one set, with what it was fitted to."""

    fit: LinearFit
    angle: Floats
    output: Floats

    @property
    def zero(self) -> float:
        """K0 [output]."""
        return float(self.fit.x[0])

    @property
    def slope(self) -> float:
        """K1 [output per g]."""
        return float(self.fit.x[1])


def null(unit: str, *names: str) -> list[SensorParameter]:
    """Parameters that are not determined."""
    return [SensorParameter(name, None, None, unit) for name in names]


def linearity(line: Line | None, span: int) -> list[SensorParameter]:
    """Largest deviation from the line of a range, in %FS and as two angles.

    Its sigma is the noise of one output, found about a smooth curve, as it stands in that residual.

    Parameters
    ----------
    line : Line or None
        Of the range; None where the test is not there.
    span : int
        Of the range [deg], for the names.
    """
    name = f"linearity_{span}"
    if line is None:
        small = null("deg", f"{name}_small_angle", f"{name}_arcsine")
        return [*null("%FS", name), *small]
    sine = np.sin(line.angle)
    largest = float(np.max(np.abs(line.fit.residual)))
    slope = abs(line.slope)
    full_scale = slope * float(np.max(sine) - np.min(sine))
    turned = np.arcsin(np.clip((line.output - line.zero) / line.slope, -1.0, 1.0))
    off = np.abs(turned - line.angle)
    arcsine = math.degrees(float(np.max(off)))
    noise = _noise_of(line)
    sigma = (
        None if noise is None else noise * _free(line, int(np.argmax(np.abs(line.fit.residual))))
    )
    # an error of the output moves the angle by 1 / (K1 cos), at 90 degrees by its square root
    cosine = max(float(np.cos(line.angle[int(np.argmax(off))])), math.sqrt(largest / slope))
    return [
        SensorParameter(name, 100.0 * largest / full_scale, _times(sigma, 100 / full_scale), "%FS"),
        SensorParameter(
            f"{name}_small_angle",
            math.degrees(largest / slope),
            _times(sigma, math.degrees(1.0 / slope)),
            "deg",
        ),
        SensorParameter(
            f"{name}_arcsine", arcsine, _times(sigma, math.degrees(1.0 / (slope * cosine))), "deg"
        ),
    ]


SLOPE_P = 0.01
"""Significance that a slope needs before anything is divided by it."""
OUTLYING_P = 0.001
"""Probability, over all rows of a range, of a sound one that leaves the line so far."""


def sloped(fit: LinearFit) -> bool:
    """Whether the output follows the tilt at all: Student's t of the slope."""
    from scipy.special import stdtrit

    size = float(fit.sigma[1])
    return abs(float(fit.x[1])) > size * float(stdtrit(max(fit.dof, 1), 1.0 - 0.5 * SLOPE_P))


def outlying(line: Line) -> list[tuple[float, float]]:
    """Rows that leave the line of the others: angle [deg], and by how much the output is off.

    Externally studentised residuals at a Bonferroni limit (Cook and Weisberg 1982, 2.2.2); a smooth
    non-linearity, which all rows share, stays far below it.
    """
    from scipy.special import stdtrit

    dof = line.fit.dof
    if dof < LEAST_FREE:
        return []
    q, _ = np.linalg.qr(np.column_stack([np.ones(line.angle.size), np.sin(line.angle)]))
    free = np.maximum(1.0 - np.sum(q**2, axis=1), 1e-12)
    squares = line.fit.residual**2 / free
    rest = np.maximum(dof * line.fit.sigma0**2 - squares, 0.0) / (dof - 1)
    limit = float(stdtrit(dof - 1, 1.0 - 0.5 * OUTLYING_P / line.angle.size))
    rounding = 1e-9 * float(np.ptp(line.output))
    rows = np.flatnonzero(squares > np.maximum(limit**2 * rest, rounding**2))
    off = line.fit.residual / free
    return [(math.degrees(float(line.angle[i])), float(off[i])) for i in rows]


SMOOTH_DEGREE = 5
"""Polynomial of the angle that a real non-linearity follows; what it leaves is noise."""
LEAST_FREE = 3


def _noise_of(line: Line) -> float | None:
    """Standard deviation of one output about a smooth curve; None from too few angles."""
    left = line.angle.size - SMOOTH_DEGREE - 1
    if left < LEAST_FREE:
        return None
    x = line.angle / float(np.max(np.abs(line.angle)) or 1.0)
    design = np.vander(x, SMOOTH_DEGREE + 1)
    fit = fit_linear(design, line.output)
    return None if fit is None else fit.sigma0


def _free(line: Line, row: int) -> float:
    """Share of a row's noise that stands in its residual about the line."""
    q, _ = np.linalg.qr(np.column_stack([np.ones(line.angle.size), np.sin(line.angle)]))
    return math.sqrt(max(1.0 - float(q[row] @ q[row]), 0.0))


def _times(sigma: float | None, factor: float) -> float | None:
    return None if sigma is None else sigma * factor
