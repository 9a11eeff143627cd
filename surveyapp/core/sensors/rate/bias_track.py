"""Following the bias of the third axis from stop to stop, through attitudes that do not tell it.

A filter that takes every estimate is led astray where the attitude is bad; one that leaves those
out and coasts is not. A set is left out where it cannot decide, where it is much less certain than
what is known already, and where it contradicts that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from surveyapp.core.sensors.rate.indexing import solve_indexing
from surveyapp.core.sensors.rate.indexing_values import Indexed, Setting, Stop
from surveyapp.core.sensors.rate.parameters import DEG_H

WALK = 0.05 * DEG_H
"""Random walk of a bias per square root of an hour [rad/s]: the example grade of source 004."""
WEAK = 3.0
"""A set whose own sigma is this many times that of the track tells nothing."""
CONTRADICTS = 4.0
"""Sigmas of the innovation beyond which a set is left out."""


@dataclass(frozen=True, slots=True)
class StopSet:
    """Index positions of one attitude.

    Parameters
    ----------
    number : int
    time_s : float
        Of its beginning.
    stops : list of Stop
    cycle : int
        Power cycle: with each the biases begin anew.
    """

    number: int
    time_s: float
    stops: list[Stop]
    cycle: int = 0


@dataclass(frozen=True, slots=True)
class Tracked:
    """The track at one set.

    Parameters
    ----------
    number : int
    time_s : float
    bias, sigma : float or None
        Of the index axis [rad/s]; None where the track has not begun.
    gated : bool
        Whether the set was left out.
    reason : str
        Why; empty if it was not.
    alone : float or None
        What the set says by itself [rad/s]; None where it is not resolved.
    indexed : Indexed
        Attitude of the set with what the track foretold as prior.
    foretold : float or None
        What the track foretold [rad/s]; None before it begins.
    gate : float or None
        By how much the set may differ from that [rad/s]; None where it says nothing by itself.
    """

    number: int
    time_s: float
    bias: float | None
    sigma: float | None
    gated: bool
    reason: str
    alone: float | None
    indexed: Indexed
    foretold: float | None = None
    gate: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of one entry of ``tracking[]``."""
        root = self.indexed.roots[0]
        resolved = self.indexed.verdict == "resolved"
        return {
            "set": self.number,
            "time_s": self.time_s,
            "bias": _deg_h(self.bias),
            "sigma": _deg_h(self.sigma),
            "gated": self.gated,
            "reason": self.reason or None,
            "alone": _deg_h(self.alone),
            "foretold": _deg_h(self.foretold),
            "gate": _deg_h(self.gate),
            "heading_deg": math.degrees(root.heading) if resolved else None,
            "axis": "z" if root.vertical else "y",
            "heading_sigma_deg": math.degrees(root.heading_sigma()) if resolved else None,
        }


def track_bias(groups: Sequence[StopSet], setting: Setting) -> list[Tracked]:
    """Follow the bias over sets of stops.

    Parameters
    ----------
    groups : sequence of StopSet
        In order of time.
    setting : Setting
        Its prior is where the track begins; after a power cycle nothing is known.
    """
    axis = setting.axis
    bias, variance = 0.0, math.inf
    if setting.bias_prior is not None and setting.bias_prior_sigma[axis] > 0.0:
        bias, variance = float(setting.bias_prior[axis]), float(setting.bias_prior_sigma[axis]) ** 2
    before, cycle = groups[0].time_s, groups[0].cycle
    tracked = []
    free = replace(setting, bias_prior=None)
    for group in groups:
        variance += WALK**2 * max(group.time_s - before, 0.0) / 3600.0
        if group.cycle != cycle:
            bias, variance, setting = 0.0, math.inf, free
        before, cycle = group.time_s, group.cycle
        alone = solve_indexing(group.stops, free)
        own, own_variance, reason = _own(alone, axis)
        resolved = own if alone.verdict == "resolved" else None
        begun = math.isfinite(variance)
        foretold = bias if begun else None
        spread = CONTRADICTS * math.sqrt(own_variance + variance)
        gate = spread if begun and resolved is not None else None
        # what was known before the set: with what it says itself its stops would count twice
        held = _held(setting, axis, bias, variance)
        if not reason and begun:
            if own_variance > WEAK**2 * variance:
                reason = "this attitude hardly tells the bias"
            elif abs(own - bias) > spread:
                reason = "contradicts the track"
        if not reason and not math.isfinite(variance):
            bias, variance = own, own_variance
        elif not reason:
            gain = variance / (variance + own_variance)
            bias, variance = bias + gain * (own - bias), (1.0 - gain) * variance
        indexed = alone if held is None else solve_indexing(group.stops, held)
        known = math.isfinite(variance)
        tracked.append(
            Tracked(
                group.number,
                group.time_s,
                bias if known else None,
                math.sqrt(variance) if known else None,
                bool(reason),
                reason,
                alone=resolved,
                indexed=indexed,
                foretold=foretold,
                gate=gate,
            )
        )
    return tracked


def _deg_h(value: float | None) -> float | None:
    return None if value is None else value / DEG_H


def _own(alone: Indexed, axis: int) -> tuple[float, float, str]:
    """Bias of the index axis from one set, its variance, and why it is of no use."""
    if not alone.roots:
        return 0.0, math.inf, "no attitude fits"
    root = alone.roots[0]
    own, variance = float(root.bias[axis]), float(root.covariance[3 + axis, 3 + axis])
    if alone.verdict != "resolved":
        return own, variance, alone.verdict
    if root.profile_sigma is not None:
        return own, variance, "the heading is good to degrees only"
    return own, variance, ""


def _held(setting: Setting, axis: int, bias: float, variance: float) -> Setting | None:
    """The setting with the track as prior of the index axis; None where there is no track yet."""
    if not math.isfinite(variance):
        return None
    prior, sigma = np.zeros(3), np.full(3, math.inf)
    if setting.bias_prior is not None:
        prior, sigma = setting.bias_prior.copy(), setting.bias_prior_sigma.copy()
    prior[axis], sigma[axis] = bias, math.sqrt(variance)
    return replace(setting, bias_prior=prior, bias_prior_sigma=sigma)
