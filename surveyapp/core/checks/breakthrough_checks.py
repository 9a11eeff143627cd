"""The breakthrough and the shafts of a project against what the rule book and the project allow.

What is compared at the meeting point is factor x sigma before the breakthrough, and the measured
miss beside it afterwards. Where the project states a tolerance of its own, that one decides, here
as in ``predict``; the rule book's limit of that component is then listed as open and says so.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

from surveyapp.core.checks.evidence import BreakthroughEvidence, ShaftEvidence
from surveyapp.core.tolerance import Measured
from surveyapp.domain.penetration import StatedTolerance
from surveyapp.domain.results import Check
from surveyapp.domain.shaft_result import ShaftOrientation
from surveyapp.domain.subject import Subject
from surveyapp.languages import said, term
from surveyapp_models.angles import ARCSEC, wrap_pi

COMPONENTS = ("lateral", "longitudinal", "vertical")
MEETING = Subject.of("penetration", said("meeting point"))
_ROUNDING = 1e-12


def breakthrough_checks(evidence: BreakthroughEvidence | None) -> list[Check]:
    """Checks of the tolerances that the project states itself; none where it states none."""
    if evidence is None or evidence.plan.tolerance is None:
        return []
    stated = evidence.plan.tolerance
    checks = []
    for name, limit in zip(COMPONENTS, _stated(stated), strict=True):
        if limit is None:
            continue
        for value, text in _errors(evidence, name):
            checks.append(
                Check(
                    rule=f"penetration.{name}",
                    clause=stated.source or said("tolerance of the project"),
                    value=value,
                    limit=limit,
                    confirmed=True,
                    passed=None if value is None else value <= limit * (1.0 + _ROUNDING),
                    unit="m",
                    where=MEETING.text,
                    text=said(
                        "{name} error at the meeting point: {text}", name=term(name), text=text
                    )
                    if value is not None
                    else text,
                    subject=MEETING,
                )
            )
    return checks


def breakthrough_measures(evidence: BreakthroughEvidence | None) -> list[Measured]:
    """What a breakthrough answers of a rule book: lateral, vertical, and the project's factor."""
    if evidence is None:
        return []
    stated = evidence.plan.tolerance or StatedTolerance()
    tunnel, found = str(evidence.plan.tunnel), []
    variables = {} if evidence.length_km is None else {"L": evidence.length_km}
    for name, own in zip(COMPONENTS, _stated(stated), strict=True):
        if name == "longitudinal":
            continue
        errors = _errors(evidence, name)
        if own is not None:
            source = stated.source or said("its own")
            text = said(
                "the project allows {own:g} m ({source}): penetration.{name}",
                own=own,
                source=source,
                name=name,
            )
            errors = [(None, text)]
        found += [
            Measured(name, value, MEETING.text, text, variables, tunnel, subject=MEETING)
            for value, text in errors
        ]
    if evidence.plan.factor is not None:
        found.append(
            Measured(
                "penetration_factor",
                evidence.plan.factor,
                MEETING.text,
                said("the project's own"),
                variables,
                tunnel,
                subject=MEETING,
            )
        )
    return found


def _stated(tolerance: StatedTolerance) -> tuple[float | None, float | None, float | None]:
    return tolerance.lateral_m, tolerance.longitudinal_m, tolerance.vertical_m


def _errors(evidence: BreakthroughEvidence, name: str) -> list[tuple[float | None, str]]:
    """Predicted and measured error of a component [m], each with what it is."""
    found: list[tuple[float | None, str]] = []
    prediction, miss = evidence.prediction, evidence.plan.measured
    i = COMPONENTS.index(name)
    sigma = None if prediction is None else prediction.sigma.components()[i]
    if prediction is not None and sigma is not None:
        found.append(
            (
                prediction.factor * sigma,
                said("predicted, {factor:g} x sigma", factor=prediction.factor),
            )
        )
    measured = None
    if miss is not None:
        measured = (miss.lateral_m, miss.longitudinal_m, miss.vertical_m)[i]
    if measured is not None:
        found.append((abs(measured), said("measured")))
    if found:
        return found
    why = evidence.refused or said(
        "nothing from which to predict the {name} error", name=term(name)
    )
    return [(None, said("missing: a prediction ({why})", why=why))]


def shaft_measures(evidence: ShaftEvidence | None) -> list[Measured]:
    """What shafts answer of a rule book: triangles, depths, carried direction and points."""
    if evidence is None:
        return []
    found: list[Measured] = []
    for name, why in evidence.refused:
        found += _refused(name, why)
    for shaft in evidence.shafts:
        found += _of_one(shaft)
    return found + _twice(evidence.shafts)


def _of_one(shaft: ShaftOrientation) -> list[Measured]:
    subject = Subject.of("shaft", shaft.id)
    found = [
        Measured(
            f"wire_distance_{item.place}",
            abs(item.f_mm) / 1000.0,
            f"{shaft.id}, {item.station}",
            said("connecting triangle"),
            subject=subject,
        )
        for item in shaft.triangles
    ]
    depth = shaft.depth
    if depth.difference_mm is not None:
        variables = {"L": depth.m / 1000.0}
        text = said("depth {m:.3f} m", m=depth.m)
        difference = depth.difference_mm / 1000.0
        found.append(
            Measured("height_transfer", difference, shaft.id, text, variables, subject=subject)
        )
    side = f"{shaft.at}-{shaft.to}"
    direction = shaft.azimuth.sigma / ARCSEC
    found.append(Measured("plumbed_direction", direction, shaft.id, side, subject=subject))
    found += [
        Measured(
            "plumbed_point",
            point.sigma_m,
            f"{shaft.id}, {point.station}",
            said("east and north together"),
            subject=subject,
        )
        for point in shaft.points
    ]
    return found


def _refused(name: str, why: str) -> list[Measured]:
    """A shaft that could not be oriented answers nothing and says why."""
    text = said("missing: the orientation through the shaft ({why})", why=why)
    names = ("plumbed_direction", "plumbed_point", "height_transfer")
    triangles = ("wire_distance_surface", "wire_distance_underground")
    subject = Subject.of("shaft", name)
    return [Measured(item, None, name, text, subject=subject) for item in (*names, *triangles)]


def _twice(shafts: Sequence[ShaftOrientation]) -> list[Measured]:
    """Two plumbings of one kind that orient one side: their azimuths against each other."""
    found = []
    for first, second in combinations(shafts, 2):
        if first.kind != second.kind or {first.at, first.to} != {second.at, second.to}:
            continue
        turned = 0.0 if first.at == second.at else math.pi
        difference = wrap_pi(second.azimuth.value + turned - first.azimuth.value)
        found.append(
            Measured(
                f"{first.kind}_shaft_twice",
                abs(difference) / ARCSEC,
                f"{first.id}, {second.id}",
                f"{first.at}-{first.to}",
                subject=Subject.of("shaft", first.id),
            )
        )
    return found
