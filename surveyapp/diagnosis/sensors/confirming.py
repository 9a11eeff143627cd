"""A second log of the same sensor, and whether what was named in the first predicts it better.

The effects keep the coefficients of the first log; only the base model is fitted anew. What happens
once (a switch, a slip) cannot recur and is neither confirmed nor refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.sensors.loop import Chosen, LoopFit, fit_model
from surveyapp.diagnosis.sensors.records import SensorRecord
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject


@dataclass(frozen=True, slots=True)
class Confirmed:
    """What a second record says.

    Parameters
    ----------
    before, after : float or None
        Rms of its block means by the base model, and with the effects of the first record.
    refused : tuple of (str, str)
        Effects that it does not confirm, and why.
    fit : LoopFit
        The first record's model with the others.
    """

    before: float | None
    after: float | None
    refused: tuple[tuple[str, str], ...]
    fit: LoopFit


def confirmed(record: SensorRecord, fit: LoopFit, second: SensorRecord) -> Confirmed:
    """Judge every effect of a model by a second record."""
    once = {e.id for e in of_subject(record.subject) if e.event}
    refused: list[tuple[str, str]] = []
    plain = _rms(second, ())
    for chosen in fit.chosen:
        name = chosen.candidate.id
        if name in once:
            continue
        part = _part(record, fit, chosen, second)
        if part is None:
            refused.append((name, "the second log lacks what is needed to confirm it"))
        elif _rms(second, (part,)) >= plain:
            refused.append((name, "the second log is predicted no better with it"))
    names = {name for name, _ in refused}
    kept = tuple(c for c in fit.chosen if c.candidate.id not in names)
    after = fit
    if names:
        after = fit_model(record.data, kept) or fit
    parts = [
        part
        for c in after.chosen
        if c.candidate.id not in once and (part := _part(record, after, c, second)) is not None
    ]
    return Confirmed(plain, _rms(second, parts), tuple(refused), after)


def _part(
    record: SensorRecord, fit: LoopFit, chosen: Chosen, second: SensorRecord
) -> Floats | None:
    """What an effect of the first record adds to the second, shape (n, d)."""
    start = record.base.shape[2]
    for item in fit.chosen:
        if item is chosen:
            break
        start += item.design.shape[2]
    x = fit.x[start : start + chosen.design.shape[2]]
    there = next((c for c in second.candidates if c.id == chosen.candidate.id), None)
    if there is None:
        return None
    trials = there.designs(second.observed)
    gaps = [sum(abs(p[k] - chosen.grid.get(k, p[k])) for k in p) for p, _ in trials]
    design = trials[int(np.argmin(gaps))][1]
    if design.shape[1:] != (second.observed.shape[1], x.size):
        return None
    return np.asarray(design @ x)


def _rms(record: SensorRecord, parts: Sequence[Floats]) -> float:
    """Rms of the block means less the given parts, the base model fitted to what is left."""
    left = record.observed - sum(parts, start=np.zeros_like(record.observed))
    design = record.base.reshape(-1, record.base.shape[2])
    solution = np.linalg.lstsq(design, left.ravel(), rcond=1e-10)[0]
    divisor = left.shape[0] if record.subject == "compass" else left.size
    return float(np.sqrt(np.sum((left.ravel() - design @ solution) ** 2) / divisor))
