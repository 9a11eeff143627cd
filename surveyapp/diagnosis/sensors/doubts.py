"""What a record cannot tell from the field of the room that it was taken in."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from surveyapp.diagnosis.sensors.loop import Chosen, LoopFit, LoopResult, Trial, fit_model
from surveyapp.diagnosis.sensors.records import SensorRecord
from surveyapp.diagnosis.sensors.rule import MARGIN, ROOM_GRADIENT_UT, SIZE_MARGIN


def doubted(record: SensorRecord, found: LoopResult) -> LoopResult:
    """What a record cannot tell from the field of its room is not named.

    First all of them together, then each by itself, the weakest first. Without the attitude every
    small effect on the size may be the field of the room, where what remains is not white. With it
    and without the place that is so of a small switch (lifted and put down), and of what gains
    little where what remains is not white; iron and a turn that stay with the carrier are told from
    a room. With the place too an effect must be wanted beside every field that a room may have
    along the path. What only white noise would name is not told from correlated noise.
    """
    alike = _alike_iron(record, found) if record.mode == "size" else None
    if alike is not None:
        return alike
    if record.subject == "compass" and found.after.chosen:
        return _beside_the_room(record, found)
    if found.after.noise == "white" or found.ambiguous or found.after.chosen:
        return found
    return _only_in_white(record, found)


def _beside_the_room(record: SensorRecord, found: LoopResult) -> LoopResult:
    """Without the effects that may be the room; what these were is kept as ``doubted``."""
    if record.room is None and _all_small(record, found):
        return _perhaps_the_room(found)
    judged = _by_the_path if record.room is not None else _by_size
    fit, left, taken = found.after, list[str](), list[Trial]()
    while fit.chosen:
        worst = judged(record, fit)
        if worst is None:
            break
        identity = fit.chosen[worst].candidate.id
        rest = tuple(c for i, c in enumerate(fit.chosen) if i != worst)
        without = fit_model(record.data, rest)
        if without is None:
            break
        left.append(identity)
        iron = None
        if record.room is not None and identity == "interference_step":
            iron = _with_iron(record, without)  # judged in its turn
        if iron is not None:
            gain, extra = without.bic - iron.bic, iron.parameters - without.parameters
            ratio = gain + extra * math.log(iron.residual.size)
            taken.append(Trial("hard_iron", gain, ratio, extra, iron.noise))
        fit = without if iron is None else iron
    if not left:
        return found
    if not fit.chosen and not found.ambiguous:
        return _perhaps_the_room(found)
    best = found.best if found.ambiguous else fit
    named = tuple(dict.fromkeys(i for i in reversed(left) if i not in fit.ids))
    steps = (*found.steps, *taken)
    return replace(found, after=fit, best=best, steps=steps, doubted=named)


def _with_iron(record: SensorRecord, fit: LoopFit) -> LoopFit | None:
    """The model and a constant iron; None where it has one."""
    if "hard_iron" in fit.ids:
        return None
    return fit_model(record.data, (*fit.chosen, _constant_iron(record, fit)))


def _all_small(record: SensorRecord, found: LoopResult) -> bool:
    """Whether the first effect gains little, or all together add no more than a room."""
    coloured = found.after.noise != "white"
    if coloured and (found.steps[0].gain or 0.0) < SIZE_MARGIN:
        return True
    lifted = "interference_step" in found.after.ids
    small = _contribution(record, found.after) < ROOM_GRADIENT_UT
    return small and (coloured if record.mode == "size" else lifted)


def _contribution(record: SensorRecord, fit: LoopFit) -> float:
    """Rms of what all effects together add; of a size about its mean, which the base takes."""
    start = record.base.shape[2]
    design = np.concatenate([c.design for c in fit.chosen], axis=2)
    part = design @ fit.x[start:]
    if record.mode == "size":
        part = part - part.mean(axis=0)
    return float(np.sqrt(np.mean(np.sum(part**2, axis=1))))


def _by_size(record: SensorRecord, fit: LoopFit) -> int | None:
    """The effect that adds least of those that a room of a few uT explains; None where none is."""
    coloured = fit.noise != "white"
    if record.mode == "size" and not coloured:
        return None
    doubts: dict[int, float] = {}
    for index, item in enumerate(fit.chosen):
        gain, own = _own(record, fit, index)
        small = own < ROOM_GRADIENT_UT
        lifted = item.candidate.id == "interference_step" and small
        doubtful = small if record.mode == "size" else lifted
        if doubtful or (coloured and gain < SIZE_MARGIN):
            doubts[index] = own
    return min(doubts, key=lambda index: doubts[index], default=None)


def _own(record: SensorRecord, fit: LoopFit, index: int) -> tuple[float, float]:
    """What only this effect explains: the BIC it gains, the rms [uT] left without it."""
    rest = tuple(c for i, c in enumerate(fit.chosen) if i != index)
    without = fit_model(record.data, rest)
    plain = fit_model(record.data, fit.chosen, only_white=True)
    bare = fit_model(record.data, rest, only_white=True)
    if without is None or plain is None or bare is None:
        return math.inf, math.inf
    more = float(np.sum(bare.residual**2) - np.sum(plain.residual**2))
    return without.bic - fit.bic, math.sqrt(max(more, 0.0) / len(fit.residual))


def _by_the_path(record: SensorRecord, fit: LoopFit) -> int | None:
    """The effect that a room's field along the path makes most needless; None where none is.

    A switch must beat a constant iron in its place too, and by more: in a bent field one shows as
    the other, and a carrier is lifted at some time and put down.
    """
    if record.room is None:
        return None
    base = np.concatenate([record.data.base, record.room()], axis=2)
    data = replace(record.data, base=base)
    items = [(i, c) for i, c in enumerate(fit.chosen) if c.candidate.id != "field_gradient"]
    whole = fit_model(data, tuple(c for _, c in items))
    iron = () if "hard_iron" in fit.ids else (_constant_iron(record, fit),)
    missed: dict[int, float] = {}
    for index, item in items:
        rest = tuple(c for i, c in items if i != index)
        others = [rest]
        margin = MARGIN
        if item.candidate.id == "interference_step":
            others, margin = [rest, (*rest, *iron)], SIZE_MARGIN
        best = min(f.bic for o in others if (f := fit_model(data, o)) is not None)
        missed[index] = math.inf if whole is None else margin - (best - whole.bic)
    worst = max(missed, key=lambda index: missed[index], default=None)
    return worst if worst is not None and missed[worst] > 0.0 else None


def _constant_iron(record: SensorRecord, fit: LoopFit) -> Chosen:
    candidate = next(c for c in record.candidates if c.id == "hard_iron")
    grid, design = candidate.designs(fit.residual)[0]
    return Chosen(candidate, grid, design)


def _only_in_white(record: SensorRecord, found: LoopResult) -> LoopResult:
    """What is named under white noise only stands beside the noise as not told apart."""
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


def _perhaps_the_room(found: LoopResult) -> LoopResult:
    """Nothing named: the first effect and the gradient of the room are not told apart."""
    first = found.steps[0]
    rivals = (first, Trial("field_gradient", first.gain, 0.0, 1, first.noise))
    return LoopResult(found.before, found.before, found.after, found.trials, rivals, found.steps)
