"""Hard and soft iron of a compass: the model chosen on held-out blocks, judged by the heading.

Models increase (none, centre, three scales, full symmetric); a richer one is chosen only if it
predicts held-out blocks significantly better. The gate is the sigma of a level heading.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from surveyapp.core.sensors.compass_models import (
    BLOCK_S,
    ModelTrial,
    block_rows,
    choose,
    try_model,
)
from surveyapp.core.sensors.ellipsoid import MODELS, SOFT, Ellipsoid
from surveyapp.core.sensors.heading_gate import heading_difference, heading_sigma, level_points
from surveyapp.domain.calibration import (
    Calibration,
    CalibrationModel,
    Geometry,
    GeometryVerdict,
    HeldOut,
    Misfit,
    SensorParameter,
)
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import counted, said
from surveyapp.languages.names import ids
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.heading import DEFAULT_DIP, dip_of

UNDERSTATED: Final = 2.0
"""Halves that differ by more than so many sigma show that the covariance understates itself."""

OFFSET_LIMIT_UT: Final = 2.0
"""Sigma of a hard iron up to which it counts as determined (levelling.md)."""

MOST_UNEQUAL: Final = 4.0
"""Scales of the axes that differ by more are units: one axis in mG beside uT is 10."""

LEAST_FIELD_UT, MOST_FIELD_UT = 15.0, 100.0
"""The field of the earth is 22 to 67 uT at the ground (IGRF-13)."""

FEWEST_ROWS: Final = 20
AZIMUTHS, BANDS = 12, 6
"""Cells of the picture of the coverage: equal in area."""


def calibrate_ellipsoid(log: SensorLog, *, limit: float) -> Calibration:
    """Calibrate a compass from a record without known headings.

    Parameters
    ----------
    log : SensorLog
        ``mag_*``, and ``acc_*`` where it was recorded: it tells the dip and nothing else.
    limit : float
        Largest sigma of a level heading that is accepted [rad].

    Returns
    -------
    Calibration
    """
    points = np.column_stack([log.columns[f"mag_{axis}_uT"] for axis in "xyz"])
    block = block_rows(log)
    if log.size < FEWEST_ROWS:
        return _refused_short(log, points)
    trials = [try_model(points, model, block) for model in MODELS]
    chosen = choose(points, trials)
    dip = record_dip(log, trials[chosen].fit)
    sigmas = [_judged(trial, dip) for trial in trials]
    chosen, sigma = _gate(trials, chosen, (sigmas, dip, limit))
    verdict, known = _verdict(trials[chosen], sigma, limit)
    if verdict != "refused":
        _refuse_other_units(trials[chosen].fit, log.path)
    return _result(log, points, (trials, chosen, sigmas), (verdict, known, sigma, dip))


def _refuse_other_units(fit: Ellipsoid, where: str) -> None:
    """Axes whose scales differ by more than iron can make them.

    Raises
    ------
    SurveyError
    """
    scales = np.diag(fit.soft)
    if float(scales.max()) <= MOST_UNEQUAL * float(scales.min()):
        return
    raise SurveyError(
        Problem(
            "mag_x/y/z are in different units",
            where,
            "scales " + ", ".join(f"{a} {1.0 / s:.3g}" for a, s in zip("xyz", scales, strict=True)),
            said(
                "scales within a factor of {most_unequal:g}: iron makes no more",
                most_unequal=MOST_UNEQUAL,
            ),
            "give each its own: `units` COLUMN=... or `scale` COLUMN=VALUE",
        )
    )


def _gate(
    trials: list[ModelTrial], chosen: int, judged: tuple[list[float], float, float]
) -> tuple[int, float]:
    """The model that is used, and the sigma that decides [rad].

    Soft iron that a record cannot see may still be there: the sigma of the full model decides,
    whatever was chosen. Where both differ by more than the limit, the full one is used.
    """
    sigmas, dip, limit = judged
    full = trials[-1]
    sigma = max(sigmas[-1], sigmas[chosen] if chosen > 0 else 0.0)
    if sigmas[-1] <= limit and chosen < len(trials) - 1:
        points = level_points(full.fit, dip)
        if heading_difference(trials[chosen].fit, full.fit, points) > limit:
            return len(trials) - 1, sigmas[-1]
    return chosen, sigma


def record_dip(log: SensorLog, best: Ellipsoid) -> float:
    """Inclination of the record [rad]; 65 degrees without specific force."""
    acc = log.vector("acc")
    if acc is None or not best.converged:
        return float(DEFAULT_DIP)
    points = np.column_stack([log.columns[f"mag_{axis}_uT"] for axis in "xyz"])
    usable = np.all(np.isfinite(acc), axis=1) & (np.linalg.norm(acc, axis=1) > 0.0)
    if not np.any(usable):
        return float(DEFAULT_DIP)
    dip = float(np.median(dip_of(best.corrected(points[usable]), acc[usable])))
    return float(np.clip(dip, -math.radians(85.0), math.radians(85.0)))


def _judged(trial: ModelTrial, dip: float) -> float:
    """Sigma of a level heading [rad]: the covariance, unless the halves contradict it."""
    sigma = heading_sigma(trial.fit, dip)
    if not math.isfinite(sigma):
        return math.inf
    half = heading_difference(*trial.halves, level_points(trial.fit, dip)) / 2.0
    return sigma if half <= UNDERSTATED * sigma else half


def _verdict(trial: ModelTrial, sigma: float, limit: float) -> tuple[GeometryVerdict, list[bool]]:
    """The verdict, and which of b, W and the field are determined (3 + 6 + 1)."""
    if sigma > limit:
        return "refused", [False] * 10
    fit = trial.fit
    spread = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    soft = soft_sigma(fit) * fit.field
    determined = [bool(s <= OFFSET_LIMIT_UT) for s in (*spread[:3], *soft)]
    determined.append(field_sigma(fit) <= OFFSET_LIMIT_UT)
    return ("good" if all(determined[:3]) else "restricted"), determined


def _soft_and_field(theta: Floats) -> Floats:
    """W (six terms) and the field as functions of theta, shape (7,)."""
    probe = Ellipsoid("full", theta, np.eye(9), np.eye(9), np.zeros(1), 0.0, 0.0, True)
    w = probe.soft
    return np.array([w[0, 0], w[1, 1], w[2, 2], w[0, 1], w[0, 2], w[1, 2], probe.field])


def _derived_covariance(fit: Ellipsoid) -> Floats:
    """Covariance of b, W and the field, shape (10, 10), by central differences of W and field."""
    jacobian = np.zeros((10, 9))
    jacobian[:3, :3] = np.eye(3)
    for k in range(3, 9):
        step = 1e-6 * max(abs(fit.theta[k]), 1.0 / fit.field)
        up, down = fit.theta.copy(), fit.theta.copy()
        up[k] += step
        down[k] -= step
        jacobian[3:, k] = (_soft_and_field(up) - _soft_and_field(down)) / (2.0 * step)
    return np.asarray(jacobian @ fit.covariance @ jacobian.T)


def soft_sigma(fit: Ellipsoid) -> Floats:
    """Standard deviations of the six terms of W, shape (6,)."""
    return np.sqrt(np.maximum(np.diag(_derived_covariance(fit))[3:9], 0.0))


def field_sigma(fit: Ellipsoid) -> float:
    """Standard deviation of the size of the field [uT]."""
    return float(np.sqrt(max(_derived_covariance(fit)[9, 9], 0.0)))


NAMES: Final = (
    *(f"hard_iron_{axis}" for axis in "xyz"),
    *(f"soft_iron_{place}" for place in SOFT),
    "field",
)
UNITS: Final = ("uT", "uT", "uT", *("1",) * 6, "uT")


def _parameters(fit: Ellipsoid, known: list[bool], *, refused: bool) -> tuple[SensorParameter, ...]:
    w, b = fit.soft, fit.offset
    values = [*b, w[0, 0], w[1, 1], w[2, 2], w[0, 1], w[0, 2], w[1, 2], fit.field]
    covariance = _derived_covariance(fit)
    absent = _absent(fit.model)
    found = []
    for index, (name, unit) in enumerate(zip(NAMES, UNITS, strict=True)):
        if not known[index]:
            why = "refused" if refused else "sigma_above_2_uT"
            found.append(SensorParameter(name, None, None, unit, why))
        elif absent[index]:
            found.append(SensorParameter(name, round(float(values[index]), 12), None, unit))
        else:
            sigma = float(np.sqrt(covariance[index, index]))
            found.append(SensorParameter(name, float(values[index]), sigma, unit))
    return tuple(found)


def _absent(model: str) -> list[bool]:
    """Which of the ten parameters a model does not hold."""
    hard, scale, cross = model == "none", model in ("none", "centre"), model != "full"
    return [hard] * 3 + [scale] * 3 + [cross] * 3 + [False]


def _result(
    log: SensorLog,
    points: Floats,
    found: tuple[list[ModelTrial], int, list[float]],
    judged: tuple[GeometryVerdict, list[bool], float, float],
) -> Calibration:
    trials, chosen, sigmas = found
    verdict, known, sigma, dip = judged
    fit, plain = trials[chosen].fit, trials[0]
    parameters = _parameters(fit, known, refused=verdict == "refused")
    undetermined = tuple(p.name for p in parameters if p.value is None)
    models = _models(trials, None if verdict == "refused" else chosen)
    cells = coverage_cells(points - fit.offset)
    refused = verdict == "refused"
    return Calibration(
        kind="compass",
        source=log.id,
        parameters=parameters,
        before=Misfit(plain.fit.rms, "uT", said("size of the field")),
        after=Misfit(None if refused else fit.rms, "uT", said("distance from the ellipsoid")),
        geometry=Geometry(
            verdict,
            fit.condition if math.isfinite(fit.condition) else None,
            undetermined,
            math.degrees(sigma) if math.isfinite(sigma) else None,
            float(np.count_nonzero(cells)) / cells.size,
        ),
        held_out=HeldOut(
            said(
                "contiguous blocks of {rows} rows (about {seconds:g} s), two halves "
                "fitted alternately",
                rows=block_rows(log),
                seconds=BLOCK_S,
            ),
            plain.held_rms,
            None if refused else trials[chosen].held_rms,
            "uT",
        ),
        models=models,
        warnings=(*log.warnings, *_warnings(log, trials, (chosen, verdict))),
        met=not refused,
        n=log.size,
        sha256=log.sha256,
        extra={
            "dip_deg": math.degrees(dip),
            "heading_sigma_by_model": {
                t.fit.model: math.degrees(s) if math.isfinite(s) else None
                for t, s in zip(trials[1:], sigmas[1:], strict=True)
            },
            "coverage_cells": cells.tolist(),
        },
        constants={} if refused else _constants(fit, dip, sigma) | _reach(log, verdict),
        notes=_notes(log, verdict),
        temperature_c=log.temperature_span_c(),
    )


def _models(trials: Sequence[ModelTrial], chosen: int | None) -> tuple[CalibrationModel, ...]:
    of = said("distance from the ellipsoid")
    return tuple(
        CalibrationModel(trial.fit.model, trial.fit.rms, trial.held_rms, index == chosen, "uT", of)
        for index, trial in enumerate(trials)
    )


def _constants(fit: Ellipsoid, dip: float, sigma: float) -> dict[str, float]:
    """What corrects a reading whatever is determined by itself: b, W, field and their sigma."""
    w = fit.soft
    numbers = [*fit.offset, w[0, 0], w[1, 1], w[2, 2], w[0, 1], w[0, 2], w[1, 2], fit.field]
    found = {f"used_{name}": float(v) for name, v in zip(NAMES, numbers, strict=True)}
    return found | {
        "dip_deg": math.degrees(dip),
        "heading_sigma_deg": math.degrees(sigma),
        "reading_sigma_uT": fit.sigma0,
    }


def _reach(log: SensorLog, verdict: GeometryVerdict) -> dict[str, float]:
    """The largest tilt of a restricted record [deg], where the specific force tells it."""
    acc = log.vector("acc")
    if verdict != "restricted" or acc is None:
        return {}
    share = acc[:, 2] / np.linalg.norm(acc, axis=1)
    return {"largest_tilt_deg": math.degrees(math.acos(np.clip(float(share.min()), -1.0, 1.0)))}


def _notes(log: SensorLog, verdict: GeometryVerdict) -> dict[str, str]:
    if verdict != "restricted":
        return {}
    text = said("holds only for tilts like those of its record")
    for tilt in _reach(log, verdict).values():
        text += said(": up to {tilt:.1f} degrees", tilt=tilt)
    return {"restricted": text}


def coverage_cells(directions: Floats) -> Floats:
    """Readings in each of 6 by 12 cells of equal area, from up to down, shape (6, 12)."""
    size = np.linalg.norm(directions, axis=1)
    height = directions[:, 2] / np.where(size > 0.0, size, 1.0)
    band = np.clip(((1.0 - height) / 2.0 * BANDS).astype(int), 0, BANDS - 1)
    around = np.arctan2(directions[:, 1], directions[:, 0]) % (2.0 * np.pi)
    azimuth = np.clip((around / (2.0 * np.pi) * AZIMUTHS).astype(int), 0, AZIMUTHS - 1)
    cells = np.zeros((BANDS, AZIMUTHS))
    np.add.at(cells, (band, azimuth), 1.0)
    return cells


def _warnings(
    log: SensorLog, trials: list[ModelTrial], outcome: tuple[int, GeometryVerdict]
) -> list[ResultWarning]:
    chosen, verdict = outcome
    found = []
    if verdict == "refused":
        text = (
            "the record does not determine the heading: turn the compass through more attitudes, "
            "upside down as well; where it was, something disturbed it: diagnose the log"
        )
        found.append(ResultWarning("geometry", text))
    elif verdict == "restricted":
        text = "the hard iron is not determined in each axis: valid only for tilts of the record"
        found.append(ResultWarning("restricted", text))
    elif chosen == 0:
        text = "no iron is found: no model predicts held-out blocks better than the raw readings"
        found.append(ResultWarning("no_iron", text))
    fit = trials[chosen].fit
    if verdict != "refused" and not LEAST_FIELD_UT <= fit.field <= MOST_FIELD_UT:
        text = said(
            "the field of the record is {field:.4g} uT and that of the earth 22 to 67 uT: are unit "
            "and scale right, or was it taken beside iron?",
            field=fit.field,
        )
        found.append(ResultWarning("field_size", text))
    failed = [t.fit.model for t in trials if not t.fit.converged]
    if failed:
        text = said("no ellipsoid could be fitted with: {names}", names=ids(failed))
        found.append(ResultWarning("no_ellipsoid", text))
    if log.vector("acc") is None:
        text = "without specific force the dip is taken as 65 degrees"
        found.append(ResultWarning("dip_assumed", text))
    elif trials[chosen].fit.converged and record_dip(log, trials[chosen].fit) < 0.0:
        text = (
            "the field points upwards, as it does south of the magnetic equator: elsewhere acc_* "
            "is gravity and not specific force (+g on the axis that is up); --scale COLUMN=-1"
        )
        found.append(ResultWarning("field_points_up", text))
    return found


def _refused_short(log: SensorLog, points: Floats) -> Calibration:
    size = np.linalg.norm(points, axis=1)
    text = counted(
        "{count} row is too few: {fewest_rows} are the least for nine parameters",
        "{count} rows are too few: {fewest_rows} are the least for nine parameters",
        count=log.size,
        fewest_rows=FEWEST_ROWS,
    )
    return Calibration(
        kind="compass",
        source=log.id,
        parameters=tuple(
            SensorParameter(n, None, None, u) for n, u in zip(NAMES, UNITS, strict=True)
        ),
        before=Misfit(float(np.std(size)), "uT", said("size of the field")),
        after=Misfit(None, "uT", said("distance from the ellipsoid")),
        geometry=Geometry("refused", None, NAMES),
        warnings=(*log.warnings, ResultWarning("too_few_rows", text)),
        met=False,
        n=log.size,
        sha256=log.sha256,
    )
