"""``north --method rotation``: a heading carried through a rotation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, cast

from surveyapp.core.sensors.rate.card_temperature import (
    CHAMBER,
    OWN,
    model_of,
)
from surveyapp.core.sensors.rate.rotation import (
    NEEDED,
    RotationOptions,
    card_matrix,
    find_heading,
)
from surveyapp.domain.north import NorthResult, Reference
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_cards import read_sensor_card
from surveyapp.io.sensor_logs.reading import Need
from surveyapp.languages import either
from surveyapp.workflows.north.request import NorthRequest
from surveyapp_models.arrays import Floats

REFERENCES: Final = ("MAGNETIC", "ASTRONOMIC", "GRID")


def find(request: NorthRequest) -> NorthResult:
    """Carry the stated heading through the record."""
    problems: list[Problem] = []
    hint = "a gyro that is only carried keeps the heading with which it began"
    heading = request.needed("initial_heading_deg", problems, hint)
    own_sigma = request.sigma("initial_heading_sigma_deg", problems)
    reference = request.option("initial_reference")
    if reference not in REFERENCES:
        problems.append(
            Problem(
                "the reference of the initial heading is not stated"
                if reference is None
                else "there is no such reference",
                "initial_reference",
                "" if reference is None else str(reference),
                either(REFERENCES),
                "a heading without its reference can be wrong by the declination",
            )
        )
    declination, sigma = _declination(request, problems)
    latitude = request.latitude(problems, required=False)
    card = request.option("card")
    known = _Known(*card_matrix({}))
    try:
        log = request.read(Need(columns=NEEDED, optional=(OWN, CHAMBER)))
        if card is not None:
            known = _known(str(card), log, problems)
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems:
        raise SurveyError(problems)
    options = RotationOptions(
        heading=math.radians(heading),
        reference=cast("Reference", reference),
        heading_sigma=own_sigma,
        declination=declination,
        declination_sigma=sigma,
        latitude=latitude,
        matrix=known.matrix,
        bias=known.bias,
        card=known.card,
        temperature_model=known.model,
    )
    result = find_heading(log, options)
    return replace(result, warnings=(*result.warnings, *known.told))


@dataclass(frozen=True, slots=True)
class _Known:
    """What a card says of the gyros: matrix, bias [rad/s], its id, and by which model of them."""

    matrix: Floats
    bias: Floats
    card: str = ""
    model: str = ""
    told: tuple[ResultWarning, ...] = ()


def _known(name: str, log: SensorLog, problems: list[Problem]) -> _Known:
    """A card's matrix and biases, these at the temperatures of the log where the card has them.

    Raises
    ------
    SurveyError
        If the card cannot be read, or the record was outside its nodes.
    """
    card = read_sensor_card(Path(name))
    matrix, bias = card_matrix({p.name: p.value for p in card.parameters})
    model = model_of(card.extra)
    if model is not None:
        biases, _ = model.at(log.columns, where=name)
        if biases is not None:
            return _Known(matrix, biases, card.id, model.model, card.warnings)
    span = log.columns.get(OWN)
    low_high = None if span is None else (float(span.min()), float(span.max()))
    problems += card.refusals(on=None, temperature_c=low_high, where=name)
    if model is None:
        return _Known(matrix, bias, card.id, told=card.warnings)
    text = (
        "the card holds biases over temperature, and the log no temperature to which they belong: "
        "the biases are those of the card's reference temperature"
    )
    return _Known(
        matrix, bias, card.id, told=(*card.warnings, ResultWarning("no_temperature", text))
    )


def _declination(
    request: NorthRequest, problems: list[Problem]
) -> tuple[float | None, float | None]:
    """Declination and its sigma [rad]; one beside another reference is told elsewhere."""
    text = request.declination()
    if text is None:
        return None, None
    try:
        parts = [float(part) for part in str(text).split(",")]
    except ValueError:
        parts = []
    if not 1 <= len(parts) <= 2 or not all(math.isfinite(p) for p in parts):
        problems.append(
            Problem("this is no declination", "declination", str(text), "D or D,SIGMA in degrees")
        )
        return None, None
    sigma = math.radians(parts[1]) if len(parts) == 2 else None
    if sigma is not None and sigma < 0.0:
        problems.append(Problem("a sigma is negative", "declination", str(text), "0 or more"))
    return math.radians(parts[0]), sigma
