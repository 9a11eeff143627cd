"""``north --method rotation``: a heading carried through a rotation."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final, cast

from surveyapp.core.sensors.rate.card_temperature import CHAMBER, OWN
from surveyapp.core.sensors.rate.rotation import NEEDED, RotationOptions, find_heading
from surveyapp.domain.north import NorthResult, Reference
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.sensor_logs.reading import Need
from surveyapp.languages import either
from surveyapp.workflows.north.card import Known, known_of
from surveyapp.workflows.north.request import NorthRequest

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
    known = Known()
    try:
        log = request.read(Need(columns=NEEDED, optional=(OWN, CHAMBER)))
        if card is not None:
            known = known_of(str(card), log, problems)
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
        force_matrix=known.force_matrix,
        force_bias=known.force_bias,
        card=known.card,
        temperature_model=known.model,
    )
    result = find_heading(log, options)
    return replace(result, warnings=(*result.warnings, *known.told))


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
