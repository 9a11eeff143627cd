"""A reversal run as a problem: turning points of a swing, N + A s_k exp(-k t) as the base model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from surveyapp.diagnosis.candidates import SHAPE_ODDS
from surveyapp.diagnosis.case import Case, Levels
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.angles import circular_mean, wrap_pi_array
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect

LEAST_POINTS = 4
LEVELS = Levels(further=0.01, shape_odds=SHAPE_ODDS)
"""By simulation, on records that were not used again (docs/explanation/diagnosis.md): at .05 beside
a first effect more names are wrong, and shapes that count as causes keep off right names only."""
IRREGULAR = 0.3
"""Share of a half swing by which a time may miss the count of turning points."""


@dataclass(frozen=True, slots=True)
class TurningPoints:
    """What a reversal run hands over.

    Parameters
    ----------
    readings : sequence of float
        Circle readings at the turning points [rad], in order, missed ones left out.
    count : sequence of float, optional
        Number of each turning point with missed ones counted; 0, 1, 2 ... if absent.
    right : sequence of bool, optional
        True at the right (east, larger) side; from the readings if absent.
    elapsed_s : sequence of float or None, optional
        Times [s].
    covariates : mapping
        Further columns, such as temperature_c; NaN = not read.
    resolution : float
        Of the readings [rad]; 0 = unknown.
    sigma : float or None
        Stated standard deviation of one turning point [rad].
    reference_temperature_c : float or None
    instrument, identity : str
    """

    readings: Sequence[float]
    count: Sequence[float] | None = None
    right: Sequence[bool] | None = None
    elapsed_s: Sequence[float] | None = None
    covariates: Mapping[str, Sequence[float]] = field(default_factory=dict)
    resolution: float = 0.0
    sigma: float | None = None
    reference_temperature_c: float | None = None
    instrument: str = ""
    identity: str = ""


def reversal_run(points: TurningPoints, extra: tuple[Effect, ...] = ()) -> Case:
    """Make the problem of a reversal run.

    Parameters
    ----------
    points : TurningPoints
    extra : tuple of Effect
        The user's own effects.

    Returns
    -------
    Case

    Raises
    ------
    SurveyError
        If there are fewer than four turning points, or they do not swing.
    """
    readings = np.asarray(points.readings, dtype=np.float64)
    _check(points, readings)
    n = readings.size
    count = np.asarray(np.arange(n) if points.count is None else points.count, dtype=np.float64)
    number = count - count[0]
    offset = _middle(readings)
    y = wrap_pi_array(readings - offset)
    temperature = points.reference_temperature_c
    return Case(
        levels=LEVELS,
        subject="reversal_run",
        title=said("run"),
        value_name=said("north over the run"),
        observations=y,
        base=np.ones((n, 1)),
        base_names=("north",),
        value_base=np.ones(1),
        value_weights=np.full(n, 1.0 / n),
        position=number,
        columns=_columns(points),
        effects=(*of_subject("reversal_run"), *extra),
        side=_sides(points, y, count),
        half_swing=number,
        sigma=None if points.sigma is None else np.full(n, points.sigma),
        resolution=points.resolution,
        references={} if temperature is None else {"temperature_c": temperature},
        offset=offset,
        direction=True,
        instrument=points.instrument,
        identity=points.identity,
        labels=tuple(said("turning point {int}", int=int(k) + 1) for k in number),
        warnings=_warnings(points, count),
    )


def _columns(points: TurningPoints) -> dict[str, Floats]:
    columns = {name: np.asarray(v, dtype=np.float64) for name, v in points.covariates.items()}
    if points.elapsed_s is not None:
        columns["elapsed_s"] = np.asarray(points.elapsed_s, dtype=np.float64)
    return columns


def _middle(readings: Floats) -> float:
    """Middle of the swing; of one wider than half a circle, as read without passing zero."""
    try:
        return circular_mean(readings)
    except ValueError:
        return float(0.5 * (readings.min() + readings.max()))


def _check(points: TurningPoints, readings: Floats) -> None:
    faults = []
    if readings.size < LEAST_POINTS:
        faults.append(
            Problem(
                "too few turning points to diagnose a run",
                points.identity,
                str(readings.size),
                said(
                    "at least {least_points}; from 8 on an effect can be named",
                    least_points=LEAST_POINTS,
                ),
                "Three turning points give north but nothing to check it with.",
            )
        )
    elif np.ptp(wrap_pi_array(readings - readings[0])) == 0.0:
        faults.append(
            Problem(
                "the turning points do not swing",
                points.identity,
                "all readings equal",
                "readings alternating between the two sides",
                "Was the gyro clamped, or one reading copied?",
            )
        )
    for name, values in (("count", points.count), ("elapsed_s", points.elapsed_s)):
        if values is not None and len(values) != readings.size:
            faults.append(
                Problem(
                    said("{name} does not belong to these readings", name=name),
                    points.identity,
                    str(len(values)),
                    str(readings.size),
                )
            )
        elif values is not None and np.any(np.diff(np.asarray(values, dtype=float)) <= 0.0):
            faults.append(
                Problem(
                    said("{name} does not increase", name=name),
                    points.identity,
                    "",
                    "increasing values",
                )
            )
    if not np.isfinite(readings).all():
        faults.append(Problem("a reading is no number", points.identity, "nan", "angles"))
    if faults:
        raise SurveyError(faults)


def _sides(points: TurningPoints, y: Floats, count: Floats) -> Floats:
    """+1 right, -1 left; alternating with the count, whatever single readings look like."""
    parity = np.where(np.round(count - count[0]) % 2 == 0, 1.0, -1.0)
    if points.right is not None:
        side = np.where(np.asarray(points.right, dtype=bool), 1.0, -1.0)
        if np.any(side * side[0] != parity):
            raise SurveyError(
                Problem(
                    "two turning points on one side follow each other",
                    points.identity,
                    "",
                    "sides that alternate with the count of turning points",
                    "Was one turning point missed? Count it.",
                )
            )
        return side
    even, odd = y[parity > 0.0], y[parity < 0.0]
    first_is_right = float(np.median(even)) >= float(np.median(odd))
    return parity if first_is_right else -parity


def _warnings(points: TurningPoints, count: Floats) -> tuple[ResultWarning, ...]:
    if points.elapsed_s is None:
        text = said(
            "no times: the number of the turning point stands in for time, rates and "
            "time constants are per half swing"
        )
        return (ResultWarning("no_times", text),)
    return tuple(_time_warnings(np.asarray(points.elapsed_s, dtype=np.float64), count))


def _time_warnings(times: Floats, count: Floats) -> list[ResultWarning]:
    if not np.isfinite(times).all() or times.size < 3:
        return [ResultWarning("times_incomplete", said("times are incomplete and are not used"))]
    slope, start = np.polyfit(count, times, 1)
    off = np.abs(times - start - slope * count) / max(abs(float(slope)), 1e-9)
    if float(off.max()) > IRREGULAR:
        k = int(np.argmax(off))
        return [
            ResultWarning(
                "times_disagree",
                said(
                    "the time of turning point {int} does not agree with the count of half "
                    "swings; perhaps one was missed",
                    int=int(count[k] - count[0]) + 1,
                ),
            )
        ]
    return []
