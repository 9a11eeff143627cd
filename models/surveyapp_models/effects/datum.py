"""States at which a result is told when an effect moves it: what ``at_datum`` of an effect returns.

Several effects settle, step or follow the temperature; each such state is written once, here.
"""

from __future__ import annotations

from collections.abc import Mapping

from surveyapp_models.effects.effect import Columns

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
