"""Instrument constant of a fibre-optic gyro on a total station, from a table turned both ways.

The gyro on the telescope sees the table's rate times the sine of its elevation. Turning one way
and back, bias and vertical earth rate cancel and the elevation remains (Yu, Wang and Wang 2016,
equations 8 to 11). The elevation leads from the reading of the vertical circle to the reading at
which the gyro's axis is level; by which of the two rules is the instrument's own and is asked for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surveyapp.core.statistics.distributions import chi_square_tail
from surveyapp_models.angles import wrap_two_pi

Rule = Literal["increases", "decreases"]
"""What the vertical-circle reading does as the gyro goes from its elevation to the horizontal."""

SCATTER_LEVEL = 0.05
"""Probability below which the scatter of the repeats exceeds the model."""


@dataclass(frozen=True, slots=True)
class BothWays:
    """One set turned both ways.

    Parameters
    ----------
    set_id, pass_id : int
    clockwise, anticlockwise : float
        Mean outputs [rad/s].
    sigma_clockwise, sigma_anticlockwise : float
        Of these means [rad/s].
    rate_clockwise, rate_anticlockwise : float
        Of the table, magnitudes [rad/s].
    reading : float or None
        Of the vertical circle [rad].
    turns_recorded, turns_used : float
        The smaller of the two ways.
    noise : float
        Of one sample [rad/s].
    samples : int
        Of both ways.
    """

    set_id: int
    pass_id: int
    clockwise: float
    anticlockwise: float
    sigma_clockwise: float
    sigma_anticlockwise: float
    rate_clockwise: float
    rate_anticlockwise: float
    reading: float | None
    turns_recorded: float
    turns_used: float
    noise: float
    samples: int

    @property
    def sine(self) -> float:
        """Sine of the elevation as the gyro's scale has it. Equation 11."""
        total = self.rate_clockwise + self.rate_anticlockwise
        return (self.anticlockwise - self.clockwise) / total

    @property
    def elevation(self) -> float:
        """Of the gyro's axis above the horizontal circle [rad]."""
        return math.asin(min(1.0, max(-1.0, self.sine)))

    def noise_sigma(self) -> float:
        """Standard deviation of the elevation from the gyro's noise [rad]; first term of (15)."""
        total = self.rate_clockwise + self.rate_anticlockwise
        both = math.hypot(self.sigma_clockwise, self.sigma_anticlockwise)
        return both / (total * math.cos(self.elevation))

    def rate_sigma(self, relative: float) -> float:
        """The same from the table's rates; second term of equation 15 [rad]."""
        one, other = self.rate_clockwise, self.rate_anticlockwise
        return abs(math.tan(self.elevation)) * relative * math.hypot(one, other) / (one + other)

    def model_sigma(self, relative: float) -> float:
        """Both together [rad]."""
        return math.hypot(self.noise_sigma(), self.rate_sigma(relative))

    def constant(self, rule: Rule) -> float | None:
        """Reading at which the axis is level [rad]; None without a reading. Equations 1, 2."""
        if self.reading is None:
            return None
        sign = 1.0 if rule == "increases" else -1.0
        return wrap_two_pi(self.reading + sign * self.elevation)


@dataclass(frozen=True, slots=True)
class Scatter:
    """Scatter of repeats against the model.

    Parameters
    ----------
    verdict : str or None
        agrees | exceeds_model; None from fewer than three repeats.
    sd, model_sd : float or None
        [rad]
    p : float or None
        Of a scatter at least as large under the model.
    relative_rate_error_needed : float or None
        Relative error of the table's rate that would explain it; None where it agrees. It says how
        large, not that it is the cause.
    """

    verdict: Literal["agrees", "exceeds_model"] | None
    sd: float | None
    model_sd: float | None
    p: float | None
    relative_rate_error_needed: float | None


def judge_scatter(
    *, sd: float, count: int, model_sd: float, elevation: float, noise_sd: float
) -> Scatter:
    """Judge a standard deviation of repeats.

    Parameters
    ----------
    sd : float
        Of the repeats [rad].
    count : int
    model_sd : float
        Equation 15 with the stated rate error [rad].
    elevation : float
        [rad]
    noise_sd : float
        Its first term alone [rad].
    """
    if count < 3:
        return Scatter(None, None, model_sd, None, None)
    p = chi_square_tail((count - 1) * (sd / model_sd) ** 2, count - 1) if model_sd > 0 else None
    exceeds = p is not None and p <= SCATTER_LEVEL
    needed = None
    if exceeds and sd > noise_sd and abs(math.tan(elevation)) > 0.0:
        needed = math.sqrt(2.0 * (sd**2 - noise_sd**2)) / abs(math.tan(elevation))
    return Scatter("exceeds_model" if exceeds else "agrees", sd, model_sd, p, needed)


@dataclass(frozen=True, slots=True)
class Constant:
    """Result of all sets.

    Parameters
    ----------
    elevation, sigma_elevation : float
        Of the first pass, the gyro's scale error taken out where two passes give it [rad].
    constant, sigma_constant : float or None
        [rad]; None without readings of the vertical circle.
    scale, sigma_scale : float or None
        Relative error of the gyro's scale factor; None from one pass.
    scatter : Scatter
    """

    elevation: float
    sigma_elevation: float
    constant: float | None
    sigma_constant: float | None
    scale: float | None
    sigma_scale: float | None
    scatter: Scatter


def combine(sets: Sequence[BothWays], *, rule: Rule, relative_rate_sigma: float) -> Constant:
    """Elevation, constant and scale factor from every set.

    Parameters
    ----------
    sets : sequence of BothWays
        At least one.
    rule : str
    relative_rate_sigma : float
        Stated relative standard deviation of the table's rate.
    """
    passes = sorted({s.pass_id for s in sets})
    groups = [[s for s in sets if s.pass_id == k] for k in passes]
    judged = [_scatter(group, rule, relative_rate_sigma) for group in groups]
    worst = min(judged, key=lambda s: 1.0 if s.p is None else s.p)
    p = None if worst.p is None else min(1.0, worst.p * len(judged))
    exceeds = p is not None and p <= SCATTER_LEVEL
    scatter = Scatter(
        None if worst.verdict is None else ("exceeds_model" if exceeds else "agrees"),
        worst.sd,
        worst.model_sd,
        p,
        worst.relative_rate_error_needed if exceeds else None,
    )
    sine, sigma_sine = zip(*(_mean_sine(g, rule, relative_rate_sigma) for g in groups), strict=True)
    readings = [_mean_reading(group) for group in groups]
    return _solved(sine, sigma_sine, readings, rule, scatter=scatter)


def _corrected(group: Sequence[BothWays], rule: Rule) -> np.ndarray:
    """Elevations as they would be at the mean reading of the group [rad]."""
    sign = 1.0 if rule == "increases" else -1.0
    middle = _mean_reading(group)
    if middle is None:
        return np.array([s.elevation for s in group])
    shift = [wrap_two_pi((s.reading or 0.0) - middle + math.pi) - math.pi for s in group]
    return np.array([s.elevation + sign * d for s, d in zip(group, shift, strict=True)])


def _mean_reading(group: Sequence[BothWays]) -> float | None:
    readings = [s.reading for s in group if s.reading is not None]
    if len(readings) < len(group):
        return None
    first = readings[0]
    return first + float(np.mean([wrap_two_pi(r - first + math.pi) - math.pi for r in readings]))


def _scatter(group: Sequence[BothWays], rule: Rule, relative: float) -> Scatter:
    values = _corrected(group, rule)
    model = math.sqrt(float(np.mean([s.model_sigma(relative) ** 2 for s in group])))
    noise = math.sqrt(float(np.mean([s.noise_sigma() ** 2 for s in group])))
    sd = float(np.std(values, ddof=1)) if values.size > 1 else 0.0
    return judge_scatter(
        sd=sd, count=values.size, model_sd=model, elevation=float(values.mean()), noise_sd=noise
    )


def _mean_sine(group: Sequence[BothWays], rule: Rule, relative: float) -> tuple[float, float]:
    """Mean sine of a pass and its sigma: the model's, or the scatter's where that exceeds it."""
    values = _corrected(group, rule)
    found = _scatter(group, rule, relative)
    one = math.sqrt(float(np.mean([s.model_sigma(relative) ** 2 for s in group])))
    if found.verdict == "exceeds_model" and found.sd is not None:
        one = found.sd
    mean = float(values.mean())
    return math.sin(mean), math.cos(mean) * one / math.sqrt(values.size)


def _solved(
    sine: Sequence[float],
    sigma: Sequence[float],
    readings: Sequence[float | None],
    rule: Rule,
    *,
    scatter: Scatter,
) -> Constant:
    """From one pass directly; from several the constant and the scale factor together."""
    sign = 1.0 if rule == "increases" else -1.0
    elevation = math.asin(sine[0])
    sigma_elevation = sigma[0] / math.cos(elevation)
    if readings[0] is None or any(r is None for r in readings):
        return Constant(elevation, sigma_elevation, None, None, None, None, scatter)
    first = readings[0]
    if len(sine) == 1:
        constant = wrap_two_pi(first + sign * elevation)
        return Constant(elevation, sigma_elevation, constant, sigma_elevation, None, None, scatter)
    offsets = np.array([wrap_two_pi((r or 0.0) - first + math.pi) - math.pi for r in readings])
    return _two_passes(np.array(sine), np.array(sigma), offsets, first, sign=sign, scatter=scatter)


def _two_passes(
    sine: np.ndarray,
    sigma: np.ndarray,
    offsets: np.ndarray,
    first: float,
    *,
    sign: float,
    scatter: Scatter,
) -> Constant:
    """Gauss-Newton for the elevation v of the first pass and the scale error e.

    sine_i = (1 + e) sin(v - sign (reading_i - reading_1)).
    """
    v, e = math.asin(sine[-1]) + sign * float(offsets[-1]), 0.0
    normal = np.eye(2)
    for _ in range(20):
        at = v - sign * offsets
        design = np.column_stack([(1.0 + e) * np.cos(at), np.sin(at)]) / sigma[:, None]
        rest = (sine - (1.0 + e) * np.sin(at)) / sigma
        step, *_ = np.linalg.lstsq(design, rest, rcond=None)
        v, e = v + float(step[0]), e + float(step[1])
        normal = design
        if float(np.abs(step).max()) < 1e-14:
            break
    _, r = np.linalg.qr(normal)
    diagonal = np.abs(np.diag(r))
    constant = wrap_two_pi(first + sign * v)
    if diagonal.min() < 1e-9 * diagonal.max():  # both passes at one elevation: no scale factor
        sigma_v = float(sigma[0] / math.cos(v))
        return Constant(v, sigma_v, constant, sigma_v, None, None, scatter)
    inverse = np.linalg.solve(r, np.eye(2))
    spread = np.sqrt(np.sum(inverse**2, axis=1))
    return Constant(v, float(spread[0]), constant, float(spread[0]), e, float(spread[1]), scatter)
