"""A tilt sensor on a dividing head: sensitivity, linearity, transverse sensitivity, zero, band.

Tests after JJF 1427-2013 as source 000 carries them out. Output E = K0 + K1 sin(angle), angle the
commanded tilt of the sensitive axis. Every definition that a percentage depends on stands in the
name of its parameter: %FS takes the whole span, (sin max - sin min) K1; the small-angle conversion
of a residual and the true error of the arcsine stand side by side.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from surveyapp.core.sensors.dividing_head_rows import RANGES, TESTS, check_rows, rows_of
from surveyapp.core.sensors.dynamic_test import bandwidth
from surveyapp.core.sensors.linear import LinearFit, fit_linear, rms
from surveyapp.core.sensors.linearity import Line, linearity, null, outlying, sloped
from surveyapp.domain.calibration import (
    Calibration,
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

ARCSEC_PER_RAD: Final = 3600.0 * 180.0 / math.pi
TREND_P: Final = 0.001
"""Significance at which a trend of the zero is called warm-up (levelling.md)."""

PF: Final = 1e12


def calibrate_dividing_head(log: SensorLog) -> Calibration:
    """Evaluate every test that a log of a dividing head holds.

    Parameters
    ----------
    log : SensorLog
        ``test``, ``output``; ``set``, ``angle_deg``, ``flip``, ``frequency_hz``,
        ``impedance_ohm``, ``time_s`` as the tests need them.

    Returns
    -------
    Calibration

    Raises
    ------
    SurveyError
        For an unknown test, or a row without what its test needs.
    """
    check_rows(log)
    lines = {number: _line(log, number) for number in RANGES}
    parameters: list[SensorParameter] = []
    warnings = list(log.warnings)
    first = lines[1]
    unit = log.units.get("output", "LSB")
    parameters += _sensitivity(first, unit)
    for number, span in RANGES.items():
        parameters += linearity(lines[number], span)
        warnings += _outlying(lines[number], span, unit)
    parameters += _transverse(log, first)
    parameters += _zero(log, first, warnings)
    parameters += _reversal(log, first)
    parameters += _capacitance(log)
    parameters.append(bandwidth(log, rows_of(log, "dynamic")))
    return _result(log, lines, parameters, warnings)


def _line(log: SensorLog, number: int) -> Line | None:
    if "set" not in log.columns or "angle_deg" not in log.columns:
        return None
    rows = rows_of(log, "static") & (log.columns["set"] == number)
    if np.count_nonzero(rows) < LEAST_ROWS:
        return None
    angle, output = np.radians(log.columns["angle_deg"][rows]), log.columns["output"][rows]
    fit = fit_linear(np.column_stack([np.ones(angle.size), np.sin(angle)]), output)
    if fit is None or fit.x[1] == 0.0 or not sloped(fit):
        return None
    return Line(fit, angle, output)


def _outlying(line: Line | None, span: int, unit: str) -> list[ResultWarning]:
    """That single rows of a range are no readings of its line."""
    rows = [] if line is None else outlying(line)
    return [
        ResultWarning(
            "outlying_row",
            said(
                "static, +-{span} degrees: the output at {angle:g} degrees is off the line of the "
                "others by {size:.4g} {unit}: read or set wrongly?",
                span=span,
                angle=round(angle, 6),
                size=size,
                unit=unit,
            ),
        )
        for angle, size in rows
    ]


def _sensitivity(line: Line | None, unit: str) -> list[SensorParameter]:
    if line is None:
        return [*null(f"{unit}/g", "sensitivity"), *null(unit, "zero")]
    sigma = line.fit.sigma
    return [
        SensorParameter("sensitivity", line.slope, float(sigma[1]), f"{unit}/g"),
        SensorParameter("zero", line.zero, float(sigma[0]), unit),
    ]


def _transverse(log: SensorLog, first: Line | None) -> list[SensorParameter]:
    """Seven positions (equation 4.6) and the sinusoid through all of them."""
    seven, wave, place = "transverse_seven_position", "transverse_sinusoid", "transverse_direction"
    rows = rows_of(log, "transverse")
    if first is None or np.count_nonzero(rows) < 4:
        return [*null("%", seven, wave), *null("deg", place)]
    angle, flip = log.columns["angle_deg"][rows], log.columns["flip"][rows]
    output, slope = log.columns["output"][rows], abs(first.slope)
    phase = np.radians(angle + 180.0 * flip)
    design = np.column_stack([np.ones(phase.size), np.cos(phase), np.sin(phase)])
    fit = fit_linear(design, output)
    pairs = [
        float(np.mean(output[(angle == a) & (flip == 0.0)]))
        - float(np.mean(output[(angle == a) & (flip == 1.0)]))
        for a in np.unique(angle)
        if np.any((angle == a) & (flip == 0.0)) and np.any((angle == a) & (flip == 1.0))
    ]
    noise = None if fit is None else 100.0 * fit.sigma0 / (math.sqrt(2.0) * slope)
    found = null("%", seven)
    if pairs:
        largest = 100.0 * max(abs(p) for p in pairs) / (2.0 * slope)
        found = [SensorParameter(seven, largest, noise, "%")]
    if fit is None:
        return [*found, *null("%", wave), *null("deg", place)]
    cosine, sine = float(fit.x[1]), float(fit.x[2])
    amplitude = math.hypot(cosine, sine)
    along = np.array([0.0, cosine, sine]) / amplitude
    across = np.array([0.0, -sine, cosine]) / amplitude**2
    sigma = [math.sqrt(float(v @ fit.covariance @ v)) for v in (along, across)]
    direction = math.degrees(math.atan2(sine, cosine)) % 360.0
    return [
        *found,
        SensorParameter(wave, 100.0 * amplitude / slope, 100.0 * sigma[0] / slope, "%"),
        SensorParameter(place, direction, math.degrees(sigma[1]), "deg"),
    ]


def _zero(
    log: SensorLog, first: Line | None, warnings: list[ResultWarning]
) -> list[SensorParameter]:
    """Scatter at rest, and with a straight line taken out (equations 4.7, 4.8)."""
    names = ("zero_stability", "zero_stability_detrended")
    rows = rows_of(log, "zero")
    n = int(np.count_nonzero(rows))
    if first is None or n < 3:
        return null("arcsec", *names)
    output = log.columns["output"][rows]
    to_arcsec = ARCSEC_PER_RAD / abs(first.slope)
    plain = float(np.std(output, ddof=1)) * to_arcsec
    order = np.linspace(-1.0, 1.0, n)
    fit = fit_linear(np.column_stack([np.ones(n), order]), output)
    found = [SensorParameter(names[0], plain, plain / math.sqrt(2.0 * (n - 1)), "arcsec")]
    if fit is None:
        return [*found, *null("arcsec", names[1])]
    rest = fit.sigma0 * to_arcsec
    found.append(SensorParameter(names[1], rest, rest / math.sqrt(2.0 * (n - 2)), "arcsec"))
    p = _trend_p(fit)
    if p < TREND_P:
        drift = 2.0 * float(fit.x[1]) * to_arcsec
        text = said(
            "the zero drifts by {drift:+.1f} arcsec over the record (p = {p:.1e}): "
            "let the sensor warm up, or use the detrended figure",
            drift=drift,
            p=p,
        )
        warnings.append(ResultWarning("warm_up", text))
    return found


def _trend_p(fit: LinearFit) -> float:
    from scipy.special import stdtr

    t = abs(float(fit.x[1])) / float(fit.sigma[1]) if fit.sigma[1] > 0.0 else math.inf
    return 2.0 * float(stdtr(fit.dof, -t)) if math.isfinite(t) else 0.0


def _reversal(log: SensorLog, first: Line | None) -> list[SensorParameter]:
    """Tilt by turning the sensor by 180 degrees: asin((E0 - E180) / 2 K1)."""
    rows = rows_of(log, "reversal")
    if first is None or not np.any(rows):
        return null("arcsec", "tilt_reversal")
    flip, output = log.columns["flip"][rows], log.columns["output"][rows]
    direct, turned = output[flip == 0.0], output[flip == 1.0]
    if not direct.size or not turned.size:
        return null("arcsec", "tilt_reversal")
    sine = (float(direct.mean()) - float(turned.mean())) / (2.0 * first.slope)
    if abs(sine) >= 1.0:
        return null("arcsec", "tilt_reversal")
    noise = first.fit.sigma0 * math.sqrt(1.0 / direct.size + 1.0 / turned.size)
    sigma = noise / (2.0 * abs(first.slope) * math.sqrt(1.0 - sine**2))
    value = math.asin(sine) * ARCSEC_PER_RAD
    return [SensorParameter("tilt_reversal", value, sigma * ARCSEC_PER_RAD, "arcsec")]


def _capacitance(log: SensorLog) -> list[SensorParameter]:
    """C = 1 / (2 pi f |Z|) of the upper and the lower plate, and how unlike they are."""
    plates = ("capacitance_upper", "capacitance_lower")
    shares = ("capacitance_difference_over_mean", "capacitance_difference_over_sum")
    rows = rows_of(log, "capacitance")
    if not np.any(rows):
        return [*null("pF", *plates), *null("%", *shares)]
    number = log.columns["set"][rows]
    product = log.columns["frequency_hz"][rows] * log.columns["impedance_ohm"][rows]
    if np.any(product <= 0.0):
        found, expected = "0 or less", "more than 0"
        raise SurveyError(Problem("frequency or impedance", log.path, found, expected))
    capacitance = PF / (2.0 * np.pi * product)
    found_plates: list[SensorParameter] = []
    for index, name in enumerate(plates, start=1):
        values = capacitance[number == index]
        if not values.size:
            found_plates += null("pF", name)
            continue
        sigma = float(np.std(values, ddof=1)) / math.sqrt(values.size) if values.size > 1 else None
        found_plates.append(SensorParameter(name, float(values.mean()), sigma, "pF"))
    upper, lower = found_plates
    if upper.value is None or lower.value is None:
        return [*found_plates, *null("%", *shares)]
    difference, total = abs(upper.value - lower.value), upper.value + lower.value
    spread = None
    if upper.sigma is not None and lower.sigma is not None:
        spread = 100.0 * math.hypot(upper.sigma, lower.sigma) / total
    return [
        *found_plates,
        SensorParameter(
            shares[0], 200.0 * difference / total, None if spread is None else 2.0 * spread, "%"
        ),
        SensorParameter(shares[1], 100.0 * difference / total, spread, "%"),
    ]


def _result(
    log: SensorLog,
    lines: dict[int, Line | None],
    parameters: list[SensorParameter],
    warnings: list[ResultWarning],
) -> Calibration:
    unit = log.units.get("output", "LSB")
    first = lines[1]
    present = {name for name in TESTS if np.any(rows_of(log, name))}
    told = tuple(_with_reason(log, item, present, lines) for item in parameters)
    undetermined: list[str] = []
    if first is None and _static_rows(log, 1):
        asked = ("sensitivity", "zero")
        lost = ("no_slope", "no_scale")
        undetermined = [p.name for p in told if p.name in asked or p.reason in lost]
    if first is None and present - {"static", "capacitance", "dynamic"}:
        text = said("without the static test over +-90 degrees nothing has a scale")
        warnings.append(ResultWarning("no_sensitivity", text))
    held = None
    if first is not None:
        held = HeldOut(
            said("each row of the static test over +-90 degrees left out in turn"),
            rms((first.output - first.output.mean()) * first.output.size / (first.output.size - 1)),
            rms(_left_out(first)),
            unit,
        )
    return Calibration(
        kind="dividing-head",
        source=log.id,
        parameters=told,
        before=Misfit(
            None if first is None else rms(first.output - first.output.mean()),
            unit,
            said("static, +-90"),
        ),
        after=Misfit(
            None if first is None else first.fit.rms, unit, said("static, +-90, about the line")
        ),
        geometry=Geometry(
            "refused" if undetermined else "good",
            None if first is None else first.fit.condition,
            tuple(undetermined),
        ),
        held_out=held,
        warnings=tuple(warnings),
        met=not undetermined,
        n=log.size,
        sha256=log.sha256,
        covariance=None,
        temperature_c=log.temperature_span_c(),
    )


_TEST_OF: Final = {
    "sensitivity": "static",
    "zero": "static",
    "linearity": "static",
    "transverse": "transverse",
    "tilt": "reversal",
    "capacitance": "capacitance",
    "bandwidth": "dynamic",
}
"""First word of a parameter to its test; ``zero_stability`` is of the test ``zero``."""


def _with_reason(
    log: SensorLog, item: SensorParameter, present: set[str], lines: dict[int, Line | None]
) -> SensorParameter:
    """A parameter without a value says whether its test, its scale or rows are missing."""
    if item.value is not None:
        return item
    test = "zero" if item.name.startswith("zero_") else _TEST_OF[item.name.split("_")[0]]
    if test not in present:
        return replace(item, reason="test_absent")
    if lines[1] is None and test in ("transverse", "zero", "reversal"):
        return replace(item, reason="no_scale")
    number = next((k for k, span in RANGES.items() if f"_{span}" in item.name), 1)
    flat = test == "static" and lines[number] is None and _static_rows(log, number) >= LEAST_ROWS
    return replace(item, reason="no_slope" if flat else "too_few_rows")


LEAST_ROWS: Final = 3
"""Of a range that a line is laid through."""


def _static_rows(log: SensorLog, number: int) -> int:
    if "set" not in log.columns:
        return 0
    return int(np.count_nonzero(rows_of(log, "static") & (log.columns["set"] == number)))


def _left_out(line: Line) -> Floats:
    """Residuals of rows that had no part in the line: v / (1 - leverage)."""
    design = np.column_stack([np.ones(line.angle.size), np.sin(line.angle)])
    q = np.linalg.qr(design)[0]
    return np.asarray(line.fit.residual / (1.0 - np.sum(q**2, axis=1)))
