"""``north --method indexing``: a sensor turned about one axis at rest."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from surveyapp.core.sensors.rate.indexing_log import IndexingOptions, find_heading
from surveyapp.core.sensors.rate.indexing_stops import CYCLE, GYROS, NEEDED, OPTIONAL
from surveyapp.core.sensors.rate.indexing_values import Setting
from surveyapp.core.sensors.rate.parameters import DEG_H
from surveyapp.domain.north import NorthResult
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import LogFile, LogRequest, Need, open_log
from surveyapp.workflows.north.card import Known, known_of
from surveyapp.workflows.north.request import NorthRequest
from surveyapp_models.arrays import Floats


def find(request: NorthRequest) -> NorthResult:
    """Find heading, attitude and biases."""
    problems: list[Problem] = []
    latitude = request.latitude(problems)
    axis = str(request.option("index_axis") or "z")
    if axis not in ("x", "y", "z"):
        problems.append(Problem("this is no axis", "index_axis", axis, "x, y or z"))
    prior, sigma = _prior(request, problems)
    spread = request.sigma("index_sigma_deg", problems) or 0.0
    turned, fixed = request.file, None
    second = request.option("second")
    indexed = str(request.option("indexed") or "first")
    if indexed not in ("first", "second"):
        problems.append(Problem("which unit was turned?", "indexed", indexed, "first or second"))
    try:
        if second is not None:
            other = _opened(request, str(second))
            turned, fixed = (other, request.file) if indexed == "second" else (turned, other)
        elif indexed == "second":
            problems.append(Problem("there is no second log", "second", "", "a FILE"))
        across = tuple(name for name in GYROS if name != f"gyr_{axis}_rad_s")
        need = Need(columns=NEEDED, varying=across, optional=(*OPTIONAL, CYCLE))
        log = request.read(need) if turned is request.file else turned.read(need)
        other_log = None if fixed is None else _fixed(fixed)
        card = request.option("card")
        known = Known() if card is None else known_of(str(card), log, problems)
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems or latitude is None:
        raise SurveyError(problems)
    setting = Setting(
        latitude=latitude,
        axis="xyz".index(axis),
        bias_prior=prior,
        bias_prior_sigma=np.full(3, sigma),
        index_sigma=spread,
        matrix=known.matrix,
    )
    options = IndexingOptions(
        setting,
        bool(request.option("track")),
        other_log,
        force_matrix=known.force_matrix,
        force_bias=known.force_bias,
        card=known.card,
    )
    # the biases are found here: what the card says of them is not asked
    result = find_heading(log, options)
    return replace(result, warnings=(*result.warnings, *known.told))


def _fixed(file: LogFile) -> SensorLog:
    return file.read(Need(columns=GYROS, varying=GYROS, optional=("temperature_c",)))


def _opened(request: NorthRequest, name: str) -> LogFile:
    path = Path(name)
    if not path.is_absolute() and not path.exists() and request.folder is not None:
        path = request.folder / name
    return open_log(LogRequest(path=path, where=name, id=path.name))


def _prior(request: NorthRequest, problems: list[Problem]) -> tuple[Floats | None, float]:
    """Biases known beforehand [rad/s] and their sigma; None without both."""
    text = request.option("bias_prior_deg_h")
    sigma = request.number("bias_prior_sigma_deg_h", problems)
    if text is None and sigma is None:
        return None, 0.0
    if text is None or sigma is None:
        missing = "bias_prior_deg_h" if text is None else "bias_prior_sigma_deg_h"
        problems.append(Problem("a prior needs values and their sigma", missing, "", "both"))
        return None, 0.0
    parts = text if isinstance(text, list) else str(text).split(",")
    try:
        values = [float(part) for part in parts]
    except (TypeError, ValueError):
        values = []
    if len(values) == 1:
        values = values * 3
    if len(values) != 3 or not all(math.isfinite(v) for v in values):
        expected = "three numbers, deg/h, as 0.1,-0.2,0"
        problems.append(Problem("these are no biases", "bias_prior_deg_h", str(text), expected))
        return None, 0.0
    if not sigma > 0.0:
        where = "bias_prior_sigma_deg_h"
        problems.append(Problem("a sigma is not positive", where, f"{sigma:g}", "above 0"))
        return None, 0.0
    return np.array(values) * DEG_H, sigma * DEG_H
