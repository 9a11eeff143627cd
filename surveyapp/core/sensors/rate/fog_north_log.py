"""``north --method fog-station``: one row a position, to north with its sigma."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from surveyapp.core.sensors.rate.fog_north import FogNorth, Position, solve_north
from surveyapp.core.sensors.rate.parameters import DEG_H
from surveyapp.domain.calibration import SensorParameter, with_reasons
from surveyapp.domain.north import NorthDirection, NorthResult
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC, wrap_pi
from surveyapp_models.constants import EARTH_RATE

NEEDED = ("gyr_x_rad_s", "horizontal_circle_deg", "face")
OPTIONAL = ("vertical_circle_deg", "temperature_c")
OFF_LEVEL = 60.0 * ARCSEC
"""Distance of a reading from the constant above which the rule of the circle matters [rad]."""
FAR = math.radians(30.0)
"""Distance of north from the stated one above which the stated one is in doubt [rad]."""
NOISE_SIGMAS = 10.0
"""Standard deviations of a row that two of them may differ by beside the earth rate; a gyro as
noisy as the earth rate finds no north."""
POLAR = math.radians(75.0)
"""Latitude above which a gyro finds no north that serves (source 000-18) [rad]."""


@dataclass(frozen=True, slots=True)
class FogNorthOptions:
    """What is stated beside the rows.

    Parameters
    ----------
    latitude, approximate_north : float
        [rad]
    constant, constant_sigma : float or None
        [rad]
    rate_sigma : float or None
        Standard deviation of one row [rad/s].
    rule : str or None
        increases | decreases; None = not stated.
    """

    latitude: float
    approximate_north: float
    constant: float | None = None
    constant_sigma: float | None = None
    rate_sigma: float | None = None
    rule: str | None = None


_WHY = {
    "bias": said("positions east and west tell bias and collimation apart"),
    "elevation": said("no position of the other face, and no constant with its circle readings"),
    "collimation": said("positions east and west tell bias and collimation apart"),
}
"""Why a parameter has no value."""


def find_north(log: SensorLog, options: FogNorthOptions) -> NorthResult:
    """North of the horizontal circle from the rows of a log.

    Raises
    ------
    SurveyError
    """
    positions = _positions(log)
    _need_a_gyro_at_rest(log, options)
    solved = solve_north(
        positions,
        latitude=options.latitude,
        approximate_north=options.approximate_north,
        constant=options.constant,
        constant_sigma=options.constant_sigma or 0.0,
        rate_sigma=options.rate_sigma,
        reading_increases=options.rule != "decreases",
    )
    direction = NorthDirection(
        None if solved.north is None else math.degrees(solved.north),
        _in(solved.sigma, ARCSEC),
        _in(solved.interval95, ARCSEC),
    )
    parameters = tuple(
        SensorParameter(name, _in(value, unit), _in(sigma, unit), text)
        for name, value, sigma, unit, text in (
            ("bias", solved.bias, solved.sigmas[0], DEG_H, "deg/h"),
            ("elevation", solved.elevation, solved.sigmas[2], ARCSEC, "arcsec"),
            ("collimation", solved.collimation, solved.sigmas[1], ARCSEC, "arcsec"),
        )
    )
    parameters = with_reasons(parameters, _WHY.__getitem__)
    missing = tuple("gyro_north" if n == "north" else n for n in solved.undetermined)
    return NorthResult(
        method="fog-station",
        source=log.id,
        key="gyro_north",
        direction=direction,
        parameters=parameters,
        undetermined=missing,
        warnings=(*log.warnings, *_warnings(positions, solved, options)),
        met=not missing,
        n=log.size,
        sha256=log.sha256,
        extra={
            "geometry": {"undetermined": list(missing)},
            "residual_rms_deg_h": solved.residual_rms / DEG_H,
            "dof": solved.dof,
            "latitude_deg": math.degrees(options.latitude),
        },
    )


def _need_a_gyro_at_rest(log: SensorLog, options: FogNorthOptions) -> None:
    """At rest two positions differ by twice the earth rate at most: else it is another unit."""
    rates = log.columns["gyr_x_rad_s"]
    allowed = 2.0 * EARTH_RATE + NOISE_SIGMAS * max(options.rate_sigma or 0.0, EARTH_RATE)
    apart = float(np.ptp(rates)) if rates.size else 0.0
    if apart <= allowed:
        return
    raise SurveyError(
        Problem(
            "the positions differ by more than the earth turns",
            said("{path}, gyr_x_rad_s", path=log.path),
            said("{value:.6g} deg/h apart", value=apart / DEG_H),
            said("{value:.6g} deg/h at most", value=allowed / DEG_H),
            "is it in rad/s, and was the instrument at rest? `units` COLUMN=deg/h",
        )
    )


def _in(value: float | None, unit: float) -> float | None:
    return None if value is None else value / unit


def _positions(log: SensorLog) -> list[Position]:
    problems = []
    rows = []
    readings = log.columns.get("vertical_circle_deg", np.full(log.size, np.nan))
    for k in range(log.size):
        face = log.texts["face"][k].strip().upper()
        if face not in ("L", "R"):
            hint = "L = direct, R = plunged"
            where = said("{path}, row {row}", path=log.path, row=k + 1)
            problems.append(Problem("this is no face", where, face, "L or R", hint))
            continue
        vertical = float(readings[k])
        rows.append(
            Position(
                float(log.columns["gyr_x_rad_s"][k]),
                math.radians(float(log.columns["horizontal_circle_deg"][k])),
                math.radians(vertical) if math.isfinite(vertical) else None,
                face == "R",
            )
        )
    if problems:
        raise SurveyError(problems)
    return rows


def _warnings(
    positions: list[Position], solved: FogNorth, options: FogNorthOptions
) -> list[ResultWarning]:
    warnings = []
    if options.rate_sigma is None and solved.sigma is None:
        text = "no --rate-sigma-deg-h and no row to spare: no sigma can be given"
        warnings.append(ResultWarning("no_rate_sigma", text))
    if options.constant is not None and options.rule is None:
        off = [
            abs(wrap_pi(p.vertical - options.constant - (math.pi if p.plunged else 0.0)))
            for p in positions
            if p.vertical is not None
        ]
        if off and max(off) > OFF_LEVEL:
            text = said(
                'a vertical reading lies {value:.0f}" off the constant and '
                "--reading-from-elevation is not stated: increases was taken",
                value=max(off) / ARCSEC,
            )
            warnings.append(ResultWarning("rule_not_stated", text))
    if solved.undetermined:
        text = said(
            "not determined by these positions: {names}", names=", ".join(solved.undetermined)
        )
        if "collimation" in solved.undetermined:
            text += said("; positions east AND west tell bias and collimation apart")
        if "north" in solved.undetermined:
            text += said("; two positions (plunging only) need --constant-deg")
        warnings.append(ResultWarning("undetermined", text))
    if solved.north is not None:
        warnings += _far_from_stated(wrap_pi(solved.north - options.approximate_north))
    if abs(options.latitude) > POLAR:
        text = "beyond 75 degrees of latitude the level earth rate is too small for mine surveying"
        warnings.append(ResultWarning("high_latitude", text))
    return warnings


def _far_from_stated(difference: float) -> list[ResultWarning]:
    """That the approximate north decides between two norths and fits neither."""
    if abs(difference) <= FAR:
        return []
    text = said(
        "north lies {degrees:.0f} degrees from the stated approximate north, and the other "
        "possibility {others:.0f}: a wrong statement turns north by 180 degrees; check it with "
        "a compass or a known line",
        degrees=abs(math.degrees(difference)),
        others=180.0 - abs(math.degrees(difference)),
    )
    return [ResultWarning("approximate_north_far", text)]
