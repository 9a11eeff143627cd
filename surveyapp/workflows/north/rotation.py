"""``north --method rotation``: a heading carried through a rotation."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final, cast

from surveyapp.core.sensors.rate.rotation import (
    NEEDED,
    RotationOptions,
    card_matrix,
    find_heading,
)
from surveyapp.domain.north import NorthResult, Reference
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_cards import read_sensor_card
from surveyapp.io.sensor_logs.reading import Need
from surveyapp.languages import either
from surveyapp.workflows.north.request import NorthRequest

REFERENCES: Final = ("MAGNETIC", "ASTRONOMIC", "GRID")


def find(request: NorthRequest) -> NorthResult:
    """Carry the stated heading through the record."""
    problems: list[Problem] = []
    hint = "a gyro that is only carried keeps the heading with which it began"
    heading = request.needed("initial_heading_deg", problems, hint)
    reference = request.option("initial_reference")
    if reference not in REFERENCES:
        problems.append(
            Problem(
                "the reference of the initial heading is not stated"
                if reference is None
                else "there is no such reference",
                "--initial-reference",
                "" if reference is None else str(reference),
                either(REFERENCES),
                "a heading without its reference can be wrong by the declination",
            )
        )
    declination, sigma = _declination(request, problems)
    latitude = request.latitude(problems, required=False)
    matrix, name = card_matrix({}), ""
    card = request.option("card")
    try:
        if card is not None:
            found = read_sensor_card(Path(str(card)))
            matrix, name = card_matrix({p.name: p.value for p in found.parameters}), found.id
        log = request.read(Need(columns=NEEDED, optional=("temperature_c",)))
        if card is not None:
            span = log.columns.get("temperature_c")
            low_high = None if span is None else (float(span.min()), float(span.max()))
            problems += found.refusals(on=None, temperature_c=low_high, where=str(card))
    except SurveyError as error:
        raise SurveyError([*problems, *error.problems]) from None
    if problems:
        raise SurveyError(problems)
    options = RotationOptions(
        heading=math.radians(heading),
        reference=cast("Reference", reference),
        declination=declination,
        declination_sigma=sigma,
        latitude=latitude,
        matrix=matrix[0],
        bias=matrix[1],
        card=name,
    )
    return find_heading(log, options)


def _declination(
    request: NorthRequest, problems: list[Problem]
) -> tuple[float | None, float | None]:
    """Declination and its sigma [rad]; one beside another reference is told elsewhere."""
    text = request.option("declination")
    if text is None:
        return None, None
    try:
        parts = [float(part) for part in str(text).split(",")]
    except ValueError:
        parts = []
    if not 1 <= len(parts) <= 2 or not all(math.isfinite(p) for p in parts):
        problems.append(
            Problem("this is no declination", "--declination", str(text), "D or D,SIGMA in degrees")
        )
        return None, None
    sigma = math.radians(parts[1]) if len(parts) == 2 else None
    return math.radians(parts[0]), sigma
