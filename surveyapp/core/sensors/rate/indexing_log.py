"""``north --method indexing``: a log of index positions to heading, attitude and biases."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from surveyapp.core.sensors.rate.bias_track import StopSet, Tracked, track_bias
from surveyapp.core.sensors.rate.indexing import CONTRADICTING, solve_indexing
from surveyapp.core.sensors.rate.indexing_checks import index_problems, rate_problems
from surveyapp.core.sensors.rate.indexing_stops import (
    CYCLE,
    GYROS,
    OPTIONAL,
    calm,
    stops_of,
    with_sigmas,
)
from surveyapp.core.sensors.rate.indexing_values import Indexed, Root, Setting, Stop
from surveyapp.core.sensors.rate.parameters import DEG_H
from surveyapp.core.sensors.rate.strapdown import skew
from surveyapp.core.statistics.distributions import student_quantile
from surveyapp.domain.calibration import SensorParameter, with_reasons
from surveyapp.domain.north import NorthDirection, NorthResult
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats
from surveyapp_models.constants import EARTH_RATE
from surveyapp_models.rate import quaternions
from surveyapp_models.rate.attitude import azimuth_of, earth_rate

LEVEL_AXIS = math.radians(10.0)
EAST_WEST = math.radians(15.0)
APART = 3.0
"""Factor by which one attitude for all sets must fit worse than one for each."""
ALIGNED = math.radians(5.0)
"""Within these angles a degenerate attitude is told [rad]."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What stands beside the solution.

    Parameters
    ----------
    warnings : list of ResultWarning
    stops : int
        That were used.
    quantile : float
        Of Student's distribution: half of the 95 % interval in sigmas [-].
    """

    warnings: list[ResultWarning]
    stops: int
    quantile: float


@dataclass(frozen=True, slots=True)
class IndexingOptions:
    """What is stated beside the log.

    Parameters
    ----------
    setting : Setting
    track : bool
    fixed : SensorLog or None
        Log of a second unit that was not turned.
    force_matrix, force_bias : ndarray, shape (3, 3), (3,)
        Of the accelerometers: output = matrix force + bias [m/s2].
    card : str
        Where these and the matrix of the gyros come from; empty = nominal.
    """

    setting: Setting
    track: bool = False
    fixed: SensorLog | None = None
    force_matrix: Floats = field(default_factory=lambda: np.eye(3))
    force_bias: Floats = field(default_factory=lambda: np.zeros(3))
    card: str = ""


def find_heading(log: SensorLog, options: IndexingOptions) -> NorthResult:
    """Heading, attitude and biases from a log.

    Raises
    ------
    SurveyError
    """
    stops, rows, warnings = stops_of(log)
    stops = [_true_force(stop, options) for stop in stops]
    stops, dof = with_sigmas(stops, options.setting)
    if not options.card:
        text = (
            "no sensor card: the axes of gyros and accelerometers are taken as perpendicular and "
            "their scale factors as nominal; what they are off by is in no sigma (--card)"
        )
        warnings.append(ResultWarning("nominal_axes", text))
    groups = _groups(log, stops, rows)
    for group in groups:
        problems = index_problems(group.stops, options.setting, log.path)
        if problems:
            raise SurveyError(problems)
    if math.isfinite(dof):
        text = "one row a stop: the sigmas are the scatter of the stops about the solution"
        warnings.append(ResultWarning("rows_are_means", text))
    tracking: list[Tracked] = []
    found, used = solve_indexing(stops, options.setting), len(stops)
    cycles = len({group.cycle for group in groups})
    if cycles > 1:
        text = said(
            "the unit was switched off and on between the {count} sets: the bias is followed "
            "within a power cycle, and the heading is that of the last set",
            count=len(groups),
        )
        warnings.append(ResultWarning("power_cycles", text))
    apart = not options.track and _stood_differently(groups, found, options.setting)
    if apart and cycles == 1:
        text = said(
            "the unit stood differently in the {count} sets: the bias is followed from one to the "
            "next as with `track`, and the heading is that of the last",
            count=len(groups),
        )
        warnings.append(ResultWarning("sets_differ", text))
    if options.track or apart or cycles > 1:
        tracking = track_bias(groups, options.setting)
        last = tracking[-1]
        found, used = last.indexed, len(groups[-1].stops)
    if not found.roots:
        raise SurveyError(Problem("no attitude fits the log", log.path))
    problems = rate_problems(
        found.two_axis_rate, sigma=found.two_axis_sigma / found.misfit, where=log.path
    )
    if problems:
        raise SurveyError(problems)
    seen = Seen(warnings, used, student_quantile(0.975, dof))
    return _result(log, options, found, tracking, seen=seen)


def _true_force(stop: Stop, options: IndexingOptions) -> Stop:
    """The stop with the specific force that its card makes of the accelerometers."""
    if not options.card:
        return stop
    force = np.linalg.solve(options.force_matrix, stop.force - options.force_bias)
    return replace(stop, force=np.asarray(force))


def _stood_differently(groups: Sequence[StopSet], together: Indexed, setting: Setting) -> bool:
    """Whether each set fits an attitude of its own far better than all fit one."""
    worst = max(together.residual_scale, together.misfit)
    if len(groups) < 2 or worst <= APART:
        return False
    alone = [solve_indexing(group.stops, setting) for group in groups]
    return APART * max(max(one.residual_scale, one.misfit) for one in alone) < worst


def _groups(log: SensorLog, stops: Sequence[Stop], rows: Sequence[int]) -> list[StopSet]:
    """Stops by set and power cycle."""
    name = next((n for n in OPTIONAL[1:] if n in log.columns), None)
    groups: dict[tuple[int, int], StopSet] = {}
    for stop, row in zip(stops, rows, strict=True):
        number = 1 if name is None else round(float(log.columns[name][row]))
        cycle = 0 if CYCLE not in log.columns else round(float(log.columns[CYCLE][row]))
        time = float(log.columns["time_s"][row])
        groups.setdefault((number, cycle), StopSet(number, time, [], cycle)).stops.append(stop)
    return list(groups.values())


def _result(
    log: SensorLog,
    options: IndexingOptions,
    found: Indexed,
    tracking: Sequence[Tracked],
    *,
    seen: Seen,
) -> NorthResult:
    setting = options.setting
    best = found.roots[0]
    resolved = found.verdict == "resolved"
    sigma = best.heading_sigma()
    axis = "xyz"[setting.axis]
    missing: tuple[str, ...] = () if resolved else ("heading", f"bias_{axis}")
    spread = np.sqrt(np.maximum(np.diag(best.covariance), 0.0))
    parameters = []
    for k, letter in enumerate("xyz"):
        known = f"bias_{letter}" not in missing and spread[3 + k] < 1e3 * DEG_H
        value = float(best.bias[k]) / DEG_H if known else None
        one = float(spread[3 + k]) / DEG_H if known else None
        parameters.append(SensorParameter(f"bias_{letter}", value, one, "deg/h"))
    why = said("the index positions leave it open: the heading is {verdict}", verdict=found.verdict)
    parameters = list(with_reasons(parameters, lambda _: why))
    missing += tuple(p.name for p in parameters if p.value is None and p.name not in missing)
    direction = NorthDirection(
        math.degrees(best.heading) if resolved else None,
        sigma / ARCSEC if resolved else None,
        seen.quantile * sigma / ARCSEC if resolved else None,
    )
    geometry, told = _geometry(best, found, setting)
    q = quaternions.from_matrix(best.attitude)
    extra: dict[str, Any] = {
        "attitude_quaternion": q.tolist() if resolved else None,
        "attitude_sigma_deg": _attitude_sigma(best) if resolved else None,
        **_covariance(best),
        "third_axis": {
            "axis": axis,
            "verdict": found.verdict,
            "roots": [_root(r, best, setting.axis) for r in found.roots],
        },
        "geometry": geometry,
        "tracking": [t.to_dict() for t in tracking],
        "stops": seen.stops,
        "card": options.card or None,
        "fixed_gyro": None if options.fixed is None else _fixed(options.fixed, best, setting),
    }
    return NorthResult(
        method="indexing",
        source=log.id,
        key="heading",
        direction=direction,
        parameters=tuple(parameters),
        undetermined=missing,
        warnings=(*log.warnings, *seen.warnings, *told, *_warnings(found)),
        met=resolved and not missing,
        n=log.size,
        sha256=log.sha256,
        extra=extra,
        direction_extra={"axis": "z" if best.vertical else "y"},
    )


def _attitude_sigma(root: Root) -> float:
    """Of the rotation from the true to the found attitude [deg]."""
    variance = np.diag(root.covariance)[:3].copy()
    if root.profile_sigma is not None:
        variance[2] = root.profile_sigma**2
    return math.degrees(math.sqrt(float(np.sum(np.maximum(variance, 0.0)))))


def _covariance(root: Root) -> dict[str, Any]:
    scale = np.array([math.degrees(1.0)] * 3 + [1.0 / DEG_H] * 3)
    matrix = root.covariance * np.outer(scale, scale)
    names = ["rotation_east", "rotation_north", "rotation_up", "bias_x", "bias_y", "bias_z"]
    return {
        "covariance": matrix.tolist(),
        "covariance_names": names,
        "covariance_units": ["deg"] * 3 + ["deg/h"] * 3,
    }


def _root(root: Root, best: Root, axis: int) -> dict[str, Any]:
    gap = root.chi_square - best.chi_square
    return {
        "heading_deg": math.degrees(root.heading),
        "bias_deg_h": float(root.bias[axis]) / DEG_H,
        "chi_square_gap": gap,
        "odds_against": math.exp(min(0.5 * gap, 700.0)),
    }


def _geometry(
    root: Root, found: Indexed, setting: Setting
) -> tuple[dict[str, Any], list[ResultWarning]]:
    """Where the index axis points, and which degenerate attitude that is."""
    pointer = root.attitude[:, setting.axis]
    elevation = math.asin(min(1.0, max(-1.0, float(pointer[2]))))
    azimuth = azimuth_of(pointer)
    pole = earth_rate(setting.latitude) / EARTH_RATE
    to_pole = math.acos(min(1.0, abs(float(pole @ pointer))))
    told = []
    if to_pole < ALIGNED:
        text = (
            "the index axis lies along the earth's axis: two axes alone cannot point; gravity and "
            "the latitude still give the attitude"
        )
        told.append(ResultWarning("two_axis_pointing_lost", text))
    east_west = min(abs(math.cos(azimuth)), 1.0) < math.sin(EAST_WEST)
    if abs(elevation) < LEVEL_AXIS and east_west:
        text = (
            "the index axis is level and points east-west, the worst attitude of all: the heading "
            "is good to degrees only unless the bias is known beforehand"
        )
        told.append(ResultWarning("index_axis_east_west", text))
    if root.vertical:
        text = "the vehicle stands nearly upright: no heading; the azimuth of its z axis is given"
        told.append(ResultWarning("near_vertical", text))
    return {
        "two_axis_rate_deg_h": found.two_axis_rate / DEG_H,
        "two_axis_sigma_deg_h": found.two_axis_sigma / DEG_H,
        "index_axis_elevation_deg": math.degrees(elevation),
        "index_axis_azimuth_deg": math.degrees(azimuth),
        "index_axis_to_earth_axis_deg": math.degrees(to_pole),
        "near_vertical": root.vertical,
    }, told


def _fixed(log: SensorLog, root: Root, setting: Setting) -> dict[str, Any]:
    """Biases of the unit that was not turned, from the attitude of the other."""
    rates = np.column_stack([log.columns[c] for c in GYROS])
    keep = calm(rates)
    rates = rates[keep]
    earth = root.attitude.T @ earth_rate(setting.latitude)
    bias = rates.mean(axis=0) - earth
    turned = root.attitude.T @ skew(earth_rate(setting.latitude))
    known = np.diag(turned @ root.covariance[:3, :3] @ turned.T)
    sigma = np.sqrt(rates.var(axis=0, ddof=1) / rates.shape[0] + np.maximum(known, 0.0))
    return {
        "source": log.id,
        "parameters": [
            SensorParameter(f"bias_{a}", float(b) / DEG_H, float(s) / DEG_H, "deg/h").to_dict()
            for a, b, s in zip("xyz", bias, sigma, strict=True)
        ],
    }


def _warnings(found: Indexed) -> list[ResultWarning]:
    warnings = []
    if found.verdict == "ambiguous":
        headings = " and ".join(f"{math.degrees(r.heading):.2f}" for r in found.roots[:2])
        text = said(
            "two headings fit, {headings} degrees, at odds below a million: a bias "
            "known beforehand (--bias-prior-deg-h) or another attitude separates "
            "them",
            headings=headings,
        )
        warnings.append(ResultWarning("ambiguous", text))
    if found.verdict == "undetermined":
        text = "the index positions do not determine the heading"
        warnings.append(ResultWarning("undetermined", text))
    if found.misfit > CONTRADICTING:
        text = said(
            "attitude, latitude and rates contradict each other: they differ by {misfit:.1f} times "
            "what the stops allow; is the latitude right, and the scale factor?",
            misfit=found.misfit,
        )
        warnings.append(ResultWarning("inconsistent", text))
    if found.residual_scale > 1.0:
        text = said(
            "the stops scatter {residual_scale:.1f} times as much as their samples "
            "allow (index angles, wandering biases); the sigmas are widened by that",
            residual_scale=found.residual_scale,
        )
        warnings.append(ResultWarning("stops_scatter", text))
    return warnings
