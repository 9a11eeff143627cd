"""Networks adjusted again and again with fresh noise: promises of covariances and tests."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from surveyapp.core.network import adjust
from surveyapp.domain.traverse import Network, Status
from surveyapp_models.arrays import Floats
from tests.network.network_factory import ARC, make


def disturbed(network: Network, rng: np.random.Generator) -> Network:
    """Fresh noise on a noise-free network, correlated where the network says so."""
    noise = np.array([o.sigma for o in network.observations]) * rng.normal(
        size=len(network.observations)
    )
    for block in network.blocks:
        root = np.linalg.cholesky(np.array(block.covariance))
        noise[list(block.members)] = root @ rng.normal(size=len(block.members))
    constants = tuple(
        replace(c, value=25 * ARC + (c.sigma or 0.0) * float(rng.normal()))
        for c in network.constants
    )
    observations = tuple(
        replace(o, value=o.value + float(e))
        for o, e in zip(network.observations, noise, strict=True)
    )
    return replace(network, observations=observations, constants=constants)


@dataclass(frozen=True)
class Covariances:
    """Sums over all repetitions with their expectation and standard deviation.

    v'Pv summed is chi-square with runs * dof, here nearly normal. One point's e' Q^-1 e is
    chi-square with 2; the points of a run are correlated, so that the sum has at most their number
    times the variance of independent ones.
    """

    squares: float
    total: int
    distance: float
    mean: float
    distance_sigma: float
    eigenvalues: Floats

    @property
    def squares_sigma(self) -> float:
        return math.sqrt(2.0 * self.total)


def covariances(runs: int, seed: int) -> Covariances:
    """Errors of points against their covariances, by so many repetitions."""
    base, truth = make(9, ("direction", "distance", "gyro"), points=5, correlated=True, noise=False)
    rng = np.random.default_rng(seed)
    free = [p.name for p in base.points if p.status_e is Status.FREE]
    distance, squares, dof = 0.0, 0.0, 0
    last, weight = np.zeros((2, 2)), np.eye(2)
    for _ in range(runs):
        result = adjust(disturbed(base, rng), relative=False)
        dof = result.dof
        squares += result.global_test.sum_of_squares
        for name in free:
            point = result.point(name)
            error = np.array([(point.e or 0) - truth[name][0], (point.n or 0) - truth[name][1]])
            weight = np.array(point.covariance)[:2, :2]
            distance += float(error @ np.linalg.solve(weight, error))
        last += np.outer(error, error)
    root = np.linalg.cholesky(weight)
    whitened = np.linalg.solve(root, np.linalg.solve(root, last / runs).T)
    return Covariances(
        squares,
        runs * dof,
        distance,
        2.0 * len(free) * runs,
        math.sqrt(4.0 * len(free) ** 2 * runs),
        np.linalg.eigvals(whitened).real,
    )


def global_tests_failed(runs: int, seed: int) -> int:
    """How often the test at 95 % of a sound network is not met."""
    base, _ = make(14, ("angle", "distance"), points=5, noise=False)
    rng = np.random.default_rng(seed)
    results = (adjust(disturbed(base, rng), relative=False) for _ in range(runs))
    return sum(result.global_test.passed is False for result in results)
