"""The zero of each axis of the magnetometer depends on its temperature.

A sensor whose zeros are right at one temperature is off by the same three numbers at every other:
about the mean of the record that is a constant, which would look like a hard iron of its own. So
the temperature at which the zeros are none is tried.
"""

from __future__ import annotations

import numpy as np

from surveyapp_models.arrays import Floats
from surveyapp_models.effects.compass import AXIS, TEMPERATURE, own_axis
from surveyapp_models.effects.effect import Coefficient, Columns, Effect, GridParameter

REFERENCE_C = 20.0
"""Reference temperature of a sensor card where none is stated."""


def datums(columns: Columns) -> Floats:
    """Where the zeros may hold [degree Celsius]: the mean, 20 as on a card, the first row."""
    theta = columns["temperature_c"]
    return np.unique([float(theta.mean()), REFERENCE_C, float(theta[0])])


def basis(columns: Columns, /, **grid: float) -> Floats:
    """Theta - datum in the rows of each axis, shape (n, 3) [K]; datum = mean if not given."""
    theta = columns["temperature_c"]
    warmer = theta - grid.get("datum_c", float(theta.mean()))
    return np.asarray(own_axis(columns) * warmer[:, None])


EFFECT = Effect(
    id="temperature",
    title="Temperature coefficient of the zeros",
    subject="compass",
    needs=(AXIS, TEMPERATURE),
    coefficients=tuple(
        Coefficient(f"temperature_{a}", "uT/K", 1.0, -100.0, 100.0, f"zero per kelvin along {a}")
        for a in "xyz"
    ),
    grid=(GridParameter("datum_c", "C", datums, "temperature at which the zeros are none"),),
    basis=basis,
    datum="zeros at the temperature datum_c",
    source="data sheets of magnetometers, offset drift",
    remedy="Let the sensor reach its temperature, or use a card with its coefficient.",
    symptom="the field followed the temperature",
    separate_by="the same turns again at another temperature",
    confusable_with=("interference_step", "hard_iron"),
)
