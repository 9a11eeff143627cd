"""What advice saves at a traverse, against an observation drawn at random.

A traverse of nine sides with one cause at work is observed on until the true cause holds 90 % of
the weight, eight observations at most. What an observation reads comes from true coordinates, not
from the engine.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from bench._traverses import Truth, Undeclared, simulated_with_truth
from surveyapp.diagnosis.next_rows import rows_advice, weighed_members
from surveyapp.diagnosis.subjects.traverse import traverse
from surveyapp.diagnosis.subjects.traverse_actions import TraversePlanner
from surveyapp.diagnosis.subjects.traverse_offers import Offer
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.priors import NU0

MOST, SURE = 8, 0.9
LENGTHS = np.random.default_rng(5).uniform(80.0, 300.0, 9)
TRAVERSES: dict[str, tuple[str, Undeclared, dict[str, Any]]] = {
    "sights bent by a wall, 8 arcsec in 100 m": (
        "lateral_refraction",
        Undeclared(bending=8.0),
        {"walls": True, "zig_zag": False},
    ),
    "angles too large by 12 arcsec": ("angle_bias", Undeclared(bias=12.0), {}),
    "one angle off by 42 arcsec": ("gross_error", Undeclared(), {"gross": (4, 6.0)}),
}
"""The effect, what is wrong, the traverse."""


def made_of(offer: Offer, truth: Truth, g: np.random.Generator) -> Observation:
    """The observation that an offer brings: what nature lets it read."""
    made = offer.made
    if offer.reversed:
        made = replace(made, back=made.to, to=made.back)
    if offer.other and made.kind is not ObservationKind.AZIMUTH:
        made = replace(made, note=f"{made.note} instrument=B".strip())
    value = truth.reads(made, other=offer.other) + made.sigma * g.normal()
    turns = made.kind not in (ObservationKind.DISTANCE, ObservationKind.GYRO_CONSTANT)
    return replace(made, value=value % math.tau if turns else value)


def traverse_visits(name: str, i: int, *, advised: bool) -> int:
    """Observations until the true cause is sure; ``MOST`` + 1 if it never is."""
    effect, wrong, how = TRAVERSES[name]
    g = np.random.default_rng([8, i, len(name)])
    network, truth = simulated_with_truth(g, wrong, LENGTHS, **how)
    for count in range(MOST + 1):
        case = traverse(network)
        assert case.planner is not None
        planner = case.planner()
        assert isinstance(planner, TraversePlanner)
        members = weighed_members(case, planner, NU0)
        total = sum(item.weight for item in members)
        if sum(m.weight for m in members if m.unit.split()[0] == effect) >= SURE * total:
            return count
        offers = planner.offers
        if advised:
            outlook = rows_advice(case, g)
            assert outlook is not None
            text = outlook.actions[0].text
            offer = next(o for o in offers if o.text == text)
        else:
            offer = offers[int(g.integers(len(offers)))]
        more = made_of(offer, truth, g)
        network = replace(network, observations=(*network.observations, more))
    return MOST + 1
