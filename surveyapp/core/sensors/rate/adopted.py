"""What a diagnosis named in the log of a rate sensor and a person adopted, taken out of it.

A drift, a gross error, a line of interference are of that record; a temperature coefficient, a
sensitivity to gravity or to fields, an asymmetric scale are of the sensor, but no programme
estimates them beside scale, misalignment and bias: all of them are taken out, at the datum that the
diagnosis had. How the unit sat in a position is not: either of the two positions of an axis may be
the crooked one, so its size goes into the sigmas as the error of a flip.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from surveyapp.core.statistics.distributions import NORMAL_95, student_quantile
from surveyapp.domain.calibration import SensorParameter
from surveyapp.domain.instrument import AdoptedEffect
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.rate.flip_error import SEAT_SD

GYROS: Final = {a: f"gyr_{a}_rad_s" for a in "xyz"}
NEEDED: Final[Mapping[str, tuple[str, ...]]] = {
    "temperature": ("temperature_c",),
    "g_sensitivity": tuple(f"acc_{a}_m_s2" for a in "xyz"),
    "magnetic_sensitivity": tuple(f"mag_{a}_uT" for a in "xyz"),
}
"""Columns of the log without which an effect cannot be taken out."""
_DEG_H: Final = math.radians(1.0) / 3600.0
_TESLA: Final = 1e-6


@dataclass(frozen=True, slots=True)
class StopDatum:
    """Where the diagnosis saw the stops of a log, and the state at which its effects are zero.

    Parameters
    ----------
    rows : tuple of (int, int)
        First and last row of each stop, last exclusive, in the order of the diagnosis.
    middle_s : float
        Time at which a drift is zero.
    temperature_c : float or None
        At which a temperature coefficient does nothing.
    table : bool
        Whether a table turned the sensor; else it lay still in its stops.
    """

    rows: tuple[tuple[int, int], ...]
    middle_s: float
    temperature_c: float | None
    table: bool


AT_STOPS: Final = frozenset({"bias_ramp", "temperature", "scale_asymmetry", "gross_error"})
"""Effects that need to know the stops: where they are zero, or in which rows they lie."""
NO_STOPS: Final = StopDatum((), 0.0, None, table=False)
"""For the others."""


def columns_needed(effects: Sequence[AdoptedEffect]) -> tuple[str, ...]:
    """Columns that a command must read to take these effects out."""
    return tuple(dict.fromkeys(c for e in effects for c in NEEDED.get(e.id, ())))


def without_effects(
    log: SensorLog, effects: Sequence[AdoptedEffect], datum: StopDatum
) -> tuple[SensorLog, tuple[ResultWarning, ...]]:
    """The log without these effects, and what was done.

    Parameters
    ----------
    log : SensorLog
        With the gyros in rad/s.
    effects : sequence of AdoptedEffect
    datum : StopDatum
    """
    told: list[ResultWarning] = []
    for effect in effects:
        reason = _why_not(log, effect)
        if reason:
            told.append(ResultWarning("adopted_not_applied", reason))
            continue
        shifts = _SHIFTS[effect.id](log, effect, datum)
        columns = {
            name: log.columns[name] - shifts[a]
            for a, name in GYROS.items()
            if a in shifts and name in log.columns
        }
        log = replace(log, columns={**log.columns, **columns})
        told.append(ResultWarning("adopted_applied", _done(effect, datum)))
    return log, tuple(told)


def _why_not(log: SensorLog, effect: AdoptedEffect) -> str:
    """Why an effect is not taken out of a log; empty if it is."""
    if effect.data_sha256 and log.sha256 and effect.data_sha256 != log.sha256:
        return said(
            "{id} was adopted for another state of the log: it is not taken out", id=effect.id
        )
    if effect.id == "flip_error":
        return said(
            "flip_error is not taken out: the other positions sit no better than anybody knows; "
            "its size counts as the error of a flip in the sigmas"
        )
    if effect.id not in _SHIFTS:
        return said("{id} cannot be taken out of this log", id=effect.id)
    if effect.id == "interference_line" and "begin_s" not in dict(effect.grid):
        return said("{id} was adopted without the time of its phase: adopt it again", id=effect.id)
    missing = [c for c in NEEDED.get(effect.id, ()) if c not in log.columns]
    if missing:
        return said(
            "{id} is not taken out: the log has no {columns}",
            id=effect.id,
            columns=", ".join(missing),
        )
    return ""


def _done(effect: AdoptedEffect, datum: StopDatum) -> str:
    if effect.id == "temperature" and datum.temperature_c is not None:
        return said(
            "temperature as adopted is taken out: the biases are those at {t:.2f} C",
            t=datum.temperature_c,
        )
    if effect.id == "bias_ramp":
        return said(
            "bias_ramp as adopted is taken out: the biases are those at {t:.1f} s",
            t=datum.middle_s,
        )
    return said("{id} as adopted is taken out", id=effect.id)


def _si(effect: AdoptedEffect) -> dict[str, float]:
    """Coefficients by name in SI units."""
    known = next(e for e in of_subject("rate") if e.id == effect.id)
    scale = {c.name: c.scale for c in known.coefficients}
    return {
        name: value * scale.get(name, scale.get(name.partition("_")[0], math.nan))
        for name, value, _, _ in effect.coefficients
    }


def _ramp(log: SensorLog, effect: AdoptedEffect, datum: StopDatum) -> dict[str, Floats]:
    minutes = (log.columns["time_s"] - datum.middle_s) / 60.0
    return {a: value * minutes for a, value in _si(effect).items()}


def _temperature(log: SensorLog, effect: AdoptedEffect, datum: StopDatum) -> dict[str, Floats]:
    warmth = log.columns["temperature_c"]
    middle = float(np.nanmean(warmth)) if datum.temperature_c is None else datum.temperature_c
    return {a: value * (warmth - middle) for a, value in _si(effect).items()}


def _gravity(log: SensorLog, effect: AdoptedEffect, datum: StopDatum) -> dict[str, Floats]:
    del datum
    found = {a: np.zeros(log.size) for a in "xyz"}
    for name, value in _si(effect).items():
        found[name[0]] = found[name[0]] + value * log.columns[f"acc_{name[1]}_m_s2"]
    return found


def _field(log: SensorLog, effect: AdoptedEffect, datum: StopDatum) -> dict[str, Floats]:
    del datum
    return {a: v * _TESLA * log.columns[f"mag_{a}_uT"] for a, v in _si(effect).items()}


def _asymmetry(log: SensorLog, effect: AdoptedEffect, datum: StopDatum) -> dict[str, Floats]:
    """Half the size of each gyro's own rate; at rest it has none, whatever its noise."""
    found = {}
    for a, value in _si(effect).items():
        rate = np.abs(log.columns[GYROS[a]])
        if datum.table:
            own = np.array([word[:1] == a for word in log.texts["position"]])
            if "table_rate_deg_s" in log.columns:
                rate = np.deg2rad(np.abs(log.columns["table_rate_deg_s"]))
            rate = rate * own
        else:
            at_rest = np.concatenate([np.arange(*span) for span in datum.rows])
            bias = float(np.mean(log.columns[GYROS[a]][at_rest]))
            rate = np.abs(log.columns[GYROS[a]] - bias)
            rate[at_rest] = 0.0
        found[a] = 0.5 * value * rate
    return found


def _gross(log: SensorLog, effect: AdoptedEffect, datum: StopDatum) -> dict[str, Floats]:
    """In the samples of the stop by what its output was too large."""
    found = {a: np.zeros(log.size) for a in "xyz"}
    numbers = [int(v) for name, v in effect.grid if name.startswith("row")]
    for value, number in zip(_si(effect).values(), numbers, strict=False):
        stop, axis = divmod(number - 1, 3)
        if 0 <= stop < len(datum.rows):
            first, last = datum.rows[stop]
            found["xyz"[axis]][first:last] += value
    return found


def _line(log: SensorLog, effect: AdoptedEffect, datum: StopDatum) -> dict[str, Floats]:
    del datum
    grid = {name: float(value) for name, value in effect.grid}
    time = log.columns["time_s"]
    phase = 2.0 * np.pi * grid["frequency_hz"] * (time - grid["begin_s"])
    during = (time >= grid["begin_s"]) & (time <= grid.get("end_s", math.inf))
    found: dict[str, Floats] = {}
    for name, value in _si(effect).items():
        kind, _, gyro = name.partition("_")
        wave = value * (np.cos(phase) if kind == "cosine" else np.sin(phase)) * during
        found[gyro] = found.get(gyro, np.zeros(log.size)) + wave
    return found


_SHIFTS: Final[Mapping[str, Callable[[SensorLog, AdoptedEffect, StopDatum], dict[str, Floats]]]] = {
    "bias_ramp": _ramp,
    "temperature": _temperature,
    "g_sensitivity": _gravity,
    "magnetic_sensitivity": _field,
    "scale_asymmetry": _asymmetry,
    "gross_error": _gross,
    "interference_line": _line,
}
"""Effect to what it put into each gyro [rad/s], shape (n,)."""


def adopted_parameters(effects: Sequence[AdoptedEffect]) -> tuple[SensorParameter, ...]:
    """Of effects of the sensor that were taken out, what belongs on its card.

    ``scale_factor_asymmetry_x`` [ppm] and ``g_sensitivity_xy`` [deg/h/g], the terms of IEEE 952 and
    1554.
    """
    found = []
    for effect in effects:
        if effect.id == "scale_asymmetry":
            found += [
                SensorParameter(f"scale_factor_asymmetry_{name}", value, sigma, "ppm")
                for name, value, sigma, _ in effect.coefficients
            ]
        elif effect.id == "g_sensitivity":
            factor = math.radians(1.0) / _DEG_H * STANDARD_GRAVITY_M_S2
            found += [
                SensorParameter(f"g_sensitivity_{name}", v * factor, s * factor, "deg/h/g")
                for name, v, s, _ in effect.coefficients
            ]
    return tuple(found)


def adopted_flip_sigma(effects: Sequence[AdoptedEffect]) -> float:
    """Standard deviation of a flip [rad] that an adopted one shows; 0 where there is none.

    A crooked seat is seen as the difference of two flips, across the axis of its position; where
    every position sits crookedly the standard deviation itself was named. That one rests on k
    combinations of seats, value/sigma = sqrt(2 k), and is widened by Student's t over the normal
    quantile, so that 95 % intervals of 1.96 sigma hold.
    """
    stated = [
        value * ARCSEC * student_quantile(0.975, 0.5 * (value / sigma) ** 2) / NORMAL_95
        for effect in effects
        if effect.id == "flip_error"
        for name, value, sigma, _ in effect.coefficients
        if name == SEAT_SD and sigma > 0.0
    ]
    if stated:
        return max(stated)
    turns = [
        value * ARCSEC
        for effect in effects
        if effect.id == "flip_error"
        for _, value, _, _ in effect.coefficients
        if value != 0.0
    ]
    return math.sqrt(float(np.mean(np.square(turns))) / 2.0) if turns else 0.0
