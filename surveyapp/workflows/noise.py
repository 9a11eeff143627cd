"""Allan deviation and filters of a log: choose the columns, compute, name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from surveyapp.core.sensors.allan import AllanCurve, Estimator, allan_curve, octaves
from surveyapp.core.sensors.noise_coefficients import coefficients_of
from surveyapp.core.sensors.noise_units import named_coefficients
from surveyapp.domain.advance import PartDone, stage
from surveyapp.domain.noise import AllanChannel, AllanResult
from surveyapp.domain.sensor_log import SENSOR_COLUMNS, TEXT_COLUMNS, SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.sensor_logs.blocks import room_for
from surveyapp.io.sensor_logs.reading import LogFile, Need
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

FEWEST: Final = 9
"""Samples below which there is no Allan deviation at three times."""


def noise_columns(file: LogFile, column: str | None) -> tuple[str, ...]:
    """The columns that are asked for: one, else every sensor column, else every number.

    Raises
    ------
    SurveyError
        If there is no such column, or none at all.
    """
    where = file.request.where
    if column is not None:
        if column in file.places:
            return (column,)
        for canonical, place in file.places.items():
            if place.name == column:
                return (canonical,)
        hint = nearest_names(column, [*file.places, *file.layout.names])
        raise SurveyError(Problem("the file has no such column", where, column, "a column", hint))
    found = tuple(name for name in file.places if name in SENSOR_COLUMNS)
    if not found:
        found = tuple(
            n for n in file.places if n not in TEXT_COLUMNS and n not in ("time_s", "t", "t_s")
        )
    if not found:
        raise SurveyError(Problem("the log has no column of a sensor", where))
    return found


def read_columns(file: LogFile, names: tuple[str, ...], progress: PartDone | None) -> SensorLog:
    """Read columns of numbers with their times, all finite and varying."""
    canonical = tuple(n for n in names if n in SENSOR_COLUMNS)
    others = tuple(n for n in names if n not in SENSOR_COLUMNS)
    need = Need(columns=canonical, varying=names, others=others)
    log = file.read(need, progress=progress)
    if log.size < FEWEST:
        found, expected = (
            said("{size} rows", size=log.size),
            said("{fewest} rows or more", fewest=FEWEST),
        )
        raise SurveyError(Problem("the log is too short", log.path, found, expected))
    return log


def factors_of(log: SensorLog, taus: Sequence[float] | None) -> tuple[int, ...]:
    """Averaging factors of wanted times [s], or octaves.

    Raises
    ------
    SurveyError
        For times that are shorter than a sample or longer than half the record.
    """
    if taus is None:
        return octaves(log.size)
    rate = log.rate_hz or 1.0
    factors = []
    problems = []
    for tau in taus:
        m = round(tau * rate) if math.isfinite(tau * rate) else 0
        if m < 1 or 2 * m > log.size - 1:
            expected = said(
                "{value:g} to {value2:g} s", value=1.0 / rate, value2=(log.size - 1) // 2 / rate
            )
            problems.append(Problem("no averaging time", "taus", f"{tau:g}", expected))
        elif m not in factors:
            factors.append(m)
    if problems:
        raise SurveyError(problems)
    return tuple(factors)


def channel_of(
    name: str,
    unit: str,
    series: Floats,
    *,
    rate_hz: float,
    factors: tuple[int, ...],
    estimator: Estimator = "oadev",
    highest_hz: float | None = None,
    progress: PartDone | None = None,
) -> AllanChannel:
    """Curve and coefficients of one series; ``highest_hz`` as in ``coefficients_of``."""
    curve: AllanCurve = allan_curve(
        series,
        rate_hz=rate_hz,
        factors=factors,
        estimator=estimator,
        room=room_for,
        progress=stage(progress, 0.0, 0.7),
    )
    known = unit not in ("1", "LSB")
    found = None
    if known:
        found = coefficients_of(series, interval=1.0 / rate_hz, highest_hz=highest_hz)
    if progress is not None:
        progress(1.0)
    return AllanChannel(
        name=name,
        unit=unit,
        rate_hz=rate_hz,
        n=series.size,
        taus_s=tuple(curve.taus.tolist()),
        deviation=tuple(curve.deviation.tolist()),
        low=tuple(curve.low.tolist()),
        high=tuple(curve.high.tolist()),
        coefficients=named_coefficients(found, unit=unit),
    )


def uneven(log: SensorLog) -> list[ResultWarning]:
    """That the samples are taken as evenly spaced where they are not."""
    if log.gaps:
        text = "the samples beside a gap are taken as neighbours: cut the log at its gaps"
        return [ResultWarning("gaps_ignored", text)]
    if "time_s" in log.columns and log.size > 2:
        step = np.diff(log.columns["time_s"][: 1 << 20])
        if float(np.std(step)) > 0.2 * float(np.median(step)):
            text = "the interval of the samples varies; its mean is taken"
            return [ResultWarning("uneven_rate", text)]
    return []


def allan_of_log(
    file: LogFile,
    *,
    column: str | None = None,
    estimator: Estimator = "oadev",
    taus: Sequence[float] | None = None,
    progress: PartDone | None = None,
) -> AllanResult:
    """Allan deviation of the columns of a log.

    Raises
    ------
    SurveyError
        For columns or times that are not there, and for what is wrong with the log.
    """
    names = noise_columns(file, column)
    log = read_columns(file, names, stage(progress, 0.0, 0.5))
    factors = factors_of(log, taus)
    rate = log.rate_hz or 1.0
    warnings = [*log.warnings, *uneven(log)]
    channels = tuple(
        channel_of(
            name,
            log.units[name],
            log.columns[name],
            rate_hz=rate,
            factors=factors,
            estimator=estimator,
            progress=stage(progress, 0.5 + 0.5 * k / len(names), 0.5 + 0.5 * (k + 1) / len(names)),
        )
        for k, name in enumerate(names)
    )
    return AllanResult(log.id, estimator, channels, log.sha256, tuple(warnings))
