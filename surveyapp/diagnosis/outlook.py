"""What a diagnosis says of later observations, as values: errors of prediction, and actions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class PredictionErrors:
    """Errors of predicting observations that chose nothing.

    Parameters
    ----------
    rms : float or None
        [SI].
    coverage : float or None
        Share of them inside their 95 % interval.
    interval95 : float or None
        Median half-width of these intervals [SI].
    """

    rms: float | None
    coverage: float | None
    interval95: float | None

    def to_dict(self, *, unit: str, scale: float) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "rms": _small(self.rms, scale),
            "coverage": self.coverage,
            f"interval95_{unit}": _small(self.interval95, scale),
        }


@dataclass(frozen=True, slots=True)
class HeldOut:
    """What was observed last, predicted from what was observed first.

    Parameters
    ----------
    scheme : str
    count : int
        Observations that were predicted; 0 = not counted.
    before, after : PredictionErrors
        By the base model alone, and by the average (a campaign) or the best model.
    """

    scheme: str
    count: int
    before: PredictionErrors
    after: PredictionErrors

    def to_dict(self, *, unit: str, scale: float) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "scheme": self.scheme,
            "n": self.count or None,
            "before": self.before.to_dict(unit=unit, scale=scale),
            "after": self.after.to_dict(unit=unit, scale=scale),
        }


@dataclass(frozen=True, slots=True)
class ActionResult:
    """What an action is expected to tell.

    Parameters
    ----------
    action, text : str
    separation : float
        Expected weight of the likeliest cause after it.
    information : float
        Expected loss of entropy of the causes [nat].
    interval95 : float
        Expected half-width of the final 95 % interval [SI].
    unit : str
        Printed unit of that interval; empty = that of the record.
    own_scale : float
        SI value of that unit; not used where it is empty.
    """

    action: str
    text: str
    separation: float
    information: float
    interval95: float
    unit: str = ""
    own_scale: float = 1.0

    def to_dict(self, *, unit: str, scale: float) -> dict[str, Any]:
        """Keys of the JSON."""
        if self.unit:
            unit, scale = self.unit, self.own_scale
        return {
            "action": self.action,
            "text": self.text,
            "separation": round(self.separation, 4),
            "information": round(self.information, 4),
            f"interval95_{unit}": _small(self.interval95, scale),
        }


@dataclass(frozen=True, slots=True)
class Outlook:
    """What actions are worth beside each other.

    Parameters
    ----------
    now : float
        Weight of the likeliest cause as it stands.
    interval : float
        Half-width of the 95 % interval of what is wanted as it stands [SI].
    actions : tuple of ActionResult
        Best first.
    wanted : str
        Of what the interval is, followed by its width: ``north at``.
    unit : str
        Printed unit of the intervals; empty = that of the record.
    scale : float
        SI value of that unit; not used where it is empty.
    """

    now: float
    interval: float
    actions: tuple[ActionResult, ...]
    wanted: str
    unit: str = ""
    scale: float = 1.0


def _small(value: float | None, scale: float) -> float | None:
    return None if value is None or not math.isfinite(value) else value / scale
