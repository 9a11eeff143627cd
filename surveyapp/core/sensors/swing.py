"""Swing of a compass: deviation of the uncorrected heading against known headings, A to E."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from surveyapp.core.sensors.compass_axes import refuse_mirrored
from surveyapp.core.sensors.linear import LinearFit, alternate_blocks, fit_linear, rms
from surveyapp.domain.calibration import (
    Calibration,
    CalibrationModel,
    Geometry,
    HeldOut,
    Misfit,
    SensorParameter,
)
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.deviation import COEFFICIENTS, deviation_basis
from surveyapp_models.compass.heading import heading_of

NAMES: Final = tuple(f"deviation_{letter}" for letter in COEFFICIENTS)
BLOCK_S: Final = 2.0
FEWEST_HEADINGS: Final = 8
RADIANS: Final = 6.2832
WHOLE_CIRCLE: Final = 5.0
"""Condition of A to E above which arcs of the circle are missing; 1 = evenly swung."""

LEVEL_LIMIT_DEG: Final = 45.0
"""A swing turns a carrier near level: up is within so many degrees of z."""


def shown_heading(log: SensorLog) -> Floats:
    """Uncorrected heading, tilt-compensated where the specific force was recorded [rad].

    Raises
    ------
    SurveyError
        If the specific force does not point along +z: axes exchanged, or z down.
    """
    field = np.column_stack([log.columns[f"mag_{axis}_uT"] for axis in "xyz"])
    acc = log.vector("acc")
    if acc is not None:
        refuse_swapped(acc, log.path)
    return heading_of(field, acc)


def refuse_swapped(acc: Floats, where: str) -> None:
    """Refuse a level record whose mean specific force is not along +z.

    Raises
    ------
    SurveyError
    """
    mean = acc.mean(axis=0)
    tilt = math.degrees(math.acos(np.clip(mean[2] / np.linalg.norm(mean), -1.0, 1.0)))
    if tilt <= LEVEL_LIMIT_DEG:
        return
    axis = int(np.argmax(np.abs(mean)))
    name = f"{'+' if mean[axis] > 0.0 else '-'}{'xyz'[axis]}"
    raise SurveyError(
        Problem(
            "the axes are exchanged or reversed: gravity is not on the z axis",
            where,
            said(
                "mean specific force ({mean:.2f}, {mean2:.2f}, {mean3:.2f}) m/s2: up is {name}",
                mean=mean[0],
                mean2=mean[1],
                mean3=mean[2],
                name=name,
            ),
            "+g on the z axis, which points up; axes right-handed",
            "exchange the columns with `columns`; `scale` COLUMN=-1 reverses one "
            "(acc and mag alike)",
        )
    )


def calibrate_swing(log: SensorLog, *, limit: float) -> Calibration:
    """Deviation coefficients of a swing.

    Parameters
    ----------
    log : SensorLog
        ``mag_*``, ``heading_deg`` (known MAGNETIC heading), and ``acc_*`` where recorded.
    limit : float
        Largest sigma of a corrected heading that is accepted [rad].

    Returns
    -------
    Calibration

    Raises
    ------
    SurveyError
        If the axes are exchanged.
    """
    psi = np.radians(log.columns["heading_deg"])
    shown = shown_heading(log)
    refuse_mirrored(psi, shown, log.path)
    deviation = (psi - shown + np.pi) % (2.0 * np.pi) - np.pi
    middle = math.atan2(float(np.mean(np.sin(deviation))), float(np.mean(np.cos(deviation))))
    deviation = middle + (deviation - middle + np.pi) % (2.0 * np.pi) - np.pi
    design = deviation_basis(psi)
    fit = fit_linear(design, deviation, correlated=True)
    sigma = math.inf if fit is None else _heading_sigma(fit)
    return _result(log, (psi, deviation, design), fit, (sigma, limit))


def _heading_sigma(fit: LinearFit) -> float:
    basis = deviation_basis(np.radians(np.arange(0.0, 360.0, 10.0)))
    return float(np.sqrt(np.max(np.sum((basis @ fit.covariance) * basis, axis=1))))


def _result(
    log: SensorLog,
    data: tuple[Floats, Floats, Floats],
    fit: LinearFit | None,
    gate: tuple[float, float],
) -> Calibration:
    psi, deviation, design = data
    sigma, limit = gate
    met = fit is not None and sigma <= limit
    parameters = tuple(
        SensorParameter(
            name,
            math.degrees(float(fit.x[i])) if fit is not None and met else None,
            math.degrees(float(fit.sigma[i])) if fit is not None and met else None,
            "deg",
        )
        for i, name in enumerate(NAMES)
    )
    rate = log.rate_hz if log.rate_hz is not None else 1.0
    block = max(min(round(BLOCK_S * rate), log.size // 10), 1)
    held, plain = _held_out(design, deviation, block), math.degrees(rms(deviation))
    after = math.degrees(fit.rms) if fit is not None and met else None
    cells = np.histogram(psi % (2.0 * np.pi), bins=12, range=(0.0, 2.0 * np.pi))[0]
    of = said("known minus corrected heading")
    return Calibration(
        kind="swing",
        source=log.id,
        parameters=parameters,
        before=Misfit(plain, "deg", said("known minus shown heading")),
        after=Misfit(after, "deg", of),
        geometry=Geometry(
            "good" if met else "refused",
            None if fit is None else fit.condition,
            () if met else NAMES,
            math.degrees(sigma) if math.isfinite(sigma) else None,
            float(np.count_nonzero(cells)) / cells.size,
        ),
        held_out=HeldOut(
            said("contiguous blocks of {rows} rows, two halves fitted alternately", rows=block),
            plain,
            held,
            "deg",
        ),
        models=(
            CalibrationModel("none", plain, plain, not met, "deg", of),
            CalibrationModel("A_to_E", after, held, met, "deg", of),
        ),
        warnings=(*log.warnings, *_warnings(log, fit, gate), *odd_headings(log, met=met)),
        met=met,
        n=log.size,
        sha256=log.sha256,
        covariance=_degrees_covariance(fit) if met else None,
        extra={"coverage_cells": [cells.tolist()]},
        constants={} if fit is None or not met else _constants(fit, sigma),
        temperature_c=log.temperature_span_c(),
    )


def _constants(fit: LinearFit, sigma: float) -> dict[str, float]:
    """Largest sigma of the correction, and the scatter of one heading about it [deg]."""
    return {
        "heading_sigma_deg": math.degrees(sigma),
        "reading_sigma_deg": math.degrees(fit.sigma0),
    }


def _degrees_covariance(fit: LinearFit | None) -> tuple[tuple[float, ...], ...] | None:
    if fit is None:
        return None
    scaled = fit.covariance * math.degrees(1.0) ** 2
    return tuple(tuple(float(v) for v in row) for row in scaled)


def _held_out(design: Floats, deviation: Floats, block: int) -> float | None:
    left = np.full(deviation.size, np.nan)
    for used, held in alternate_blocks(deviation.size, block):
        half = fit_linear(design[used], deviation[used])
        if half is None:
            return None
        left[held] = deviation[held] - design[held] @ half.x
    return math.degrees(rms(left))


def odd_headings(log: SensorLog, *, met: bool) -> list[ResultWarning]:
    """Known headings beyond a turn are taken modulo 360; what else they may be is told."""
    known = log.columns["heading_deg"]
    low, high = float(known.min()), float(known.max())
    found = []
    if low < -360.0 or high > 360.0:
        text = said(
            "heading_deg runs from {low:g} to {high:g} degrees: whole turns are taken off; gon "
            "take `units` heading_deg=gon, counts `scale`",
            low=low,
            high=high,
        )
        found.append(ResultWarning("heading_beyond_a_turn", text))
    elif not met and log.size >= FEWEST_HEADINGS and high - low > 3.0 and high <= RADIANS:
        text = said(
            "heading_deg runs from {low:g} to {high:g}: are these radians? `units` heading_deg=rad",
            low=low,
            high=high,
        )
        found.append(ResultWarning("heading_in_radians", text))
    return found


def _why_refused(fit: LinearFit | None, gate: tuple[float, float]) -> str:
    """The circle is not swung through, or the readings scatter too much for the headings."""
    sigma, limit = gate
    if fit is None or fit.condition > WHOLE_CIRCLE:
        return said("the headings do not determine A to E: swing through the whole circle")
    return said(
        "a corrected heading would have a sigma of {sigma:.2f} degrees, more than {limit:g}: the "
        "headings scatter by {rms:.2f} degrees about A to E over {rows} rows; swing again with "
        "more headings, away from iron, and look for a wrong known heading",
        sigma=math.degrees(sigma),
        limit=math.degrees(limit),
        rms=math.degrees(fit.rms),
        rows=fit.residual.size,
    )


def _warnings(
    log: SensorLog, fit: LinearFit | None, gate: tuple[float, float]
) -> list[ResultWarning]:
    met = fit is not None and gate[0] <= gate[1]
    found = []
    if not met:
        found.append(ResultWarning("geometry", _why_refused(fit, gate)))
    if fit is not None and fit.inflation > 1.0:
        text = said(
            "neighbouring deviations resemble each other; sigmas widened {inflation:.2f} x",
            inflation=fit.inflation,
        )
        found.append(ResultWarning("correlated", text))
    if log.vector("acc") is None:
        text = "no specific force: the headings are taken as level, not tilt-compensated"
        found.append(ResultWarning("not_tilt_compensated", text))
    return found
