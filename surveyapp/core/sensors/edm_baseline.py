"""A distance meter on a line of pillars: constant, cyclic error, and who corrected the atmosphere.

Nothing is corrected that the readings do not ask for: a term is adopted where the pointings (not
the readings, which share their centring and their air) prove it and where it predicts pointings
that were left out. Whether the instrument has already applied the atmosphere is judged, not asked.

Source: J. M. Rueger (1996), Electronic Distance Measurement, 4th ed., ch. 5, 12, 13.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from surveyapp.core.edm import (
    AtmosphereVerdict,
    EdmReading,
    TermVerdict,
    baseline_design,
    fit_baseline,
    horizontal_lengths,
    judge_atmosphere,
    judge_terms,
    sight_means,
)
from surveyapp.core.sensors.edm_readings import edm_readings
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
from surveyapp_models.effects.traverse.distance_cyclic import LARGEST_AMPLITUDE_M, UNIT_LENGTHS_M

MM: Final = 1e3
WEATHER: Final = ("temperature_c", "pressure_hpa", "humidity_percent")
LEAST_PILLARS: Final = 4
"""With three pillars the constant has one redundant pointing, and nothing is left to prove it."""


@dataclass(frozen=True, slots=True)
class _Model:
    """One treatment of the distances."""

    id: str
    lengths: Floats
    constant: bool = False
    unit_length_m: float | None = None


@dataclass(frozen=True, slots=True)
class _Judged:
    """What the pointings say: the terms, the unit length, the atmosphere."""

    constant: TermVerdict
    cyclic: TermVerdict | None
    unit_length_m: float | None
    atmosphere: AtmosphereVerdict | None


def calibrate_edm(
    log: SensorLog,
    *,
    heights: Mapping[str, float] | None = None,
    unit_length_m: float | None = None,
) -> Calibration:
    """Calibrate a distance meter.

    Parameters
    ----------
    log : SensorLog
        ``from_pillar``, ``to_pillar``, ``slope_distance_m``; heights and weather where they are
        known.
    heights : mapping, optional
        Heights of the pillars [m], where the log does not hold them.
    unit_length_m : float, optional
        Of the cyclic error [m]; without it the common ones are tried and paid for.

    Returns
    -------
    Calibration

    Raises
    ------
    SurveyError
        For a line of pillars that determines nothing, impossible readings, unknown heights.
    """
    readings, levelled = edm_readings(log, heights)
    weather = all(name in log.columns for name in WEATHER)
    as_read = horizontal_lengths(readings, reduce=False)
    reduced = horizontal_lengths(readings)
    _check_design(readings, reduced, log.path)
    atmosphere = judge_atmosphere(readings) if weather else None
    judged = _judge(readings, reduced, atmosphere, unit_length_m)
    models = _models(readings, (as_read, reduced), judged, levelled=levelled)
    held = {model.id: _held_out(readings, model) for model in models}
    chosen = _chosen(models, held, judged, levelled=levelled)
    return _result(log, readings, (models, chosen, held), judged, levelled=levelled)


def _check_design(readings: Sequence[EdmReading], lengths: Floats, where: str) -> None:
    sights, _ = sight_means(readings, lengths)
    pillars = {name for r in sights for name in (r.start, r.end)}
    steep = [r for r in readings if abs(r.end_height_m - r.start_height_m) >= r.slope_m]
    problems = []
    if steep:
        text = f"{steep[0].start}-{steep[0].end}: {steep[0].slope_m:g} m"
        problems.append(
            Problem("a distance is shorter than the difference of the heights", where, text)
        )
    rank = np.linalg.matrix_rank(baseline_design(sights, constant=True))
    if len(pillars) < LEAST_PILLARS or len(sights) < len(pillars) + 1 or rank < len(pillars):
        problems.append(
            Problem(
                "the distances determine no constant",
                where,
                said(
                    "{size} pointings between {size2} pillars", size=len(sights), size2=len(pillars)
                ),
                said(
                    "at least {least_pillars} pillars in all combinations",
                    least_pillars=LEAST_PILLARS,
                ),
                "a constant shows where a length is measured whole and in parts",
            )
        )
    if problems:
        raise SurveyError(problems)


def _judge(
    readings: Sequence[EdmReading],
    reduced: Floats,
    atmosphere: AtmosphereVerdict | None,
    unit_length_m: float | None,
) -> _Judged:
    lengths = reduced
    if atmosphere is not None and atmosphere.verdict == "not_applied":
        lengths = horizontal_lengths(readings, correct_atmosphere=True)
    constant = judge_terms(readings, lengths)
    units = UNIT_LENGTHS_M if unit_length_m is None else (unit_length_m,)
    found: list[tuple[TermVerdict, float]] = []
    for unit in units:
        try:
            found.append(
                (judge_terms(readings, lengths, cyclic_unit_m=unit, tried=len(units)), unit)
            )
        except ValueError:
            continue
    if not found:
        return _Judged(constant, None, unit_length_m, atmosphere)
    best = min(found, key=lambda item: item[0].probability)
    return _Judged(constant, best[0], best[1], atmosphere)


def _models(
    readings: Sequence[EdmReading],
    lengths: tuple[Floats, Floats],
    judged: _Judged,
    *,
    levelled: bool,
) -> list[_Model]:
    as_read, reduced = lengths
    found = [_Model("as_read", as_read)]
    best = reduced
    if levelled:
        found.append(_Model("reduced", reduced))
    if judged.atmosphere is not None:
        corrected = horizontal_lengths(readings, correct_atmosphere=True)
        found.append(_Model("atmosphere", corrected))
        if judged.atmosphere.verdict == "not_applied":
            best = corrected
    found.append(_Model("constant", best, constant=True))
    if judged.cyclic is not None:
        found.append(_Model("cyclic", best, constant=True, unit_length_m=judged.unit_length_m))
    return found


def _held_out(readings: Sequence[EdmReading], model: _Model) -> float | None:
    """Error of pointings predicted from those between other pillars [m].

    Both directions of a pair are left out together: they share its air and its centring.
    """
    sights, means = sight_means(readings, model.lengths)
    matrix = baseline_design(sights, constant=model.constant, cyclic_unit_m=model.unit_length_m)
    q, _ = np.linalg.qr(matrix)
    residual = means - q @ (q.T @ means)
    pairs = np.array(["|".join(sorted((r.start, r.end))) for r in sights])
    errors = []
    for pair in np.unique(pairs):
        rows = np.flatnonzero(pairs == pair)
        free = np.eye(rows.size) - q[rows] @ q[rows].T
        if float(np.linalg.eigvalsh(free)[0]) > 1e-3:
            errors += np.linalg.solve(free, residual[rows]).tolist()
    return float(np.sqrt(np.mean(np.square(errors)))) if errors else None


def _chosen(
    models: Sequence[_Model],
    held: Mapping[str, float | None],
    judged: _Judged,
    *,
    levelled: bool,
) -> str:
    """The richest model that is proved: by the pointings, and on those that were left out."""
    chosen = "reduced" if levelled else "as_read"
    if judged.atmosphere is not None and judged.atmosphere.verdict == "not_applied":
        chosen = "atmosphere"
    terms = (("constant", judged.constant), ("cyclic", judged.cyclic))
    for name, verdict in terms:
        if verdict is None or not verdict.significant:
            continue
        if name == "cyclic" and verdict.amplitude_m > LARGEST_AMPLITUDE_M:
            continue
        before, after = held[chosen], held[name]
        if before is not None and after is not None and after < before:
            chosen = name
    return chosen


def _result(
    log: SensorLog,
    readings: Sequence[EdmReading],
    compared: tuple[Sequence[_Model], str, Mapping[str, float | None]],
    judged: _Judged,
    *,
    levelled: bool,
) -> Calibration:
    models, chosen, held = compared
    rms = {m.id: _rms(readings, m) for m in models}
    best = next(m for m in models if m.id == chosen)
    sights, _ = sight_means(readings, best.lengths)
    temperature = log.columns.get("temperature_c")
    known = temperature is not None and bool(np.isfinite(temperature).all())
    parameters, undetermined = _parameters(readings, best, judged)
    distances = said("distances of the baseline")
    return Calibration(
        kind="edm",
        source=log.id,
        parameters=parameters,
        before=Misfit(rms["as_read"] * MM, "mm", said("distances as read, taken for horizontal")),
        after=Misfit(rms[chosen] * MM, "mm", chosen),
        geometry=Geometry("restricted" if undetermined else "good", undetermined=undetermined),
        held_out=HeldOut(
            said("the pointings of each pair of pillars from all others"),
            _mm(held["as_read"]),
            _mm(held[chosen]),
            "mm",
        ),
        models=tuple(
            CalibrationModel(m.id, rms[m.id] * MM, _mm(held[m.id]), m.id == chosen, "mm", distances)
            for m in models
        ),
        warnings=(*log.warnings, *_warnings(judged, len(sights), levelled=levelled)),
        n=log.size,
        sha256=log.sha256,
        extra=_extra(judged, len(sights)),
        notes={"model": f"{chosen}: a term that it does not hold is not proved; do not apply it"},
        temperature_c=(float(temperature.min()), float(temperature.max()))
        if known and temperature is not None
        else None,
    )


def _mm(value: float | None) -> float | None:
    return None if value is None else value * MM


def _rms(readings: Sequence[EdmReading], model: _Model) -> float:
    fit = fit_baseline(
        readings, model.lengths, constant=model.constant, cyclic_unit_m=model.unit_length_m
    )
    return fit.sigma0_m


def _parameters(
    readings: Sequence[EdmReading], best: _Model, judged: _Judged
) -> tuple[tuple[SensorParameter, ...], tuple[str, ...]]:
    """Constant and cyclic term with the sigma of the pointings, adopted or not."""
    sights, means = sight_means(readings, best.lengths)
    value, sigma = fit_baseline(sights, means, constant=True).term("constant")
    found = [SensorParameter("constant_mm", value * MM, sigma * MM, "mm")]
    names = ("cyclic_sine_mm", "cyclic_cosine_mm", "cyclic_amplitude_mm")
    if judged.cyclic is None:
        return (*found, *(SensorParameter(n, None, None, "mm") for n in names)), names
    fit = fit_baseline(sights, means, constant=True, cyclic_unit_m=judged.unit_length_m)
    for name, term in zip(names, ("cyclic_sin", "cyclic_cos"), strict=False):
        value, sigma = fit.term(term)
        found.append(SensorParameter(name, value * MM, sigma * MM, "mm"))
    size = judged.cyclic
    found.append(SensorParameter(names[2], size.amplitude_m * MM, size.sigma_m * MM, "mm"))
    found.append(SensorParameter("unit_length_m", judged.unit_length_m, None, "m"))
    return tuple(found), ()


def _extra(judged: _Judged, pointings: int) -> dict[str, object]:
    """Further keys of the JSON."""
    air = judged.atmosphere

    def told(verdict: TermVerdict | None) -> dict[str, object] | None:
        if verdict is None:
            return None
        return {
            "f": verdict.statistic,
            "p": verdict.probability,
            "significant": verdict.significant,
        }

    return {
        "pointings": pointings,
        "atmosphere": None
        if air is None
        else {
            "verdict": air.verdict,
            "as_read_mm": air.as_read_m * MM,
            "corrected_mm": air.corrected_m * MM,
            "evidence": air.evidence,
        },
        "constant": told(judged.constant),
        "cyclic": told(judged.cyclic),
    }


def _warnings(judged: _Judged, pointings: int, *, levelled: bool) -> list[ResultWarning]:
    found = []
    if not levelled:
        text = "no heights: the distances are taken for horizontal (--heights FILE)"
        found.append(ResultWarning("no_heights", text))
    if judged.atmosphere is None:
        text = (
            "no temperature, pressure and humidity: who corrected the atmosphere cannot be judged"
        )
        found.append(ResultWarning("no_weather", text))
    else:
        found.append(ResultWarning(*_AIR[judged.atmosphere.verdict]))
    if judged.cyclic is not None and judged.cyclic.amplitude_m > LARGEST_AMPLITUDE_M:
        text = said(
            "a cyclic term of {value:.1f} mm is not plausible (at most {value2:g} "
            "mm): another cause, or another unit length",
            value=judged.cyclic.amplitude_m * MM,
            value2=LARGEST_AMPLITUDE_M * MM,
        )
        found.append(ResultWarning("cyclic_implausible", text))
    return found


_AIR: Final = {
    "already_applied": (
        "atmosphere_applied",
        "the instrument has already applied the atmosphere: applying it again makes it worse",
    ),
    "not_applied": (
        "atmosphere_not_applied",
        "the distances hold no atmospheric correction: it is applied here, and must be later",
    ),
    "not_separable": (
        "atmosphere_unknown",
        "the weather changed too little to tell whether the atmosphere was applied",
    ),
}
