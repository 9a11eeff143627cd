"""Which single observation the network is best without, ranked by the adjustment without each.

The largest standardized residual names the right one only where observations are independent and
the error is small; a large one bends the linearisation and throws its shadow on its neighbours.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from surveyapp.core.network.adjustment import adjust
from surveyapp.core.network.gross import without
from surveyapp.domain.adjustment import AdjustmentResult, Removal
from surveyapp.domain.traverse import Network
from surveyapp.errors import SurveyError

MOST_TRIALS: Final = 8
MOST_POINTS: Final = 500
"""In larger networks each trial takes as long as the adjustment: there suspects are listed only."""


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
    for item in tested[:MOST_TRIALS]:
        try:
            trial = adjust(
                without(replace(network, tolerance_m=None), gone | {item.place}), relative=False
            )
        except SurveyError:
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
    return replace(result, removals=tuple(found))
