"""Three filters on one description: textbook steady state, filterpy, the exact solution."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp.cli.main import main
from surveyapp.core.sensors.filters import (
    LocalLevel,
    kalman,
    particles,
    run_filter,
    sage_husa,
    step_lag,
)
from surveyapp_models.arrays import Floats

filterpy = pytest.importorskip("filterpy.kalman")


def series_of(n: int = 400, q: float = 0.04, r: float = 1.0, seed: int = 1) -> Floats:
    rng = np.random.default_rng(seed)
    return np.asarray(np.cumsum(math.sqrt(q) * rng.normal(size=n)) + rng.normal(size=n) * r**0.5)


def test_kalman_against_the_textbook_steady_state_and_filterpy() -> None:
    model, series = LocalLevel(0.04, 1.0), series_of()
    ours = kalman(series, model)
    p = ours.variance[-1]
    assert p == pytest.approx(model.steady_variance, rel=1e-12)
    assert p**2 + model.q * p - model.q * model.r == pytest.approx(0.0, abs=1e-12)
    theirs = filterpy.KalmanFilter(dim_x=1, dim_z=1)
    theirs.x, theirs.P = np.array([[series[0]]]), np.array([[model.r]])
    theirs.F = theirs.H = np.eye(1)
    theirs.Q, theirs.R = np.array([[model.q]]), np.array([[model.r]])
    for k in range(1, series.size):
        theirs.predict()
        theirs.update(series[k])
        assert ours.estimate[k] == pytest.approx(float(theirs.x[0, 0]), rel=1e-9, abs=1e-12)
        assert ours.variance[k] == pytest.approx(float(theirs.P[0, 0]), rel=1e-9)


def test_particles_agree_with_the_exact_solution_within_their_monte_carlo_error() -> None:
    model, series = LocalLevel(0.04, 1.0), series_of(300)
    exact = kalman(series, model)
    found = particles(series, model, np.random.default_rng(2), count=4000)
    error = (found.estimate - exact.estimate)[20:] / np.sqrt(exact.variance[20:])
    # about sqrt(1/4000) = .016 for independent draws; resampling widens it a few times
    assert float(np.sqrt(np.mean(error**2))) < 0.06
    assert found.variance[50:].mean() == pytest.approx(exact.variance[50:].mean(), rel=0.05)
    assert found.resamplings is not None
    assert 10 < found.resamplings < 300


def test_the_guard_keeps_the_adaptive_variance_positive() -> None:
    series = np.concatenate([np.zeros(500), series_of(500)])
    found = sage_husa(series, LocalLevel(0.04, 1.0))
    assert np.all(found.variance > 0.0)
    assert np.all(np.isfinite(found.estimate))


def test_divergence_and_degeneracy_are_told() -> None:
    series = series_of(600)
    series[300:] += 50.0 * np.arange(300)
    lost = kalman(series, LocalLevel(1e-4, 1.0))
    assert lost.lost_at is not None
    assert 295 < lost.lost_at < 330
    assert kalman(series[:300], LocalLevel(0.04, 1.0)).lost_at is None
    far = np.concatenate([np.zeros(50), np.full(50, 1e3)])
    gone = particles(far, LocalLevel(1e-4, 1.0), np.random.default_rng(1))
    assert gone.degenerate is not None
    assert gone.degenerate > 0
    assert np.all(np.isfinite(gone.estimate))


@pytest.mark.parametrize(("ratio", "lag"), [(0.1, 8), (0.01, 24), (0.001, 73), (1e-4, 231)])
def test_the_lag_of_a_step_is_that_of_the_steady_gain(ratio: float, lag: int) -> None:
    model = LocalLevel(ratio, 1.0)
    found = step_lag("kalman", model, sigmas=2.0, rng=np.random.default_rng(1))
    gain = (model.steady_variance + model.q) / (model.steady_variance + model.q + model.r)
    assert found == math.ceil(math.log(0.1) / math.log(1.0 - gain)) == lag


def test_an_adaptive_filter_takes_a_large_step_for_noise() -> None:
    rng = np.random.default_rng(1)
    small = step_lag("sage-husa", LocalLevel(0.01, 1.0), sigmas=2.0, rng=rng)
    large = step_lag("sage-husa", LocalLevel(0.01, 1.0), sigmas=20.0, rng=rng)
    assert small is not None
    assert large is not None
    assert large > 4.0 * small


def test_the_same_seed_gives_the_same_particles() -> None:
    series, model = series_of(100), LocalLevel(0.04, 1.0)
    first = run_filter("particle", series, model, np.random.default_rng(5)).estimate
    assert np.array_equal(
        first, run_filter("particle", series, model, np.random.default_rng(5)).estimate
    )


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = tmp_path / "log.csv", tmp_path / "out.csv"
    series = 1e-3 * series_of(3000, q=1e-6)
    np.savetxt(
        path, np.column_stack([100.0 + np.arange(3000) * 0.01, series]), delimiter=",",
        header="time_s,gyr_x_rad_s", comments="",
    )  # fmt: skip
    command = ["filter", str(path), "--filter", "kalman", "--q", "1e-9", "--r", "1e-6"]
    assert main([*command, "--seed", "3", "--json", "-o", str(out)]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["schema"] == "surveyapp.filter/1"
    assert result["step_lag_90_samples"] == {"2_sigma": 73.0, "20_sigma": 73.0}
    assert len(result["deviation_ratio"]) == len(result["taus_s"])
    assert result["deviation_ratio"][0] < 0.05
    assert result["deviation_ratio"][-1] > 0.5
    after = {c["symbol"]: c for c in result["after"]["coefficients"]}
    assert after["N"]["value"] is None
    assert after["N"]["reason"] in ("filtered", "no_power_law")
    assert result["divergence"]["diverged"] is False
    lines = out.read_text().splitlines()
    assert lines[0] == "time_s,gyr_x_rad_s,filtered_gyr_x_rad_s"
    assert lines[1].startswith("100,")
    assert main(["filter", str(path), "--filter", "all"]) == 0
    assert "p particle" in capsys.readouterr().out
    assert main(["filter", str(path), "--q", "0", "--r", "-1", "--seed", "-1"]) == 2
    told = capsys.readouterr().err
    assert told.count("no variance") == 2
    assert "--seed: the seed is negative" in told


@pytest.mark.parametrize("count", [0, 1, 12, 19, 20, 25])
def test_innovations_beyond_are_sustained_from_twenty_in_a_row_on(count: int) -> None:
    """Readings that jump to and fro by 100 sigma are beyond, each of them."""
    series = np.zeros(200)
    series[100 : 100 + count] = 100.0 * (-1.0) ** np.arange(count)
    found = kalman(series, LocalLevel(1e-6, 1.0))
    assert found.lost == count
    assert found.lost_at == (100 if count >= 20 else None)
