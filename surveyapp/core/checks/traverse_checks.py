"""Closures and repeated lengths of traverses against their own sigmas: no rule book is needed."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

from surveyapp.core.checks.evidence import TraverseEvidence
from surveyapp.core.network.closures import network_closures
from surveyapp.domain.adjustment import SIGMAS, Closure
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.results import Check
from surveyapp.domain.subject import Subject
from surveyapp.domain.traverse import Network
from surveyapp.languages import said
from surveyapp_models.angles import RHO_ARCSEC

K = ObservationKind


def traverse_checks(traverses: Sequence[TraverseEvidence]) -> list[Check]:
    """Checks of every closure that has a sigma, and of every length measured from both ends."""
    checks: list[Check] = []
    for item in traverses:
        subject = item.traverse.subject
        closures = network_closures(item.network)
        checks += [closure_check(c, subject) for c in closures if c.passed is not None]
        checks += forward_back(item.network, subject)
    return checks


def closure_check(item: Closure, subject: Subject) -> Check:
    """A closure against three of its own standard deviations."""
    angular = item.angular is not None
    value = abs(item.angular or 0.0) * RHO_ARCSEC if angular else abs(item.height_m or 0.0) * 1e3
    sigma = item.angular_sigma if angular else item.height_sigma_m
    scale = RHO_ARCSEC if angular else 1e3
    return Check(
        rule=f"traverse.{item.kind}_closure",
        clause=said("3 sigma of the misclosure"),
        value=value,
        limit=None if sigma is None else SIGMAS * sigma * scale,
        confirmed=True,
        passed=item.passed,
        unit="arcsec" if angular else "mm",
        where="-".join(item.stations[:6]) + ("-..." if len(item.stations) > 6 else ""),
        text=said("{angles} angles", angles=item.angles) if angular else "heights",
        subject=subject,
    )


def forward_back(network: Network, subject: Subject) -> list[Check]:
    """Lengths measured from both ends: forward against back, judged by their sigmas."""
    both: dict[tuple[str, str], dict[str, Observation]] = defaultdict(dict)
    for obs in network.observations:
        if obs.kind in (K.DISTANCE, K.SLOPE_DISTANCE):
            both[min(obs.at, obs.to), max(obs.at, obs.to)].setdefault(obs.at, obs)
    checks = []
    for pair, ends in both.items():
        if len(ends) < 2:
            continue
        a, b = ends[pair[0]], ends[pair[1]]
        if a.kind is not b.kind or (a.hi, a.ht) != (b.ht, b.hi):
            continue
        value, limit = abs(a.value - b.value), SIGMAS * math.hypot(a.sigma, b.sigma)
        checks.append(
            Check(
                rule="traverse.forward_back",
                clause=said("3 sigma of the difference"),
                value=value * 1000.0,
                limit=limit * 1000.0,
                confirmed=True,
                passed=value <= limit,
                unit="mm",
                where="-".join(pair),
                text=said("length forward against back"),
                subject=subject,
            )
        )
    return checks
