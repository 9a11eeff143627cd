"""Long records of a rate sensor, made of noise of four kinds and of what is put on top."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from surveyapp.diagnosis import Case
from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import (
    Coefficient,
    Column,
    Columns,
    Effect,
    GridParameter,
)

STEP_S = 0.01
SAMPLES = 100_000


def _ramp(columns: Columns, /, **grid: float) -> Floats:
    t = columns["time_s"]
    return np.asarray((t - t.mean())[:, None] / 3600.0)


def _warmth(columns: Columns, /, **grid: float) -> Floats:
    return np.asarray((columns["temperature_c"] - 20.0)[:, None])


def _tone(columns: Columns, /, **grid: float) -> Floats:
    phase = 2.0 * np.pi * grid["frequency"] * columns["time_s"]
    return np.column_stack([np.cos(phase), np.sin(phase)])


def _bearing(columns: Columns, /, **grid: float) -> Floats:
    angle = columns["bearing"]
    return np.column_stack([np.cos(angle), np.sin(angle)])


def effect(identity: str, needs: tuple[Column, ...], unit: str, basis: Any, **more: Any) -> Effect:
    count = 2 if identity in ("interference_line", "bearing") else 1
    coefficient = Coefficient("size", unit, 1.0, -1e6, 1e6, "size")
    return Effect(
        id=identity,
        title=identity.replace("_", " "),
        subject="rate",
        needs=needs,
        coefficients=(coefficient,) * count,
        basis=basis,
        datum="the mean over the record",
        source="a test",
        remedy="Wait.",
        symptom="the rate changed",
        separate_by="a longer record",
        **more,
    )


TIME = Column("time_s", "s")
RAMP = effect("bias_ramp", (TIME,), "deg/h/h", _ramp)
TEMPERATURE = effect("temperature", (Column("temperature_c", "K"),), "deg/h/K", _warmth)
BEARING = effect("bearing", (Column("bearing", "rad"),), "deg/h", _bearing)
TONE = effect(
    "interference_line",
    (TIME,),
    "deg/h",
    _tone,
    grid=(
        GridParameter(
            "frequency", "Hz", lambda columns: np.array([0.137, 12.48]), "of the table's motor"
        ),
    ),
)


def rate_log(
    values: Floats,
    time: Floats | None = None,
    *,
    effects: tuple[Effect, ...] = (RAMP,),
    columns: Mapping[str, Floats] | None = None,
    **more: Any,
) -> Case:
    """A problem with one constant bias [deg/h]."""
    n = values.size
    t = np.asarray(STEP_S * np.arange(n) if time is None else time, dtype=np.float64)
    return Case(
        subject="rate",
        observations=values,
        base=np.ones((n, 1)),
        base_names=("bias",),
        value_base=np.ones(1),
        value_weights=np.full(n, 1.0 / n),
        position=t,
        columns={"time_s": t, **(columns or {})},
        effects=effects,
        unit="deg/h",
        scale=1.0,
        identity="log",
        position_unit="s",
        **more,
    )


def white(n: int, g: np.random.Generator) -> Floats:
    """Independent samples."""
    return g.standard_normal(n)


def autoregressive(n: int, g: np.random.Generator) -> Floats:
    """First-order autoregressive, correlation of neighbours 0.9."""
    from scipy.signal import lfilter

    return np.asarray(lfilter([1.0], [1.0, -0.9], g.standard_normal(n)), dtype=np.float64)


def walk(n: int, g: np.random.Generator, size: float = 3.0) -> Floats:
    """White noise on a random walk that ends ``size`` standard deviations of a sample away."""
    steps = g.standard_normal(n) * size / np.sqrt(n)
    return np.asarray(g.standard_normal(n) + np.cumsum(steps))


def flicker(n: int, g: np.random.Generator) -> Floats:
    """1/f noise, cut out of a record twice as long."""
    frequency = np.fft.rfftfreq(2 * n)
    frequency[0] = frequency[1]
    shaped = np.fft.rfft(g.standard_normal(2 * n)) / np.sqrt(frequency)
    return np.asarray(np.fft.irfft(shaped)[:n])


NOISES = {
    "white": white,
    "AR(1) .9": autoregressive,
    "white and random walk": walk,
    "1/f": flicker,
}
