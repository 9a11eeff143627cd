"""A filter on a column of a log: Allan deviation and coefficients before and after, and its lag."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from surveyapp.core.sensors.allan import octaves
from surveyapp.core.sensors.filters import (
    BLOCK,
    FILTERS,
    LOST,
    Filtered,
    FilterName,
    LocalLevel,
    run_filter,
    step_lag,
)
from surveyapp.domain.advance import PartDone, stage
from surveyapp.domain.columns import pieces
from surveyapp.domain.noise import AllanChannel, FilterResult
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.io.sensor_logs.blocks import room_for
from surveyapp.io.sensor_logs.reading import LogFile
from surveyapp.languages import said
from surveyapp.workflows.noise import channel_of, noise_columns, read_columns, uneven
from surveyapp_models.arrays import Floats

STEP_SIGMAS = (2.0, 20.0)
LONGEST_LAG = 20_000

PASS_BAND = 0.1
"""Share of the corner frequency, gain / (2 pi), up to which a filter leaves a series as it is."""


def filter_log(
    file: LogFile,
    *,
    name: str,
    column: str | None,
    q: float | None,
    r: float | None,
    seed: int = 1,
    progress: PartDone | None = None,
) -> tuple[FilterResult, dict[str, Floats]]:
    """Filter one column.

    Parameters
    ----------
    file : LogFile
    name : str
        kalman, sage-husa or particle.
    column : str or None
        None where the log has one sensor column only.
    q, r : float or None
        Variances [unit of the column squared, per sample]; by default r from the differences of
        neighbouring readings, and q = r / 1000.
    seed : int
        Of the particle filter and of the step test.
    progress : callable, optional

    Returns
    -------
    tuple of FilterResult, dict of str to ndarray
        The result, and the times of the log with the raw and the filtered series by column.

    Raises
    ------
    SurveyError
        For an unknown filter or column, and for variances that are not positive.
    """
    model_name = _known(name)
    names = _one_column(file, column)
    log = read_columns(file, names, stage(progress, 0.0, 0.5))
    series, unit = log.columns[names[0]], log.units[names[0]]
    model = _model(series, (q, r), seed)
    rng = np.random.default_rng(seed)
    filtered = run_filter(
        model_name, series, model, rng, room=room_for, progress=stage(progress, 0.5, 0.8)
    )
    rate = log.rate_hz or 1.0
    before, after = _channels(
        (names[0], unit), (series, filtered.estimate), (rate, model), stage(progress, 0.8, 0.96)
    )
    lags = _lags(model_name, model, seed)
    if progress is not None:
        progress(1.0)
    warnings = [*log.warnings, *uneven(log), *_warnings(filtered, lags)]
    result = FilterResult(
        filter=model_name,
        column=names[0],
        source=log.id,
        unit=unit,
        q=model.q,
        r=model.r,
        before=before,
        after=_told(after),
        deviation_ratio=tuple(
            a / b if b > 0.0 else math.inf
            for a, b in zip(after.deviation, before.deviation, strict=True)
        ),
        step_lag_90_samples=lags,
        divergence=_divergence(filtered, rate),
        resamplings=filtered.resamplings,
        seed=seed,
        warnings=tuple(warnings),
    )
    times = log.columns.get("time_s")
    if times is None:
        times = np.arange(series.size) / rate
    return result, {
        "time_s": times,
        names[0]: series,
        f"filtered_{names[0]}": filtered.estimate,
    }


def _channels(
    named: tuple[str, str],
    both: tuple[Floats, Floats],
    known: tuple[float, LocalLevel],
    progress: PartDone | None,
) -> tuple[AllanChannel, AllanChannel]:
    """Allan deviation of a series and of what a filter made of it."""
    rate, model = known
    pass_band = PASS_BAND * model.steady_gain * rate / (2.0 * math.pi)
    made = [
        channel_of(
            *named,
            series,
            rate_hz=rate,
            factors=octaves(series.size),
            highest_hz=highest_hz,
            progress=stage(progress, 0.5 * k, 0.5 * k + 0.5),
        )
        for k, (series, highest_hz) in enumerate(zip(both, (None, pass_band), strict=True))
    ]
    return made[0], made[1]


def _one_column(file: LogFile, column: str | None) -> tuple[str, ...]:
    names = noise_columns(file, column)
    if len(names) > 1:
        hint = said("`column` C, one of: {names}", names=", ".join(names))
        raise SurveyError(Problem("which column?", file.request.where, "", "one column", hint))
    return tuple(names)


def _lags(name: FilterName, model: LocalLevel, seed: int) -> dict[str, float | None]:
    """Samples until 90 % of a step is followed, by the size of the step."""
    return {
        f"{sigmas:g}_sigma": step_lag(
            name, model, sigmas=sigmas, rng=np.random.default_rng(seed), longest=LONGEST_LAG
        )
        for sigmas in STEP_SIGMAS
    }


def _mean_square_step(series: Floats) -> float:
    """Mean square of the differences of neighbouring readings."""
    total = 0.0
    for piece in pieces(series, BLOCK, overlap=1):
        step = np.diff(piece)
        total += float(step @ step)
    return total / (series.size - 1)


def _known(name: str) -> FilterName:
    for known in FILTERS:
        if known == name:
            return known
    hint = nearest_names(name, FILTERS)
    raise SurveyError(Problem("there is no such filter", "filter", name, hint=hint))


def _model(series: Floats, stated: tuple[float | None, float | None], seed: int) -> LocalLevel:
    """The variances as stated, or from the differences of the series."""
    q, r = stated
    reading = r if r is not None else 0.5 * _mean_square_step(series)
    model = LocalLevel(q if q is not None else 1e-3 * reading, reading)
    problems = [
        Problem(
            said("{name} is no variance", name=name), name, f"{value:g}", "a finite number above 0"
        )
        for name, value in (("q", model.q), ("r", model.r))
        if not math.isfinite(value) or value <= 0.0
    ]
    if seed < 0:
        problems.append(Problem("the seed is negative", "seed", str(seed), "0 or more"))
    if problems:
        raise SurveyError(problems)
    return model


def _told(after: AllanChannel) -> AllanChannel:
    """The filtered series with the coefficients whose slope a filter leaves alone.

    A low-pass bends the short end of the curve: quantisation and white noise follow no power law
    any more, and their "reduction" would be an artefact. They are null, reason ``filtered``.
    """
    if after.unit in ("1", "LSB"):
        return after
    told = tuple(
        replace(c, value=None, sigma=None, reason="filtered") if c.symbol in ("Q", "N") else c
        for c in after.coefficients
    )
    return replace(after, coefficients=told)


def _divergence(filtered: Filtered, rate: float) -> dict[str, Any]:
    return {
        "diverged": filtered.lost_at is not None,
        "at_s": None if filtered.lost_at is None else filtered.lost_at / rate,
        "innovations_beyond": filtered.lost,
        "limit_sigma": LOST,
        "degenerate": filtered.degenerate,
    }


def _warnings(filtered: Filtered, lags: dict[str, float | None]) -> list[ResultWarning]:
    found = []
    if filtered.lost_at is not None:
        text = "the filter lost the series: its innovations stay far beyond their sigma"
        found.append(ResultWarning("divergence", text))
    if filtered.degenerate:
        text = said(
            "every weight vanished at {degenerate} samples: q or r is too small",
            degenerate=filtered.degenerate,
        )
        found.append(ResultWarning("degenerate", text))
    slow = [name for name, lag in lags.items() if lag is None]
    if slow:
        text = said(
            "a step is not followed within {longest_lag} samples: {names}",
            longest_lag=LONGEST_LAG,
            names=", ".join(slow),
        )
        found.append(ResultWarning("never_follows", text))
    return found
