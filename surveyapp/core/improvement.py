"""What would improve an azimuth most: the largest part of its budget, and the rest without it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from surveyapp.domain.results import BudgetLine


@dataclass(frozen=True, slots=True)
class Improvement:
    """The part of a budget that weighs most.

    Parameters
    ----------
    source : str
        Name of the source in the budget.
    at_calibration : bool
        Whether it came in with the instrument constant.
    sigma, without : float
        Of the azimuth as it is, and if this part were away [rad].
    """

    source: str
    at_calibration: bool
    sigma: float
    without: float


def most_helpful(budget: tuple[BudgetLine, ...]) -> Improvement | None:
    """The part whose removal would help most, None where there is no budget.

    Parameters
    ----------
    budget : tuple of BudgetLine
        Independent parts [rad].
    """
    if not budget:
        return None
    largest = max(budget, key=lambda item: item.sigma)
    total = math.fsum(item.sigma**2 for item in budget)
    rest = math.fsum(item.sigma**2 for item in budget if item is not largest)
    return Improvement(
        source=largest.name,
        at_calibration=largest.at_calibration,
        sigma=math.sqrt(total),
        without=math.sqrt(rest),
    )
