"""The result of calibrating a sensor: parameters, how well they fit, and what is not determined.

One form for every kind of sensor, schema ``surveyapp.calibrate/1``. A parameter that the record
does not determine has no value, and its name stands in the geometry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final, Literal

from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said

CALIBRATE_SCHEMA: Final = "surveyapp.calibrate/1"

REASONS: Final[dict[str, str]] = {
    "refused": said("the record does not determine the result"),
    "not_determined": said("the record does not determine it"),
    "sigma_above_2_uT": said("its sigma is more than 2 uT"),
    "test_absent": said("its test is not in the log"),
    "no_scale": said("no static test over +-90 degrees gives the scale"),
    "no_slope": said("the output does not follow the tilt"),
    "too_few_rows": said("its test has too few rows"),
    "no_temperature": said("the temperature is not recorded or does not vary"),
    "attitude": said("the attitudes do not determine it"),
}
"""Why a parameter has no value."""

GeometryVerdict = Literal["good", "restricted", "refused"]


@dataclass(frozen=True, slots=True)
class SensorParameter:
    """One parameter of a sensor.

    Parameters
    ----------
    name : str
    value : float or None
        None = not determined.
    sigma : float or None
        Standard deviation; None where it is not determined or nothing was estimated.
    unit : str
    reason : str or None
        Why there is no value: a key of ``REASONS``, or words that hold numbers of the record.
    """

    name: str
    value: float | None
    sigma: float | None
    unit: str
    reason: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "name": self.name,
            "value": self.value,
            "sigma": self.sigma,
            "unit": self.unit,
            "reason": self.reason,
        }


def in_words(reason: str) -> str:
    """A reason as it is shown."""
    return REASONS.get(reason, reason)


def with_reasons(
    parameters: Iterable[SensorParameter], why: Callable[[str], str]
) -> tuple[SensorParameter, ...]:
    """The parameters; one without a value and without a reason gets the one of its name."""
    return tuple(
        p if p.value is not None or p.reason else replace(p, reason=why(p.name)) for p in parameters
    )


def names_by_reason(parameters: Iterable[SensorParameter]) -> dict[str, tuple[str, ...]]:
    """Reason in words to the names of the parameters that have no value for it."""
    found: dict[str, tuple[str, ...]] = {}
    for item in parameters:
        if item.value is None and item.reason:
            why = in_words(item.reason)
            found[why] = (*found.get(why, ()), item.name)
    return found


@dataclass(frozen=True, slots=True)
class Misfit:
    """Root mean square of residuals; ``of`` says of what, where the unit does not."""

    rms: float | None
    unit: str
    of: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {"rms": self.rms, "unit": self.unit, "of": self.of}


@dataclass(frozen=True, slots=True)
class HeldOut:
    """Residuals of rows that had no part in the fit.

    Parameters
    ----------
    scheme : str
        How the rows were left out.
    before, after : float or None
        Root mean square without and with the chosen model.
    unit : str
    """

    scheme: str
    before: float | None
    after: float | None
    unit: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "scheme": self.scheme,
            "before": self.before,
            "after": self.after,
            "unit": self.unit,
        }


@dataclass(frozen=True, slots=True)
class Geometry:
    """What the record can determine at all.

    Parameters
    ----------
    verdict : str
        good | restricted | refused.
    condition : float or None
        Of the scaled normal equations; shown, never a gate.
    undetermined : tuple of str
        Names of parameters without a value.
    heading_sigma_deg : float or None
        Of a compass.
    coverage : float or None
        Share of the directions that the record holds, 0 to 1.
    """

    verdict: GeometryVerdict
    condition: float | None = None
    undetermined: tuple[str, ...] = ()
    heading_sigma_deg: float | None = None
    coverage: float | None = None

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "verdict": self.verdict,
            "condition": self.condition,
            "heading_sigma_deg": self.heading_sigma_deg,
            "coverage": self.coverage,
            "undetermined": list(self.undetermined),
        }


@dataclass(frozen=True, slots=True)
class CalibrationModel:
    """One of the models that were compared.

    Parameters
    ----------
    id : str
    rms, held_out_rms : float or None
        Root mean square of the residuals, and of those of rows that had no part in the fit.
    chosen : bool
    unit, of : str
        Of both, and of what they are: not the same for all models of a compass.
    """

    id: str
    rms: float | None
    held_out_rms: float | None
    chosen: bool
    unit: str
    of: str

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            "id": self.id,
            "rms": self.rms,
            "held_out_rms": self.held_out_rms,
            "chosen": self.chosen,
            "unit": self.unit,
            "of": self.of,
        }


@dataclass(frozen=True, slots=True)
class Calibration:
    """A calibrated sensor.

    Parameters
    ----------
    kind : str
        compass | swing | tilt | dividing-head | six-position ...
    source : str
        Log or file.
    parameters : tuple of SensorParameter
    before, after : Misfit
        Without and with what was estimated.
    geometry : Geometry
    held_out : HeldOut or None
    models : tuple of CalibrationModel
    warnings : tuple of ResultWarning
    met : bool
        False ends with exit 1: refused, undetermined or inconsistent, as the subject says.
    n : int
        Rows used.
    sha256 : str
        Of the log.
    extra : mapping
        Further keys of the JSON that only this subject has; ready for JSON.
    covariance : tuple of tuple of float, or None
        Of the parameters that have a sigma, in their order.
    temperature_c : tuple of float, or None
        Lowest and highest temperature of the record.
    constants : mapping of str to float
        Further numbers that a card needs beside the parameters.
    notes : mapping of str to str
        What a reader of the card must know.
    tables : mapping of str to mapping
        Tables of the card that only this subject has.
    """

    kind: str
    source: str
    parameters: tuple[SensorParameter, ...]
    before: Misfit
    after: Misfit
    geometry: Geometry
    held_out: HeldOut | None = None
    models: tuple[CalibrationModel, ...] = ()
    warnings: tuple[ResultWarning, ...] = ()
    met: bool = True
    n: int = 0
    sha256: str = ""
    extra: Mapping[str, Any] = field(default_factory=dict)
    covariance: tuple[tuple[float, ...], ...] | None = None
    temperature_c: tuple[float, float] | None = None
    constants: Mapping[str, float] = field(default_factory=dict)
    notes: Mapping[str, str] = field(default_factory=dict)
    tables: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """No parameter without a value is without a reason."""
        usual = "refused" if self.geometry.verdict == "refused" else "not_determined"
        told = tuple(
            replace(item, reason=usual) if item.value is None and item.reason is None else item
            for item in self.parameters
        )
        object.__setattr__(self, "parameters", told)

    @property
    def empty(self) -> dict[str, tuple[str, ...]]:
        """Parameters without a value, by the reason in words."""
        return names_by_reason(self.parameters)

    def value(self, name: str) -> float | None:
        """Value of a parameter, None if it is not determined.

        Raises
        ------
        KeyError
            If there is no parameter of this name.
        """
        return self.parameter(name).value

    def parameter(self, name: str) -> SensorParameter:
        """One parameter by its name.

        Raises
        ------
        KeyError
            If there is no parameter of this name.
        """
        for item in self.parameters:
            if item.name == name:
                return item
        raise KeyError(name)

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON, schema ``surveyapp.calibrate/1``."""
        return {
            "schema": CALIBRATE_SCHEMA,
            "kind": self.kind,
            "source": self.source,
            "sha256": self.sha256,
            "n": self.n,
            "parameters": [item.to_dict() for item in self.parameters],
            "before": self.before.to_dict(),
            "after": self.after.to_dict(),
            "held_out": None if self.held_out is None else self.held_out.to_dict(),
            "geometry": self.geometry.to_dict(),
            "models": [item.to_dict() for item in self.models],
            "warnings": [item.to_dict() for item in self.warnings],
            **self.extra,
        }
