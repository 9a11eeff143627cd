"""``calibrate rate --programme multi-position``: a hand-held record to accelerometers and gyros."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from surveyapp.core.sensors.rate.hand_forces import (
    LEVELS,
    PARAMETERS,
    ForceModel,
    converter_zero,
    covariance_with_omitted,
    expanded,
    fit_forces,
    left_out,
    shifted_forces,
)
from surveyapp.core.sensors.rate.hand_held import HeldStop, RateModel, Turn, fit_rates
from surveyapp.core.sensors.rate.hand_parameters import (
    LEAST_TURNS,
    force_parameters,
    needed,
    rate_parameters,
    why_none,
    widened,
)
from surveyapp.core.sensors.rate.held_turns import (
    ACCELEROMETERS,
    GYROS,
    rest_rates,
    turns_between,
    ups_of,
    with_frame,
    with_g_sensitivity,
)
from surveyapp.core.sensors.rate.needed import (
    CROSS_TOLERANCE,
    SCALE_TOLERANCE,
    ZERO_TOLERANCE,
)
from surveyapp.core.sensors.rate.still import (
    FALSE_ALARM,
    WINDOW_S,
    bias_tolerance,
    bridged,
    gate_of,
    rest_noise,
    runs_of,
    statistic,
)
from surveyapp.core.sensors.rate.turn_axes import axes_problems
from surveyapp.core.statistics.distributions import NORMAL_95
from surveyapp.domain.calibration import (
    Calibration,
    CalibrationModel,
    Geometry,
    HeldOut,
    Misfit,
    with_reasons,
)
from surveyapp.domain.sensor_log import STANDARD_GRAVITY_M_S2, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

NEEDED = (*GYROS, *ACCELEROMETERS)
LEAST_STOP_S = 1.0
"""A shorter stop does not average the noise of a hand."""
LEAST_STOPS = 5
"""Stops below which no model is determined: one more than bias and scale need."""
GUARD_S = 0.1
SAME_ATTITUDE = 0.02
"""A unit that was bumped lies as before to so much [rad]."""
FEW_DOF = 3


@dataclass(frozen=True, slots=True)
class MultiPositionOptions:
    """What is stated beside the log: latitude [rad] or None, gravity [m/s2]."""

    latitude: float | None = None
    gravity: float = STANDARD_GRAVITY_M_S2


def held_stops(log: SensorLog) -> list[HeldStop]:
    """Stops at which the record is as quiet as its quietest parts."""
    force = np.column_stack([log.columns[c] for c in ACCELEROMETERS])
    rate = np.column_stack([log.columns[c] for c in GYROS])
    hz = log.rate_hz or 100.0
    noise = rest_noise(force, rate, rate_hz=hz)
    window = max(round(WINDOW_S * hz), 3)
    tolerance = bias_tolerance(rate, noise, rate_hz=hz)
    values = statistic(force, rate, noise, window=window, tolerance=tolerance)
    gate = gate_of(values, window=window, false_alarm=FALSE_ALARM, own_means=6)
    still = bridged(values <= gate.threshold, rate_hz=hz, least_s=LEAST_STOP_S)
    guard = round(GUARD_S * hz)
    found: list[HeldStop] = []
    for first, last in runs_of(still):
        a, b = first + guard, last - guard
        if b - a < 2:
            continue
        mean = force[a:b].mean(axis=0)
        if found and _only_bumped(
            found[-1], HeldStop(a, b, mean, rate[a:b].mean(axis=0), 0.0), log
        ):
            last_one = found.pop()
            a = last_one.start
            mean = np.average(
                [last_one.force, mean], axis=0, weights=[last_one.stop - last_one.start, b - a]
            )
        middle = float(log.columns["time_s"][(a + b) // 2])
        found.append(HeldStop(a, b, mean, rate[a:b].mean(axis=0), middle))
    return found


def _only_bumped(before: HeldStop, after: HeldStop, log: SensorLog) -> bool:
    """Whether a unit was not turned between two rests: neither gravity nor the gyros show it.

    A turn about the vertical leaves gravity where it was.
    """
    size = float(np.linalg.norm(before.force))
    if float(np.linalg.norm(after.force - before.force)) >= SAME_ATTITUDE * size:
        return False
    rate = np.column_stack([log.columns[c][before.stop : after.start] for c in GYROS])
    resting = 0.5 * (before.rate + after.rate)
    turned = (rate - resting).sum(axis=0) / (log.rate_hz or 100.0)
    return float(np.linalg.norm(turned)) < SAME_ATTITUDE


def _too_few(log: SensorLog, stops: int) -> Problem:
    return Problem(
        "too few stops at rest for any model",
        log.path,
        said("{size} stops as quiet as the record can be", size=stops),
        said(
            "{least_stops} or more, of {least_stop_s:g} s and more, in different attitudes",
            least_stops=LEAST_STOPS,
            least_stop_s=LEAST_STOP_S,
        ),
        "lay the unit down at each stop: a hand that holds it moves it",
    )


def calibrate_multi_position(log: SensorLog, options: MultiPositionOptions) -> Calibration:
    """Accelerometers and gyros from hand-held stops.

    Raises
    ------
    SurveyError
        If there are too few stops for any model, or a gyro is saturated.
    """
    stops = held_stops(log)
    if len(stops) < LEAST_STOPS:
        raise SurveyError(_too_few(log, len(stops)))
    forces = np.array([s.force for s in stops])
    models = _force_models(forces, options.gravity)
    held = {m.level: left_out(forces, m, gravity=options.gravity) for m in models}
    chosen = _chosen(models, held)
    covariance = covariance_with_omitted(forces, chosen, gravity=options.gravity)
    turns = turns_between(log, stops, chosen, options.latitude)
    problems = axes_problems(turns, log.path)
    if problems:
        raise SurveyError(problems)
    bias, sigma_bias = _bias(stops, chosen, options)
    gyro = None
    if len(turns) >= LEAST_TURNS:
        gyro = _fitted(stops, chosen, turns, gravity=options.gravity)
    parameters = (
        *needed(force_parameters(chosen, covariance), len(stops), "stops"),
        *needed(rate_parameters(gyro, bias, sigma_bias), len(turns), "turns"),
    )
    why = partial(why_none, model=chosen, stops=len(stops), turns=len(turns))
    parameters = with_reasons(parameters, why)
    missing = tuple(p.name for p in parameters if p.value is None)
    raw = np.linalg.norm(forces, axis=1) - options.gravity
    before = math.sqrt(float(np.mean(raw**2)))
    if np.any(converter_zero(forces, options.gravity)):
        before = models[0].rms  # counts from the middle of a range: their size says nothing
    size = said("size of gravity at the stops")
    return Calibration(
        kind="multi-position",
        source=log.id,
        parameters=parameters,
        before=Misfit(before, "m/s2", size),
        after=Misfit(chosen.rms, "m/s2", size),
        geometry=Geometry("good" if not missing else "restricted", None, missing),
        held_out=HeldOut(
            said("one stop after the other"), held.get("bias_scale"), held.get(chosen.level), "m/s2"
        ),
        models=tuple(
            CalibrationModel(m.level, m.rms, held[m.level], m.level == chosen.level, "m/s2", size)
            for m in models
        ),
        warnings=(
            *log.warnings,
            *_warnings(log, chosen, gyro, options),
            *_left_out(len(stops) - 1 - len(turns)),
        ),
        met=not missing,
        n=log.size,
        sha256=log.sha256,
        extra={
            "stops": [_stop_dict(log, s, chosen) for s in stops],
            "dof": {"accelerometer": chosen.dof, "gyro": None if gyro is None else gyro.dof},
            "gravity_direction": None
            if gyro is None
            else _directions(gyro, turns, with_g_sensitivity(log, stops, chosen, turns)),
        },
    )


def _fitted(
    stops: Sequence[HeldStop], model: ForceModel, turns: Sequence[Turn], *, gravity: float
) -> RateModel:
    """The gyros from their turns, with the accelerometers' own uncertainty.

    What their model omits bends the frame of the gyros as what it has does.
    """
    gyro = fit_rates(turns)
    if model.dof < 1:
        return gyro
    forces = np.array([s.force for s in stops])
    whole = expanded(model)
    covariance = _with_tolerances(
        covariance_with_omitted(forces, model, gravity=gravity), PARAMETERS[model.level]
    )
    shifted = []
    for other in shifted_forces(whole, covariance):
        ups = other.corrected(forces)
        shifted.append(ups / np.linalg.norm(ups, axis=1)[:, None])
    spread = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return with_frame(gyro, turns, shifted, covariance / np.outer(spread, spread))


def _with_tolerances(covariance: Floats, count: int) -> Floats:
    """Covariance of the accelerometers, which are never worse than their makers leave them.

    ``count``: parameters of the model; what it omits has its tolerance in ``covariance`` already.
    """
    kinds = [ZERO_TOLERANCE] * 3 + [SCALE_TOLERANCE] * 3 + [CROSS_TOLERANCE] * 3
    sigma = np.array(kinds) / NORMAL_95
    held = np.zeros(sigma.size)
    held[: {4: 3}.get(count, count)] = 1.0
    unit = np.linalg.inv(covariance / np.outer(sigma, sigma) + 1e-12 * np.eye(sigma.size))
    return np.asarray(np.linalg.inv(unit + np.diag(held)) * np.outer(sigma, sigma))


def _directions(gyro: RateModel, turns: Sequence[Turn], pulled: Sequence[Turn]) -> dict[str, Any]:
    """How far the carried direction of gravity misses the felt one, by the model of the gyros."""
    return {
        "before_deg": math.degrees(gyro.rms_before),
        "after_deg": math.degrees(gyro.rms_after),
        "with_g_sensitivity_deg": math.degrees(fit_rates(pulled).rms_after) if pulled else None,
        "of": "angle between carried and felt direction after a turn, rms",
        "turns": len(turns),
    }


def force_model(forces: Floats, options: MultiPositionOptions) -> ForceModel:
    """The accelerometer model that predicts left-out stops best.

    Parameters
    ----------
    forces : ndarray, shape (n, 3)
        Outputs of the stops [m/s2].
    options : MultiPositionOptions
    """
    models = _force_models(forces, options.gravity)
    held = {m.level: left_out(forces, m, gravity=options.gravity) for m in models}
    return _chosen(models, held)


def _force_models(forces: Floats, gravity: float) -> list[ForceModel]:
    return [
        fit_forces(forces, level=level, gravity=gravity)
        for level in LEVELS
        if forces.shape[0] > PARAMETERS[level]
    ]


def _chosen(models: Sequence[ForceModel], held: dict[str, float | None]) -> ForceModel:
    """The model that predicts left-out stops best; the simplest where none can be left out."""
    known = [m for m in models if held[m.level] is not None]
    if not known:
        return models[0]
    return min(known, key=lambda m: held[m.level] or 0.0)


def _bias(
    stops: Sequence[HeldStop], model: ForceModel, options: MultiPositionOptions
) -> tuple[Floats, Floats]:
    """Bias of each gyro and its sigma from the scatter of the stops [rad/s]."""
    means = rest_rates(stops, ups_of(stops, model), options.latitude)
    sigma = means.std(axis=0, ddof=1) / math.sqrt(len(stops))
    return means.mean(axis=0), sigma * widened(len(stops) - 1)


def _stop_dict(log: SensorLog, stop: HeldStop, model: ForceModel) -> dict[str, Any]:
    size = float(np.linalg.norm(model.corrected(stop.force)))
    return {
        "start_s": float(log.columns["time_s"][stop.start]),
        "end_s": float(log.columns["time_s"][stop.stop - 1]),
        "force_m_s2": stop.force.tolist(),
        "rate_deg_s": np.degrees(stop.rate).tolist(),
        "gravity_m_s2": size,
    }


def _left_out(count: int) -> list[ResultWarning]:
    if not count:
        return []
    text = said(
        "{number} of the turns held a gap or a saturated gyro and took no part", number=count
    )
    return [ResultWarning("turns_left_out", text)]


def _warnings(
    log: SensorLog,
    model: ForceModel,
    gyro: RateModel | None,
    options: MultiPositionOptions,
) -> list[ResultWarning]:
    warnings = []
    if model.dof <= FEW_DOF or (gyro is not None and gyro.dof <= FEW_DOF):
        text = said(
            "few degrees of freedom: accelerometer {dof}, gyro {gyro}; the "
            "residuals say little of the fit",
            dof=model.dof,
            gyro=said("none") if gyro is None else gyro.dof,
        )
        warnings.append(ResultWarning("few_degrees_of_freedom", text))
    if options.latitude is None:
        text = (
            "no --latitude: the vertical earth rate (up to 15 deg/h, .0042 deg/s) stays in the "
            "rests and looks like a sensitivity to gravity"
        )
        warnings.append(ResultWarning("latitude_unknown", text))
    if log.clipped:
        names = ", ".join(f"{name} in {rows} rows" for name, rows in log.clipped.items())
        warnings.append(
            ResultWarning("saturated", said("at the end of their range: {names}", names=names))
        )
    text = said(
        "scale factors of the accelerometers refer to {gravity:.5f} m/s2; "
        "--gravity-m-s2 states the local one",
        gravity=options.gravity,
    )
    warnings.append(ResultWarning("gravity", text))
    return warnings
