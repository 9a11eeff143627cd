"""A traverse as a problem: what its misclosures say about instruments and field work.

An adjusted network of n observations with p unknowns contradicts itself in n - p independent
conditions only. They are what is diagnosed: the whitened residuals in an orthonormal base of what
the unknowns leave free, each with a standard deviation of 1 if the stated sigmas are right. One row
more carries the result: the place of the least certain point along the longest axis of its
ellipse, in units of its own sigma, so that every effect shows what it does to the coordinates.

The conditions have no order: there are no generic shapes over time and no wandering noise here;
correlation is the business of the covariance blocks. Nothing is corrected: a distance whose
atmosphere the instrument has corrected is taken as it stands.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from surveyapp.core.network.model import Model, compile_network
from surveyapp.core.network.observation_equations import equations, linearised, misclosures
from surveyapp.core.network.solving import solve_network
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.subjects.pointings import one_a_pointing
from surveyapp.diagnosis.subjects.traverse_actions import Adjusted, planner_of
from surveyapp.diagnosis.subjects.traverse_columns import gyro_sides, observation_columns
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Network
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.languages import said
from surveyapp_models.arrays import Floats
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Columns, Effect

K = ObservationKind
LEAST_REDUNDANCY = 0.02
"""Below it a slip must exceed 29 of its own sigmas to be found (4.13 over the root of it), and any
small misclosure would be called a large one."""
MOST_OBSERVATIONS = 2000
"""The conditions are held in a dense matrix; larger networks are diagnosed in parts."""
RANK = 1e-9
"""Singular values below this share of the largest are a free datum."""
TRANSFORM = "conditions_of_observations"


def _refuse_many(network: Network, identity: str) -> None:
    if len(network.observations) > MOST_OBSERVATIONS:
        raise SurveyError(
            Problem(
                "too many observations to diagnose them together",
                identity,
                str(len(network.observations)),
                said("at most {most_observations}", most_observations=MOST_OBSERVATIONS),
                "Diagnose one traverse at a time.",
            )
        )


def traverse(
    network: Network,
    *,
    name: str = "",
    atmosphere_applied: bool | None = None,
    extra: tuple[Effect, ...] = (),
    gyro_sigma: float | None = None,
) -> Case:
    """Make the problem of a network.

    Parameters
    ----------
    network : Network
        A sight along a wall says so in its note: ``wall=left`` or ``wall=right``.
    name : str
        For messages.
    atmosphere_applied : bool or None
        Whether the instrument has corrected the distances; None = nobody says.
    extra : tuple of Effect
        The user's own; their basis is in the unit of the observations [rad] and [m].
    gyro_sigma : float or None
        Of a gyro azimuth of this office, for advice on a traverse without gyro sides [rad].

    Returns
    -------
    Case
        ``columns`` are those of the observations, ``observations`` the conditions.

    Raises
    ------
    SurveyError
        What the adjustment refuses, no redundancy at all, or too many observations.
    """
    identity = name or network.name or "traverse"
    _refuse_many(network, identity)
    network, repeated = one_a_pointing(network)
    adjusted, weakest = _adjusted(network, identity)
    model, columns = adjusted.model, adjusted.columns
    size = columns[TRANSFORM].shape[0]
    effects = (*of_subject("traverse"), *extra)
    base = np.zeros((size, 1))
    base[0, 0] = 1.0
    return Case(
        subject="traverse",
        title=said("traverse"),
        value_name=said("the place of the least certain point"),
        observations=adjusted.transform @ adjusted.right,
        base=base,
        base_names=(said("place of {weakest}", weakest=weakest),),
        value_base=np.ones(1),
        value_weights=np.zeros(size),
        position=np.zeros(size),
        columns=columns,
        effects=tuple(_in_conditions(effect) for effect in effects),
        sigma=np.ones(size),
        unit="sigma",
        scale=1.0,
        identity=identity,
        labels=(
            said("place of {weakest}", weakest=weakest),
            *[said("condition {i}", i=i) for i in range(1, size)],
        ),
        grid_labels={**_labels(model), **adjusted.labels},
        warnings=(*repeated, *_warnings(atmosphere_applied, columns, weakest)),
        planner=partial(planner_of, adjusted, effects, gyro_sigma),
    )


def _adjusted(network: Network, identity: str) -> tuple[Adjusted, str]:
    """The adjusted network with its conditions, and the name of its least certain point."""
    model = compile_network(network)
    values = solve_network(network, model).values
    whitener, design, right = _whitened(model, values)
    inverse = np.asarray(np.linalg.pinv(design, rcond=RANK), dtype=np.float64)
    weakest, towards = _weakest_point(network, model, inverse)
    transform = _conditions(design, towards)
    if transform.shape[0] < 2:
        raise SurveyError(
            Problem(
                "nothing controls the traverse",
                identity,
                said("{size} observations, all of them necessary", size=len(model.observations)),
                "a closure, a repetition, a fixed point or gyro side more",
            )
        )
    told = observation_columns(network, model, values)
    columns = {**told.columns, TRANSFORM: transform @ whitener}
    columns["own_sigma"] = _controlled(columns)
    found = Adjusted(
        network=network,
        model=model,
        values=values,
        whitener=whitener,
        design=design,
        right=right,
        inverse=inverse,
        transform=transform,
        columns=columns,
        labels=told.labels,
    )
    return found, weakest


def _controlled(columns: Mapping[str, Floats]) -> Floats:
    """Stated sigmas of the observations that the others control, else 0: no slip shows in them.

    The squared norm of what an error of one sigma does to the conditions is its redundancy number
    (Baarda 1968).
    """
    sigma = columns["own_sigma"]
    redundancy = np.sum((columns[TRANSFORM][1:] * sigma) ** 2, axis=0)
    return np.where(redundancy >= LEAST_REDUNDANCY, sigma, 0.0)


def _in_conditions(effect: Effect) -> Effect:
    """The same effect, its basis taken from the observations to the conditions."""

    def basis(columns: Columns, /, **grid: float) -> Floats:
        return np.asarray(columns[TRANSFORM] @ effect.basis(columns, **grid))

    return replace(effect, basis=basis)


def _whitened(model: Model, values: Floats) -> tuple[Floats, Floats, Floats]:
    """Whitener (n, n), whitened design (n, u) and misclosures (n,) at the adjusted values."""
    computed, partials = linearised(model, values)
    n, u = len(model.value), model.structure.count
    misclosure = misclosures(model, computed)
    whitener, design, right = np.zeros((n, n)), np.zeros((n, u + 1)), np.zeros(n)
    for group in equations(model, partials, misclosure):
        inverse = np.linalg.inv(group.root)
        for rows, unknowns, jacobian, part, inv in zip(
            group.rows, group.unknowns, group.jacobian, group.misclosure, inverse, strict=True
        ):
            whitener[np.ix_(rows, rows)] = inv
            design[np.ix_(rows, unknowns)] += jacobian
            right[rows] = part
    return whitener, design[:, :u], right


def _weakest_point(network: Network, model: Model, pseudo: Floats) -> tuple[str, Floats]:
    """Name of the least certain point, and the unit row that estimates its worst coordinate."""
    unknowns = model.unknown_of[: 3 * len(network.points)].reshape(-1, 3)
    best: tuple[float, str, Floats] = (0.0, "", np.zeros(pseudo.shape[1]))
    for point, own in zip(network.points, unknowns, strict=True):
        rows = pseudo[own[own >= 0]]
        if not len(rows):
            continue
        variance, axes = np.linalg.eigh(rows @ rows.T)
        if variance[-1] > best[0]:
            best = (float(variance[-1]), point.name, axes[:, -1] @ rows)
    norm = float(np.linalg.norm(best[2]))
    return best[1], best[2] / norm if norm > 0.0 else best[2]


def _conditions(design: Floats, towards: Floats) -> Floats:
    """The row of the result and an orthonormal base of what the unknowns leave, (r + 1, n)."""
    left, singular, _ = np.linalg.svd(design, full_matrices=True)
    rank = int((singular > RANK * singular[0]).sum()) if singular.size else 0
    return np.vstack([towards[None, :], left[:, rank:].T])


def _labels(model: Model) -> dict[str, dict[float, str]]:
    """What the numbers of the scanned parameters stand for."""
    side, _ = gyro_sides(model)
    return {
        "observation": {float(i): obs.where for i, obs in enumerate(model.observations, start=1)},
        "first_side": {
            float(s): f"{obs.at}-{obs.to}"
            for s, obs in zip(side, model.observations, strict=True)
            if s > 0.0
        },
    }


def _warnings(
    atmosphere_applied: bool | None, columns: Mapping[str, Floats], weakest: str
) -> tuple[ResultWarning, ...]:
    value = said(
        "values are the place of {weakest}, the least certain point, in its own sigmas",
        weakest=weakest,
    )
    found = [ResultWarning("weakest_point", value)]
    if not columns["distance_m"].any():
        return tuple(found)
    if atmosphere_applied is None:
        text = said(
            "atmosphere_applied is not stated: whether the distances hold the "
            "atmospheric correction is unknown, and a scale may be nothing else"
        )
        found.append(ResultWarning("atmosphere_unknown", text))
    elif atmosphere_applied:
        text = said(
            "the instrument has corrected the atmosphere: nothing is corrected again, "
            "and a scale found here first asks whether somebody did"
        )
        found.append(ResultWarning("atmosphere_applied", text))
    return tuple(found)
