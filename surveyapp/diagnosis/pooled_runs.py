"""What one run says of a coefficient, and how likely events in all runs are: parts of the pooling.

An event has its own place in each run: the likelihood of a run is the mean over its places, and
the size is common to the runs or their own, as that of an effect of the instrument. Events are
rivals of these and are never named by pooling.

Source: prediction.md C ("places belong to the session").
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from surveyapp.diagnosis.candidates import Candidate, single_effects
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.compare import orthonormal_design
from surveyapp.diagnosis.fits import fit_members
from surveyapp.domain.priors import NU0
from surveyapp_models.arrays import Floats

SPREADS = (0.05, 0.3, 1.0)
"""How much sessions differ in a coefficient, in its own prior standard deviation."""
SIZES = (0.7, 1.5, 4.0)
"""Prior standard deviation of a common coefficient: what it does to one reading, in sigmas."""
LEAST_LEFT = 0.004
NODES = np.linspace(-3.5, 3.5, 141)
"""Of a common coefficient, in its prior standard deviation."""


@dataclass(frozen=True, slots=True)
class Run:
    """A run under its base model.

    Parameters
    ----------
    case : Case
    residual : ndarray, shape (n,)
        In the case's unit.
    q : ndarray, shape (n, k)
        Orthonormal columns of the base.
    sigma, nu0 : float
        Prior standard deviation of a reading, in the case's unit, and its degrees of freedom.
    candidates : tuple of Candidate
        Single effects at their places, about the base.
    """

    case: Case
    residual: Floats
    q: Floats
    sigma: float
    nu0: float
    candidates: tuple[Candidate, ...]

    def likelihood(
        self, column: Floats, readings: Floats, total: Floats
    ) -> tuple[Floats, Floats, Floats, float] | None:
        """Estimate, variance, height and sensitivity of a coefficient, None where it is base.

        Parameters
        ----------
        column : ndarray, shape (n,)
        readings : ndarray, shape (m, n)
            Without the base; in the case's unit.
        total : ndarray, shape (m,)
            Their sums of squares with the prior's.
        """
        left = column - self.q @ (self.q.T @ column)
        square = float(left @ left)
        if square <= LEAST_LEFT**2 * float(column @ column):
            return None
        nu = self.nu0 + self.case.size - self.q.shape[1]
        b = readings @ left / square
        rest = np.maximum(total - b * b * square, 1e-300)
        height = -0.5 * nu * np.log(rest / total)
        sensitivity = float(np.sqrt(square / self.case.size)) / self.sigma
        return b, rest / nu / square, height, sensitivity


def run_of(case: Case) -> Run:
    """A run with the noise that is stated for it, or its own scatter where none is."""
    base = fit_members(case, ())
    q = orthonormal_design(base)
    scatter = float(np.sqrt(base.sum_of_squares / max(case.size - q.shape[1], 1)))
    sigma, nu0 = max(scatter, case.noise_floor, 1e-12), 0.0
    if case.sigma is not None:
        sigma, nu0 = float(np.median(case.sigma)), NU0
    candidates = tuple(single_effects(case, base.theta))
    return Run(case, base.residual, q, sigma=sigma, nu0=nu0, candidates=candidates)


def event_evidence(runs: Sequence[Run]) -> list[tuple[str, str, float]]:
    """Id, title and log evidence of every event of one size, against nothing at work.

    Parameters
    ----------
    runs : sequence of Run
    """
    told: dict[str, list[Floats]] = {}
    titles: dict[str, str] = {}
    for run in runs:
        for candidate in run.candidates:
            effect = candidate.effect
            if effect is None or not effect.event or candidate.count != 1:
                continue
            places = np.array(list(_places(run, candidate)))
            if len(effect.coefficients) == 1 and places.size:
                told.setdefault(effect.id, []).append(places)
                titles[effect.id] = effect.title
    return [(name, titles[name], _event(places)) for name, places in told.items()]


def _places(run: Run, candidate: Candidate) -> Iterator[tuple[float, float, float, float]]:
    """Estimate, variance, height and sensitivity at each place of one run."""
    readings = (run.residual - run.q @ (run.q.T @ run.residual))[None, :]
    total = run.nu0 * run.sigma**2 + np.sum(readings**2, axis=1)
    for column in candidate.columns[:, :, 0]:
        found = run.likelihood(column, readings, total)
        if found is not None:
            b, variance, height, sensitivity = found
            yield float(b[0]), float(variance[0]), float(height[0]), sensitivity


def _event(runs: Sequence[Floats]) -> float:
    """Log evidence of one event over all runs: sizes common or their own, places integrated."""
    typical = float(np.median(np.concatenate([places[:, 3] for places in runs])))
    found = []
    for size in SIZES:
        a = size / typical
        mu = a * NODES
        prior = np.exp(-0.5 * NODES**2)
        for spread in SPREADS:
            along = np.zeros(mu.size)
            for b, v, h, _ in (places.T for places in runs):
                wide = (v + (spread * a) ** 2)[:, None]
                off = 0.5 * (b[:, None] - mu) ** 2 / wide
                along += log_mean(h[:, None] + 0.5 * np.log(v[:, None] / wide) - off)
            found.append(float(log_mean(along + np.log(prior / prior.mean()))))
    return float(log_mean(np.array(found)))


def log_mean(values: Floats) -> Floats:
    """Logarithm of the mean of exponentials along the first axis."""
    top = values.max(axis=0)
    return np.asarray(top + np.log(np.mean(np.exp(values - top), axis=0)))
