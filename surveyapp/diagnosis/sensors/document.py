"""Words and JSON of a sensor diagnosis: what is named, not told apart, and to be done."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from surveyapp.diagnosis.result import CandidateVerdict
from surveyapp.diagnosis.sensors.loop import Chosen, LoopFit, LoopResult, Trial
from surveyapp.diagnosis.sensors.records import SensorRecord
from surveyapp.languages import joined, said, term
from surveyapp.languages.names import by_id, named
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect

_LEFT: Final = {
    "ar1": said("The residuals that remain resemble their neighbours."),
    "random_walk": said("The residuals that remain wander."),
}


def effect_of(record: SensorRecord, identity: str) -> Effect | None:
    """The effect of a name, of the catalogue or the user's own."""
    every = (*of_subject(record.subject), *record.own)
    return next((effect for effect in every if effect.id == identity), None)


def remedies_of(record: SensorRecord, adopted: list[dict[str, Any]]) -> list[str]:
    """What is to be done about each named effect."""
    found = [effect_of(record, item["effect"]) for item in adopted]
    return [term(effect.remedy) for effect in found if effect is not None]


def _p(trial: Trial, family: int) -> float:
    from scipy.special import chdtrc

    return min(1.0, family * float(chdtrc(trial.extra, max(trial.likelihood_ratio, 0.0))))


def adopted_of(
    record: SensorRecord, found: LoopResult, fit: LoopFit, chosen: Chosen
) -> dict[str, Any]:
    """What is named, with its coefficients."""
    start = record.base.shape[2]
    for item in fit.chosen:
        if item is chosen:
            break
        start += item.design.shape[2]
    candidate = chosen.candidate
    sigma = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    coefficients: list[dict[str, Any]] = []
    for k, name in enumerate(candidate.names):
        coefficients.append(
            {
                "name": name,
                "value": float(fit.x[start + k]) * candidate.scale,
                "sigma": float(sigma[start + k]) * candidate.scale,
                "unit": candidate.unit,
            }
        )
    grid = [
        {
            "name": name,
            "value": value if math.isfinite(value) else None,
            "unit": "C" if name.endswith("_c") else "s",
        }
        for name, value in chosen.grid.items()
        if name not in candidate.names
    ]
    if candidate.id == "interference_step":
        coefficients += [{**g, "sigma": None} for g in grid]
    trial = next((t for t in found.steps if t.id == candidate.id), None)
    family = len(record.candidates) * (400 if candidate.id == "interference_step" else 1)
    effect = effect_of(record, candidate.id)
    return {
        "effect": candidate.id,
        "title": candidate.id if effect is None else effect.title,
        "coefficients": coefficients,
        "grid": grid,
        "p_family": None if trial is None else _p(trial, family),
        "margin_bic": None if trial is None else trial.gain,
    }


def rms_of(record: SensorRecord, residual: Floats, *, gross: bool) -> float:
    """Misfit of the rows of a model, with the gross errors still in it where that is asked.

    Of a compass the length of the vector, of a tilt sensor one axis.
    """
    per_row = 1 if record.subject == "compass" else residual.shape[1]
    out = [size for _, size in record.gross] if gross else []
    squares = float(np.sum(residual**2)) + sum(size**2 for size in out)
    return math.sqrt(squares / (per_row * (residual.shape[0] + len(out))))


def gross_of(record: SensorRecord, n_log: int) -> dict[str, Any]:
    """The gross errors as one effect."""
    effect = effect_of(record, "gross_error")
    return {
        "effect": "gross_error",
        "title": "" if effect is None else effect.title,
        "coefficients": [
            {"name": f"row {row + 1}", "value": size, "sigma": None, "unit": record.unit}
            for row, size in record.gross
        ],
        "grid": [],
        "p_family": min(1.0, n_log * 1e-8),
        "margin_bic": None,
    }


def ambiguous_of(record: SensorRecord, found: LoopResult) -> list[dict[str, Any]]:
    """What could not be told apart."""
    if not found.ambiguous:
        return []
    top = found.ambiguous[0].gain or 0.0
    separate = said(
        "a record with the attitude and the place beside it, or one more at another place"
    )
    if record.subject == "tilt":
        separate = said("a repeated record, its temperatures and tilts in another order")
    return [
        {
            "any_of": [t.id for t in found.ambiguous],
            "delta_bic": [top - (t.gain or 0.0) for t in found.ambiguous],
            "collinearity": None,
            "separate_by": separate,
        }
    ]


def candidates_of(found: LoopResult, record: SensorRecord) -> list[dict[str, Any]]:
    """Every effect and what became of it."""
    last = {t.id: t for trials in found.trials for t in trials}
    ambiguous = {t.id for t in found.ambiguous}
    rows = []
    for candidate in record.candidates:
        trial = last.get(candidate.id)
        verdict: CandidateVerdict = "not_significant"
        if candidate.id in found.after.ids:
            verdict = "adopted"
        elif candidate.id in ambiguous or candidate.id in found.doubted:
            verdict = "candidate"
        elif trial is None or trial.gain is None:
            verdict = "not_applicable"
        p = None if trial is None or trial.gain is None else _p(trial, 1)
        rows.append(
            {
                "effect": candidate.id,
                "verdict": verdict,
                "p": p,
                "p_family": None if p is None else min(1.0, p * len(record.candidates)),
                "delta_bic": None if trial is None else trial.gain,
                "kind": "named",
                "reason": said("may be the field of the room")
                if candidate.id in found.doubted
                else "",
            }
        )
    for identity, reason in record.missing:
        rows.append(
            {
                "effect": identity,
                "verdict": "not_applicable",
                "p": None,
                "p_family": None,
                "delta_bic": None,
                "kind": "named",
                "reason": reason,
            }
        )
    rows.append(
        {
            "effect": "gross_error",
            "verdict": "adopted" if record.gross else "not_significant",
            "p": None,
            "p_family": None,
            "delta_bic": None,
            "kind": "named",
            "reason": "",
        }
    )
    return rows


def words_of(document: dict[str, Any]) -> list[str]:
    """The diagnosis in plain sentences."""
    unit = document["unit"]
    before, after = document["before"]["rms"], document["after"]["rms"]
    told = [
        said(
            "{log}: the residuals of the base model are {before:.3g} {unit} (rms), "
            "{after:.3g} {unit} with what is named; verdict {verdict}.",
            log=document["identity"],
            before=before,
            after=after,
            unit=unit,
            verdict=named(document["verdict"]),
        )
    ]
    for item in document["adopted"]:
        numbers = joined(", ", [_shown(c) for c in item["coefficients"][:6]])
        effect = named(item["effect"])
        told.append(said("Named: {effect} ({numbers}).", effect=effect, numbers=numbers))
    told += [
        said(
            "Not told apart: {names}. It takes {what}.",
            names=_or([named(name) for name in item["any_of"]]),
            what=item["separate_by"],
        )
        for item in document["ambiguous"]
    ]
    held = document["held_out"]
    if held["before"] is not None and held["after"] is not None:
        numbers = f"{held['before']:.3g} -> {held['after']:.3g} {unit}"
        told.append(said("Held out: {numbers}.", numbers=numbers))
    if document["noise"]["after"] != "white":
        told.append(_LEFT[document["noise"]["after"]])
    return told + list(document["remedy"])


def _or(names: list[str]) -> str:
    """Names of which one is meant: ``a or b or c``."""
    whole, *others = names
    for name in others:
        whole = said("{before} or {last}", before=whole, last=name)
    return whole


def _shown(coefficient: dict[str, Any]) -> str:
    value = coefficient["value"]
    number = said("never") if value is None else f"{value:.4g}"
    return joined(" ", (by_id(coefficient["name"]), number, coefficient["unit"]))
