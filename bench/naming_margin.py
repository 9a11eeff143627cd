"""What each part of the rule of names does: right against wrong names, on records of its own.

Every line of runs at N = 20 of ``operating_characteristics`` and the lines that no catalogue has,
with seeds of this bench, searched under several rules: the specification's own (a gate of .05 at
every depth, rivals worse by 4 BIC), then one change after the other to the rule that is used, then
smaller margins. SURVEYAPP_BENCH_RUNS is the number of records a line.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace

from bench._records import Truth, problems
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


def lines() -> list[tuple[int, Truth]]:
    """The catalogue at N = 20, and what no catalogue has."""
    return [
        (place, truth)
        for place, truth in enumerate(REFERENCE)
        if not truth.name.startswith("none") and (truth.size == 20 or not truth.effect)
    ]


def run() -> list[str]:
    """Evaluate every line, return what is printed."""
    right, wrong, strange = (dict.fromkeys(RULES, 0) for _ in range(3))
    known = unknown = 0
    for place, truth in lines():
        expected = frozenset(truth.effect.split("+")) - {""}
        made, _ = problems(truth, RUNS, SEED + place)
        for case in made:
            known, unknown = known + bool(expected), unknown + (not expected)
            for rule, names in named(case).items():
                false = bool(names - expected)
                right[rule] += bool(expected) and expected <= names
                wrong[rule] += bool(expected) and false
                strange[rule] += not expected and false
    text = [f"| rule | right of {known} | wrong | in no catalogue, of {unknown}: a name |"]
    text.append("|---|---|---|---|")
    text += [
        f"| {rule} | {right[rule] / known:.3f} | {wrong[rule] / known:.3f} "
        f"| {strange[rule] / unknown:.3f} |"
        for rule in RULES
    ]
    return text
