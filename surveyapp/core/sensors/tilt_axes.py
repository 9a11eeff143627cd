"""Two-axis tilt sensor against a reference: zero, scale, cross axis and temperature of each axis.

reading = zero + scale * own + cross * other + temperature * (T - T0), all tilts in arc-seconds:
small tilts, so that the axes do not mix by rotation (10 arc-minutes twice mix by .9"/600").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.sensors.linear import Array, LinearFit, alternate_blocks, fit_linear, rms
from surveyapp.core.statistics.distributions import student_quantile
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

AXES: Final = ("along", "across")
TERMS: Final = ("zero", "scale", "cross", "temperature")
UNITS: Final = {"zero": "arcsec", "scale": "1", "cross": "1", "temperature": "arcsec/K"}
FEWEST_ROWS: Final = 5
SCALES: Final = (0.2, 5.0)
"""A scale factor beyond these is another unit: arc-minutes, degrees, counts."""

BLOCK_ROWS: Final = 7
"""Rows of a held-out block (levelling.md: tilt 7 rows)."""

FEW_DOF: Final = 5
"""Below so many degrees of freedom sigma itself is known to worse than a third."""

GROSS: Final = 5.0
"""Residuals beyond so many sigma are told; the diagnosis names them."""


@dataclass(frozen=True, slots=True)
class AxisFit:
    """One axis: the fit, the terms it holds, and the rms of held-out rows without and with them."""

    axis: str
    terms: tuple[str, ...]
    fit: LinearFit
    plain: LinearFit
    held_before: float
    held_after: float


def calibrate_tilt_axes(log: SensorLog, *, reference_temperature_c: float = 20.0) -> Calibration:
    """Calibrate both axes of a tilt sensor.

    Parameters
    ----------
    log : SensorLog
        ``tilt_along_arcsec``, ``tilt_across_arcsec``, ``ref_along_arcsec``,
        ``ref_across_arcsec``, and ``temperature_c`` where it was recorded.
    reference_temperature_c : float
        At which the zeros hold.

    Returns
    -------
    Calibration

    Raises
    ------
    SurveyError
        If the references do not determine zero, scale and cross axis, or the axes are exchanged.
    """
    temperature = log.columns.get("temperature_c")
    theta = None
    if temperature is not None and not bool(np.all(np.isnan(temperature))):
        _refuse_gaps(log, temperature)
        theta = temperature - reference_temperature_c if np.ptp(temperature) > 0.0 else None
    fits = [_fit_axis(log, axis, theta) for axis in AXES]
    _refuse_exchanged(log, fits)
    _refuse_other_unit(log, fits)
    return _result(log, fits, theta, reference_temperature_c)


def _fit_axis(log: SensorLog, axis: str, theta: Array | None) -> AxisFit:
    other = AXES[1 - AXES.index(axis)]
    reading = log.columns[f"tilt_{axis}_arcsec"]
    own, across = log.columns[f"ref_{axis}_arcsec"], log.columns[f"ref_{other}_arcsec"]
    columns = [np.ones(log.size), own, across]
    if theta is not None:
        columns.append(theta)
    design = np.column_stack(columns)
    fit = fit_linear(design, reading, correlated=True)
    if fit is None and theta is not None:
        design = design[:, :3]
        fit = fit_linear(design, reading, correlated=True)
    plain = fit_linear(design[:, :2], reading)
    if fit is None or plain is None or log.size < FEWEST_ROWS:
        raise SurveyError(
            Problem(
                said("the references do not determine the axis {axis}", axis=axis),
                log.path,
                said("{size} rows; the references follow one line or stand still", size=log.size),
                "tilts along and across that vary independently, five rows or more",
            )
        )
    before, after = _held_out(design[:, :2], reading), _held_out(design, reading)
    return AxisFit(axis, TERMS[: design.shape[1]], fit, plain, before, after)


def _held_out(design: Array, reading: Array) -> float:
    """Rms of rows that had no part in the fit, two halves of contiguous blocks."""
    left = np.full(reading.size, np.nan)
    for used, held in alternate_blocks(reading.size, BLOCK_ROWS):
        fit = fit_linear(design[used], reading[used])
        if fit is None:
            continue
        left[held] = reading[held] - design[held] @ fit.x
    return rms(left[np.isfinite(left)]) if np.any(np.isfinite(left)) else float("nan")


def _refuse_exchanged(log: SensorLog, fits: list[AxisFit]) -> None:
    """Both axes follow the reference of the other one: the columns are exchanged."""
    if all(abs(f.fit.x[2]) > abs(f.fit.x[1]) for f in fits):
        found = ", ".join(f"{f.axis}: own {f.fit.x[1]:.3f}, other {f.fit.x[2]:.3f}" for f in fits)
        raise SurveyError(
            Problem(
                "the axes along and across are exchanged",
                log.path,
                found,
                "readings that follow the reference of their own axis",
                "exchange the two columns with `columns`",
            )
        )


def _refuse_other_unit(log: SensorLog, fits: list[AxisFit]) -> None:
    """A reading that changes by another unit than its reference."""
    problems = []
    for item in fits:
        scale = abs(float(item.fit.x[1]))
        if SCALES[0] <= scale <= SCALES[1]:
            continue
        hint = said(
            "`units` COLUMN=... for tilt_{axis}_arcsec, or `scale` for counts", axis=item.axis
        )
        problems.append(
            Problem(
                said("the axis {axis} is in another unit than its reference", axis=item.axis),
                log.path,
                said("it changes by {scale:.4g} for each arc-second of the reference", scale=scale),
                said("{scales:g} to {scales2:g}", scales=SCALES[0], scales2=SCALES[1]),
                hint,
            )
        )
    if problems:
        raise SurveyError(problems)


def _refuse_gaps(log: SensorLog, temperature: Array) -> None:
    missing = int(np.count_nonzero(np.isnan(temperature)))
    if missing:
        raise SurveyError(
            Problem(
                "temperature_c is not a number in some rows",
                log.path,
                said("{missing} of {size} rows", missing=missing, size=log.size),
                "a temperature in each row, or no such column",
                "leave these rows out",
            )
        )


def _result(
    log: SensorLog, fits: list[AxisFit], theta: Array | None, reference_c: float
) -> Calibration:
    parameters = []
    for term in TERMS:
        for item in fits:
            value = sigma = None
            if term in item.terms:
                index = item.terms.index(term)
                value, sigma = float(item.fit.x[index]), float(item.fit.sigma[index])
            why = "no_temperature" if value is None else None
            parameters.append(
                SensorParameter(f"{term}_{item.axis}", value, sigma, UNITS[term], why)
            )
    undetermined = tuple(p.name for p in parameters if p.value is None)
    raw = np.concatenate(
        [log.columns[f"tilt_{a}_arcsec"] - log.columns[f"ref_{a}_arcsec"] for a in AXES]
    )
    after = rms(np.concatenate([item.fit.residual for item in fits]))
    plain = rms(np.concatenate([item.plain.residual for item in fits]))
    held = HeldOut(
        said(
            "contiguous blocks of {rows} rows, two halves fitted alternately; before = zero "
            "and scale only",
            rows=BLOCK_ROWS,
        ),
        _finite(rms(np.array([item.held_before for item in fits]))),
        _finite(rms(np.array([item.held_after for item in fits]))),
        "arcsec",
    )
    residuals = said("residuals of both axes")
    return Calibration(
        kind="tilt",
        source=log.id,
        parameters=tuple(parameters),
        before=Misfit(rms(raw), "arcsec", said("reading minus reference")),
        after=Misfit(after, "arcsec", residuals),
        geometry=Geometry(
            "restricted" if undetermined else "good",
            max(item.fit.condition for item in fits),
            undetermined,
        ),
        held_out=held,
        models=(
            CalibrationModel("zero_and_scale", plain, held.before, False, "arcsec", residuals),
            CalibrationModel("all_terms", after, held.after, True, "arcsec", residuals),
        ),
        warnings=(*log.warnings, *_warnings(log, fits, theta)),
        n=log.size,
        sha256=log.sha256,
        covariance=_covariance(fits),
        temperature_c=log.temperature_span_c(),
        constants=_constants(log, fits, reference_c),
    )


def _constants(log: SensorLog, fits: list[AxisFit], reference_c: float) -> dict[str, float]:
    """What belongs to the parameters: where the zeros hold, noise of a reading, largest reading."""
    readings = [np.abs(log.columns[f"tilt_{a}_arcsec"]) for a in AXES]
    return {
        "reference_temperature_c": reference_c,
        "reading_sigma_arcsec": max(item.fit.sigma0 for item in fits),
        "largest_reading_arcsec": max(float(values.max()) for values in readings),
    }


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _covariance(fits: list[AxisFit]) -> tuple[tuple[float, ...], ...]:
    """Of the determined parameters in their order: term by term, along before across."""
    names = [(t, i) for t in TERMS for i, item in enumerate(fits) if t in item.terms]
    matrix = np.zeros((len(names), len(names)))
    for row, (term, axis) in enumerate(names):
        for column, (other, other_axis) in enumerate(names):
            if axis == other_axis:
                item = fits[axis]
                matrix[row, column] = item.fit.covariance[
                    item.terms.index(term), item.terms.index(other)
                ]
    return tuple(tuple(float(v) for v in row) for row in matrix)


def _warnings(
    log: SensorLog, fits: list[AxisFit], theta: Array | None
) -> tuple[ResultWarning, ...]:
    found = []
    if theta is None or any("temperature" not in item.terms for item in fits):
        text = (
            "the temperature is not recorded or does not vary: its coefficients stay undetermined"
        )
        found.append(ResultWarning("no_temperature", text))
    dof = min(item.fit.dof for item in fits)
    if dof < FEW_DOF:
        text = said(
            "{rows} rows leave few degrees of freedom, {dof}: a 95 % interval is {factor:.2g} "
            "sigma, and none of them tells whether the model holds; take more rows",
            rows=log.size,
            dof=dof,
            factor=student_quantile(0.975, max(dof, 1)),
        )
        found.append(ResultWarning("few_rows", text))
    for item in fits:
        if item.fit.x[1] < 0.0:
            text = said(
                "the axis {axis} reads against its reference: its sign is reversed", axis=item.axis
            )
            found.append(ResultWarning("reversed_axis", text))
        if item.fit.inflation > 1.0:
            text = said(
                "neighbouring residuals of the axis {axis} resemble each other; its "
                "sigmas are widened {inflation:.2f} times",
                axis=item.axis,
                inflation=item.fit.inflation,
            )
            found.append(ResultWarning("correlated", text))
        gross = int(np.count_nonzero(np.abs(item.fit.residual) > GROSS * item.fit.sigma0))
        if gross:
            text = said(
                "{gross} residuals of the axis {axis} are larger than {gross2:g} "
                "sigma: diagnose the log",
                gross=gross,
                axis=item.axis,
                gross2=GROSS,
            )
            found.append(ResultWarning("gross_errors", text))
    del log
    return tuple(found)
