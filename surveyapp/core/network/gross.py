"""Observations that miss by more than a stated tolerance: left out before the tests, never hidden.

Each of them stays in the result with its misclosure, marked as left out, and is a check not met.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.network.gaussnewton import Converged
from surveyapp.core.network.model import Model, compile_network
from surveyapp.core.network.observation_equations import linearised, misclosures
from surveyapp.core.network.solving import solve_network
from surveyapp.domain.adjustment import AdjustedObservation, LeftOut
from surveyapp.domain.traverse import Network
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import joined, said
from surveyapp_models.arrays import Floats


@dataclass(frozen=True, slots=True)
class Cleaned:
    """The network without what missed by more than the tolerance, solved.

    Parameters
    ----------
    model, state
        Of the reduced network; ``model.used`` counts in the whole one.
    rows : tuple of AdjustedObservation
        What was left out, against the adjusted points.
    left_out : tuple of LeftOut
    warning : ResultWarning
    """

    model: Model
    state: Converged
    rows: tuple[AdjustedObservation, ...]
    left_out: tuple[LeftOut, ...]
    warning: ResultWarning


def gross_misfit(network: Network, model: Model, values: Floats, misclosure: Floats) -> Floats:
    """Misclosure of each observation across its sight [m]; a constant has no sight."""
    misfit = np.abs(misclosure)
    points = values[: 3 * len(network.points)].reshape(-1, 3)[:, :2]
    slots = model.slots[model.angular]
    real = np.logical_and(slots >= 0, slots < model.coordinate_slots)
    owner = np.where(real, slots, slots[:, :1]) // 3
    owner = np.where(np.any(real, axis=1, keepdims=True), owner, 0)
    reach = np.linalg.norm(points[owner] - points[owner[:, :1]], axis=2).max(axis=1)
    misfit[model.angular] *= reach
    return misfit


def without_gross(network: Network, model: Model, state: Converged) -> Cleaned | None:
    """Leave out what misses by more than the stated tolerance, one worst at a time."""
    if network.tolerance_m is None:
        return None
    gone: list[int] = []
    reduced, whole = network, model
    places = list(range(len(network.observations)))
    while True:
        if float(np.abs(state.misclosure).max()) == 0.0:
            break
        misfit = gross_misfit(reduced, model, state.values, state.misclosure)
        candidates = np.flatnonzero((misfit > network.tolerance_m) & (model.used >= 0))
        if not len(candidates):
            break
        weighted = np.abs(state.misclosure[candidates]) / model.sigma[candidates]
        worst = int(candidates[np.argmax(weighted)])
        place = int(model.used[worst])
        gone.append(places.pop(place))
        reduced = without(reduced, {place})
        model = compile_network(reduced)
        state = solve_network(reduced, model)
    if not gone:
        return None
    used = np.array([places[i] if i >= 0 else -1 for i in model.used.tolist()], dtype=np.int64)
    names = [network.observations[place].where for place in gone]
    text = said(
        "{names} observations miss by more than {tolerance_m:g} m and were left out: {names2}",
        names=len(names),
        tolerance_m=network.tolerance_m,
        names2=joined("; ", names),
    )
    values, misses = _against(whole, (model, state))
    misfits = gross_misfit(network, whole, values, np.nan_to_num(misses))
    row_of = {place: row for row, place in enumerate(whole.used.tolist())}
    return Cleaned(
        replace(model, used=used),
        state,
        tuple(_left_out_row(whole, row_of[place], float(misses[row_of[place]])) for place in gone),
        tuple(
            LeftOut(place, name, float(misfits[row_of[place]]), network.tolerance_m)
            for place, name in zip(gone, names, strict=True)
        ),
        ResultWarning("gross_errors_left_out", text),
    )


def _against(whole: Model, solved: tuple[Model, Converged]) -> tuple[Floats, Floats]:
    """Values of every slot of the whole network, and misclosures against them."""
    model, state = solved
    first = model.coordinate_slots + len(model.constants)
    values = np.full(
        whole.coordinate_slots + len(whole.constants) + len(whole.orientations), np.nan
    )
    values[:first] = state.values[:first]
    turned = {key: state.values[first + i] for i, key in enumerate(model.orientations)}
    for i, key in enumerate(whole.orientations):
        values[first + i] = turned.get(key, np.nan)
    with np.errstate(invalid="ignore"):
        return values, misclosures(whole, linearised(whole, values)[0])


def _left_out_row(whole: Model, row: int, miss: float) -> AdjustedObservation:
    """An observation that was left out, computed from the adjusted points."""
    obs = whole.observations[row]
    miss = 0.0 if miss != miss else miss  # the last of a set: nothing is left to miss
    return AdjustedObservation(
        place=int(whole.used[row]),
        kind=obs.kind,
        at=obs.at,
        back=obs.back,
        to=obs.to,
        observed=obs.value,
        adjusted=obs.value - miss,
        residual=-miss,
        sigma=obs.sigma,
        sigma_adjusted=0.0,
        standardized=None,
        redundancy=0.0,
        mdb=None,
        mdb_effect_m=None,
        group=obs.group,
        line=obs.line,
        left_out=True,
    )


def without(network: Network, places: set[int]) -> Network:
    """The network without some observations, blocks reduced accordingly."""
    keep = [i for i in range(len(network.observations)) if i not in places]
    moved = {old: new for new, old in enumerate(keep)}
    blocks = []
    for block in network.blocks:
        left = [i for i, member in enumerate(block.members) if member in moved]
        if left:
            blocks.append(
                replace(
                    block,
                    members=tuple(moved[block.members[i]] for i in left),
                    covariance=tuple(tuple(block.covariance[i][j] for j in left) for i in left),
                )
            )
    return replace(
        network,
        observations=tuple(network.observations[i] for i in keep),
        blocks=tuple(blocks),
    )
