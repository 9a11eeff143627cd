"""The ledger entry of a diagnosis: every trial, so that nothing that was tried is forgotten.

A value only; appending it to ``ledger.jsonl`` with time and software is the business of io.
"""

from __future__ import annotations

import math
from typing import Any

from surveyapp.diagnosis.battery import BatteryTest
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.fits import Fit
from surveyapp.diagnosis.loop import Search

SCHEMA = "surveyapp.ledger.diagnosis/1"


def ledger_entry(
    problem: Case,
    found: Search,
    battery: tuple[BatteryTest, ...],
    *,
    digest: str,
    draws: int,
) -> dict[str, Any]:
    """Everything that was tried in one diagnosis, as plain values."""
    return {
        "schema": SCHEMA,
        "subject": problem.subject,
        "identity": problem.identity,
        "instrument": problem.instrument,
        "data_sha256": digest,
        "observations": problem.size,
        "draws": draws,
        "battery": [
            {
                "channel": test.channel,
                "test": test.name,
                "statistic": round(test.statistic, 6),
                "p": round(test.p, 6),
            }
            for test in battery
        ],
        "gates": [
            {
                "beside": list(gate.effects),
                "p_family": round(gate.p_family, 6),
                "tests": [
                    {"effect": t.id, "p": t.p, "p_family": t.p_family, "left": round(t.left, 6)}
                    for t in gate.tests
                ],
            }
            for gate in found.gates
        ],
        "trials": [
            {"depth": level.depth, "sets": [_trial(problem, fit) for fit in level.every]}
            for level in found.levels
        ],
        "adopted": list(found.adopted),
        "refused": [{"effect": name, "reason": reason} for name, reason in found.refused],
    }


def _trial(problem: Case, fit: Fit) -> dict[str, Any]:
    return {
        "effects": list(fit.effects),
        "grid": [member.point for member in fit.members],
        "parameters": fit.parameters,
        "bic": round(fit.bic, 3),
        "rms": math.sqrt(fit.sum_of_squares / problem.size) / problem.scale,
    }
