"""What each part of the rule of names does: right against wrong names, on records of its own.

Every line of runs at N = 20 of ``operating_characteristics`` and the lines that no catalogue has,
with seeds of this bench, searched under several rules: the specification's own (a gate of .05 at
every depth, rivals worse by 4 BIC), then one change after the other to the rule that is used, then
smaller margins. SURVEYAPP_BENCH_RUNS is the number of records a line, SURVEYAPP_BENCH_STORE a
folder in which finished lines are kept.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from bench._records import Truth, problems
from bench._stored import stored
from bench.operating_characteristics import REFERENCE
from surveyapp.diagnosis.case import Case, Levels
from surveyapp.diagnosis.loop import search
from surveyapp.diagnosis.subjects.reversal_run import LEVELS

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "30"))
DRAWS = 1000
SEED = 20261201
RULES: Mapping[str, Levels] = {
    "specification: gate .05, rivals worse by 4": Levels(),
    "gate .01 beside a first effect": replace(LEVELS, shape_odds=0.0),
    "and a shape charged by its odds (used)": LEVELS,
    "rivals worse by 3": replace(LEVELS, margin=3.0),
    "rivals worse by 2": replace(LEVELS, margin=2.0),
}


def named(case: Case) -> dict[str, frozenset[str]]:
    """The names that each rule gives a record."""
    return {
        rule: frozenset(search(replace(case, levels=levels), draws=DRAWS, confirm=None).adopted)
        for rule, levels in RULES.items()
    }


def line(place: int, truth: Truth) -> list[list[int]]:
    """Of each rule: records that are rightly and that are wrongly named."""
    expected = frozenset(truth.effect.split("+")) - {""}
    made, _ = problems(truth, RUNS, SEED + place)
    found = [named(case) for case in made]
    right = [sum(bool(expected) and expected <= names[rule] for names in found) for rule in RULES]
    wrong = [sum(bool(names[rule] - expected) for names in found) for rule in RULES]
    return [right, wrong]


def lines() -> list[tuple[int, Truth]]:
    """The catalogue at N = 20, and what no catalogue has."""
    return [
        (place, truth)
        for place, truth in enumerate(REFERENCE)
        if not truth.name.startswith("none") and (truth.size == 20 or not truth.effect)
    ]


def run() -> list[str]:
    """Evaluate every line, return what is printed."""
    whole = {True: [0] * len(RULES), False: [0] * len(RULES)}
    right = [0] * len(RULES)
    for place, truth in lines():
        key = (truth, place, RUNS, tuple(RULES.items()))
        one = stored(f"names {truth.name} {truth.size}", key, partial(line, place, truth))
        own = whole[bool(truth.effect)]
        for k in range(len(RULES)):
            right[k] += one[0][k]
            own[k] += one[1][k]
    known = RUNS * sum(bool(truth.effect) for _, truth in lines())
    unknown = RUNS * sum(not truth.effect for _, truth in lines())
    text = [f"| rule | right of {known} | wrong | in no catalogue, of {unknown}: a name |"]
    text.append("|---|---|---|---|")
    text += [
        f"| {rule} | {right[k] / known:.3f} | {whole[True][k] / known:.3f} "
        f"| {whole[False][k] / unknown:.3f} |"
        for k, rule in enumerate(RULES)
    ]
    return text
