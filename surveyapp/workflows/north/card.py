"""What a sensor card says of the unit by which north is found."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from surveyapp.core.sensors.rate.card_temperature import OWN, model_of
from surveyapp.core.sensors.rate.card_values import card_forces, card_matrix
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem
from surveyapp.io.sensor_cards import read_sensor_card
from surveyapp_models.arrays import Floats

KIND = "rate"


@dataclass(frozen=True, slots=True)
class Known:
    """Matrices and zeros of a unit; nominal where no card tells them.

    Parameters
    ----------
    matrix, bias : ndarray
        Of the gyros: output = matrix rate + bias [rad/s]; the bias (3,), or one a row of the log.
    force_matrix, force_bias : ndarray
        Of the accelerometers [m/s2].
    card : str
        Its id; empty without one.
    model : str
        By which the bias follows the temperature; empty = it does not.
    told : tuple of ResultWarning
    """

    matrix: Floats = field(default_factory=lambda: np.eye(3))
    bias: Floats = field(default_factory=lambda: np.zeros(3))
    force_matrix: Floats = field(default_factory=lambda: np.eye(3))
    force_bias: Floats = field(default_factory=lambda: np.zeros(3))
    card: str = ""
    model: str = ""
    told: tuple[ResultWarning, ...] = ()


def known_of(name: str, log: SensorLog, problems: list[Problem]) -> Known:
    """A card's matrices and zeros, the gyros' at the temperatures of the log where it has them.

    What forbids its use goes to ``problems``.

    Raises
    ------
    SurveyError
        If the card cannot be read, or the record was outside its nodes.
    """
    card = read_sensor_card(Path(name), where=name)
    if card.kind != KIND:
        problems.append(Problem("the card is of another kind", name, card.kind, KIND))
        return Known()
    values = {p.name: p.value for p in card.parameters}
    matrix, bias = card_matrix(values)
    forces = card_forces(values)
    model = model_of(card.extra)
    if model is not None:
        biases, _ = model.at(log.columns, where=name)
        if biases is not None:
            return Known(matrix, biases, *forces, card.id, model.model, card.warnings)
    span = log.columns.get(OWN)
    low_high = None if span is None else (float(span.min()), float(span.max()))
    problems += card.refusals(on=None, temperature_c=low_high, where=name)
    if model is None:
        return Known(matrix, bias, *forces, card.id, told=card.warnings)
    text = (
        "the card holds biases over temperature, and the log no temperature to which they belong: "
        "the biases are those of the card's reference temperature"
    )
    told = (*card.warnings, ResultWarning("no_temperature", text))
    return Known(matrix, bias, *forces, card.id, told=told)
