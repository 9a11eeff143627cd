"""The temperature model of a card: biases of the gyros at the temperatures of a record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, cast

import numpy as np

from surveyapp.core.sensors.rate.compensation import MODELS, ModelName, fitted
from surveyapp.core.sensors.rate.parameters import DEG_H
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

TABLE: Final = "temperature_model"
"""Table of a card: ``model``, nodes ``chamber_c`` and ``sensor_c`` [C], ``bias_x/y/z`` [deg/h]."""
OWN, CHAMBER = "temperature_c", "reference_temperature_c"
NODE_KEYS: Final = ((CHAMBER, "chamber_c"), (OWN, "sensor_c"))
"""Column of a log whose temperatures the nodes of a key are."""
MODEL_KEYS: Final = (
    "model",
    *(key for _, key in NODE_KEYS),
    *(f"bias_{axis}" for axis in "xyz"),
)


@dataclass(frozen=True, slots=True)
class TemperatureModel:
    """Biases over temperature.

    Parameters
    ----------
    model : str
    nodes : mapping of str to ndarray, shape (k,)
        By the column of a log to which they belong [C].
    bias : ndarray, shape (k, 3)
        [deg/h]
    """

    model: ModelName
    nodes: Mapping[str, Floats]
    bias: Floats

    def to_table(self) -> dict[str, Any]:
        """The table of a card."""
        found: dict[str, Any] = {"model": self.model}
        for column, key in NODE_KEYS:
            if column in self.nodes:
                found[key] = self.nodes[column].tolist()
        return found | {f"bias_{a}": self.bias[:, i].tolist() for i, a in enumerate("xyz")}

    def at(self, columns: Mapping[str, Floats], *, where: str) -> tuple[Floats | None, str]:
        """Biases [rad/s] at each row of a log, shape (n, 3), and the column that told.

        None where the log has no temperature of the kind that the nodes have.

        Raises
        ------
        SurveyError
            If the record was outside the nodes.
        """
        for column in (OWN, CHAMBER):
            if column not in columns or column not in self.nodes:
                continue
            nodes, seen = self.nodes[column], columns[column]
            order = np.argsort(nodes)
            low, high = float(nodes.min()), float(nodes.max())
            if float(seen.min()) < low or float(seen.max()) > high:
                found = f"{float(seen.min()):g} to {float(seen.max()):g} C"
                raise SurveyError(
                    Problem(
                        "the temperature lies outside the nodes of the card",
                        where,
                        found,
                        said("{low:g} to {high:g} C", low=low, high=high),
                        "nothing is extrapolated: calibrate over the range in which it is used",
                    )
                )
            rows = []
            for values in self.bias.T:
                function = fitted(self.model, nodes[order], values[order])
                if function is None:
                    return None, ""
                rows.append(function(seen) * DEG_H)
            return np.column_stack(rows), column
        return None, ""


def model_of(extra: Mapping[str, object]) -> TemperatureModel | None:
    """The temperature model of a card's own tables; None where it has none that is whole."""
    table = extra.get(TABLE)
    if not isinstance(table, Mapping) or table.get("model") not in MODELS:
        return None
    nodes = {
        column: numbers
        for column, key in NODE_KEYS
        if (numbers := _numbers(table.get(key))) is not None
    }
    biases = [_numbers(table.get(f"bias_{a}")) for a in "xyz"]
    known = [b for b in biases if b is not None]
    sizes = {v.size for v in (*nodes.values(), *known)}
    if not nodes or len(known) < len(biases) or len(sizes) != 1:
        return None
    return TemperatureModel(cast("ModelName", table["model"]), nodes, np.column_stack(known))


def _numbers(value: object) -> Floats | None:
    if not isinstance(value, Sequence) or isinstance(value, str) or not value:
        return None
    if not all(isinstance(v, int | float) and not isinstance(v, bool) for v in value):
        return None
    found = np.array(value, dtype=np.float64)
    return found if np.all(np.isfinite(found)) else None
