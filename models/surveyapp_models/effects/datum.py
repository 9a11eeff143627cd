"""States at which a result is told when an effect moves it, and at which an adopted one is nothing.

What ``at_datum`` and ``reference`` of an effect return. Several effects settle, step or follow the
temperature; each such state is written once, here.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.effect import Basis, Columns, ReferenceState

Rows = tuple[tuple[str, tuple[float, ...]], ...]


def asymptote(columns: Columns, references: Mapping[str, float], /, **grid: float) -> Rows:
    """Where it settles."""
    del columns, references, grid
    return (("asymptote", (0.0,)),)


def both_plateaus(columns: Columns, references: Mapping[str, float], /, **grid: float) -> Rows:
    """Before and after a step."""
    del columns, references, grid
    return (("before the step", (0.0,)), ("after the step", (1.0,)))


def reference_temperature(
    columns: Columns, references: Mapping[str, float], /, **grid: float
) -> Rows:
    """The reference temperature, else the mean."""
    del grid
    mean = float(columns["temperature_c"].mean())
    reference = references.get("temperature_c", mean)
    return ((f"{reference:g} degrees Celsius", (reference - mean,)),)


def at_mean_temperature(
    columns: Columns, references: Mapping[str, float], /, **grid: float
) -> dict[str, float]:
    """The reference temperature, else the mean: the datum of ``reference_temperature``."""
    del grid
    return {
        "temperature_c": references.get("temperature_c", float(columns["temperature_c"].mean()))
    }


def at_mean_secant(
    columns: Columns, references: Mapping[str, float], /, **grid: float
) -> dict[str, float]:
    """The latitude [rad] whose secant is the mean secant."""
    del references, grid
    return {"latitude": float(np.arccos(1.0 / (1.0 / np.cos(columns["latitude"])).mean()))}


def at_mean_date(
    columns: Columns, references: Mapping[str, float], /, **grid: float
) -> dict[str, float]:
    """The mean date [d]."""
    del references, grid
    return {"elapsed_days": float(columns["elapsed_days"].mean())}


def at_last_date(
    columns: Columns, references: Mapping[str, float], /, **grid: float
) -> dict[str, float]:
    """The last date [d]: after a step, where the later plateau counts."""
    del references, grid
    return {"elapsed_days": float(columns["elapsed_days"].max())}


def centred(column: str) -> Basis:
    """A basis that is a column less its mean."""

    def basis(columns: Columns, /, **grid: float) -> Floats:
        del grid
        values = columns[column]
        return np.asarray(values - values.mean())[:, None]

    return basis


def at_mean_of(column: str) -> ReferenceState:
    """The mean of a column: where ``centred`` corrects nothing."""

    def state(
        columns: Columns, references: Mapping[str, float], /, **grid: float
    ) -> dict[str, float]:
        del grid
        return {column: references.get(column, float(columns[column].mean()))}

    return state
