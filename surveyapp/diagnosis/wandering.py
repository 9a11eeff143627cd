"""Noise that wanders against an effect, where channels were observed side by side.

A walk follows a trend nearly as well as the trend itself, and beside few rows BIC can hardly tell
them. What the effect leaves can: about the right effect the channels are white, about a wrong one
the walk still walks. So two numbers decide: by how much BIC the noise instead of the effect is
worse, and how often white noise about the effect looks no whiter than the rest. The worse the noise
instead, the less white the rest need be.
"""

from __future__ import annotations

import numpy as np

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit, with_noise
from surveyapp.diagnosis.stochastic import white_gains

DRAWS = 1000
"""Records of white noise."""
STANDS = ((0.0, 0.45), (12.0, 0.15), (20.0, 0.02), (40.0, 0.0))
"""An effect stands where the noise instead is worse by that much BIC and its rest is at least as
white as this share of white records: what the share keeps of the right names. By simulation of
ramps and walks of three gyros at 12, 18 and 30 stops (docs/explanation/sensors.md): the most right
names of slow ramps with at most .10 of the walks named at 18 and 30 stops and .15 at 12."""
MANY = ((18.0, 1.0), (30.0, 0.33))
"""Stops, and the part of these shares that is asked for: the longer a walk walks, the less white is
what a wrong effect leaves, and the less need the right one lose."""
STATIONARY = ((0.0, 0.05), (20.0, 0.02), (40.0, 0.0))
"""The same of noise that comes back (AR(1)): it follows a drift badly, and where it does it is a
walk; a level of its own costs right names and keeps off no wrong ones."""


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
    if rival.noise is None:
        return False
    table = STANDS if rival.noise.kind == "random_walk" else STATIONARY
    needed = [share for least, share in table if rival.bic >= fit.bic + least]
    if not needed:
        return False
    share = needed[-1] * asked_of(problem)
    return share == 0.0 or whiteness(problem, fit, rival.noise.kind) >= share


def asked_of(problem: Case) -> float:
    """Part of the shares that is asked for with the stops of a record."""
    if problem.series is None:
        return 1.0
    stops = np.unique(problem.position[np.isfinite(problem.series)]).size
    sizes, parts = np.log(np.array(MANY)).T
    return float(np.exp(np.interp(np.log(max(stops, 1)), sizes, parts)))


def whiteness(problem: Case, fit: Fit, kind: str) -> float:
    """Share of white records about a fit in which noise of a kind gains as much as in this one."""
    gained = [
        fit.bic - f.bic
        for f in with_noise(problem, fit)
        if f.noise is not None and f.noise.kind == kind
    ]
    if not gained:
        return 1.0
    null = next(v for k, v in white_gains(problem, fit.design, draws=DRAWS).items() if k == kind)
    return float((1.0 + (null >= max(gained)).sum()) / (DRAWS + 1.0))


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
