"""Which single observation the network is best without, ranked by the adjustment without each.

The largest standardized residual names the right one only where observations are independent and
the error is small; a large one bends the linearisation and throws its shadow on its neighbours.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from surveyapp.core.network.adjustment import adjust
from surveyapp.core.network.gaussnewton import UnsettledError
from surveyapp.core.network.gross import without
from surveyapp.domain.adjustment import AdjustmentResult, Removal
from surveyapp.domain.traverse import Network
from surveyapp.errors import SurveyError

MOST_SHOWN: Final = 8
MOST_POINTS: Final = 500
"""In larger networks each trial takes as long as the adjustment: there suspects are listed only."""
_EFFORT: Final = 4000
"""Points times trials: an error of degrees throws its shadow so far that a small network is tried
with every observation."""
_MOST_NAMED: Final = 4
_MOST_UNSETTLED: Final = 80
"""So many trials of a network that does not converge, each of which may not converge either."""


def with_removals(network: Network, result: AdjustmentResult) -> AdjustmentResult:
    """Add the ranked removals to an adjustment that suspects something.

    Parameters
    ----------
    network : Network
        As it was adjusted.
    result : AdjustmentResult

    Returns
    -------
    AdjustmentResult
        ``removals`` by v'Pv without the observation, smallest first; an observation whose removal
        leaves something undetermined is no candidate.
    """
    if not result.snooping.suspects or len(network.points) > MOST_POINTS:
        return result
    tested = [
        item
        for item in result.observations
        if item.place >= 0 and item.standardized is not None and not item.left_out
    ]
    tested.sort(key=lambda item: -abs(item.standardized or 0.0))
    gone = {item.place for item in result.left_out}
    found = []
    for item in tested[: max(MOST_SHOWN, _EFFORT // len(network.points))]:
        trial = _trial(network, gone | {item.place})
        if trial is None:
            continue
        found.append(
            Removal(
                place=item.place,
                description=network.observations[item.place].where,
                standardized=item.standardized or 0.0,
                sum_of_squares=trial.global_test.sum_of_squares,
                ratio=trial.global_test.ratio,
                passed=trial.global_test.passed,
                suspects=len(trial.snooping.suspects),
            )
        )
    found.sort(key=lambda item: item.sum_of_squares)
    return replace(result, removals=tuple(found[:MOST_SHOWN]))


def _trial(network: Network, places: set[int]) -> AdjustmentResult | None:
    """The adjustment without some observations; None where it cannot be."""
    try:
        return adjust(without(replace(network, tolerance_m=None), places), relative=False)
    except SurveyError:
        return None


def unsettled(network: Network, error: UnsettledError) -> SurveyError:
    """Add to an adjustment that does not converge which observation it converges without.

    Parameters
    ----------
    network : Network
    error : UnsettledError
        Returned as it is for a network of more than 80 observations, or where no single one helps.
    """
    count = len(network.observations)
    if count > _MOST_UNSETTLED:
        return error
    found = []
    for place, obs in enumerate(network.observations):
        trial = _trial(network, {place})
        if trial is not None and trial.global_test.passed is not False and trial.dof > 0:
            found.append((trial.global_test.sum_of_squares, obs.where))
    if not found:
        return error
    found.sort()
    names = "; ".join(where for _, where in found[:_MOST_NAMED])
    more = f" and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
    first = error.problems[0]
    hint = (
        "It converges, and the global test is met, without one of these, the likeliest first: "
        f"{names}{more}."
    )
    return SurveyError(replace(first, hint=hint))
