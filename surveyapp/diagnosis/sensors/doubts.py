"""What a record cannot tell from the field of the room that it was taken in."""

from __future__ import annotations

from typing import Final

import numpy as np

from surveyapp.diagnosis.sensors.loop import Chosen, LoopFit, LoopResult, Trial, fit_model
from surveyapp.diagnosis.sensors.records import SensorRecord
from surveyapp.diagnosis.sensors.rule import MARGIN, ROOM_GRADIENT_UT, SIZE_MARGIN


def doubted(record: SensorRecord, found: LoopResult) -> LoopResult:
    """What a record cannot tell from the gradient of its room is not named.

    Without the attitude every small effect on the size may be the field of the room, where what
    remains is not white. With it and without the place that is so of a small switch (lifted and
    put down), and of what gains little where what remains is not white; iron and a turn that stay
    with the carrier are told from a room. What only white noise would name is not told from
    correlated noise.
    """
    alike = _alike_iron(record, found) if record.mode == "size" else None
    if alike is not None:
        return alike
    if record.mode == "size" and found.after.chosen and found.after.noise != "white":
        weak = (found.steps[0].gain or 0.0) < SIZE_MARGIN
        if weak or _contribution(record, found.after) < ROOM_GRADIENT_UT:
            return _perhaps_the_room(found)
        return found
    if record.mode == "vector" and found.after.chosen and _placeless(record):
        weak = found.after.noise != "white" and (found.steps[0].gain or 0.0) < SIZE_MARGIN
        lifted = "interference_step" in found.after.ids
        if weak or (lifted and _contribution(record, found.after) < ROOM_GRADIENT_UT):
            return _perhaps_the_room(found)
        return found
    if found.after.noise == "white" or found.ambiguous or found.after.chosen:
        return found
    plain = fit_model(record.data, found.after.chosen, only_white=True)
    if plain is None:
        return found
    best: Trial | None = None
    for candidate in record.candidates:
        if candidate.id in found.after.ids:
            continue
        for grid, design in candidate.designs(plain.residual):
            chosen_ = (*found.after.chosen, Chosen(candidate, grid, design))
            fit = fit_model(record.data, chosen_, only_white=True)
            if fit is not None and plain.bic - fit.bic > MARGIN:
                trial = Trial(candidate.id, plain.bic - fit.bic)
                if best is None or (trial.gain or 0.0) > (best.gain or 0.0):
                    best = trial
    if best is None:
        return found
    rivals = (Trial(found.after.noise, plain.bic - found.after.bic), best)
    return LoopResult(found.before, found.after, found.after, found.trials, rivals, found.steps)


ALIKE: Final = 0.05
"""Share of a hard iron that a soft one leaves, below which both look alike: near level the field
along z is constant, and what soft iron turns of it into x is a hard iron along x."""


def _alike_iron(record: SensorRecord, found: LoopResult) -> LoopResult | None:
    """Nothing named where a soft iron is named that is a hard iron as well; None where not."""
    soft = next((c for c in found.after.chosen if c.candidate.id == "soft_iron"), None)
    hard = next((c for c in record.candidates if c.id == "hard_iron"), None)
    if soft is None or hard is None or "hard_iron" in found.after.ids:
        return None
    size = record.observed.size
    known = np.concatenate([record.base, soft.design], axis=2).reshape(size, -1)
    design = hard.designs(found.before.residual)[0][1].reshape(size, -1)
    wanted = design - design.mean(axis=0)
    left = design - known @ np.linalg.lstsq(known, design, rcond=1e-10)[0]
    if float(np.sum(left**2)) > ALIKE * float(np.sum(wanted**2)):
        return None
    first = next(t for t in found.steps if t.id == "soft_iron")
    rivals = (first, Trial("hard_iron", first.gain, first.likelihood_ratio, 3, first.noise))
    return LoopResult(found.before, found.before, found.after, found.trials, rivals, found.steps)


def _placeless(record: SensorRecord) -> bool:
    return any(identity == "field_gradient" for identity, _ in record.missing)


def _perhaps_the_room(found: LoopResult) -> LoopResult:
    """Nothing named: the first effect and the gradient of the room are not told apart."""
    first = found.steps[0]
    rivals = (first, Trial("field_gradient", first.gain, 0.0, 1, first.noise))
    return LoopResult(found.before, found.before, found.after, found.trials, rivals, found.steps)


def _contribution(record: SensorRecord, fit: LoopFit) -> float:
    """Rms of what all effects together add; of a size about its mean, which the base takes."""
    start = record.base.shape[2]
    design = np.concatenate([c.design for c in fit.chosen], axis=2)
    part = design @ fit.x[start:]
    if record.mode == "size":
        part = part - part.mean(axis=0)
    return float(np.sqrt(np.mean(np.sum(part**2, axis=1))))
