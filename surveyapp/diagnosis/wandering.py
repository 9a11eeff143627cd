"""Noise that wanders against an effect, where channels were observed side by side.

A walk follows a trend nearly as well as the trend itself, and beside few rows BIC can hardly tell
them. What the effect leaves can: about the right effect the channels are white, about a wrong one
the walk still walks. So a rival that is no better than the effect is refuted where the same noise
*beside* the effect is not worth its parameter; and an effect does not stand where it is.
"""

from __future__ import annotations

from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit, with_noise

WHITE = 2.0
"""BIC by which noise beside an effect must be worse for the rest to count as white. By simulation
of ramps and walks of three gyros: with 2, beside a rival no better, .41 of the ramps of .008
deg/s per minute pass at 18 stops and .09 of the walks; with 1, .58 and .18."""


def rest_is_white(problem: Case, fit: Fit, kind: str, *, by: float = WHITE) -> bool:
    """Whether noise of a kind beside the effects of a fit is worse than none, by that much BIC."""
    beside = [
        f.bic for f in with_noise(problem, fit) if f.noise is not None and f.noise.kind == kind
    ]
    return not beside or min(beside) >= fit.bic + by


def refuted(problem: Case, fit: Fit, rival: Fit) -> bool:
    """Whether a rival that replaces effects of a fit by noise is refuted by what the fit leaves."""
    if problem.series is None or rival.noise is None or fit.noise is not None or not fit.members:
        return False
    fewer = {m.candidate.id for m in rival.members} < {m.candidate.id for m in fit.members}
    named = all(m.candidate.kind == "named" for m in fit.members)
    if not (fewer and named) or rival.bic < fit.bic:
        return False
    return rest_is_white(problem, fit, rival.noise.kind)


FAR = 3.0
"""Margins beyond which noise is no rival, whatever is left."""


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
    close = rival.bic < after.bic + margin
    if problem.series is None or rival.noise is None:
        return close
    if close:
        return not refuted(problem, after, rival)
    far = rival.bic >= after.bic + FAR * margin
    return not far and not rest_is_white(problem, after, rival.noise.kind, by=0.0)
