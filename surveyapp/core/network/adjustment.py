"""The adjustment of a network: from observations to points, sigmas, tests and warnings.

Puts the parts together and says what went wrong in the trade's words; the numbers come from the
modules that it calls.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from surveyapp.core.network import quality as q
from surveyapp.core.network.angle_pairs import fold
from surveyapp.core.network.closures import network_closures
from surveyapp.core.network.collector import paused_collection
from surveyapp.core.network.estimated_sigmas import shares
from surveyapp.core.network.gaussnewton import Converged
from surveyapp.core.network.gross import without_gross
from surveyapp.core.network.level_distances import with_level_distances
from surveyapp.core.network.model import Model, compile_network
from surveyapp.core.network.solving import mirror_warning, solutions
from surveyapp.domain.adjustment import (
    AdjustedObservation,
    AdjustedPoint,
    AdjustmentResult,
    Ellipse,
    RelativeEllipse,
    SharedValue,
    Snooping,
    Suspect,
)
from surveyapp.domain.traverse import Network, Status
from surveyapp.domain.warning import ResultWarning
from surveyapp.languages import said
from surveyapp_models.arrays import Floats

SOUND = 1e-3
"""Relative gap between redundancies and degrees of freedom from which on a user must know."""
FAMILY_LEVEL = 0.05
"""Probability of accusing any observation of a network that has no gross error."""


def adjust(
    network: Network, *, family_level: float = FAMILY_LEVEL, relative: bool = True
) -> AdjustmentResult:
    """Adjust a network by least squares.

    Parameters
    ----------
    network : Network
    family_level : float
        Level of data snooping for all observations together.
    relative : bool
        Whether relative ellipses of neighbouring points are wanted.

    Returns
    -------
    AdjustmentResult
        Sigmas are one sigma, a priori or scaled by the residuals as the network says.

    Raises
    ------
    SurveyError
        No datum, undetermined points (named), no approximate coordinates, no convergence.
    """
    with paused_collection():
        network, projected = with_level_distances(network)
        model = compile_network(network)
        found = solutions(network, model)
        state = found.state
        warnings = [*network.warnings, *_skipped_warning(network, model, projected)]
        cleaned = without_gross(network, model, state)
        if cleaned is None:
            warnings += mirror_warning(network, found)
            return _result(network, model, state, tuple(warnings), options=(family_level, relative))
        warnings.append(cleaned.warning)
        result = _result(
            network, cleaned.model, cleaned.state, tuple(warnings), options=(family_level, relative)
        )
        rows = (*result.observations, *cleaned.rows)
        return replace(result, observations=rows, left_out=cleaned.left_out)


def _skipped_warning(
    network: Network, model: Model, projected: frozenset[int]
) -> list[ResultWarning]:
    """Observations that could not be used; those that became horizontal distances were."""
    skipped = [i for i in model.skipped if i not in projected]
    if not skipped:
        return []
    first = ", ".join(network.observations[i].where for i in skipped[:5])
    more = said(" and {number} more", number=len(skipped) - 5) if len(skipped) > 5 else ""
    text = said(
        "{skipped} observations touch a coordinate that is neither fixed nor "
        "adjusted and were not used: {first}{more}",
        skipped=len(skipped),
        first=first,
        more=more,
    )
    return [ResultWarning("observations_not_used", text)]


def _result(
    network: Network,
    model: Model,
    state: Converged,
    warnings: tuple[ResultWarning, ...],
    *,
    options: tuple[float, bool],
) -> AdjustmentResult:
    family_level, relative = options
    solved = state.solved
    dof = len(model.observations) - model.structure.count + solved.defect
    coordinate = np.append(state.model.slot_of < model.coordinate_slots, 0.0).astype(np.float64)
    checked = q.assess(state.groups, solved.cofactor, len(state.model.value), coordinate)
    checked = fold(state.model, checked, len(model.observations))
    test = q.global_test(
        state.sum_of_squares,
        dof,
        sigma_apriori=network.sigma_apriori,
        probability=network.confidence,
        estimated=shares(model.observations, q.control(checked.mdb), dof),
    )
    estimated = network.scaled_by_residuals and test.ratio is not None
    scale = float(test.ratio or 1.0) if estimated else 1.0
    warnings = (*warnings, *_unsound(float(checked.redundancy.sum()), dof))
    return AdjustmentResult(
        points=_points(network, model, state, scale),
        observations=_observations(model, state, checked, scale),
        sigma0=None if test.ratio is None else test.ratio * network.sigma_apriori,
        dof=dof,
        defect=solved.defect,
        iterations=state.iterations,
        global_test=test,
        sigma_scale=scale,
        confidence_scale=q.confidence_scale(network.confidence, dof if estimated else None),
        closures=network_closures(network),
        shared=_shared(model, state, scale),
        relative=_relative(network, model, state, scale) if relative else (),
        snooping=_snooping(
            model, checked, scale, (family_level, dof if estimated else None, test.sigma_dof)
        ),
        warnings=warnings,
    )


def _unsound(redundancy: float, dof: int) -> list[ResultWarning]:
    """Redundancies sum to the degrees of freedom, or rounding has spoilt the cofactors."""
    if abs(redundancy - dof) <= SOUND * max(dof, 1):
        return []
    text = said(
        "the redundancies sum to {redundancy:.6g} instead of {dof}: the network is "
        "so weak that its sigmas and tests are not reliable",
        redundancy=redundancy,
        dof=dof,
    )
    return [ResultWarning("cofactors_inaccurate", text)]


def _point_cofactors(state: Converged, points: int) -> Floats:
    """Covariances (points, 3, 3) with the a-priori sigmas; 0 where fixed or unused."""
    unknowns = state.model.unknown_of[: 3 * points].reshape(-1, 3)
    return state.solved.cofactor.blocks(unknowns)


def _points(
    network: Network, model: Model, state: Converged, scale: float
) -> tuple[AdjustedPoint, ...]:
    covariance = _point_cofactors(state, len(network.points)) * scale**2
    sigma = np.sqrt(np.maximum(np.einsum("nii->ni", covariance), 0.0))
    axes = np.stack(
        q.ellipse_axes(covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]), axis=1
    )
    known = state.values[: 3 * len(network.points)].reshape(-1, 3).tolist()
    unknowns = model.unknown_of[: 3 * len(network.points)].reshape(-1, 3)
    both: list[bool] = np.all(unknowns[:, :2] >= 0, axis=1).tolist()
    rows = zip(
        network.points, known, sigma.tolist(), axes.tolist(), both, covariance.tolist(), strict=True
    )
    result = []
    for point, at, s, (a, b, azimuth), plane, matrix in rows:
        used = (
            point.status_e is not Status.UNUSED,
            point.status_n is not Status.UNUSED,
            point.status_h is not Status.UNUSED,
        )
        given = (point.e, point.n, point.h)
        values = [
            x if flag and not math.isnan(x) else g
            for x, flag, g in zip(at, used, given, strict=True)
        ]
        sigmas = [x if flag else None for x, flag in zip(s, used, strict=True)]
        result.append(
            AdjustedPoint(
                point.name,
                values[0],
                values[1],
                values[2],
                sigmas[0],
                sigmas[1],
                sigmas[2],
                Ellipse(a, b, azimuth) if plane else None,
                tuple((r[0], r[1], r[2]) for r in matrix),
            )
        )
    return tuple(result)


def _observations(
    model: Model, state: Converged, checked: q.Quality, scale: float
) -> tuple[AdjustedObservation, ...]:
    residual = -state.misclosure
    columns = zip(
        model.observations,
        model.used.tolist(),
        residual.tolist(),
        (checked.sigma_adjusted * scale).tolist(),
        (checked.standardized / scale if scale > 0.0 else checked.standardized).tolist(),
        np.where(np.abs(checked.redundancy) < q.UNCONTROLLED, 0.0, checked.redundancy).tolist(),
        (checked.mdb * scale).tolist(),
        (checked.effect * scale).tolist(),
        strict=True,
    )
    return tuple(
        AdjustedObservation(
            place=place,
            kind=obs.kind,
            at=obs.at,
            back=obs.back,
            to=obs.to,
            observed=obs.value,
            adjusted=obs.value + v,
            residual=v,
            sigma=obs.sigma,
            sigma_adjusted=s,
            standardized=None if w != w else w,
            redundancy=r,
            mdb=None if mdb != mdb else mdb,
            mdb_effect_m=None if effect != effect else effect,
            group=obs.group,
            line=obs.line,
        )
        for obs, place, v, s, w, r, mdb, effect in columns
    )


def _shared(model: Model, state: Converged, scale: float) -> tuple[SharedValue, ...]:
    first = model.coordinate_slots
    names = [("gyro_constant", name) for name in model.constants]
    names += [("orientation", f"{at} {name}".strip()) for at, name in model.orientations]
    if not names:
        return ()
    unknowns = state.model.unknown_of[first : first + len(names)]
    sigma = np.sqrt(state.solved.cofactor.blocks(unknowns[:, None])[:, 0, 0]) * scale
    return tuple(
        SharedValue(kind, name, value, s)
        for (kind, name), value, s in zip(
            names, state.values[first : first + len(names)].tolist(), sigma.tolist(), strict=True
        )
    )


def _relative(
    network: Network, model: Model, state: Converged, scale: float
) -> tuple[RelativeEllipse, ...]:
    """Ellipses of neighbours, at least one of them unknown."""
    number = {point.name: i for i, point in enumerate(network.points)}
    ends = np.array(
        [(number[obs.at], number[obs.to]) for obs in model.observations if obs.to], dtype=np.int64
    ).reshape(-1, 2)
    keys = np.unique(ends.min(axis=1) * len(number) + ends.max(axis=1))
    pairs = np.stack(np.divmod(keys, len(number)), axis=1)
    slots = np.stack(
        (3 * pairs[:, 0], 3 * pairs[:, 0] + 1, 3 * pairs[:, 1], 3 * pairs[:, 1] + 1), axis=1
    )
    unknowns = state.model.unknown_of[slots]
    pairs, unknowns = pairs[(unknowns >= 0).any(axis=1)], unknowns[(unknowns >= 0).any(axis=1)]
    blocks = state.solved.cofactor.blocks(unknowns) * scale**2
    turn = np.array([[-1.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]])
    covariance = np.einsum("ip,npq,jq->nij", turn, blocks, turn)
    axes = q.ellipse_axes(covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1])
    names = [point.name for point in network.points]
    return tuple(
        RelativeEllipse(names[i], names[j], Ellipse(a, b, azimuth))
        for (i, j), a, b, azimuth in zip(
            pairs.tolist(), *(axis.tolist() for axis in axes), strict=True
        )
    )


def _snooping(
    model: Model, checked: q.Quality, scale: float, options: tuple[float, int | None, float | None]
) -> Snooping:
    level, dof, sigma_dof = options
    tests = q.distinct_tests(checked.standardized)
    critical = q.family_critical(tests, level, dof, sigma_dof=sigma_dof)
    statistic = "tau" if dof is not None else "normal" if sigma_dof is None else "student"
    if critical is None or scale <= 0.0:
        return Snooping(statistic, level, tests, None)
    size = np.nan_to_num(np.abs(checked.standardized) / scale)
    beyond = np.flatnonzero(size > critical)
    beyond = beyond[np.argsort(-size[beyond], kind="stable")]
    suspects = tuple(
        Suspect(
            int(model.used[row]),
            model.observations[row].where,
            float(checked.standardized[row] / scale),
            float(checked.error[row]),
            bool(model.angular[row]),
        )
        for row in beyond.tolist()
    )
    return Snooping(statistic, level, tests, critical, suspects)
