"""What the network is best without, ranked by the adjustment without each observation.

Where no single observation is the fault, those are tried together that one mistake spoils.

The largest standardized residual names the right one only where observations are independent and
the error is small; a large one bends the linearisation and throws its shadow on its neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from typing import Final

from surveyapp.core.network.adjustment import adjust
from surveyapp.core.network.gaussnewton import UnsettledError
from surveyapp.core.network.gross import without
from surveyapp.domain.adjustment import AdjustedObservation, AdjustmentResult, Removal
from surveyapp.domain.network_tests import GlobalTest
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Network
from surveyapp.errors import SurveyError
from surveyapp.languages import joined, said

K = ObservationKind
_SIGHTED: Final = frozenset(
    {K.ANGLE, K.DIRECTION, K.DISTANCE, K.SLOPE_DISTANCE, K.ZENITH, K.AZIMUTH}
)
MOST_SHOWN: Final = 8
MOST_POINTS: Final = 500
"""In larger networks each trial takes as long as the adjustment: there suspects are listed only."""
_EFFORT: Final = 4000
_MOST_TRIALS: Final = 30
"""At most so many, and points times trials within the effort: an error of degrees throws its shadow
far, so that a small network is tried with more than the largest residuals."""
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
    tried = [
        removal
        for item in tested[: _trials(network)]
        if (removal := _removal(network, gone, _Cause.of(network, item))) is not None
    ]
    found = [removal for removal, _ in tried]
    found.sort(key=lambda item: item.sum_of_squares)
    if not _fits(result.global_test) and not any(fits for _, fits in tried):
        found = [*_common_causes(network, gone, tested), *found]
    return replace(result, removals=tuple(found[:MOST_SHOWN]))


def _trials(network: Network) -> int:
    return min(max(MOST_SHOWN, _EFFORT // len(network.points)), _MOST_TRIALS)


def _fits(test: GlobalTest) -> bool:
    """Whether residuals are no larger than the sigmas allow; smaller ones are no gross error."""
    return test.ratio is None or test.upper is None or test.ratio <= test.upper


@dataclass(frozen=True, slots=True)
class _Cause:
    """Observations that one mistake spoils: their places, in words, the largest v/sigma."""

    places: frozenset[int]
    text: str
    standardized: float
    first: int

    @classmethod
    def of(cls, network: Network, item: AdjustedObservation) -> _Cause:
        """One observation alone."""
        where = network.observations[item.place].where
        return cls(frozenset({item.place}), where, item.standardized or 0.0, item.place)


def _removal(network: Network, gone: Set[int], cause: _Cause) -> tuple[Removal, bool] | None:
    """The adjustment without the observations of a cause, and whether it fits."""
    trial = _trial(network, gone | cause.places)
    if trial is None:
        return None
    removal = Removal(
        place=cause.first,
        description=cause.text,
        standardized=cause.standardized,
        sum_of_squares=trial.global_test.sum_of_squares,
        ratio=trial.global_test.ratio,
        passed=trial.global_test.passed,
        suspects=len(trial.snooping.suspects),
        left_out=len(cause.places),
    )
    return removal, _fits(trial.global_test)


def _common_causes(
    network: Network, gone: Set[int], tested: Sequence[AdjustedObservation]
) -> list[Removal]:
    """What the network is sound without, where no single observation is the fault.

    A height that was read wrongly, a target under another's name, distances in another unit spoil
    several observations alike. Only what leaves a test that is met is told, the fewest left out
    and the smallest v'Pv first (Akaike's sum of both).
    """
    groups: dict[str, list[AdjustedObservation]] = {}
    for item in tested:
        for text in _causes(item):
            groups.setdefault(text, []).append(item)
    several = [(text, items) for text, items in groups.items() if len(items) > 1]
    found = []
    for text, items in several[: _trials(network)]:
        places = frozenset(item.place for item in items)
        largest = items[0]
        cause = _Cause(places, text, largest.standardized or 0.0, largest.place)
        tried = _removal(network, gone, cause)
        if tried is not None and tried[1]:
            found.append(tried[0])
    return sorted(found, key=lambda item: item.sum_of_squares + 2.0 * item.left_out)


def _causes(item: AdjustedObservation) -> tuple[str, ...]:
    """Mistakes that would spoil an observation together with others."""
    at, to = item.at, item.to
    if not to or item.kind not in _SIGHTED:
        return ()
    sight = said("everything sighted {at}-{to}: another target?", at=at, to=to)
    if item.kind is K.ZENITH:
        return (
            said("zenith angles at {at}: height of the instrument?", at=at),
            said("zenith angles {at}-{to}: height of the target?", at=at, to=to),
            sight,
        )
    if item.kind in (K.DISTANCE, K.SLOPE_DISTANCE):
        return said("distances at {at}: another unit or constant?", at=at), sight
    return (sight,)


def _trial(network: Network, places: Set[int]) -> AdjustmentResult | None:
    """The adjustment without some observations; None where it cannot be."""
    try:
        return adjust(without(replace(network, tolerance_m=None), set(places)), relative=False)
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
        if trial is not None and _fits(trial.global_test) and trial.dof > 0:
            found.append((trial.global_test.sum_of_squares, obs.where))
    if not found:
        return error
    found.sort()
    names = joined("; ", [where for _, where in found[:_MOST_NAMED]])
    more = (
        said(" and {number} more", number=len(found) - _MOST_NAMED)
        if len(found) > _MOST_NAMED
        else ""
    )
    first = error.problems[0]
    hint = said(
        "It converges, and the global test is met, without one of these, the likeliest first: "
        "{names}{more}.",
        names=names,
        more=more,
    )
    return SurveyError(replace(first, hint=hint))
