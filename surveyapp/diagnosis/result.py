"""What a diagnosis ends with, as values; ``to_dict`` gives the JSON of the command line.

Angles of directions are printed in decimal degrees, everything small in the unit of the subject.
No key is ever missing, nothing is ever NaN: what is not determined is None.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from surveyapp.diagnosis.battery import BatteryTest
from surveyapp.diagnosis.long_records.lines import SpectralLine
from surveyapp.diagnosis.outlook import ActionResult, HeldOut
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said
from surveyapp_models.angles import wrap_two_pi

Verdict = Literal["adequate", "explained", "not_separable", "unattributed"]
CandidateVerdict = Literal[
    "adopted", "candidate", "not_significant", "implausible", "not_separable", "not_applicable"
]
SCHEMA = "surveyapp.diagnose/1"


@dataclass(frozen=True, slots=True)
class Estimate:
    """A result: value [SI], sigma and half-width of the 95 % interval [SI]."""

    value: float
    sigma: float | None
    interval95: float | None


@dataclass(frozen=True, slots=True)
class DatumValue:
    """The result at a physical datum.

    Parameters
    ----------
    effect : str
    states : tuple of (str, Estimate)
        What the state is and the result there; a step has two, the last one counts for later work.
    """

    effect: str
    states: tuple[tuple[str, Estimate], ...]


@dataclass(frozen=True, slots=True)
class ModelResult:
    """One model: what is in it and how well it does.

    Parameters
    ----------
    effects : tuple of str
    parameters : float
        Searched positions counted.
    bic : float
    rms, sigma0 : float
        [SI].
    dof : float
    loo_rms, confirm_rms, forecast_rms : float or None
        Errors [SI] on observations that did not choose: each one left out in turn, a second set,
        the last quarter from the first three.
    value : Estimate
    value_at_datum : DatumValue or None
    """

    effects: tuple[str, ...]
    parameters: float
    bic: float
    rms: float
    sigma0: float | None
    dof: float
    loo_rms: float | None
    confirm_rms: float | None
    forecast_rms: float | None
    value: Estimate
    value_at_datum: DatumValue | None


@dataclass(frozen=True, slots=True)
class NamedCoefficient:
    """A coefficient in its printed unit."""

    name: str
    value: float
    sigma: float | None
    unit: str


@dataclass(frozen=True, slots=True)
class Adoption:
    """An effect that the engine names.

    Parameters
    ----------
    effect : str
    title : str
    coefficients : tuple of NamedCoefficient
    grid : tuple of (str, float, str)
        Name, value, unit.
    p_family : float or None
    margin_bic : float or None
        How much worse the best set without it is, at the depth at which it was named.
    record : AdoptedEffect
        What is written into the project (adopted_at and software are filled in there).
    symptom : str
        What it looks like here; empty where it is as the effect says.
    """

    effect: str
    title: str
    coefficients: tuple[NamedCoefficient, ...]
    grid: tuple[tuple[str, float, str], ...]
    p_family: float | None
    margin_bic: float | None
    record: AdoptedEffect
    symptom: str = ""


@dataclass(frozen=True, slots=True)
class Ambiguity:
    """Sets that explain the record about equally well.

    Parameters
    ----------
    any_of : tuple of str
        Best first; effects of one set joined by `` + ``.
    delta_bic : tuple of float
    collinearity : float or None
        Correlation of what the first two say about the observations.
    separate_by : str
    """

    any_of: tuple[str, ...]
    delta_bic: tuple[float, ...]
    collinearity: float | None
    separate_by: str


@dataclass(frozen=True, slots=True)
class CandidateResult:
    """What became of one candidate."""

    effect: str
    verdict: CandidateVerdict
    p: float | None
    p_family: float | None
    delta_bic: float | None
    kind: str
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Everything that a diagnosis found; the words are made of it by ``diagnosis.words``.

    Parameters
    ----------
    subject, identity, instrument : str
    unit : str
        Printed unit of residuals.
    scale : float
        SI value of one printed unit.
    direction : bool
        Whether the value is a direction.
    verdict : str
    adopted, ambiguous, candidates
    before, after, after_best : ModelResult
    averaged : Estimate
    remedy : tuple of str
    warnings : tuple of ResultWarning
    battery : tuple of BatteryTest
    ledger : mapping
        The entry for the ledger, complete but for time and software.
    residuals_before : tuple of float
        [SI]; of a long record those of its block means.
    lines : tuple of SpectralLine
        Of a long record; they are not in the residuals.
    frequency_unit : str
        Of the lines.
    title, value_name : str
        Of the subject, and of its result.
    prediction : HeldOut or None
        None where too little was observed.
    actions : tuple of ActionResult
        What to observe next, best first.
    advice : tuple of str
        The same in sentences.
    """

    subject: str
    identity: str
    instrument: str
    unit: str
    scale: float
    direction: bool
    verdict: Verdict
    adopted: tuple[Adoption, ...]
    ambiguous: tuple[Ambiguity, ...]
    candidates: tuple[CandidateResult, ...]
    before: ModelResult
    after: ModelResult
    after_best: ModelResult
    averaged: Estimate
    remedy: tuple[str, ...]
    warnings: tuple[ResultWarning, ...]
    battery: tuple[BatteryTest, ...]
    ledger: dict[str, Any]
    residuals_before: tuple[float, ...]
    residuals_best: tuple[float, ...]
    lines: tuple[SpectralLine, ...] = ()
    frequency_unit: str = "Hz"
    title: str = ""
    value_name: str = said("the result")
    prediction: HeldOut | None = None
    actions: tuple[ActionResult, ...] = ()
    advice: tuple[str, ...] = ()

    @property
    def heading(self) -> str:
        """What was diagnosed: the subject, and which one."""
        which = self.identity.removeprefix(f"{self.title} ")
        if which == self.title:
            return self.title
        return joined(" ", (self.title, which))

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON of ``diagnose`` (design.md section 5)."""
        return {
            "schema": SCHEMA,
            "subject": self.subject,
            "unit": self.unit,
            "verdict": self.verdict,
            "adopted": [self._adoption(item) for item in self.adopted],
            "ambiguous": [
                {
                    "any_of": list(item.any_of),
                    "delta_bic": [_rounded(d, 2) for d in item.delta_bic],
                    "collinearity": _rounded(item.collinearity, 4),
                    "separate_by": item.separate_by,
                }
                for item in self.ambiguous
            ],
            "candidates": [
                {
                    "effect": item.effect,
                    "verdict": item.verdict,
                    "p": _rounded(item.p, 6),
                    "p_family": _rounded(item.p_family, 6),
                    "delta_bic": _rounded(item.delta_bic, 2),
                    "kind": item.kind,
                    "reason": item.reason,
                }
                for item in self.candidates
            ],
            "before": self._model(self.before),
            "after": self._model(self.after),
            "after_best": self._model(self.after_best),
            "averaged": self._quantity(self.averaged),
            "lines": [
                {**line.to_dict(self.scale), "frequency_unit": self.frequency_unit}
                for line in self.lines
            ],
            "pooled": None,
            "prediction": None
            if self.prediction is None
            else self.prediction.to_dict(unit=self.unit, scale=self.scale),
            "actions": [item.to_dict(unit=self.unit, scale=self.scale) for item in self.actions],
            "remedy": list(self.remedy),
            "warnings": [warning.to_dict() for warning in self.warnings],
        }

    def _adoption(self, item: Adoption) -> dict[str, Any]:
        return {
            "effect": item.effect,
            "coefficients": [
                {"name": c.name, "value": c.value, "sigma": _finite(c.sigma), "unit": c.unit}
                for c in item.coefficients
            ],
            "grid": [{"name": n, "value": v, "unit": u} for n, v, u in item.grid],
            "p_family": _rounded(item.p_family, 6),
            "margin_bic": _rounded(item.margin_bic, 2),
        }

    def _quantity(self, item: Estimate) -> dict[str, Any]:
        if self.direction:
            value = {"deg": math.degrees(wrap_two_pi(item.value))}
        else:
            value = {self.unit: item.value / self.scale}
        return {
            **value,
            f"sigma_{self.unit}": self._small(item.sigma),
            f"interval95_{self.unit}": self._small(item.interval95),
        }

    def _small(self, value: float | None) -> float | None:
        return None if value is None or not math.isfinite(value) else value / self.scale

    def _model(self, item: ModelResult) -> dict[str, Any]:
        datum = None
        if item.value_at_datum is not None:
            states = item.value_at_datum.states
            datum = {
                "effect": item.value_at_datum.effect,
                "datum": states[-1][0],
                **self._quantity(states[-1][1]),
                "states": [{"datum": text, **self._quantity(q)} for text, q in states],
            }
        return {
            "effects": list(item.effects),
            "parameters": item.parameters,
            "bic": _rounded(item.bic, 2),
            "rms": self._small(item.rms),
            "sigma0": self._small(item.sigma0),
            "dof": item.dof,
            "loo_rms": self._small(item.loo_rms),
            "confirm_rms": self._small(item.confirm_rms),
            "forecast_rms": self._small(item.forecast_rms),
            "value": self._quantity(item.value),
            "value_at_datum": datum,
        }


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else value


def _rounded(value: float | None, digits: int) -> float | None:
    value = _finite(value)
    return None if value is None else round(value, digits)
