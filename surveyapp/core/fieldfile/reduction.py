"""Mean of the faces of each target of a set, and what a surveyor must be told about them.

Zenith angle (L + 2 pi - R) / 2, direction mean of L and R - pi, distances mean of what there is.
One face alone is reduced to face left and told. Nothing is left out here.

Source: Ghilani, Adjustment Computations, ch. 7 (faces); collimation c = (L - R + pi) / 2 and index
i = (L + R - 2 pi) / 2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from surveyapp.core.fieldfile.face_pairs import unlike
from surveyapp.core.fieldfile.rounds import Round, group
from surveyapp.domain.fieldfile import FieldFile, Pointing, ReducedSet, ReducedSight
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said, some
from surveyapp_models.angles import wrap_pi, wrap_two_pi

_FACES_DIFFER_M: Final = 0.010
"""Distances of one sight in both faces agree within some mm whatever the instrument."""
_SHOWN: Final = 6


def corrected_slope(pointing: Pointing, *, corrected: bool) -> float | None:
    """Slope distance with prism constant and ppm where the file stores it raw [m]."""
    if pointing.sd is None or not (corrected or pointing.raw):
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


Pair = tuple[str, int, float | None, float | None]
"""Target, line, collimation in the horizon and index [rad] of a target with both faces."""


def _pairs(targets: Sequence[Sequence[Pointing]]) -> list[tuple[Pair, Pointing, Pointing]]:
    found = []
    for sights in targets:
        left = next((p for p in sights if p.face == "L"), None)
        right = next((p for p in sights if p.face == "R"), None)
        if left is None or right is None:
            continue
        collimation = index = None
        if left.hz is not None and right.hz is not None:
            collimation = 0.5 * wrap_pi(left.hz - right.hz + math.pi)
        if left.v is not None and right.v is not None:
            index = 0.5 * wrap_pi(left.v + right.v)
        found.append(((left.to, left.line, collimation, index), left, right))
    return found


def _reduced(made: Round, *, corrected: bool) -> tuple[ReducedSet, list[Pair]]:
    targets = _by_target(made)
    pairs = _pairs(targets)
    collimations = [pair[2] for pair, _, _ in pairs if pair[2] is not None]
    indices = [pair[3] for pair, _, _ in pairs if pair[3] is not None]
    reduced = ReducedSet(
        name=made.name,
        at=made.at,
        sights=tuple(_sight(sights, corrected=corrected) for sights in targets),
        collimation=_mean(collimations),
        index=_mean(indices),
        spread=tuple(collimations),
        index_spread=tuple(indices),
        length_gaps=tuple(
            0.5 * (left.sd - right.sd)
            for _, left, right in pairs
            if left.sd is not None and right.sd is not None
        ),
    )
    level = [
        (to, line, None if c is None else c * math.sin(left.v or 0.5 * math.pi), i)
        for (to, line, c, i), left, _ in pairs
    ]
    return reduced, level


def _without_unlike(
    made: Sequence[tuple[ReducedSet, list[Pair]]],
) -> tuple[tuple[ReducedSet, ...], list[str]]:
    """Sets without the spread of pairs that belong to no others, and their places in words."""
    sets = [item for item, _ in made]
    pairs = [(number, pair) for number, (_, found) in enumerate(made) for pair in found]
    gone: dict[int, set[str]] = {}
    places = []
    for column, what in ((2, "collimation"), (3, "index")):
        known = [(number, pair, x) for number, pair in pairs if (x := pair[column]) is not None]
        values = [float(x) for _, _, x in known]
        for place in unlike(values):
            number, pair, _ = known[place]
            usual = math.degrees(math.fsum(values) / len(values)) * 3600.0
            gone.setdefault(number, set()).add(pair[0])
            places.append(
                f"{sets[number].at}-{pair[0]} (line {pair[1]}): {what} "
                f'{math.degrees(values[place]) * 3600.0:+.1f}" (mean of all {usual:+.1f}")'
            )
    for number, names in gone.items():
        sound = [pair for pair in made[number][1] if pair[0] not in names]
        kept = {pair[0] for pair in sound}
        item = sets[number]
        order = [pair[0] for pair in made[number][1] if pair[2] is not None]
        second = [pair[0] for pair in made[number][1] if pair[3] is not None]
        sets[number] = replace(
            item,
            spread=tuple(x for x, to in zip(item.spread, order, strict=True) if to in kept),
            index_spread=tuple(
                x for x, to in zip(item.index_spread, second, strict=True) if to in kept
            ),
            unlike=frozenset(names),
        )
    return tuple(sets), places


def reduce_file(file: FieldFile) -> tuple[tuple[ReducedSet, ...], tuple[ResultWarning, ...]]:
    """Sets of a field file with the mean of their faces.

    Parameters
    ----------
    file : FieldFile

    Returns
    -------
    sets, warnings
        ``one_face``, ``unequal_targets``, ``repeated_reading``, ``faces_differ``,
        ``face_pair_differs``, ``heights_unknown`` and ``horizontal_only``, each once with the
        lines it is about.
    """
    grouped = group(file.pointings)
    sets, slips = _without_unlike(
        [_reduced(made, corrected=file.corrected) for made in grouped.rounds]
    )
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
        *_listed(
            "face_pair_differs",
            "the faces of a target disagree otherwise than all others: was one misread?",
            slips,
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
