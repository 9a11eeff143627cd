"""What would help: further gyro sides, and what else, each with its gain and its cost."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from surveyapp.core.penetration.covariance import contributions, total
from surveyapp.core.penetration.mine import Mine, assemble
from surveyapp.core.penetration.placement import Candidate, Outlook, outlook, planned_row
from surveyapp.core.penetration.rows import HeadingRows, Row, RowKind
from surveyapp.core.penetration.search import best_placements, least_sides
from surveyapp.domain.placement import (
    LeastProgramme,
    Measure,
    Placement,
    PlacementPlan,
    PlannedSide,
)
from surveyapp.languages import said

BETTER_ANGLES = 5.0 / 7.0
"""From the 7" class to 5"."""
BETTER_GYRO = 2.0 / 3.0
"""From 15" to 10"."""
SECOND = " (second)"


def lateral_sigma(mine: Mine) -> float:
    """Lateral 1 sigma of a mine [m]."""
    return math.sqrt(float(total(contributions(mine))[0][0, 0]))


def candidates_of(mine: Mine, defaults: Mapping[str, tuple[str, float]]) -> tuple[Candidate, ...]:
    """Sides without a gyro, each with the instrument that would observe it.

    Parameters
    ----------
    mine : Mine
    defaults : mapping of heading name to (instrument, sigma)
        For a heading that has no gyro side yet [rad].
    """
    found = []
    for number, heading in enumerate(mine.headings):
        gyro = [row for row in heading.rows if row.kind is RowKind.GYRO]
        name = heading.route.heading.name
        if gyro:
            instrument, sigma = gyro[0].instrument, gyro[0].reading
        elif name in defaults:
            instrument, sigma = defaults[name]
        else:
            continue
        taken = {row.side for row in gyro}
        found += [
            Candidate(number, side, instrument, sigma)
            for side in range(heading.route.sides)
            if side not in taken
        ]
    return tuple(found)


def with_candidates(mine: Mine, chosen: Sequence[Candidate]) -> Mine:
    """The mine with candidates observed."""
    return mine.with_rows([(item.heading, planned_row(mine, item)) for item in chosen])


def plan_sides(
    mine: Mine, candidates: Sequence[Candidate], sides: int, allowed: float | None, *, factor: float
) -> PlacementPlan:
    """Best placements of K sides, the least programme, and other measures.

    Parameters
    ----------
    mine : Mine
    candidates : sequence of Candidate
    sides : int
        1 to the number of candidates.
    allowed : float or None
        Lateral tolerance [m]; compared with factor times sigma.
    factor : float
    """
    start = outlook(mine, candidates)
    found = best_placements(start, sides)
    placements = tuple(
        Placement(
            _named(mine, candidates, chosen),
            value,
            start.lateral - value,
            "exact" if found.exact else "exchange",
        )
        for chosen, value in zip(found.sets, found.lateral, strict=True)
    )
    least, why = _least(mine, candidates, start, (allowed, factor))
    return PlacementPlan(placements, least, why, measures(mine))


def _named(
    mine: Mine, candidates: Sequence[Candidate], chosen: Sequence[int]
) -> tuple[PlannedSide, ...]:
    found = []
    for index in chosen:
        item = candidates[index]
        at, to = mine.plan.headings[item.heading].sides[item.side]
        found.append(PlannedSide(at, to, item.instrument))
    return tuple(found)


def _least(
    mine: Mine,
    candidates: Sequence[Candidate],
    start: Outlook,
    judged: tuple[float | None, float],
) -> tuple[LeastProgramme | None, str]:
    allowed, factor = judged
    if allowed is None:
        return None, said("no lateral tolerance is stated, so no programme can be judged by it")
    found = least_sides(start, allowed / factor)
    if found is not None:
        chosen, value = found
        return LeastProgramme(len(chosen), value, _named(mine, candidates, chosen)), ""
    whole = with_candidates(mine, candidates)
    parts = contributions(whole)
    value = math.sqrt(float(total(parts)[0][0, 0]))
    shared = math.sqrt(sum(float(p.plane[0, 0]) for p in parts if p.source == "gyro_constant"))
    why = said(
        "no number of further gyro sides is enough: with all {candidates} free "
        "sides observed the prediction is {factor:g} x {value:.4f} = {factor2:.3f} "
        "m, above the allowed {allowed:g} m",
        candidates=len(candidates),
        factor=factor,
        value=value,
        factor2=factor * value,
        allowed=allowed,
    )
    if shared > 0.0:
        why += said(
            "; of this the shared error of the constant alone is {factor:g} x "
            "{shared:.4f} = {factor2:.3f} m, which no further side of the same "
            "instrument lowers: a second instrument or more rounds of calibration do",
            factor=factor,
            shared=shared,
            factor2=factor * shared,
        )
    return None, why


def measures(mine: Mine) -> tuple[Measure, ...]:
    """What else would help, best first."""
    now = lateral_sigma(mine)
    gyro = sum(row.kind is RowKind.GYRO for heading in mine.headings for row in heading.rows)
    found = [
        (
            "angles",
            scaled(mine, RowKind.ANGLE, BETTER_ANGLES),
            0,
            said("angles with 5/7 of the sigma"),
        )
    ]
    if gyro:
        mirrored, more = reciprocal(mine)
        rounds = {name: sigma / math.sqrt(2.0) for name, sigma in mine.gyros().items()}
        found += [
            (
                "gyro",
                scaled(mine, RowKind.GYRO, BETTER_GYRO),
                0,
                said("gyro sides with 2/3 of the sigma"),
            ),
            (
                "second_instrument",
                _second_instrument(mine),
                gyro,
                said("every gyro side with a second instrument too"),
            ),
            (
                "calibration_rounds",
                assemble(mine.plan, mine.headings, rounds, mine.calibrated),
                0,
                said("twice the rounds of calibration"),
            ),
        ]
        if more:
            found.append(("reciprocal", mirrored, more, said("gyro sides from both ends")))
    plan = replace(mine.plan, independent_surveys=mine.plan.independent_surveys + 1)
    found.append(
        ("second_survey", replace(mine, plan=plan), gyro, said("one independent survey more"))
    )
    made = [
        Measure(kind, value, now - value, cost, text)
        for kind, changed, cost, text in found
        for value in (lateral_sigma(changed),)
    ]
    return tuple(sorted(made, key=lambda item: item.lateral_m))


def _with_rows(mine: Mine, rows: Sequence[tuple[Row, ...]], more: Mapping[str, float]) -> Mine:
    headings: list[HeadingRows] = [
        replace(heading, rows=own) for heading, own in zip(mine.headings, rows, strict=True)
    ]
    return assemble(mine.plan, headings, {**mine.gyros(), **more}, mine.calibrated)


def scaled(mine: Mine, kind: RowKind, ratio: float) -> Mine:
    """All readings of one kind better by a ratio."""
    rows = [
        tuple(replace(r, reading=r.reading * ratio) if r.kind is kind else r for r in h.rows)
        for h in mine.headings
    ]
    return _with_rows(mine, rows, {})


def reciprocal(mine: Mine) -> tuple[Mine, int]:
    """Every gyro side also from its other end; how many determinations that costs."""
    rows, more = [], 0
    for heading in mine.headings:
        gyro = [row for row in heading.rows if row.kind is RowKind.GYRO]
        seen = {(row.side, row.forward, row.instrument) for row in gyro}
        extra = [
            replace(row, forward=not row.forward)
            for row in gyro
            if (row.side, not row.forward, row.instrument) not in seen
        ]
        more += len(extra)
        rows.append((*heading.rows, *extra))
    return _with_rows(mine, rows, {}), more


def _second_instrument(mine: Mine) -> Mine:
    """Every gyro side also with a second instrument of the same kind and calibration."""
    rows = [
        (
            *heading.rows,
            *(
                replace(row, instrument=row.instrument + SECOND)
                for row in heading.rows
                if row.kind is RowKind.GYRO
            ),
        )
        for heading in mine.headings
    ]
    return _with_rows(mine, rows, {n + SECOND: s for n, s in mine.gyros().items()})
