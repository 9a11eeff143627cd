"""Rate sensors for scripts, re-exported by ``surveyapp.api``: plans, north, spectrum, motion."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from surveyapp.api.project import Folder
from surveyapp.api.sensors import LogOptions, open_sensor_log
from surveyapp.domain.line_spectrum import LineSpectrum
from surveyapp.domain.motion import Motion
from surveyapp.domain.north import NorthResult
from surveyapp.domain.warning import told_about
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import said

if TYPE_CHECKING:
    from surveyapp.core.sensors.rate.fog_station_plan import FogStationPlan
    from surveyapp.core.sensors.rate.stop_plan import StopPlan
    from surveyapp.domain.advance import PartDone


def plan_fog_station(
    *,
    elevation_deg: float | None = None,
    rate_deg_s: float | None = None,
    samples: int | None = None,
    relative_rate_sigma: float | None = None,
) -> FogStationPlan:
    """What one and two passes would reach, with the planning curves of source 001.

    Parameters
    ----------
    elevation_deg, rate_deg_s : float, optional
        Default 10 degrees, 30 deg/s.
    samples : int, optional
        Each way; default 300.
    relative_rate_sigma : float, optional
        Default 1e-4.

    Raises
    ------
    SurveyError
    """
    from surveyapp.core.sensors.rate import fog_station_plan as plan

    problems = []
    for option, value, low, high in (
        ("elevation_deg", elevation_deg, -89.0, 89.0),
        ("rate", rate_deg_s, 1e-6, 1e5),
        ("samples", samples, 1, 1e9),
        ("table_rate_relative_sigma", relative_rate_sigma, 0.0, 1.0),
    ):
        if value is not None and not low <= value <= high:
            problems.append(
                Problem(
                    "out of range",
                    option,
                    f"{value:g}",
                    said("{low:g} to {high:g}", low=low, high=high),
                )
            )
    if problems:
        raise SurveyError(problems)
    return plan.plan_fog_station(
        elevation_deg=plan.ELEVATION_DEG if elevation_deg is None else elevation_deg,
        rate_deg_s=plan.RATE_DEG_S if rate_deg_s is None else rate_deg_s,
        samples=plan.SAMPLES if samples is None else samples,
        relative_rate_sigma=(
            plan.RELATIVE_RATE_SIGMA if relative_rate_sigma is None else relative_rate_sigma
        ),
    )


def plan_north_stops(
    *,
    grade: str | None = None,
    latitude_deg: float | None = None,
    want_deg: float | None = None,
    route_m: float | None = None,
) -> StopPlan:
    """What stops of 10 to 300 s, every 0 to 100 m, would reach with a grade of gyro.

    Parameters
    ----------
    grade : str, optional
        Default mems.
    latitude_deg : float
        Must be stated.
    want_deg : float, optional
        Wanted standard deviation of the heading.
    route_m : float, optional
        Default 1000 m.

    Raises
    ------
    SurveyError
    """
    from surveyapp.core.sensors.rate import stop_plan as plan

    problems = []
    if latitude_deg is None:
        problems.append(Problem("the latitude is not stated", "latitude", "", "degrees"))
    elif not -90.0 < latitude_deg < 90.0:
        expected = "-90 to 90, the poles not among them"
        problems.append(Problem("this is no latitude", "latitude", f"{latitude_deg:g}", expected))
    name = grade or "mems"
    if name not in plan.GRADES:
        hint = nearest_names(name, plan.GRADES)
        problems.append(Problem("there is no such grade", "grade", name, hint=hint))
    for option, value in (("want_deg", want_deg), ("route_m", route_m)):
        if value is not None and not 0.0 < value < 1e9:
            problems.append(Problem("out of range", option, f"{value:g}", "above 0"))
    if problems or latitude_deg is None:
        raise SurveyError(problems)
    return plan.plan_stops(
        plan.GRADES[name],
        latitude_deg=latitude_deg,
        want_deg=want_deg,
        route_m=plan.ROUTE_M if route_m is None else route_m,
    )


def north(
    source: Folder,
    *,
    method: str | None = None,
    sensor: str | None = None,
    log: LogOptions | None = None,
    allow_outside: bool = False,
    options: Mapping[str, object] | None = None,
    progress: PartDone | None = None,
) -> NorthResult:
    """Find north from the log of a rate sensor.

    Parameters
    ----------
    source : path
        A CSV file, or a project folder together with ``sensor``.
    method : str, optional
        fog-station, indexing or rotation; may stand in the log's entry.
    sensor : str, optional
        Id of a ``[[sensor_log]]``.
    log : LogOptions, optional
    allow_outside : bool
    options : mapping, optional
        Of the method, under the names of the command line: ``latitude``, ``constant_deg`` ...
    progress : callable, optional

    Raises
    ------
    SurveyError
        For input that cannot be used.
    """
    from surveyapp.workflows.north import NorthRequest, find_north

    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    stated = opened.entry.options.get("method") if opened.entry is not None else None
    found = find_north(
        NorthRequest(
            method=method or str(stated or ""),
            file=opened.file,
            entry=opened.entry,
            options=options or {},
            folder=opened.folder,
            today=datetime.now(UTC).astimezone().date(),
            progress=progress,
        )
    )
    return told_about(found, opened.subject)


def spectrum(
    source: Folder,
    column: str,
    *,
    sensor: str | None = None,
    log: LogOptions | None = None,
    against: Folder | None = None,
    field_uT: float | None = None,
    sensitivity_deg_h_t: float | None = None,
    shielding: float | None = None,
    allow_outside: bool = False,
    progress: PartDone | None = None,
) -> LineSpectrum:
    """Interference lines of a column.

    Parameters
    ----------
    source : path
    column : str
        Canonical name, or the name in the file.
    sensor : str, optional
    log : LogOptions, optional
    against : path, optional
        Record of a second state, read in the same way.
    field_uT, sensitivity_deg_h_t, shielding : float, optional
        Magnetic budget: bias = sensitivity x field / shielding [uT, deg/h per T].
    allow_outside : bool
    progress : callable, optional

    Raises
    ------
    SurveyError
        For input that cannot be used.
    """
    from surveyapp.workflows.spectrum import MagneticOptions, find_spectrum

    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    other = None if against is None else open_sensor_log(against, log=log).file
    found = find_spectrum(
        opened.file,
        column,
        magnetic=MagneticOptions(field_uT, sensitivity_deg_h_t, shielding),
        against=other,
        entry=opened.entry,
        progress=progress,
    )
    return told_about(found, opened.subject)


def motion(
    source: Folder,
    *,
    sensor: str | None = None,
    log: LogOptions | None = None,
    allow_outside: bool = False,
    options: Mapping[str, object] | None = None,
    progress: PartDone | None = None,
) -> Motion:
    """State of motion of a vehicle, and its path.

    Parameters
    ----------
    source : path
    sensor : str, optional
    log : LogOptions, optional
    allow_outside : bool
    options : mapping, optional
        ``false_alarm``, ``path``, ``begin`` ("E,N,AZIMUTH"), ``end`` ("E,N"), ``snap``,
        ``snap_power_cycle``, ``still_gate_factor``; over those of the log's entry.
    progress : callable, optional

    Raises
    ------
    SurveyError
        For input that cannot be used.
    """
    from surveyapp.workflows.motion import find_motion, options_of

    opened = open_sensor_log(source, sensor=sensor, log=log, allow_outside=allow_outside)
    asked = options_of(opened.entry, options or {})
    found = find_motion(opened.file, asked, entry=opened.entry, progress=progress)
    return told_about(found, opened.subject)
