"""What a rank defect means in the trade's words: no datum, not connected, or which points hang."""

from __future__ import annotations

import numpy as np

from surveyapp.core.leastsquares.equations import Ints
from surveyapp.core.network.gaussnewton import Converged
from surveyapp.core.network.model import Model
from surveyapp.domain.traverse import Network, Status
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said

MOST_NAMED = 20


def unknown_name(network: Network, model: Model, unknown: int) -> tuple[str, str]:
    """Owner and name of an unknown: ("point P", "e"), ("station A", "orientation"), ..."""
    slot = int(model.slot_of[unknown])
    if slot < model.coordinate_slots:
        return f"point {network.points[slot // 3].name}", "enh"[slot % 3]
    index = slot - model.coordinate_slots
    if index < len(model.constants):
        return f"gyro {model.constants[index]}", "instrument constant"
    at, name = model.orientations[index - len(model.constants)]
    return f"station {at}" + (f", set {name}" if name else ""), "orientation"


def _parts(network: Network, model: Model) -> list[set[str]]:
    """Groups of points that observations join, largest first."""
    parent = {point.name: point.name for point in network.points}

    def find(name: str) -> str:
        while parent[name] != name:
            parent[name] = parent[parent[name]]
            name = parent[name]
        return name

    for obs in model.observations:
        for other in (obs.to, obs.back):
            if other and obs.at in parent:
                parent[find(other)] = find(obs.at)
    groups: dict[str, set[str]] = {}
    for name in parent:
        groups.setdefault(find(name), set()).add(name)
    return sorted(groups.values(), key=len, reverse=True)


def refuse_undetermined(network: Network, state: Converged) -> SurveyError:
    """Error that names every undetermined unknown and says why."""
    undetermined, model = state.solved.undetermined, state.model
    owners: dict[str, list[str]] = {}
    for unknown in undetermined.tolist():
        owner, name = unknown_name(network, model, unknown)
        owners.setdefault(owner, []).append(name)
    names = {"plane": "en", "height": "h"}
    lacking = {key for owner in owners.values() for key in names if set(owner) & set(names[key])}
    free_datum = bool(lacking) and not any(
        status in (Status.FIXED, Status.CONSTRAINED)
        for point in network.points
        for part, _, status in point.components()
        if any(part in names[key] for key in lacking)
    )
    parts = _parts(network, model)
    problems = [_reason(state.solved.defect, undetermined, model, parts, free_datum=free_datum)]
    named = list(owners.items())
    problems += [
        Problem(
            "Not determined by the observations",
            owner,
            ", ".join(names),
            "observations that fix it",
            "",
        )
        for owner, names in named[:MOST_NAMED]
    ]
    if len(named) > MOST_NAMED:
        found = said("{more} further points or stations", more=len(named) - MOST_NAMED)
        problems.append(Problem("Not determined either", "network", found, "", ""))
    return SurveyError(problems)


def _reason(
    defect: int, undetermined: Ints, model: Model, parts: list[set[str]], *, free_datum: bool
) -> Problem:
    found = said(
        "rank defect {defect}, {size} unknowns not determined",
        defect=defect,
        size=len(undetermined),
    )
    coordinates = model.slot_of < model.coordinate_slots
    touched = np.isin(np.flatnonzero(coordinates), undetermined)
    if free_datum:
        hint = (
            "Fix points or an azimuth, or constrain points for a free network: of a project "
            "coordinates and fixed = true in [[station]], of an import `fixed` NAME."
        )
        return Problem("The network has no datum", "network", found, "fixed points", hint)
    joined = [part for part in parts if len(part) > 1]
    if len(joined) > 1:
        small = ", ".join(sorted(joined[-1])[:8])
        hint = said(
            "One part is {small}. Join it to the rest, or give it its own fixed points.",
            small=small,
        )
        return Problem("The network is not connected", "network", found, "one network", hint)
    if touched.all():
        hint = "Too few fixed coordinates, or no azimuth, for this kind of observations."
        return Problem("The datum is incomplete", "network", found, "a full datum", hint)
    return Problem(
        "Parts of the network are not determined", "network", found, "a determined network", ""
    )
