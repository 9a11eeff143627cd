"""Noise that wanders against an effect, where channels were observed side by side.

A walk follows a trend nearly as well as the trend itself, and beside few rows BIC can hardly tell
them: it charges the effect for parameters and the noise for next to none. So both are weighed
alike, by their marginal likelihood with their size unknown, and what decides is the odds.
"""

from __future__ import annotations

import math

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.stochastic import best_noises, effect_gain

ODDS = 2.0
"""An effect stands against noise of a kind instead of it where it is so many times likelier: of
walks of the size that is mistaken most .12 to .19 are named a drift then. By simulation of ramps
and walks of three gyros (bench ``rate_walk``, docs/explanation/sensors.md)."""


def stands(problem: Case, fit: Fit, rival: Fit) -> bool:
    """Whether an effect stands against noise of a kind instead of it.

    Parameters
    ----------
    problem : Case
    fit : Fit
        With the effect.
    rival : Fit
        With noise instead.
    """
    return rival.noise is not None and log_odds(problem, fit, rival) >= math.log(ODDS)


def log_odds(problem: Case, fit: Fit, rival: Fit) -> float:
    """Logarithm of the odds of an effect against noise instead, each of unknown size.

    Members that only the rival has stand beside both.
    """
    if rival.noise is None or problem.series is None:
        return 0.0
    channels = np.isfinite(problem.series)
    base, residual, kind = rival.design, rival.residual, rival.noise.kind
    effect = fit.design - base @ np.linalg.lstsq(base, fit.design, rcond=None)[0]
    # what wanders through the channels only is judged there: their white noise is their own
    if not np.any(np.abs(effect[~channels]) > 1e-9 * np.abs(effect).max()):
        rows = np.flatnonzero(channels)
    else:
        rows = np.arange(channels.size)
    each = int(channels.sum()) // max(np.unique(problem.series[channels]).size, 1)
    floor = max(problem.noise_floor, 1e-6 * problem.scale) ** 2
    base, residual, effect = base[rows], residual[rows], effect[rows]
    gain = effect_gain(base, effect, residual, each=each, floor=floor)
    found = best_noises(
        problem, base, residual, scale=problem.scale, floor=problem.noise_floor**2, rows=rows
    )
    return 0.5 * (gain - next(noise.gain for noise in found if noise.kind == kind))


def refuted(problem: Case, fit: Fit, rival: Fit) -> bool:
    """Whether a rival that replaces effects of a fit by noise is refuted by what the fit leaves."""
    if problem.series is None or rival.noise is None or fit.noise is not None or not fit.members:
        return False
    fewer = {m.candidate.id for m in rival.members} < {m.candidate.id for m in fit.members}
    named = all(m.candidate.kind == "named" for m in fit.members)
    return fewer and named and stands(problem, fit, rival)


def imitates(problem: Case, after: Fit, rival: Fit, *, margin: float) -> bool:
    """Whether noise is a rival to an effect; of channels, what the effect leaves decides.

    Parameters
    ----------
    problem : Case
    after : Fit
        With the effect.
    rival : Fit
        With noise instead.
    margin : float
        BIC by which the noise must be worse.
    """
    if problem.series is None or rival.noise is None:
        return rival.bic < after.bic + margin
    return not stands(problem, after, rival)
