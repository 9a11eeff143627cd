"""Mean of the faces of each target of a set, and what a surveyor must be told about them.

Zenith angle (L + 2 pi - R) / 2, direction mean of L and R - pi, distances mean of what there is.
One face alone is reduced to face left and told. Nothing is left out here.

Source: Ghilani, Adjustment Computations, ch. 7 (faces); collimation c = (L - R + pi) / 2 and index
i = (L + R - 2 pi) / 2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from surveyapp.core.fieldfile.rounds import Round, group
from surveyapp.domain.fieldfile import FieldFile, Pointing, ReducedSet, ReducedSight
from surveyapp.domain.project import ResultWarning
from surveyapp.languages import joined, said, some
from surveyapp_models.angles import wrap_pi, wrap_two_pi

_FACES_DIFFER_M: Final = 0.010
"""Distances of one sight in both faces agree within some mm whatever the instrument."""
_SHOWN: Final = 6


def corrected_slope(pointing: Pointing, *, corrected: bool) -> float | None:
    """Slope distance with prism constant and ppm where the file stores it raw [m]."""
    if pointing.sd is None or not corrected:
        return pointing.sd
    ppm = pointing.ppm or 0.0
    return pointing.sd + (pointing.prism_m or 0.0) + pointing.sd * ppm * 1e-6


def _mean(values: Sequence[float | None]) -> float | None:
    found = [value for value in values if value is not None]
    return sum(found) / len(found) if found else None


def _direction(left: Pointing | None, right: Pointing | None) -> float | None:
    a = None if left is None else left.hz
    b = None if right is None or right.hz is None else right.hz - math.pi
    if a is None or b is None:
        return None if a is None and b is None else wrap_two_pi(a if a is not None else b or 0.0)
    return wrap_two_pi(a + 0.5 * wrap_pi(b - a))


def _zenith(left: Pointing | None, right: Pointing | None) -> float | None:
    a = None if left is None else left.v
    b = None if right is None or right.v is None else 2.0 * math.pi - right.v
    return _mean((a, b))


def _sight(sights: Sequence[Pointing], *, corrected: bool) -> ReducedSight:
    left = next((p for p in sights if p.face != "R"), None)
    right = next((p for p in sights if p.face == "R"), None)
    first = sights[0]
    slope = _mean([corrected_slope(p, corrected=corrected) for p in sights])
    return ReducedSight(
        to=first.to,
        direction=_direction(left, right),
        zenith=_zenith(left, right),
        slope_distance=slope,
        distance=_mean([p.hd for p in sights]) if slope is None else None,
        hi=first.hi,
        ht=first.ht,
        faces=len({p.face for p in sights}),
        lines=tuple(p.line for p in sights),
    )


def _by_target(made: Round) -> list[list[Pointing]]:
    targets: dict[str, list[Pointing]] = {}
    for (to, _), pointing in made.sights.items():
        targets.setdefault(to, []).append(pointing)
    return list(targets.values())


def _reduced(made: Round, *, corrected: bool) -> ReducedSet:
    targets = _by_target(made)
    collimations, indices, gaps = [], [], []
    for sights in targets:
        left = next((p for p in sights if p.face == "L"), None)
        right = next((p for p in sights if p.face == "R"), None)
        if left is None or right is None:
            continue
        if left.hz is not None and right.hz is not None:
            collimations.append(0.5 * wrap_pi(left.hz - right.hz + math.pi))
        if left.v is not None and right.v is not None:
            indices.append(0.5 * wrap_pi(left.v + right.v))
        if left.sd is not None and right.sd is not None:
            gaps.append(0.5 * (left.sd - right.sd))
    return ReducedSet(
        name=made.name,
        at=made.at,
        sights=tuple(_sight(sights, corrected=corrected) for sights in targets),
        collimation=_mean(collimations),
        index=_mean(indices),
        spread=tuple(collimations),
        index_spread=tuple(indices),
        length_gaps=tuple(gaps),
    )


def reduce_file(file: FieldFile) -> tuple[tuple[ReducedSet, ...], tuple[ResultWarning, ...]]:
    """Sets of a field file with the mean of their faces.

    Parameters
    ----------
    file : FieldFile

    Returns
    -------
    sets, warnings
        ``one_face``, ``unequal_targets``, ``repeated_reading``, ``faces_differ``,
        ``heights_unknown`` and ``horizontal_only``, each once with the lines it is about.
    """
    grouped = group(file.pointings)
    sets = tuple(_reduced(made, corrected=file.corrected) for made in grouped.rounds)
    warnings = [
        *_face_warnings(grouped.rounds),
        *_listed(
            "repeated_reading",
            said("a target was read again in the same face: it counts for the next set"),
            [
                said("line {line} ({at}-{to})", line=p.line, at=p.at, to=p.to)
                for p in grouped.repeated
            ],
        ),
        *_listed(
            "faces_differ",
            said(
                "distances of the two faces differ by more than {most:.0f} mm",
                most=_FACES_DIFFER_M * 1000.0,
            ),
            _unequal_distances(grouped.rounds),
        ),
        *_length_warnings(sets),
    ]
    return sets, tuple(warnings)


def _listed(code: str, text: str, places: Sequence[str]) -> list[ResultWarning]:
    if not places:
        return []
    return [ResultWarning(code, joined(": ", (text, some(places, _SHOWN))))]


def _face_warnings(rounds: Sequence[Round]) -> list[ResultWarning]:
    single: list[str] = []
    unequal: list[str] = []
    for made in rounds:
        targets = _by_target(made)
        both = any(len({p.face for p in sights}) == 2 for sights in targets)
        for sights in targets:
            if len({p.face for p in sights}) == 1:
                place = f"set {made.name}: {made.at}-{sights[0].to} (line {sights[0].line})"
                single.append(place)
                unequal += [place] if both else []
    return [
        *_listed(
            "one_face", said("observed in one face only: collimation and index stay in"), single
        ),
        *_listed("unequal_targets", said("the faces of a set hold unequal targets"), unequal),
    ]


def _unequal_distances(rounds: Sequence[Round]) -> list[str]:
    places = []
    for made in rounds:
        for sights in _by_target(made):
            lengths = [p.sd for p in sights if p.sd is not None]
            if len(lengths) > 1 and max(lengths) - min(lengths) > _FACES_DIFFER_M:
                gap = (max(lengths) - min(lengths)) * 1000.0
                places.append(f"{made.at}-{sights[0].to} by {gap:.0f} mm (line {sights[0].line})")
    return places


def _length_warnings(sets: Sequence[ReducedSet]) -> list[ResultWarning]:
    level = [f"{s.at}-{t.to}" for s in sets for t in s.sights if t.distance is not None]
    blind = [
        f"{s.at}-{t.to}"
        for s in sets
        for t in s.sights
        if t.zenith is not None and (t.hi is None or t.ht is None)
    ]
    return [
        *_listed("horizontal_only", said("only horizontal distances are stored"), level),
        *_listed(
            "heights_unknown",
            said("no height of instrument or target in the file: it counts as 0 in the book"),
            list(dict.fromkeys(blind)),
        ),
    ]
