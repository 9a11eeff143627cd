"""A user's own effect tried once on a made-up record, before it meets a real one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from surveyapp.core.orientation.campaign_columns import COLUMNS as CAMPAIGN_COLUMNS
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.user_effects.calls import guarded
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Effect

MOST_POINTS = 200
"""Values of the scanned parameters that are tried."""
SIZE = 24


def _run_columns(generator: np.random.Generator) -> dict[str, Floats]:
    time = np.delete(np.arange(SIZE + 1.0), 7)
    return {
        "half_swing": time,
        "side": np.where(time % 2 == 0, -1.0, 1.0),
        "relative_amplitude": np.exp(-0.02 * time),
        "first_amplitude": np.full(SIZE, 0.02),
        "decay": np.full(SIZE, 0.02),
        "temperature_c": 20.0 + 0.2 * time + generator.normal(size=SIZE),
        "elapsed_s": 212.0 * time,
    }


def _campaign_columns(generator: np.random.Generator) -> dict[str, Floats]:
    return {column.name: column.example(generator, SIZE) for column in CAMPAIGN_COLUMNS}


def _traverse_columns(generator: np.random.Generator) -> dict[str, Floats]:
    kind = np.arange(SIZE) % 3
    gyro = (np.arange(SIZE) % 10 == 9).astype(float)
    return {
        "distance_m": np.where(kind == 0, generator.uniform(30.0, 200.0, SIZE), 0.0),
        "sights_turned": (kind == 1).astype(float),
        "wall_length_m": np.where(kind == 1, generator.uniform(-90.0, 90.0, SIZE), 0.0),
        "gyro_side": gyro * np.cumsum(gyro),
        "gyro_group": gyro,
        "station": np.arange(SIZE) // 3 + 1.0,
        "target": np.arange(SIZE) // 3 + 2.0,
        "observation": np.arange(1.0, SIZE + 1.0),
        "own_sigma": np.where(kind == 0, 0.002, 3e-5),
    }


def _rate_columns(generator: np.random.Generator) -> dict[str, Floats]:
    """A row for each gyro of some stops, turned about one axis after the other."""
    stop = np.arange(SIZE) // 3
    rates = np.sign(generator.normal(size=SIZE))[:, None] * np.eye(3)[stop % 3]
    rates = rates[3 * stop.clip(max=SIZE // 3 - 1)] + 0.1
    return {
        "axis": np.asarray(np.arange(SIZE) % 3, dtype=np.float64),
        "stop": np.asarray(stop + 1, dtype=np.float64),
        "place": np.asarray(stop % 3 + 1, dtype=np.float64),
        "elapsed_s": np.asarray(60.0 * stop, dtype=np.float64),
        "temperature_c": generator.uniform(10.0, 30.0, SIZE),
        **{f"input_{a}": rates[:, i] for i, a in enumerate("xyz")},
        **{f"force_{a}": generator.uniform(-9.8, 9.8, SIZE) for a in "xyz"},
        **{f"field_{a}": generator.uniform(-5e-5, 5e-5, SIZE) for a in "xyz"},
        **{f"half_size_{a}": generator.uniform(-0.5, 0.5, SIZE) for a in "xyz"},
        **{f"force_{a}{b}": generator.uniform(-9.8, 9.8, SIZE) for a in "xyz" for b in "xyz"},
        **{f"rate_{a}{b}": generator.uniform(-1.0, 1.0, SIZE) for a in "xyz" for b in "xyz"},
    }


def _compass_columns(generator: np.random.Generator) -> dict[str, Floats]:
    """Three rows a time, one for each axis of the magnetometer."""
    return {
        "axis": np.asarray(np.arange(SIZE) % 3, dtype=np.float64),
        "time_s": np.asarray(np.arange(SIZE) // 3, dtype=np.float64),
        "row": np.asarray(np.arange(SIZE) // 3 + 1, dtype=np.float64),
        "temperature_c": generator.uniform(10.0, 30.0, SIZE),
        **{f"field_{a}": generator.uniform(-50.0, 50.0, SIZE) for a in "xyz"},
        **{f"level_{a}": generator.uniform(-1.0, 1.0, SIZE) for a in "xyz"},
        **{f"place_{a}": generator.uniform(-1.0, 1.0, SIZE) for a in "xyz"},
    }


def _tilt_columns(generator: np.random.Generator) -> dict[str, Floats]:
    """Two rows a time, one for each axis of the tilt sensor."""
    return {
        "axis": np.asarray(np.arange(SIZE) % 2, dtype=np.float64),
        "time_s": np.asarray(20.0 * (np.arange(SIZE) // 2), dtype=np.float64),
        "row": np.asarray(np.arange(SIZE) // 2 + 1, dtype=np.float64),
        "temperature_c": generator.uniform(10.0, 30.0, SIZE),
        "reference": generator.uniform(-600.0, 600.0, SIZE),
        "other_reference": generator.uniform(-600.0, 600.0, SIZE),
    }


_MAKERS: dict[str, Callable[[np.random.Generator], dict[str, Floats]]] = {
    "reversal_run": _run_columns,
    "campaign": _campaign_columns,
    "traverse": _traverse_columns,
    "rate": _rate_columns,
    "compass": _compass_columns,
    "tilt": _tilt_columns,
}
COLUMNS = {subject: tuple(make(np.random.default_rng(0))) for subject, make in _MAKERS.items()}
"""Columns that a project has, by subject; subjects of sensors have those of their log."""


def probe_problems(effect: Effect, file: str) -> list[Problem]:
    """Call every function of an effect, the basis twice; what is wrong with it.

    Parameters
    ----------
    effect : Effect
        Its form is right (``form_problems``).
    file : str
        For messages.
    """
    generator = np.random.default_rng(5)
    make = _MAKERS.get(effect.subject)
    known = {} if make is None else make(generator)
    columns = {
        need.name: known.get(need.name, generator.uniform(0.0, 1.0, SIZE)) for need in effect.needs
    }
    where = said("{file}, effect {id}", file=file, id=effect.id)
    try:
        _probe(guarded(effect, file), columns, where)
    except SurveyError as error:
        return list(error.problems)
    return []


def _probe(effect: Effect, columns: dict[str, Floats], where: str) -> None:
    points = effect.grid_points(columns)
    if not points:
        raise _wrong(
            "its grid is empty",
            where,
            said("no value to scan on a record of {size}", size=SIZE),
            "values",
        )
    step = max(1, len(points) // MOST_POINTS)
    for point in points[::step]:
        first, second = effect.basis(columns, **point), effect.basis(columns, **point)
        at = ", ".join(f"{name} {value:g}" for name, value in point.items())
        place = (
            said("{where}, basis at {at}", where=where, at=at)
            if at
            else said("{where}, basis", where=where)
        )
        if not np.array_equal(first, second):
            what = "the basis gives another result when it is called again"
            raise _wrong(what, place, "two results that differ", "a pure function")
        if effect.law is None and bool(np.any(np.ptp(first, axis=0) == 0.0)):
            what = "the basis does not vary over the record, and so explains nothing"
            raise _wrong(what, place, "a constant column", "columns that vary")
        if effect.midpoint is not None:
            effect.midpoint(columns, **point)
        if effect.at_datum is not None:
            effect.at_datum(columns, {}, **point)
        if effect.law is not None:
            _probe_law(effect, point, columns, place)


def _probe_law(
    effect: Effect, point: dict[str, float], columns: dict[str, Floats], where: str
) -> None:
    """A law is the exponential one where its coefficient is 0, and its basis is its derivative."""
    law = effect.law
    if law is None:
        return
    known = _run_columns(np.random.default_rng(5))
    time, first, decay = known["half_swing"], np.array([[0.02]]), np.array([[0.02]])
    zero = law(time, first, decay, np.zeros((1, 1)), **point)
    if not np.allclose(zero, first * np.exp(-decay * time), rtol=1e-6, atol=0.0):
        what = "the amplitude law is not exponential where its coefficient is 0"
        raise _wrong(what, where.replace("basis", "law"), "another law", "A exp(-k t)")
    size = 1e-6 * effect.coefficients[0].scale * max(map(abs, _range(effect)))
    up = law(time, first, decay, np.full((1, 1), size), **point)
    slope = known["side"] * ((up - zero) / size)[0]
    tangent = effect.basis(columns, **point)[:, 0]
    apart = float(np.linalg.norm(slope - tangent))
    if not apart <= 0.02 * float(np.linalg.norm(slope)):
        what = "the basis of an amplitude law is not its derivative where the coefficient is 0"
        raise _wrong(what, where, "another column", "side times the derivative of the law")


def _range(effect: Effect) -> tuple[float, float]:
    return effect.coefficients[0].low, effect.coefficients[0].high


def _wrong(what: str, where: str, found: str, expected: str) -> SurveyError:
    return SurveyError(Problem(what, where, found, expected))
