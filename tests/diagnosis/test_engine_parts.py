"""Parts of the engine against independent routes: scipy's optimizer, distributions, brute force."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy import optimize, stats

from surveyapp.diagnosis import CampaignDetermination, Case, TurningPoints
from surveyapp.diagnosis.candidates import Candidate, all_candidates
from surveyapp.diagnosis.compare import orthonormal_design, spans
from surveyapp.diagnosis.fits import Fit, Member, fit_members, with_noise
from surveyapp.diagnosis.held_out import leave_one_out
from surveyapp.diagnosis.nulls import Noise, null_of, reductions
from surveyapp.diagnosis.projection import project
from surveyapp.diagnosis.run_value import plain_value, value_of
from surveyapp.diagnosis.stochastic import noise_models
from surveyapp.diagnosis.subjects.campaign import campaign
from surveyapp.diagnosis.subjects.reversal_run import reversal_run
from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects import of_subject
from tests.diagnosis.measured_runs import johannesburg


def quiet_run(seed: int, n: int = 20) -> Case:
    g = np.random.default_rng(seed)
    k = np.arange(float(n))
    y = 1.0 + 0.017 * (-1.0) ** k * np.exp(-0.015 * k) + 4.0 * ARCSEC * g.standard_normal(n)
    return reversal_run(TurningPoints(list(y)))


def candidate_of(problem: Case, identity: str) -> Candidate:
    pool = all_candidates(problem, fit_members(problem, ()).theta)
    return next(c for c in pool if c.id == identity and c.count == 1)


@pytest.mark.parametrize("identity", ["quadratic_drag", "dry_friction", "damping_break"])
def test_amplitude_laws_are_fitted_as_scipy_fits_them(identity: str) -> None:
    problem = reversal_run(johannesburg())
    assert problem.side is not None
    assert problem.half_swing is not None
    candidate = candidate_of(problem, identity)
    effect = candidate.effect
    assert effect is not None
    assert effect.law is not None
    g = len(candidate.points) // 3
    fit = fit_members(problem, [Member(candidate, g)])
    side, t, y = problem.side, problem.half_swing, problem.observations
    law, point = effect.law, candidate.points[g]
    low = [-np.inf, -np.inf, 0.0, -np.inf if not effect.one_sided else 0.0]

    def residuals(x: np.ndarray[tuple[int], np.dtype[np.float64]]) -> object:
        assert law is not None
        return (x[0] + side * law(t, x[1:2], x[2:3], x[3:4], **point) - y) / ARCSEC

    start = [float(fit.linear[0]), 0.0187, 0.012, 0.0 if not effect.one_sided else 1e-6]
    free = optimize.least_squares(
        residuals, start, bounds=(low, np.inf), x_scale=[1e-3, 1e-2, 1e-2, 1e-2], xtol=1e-15
    )
    assert fit.sum_of_squares / ARCSEC**2 <= 2.0 * free.cost * (1.0 + 1e-6)
    assert fit.theta is not None
    assert fit.theta[1] >= 0.0


def test_the_null_of_one_fixed_column_is_the_f_distribution() -> None:
    problem = quiet_run(1)
    fit = fit_members(problem, ())
    q = orthonormal_design(fit)
    item = project(candidate_of(problem, "midpoint_drift"), q)
    null = null_of((item,), q, Noise(20_000, 0.0, problem.root_weights))
    dof = problem.size - q.shape[1] - 1
    for f in (0.5, 2.0, 4.0, 8.0):
        p = float(null.p_values(np.array([f / dof]))[0])
        exact = float(stats.f.sf(f, 1, dof))
        assert p == pytest.approx(exact, abs=4.0 * np.sqrt(exact / 20_000) + 1e-4)


@pytest.mark.statistical
def test_family_p_values_of_noise_are_uniform() -> None:
    values = []
    for seed in range(200):
        problem = quiet_run(seed, 12)
        fit = fit_members(problem, ())
        q = orthonormal_design(fit)
        pool = [c for c in all_candidates(problem, fit.theta) if not c.is_law and c.count == 1]
        items = tuple(i for i in (project(c, q) for c in pool) if i.index.size)
        null = null_of(items, q, Noise(400, 0.0, problem.root_weights))
        seen = [float(reductions(i, fit.residual).max()) for i in items]
        left = fit.sum_of_squares
        p = null.p_values(np.array([s / (left - s) for s in seen]))
        values.append(float(null.family(p).min()))
    assert stats.kstest(values, "uniform").pvalue > 1e-3


def test_an_effect_that_the_model_expresses_is_not_separable() -> None:
    problem = quiet_run(2)
    base = fit_members(problem, ())
    drift = candidate_of(problem, "midpoint_drift")
    fit = fit_members(problem, [Member(drift, 0)], base.theta)
    assert project(drift, orthonormal_design(fit)).index.size == 0


def test_noise_likelihoods_agree_with_the_integrated_multivariate_normal() -> None:
    # A flat prior of the parameters is a normal one that is very wide: y ~ N(0, C + w J J').
    problem = quiet_run(3)
    fit = fit_members(problem, ())
    basis = np.linalg.qr(fit.design / np.sqrt((fit.design**2).sum(axis=0)))[0]
    v, n, wide = fit.residual / ARCSEC, problem.size, 1e7

    def minus(white: float, process: np.ndarray) -> float:
        covariance = white * (np.eye(n) + process) + wide * basis @ basis.T
        return float(-2.0 * stats.multivariate_normal.logpdf(v, cov=covariance))

    dof = n - basis.shape[1]
    plain = minus(float(v @ v) / dof, np.zeros((n, n)))
    for found in with_noise(problem, fit):
        assert found.noise is not None
        gains = [
            plain - minus(point.white / ARCSEC**2, point.model.process)
            for point in found.noise.points
        ]
        shares = np.array([point.share for point in found.noise.points])
        relative = np.exp(0.5 * (np.array(gains) - gains[0]))
        np.testing.assert_allclose(relative, shares / shares[0], rtol=1e-3)
        grid = sum(m.kind == found.noise.kind for m in noise_models(problem))
        average = gains[0] + 2.0 * np.log(1.0 / shares[0] / grid)
        assert found.noise.gain == pytest.approx(average, abs=1e-3)


def test_every_noise_model_is_whitened() -> None:
    problem = quiet_run(4, 12)
    for model in noise_models(problem):
        covariance = np.eye(12) + model.process
        np.testing.assert_allclose(
            model.whitener @ covariance @ model.whitener.T, np.eye(12), atol=1e-9
        )


def test_leave_one_out_is_what_leaving_out_gives() -> None:
    g = np.random.default_rng(8)
    made = [
        CampaignDetermination.at(v * ARCSEC, elapsed_days=float(i), sigma=5.0 * ARCSEC)
        for i, v in enumerate(5.0 * g.standard_normal(12) + np.arange(12))
    ]
    problem = campaign(made)
    drift = candidate_of(problem, "time_drift")
    fit = fit_members(problem, [Member(drift, 0)])
    found = leave_one_out(problem, fit)
    X = np.column_stack([np.ones(12), drift.columns[0, :, 0]])
    errors = []
    for i in range(12):
        keep = np.arange(12) != i
        b, *_ = np.linalg.lstsq(X[keep], problem.observations[keep], rcond=None)
        errors.append(problem.observations[i] - X[i] @ b)
    assert found == pytest.approx(float(np.sqrt(np.mean(np.square(errors)))), rel=1e-9)


@pytest.mark.statistical
@pytest.mark.parametrize("n", [8, 20])
def test_the_sigma_of_a_run_is_the_scatter_of_its_norths(n: int) -> None:
    values = []
    for seed in range(300):
        problem = quiet_run(1000 + seed, n)
        value = plain_value(problem, fit_members(problem, ()))
        values.append(((problem.offset + value.value - 1.0) / value.sigma, value.dof))
    z = np.array([v for v, _ in values])
    assert stats.kstest(z, stats.t(df=values[0][1]).cdf).pvalue > 1e-3


def test_a_walk_of_north_is_predicted_along_the_run() -> None:
    # The mean over the record of a walk that was read almost without noise is known, not widened.
    g = np.random.default_rng(3)
    k = np.arange(20.0)
    walk = np.cumsum(g.normal(0.0, 9.0 * ARCSEC, 20))
    y = 1.0 + walk + 0.017 * (-1.0) ** k * np.exp(-0.015 * k)
    y = y + 0.3 * ARCSEC * g.standard_normal(20)
    problem = reversal_run(TurningPoints(list(y)))
    fits = with_noise(problem, fit_members(problem, ()))
    fit = next(f for f in fits if f.noise is not None and f.noise.kind == "random_walk")
    value = value_of(problem, fit)
    assert abs(problem.offset + value.value - 1.0 - walk.mean()) < 4.0 * value.sigma
    assert value.sigma < 4.0 * ARCSEC


def test_rounding_bounds_what_can_be_left() -> None:
    # Ten readings that lie on a straight decay to the last digit must not look like a discovery.
    run = johannesburg(12)
    fine = reversal_run(dataclasses.replace(run, resolution=0.0))
    coarse = reversal_run(dataclasses.replace(run, resolution=60.0 * ARCSEC))
    assert fit_members(coarse, ()).bic >= fit_members(fine, ()).bic


def test_a_generic_shape_that_contains_an_effect_is_no_rival() -> None:
    problem = quiet_run(6)
    base = fit_members(problem, ())

    def alone(identity: str) -> Fit:
        return fit_members(problem, [Member(candidate_of(problem, identity), 0)], base.theta)

    assert spans(alone("quadratic"), alone("midpoint_drift"))
    assert not spans(alone("midpoint_drift"), alone("quadratic"))
    assert not spans(alone("warm_up"), alone("midpoint_drift"))


def test_all_candidates_of_the_catalogue_are_tried() -> None:
    problem = quiet_run(7)
    ids = {c.id for c in all_candidates(problem, fit_members(problem, ()).theta)}
    assert {effect.id for effect in of_subject("reversal_run")} <= ids
