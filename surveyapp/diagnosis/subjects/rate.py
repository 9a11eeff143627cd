"""A rate sensor as a subject: the outputs of its stops, and of the turns between them.

A stop is a rest in some attitude, or whole turns of a table at a known rate: a row for each gyro. A
turn by hand from one rest to the next gives two rows, the angles by which the gyros missed the
direction of gravity. The base model is bias, scale factor and misalignment; of rests alone it is
the bias.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.sensors.rate.hand_held import TurnRows
from surveyapp.diagnosis.action import Action, last_rows
from surveyapp.diagnosis.case import Case, Levels, OwnScale
from surveyapp.diagnosis.crooked_seats import Seats, crooked_seats
from surveyapp.diagnosis.subject import DiagnosedSubject, Record, case_of
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Column, Columns, Effect
from surveyapp_models.effects.rate import (
    AXIS,
    DEG_S,
    ELAPSED,
    FIELDS,
    FORCES,
    GYRO_FORCES,
    GYRO_RATES,
    GYRO_SIZES,
    INPUTS,
    PLACE,
    STOP,
    TEMPERATURE,
    by_axis,
    flip_error,
)
from surveyapp_models.effects.rate.gross_error import rows as rows_of

LEAST_STOPS = 4
LEVELS = Levels(first=0.04, further=0.01)
"""Of the stops of a log whose samples are searched for lines beside: together one false alarm in
twenty, and beside a right name two wrong ones in a hundred. An effect that would just pass one gate
of .05 four times in five passes that of .01 three times in five: the price."""
LEAN = "lean"
"""Column of what the earth's rate along a table's axis does."""
SEAT = "seat_"
"""Columns of what crooked seats do begin so."""


@dataclass(frozen=True, slots=True)
class RateStop:
    """What the gyros showed at one stop.

    Parameters
    ----------
    output : ndarray, shape (3,)
        [rad/s]; what is known of the earth rate taken out.
    elapsed_s : float
    force : ndarray, shape (3,), or None
        [m/s2]
    known : ndarray, shape (3,), or None
        Known rate of the body [rad/s]; None = at rest.
    place : int or None
        Position on the table.
    temperature_c : float or None
    field : ndarray, shape (3,), or None
        [T]
    label : str
    rows : tuple of int, or None
        First and last row of the log, last exclusive.
    node : int or None
        Temperature of the chamber, from 1: the biases are taken anew at each.
    lean : ndarray, shape (3,), or None
        Direction of the table's axis in the body where the earth's rate along it is not known.
    """

    output: Floats
    elapsed_s: float
    force: Floats | None = None
    known: Floats | None = None
    place: int | None = None
    temperature_c: float | None = None
    field: Floats | None = None
    label: str = ""
    rows: tuple[int, int] | None = None
    node: int | None = None
    lean: Floats | None = None


@dataclass(frozen=True, slots=True)
class RateTurn:
    """A turn between two rests.

    Parameters
    ----------
    rows : TurnRows
    elapsed_s : float
        Of its middle.
    duration_s : float
    temperature_c : float or None
    label : str
    """

    rows: TurnRows
    elapsed_s: float
    duration_s: float
    temperature_c: float | None = None
    label: str = ""


def rest_base(columns: Columns, /) -> Floats:
    """A bias for each gyro, at each temperature of a chamber, shape (n, 3 nodes)."""
    if "node" not in columns:
        return by_axis(columns, np.ones(columns["axis"].size))
    nodes = np.unique(columns["node"])
    return np.hstack([by_axis(columns, (columns["node"] == k).astype(float)) for k in nodes])


def turned_base(columns: Columns, /) -> Floats:
    """Bias and response to the rates of each gyro, shape (n, 9 + 3 nodes).

    One column more where the earth's rate along the table's axis is not known.
    """
    free = [columns[LEAN]] if LEAN in columns else []
    rates = [columns[need.name] for need in GYRO_RATES]
    return np.column_stack([rest_base(columns), *rates, *free])


def _repeated(columns: Columns) -> dict[str, Floats]:
    """Rows of one more stop as the last one was."""
    stop = columns["stop"][columns["axis"] < 3.0].max()
    here = columns["stop"] == stop
    return {**last_rows({name: values[here] for name, values in columns.items()}, 3)}


def _upside_down(columns: Columns, /) -> dict[str, Floats] | None:
    """The last stop with every force reversed."""
    if "force_x" not in columns:
        return None
    rows = _repeated(columns)
    forces = [need.name for need in (*FORCES, *GYRO_FORCES)]
    return {**rows, **{name: -rows[name] for name in forces}}


def _warmer(columns: Columns, /) -> dict[str, Floats] | None:
    """The last stop five kelvin warmer."""
    if "temperature_c" not in columns:
        return None
    rows = _repeated(columns)
    return {**rows, "temperature_c": rows["temperature_c"] + 5.0}


ACTIONS = (
    Action("upside_down", said("repeat the last stop upside down"), _upside_down),
    Action("warmer", said("repeat the last stop 5 K warmer"), _warmer),
)
NODE = Column("node", "number of the chamber's temperature, from 1")
COLUMNS = (
    *(AXIS, STOP, NODE, ELAPSED, TEMPERATURE, PLACE),
    *(*FORCES, *INPUTS, *FIELDS),
    *(*GYRO_FORCES, *GYRO_RATES, *GYRO_SIZES),
)


def seated_base(columns: Columns, /) -> Floats:
    """Bias, response, and what crooked seats do, shape (n, 12 + k)."""
    names = sorted((n for n in columns if n.startswith(SEAT)), key=lambda n: int(n[len(SEAT) :]))
    return np.column_stack([turned_base(columns), *(columns[name] for name in names)])


def rate_subject(
    *, turned: bool, nodes: int = 0, lean: bool = False, seats: int = 0
) -> DiagnosedSubject:
    """The subject of stops at rest, or of stops on a table that turned, perhaps in a chamber.

    With ``lean`` the earth's rate along the table's axis is free; ``seats`` columns of the record
    say what crooked seats do.
    """
    biases = tuple(f"bias_{a}" for a in "xyz")
    if nodes:
        biases = tuple(f"bias_{a}_node_{k + 1}" for k in range(nodes) for a in "xyz")
    matrix = tuple(f"response_{a}{b}" for a in "xyz" for b in "xyz")
    names = (*biases, *matrix) if turned else biases
    names = (*names, "earth_rate_along_table") if lean else names
    names = (*names, *(f"{SEAT}{k + 1}" for k in range(seats)))
    return DiagnosedSubject(
        id="rate",
        title=said("a rate sensor"),
        value_name=said("the mean bias of the three gyros"),
        columns=COLUMNS,
        base=seated_base if seats else (turned_base if turned else rest_base),
        base_names=names,
        effects=of_subject("rate"),
        value=tuple(1.0 / len(biases) if k < len(biases) else 0.0 for k in range(len(names))),
        actions=ACTIONS,
        unit="deg/s",
        scale=DEG_S,
        position="elapsed_s",
    )


def rate_case(
    stops: Sequence[RateStop],
    turns: Sequence[RateTurn] = (),
    *,
    identity: str,
    extra: tuple[Effect, ...] = (),
    seats: Seats | None = None,
) -> Case:
    """The case of the stops of a record and of the turns between them.

    Raises
    ------
    SurveyError
        If there are too few.
    """
    if len(stops) < LEAST_STOPS:
        raise SurveyError(
            Problem(
                "too few stops to diagnose",
                identity,
                str(len(stops)),
                said("{least_stops} or more", least_stops=LEAST_STOPS),
            )
        )
    columns = _stop_columns(stops)
    if seats is not None:
        columns |= {f"{SEAT}{k + 1}": c for k, c in enumerate(seats.columns.T)}
    observed = np.concatenate([s.output for s in stops])
    labels = [f"{s.label or f'stop {k + 1}'}, gyro {a}" for k, s in enumerate(stops) for a in "xyz"]
    series, rests = columns["axis"], observed.size
    sigma: Floats | None = None
    scales: tuple[OwnScale, ...] = ()
    if turns:
        columns = _with_turns(columns, turns, start=stops[0].elapsed_s)
        observed = np.concatenate([observed, *(t.rows.error for t in turns)])
        labels += [f"{t.label}, {which} angle" for t in turns for which in ("first", "second")]
        series = np.append(series, np.full(2 * len(turns), np.nan))
        sigma, scales = _sigmas(columns, observed, rests)
    record = Record(
        observed,
        columns,
        sigma=sigma,
        identity=identity,
        labels=tuple(labels),
        grid_labels={"row": dict(zip(rows_of(columns).tolist(), labels, strict=True))},
        groups=columns["stop"],
        series=series,
        extra=extra,
    )
    turned = bool(turns) or any(s.known is not None for s in stops)
    nodes = np.unique(columns["node"]).size if "node" in columns else 0
    effective = 0 if seats is None else seats.effective
    subject = rate_subject(turned=turned, nodes=nodes, lean=LEAN in columns, seats=effective)
    case = case_of(subject, record)
    told = np.arange(observed.size) < rests
    weights = np.where(told, 1.0 / rests, 0.0)
    case = replace(case, nuisance=effective, own_scales=scales, levels=LEVELS)
    return replace(case, value_weights=weights, reported=told.astype(np.float64))


def seats_of(stops: Sequence[RateStop]) -> Seats | None:
    """Whether every position of a table sits crookedly; in a chamber the matrix may vary too."""
    if any(s.known is None or s.place is None or s.node is not None for s in stops):
        return None
    if len(stops) < LEAST_STOPS:
        return None
    columns = _stop_columns(stops)
    by_place = [flip_error.basis(columns, place=place) for place in flip_error.places(columns)]
    observed = np.concatenate([s.output for s in stops])
    return crooked_seats(observed, turned_base(columns), by_place)


def _stop_columns(stops: Sequence[RateStop]) -> dict[str, Floats]:
    """What is known at each stop, three rows each."""
    turned = any(s.known is not None for s in stops)
    count = len(stops)

    def each(values: Sequence[float]) -> Floats:
        return np.repeat(np.array(values, dtype=np.float64), 3)

    columns: dict[str, Floats] = {
        "axis": np.tile(np.arange(3.0), count),
        "stop": each([k + 1.0 for k in range(count)]),
        "elapsed_s": each([s.elapsed_s - stops[0].elapsed_s for s in stops]),
    }
    for name, values in (
        ("force", [s.force for s in stops]),
        ("field", [s.field for s in stops]),
        ("input", [np.zeros(3) if s.known is None else s.known for s in stops] if turned else []),
    ):
        kept = [v for v in values if v is not None]
        if kept and len(kept) == count:
            table = np.array(kept)
            columns |= {f"{name}_{a}": each(table[:, i].tolist()) for i, a in enumerate("xyz")}
    temperatures = [s.temperature_c for s in stops if s.temperature_c is not None]
    if len(temperatures) == count and np.ptp(temperatures) > 0.0:
        columns["temperature_c"] = each(temperatures)
    nodes = [float(s.node) for s in stops if s.node is not None]
    if len(nodes) == count and np.ptp(nodes) > 0.0:
        columns["node"] = each(nodes)
    if any(s.lean is not None for s in stops):
        free = [np.zeros(3) if s.lean is None else s.lean for s in stops]
        columns[LEAN] = np.concatenate(free)
    places = [float(s.place) for s in stops if s.place is not None]
    if len(places) == count:
        columns["place"] = each(places)
    return columns | _through_gyros(columns)


def _through_gyros(columns: Columns) -> dict[str, Floats]:
    """Force, rate and half its size as each row has them through each gyro: a stop, its own."""
    found: dict[str, Floats] = {}
    for j, b in enumerate("xyz"):
        for name, given in (("force", f"force_{b}"), ("rate", f"input_{b}")):
            if given in columns:
                own = by_axis(columns, columns[given])
                found |= {f"{name}_{a}{b}": own[:, i] for i, a in enumerate("xyz")}
        if f"input_{b}" in columns:
            half = 0.5 * np.abs(columns[f"input_{b}"])
            found[f"half_size_{b}"] = by_axis(columns, half)[:, j]
    return found


def _with_turns(columns: Columns, turns: Sequence[RateTurn], *, start: float) -> dict[str, Floats]:
    """The columns with two rows of each turn below."""
    rest = columns["axis"].size
    last = float(columns["stop"].max())
    rows = {
        "axis": np.tile([3.0, 4.0], len(turns)),
        "stop": np.repeat(last + 1.0 + np.arange(len(turns)), 2),
        "elapsed_s": np.repeat([t.elapsed_s - start for t in turns], 2),
    }
    if "temperature_c" in columns:
        between = np.interp(
            rows["elapsed_s"], columns["elapsed_s"][::3], columns["temperature_c"][::3]
        )
        known = np.repeat(
            [np.nan if t.temperature_c is None else t.temperature_c for t in turns], 2
        )
        rows["temperature_c"] = np.where(np.isfinite(known), known, between)
    for i, a in enumerate("xyz"):
        rows[f"half_size_{a}"] = np.concatenate([t.rows.size[:, i] for t in turns])
        for j, b in enumerate("xyz"):
            rows[f"force_{a}{b}"] = np.concatenate([t.rows.force[:, i, j] for t in turns])
            rows[f"rate_{a}{b}"] = np.concatenate([t.rows.rate[:, i, j] for t in turns])
    size = 2 * len(turns)
    return {
        name: np.append(columns.get(name, np.zeros(rest)), rows.get(name, np.zeros(size)))
        for name in dict.fromkeys((*columns, *rows))
    }


LEAST_DOF = 6
"""Degrees of freedom from which a standard deviation is good to a third."""


def _sigma_about(values: Floats, designs: Sequence[Floats]) -> tuple[float, Floats]:
    """Standard deviation about the first of several models that leaves enough, and that model."""
    for design in designs:
        u, s, _ = np.linalg.svd(design, full_matrices=False)
        basis = u[:, s > 1e-9 * s[0]]
        left = values.size - basis.shape[1]
        rest = values - basis @ (basis.T @ values)
        found = float(np.sqrt(rest @ rest / max(left, 1)))
        if left >= LEAST_DOF and found > 0.0:
            return found, np.asarray(basis)
    return float(np.sqrt(np.mean(values**2))) or 1.0, np.zeros((values.size, 0))


def _sigmas(columns: Columns, observed: Floats, rests: int) -> tuple[Floats, tuple[OwnScale, ...]]:
    """How well rests and turns are known against each other: each about its widest own model.

    Only their ratio matters; a model that lacks an effect would take its traces for noise.
    """
    rest = {name: values[:rests] for name, values in columns.items()}
    turn = {name: values[rests:] for name, values in columns.items()}
    minutes = rest["elapsed_s"] - rest["elapsed_s"].mean()
    plain, ramp = rest_base(rest), by_axis(rest, minutes)
    force = np.column_stack([rest[need.name] for need in GYRO_FORCES])
    rate = np.column_stack([turn[need.name] for need in GYRO_RATES])
    size = np.column_stack([turn[need.name] for need in GYRO_SIZES])
    pull = np.column_stack([turn[need.name] for need in GYRO_FORCES])
    of_rests, about_rests = _sigma_about(
        observed[:rests], [np.hstack([plain, force, ramp]), np.hstack([plain, force]), plain]
    )
    of_turns, about_turns = _sigma_about(
        observed[rests:], [np.hstack([rate, size, pull]), np.hstack([rate, size]), rate]
    )
    rows = np.arange(observed.size)
    scales = (OwnScale(rows[:rests], about_rests), OwnScale(rows[rests:], about_turns))
    return np.where(rows < rests, of_rests, of_turns), scales
