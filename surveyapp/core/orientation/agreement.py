"""Do the constants of several lines, or of several epochs, agree: the comparison and its words."""

from __future__ import annotations

from dataclasses import dataclass

from surveyapp.languages import listed, said, term
from surveyapp_models.angles import RHO_ARCSEC


@dataclass(frozen=True, slots=True)
class Agreement:
    """Comparison of group means.

    Parameters
    ----------
    difference : float
        Largest difference between two groups [rad].
    limit : float
        What chance makes at the 5 % level [rad] (two groups), else NaN-free 0.
    agree : bool
    scatter : float
        Standard deviation to be added to the pooled mean where they do not agree [rad].
    dof : int
    probability : float
    names : tuple of str
    """

    difference: float
    limit: float
    agree: bool
    scatter: float
    dof: int
    probability: float
    names: tuple[str, ...]


def agreement_text(test: Agreement, what: str) -> str:
    """Tell an agreement or disagreement in one sentence; ``what``: lines or epochs."""
    names = listed([term(name) if name in ("before", "after") else name for name in test.names])
    if len(test.names) > 3:
        count = len(test.names)
        names = said("{count} epochs", count=count)
        if what == "lines":
            names = said("{count} lines", count=count)
    values = {
        "names": names,
        "difference": test.difference * RHO_ARCSEC,
        "limit": test.limit * RHO_ARCSEC,
        "probability": test.probability,
    }
    if test.agree:
        return said(
            'constants of {names} agree: {difference:.2f}" apart, chance makes {limit:.2f}" '
            "(p = {probability:.3g})",
            **values,
        )
    return said(
        'constants of {names} disagree: {difference:.2f}" apart, chance makes {limit:.2f}" '
        "(p = {probability:.3g})",
        **values,
    )
