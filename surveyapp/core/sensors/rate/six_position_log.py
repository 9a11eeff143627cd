"""``calibrate rate --programme six-position``: a table log to twelve parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from surveyapp.core.sensors.rate.gross_samples import gross_samples
from surveyapp.core.sensors.rate.parameters import (
    DEG_H,
    condition_of,
    gyro_parameters,
    undetermined,
)
from surveyapp.core.sensors.rate.position_log import (
    GYROS,
    Placed,
    label_problems,
    means_of,
    place_problems,
    placed_stretches,
    resting_of,
    sense_of,
    table_tilt,
    unit_problems,
)
from surveyapp.core.sensors.rate.six_position import (
    GyroTriad,
    PositionMeans,
    StaticMeans,
    solve_six_positions,
    traditional,
)
from surveyapp.core.sensors.rate.table_log import encoder_told, label, motion_of, sense_warnings
from surveyapp.core.sensors.rate.turning import about_turns
from surveyapp.core.statistics.distributions import chi_square_tail
from surveyapp.domain.calibration import (
    Calibration,
    Geometry,
    Misfit,
    SensorParameter,
    with_reasons,
)
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.constants import EARTH_RATE

WARM_UP_S = 1800.0
"""Warm-up that source 003 asks for before the first turn."""
SMOOTHED_S = 1.0


@dataclass(frozen=True, slots=True)
class SixPositionOptions:
    """What is stated beside the log.

    Parameters
    ----------
    flip_sigma : float
        Standard deviation of the seating about each body axis [rad]; 0 = not stated.
    relative_rate_sigma : float
        Of the table's rate.
    latitude : float or None
        [rad]; only needed where an axis was turned in one of its two positions.
    """

    flip_sigma: float = 0.0
    relative_rate_sigma: float = 0.0
    latitude: float | None = None


def calibrate_six_positions(log: SensorLog, options: SixPositionOptions) -> Calibration:
    """Twelve gyro parameters from a log.

    Raises
    ------
    SurveyError
        With everything that cannot be used.
    """
    problems = place_problems(log)
    motion = motion_of(log)
    if isinstance(motion, Problem):
        problems.append(motion)
    if problems or isinstance(motion, Problem):
        raise SurveyError(problems)
    rounds = (
        [label(log, "round", k, 1) for k in range(log.size)]
        if "round" in log.columns
        else ([1] * log.size)
    )
    placed, problems = placed_stretches(log, motion, rounds, ("position", "round"))
    if problems:
        raise SurveyError(problems)
    static, resting = resting_of(log, motion, placed)
    shown = means_of(log, placed, latitude=options.latitude)
    means, warnings, problems = sense_of(shown, where=log.path)
    used = [t for p in placed for t in p.turned]
    noted, wrong = encoder_told(log, motion, used, relative_rate_sigma=options.relative_rate_sigma)
    problems += [*wrong, *label_problems(resting, where=log.path)]
    problems += [] if problems else unit_problems(shown, where=log.path)
    if problems:
        raise SurveyError(problems)
    triad = _solve(means, options)
    parameters = with_reasons(gyro_parameters(triad), partial(_why, means=means))
    missing = undetermined(parameters)
    before, after = _misfits(means, triad)
    return Calibration(
        kind="six-position",
        source=log.id,
        parameters=parameters,
        before=before,
        after=after,
        geometry=Geometry(
            "good" if not missing else "restricted", condition_of(triad.matrix), missing
        ),
        warnings=(
            *log.warnings,
            *sense_warnings(motion, warnings),
            *noted,
            *gross_samples(log, used, GYROS),
            *_warnings(log, motion_begin_s(log, placed), options),
        ),
        met=not missing,
        n=sum(t.stretch.stop - t.stretch.start for t in used),
        sha256=log.sha256,
        extra={
            "steps": _steps(log, placed, table_tilt(resting)),
            "traditional": _traditional(static, means, triad, options),
            "repeatability": _repeatability(means, options),
        },
    )


def _solve(means: Sequence[PositionMeans], options: SixPositionOptions) -> GyroTriad:
    return solve_six_positions(
        means,
        flip_sigma=options.flip_sigma,
        relative_rate_sigma=options.relative_rate_sigma,
    )


def _why(name: str, *, means: Sequence[PositionMeans]) -> str:
    """Why a parameter has no value."""
    axis = name[-1]
    words = {m.position for m in means}
    if not words & {f"{axis}+", f"{axis}-"}:
        return said("no whole turns both ways with {axis} up or down", axis=axis)
    missing = next((w for w in (f"{axis}+", f"{axis}-") if w not in words), None)
    if missing is None:
        return said("less than a whole turn leaves the level earth rate in it")
    return said(
        "{axis} was turned in one position only and holds the vertical earth rate: turn {missing} "
        "too, or state the latitude",
        axis=axis,
        missing=missing,
    )


def _misfits(means: Sequence[PositionMeans], triad: GyroTriad) -> tuple[Misfit, Misfit]:
    """Slopes of the outputs against perfect gyros and against the calibrated ones [ppm]."""
    ideal, fitted = [], []
    matrix = np.where(np.isnan(triad.matrix), np.eye(3), triad.matrix)
    for one in means:
        ideal.append(one.column() - np.eye(3)[:, one.axis])
        fitted.append(one.column() - matrix[:, one.axis])
    return tuple(
        Misfit(
            math.sqrt(float(np.mean(np.square(rest)))) * 1e6, "ppm", said("output per table rate")
        )
        for rest in (ideal, fitted)
    )  # type: ignore[return-value]


def motion_begin_s(log: SensorLog, placed: Sequence[Placed]) -> float:
    """Seconds at rest before the first turning."""
    first = min(t.stretch.start for p in placed for t in p.turned)
    return float(log.columns["time_s"][first] - log.columns["time_s"][0])


def _warnings(log: SensorLog, warm_up_s: float, options: SixPositionOptions) -> list[ResultWarning]:
    warnings = []
    if warm_up_s < WARM_UP_S:
        text = said(
            "{value:.1f} min before the first turn; the source asks for 30", value=warm_up_s / 60.0
        )
        warnings.append(ResultWarning("short_warm_up", text))
    if options.flip_sigma == 0.0:
        text = (
            "no --flip-sigma-arcsec: how well the unit is seated after each flip is not in the "
            "sigmas of misalignment and scale factor; 1' about each axis is 42\" in a misalignment"
        )
        warnings.append(ResultWarning("no_flip_sigma", text))
    if options.relative_rate_sigma == 0.0:
        text = "no --table-rate-relative-sigma: the table's rate counts as exact"
        warnings.append(ResultWarning("no_table_rate_sigma", text))
    return warnings


def _steps(log: SensorLog, placed: Sequence[Placed], tilt: float | None) -> list[dict[str, Any]]:
    """What was done, in order: levelling, smoothing, and each stretch with its turns."""
    begin = motion_begin_s(log, placed)
    steps: list[dict[str, Any]] = [
        {
            "step": "levelling",
            "warm_up_s": begin,
            "tilt_arcsec": None if tilt is None else tilt / ARCSEC,
        },
        _smoothing(log, placed),
    ]
    for place in placed:
        steps += [
            {
                "step": "segment",
                "position": place.position,
                "round": place.group,
                "start_s": float(log.columns["time_s"][item.stretch.start]),
                "end_s": float(log.columns["time_s"][item.stretch.stop - 1]),
                "rate_deg_s": math.degrees(item.rate),
                "turns_recorded": item.recorded,
                "turns_used": item.stretch.turns if not item.whole else round(item.stretch.turns),
                "whole_turns": item.whole,
            }
            for item in place.turned
        ]
    return steps


def _smoothing(log: SensorLog, placed: Sequence[Placed]) -> dict[str, Any]:
    """Noise of a sample and of a smoothed second, on the first stretch."""
    item = placed[0].turned[0]
    count = max(round(SMOOTHED_S * (log.rate_hz or 1.0)), 1)
    sample, smoothed = [], []
    for name in GYROS:
        part = about_turns(item.stretch, log.columns[name])
        sample.append(item.mean(log.columns[name]).noise / DEG_H)
        whole = part[: part.size - part.size % count]
        means = whole.reshape(-1, count).mean(axis=1)
        smoothed.append(float(np.std(np.diff(means)) / math.sqrt(2.0)) / DEG_H)
    return {
        "step": "smoothing",
        "window_s": SMOOTHED_S,
        "sd_sample_deg_h": sample,
        "sd_smoothed_deg_h": smoothed,
    }


def _traditional(
    static: Sequence[StaticMeans],
    means: Sequence[PositionMeans],
    triad: GyroTriad,
    options: SixPositionOptions,
) -> dict[str, Any] | None:
    if not static:
        return None
    latitude = options.latitude
    found = traditional(
        static,
        means,
        triad=triad,
        level_rate=EARTH_RATE * (1.0 if latitude is None else math.cos(latitude)),
        seating=(options.flip_sigma, options.relative_rate_sigma),
    )
    parameters = [
        SensorParameter(f"scale_factor_{a}", v * 1e6, s * 1e6, "ppm")
        for a, (v, s) in found.scale.items()
    ]
    parameters += [
        SensorParameter(f"bias_{a}", v / DEG_H, s / DEG_H, "deg/h")
        for a, (v, s) in found.bias.items()
    ]
    text = (
        "biases at rest from two positions, scale factors from one: the level earth rate cancels "
        "only if both rests have one azimuth, and is in the sigma"
    )
    return {"method": text, "parameters": [p.to_dict() for p in parameters]}


def _repeatability(
    means: Sequence[PositionMeans], options: SixPositionOptions
) -> dict[str, Any] | None:
    """Scatter of the parameters from round to round against their stated sigma."""
    rounds = sorted({m.group for m in means})
    if len(rounds) < 2:
        return None
    single = [gyro_parameters(_solve([m for m in means if m.group == k], options)) for k in rounds]
    rows = []
    for cells in zip(*single, strict=True):
        values = np.array([c.value for c in cells if c.value is not None], dtype=np.float64)
        sigmas = np.array([c.sigma for c in cells if c.sigma is not None], dtype=np.float64)
        if values.size < 2 or sigmas.size < 2:
            continue
        sd, stated = float(np.std(values, ddof=1)), math.sqrt(float(np.mean(sigmas**2)))
        p = chi_square_tail((values.size - 1) * (sd / stated) ** 2, values.size - 1)
        rows.append({"name": cells[0].name, "sd": sd, "stated_sigma": stated, "p": p})
    level = 0.05 / max(len(rows), 1)
    verdict = "agrees" if all(r["p"] > level for r in rows) else "exceeds_model"
    return {"rounds": len(rounds), "verdict": verdict, "parameters": rows}
