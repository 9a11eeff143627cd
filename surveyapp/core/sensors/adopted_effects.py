"""What a diagnosis named in a log and a person adopted, taken out before the log is used.

What happened in the record and never again is taken out: a switch, gross errors, the warm-up of
that day. What belongs to the sensor (iron, cross axis, temperature) stays: the calibration
estimates it with everything else, and a correction by a card has it on the card.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from surveyapp.domain.columns import PIECE, Room, in_memory, let_go
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.sensor_log import Array, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.effects import of_subject

AXES = ("along", "across")
EVENT_COLUMNS = (*(f"mag_{a}_uT" for a in "xyz"), *(f"tilt_{a}_arcsec" for a in AXES))
"""Columns in which an event was seen."""


def without_events(
    log: SensorLog, effects: Sequence[AdoptedEffect], *, room: Room = in_memory
) -> tuple[SensorLog, tuple[ResultWarning, ...]]:
    """The log without the adopted effects that were events of it, and what was done.

    Parameters
    ----------
    log : SensorLog
        Of a compass or a two-axis tilt sensor.
    effects : sequence of AdoptedEffect
        Of its ``[[sensor_log]]``.
    room : callable
        Where the columns lie that were changed.
    """
    told: list[ResultWarning] = []
    gross: list[int] = []
    for effect in effects:
        if effect.data_sha256 and log.sha256 and effect.data_sha256 != log.sha256:
            text = said(
                "{id} was adopted for another state of the log: it is not taken out", id=effect.id
            )
            told.append(ResultWarning("adopted_not_applied", text))
            continue
        if effect.id == "gross_error":
            gross += _rows(effect)
            continue
        columns = _corrected(log, effect, room)
        if columns is None:
            text = said("{id} belongs to the sensor and is left to its calibration", id=effect.id)
            told.append(ResultWarning("adopted_not_applied", text))
            continue
        log = replace(log, columns={**log.columns, **columns})
        told.append(
            ResultWarning("adopted_applied", said("{id} as adopted is taken out", id=effect.id))
        )
    if gross:
        log = _without_rows(log, gross, room)
        text = said("{size} rows adopted as gross errors are left out", size=len(gross))
        told.append(ResultWarning("adopted_applied", text))
    return log, tuple(told)


def _corrected(log: SensorLog, effect: AdoptedEffect, room: Room) -> dict[str, Array] | None:
    """Columns without the effect; None where it is no event."""
    found: dict[str, Array] = {}
    for start in range(0, log.size, PIECE):
        columns = _piece_corrected(log.rows(slice(start, start + PIECE)), effect)
        if columns is None:
            return None
        for name, values in columns.items():
            if name not in found:
                found[name] = room(log.size)
            found[name][start : start + PIECE] = values
            let_go(found[name])
        let_go(log.columns["time_s"])
    return found


def _piece_corrected(log: SensorLog, effect: AdoptedEffect) -> dict[str, Array] | None:
    values = {name: value for name, value, _, _ in effect.coefficients}
    grid = {name: float(value) for name, value in effect.grid if not isinstance(value, str)}
    if effect.id == "interference_step" and log.has("mag_x_uT", "mag_y_uT", "mag_z_uT"):
        time = log.columns["time_s"]
        during = (time >= grid.get("on_s", -np.inf)) & (time < grid.get("off_s", np.inf))
        return {
            f"mag_{a}_uT": log.columns[f"mag_{a}_uT"] - values.get(f"step_{a}", 0.0) * during
            for a in "xyz"
        }
    if effect.id == "warm_up" and log.has("tilt_along_arcsec", "tilt_across_arcsec", "time_s"):
        known = next(e for e in of_subject("tilt") if e.id == "warm_up")
        found = {}
        for number, axis in enumerate(AXES):
            rows = {"axis": np.full(log.size, float(number)), "time_s": log.columns["time_s"]}
            size = np.array([values.get(f"warm_up_{a}", 0.0) for a in AXES])
            name = f"tilt_{axis}_arcsec"
            found[name] = log.columns[name] - known.basis(rows, **grid) @ size
        return found
    return None


def _rows(effect: AdoptedEffect) -> list[int]:
    """Rows of gross errors, from 0; named ``row 1`` and so on."""
    words = [name.rpartition(" ")[2] for name, *_ in effect.coefficients]
    return [int(word) - 1 for word in words if word.isdigit()]


def _without_rows(log: SensorLog, rows: Sequence[int], room: Room) -> SensorLog:
    kept = np.ones(log.size, dtype=bool)
    kept[[row for row in rows if 0 <= row < log.size]] = False
    return log.chosen(kept, room=room)
