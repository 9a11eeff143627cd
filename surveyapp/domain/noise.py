"""Results on the noise of a sensor: Allan deviation, coefficients, and filters side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from surveyapp.domain.warning import ResultWarning

ALLAN_SCHEMA: Final = "surveyapp.allan/1"
FILTER_SCHEMA: Final = "surveyapp.filter/1"


@dataclass(frozen=True, slots=True)
class NoiseCoefficient:
    """One coefficient of IEEE 952 in its unit; a null one carries its reason."""

    name: str
    symbol: str
    value: float | None
    sigma: float | None
    unit: str
    reason: str | None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "symbol": self.symbol,
            "value": self.value,
            "sigma": self.sigma,
            "unit": self.unit,
            "reason": self.reason,
        }


@dataclass(frozen=True, slots=True)
class AllanChannel:
    """Allan deviation of one column.

    Parameters
    ----------
    name, unit : str
    rate_hz : float
    n : int
    taus_s, deviation, low, high : tuple of float
        With the 95 % interval.
    coefficients : tuple of NoiseCoefficient
    """

    name: str
    unit: str
    rate_hz: float
    n: int
    taus_s: tuple[float, ...]
    deviation: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    coefficients: tuple[NoiseCoefficient, ...]

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "unit": self.unit,
            "rate_hz": self.rate_hz,
            "n": self.n,
            "taus_s": list(self.taus_s),
            "deviation": list(self.deviation),
            "low": list(self.low),
            "high": list(self.high),
            "coefficients": [item.to_dict() for item in self.coefficients],
        }


@dataclass(frozen=True, slots=True)
class AllanResult:
    """Allan deviation of the columns of a log, schema ``surveyapp.allan/1``."""

    source: str
    estimator: str
    channels: tuple[AllanChannel, ...]
    sha256: str = ""
    warnings: tuple[ResultWarning, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": ALLAN_SCHEMA,
            "source": self.source,
            "sha256": self.sha256,
            "estimator": self.estimator,
            "channels": [item.to_dict() for item in self.channels],
            "warnings": [item.to_dict() for item in self.warnings],
        }


@dataclass(frozen=True, slots=True)
class FilterResult:
    """A series before and after a filter, schema ``surveyapp.filter/1``.

    Parameters
    ----------
    filter, column, source, unit : str
    q, r : float
        Variances of the state's step and of a reading [unit^2].
    before, after : AllanChannel
        The raw and the filtered series.
    deviation_ratio : tuple of float
        Filtered over raw deviation at each time of ``before``.
    step_lag_90_samples : mapping of str to float or None
        Samples until 90 % of a step of so many sigma; None = not within the test.
    divergence : mapping
        Whether and where the filter lost the series.
    resamplings : int or None
        Of the particle filter.
    """

    filter: str
    column: str
    source: str
    unit: str
    q: float
    r: float
    before: AllanChannel
    after: AllanChannel
    deviation_ratio: tuple[float, ...]
    step_lag_90_samples: Mapping[str, float | None]
    divergence: Mapping[str, Any]
    resamplings: int | None = None
    seed: int | None = None
    warnings: tuple[ResultWarning, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "schema": FILTER_SCHEMA,
            "source": self.source,
            "filter": self.filter,
            "column": self.column,
            "unit": self.unit,
            "q": self.q,
            "r": self.r,
            "seed": self.seed,
            "n": self.before.n,
            "rate_hz": self.before.rate_hz,
            "taus_s": list(self.before.taus_s),
            "before": {
                "deviation": list(self.before.deviation),
                "coefficients": [c.to_dict() for c in self.before.coefficients],
            },
            "after": {
                "deviation": list(self.after.deviation),
                "coefficients": [c.to_dict() for c in self.after.coefficients],
            },
            "deviation_ratio": list(self.deviation_ratio),
            "step_lag_90_samples": dict(self.step_lag_90_samples),
            "divergence": dict(self.divergence),
            "resamplings": self.resamplings,
            "warnings": [item.to_dict() for item in self.warnings],
            **self.extra,
        }
