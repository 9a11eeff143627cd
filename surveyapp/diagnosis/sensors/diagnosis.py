"""The diagnosis of a sensor log: the loop, its proof on held-out blocks, and what to do.

The JSON is that of every diagnosis, ``surveyapp.diagnose/1``, with ``held_out`` beside it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numpy as np

from surveyapp.core.sensors.linear import alternate_blocks
from surveyapp.diagnosis.result import Verdict
from surveyapp.diagnosis.sensors.confirming import confirmed
from surveyapp.diagnosis.sensors.document import (
    adopted_of,
    ambiguous_of,
    candidates_of,
    gross_of,
    remedies_of,
    rms_of,
    words_of,
)
from surveyapp.diagnosis.sensors.doubts import doubted
from surveyapp.diagnosis.sensors.edges import refined, row_residual
from surveyapp.diagnosis.sensors.loop import LoopFit, LoopResult, fit_model, run_loop
from surveyapp.diagnosis.sensors.records import SensorRecord
from surveyapp.diagnosis.sensors.windows import block_means
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said
from surveyapp.languages.names import named

HELD_OUT_S: Final = 2.0
TILT_ROWS: Final = 7


@dataclass(frozen=True, slots=True)
class SensorDiagnosis:
    """What was found; ``to_dict`` is the JSON.

    Parameters
    ----------
    document : dict
        Ready for JSON.
    words : tuple of str
    records : tuple of AdoptedEffect
        What is written of the named effects where they are adopted.
    written : tuple of str
        Where.
    not_written : tuple of dict
        Named effects that were not, and why.
    """

    document: dict[str, Any]
    words: tuple[str, ...]
    records: tuple[AdoptedEffect, ...] = ()
    written: tuple[str, ...] = ()
    not_written: tuple[dict[str, str], ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Keys of the JSON."""
        return {
            **self.document,
            "written": list(self.written),
            "not_written": list(self.not_written),
            "words": list(self.words),
        }

    @property
    def ledger(self) -> dict[str, Any]:
        """What the ledger of a project keeps of it."""
        keys = ("subject", "identity", "verdict", "adopted", "ambiguous", "candidates")
        return {
            "schema": "surveyapp.ledger.diagnosis/1",
            **{key: self.document[key] for key in keys},
        }


def diagnose_sensor(
    record: SensorRecord,
    *,
    identity: str,
    n_log: int,
    warnings: Sequence[ResultWarning] = (),
    second: SensorRecord | None = None,
    data_sha256: str = "",
) -> SensorDiagnosis:
    """Run the loop on a record and tell what it found.

    Parameters
    ----------
    record : SensorRecord
    identity : str
        Of the sensor log.
    n_log : int
        Rows of the log.
    warnings : sequence of ResultWarning
    second : SensorRecord, optional
        Of another log of the same sensor, which chose nothing.
    data_sha256 : str
        Of the log.
    """
    found = run_loop(record.data, record.candidates, refine=partial(refined, record))
    found = doubted(record, found)
    after = refined(record, found.after)
    proof = None if second is None else confirmed(record, after, second)
    notes = list(warnings)
    if proof is not None:
        after = proof.fit
        notes += [ResultWarning("not_adopted", joined(": ", (n, why))) for n, why in proof.refused]
    notes += [_of_the_room(name) for name in found.doubted]
    best = refined(record, found.best) if found.ambiguous else after
    fits = {"before": found.before, "after": after, "after_best": best}
    verdict: Verdict = _verdict(record, found)
    if proof is not None and proof.refused and not found.ambiguous:
        verdict = "unattributed"
    adopted = [adopted_of(record, found, after, c) for c in after.chosen]
    if record.gross:
        adopted.append(gross_of(record, n_log))
    models = {name: _model(record, fit, gross=name == "before") for name, fit in fits.items()}
    if proof is not None:
        models["before"]["confirm_rms"] = proof.before
        models["after"]["confirm_rms"] = proof.after
    document: dict[str, Any] = {
        "schema": "surveyapp.diagnose/1",
        "subject": record.subject,
        "identity": identity,
        "unit": record.unit,
        "verdict": verdict,
        "adopted": adopted,
        "ambiguous": ambiguous_of(record, found),
        "candidates": candidates_of(found, record),
        **models,
        "averaged": None,
        "held_out": _blocks_left_out(record, found.before, after),
        "noise": {"before": found.before.noise, "after": after.noise},
        "lines": [],
        "remedy": remedies_of(record, adopted),
        "warnings": [item.to_dict() for item in notes],
        "mode": record.mode,
        **_compass_figures(record, found.before, after),
    }
    told = [n.text for n in notes if n.code == "not_adopted"]
    return SensorDiagnosis(
        document,
        (*words_of(document), *told),
        tuple(_record_of(item, document, data_sha256) for item in adopted),
    )


def _of_the_room(effect: str) -> ResultWarning:
    text = said("{effect}: may be the field of the room", effect=named(effect))
    return ResultWarning("not_adopted", text)


def _blocks_left_out(record: SensorRecord, before: LoopFit, after: LoopFit) -> dict[str, Any]:
    return {
        "scheme": "contiguous blocks, two halves fitted alternately",
        "before": _held_out(record, before),
        "after": _held_out(record, after),
        "unit": record.unit,
    }


def _record_of(item: dict[str, Any], document: dict[str, Any], sha256: str) -> AdoptedEffect:
    """A named effect as it is written under the log in project.toml."""
    grid = {g["name"] for g in item["grid"]}
    return AdoptedEffect(
        id=item["effect"],
        coefficients=tuple(
            (c["name"], c["value"], c["sigma"] or 0.0, c["unit"])
            for c in item["coefficients"]
            if c["name"] not in grid
        ),
        grid=tuple((g["name"], g["value"]) for g in item["grid"] if g["value"] is not None),
        data_sha256=sha256,
        before=document["before"]["rms"],
        after=document["after"]["rms"],
        confirm=document["after"]["confirm_rms"],
        unit=document["unit"],
    )


def _verdict(record: SensorRecord, found: LoopResult) -> Verdict:
    if found.ambiguous:
        return "not_separable"
    if found.after.chosen or record.gross:
        return "explained"
    return "adequate" if found.after.noise == "white" else "unattributed"


def _plain(record: SensorRecord, fit: LoopFit) -> LoopFit:
    """The same model by plain least squares: what its smallest residuals are."""
    return fit_model(record.data, fit.chosen, only_white=True) or fit


def _model(record: SensorRecord, fit: LoopFit, *, gross: bool) -> dict[str, Any]:
    residual = row_residual(record, _plain(record, fit))
    n = residual.shape[0] * residual.shape[1]
    dof = max(n - fit.parameters, 1)
    rms = rms_of(record, residual, gross=gross)
    return {
        "effects": list(fit.ids),
        "parameters": fit.parameters,
        "bic": fit.bic,
        "rms": rms,
        "sigma0": float(np.sqrt(np.sum(residual**2) / dof)),
        "dof": dof,
        "loo_rms": _held_out(record, fit),
        "confirm_rms": None,
        "forecast_rms": None,
        "value": None,
        "value_at_datum": None,
    }


def _held_out(record: SensorRecord, fit: LoopFit) -> float | None:
    """Rms of blocks that had no part in the fit; switch times stay as they were found."""
    n, d = record.observed.shape
    if record.subject == "compass":
        length = float(record.time[-1] - record.time[0]) / n
        block = max(round(HELD_OUT_S / length), 1) if length > 0.0 else 1
    else:
        block = max(TILT_ROWS * n // max(record.time.size, 1), 1)
    design = np.concatenate([record.base, *(c.design for c in fit.chosen)], axis=2)
    rows = row_residual(record, _plain(record, fit))
    inside = rows - block_means(rows, record.block)[record.block]
    held = np.full((n, d), np.nan)
    for used, left in alternate_blocks(n, block):
        a = design[used].reshape(-1, design.shape[2])
        solution, _, rank, _ = np.linalg.lstsq(a, record.observed[used].ravel(), rcond=1e-10)
        if rank < design.shape[2]:
            return None
        held[left] = record.observed[left] - design[left] @ solution
    residual = inside + held[record.block]
    divisor = residual.shape[0] * (1 if record.subject == "compass" else d)
    return float(np.sqrt(np.sum(residual**2) / divisor))


def _compass_figures(record: SensorRecord, before: LoopFit, after: LoopFit) -> dict[str, Any]:
    """Size of the corrected field and heading, before and after."""
    if record.mag is None or record.mode != "vector" or record.matrices is None:
        return {}
    figures: dict[str, dict[str, float]] = {"size_rms_uT": {}, "heading_rms_deg": {}}
    size = record.base.shape[2]
    for name, model in (("before", before), ("after", after)):
        fit = _plain(record, model)
        level = fit.x[:size]
        corrected = record.base_rows @ level + row_residual(record, fit)
        length = np.linalg.norm(corrected, axis=1)
        figures["size_rms_uT"][name] = float(np.std(length))
        turned = np.einsum("nij,nj->ni", record.matrices, corrected)
        angle = np.arctan2(turned[:, 1], turned[:, 0]) - math.atan2(level[1], level[0])
        angle = (angle + np.pi) % (2.0 * np.pi) - np.pi
        figures["heading_rms_deg"][name] = float(np.degrees(np.sqrt(np.mean(angle**2))))
    return dict(figures)
