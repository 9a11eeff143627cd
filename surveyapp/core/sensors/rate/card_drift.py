"""How far a sensor has drifted from one calibration to the next: parameters against older cards."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import date
from typing import Any

from surveyapp.core.statistics.distributions import chi_square_tail
from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.sensor_card import SensorCard
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said

LEVEL = 0.05
"""Of all parameters of a card together: Bonferroni over them."""
MONTH_D = 30.44


def drift_from(
    parameters: Sequence[SensorParameter], card: SensorCard, day: date | None
) -> dict[str, Any]:
    """Change of every parameter that both have, against what both sigmas allow.

    Parameters
    ----------
    parameters : sequence of SensorParameter
        Of the new calibration.
    card : SensorCard
        Older, or newer: the days between have a sign.
    day : datetime.date or None
        Of the new record.

    Returns
    -------
    dict
        Ready for JSON.
    """
    days = None
    if day is not None and card.calibrated_on is not None:
        days = (day - card.calibrated_on).days
    rows: list[dict[str, Any]] = []
    for item in parameters:
        before, sigma = card.get(item.name), card.sigma(item.name)
        if item.value is None or before is None:
            continue
        both = None
        if item.sigma is not None and sigma is not None:
            both = math.hypot(item.sigma, sigma) or None
        change = item.value - before
        rows.append(
            {
                "name": item.name,
                "change": change,
                "sigma": both,
                "p": None if both is None else chi_square_tail((change / both) ** 2, 1),
                "per_month": change / days * MONTH_D if days else None,
                "unit": item.unit,
            }
        )
    known = [float(row["p"]) for row in rows if row["p"] is not None]
    moved = any(p < LEVEL / len(known) for p in known)
    verdict = "not_known" if not known else "drifted" if moved else "within_sigmas"
    return {
        "card": card.id,
        "calibrated_on": None if card.calibrated_on is None else card.calibrated_on.isoformat(),
        "days": days,
        "verdict": verdict,
        "parameters": rows,
    }


def told_drift(found: Sequence[dict[str, Any]]) -> tuple[ResultWarning, ...]:
    """Which parameters moved more than both calibrations allow, card by card."""
    told = []
    for one in found:
        known = [row for row in one["parameters"] if row["p"] is not None]
        names = [row["name"] for row in known if row["p"] < LEVEL / len(known)]
        if names:
            text = said(
                "since the card {card}: {names} changed by more than both sigmas allow",
                card=one["card"],
                names=", ".join(names),
            )
            told.append(ResultWarning("drift", text))
    return tuple(told)
