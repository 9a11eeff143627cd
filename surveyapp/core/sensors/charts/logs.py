"""Pictures of a calibration beside its log: readings before and after, and what they cover."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from surveyapp.core.sensors.charts.results import TIME, pairs
from surveyapp.core.sensors.compass_calibration import coverage_cells
from surveyapp.core.sensors.swing import shown_heading
from surveyapp.domain.calibration import Calibration
from surveyapp.domain.chart import Chart, Coverage, Picture, Series
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.languages import said, term
from surveyapp_models.arrays import Floats
from surveyapp_models.compass.deviation import COEFFICIENTS, deviation_basis

ARCSEC: Final = math.pi / 648000.0
RANGES: Final = {1: 90, 2: 30, 3: 15}


def compass_pictures(log: SensorLog, result: Calibration) -> tuple[Picture, ...]:
    """Size of the field before and after, and the directions that the record covers.

    The chosen model need not be determined well enough for a card: what it leaves is shown then
    too, as dots of what was measured alone where nothing was fitted.
    """
    points = np.column_stack([log.columns[f"mag_{axis}_uT"] for axis in "xyz"])
    size = np.linalg.norm(points, axis=1)
    curves = [Series(said("measured"), pairs(log.columns["time_s"], size), "dots")]
    corrected = _corrected(points, result)
    if corrected is not None:
        after = np.linalg.norm(corrected, axis=1)
        curves.append(Series(said("calibrated"), pairs(log.columns["time_s"], after)))
    cells = result.extra.get("coverage_cells")
    told = result.geometry.coverage
    note = "" if told is None else said("{share:.0%} of the directions are covered", share=told)
    found: list[Picture] = [
        Chart(said("Size of the field"), TIME, said("field [uT]"), tuple(curves))
    ]
    if cells:
        title = said("Directions of the field in the sensor, from up to down")
        found.append(Coverage(title, _whole(np.array(cells)), note))
    return tuple(found)


def _corrected(points: Floats, result: Calibration) -> Floats | None:
    """Field with the hard and soft iron of a calibration taken out; None without one."""
    known = {p.name: p.value for p in result.parameters}
    iron = [known.get(f"hard_iron_{axis}") for axis in "xyz"]
    soft = [known.get(f"soft_iron_{cell}") for cell in ("xx", "yy", "zz", "xy", "xz", "yz")]
    if any(value is None for value in (*iron, *soft)):
        return None
    xx, yy, zz, xy, xz, yz = (float(value or 0.0) for value in soft)
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.asarray((points - np.array([float(v or 0.0) for v in iron])) @ matrix)


def _whole(cells: Floats) -> tuple[tuple[int, ...], ...]:
    return tuple(tuple(int(value) for value in row) for row in cells)


def swing_pictures(log: SensorLog, result: Calibration) -> tuple[Picture, ...]:
    """Deviation against the known heading, with the curve of A to E."""
    psi = np.radians(log.columns["heading_deg"])
    shown = shown_heading(log)
    deviation = np.degrees((psi - shown + np.pi) % (2.0 * np.pi) - np.pi)
    order = np.argsort(psi % (2.0 * np.pi))
    heading = np.degrees(psi % (2.0 * np.pi))[order]
    curves = [Series(said("known minus shown"), pairs(heading, deviation[order]), "dots")]
    values = [p.value for p in result.parameters if p.name.startswith("deviation_")]
    if len(values) == len(COEFFICIENTS) and all(v is not None for v in values):
        grid = np.radians(np.arange(0.0, 361.0, 5.0))
        line = deviation_basis(grid) @ np.array(values, dtype=np.float64)
        curves.append(Series(said("A to E"), pairs(np.degrees(grid), line)))
    cells = result.extra.get("coverage_cells", [])
    found: list[Picture] = [
        Chart(
            said("Deviation"),
            said("known magnetic heading [deg]"),
            said("deviation [deg]"),
            tuple(curves),
        )
    ]
    if cells:
        rows = tuple(tuple(int(value) for value in row) for row in cells)
        found.append(Coverage(said("Headings of the swing, from north clockwise"), rows))
    return tuple(found)


def tilt_pictures(log: SensorLog, result: Calibration) -> tuple[Picture, ...]:
    """Reading minus reference of both axes, before and after."""
    found: list[Picture] = []
    known = {p.name: p.value for p in result.parameters}
    for axis, other in (("along", "across"), ("across", "along")):
        reading, own = log.columns[f"tilt_{axis}_arcsec"], log.columns[f"ref_{axis}_arcsec"]
        curves = [Series(said("reading minus reference"), pairs(own, reading - own), "dots")]
        terms = [known.get(f"{term}_{axis}") for term in ("zero", "scale", "cross")]
        if all(value is not None for value in terms):
            zero, scale, cross = (float(value or 0.0) for value in terms)
            model = zero + scale * own + cross * log.columns[f"ref_{other}_arcsec"]
            slope, temperature = known.get(f"temperature_{axis}"), log.columns.get("temperature_c")
            if slope is not None and temperature is not None:
                at = result.constants.get("reference_temperature_c", 20.0)
                model = model + slope * (temperature - at)
            curves.append(Series(said("calibrated"), pairs(own, reading - model), "dots"))
        title = said("Tilt {axis}", axis=term(axis))
        found.append(
            Chart(title, said("reference [arcsec]"), said("residual [arcsec]"), tuple(curves))
        )
    return tuple(found)


def head_pictures(log: SensorLog, result: Calibration) -> tuple[Picture, ...]:
    """Residuals of each range about its own line, and the zero over its hour."""
    tests = np.array(log.texts["test"])
    found: list[Picture] = []
    if log.has("set", "angle_deg"):
        for number, span in RANGES.items():
            rows = (tests == "static") & (log.columns["set"] == number)
            if np.count_nonzero(rows) < 3:
                continue
            angle, output = log.columns["angle_deg"][rows], log.columns["output"][rows]
            design = np.column_stack([np.ones(angle.size), np.sin(np.radians(angle))])
            line = np.linalg.lstsq(design, output, rcond=None)[0]
            rest = (output - design @ line) / (line[1] * np.ptp(design[:, 1])) * 100.0
            series = (Series(said("residual"), pairs(angle, rest), "dots"),)
            title = said("Linearity over +-{span} degrees", span=span)
            found.append(Chart(title, said("commanded tilt [deg]"), said("residual [%FS]"), series))
    zero, scale = log.columns["output"][tests == "zero"], _value(result, "sensitivity")
    if zero.size > 2 and scale:
        minutes = np.arange(zero.size, dtype=np.float64)
        label = said("row")
        if log.has("time_s"):
            minutes = (log.columns["time_s"][tests == "zero"] - log.columns["time_s"][0]) / 60.0
            label = said("time [min]")
        drift = (zero - zero.mean()) / scale / ARCSEC
        series = (Series(said("zero"), pairs(minutes, drift)),)
        found.append(Chart(said("Zero about its mean"), label, said("zero [arcsec]"), series))
    return tuple(found)


def stop_pictures(result: Calibration, *, gravity: float) -> tuple[Picture, ...]:
    """Size of gravity at every stop, before and after.

    ``gravity`` [m/s2].
    """
    stops = result.extra.get("stops", [])
    if not stops:
        return ()
    number = range(1, len(stops) + 1)
    raw = [float(np.linalg.norm(s["force_m_s2"])) - gravity for s in stops]
    after = [s["gravity_m_s2"] - gravity for s in stops]
    label = said("size minus gravity [m/s2]")
    pictures: list[Picture] = [
        Chart(title, said("stop"), label, (_dots(word, number, values),))
        for title, word, values in (
            (said("Gravity at the stops, as measured"), said("as measured"), raw),
            (said("Gravity at the stops, calibrated"), said("calibrated"), after),
        )
    ]
    directions = np.array([s["force_m_s2"] for s in stops])
    cells = _whole(coverage_cells(directions))
    pictures.append(Coverage(said("Attitudes of the stops: where up was in the unit"), cells))
    return tuple(pictures)


def _dots(name: str, x: range, y: list[float]) -> Series:
    return Series(name, pairs(x, y), "dots")


def _value(result: Calibration, name: str) -> float | None:
    return next((p.value for p in result.parameters if p.name == name), None)
