"""Data snooping: gross errors taken out one after another, and put back where they were innocent.

Detection, identification, adaptation after Baarda and Teunissen, at a level for the whole family.
Nothing is removed from the network itself: the caller gets a list of names and an adjustment.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from surveyapp.core.network.adjustment import FAMILY_LEVEL, adjust
from surveyapp.core.network.gross import without
from surveyapp.domain.adjustment import AdjustmentResult, Suspect
from surveyapp.domain.traverse import Network
from surveyapp.errors import SurveyError

MOST_ROUNDS = 200


@dataclass(frozen=True, slots=True)
class SnoopingResult:
    """Outcome of data snooping.

    Parameters
    ----------
    removed : tuple of Suspect
        Observations taken for gross, in the order in which they were named; ``place`` is the
        place in the network that was given.
    adjustment : AdjustmentResult
        Without them; places in it count in the reduced network.
    """

    removed: tuple[Suspect, ...]
    adjustment: AdjustmentResult

    def to_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {
            "removed": [item.to_dict() for item in self.removed],
            "adjustment": self.adjustment.to_dict(),
        }


def _separate(network: Network, suspects: tuple[Suspect, ...]) -> list[Suspect]:
    """The largest suspect, and further ones that share no point with a larger one."""
    touched: set[str] = set()
    chosen = []
    for item in suspects:
        if item.place < 0:
            continue
        obs = network.observations[item.place]
        names = {name for name in (obs.at, obs.back, obs.to) if name}
        if not names & touched:
            chosen.append(item)
        touched |= names
    return chosen


def data_snooping(
    network: Network, *, family_level: float = FAMILY_LEVEL, apriori: bool = True
) -> SnoopingResult:
    """Find, name and leave out gross errors.

    Parameters
    ----------
    network : Network
    family_level : float
        Probability of removing anything from a sound network in the first round.
    apriori : bool
        Test with the a-priori sigma0: an estimated one is itself inflated by the errors sought.

    Returns
    -------
    SnoopingResult
        An observation whose removal would leave something undetermined is kept.
    """
    base = replace(network, scaled_by_residuals=network.scaled_by_residuals and not apriori)
    places = list(range(len(base.observations)))
    removed: list[Suspect] = []
    current = base
    result = adjust(current, family_level=family_level, relative=False)
    for _ in range(MOST_ROUNDS):
        chosen = _separate(current, result.snooping.suspects)
        if not chosen:
            break
        gone = {item.place for item in chosen}
        reduced = without(current, gone)
        try:
            result = adjust(reduced, family_level=family_level, relative=False)
        except SurveyError:
            if len(chosen) == 1:
                break
            chosen, gone = chosen[:1], {chosen[0].place}
            reduced = without(current, gone)
            try:
                result = adjust(reduced, family_level=family_level, relative=False)
            except SurveyError:
                break
        removed += [replace(item, place=places[item.place]) for item in chosen]
        places = [place for i, place in enumerate(places) if i not in gone]
        current = reduced
    return _restored(base, removed, family_level)


def _restored(base: Network, removed: list[Suspect], family_level: float) -> SnoopingResult:
    """Put back what the cleaned network does not accuse any more."""
    guilty = list(removed)
    for item in reversed(removed):
        trial = [other for other in guilty if other is not item]
        result = adjust(
            without(base, {other.place for other in trial}),
            family_level=family_level,
            relative=False,
        )
        back = item.place - sum(other.place < item.place for other in trial)
        if all(suspect.place != back for suspect in result.snooping.suspects):
            guilty = trial
    final = adjust(without(base, {item.place for item in guilty}), family_level=family_level)
    return SnoopingResult(tuple(guilty), final)
