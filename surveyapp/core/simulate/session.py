"""One simulated session as a field book, with its truth beside it.

The rows are what a surveyor would have written, in the columns of the field book; that they pass
through text is the point: the reduction reads them like any other book.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import math
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

import numpy as np

from surveyapp.core.simulate.disturbing import tripod_twist
from surveyapp.core.simulate.specification import RUN_EFFECTS, SessionSpec
from surveyapp.core.simulate.turning_points import (
    SimulatedPoints,
    Timetable,
    simulate_turning_points,
    tape_zero_div,
    timetable,
)
from surveyapp.domain.readings import COLUMNS
from surveyapp_models.angles import RHO_ARCSEC, AngleUnit, format_angle, wrap_two_pi
from surveyapp_models.gyro.motion import swing_position, turning_times_s, unspun_swing
from surveyapp_models.gyro.periods import clamped_period_s, tracking_period_s

UNSPUN_AMPLITUDE_DIV = 4.0
"""First amplitude of the simulated unspun swing [div]."""
UNSPUN_RATIO = 0.97
"""Its amplitude ratio per half swing: air and tape damp it more than the spinning gyro."""

Row = dict[str, str]


@dataclass(frozen=True, slots=True)
class SimulatedSession:
    """A session as observed, and what it was made from.

    Parameters
    ----------
    spec : SessionSpec
    rows : tuple of dict
        Column to text, in the order of the book.
    truth : dict
        Values of JSON: gyro north, line reading, effects with their sizes; for truth files only.
    """

    spec: SessionSpec
    rows: tuple[Row, ...]
    truth: dict[str, Any]


@dataclass(frozen=True, slots=True)
class _Entry:
    """A row before it is numbered; ``moment_s`` counts from the first turning point."""

    moment_s: float
    kind: str
    value: str
    unit: str = ""
    face: str = ""
    side: str = ""
    temperature_c: str = ""


def simulate_session(spec: SessionSpec, rng: np.random.Generator) -> SimulatedSession:
    """Simulate one session of any swing method.

    Parameters
    ----------
    spec : SessionSpec
    rng : numpy.random.Generator

    Returns
    -------
    SimulatedSession

    Raises
    ------
    ValueError
        If the swing, disturbed as asked, does not reach a line that is to be timed.
    """
    return simulate_sessions(spec, 1, rng)[0]


def simulate_sessions(
    spec: SessionSpec, runs: int, rng: np.random.Generator
) -> tuple[SimulatedSession, ...]:
    """Simulate many sessions of one specification at a fraction of the time of each by itself.

    Parameters
    ----------
    spec : SessionSpec
    runs : int
        Each draws its own noise, paths, places and phases.
    rng : numpy.random.Generator

    Returns
    -------
    tuple of SimulatedSession

    Raises
    ------
    ValueError
        If a swing, disturbed as asked, does not reach a line that is to be timed.
    """
    points = simulate_turning_points(spec, runs, rng)
    table = timetable(spec)
    return tuple(_session(spec, _one_run(points, run), table, rng) for run in range(runs))


def _one_run(points: SimulatedPoints, run: int) -> SimulatedPoints:
    """The ensemble of one run."""
    arrays = {
        field.name: getattr(points, field.name)[run : run + 1]
        for field in dataclasses.fields(points)
        if field.name != "drawn"
    }
    drawn = {name: values[run : run + 1] for name, values in points.drawn.items()}
    return SimulatedPoints(**arrays, drawn=drawn)


def _session(
    spec: SessionSpec, points: SimulatedPoints, table: Timetable, rng: np.random.Generator
) -> SimulatedSession:
    entries = [
        *_tape_zeros(spec, table.zero_before_s, table, rng),
        *_sights(spec, -300.0, rng),
        *_clamp(spec),
        *_swing(spec, points, rng),
        *_sights(spec, table.last_s + 150.0, rng),
        *_tape_zeros(spec, table.zero_after_s, table, rng),
    ]
    entries.sort(key=lambda entry: entry.moment_s)
    begin = math.floor(entries[0].moment_s)
    rows = tuple(_row(spec, seq, entry, begin) for seq, entry in enumerate(entries, start=1))
    return SimulatedSession(spec, rows, _truth(spec, points, table))


def book_text(rows: tuple[Row, ...]) -> str:
    """Return the rows as the text of a field book."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def circle_text(angle: float, resolution: float) -> str:
    """Return a circle reading [rad] as dms text with the decimals of its resolution [rad]."""
    step = resolution * RHO_ARCSEC
    decimals = 3 if step <= 0.0 else min(max(0, math.ceil(-math.log10(step) - 1e-9)), 6)
    return format_angle(wrap_two_pi(angle), AngleUnit.DMS, decimals)


def _row(spec: SessionSpec, seq: int, entry: _Entry, begin: float) -> Row:
    row = dict.fromkeys(COLUMNS, "")
    row.update(seq=str(seq), kind=entry.kind, value=entry.value, unit=entry.unit)
    row.update(face=entry.face, side=entry.side, temperature_c=entry.temperature_c)
    if spec.times or spec.timed:
        elapsed = entry.moment_s - begin
        row["elapsed_s"] = f"{elapsed:.3f}"
        moment = spec.start + timedelta(seconds=round(elapsed, 3))
        row["time"] = moment.isoformat(timespec="milliseconds")
    return row


def _sights(spec: SessionSpec, moment_s: float, rng: np.random.Generator) -> list[_Entry]:
    turn = float(tripod_twist(spec, moment_s + 20.0, timetable(spec).last_s))
    line = spec.circle_of_north + spec.line_azimuth - turn
    errors = rng.normal(scale=spec.noise.sight, size=2)
    left = line + spec.collimation + float(errors[0])
    right = line + math.pi - spec.collimation + float(errors[1])
    resolution = min(spec.noise.reading_resolution, 0.1 / RHO_ARCSEC)
    return [
        _Entry(moment_s, "backsight", circle_text(left, resolution), "dms", face="L"),
        _Entry(moment_s + 40.0, "backsight", circle_text(right, resolution), "dms", face="R"),
    ]


def _clamp(spec: SessionSpec) -> list[_Entry]:
    if not spec.clamped:
        return []
    reading = spec.circle_of_north + spec.constant + spec.clamp_offset
    return [_Entry(-150.0, "clamp", circle_text(reading, spec.noise.reading_resolution), "dms")]


def _div_text(value: float, resolution: float) -> str:
    if resolution <= 0.0:
        return f"{value:.6f}"
    decimals = min(max(0, math.ceil(-math.log10(resolution) - 1e-9)), 6)
    return f"{round(value / resolution) * resolution:.{decimals}f}"


def _tape_zeros(
    spec: SessionSpec, middle_s: float, table: Timetable, rng: np.random.Generator
) -> list[_Entry]:
    """The unspun swing about the tape zero, which drifts on while it is observed."""
    count = spec.tape_zero_points
    if count == 0:
        return []
    decay = -math.log(UNSPUN_RATIO) / table.unspun_half_swing_s
    phase = float(rng.choice([0.0, math.pi]))
    swing = unspun_swing(
        spec.gyro, rest=0.0, amplitude=UNSPUN_AMPLITUDE_DIV, phase=phase, decay=decay
    )
    times = turning_times_s(swing, count)
    moments = times - times.mean() + middle_s
    values = swing_position(swing, times) + tape_zero_div(spec, moments)
    values = values + rng.normal(scale=spec.noise.scale_div, size=count)
    resolution = spec.noise.scale_resolution_div
    return [
        _Entry(float(moment), "tape_zero", _div_text(float(value), resolution), "div")
        for moment, value in zip(moments, values, strict=True)
    ]


def _swing(spec: SessionSpec, points: SimulatedPoints, rng: np.random.Generator) -> list[_Entry]:
    noise = spec.noise
    readings, times = points.readings[0], points.time_s[0]
    times = times + rng.normal(scale=noise.time_s, size=times.shape)
    motion = points.motion[0]
    larger = motion[0] > motion[1]
    kind = "scale_reversal" if spec.clamped else "reversal"
    entries = []
    for index, (value, moment) in enumerate(zip(readings, times, strict=True)):
        temperature = f"{points.temperature_c[0, index]:.2f}" if spec.temperature_span_c else ""
        if index in spec.missed:
            entries.append(_Entry(float(moment), "missed", ""))
            continue
        if spec.clamped:
            text, unit = _div_text(float(value), noise.scale_resolution_div), "div"
        else:
            text, unit = circle_text(float(value), noise.reading_resolution), "dms"
        side = "R" if larger == (index % 2 == 0) else "L"
        entries.append(
            _Entry(float(moment), kind, text, unit, side=side, temperature_c=temperature)
        )
    for line, moments in zip(spec.lines_div, points.passage_time_s[0], strict=False):
        entries += [_Entry(float(t), "transit", f"{line:g}", "div") for t in moments]
    return entries


def _truth(spec: SessionSpec, points: SimulatedPoints, table: Timetable) -> dict[str, Any]:
    north = float(points.gyro_north[0].mean())
    line = spec.circle_of_north + spec.line_azimuth
    gyro = spec.gyro
    kinds = {kind.id: kind for kind in RUN_EFFECTS}
    return {
        "method": spec.method,
        "latitude_deg": math.degrees(spec.latitude),
        "gyro_north_deg": math.degrees(wrap_two_pi(north)),
        "run_mean_north_deg": math.degrees(wrap_two_pi(float(points.run_north[0].mean()))),
        "line_reading_deg": math.degrees(wrap_two_pi(line)),
        "gyro_azimuth_deg": math.degrees(wrap_two_pi(line - north)),
        "azimuth_deg": math.degrees(wrap_two_pi(spec.line_azimuth)),
        "constant_arcsec": spec.constant * RHO_ARCSEC,
        "tape_zero_div": list(spec.tape_zero_div),
        "ratio_per_half_swing": spec.ratio,
        "period_s": 2.0 * table.half_swing_s,
        "tracking_period_s": tracking_period_s(gyro, spec.latitude),
        "clamped_period_s": clamped_period_s(gyro, spec.latitude),
        "gyro_north_of_points_arcsec": [
            float(value) for value in (points.gyro_north[0] - north) * RHO_ARCSEC
        ],
        "midpoint_of_points_deg": [
            math.degrees(wrap_two_pi(float(value))) for value in points.midpoint[0]
        ],
        "effects": [
            {
                "id": effect.id,
                "size": effect.size / kinds[effect.id].to_internal,
                "unit": kinds[effect.id].unit,
                "options": dict(effect.options),
            }
            for effect in spec.effects
        ],
        "drawn": {name: float(values[0]) for name, values in points.drawn.items()},
    }
