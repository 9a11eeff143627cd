"""``calibrate fog-station``: a table log to the instrument constant and its scatter."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from surveyapp.core.sensors.rate.fog_station import (
    BothWays,
    Constant,
    Rule,
    Scatter,
    combine,
)
from surveyapp.core.sensors.rate.gross_samples import gross_samples
from surveyapp.core.sensors.rate.table_log import (
    Turned,
    encoder_told,
    label,
    motion_of,
    red_noise_factor,
    saturated,
    sense_warnings,
    stretches_of,
    usable,
)
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

GYRO = "gyr_x_rad_s"
NEEDED = (GYRO,)
OPTIONAL = (
    "table_rate_deg_s",
    "table_angle_deg",
    "vertical_circle_deg",
    "set",
    "pass",
    "temperature_c",
)
NO_SCALE_ERROR = 0.1
"""Relative error of a scale factor that no gyro has: the rule is wrong then."""
STEEPEST = 0.9
"""Of the table's rate: a gyro that shows more stands upright, or is in another unit."""
STEEP = math.radians(10.0)
"""Elevation above which the source asks to level the gyro better first [rad]."""


def calibrate_fog_station(
    log: SensorLog, *, rule: Rule, relative_rate_sigma: float | None, problems: list[Problem]
) -> Calibration:
    """Instrument constant from a log.

    Parameters
    ----------
    log : SensorLog
        With ``gyr_x_rad_s`` and how the table turned.
    rule : str
        What the reading does as the gyro goes from its elevation to the horizontal.
    relative_rate_sigma : float or None
        Relative standard deviation of the table's rate; None counts as 0 and is told.
    problems : list of Problem
        Found before; raised together with those of the log.

    Raises
    ------
    SurveyError
    """
    turns, warnings = turned_sets(log, problems, relative_rate_sigma=relative_rate_sigma or 0.0)
    sets = [_both_ways(log, turned, pass_id, set_id) for (pass_id, set_id), turned in turns.items()]
    steep = [s for s in sets if abs(s.sine) > STEEPEST]
    if steep:
        raise SurveyError(_not_level(log, steep))
    found = combine(sets, rule=rule, relative_rate_sigma=relative_rate_sigma or 0.0)
    if found.scale is not None and abs(found.scale) > NO_SCALE_ERROR:
        raise SurveyError(_against_rule(log, rule))
    warnings += gross_samples(log, [t for turned in turns.values() for t in turned], NEEDED)
    return _calibration(log, sets, found, rule, relative=relative_rate_sigma, warnings=warnings)


def turned_sets(
    log: SensorLog, problems: list[Problem], *, relative_rate_sigma: float = 0.0
) -> tuple[dict[tuple[int, int], list[Turned]], list[ResultWarning]]:
    """Whole turns of each pass and set, and what is to be said of the table's sense.

    Parameters
    ----------
    log : SensorLog
    problems : list of Problem
        Found before; raised together with those of the log.
    relative_rate_sigma : float
        Stated for the table's rate.

    Raises
    ------
    SurveyError
    """
    motion = motion_of(log)
    if isinstance(motion, Problem):
        raise SurveyError([*problems, motion])
    groups: dict[tuple[int, int], list[Any]] = {}
    for stretch in stretches_of(log, motion, ("set", "pass")):
        key = (label(log, "pass", stretch.start, 1), label(log, "set", stretch.start, 0))
        groups.setdefault(key, []).append(stretch)
    if "set" not in log.columns:
        groups = _paired(groups)
    found = {}
    if not groups:
        problems = [*problems, *usable([], where=log.path)[1]]
    for (pass_id, set_id), stretches in sorted(groups.items()):
        where = said(
            "{path}, pass {pass_id}, set {set_id}", path=log.path, pass_id=pass_id, set_id=set_id
        )
        turned, wrong = usable(stretches, where=where)
        problems = [*problems, *wrong, *_saturation(turned, log.columns[GYRO], where)]
        if turned:
            found[(pass_id, set_id)] = turned
    every = [t for turned in found.values() for t in turned]
    noted, wrong = encoder_told(log, motion, every, relative_rate_sigma=relative_rate_sigma)
    problems = [*problems, *wrong]
    if problems:
        raise SurveyError(list(dict.fromkeys(problems)))
    return found, [*sense_warnings(motion), *noted]


def _not_level(log: SensorLog, sets: list[BothWays]) -> list[Problem]:
    """The gyro shows so much of the table's rate that it is another gyro or another unit."""
    return [
        Problem(
            "the gyro does not lie near the horizontal",
            said(
                "{path}, pass {pass_id}, set {set_id}",
                path=log.path,
                pass_id=s.pass_id,
                set_id=s.set_id,
            ),
            said("it shows {share:.4g} of the table's rate", share=abs(s.sine)),
            said("at most {share:g}: the sine of its elevation", share=STEEPEST),
            "is gyr_x_rad_s the gyro of the telescope, and in rad/s? `units` COLUMN=deg/s",
        )
        for s in sets
    ]


def _against_rule(log: SensorLog, rule: Rule) -> Problem:
    other = "decreases" if rule == "increases" else "increases"
    return Problem(
        "the stated rule contradicts the passes",
        f"{log.path}, `reading_from_elevation`",
        rule,
        other,
        "from one pass to the other the vertical circle and the elevation changed in opposite "
        "ways: look it up at the instrument; or does the table turn the other way than the log "
        "says, or were two sets exchanged?",
    )


def _paired(groups: dict[tuple[int, int], list[Any]]) -> dict[tuple[int, int], list[Any]]:
    """Sets of one way and the way back, in the order of the log."""
    found: dict[tuple[int, int], list[Any]] = {}
    for (pass_id, _), stretches in groups.items():
        number, here = 1, list(stretches)
        while here:
            one = here.pop(0)
            other = next((s for s in here if s.rate * one.rate < 0.0), None)
            if other is not None:
                here.remove(other)
            elif found:
                found[max(found)].append(one)
                continue
            found[(pass_id, number)] = [one] if other is None else [one, other]
            number += 1
    return found


def _saturation(turned: list[Turned], values: np.ndarray, where: str) -> list[Problem]:
    for item in turned:
        part = values[item.stretch.start : item.stretch.stop]
        ends = float(np.mean((part == values.max()) | (part == values.min())))
        if saturated(part, values, expected=0.0) or (ends > 0.9 and np.ptp(values) > 0.0):
            found = said(
                "{ends:.0%} of a stretch at {value:.6g} rad/s", ends=ends, value=part.max()
            )
            return [
                Problem(
                    "the gyro is saturated",
                    where,
                    found,
                    "a rate within its range",
                    "turn the table more slowly, or level the gyro better",
                )
            ]
    return []


def _both_ways(log: SensorLog, turned: list[Turned], pass_id: int, set_id: int) -> BothWays:
    values = log.columns[GYRO]
    red = red_noise_factor(turned, values)
    sides = []
    for sign in (1.0, -1.0):
        here = [t for t in turned if t.rate * sign > 0.0]
        means = [t.mean(values) for t in here]
        weight = np.array([m.count for m in means], dtype=np.float64)
        weight /= weight.sum()
        mean = float(weight @ [m.mean for m in means])
        sigma = red * math.sqrt(float(np.sum((weight * [m.sigma for m in means]) ** 2)))
        rate = abs(float(weight @ [t.rate for t in here]))
        sides.append((mean, sigma, rate, means))
    (cw, s_cw, w_cw, m_cw), (ccw, s_ccw, w_ccw, m_ccw) = sides
    reading = None
    if "vertical_circle_deg" in log.columns:
        rows = [log.columns["vertical_circle_deg"][t.stretch.start] for t in turned]
        finite = [r for r in rows if math.isfinite(r)]
        reading = math.radians(float(finite[0])) if finite else None
    noise = math.sqrt(float(np.mean([m.noise**2 for m in (*m_cw, *m_ccw)])))
    return BothWays(
        set_id,
        pass_id,
        cw,
        ccw,
        s_cw,
        s_ccw,
        w_cw,
        w_ccw,
        reading,
        min(t.recorded for t in turned),
        min(t.stretch.turns for t in turned),
        noise,
        sum(m.count for m in (*m_cw, *m_ccw)),
    )


def _calibration(
    log: SensorLog,
    sets: list[BothWays],
    found: Constant,
    rule: Rule,
    *,
    relative: float | None,
    warnings: list[ResultWarning],
) -> Calibration:
    constant = None if found.constant is None else math.degrees(found.constant)
    known = (
        SensorParameter(
            "elevation", found.elevation / ARCSEC, found.sigma_elevation / ARCSEC, "arcsec"
        ),
        SensorParameter("instrument_constant", constant, _scaled(found.sigma_constant), "deg"),
        SensorParameter("scale_factor", _ppm(found.scale), _ppm(found.sigma_scale), "ppm"),
    )
    parameters = with_reasons(known, _WHY.__getitem__)
    undetermined = ("instrument_constant",) if constant is None else ()
    scatter = found.scatter
    first = [s.elevation for s in sets]
    met = not undetermined and scatter.verdict != "exceeds_model"
    return Calibration(
        kind="fog-station",
        source=log.id,
        parameters=parameters,
        before=Misfit(
            math.sqrt(float(np.mean(np.square(first)))) / ARCSEC,
            "arcsec",
            said("elevations, none assumed"),
        ),
        after=Misfit(
            None if scatter.sd is None else scatter.sd / ARCSEC,
            "arcsec",
            said("repeats about their mean"),
        ),
        geometry=Geometry("good" if not undetermined else "restricted", None, undetermined),
        warnings=(
            *log.warnings,
            *warnings,
            *_sense_unproved(log, found),
            *_warnings(sets, found, relative),
        ),
        met=met,
        n=sum(s.samples for s in sets),
        sha256=log.sha256,
        extra={
            "rule": rule,
            "scatter": _scatter_dict(scatter),
            "sets": [_set_dict(s, rule, relative or 0.0) for s in sets],
        },
    )


def _sense_unproved(log: SensorLog, found: Constant) -> list[ResultWarning]:
    """One gyro in one pass cannot tell which way the table turned."""
    if found.scale is not None or "table_angle_deg" in log.columns:
        return []
    text = (
        "only table_rate_deg_s says which way the table turned: had it turned the other way, the "
        "elevation would have the other sign; table_angle_deg or a second pass would show it"
    )
    return [ResultWarning("sense_unproved", text)]


_WHY: Final = {
    "elevation": said("no turns both ways"),
    "instrument_constant": said("the log has no reading of the vertical circle"),
    "scale_factor": said("one pass, or two at one reading: it takes two passes"),
}
"""Why a parameter has no value."""


def _scaled(sigma: float | None) -> float | None:
    return None if sigma is None else math.degrees(sigma)


def _ppm(value: float | None) -> float | None:
    return None if value is None else value * 1e6


def _scatter_dict(scatter: Scatter) -> dict[str, Any]:
    return {
        "verdict": scatter.verdict,
        "sd_arcsec": None if scatter.sd is None else scatter.sd / ARCSEC,
        "model_sd_arcsec": None if scatter.model_sd is None else scatter.model_sd / ARCSEC,
        "p": scatter.p,
        "relative_rate_error_needed": scatter.relative_rate_error_needed,
    }


def _set_dict(one: BothWays, rule: Rule, relative: float) -> dict[str, Any]:
    constant = one.constant(rule)
    return {
        "set": one.set_id,
        "pass": one.pass_id,
        "elevation_arcsec": one.elevation / ARCSEC,
        "sigma_arcsec": one.model_sigma(relative) / ARCSEC,
        "vertical_circle_deg": None if one.reading is None else math.degrees(one.reading),
        "instrument_constant_deg": None if constant is None else math.degrees(constant),
        "table_rate_deg_s": math.degrees(0.5 * (one.rate_clockwise + one.rate_anticlockwise)),
        "turns_recorded": one.turns_recorded,
        "turns_used": one.turns_used,
        "samples": one.samples,
        "noise_deg_h": math.degrees(one.noise) * 3600.0,
    }


def _warnings(sets: list[BothWays], found: Constant, relative: float | None) -> list[ResultWarning]:
    warnings = []
    if relative is None:
        text = "no --table-rate-relative-sigma: the table's rate counts as exact in every sigma"
        warnings.append(ResultWarning("no_table_rate_sigma", text))
    first = [s.elevation for s in sets if s.pass_id == sets[0].pass_id]
    steepest = max(first, key=abs)
    if abs(steepest) > STEEP:
        text = said(
            "the elevation of {value:.2f} degrees is above 10: the error of the "
            "table's rate enters by its tangent; level the gyro better or add a "
            "pass",
            value=math.degrees(steepest),
        )
        warnings.append(ResultWarning("elevation_above_10", text))
    if found.scale is None:
        text = (
            "one pass: an error of the gyro's scale factor is in the constant by the tangent of "
            "the elevation and does not show in the repeats; a second pass near level removes it"
        )
        warnings.append(ResultWarning("one_pass", text))
    if any(s.turns_used < 0.99 for s in sets):
        text = "less than a whole turn, but the way back retraced the arc: the earth rate cancels"
        warnings.append(ResultWarning("retraced_arc", text))
    if found.scatter.verdict == "exceeds_model":
        warnings.append(ResultWarning("scatter_exceeds_model", _exceeding(found.scatter)))
    return warnings


def _exceeding(scatter: Scatter) -> str:
    needed = scatter.relative_rate_error_needed
    sd = (scatter.sd or 0.0) / ARCSEC
    model = (scatter.model_sd or 0.0) / ARCSEC
    text = said(
        'the repeats scatter by {sd:.2f}" where the model allows {model:.2f}": an effect is '
        "missing in the model",
        sd=sd,
        model=model,
    )
    if needed is not None:
        text += said(
            "; a relative error of the table's rate of {needed:.2g} would do it, and so would "
            "wobble of its axis, levelling anew or creep of the telescope: which one is not known",
            needed=needed,
        )
    return text
