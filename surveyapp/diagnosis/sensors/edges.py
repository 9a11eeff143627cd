"""When something was switched on and off, to the row.

The loop compares models on block means. A switch within a block leaves there a good part of its
size, far beyond the noise of a mean, and every effect that is tried next would be judged by that
block: so the times are found to the row before anything else is tried.
"""

from __future__ import annotations

import math

import numpy as np

from surveyapp.diagnosis.sensors.loop import Chosen, LoopFit, fit_model
from surveyapp.diagnosis.sensors.records import SensorRecord
from surveyapp.diagnosis.sensors.windows import block_means, switched
from surveyapp_models.arrays import Floats


def refined(record: SensorRecord, fit: LoopFit) -> LoopFit:
    """Switch times to the row: where each row fits better with or without the step.

    Parameters
    ----------
    record : SensorRecord
    fit : LoopFit

    Returns
    -------
    LoopFit
        As it was where nothing is switched, or where the rows do not fit better.
    """
    if record.step_rows is None:
        return fit
    for _ in range(2):
        index = next(
            (i for i, c in enumerate(fit.chosen) if c.candidate.id == "interference_step"), None
        )
        if index is None:
            return fit
        chosen = fit.chosen[index]
        on, off = _edges(record, fit, chosen)
        rows = record.step_rows * switched(record.time, on, off)[:, None, None]
        moved = Chosen(
            chosen.candidate, {"on_s": on, "off_s": off}, block_means(rows, record.block)
        )
        trial = fit_model(record.data, (*fit.chosen[:index], moved, *fit.chosen[index + 1 :]))
        if trial is None or trial.bic > fit.bic + 6.0:
            return fit
        fit = trial
    return fit


def row_residual(record: SensorRecord, fit: LoopFit, *, without: str = "") -> Floats:
    """Residual row by row of base and effects, ``without`` one of them, shape (m, d)."""
    size = record.base.shape[2]
    residual = record.rows - record.base_rows @ fit.x[:size]
    start = size
    for chosen in fit.chosen:
        k = chosen.design.shape[2]
        x = fit.x[start : start + k]
        start += k
        if chosen.candidate.id == without:
            continue
        if chosen.candidate.id == "interference_step" and record.step_rows is not None:
            on, off = chosen.grid["on_s"], chosen.grid["off_s"]
            residual = residual - (record.step_rows @ x) * switched(record.time, on, off)[:, None]
        elif chosen.candidate.rows is not None:
            residual = residual - chosen.candidate.rows(chosen.grid) @ x
        else:
            residual = residual - (chosen.design @ x)[record.block]
    return np.asarray(residual)


def _edges(record: SensorRecord, fit: LoopFit, chosen: Chosen) -> tuple[float, float]:
    bare = row_residual(record, fit, without="interference_step")
    size, start = record.base.shape[2], 0
    start = size
    for item in fit.chosen:
        if item is chosen:
            break
        start += item.design.shape[2]
    x = fit.x[start : start + chosen.design.shape[2]]
    if record.step_rows is None:
        return chosen.grid["on_s"], chosen.grid["off_s"]
    gain = np.sum(bare**2, axis=1) - np.sum((bare - record.step_rows @ x) ** 2, axis=1)
    per_block = int(np.ceil(record.time.size / record.observed.shape[0]))
    reach = 2 * per_block + 2
    first = int(np.searchsorted(record.time, chosen.grid["on_s"]))
    last = int(np.searchsorted(record.time, chosen.grid["off_s"]))
    total = np.concatenate([[0.0], np.cumsum(gain)])
    if first > 0:
        a = np.arange(max(first - reach, 0), min(first + reach, last))
        first = int(a[np.argmin(total[a])])
    if last < record.time.size:
        b = np.arange(max(last - reach, first + 1), min(last + reach, record.time.size) + 1)
        last = int(b[np.argmax(total[b])])
    off = float(record.time[last]) if last < record.time.size else math.inf
    return float(record.time[first]), off
