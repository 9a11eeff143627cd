"""Allan deviation against allantools and NBS14; coefficients against simulated truth."""

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.api.sensors import LogOptions
from surveyapp.cli.main import main
from surveyapp.core.sensors.allan import allan_curve, allan_variances, octaves
from surveyapp.core.sensors.noise_coefficients import coefficients_of
from surveyapp_models.arrays import Floats

allantools = pytest.importorskip("allantools")
SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[2] / "../shared/data"))
STATIC = SHARED / "mpu6050_static/example_data_static_449s.csv"


def flicker(n: int, rng: np.random.Generator) -> Floats:
    """Flicker noise of B = 1 by fractional differencing (Kasdin 1995)."""
    k = np.arange(1, n)
    response = np.concatenate([[1.0], np.cumprod((k - 0.5) / k)])
    white = rng.normal(size=n)
    return np.fft.irfft(np.fft.rfft(response, 2 * n) * np.fft.rfft(white, 2 * n))[:n]


def nbs14() -> Floats:
    """The 1000-point set of NBS Monograph 140 annex 8.E (NIST SP 1065 section 12.4)."""
    n = 1234567890
    values = []
    for _ in range(1000):
        values.append(n / 2147483647.0)
        n = 16807 * n % 2147483647
    return np.array(values)


def test_nbs14_agrees_with_the_printed_values() -> None:
    series = nbs14()
    adev = np.sqrt(allan_variances(series, (1, 10, 100), estimator="adev"))
    oadev = np.sqrt(allan_variances(series, (1, 10, 100)))
    assert adev == pytest.approx([0.2922319, 0.0996574, 0.0389780], abs=5e-8)
    assert oadev == pytest.approx([0.2922319, 0.0915995, 0.0324134], abs=5e-8)


@pytest.mark.parametrize("kind", ["white", "flicker", "walk", "nbs14"])
def test_agreement_with_allantools(kind: str) -> None:
    rng = np.random.default_rng(3)
    series = {
        "white": rng.normal(size=20_000) + 5.0,
        "flicker": flicker(20_000, rng),
        "walk": np.cumsum(rng.normal(size=20_000)),
        "nbs14": nbs14(),
    }[kind]
    factors = octaves(series.size)
    for name, function in (("oadev", allantools.oadev), ("adev", allantools.adev)):
        taus = np.array(factors, dtype=float)
        _, theirs, _, _ = function(series, rate=1.0, data_type="freq", taus=taus)
        ours = np.sqrt(allan_variances(series, factors, estimator=name))  # type: ignore[arg-type]
        assert ours == pytest.approx(theirs, rel=1e-9)


def test_intervals_hold_at_their_rate() -> None:
    held = []
    for seed in range(60):
        series = np.random.default_rng(seed).normal(size=2000)
        curve = allan_curve(series, rate_hz=1.0)
        truth = 1.0 / np.sqrt(curve.taus)
        held.append((curve.low <= truth) & (truth <= curve.high))
    # 600 intervals at nine times, neighbours correlated: .95 within .03
    assert 0.91 < np.mean(held) < 0.985


def simulated(seed: int, size: dict[str, float], n: int = 50_000) -> Floats:
    dt = 0.01
    rng = np.random.default_rng([seed, 99])
    series = np.zeros(n)
    series += size.get("Q", 0.0) * np.diff(rng.normal(size=n + 1)) / dt
    series += size.get("N", 0.0) / math.sqrt(dt) * rng.normal(size=n)
    if "B" in size:
        series += size["B"] * flicker(n, rng)
    series += size.get("K", 0.0) * math.sqrt(dt) * np.cumsum(rng.normal(size=n))
    return np.asarray(series + size.get("R", 0.0) * dt * np.arange(n))


@pytest.mark.statistical
@pytest.mark.parametrize(
    "truth",
    [{"Q": 0.02, "N": 0.5, "B": 0.3}, {"N": 1.0, "K": 0.3}, {"N": 1.0, "R": 0.01}],
    ids=lambda t: "".join(t),
)
def test_coefficients_hold_and_absent_ones_are_null(truth: dict[str, float]) -> None:
    held, wrong = [], 0
    for seed in range(16):
        for item in coefficients_of(simulated(seed, truth), interval=0.01):
            if item.value is None or item.sigma is None:
                assert item.reason in ("not_significant", "not_separable")
            elif item.symbol in truth:
                held.append(abs(item.value - truth[item.symbol]) < 1.96 * item.sigma)
            else:
                wrong += 1
    # at least .95 - 3 sqrt(.95 x .05 / 32); absent terms in .01 of 32 to 48: at most 3 with
    # p = .998; 200 records a line in ``python -m bench sensors``
    assert len(held) >= 26
    assert np.mean(held) > 0.83
    assert wrong <= 3


def test_a_ramp_and_a_random_walk_are_not_told_apart_where_they_look_alike() -> None:
    found = {
        c.symbol: c for c in coefficients_of(simulated(4, {"N": 1.0, "R": 0.002}), interval=0.01)
    }
    assert found["R"].value is None
    assert found["K"].value is None
    assert {found["R"].reason, found["K"].reason} <= {"not_separable", "not_significant"}


def test_a_series_that_is_no_sum_of_power_laws_has_no_coefficient() -> None:
    t = np.arange(20_000)
    series = np.sin(2.0 * np.pi * 0.05 * t) + 0.01 * np.random.default_rng(1).normal(size=t.size)
    assert {c.reason for c in coefficients_of(series, interval=0.01)} == {"no_power_law"}
    assert {c.reason for c in coefficients_of(series[:50], interval=0.01)} == {"record_too_short"}


def test_the_command_and_its_units(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    series = simulated(1, {"N": math.radians(0.3) / 60.0}, n=20_000)
    path = tmp_path / "log.csv"
    np.savetxt(
        path, np.column_stack([series, series]), delimiter=",", header="gx,counts", comments=""
    )
    command = ["allan", str(path), "--rate-hz", "100", "--map", "gyr_x_rad_s=gx", "--json"]
    assert main(command) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["schema"] == "surveyapp.allan/1"
    assert [c["name"] for c in result["channels"]] == ["gyr_x_rad_s"]
    channel = result["channels"][0]
    assert channel["taus_s"][:3] == [0.01, 0.02, 0.04]
    assert len(channel["taus_s"]) == 13
    walk = next(c for c in channel["coefficients"] if c["symbol"] == "N")
    assert walk["name"] == "angle_random_walk"
    assert walk["unit"] == "deg/sqrt(h)"
    assert abs(walk["value"] - 0.3) < 4.0 * walk["sigma"]
    ramp = next(c for c in channel["coefficients"] if c["symbol"] == "R")
    assert (ramp["value"], ramp["sigma"]) == (None, None)
    assert ramp["reason"]
    assert main([*command[:4], "--column", "counts", "--taus", "0.1,1", "--json"]) == 0
    channel = json.loads(capsys.readouterr().out)["channels"][0]
    assert channel["taus_s"] == [0.1, 1.0]
    assert {c["reason"] for c in channel["coefficients"]} == {"unit"}
    assert main([*command, "--taus", "0.001,1e9"]) == 2
    assert main(["allan", str(path), "--rate-hz", "100", "--column", "gxx"]) == 2
    assert main(["allan", str(path)]) == 2


@pytest.mark.shared_data
@pytest.mark.skipif(not STATIC.exists(), reason="measured records are not there")
def test_six_measured_channels_have_white_noise_and_what_else_can_be_told() -> None:
    """MPU-6050 at rest, 449 s: gy rises after 30 s; whether it wanders or flickers is not told."""
    counts = {f"g{a}": 1.0 / 131.0 for a in "xyz"} | {f"a{a}": 1.0 / 16384.0 for a in "xyz"}
    columns = {f"gyr_{a}_rad_s": f"g{a}" for a in "xyz"} | {f"acc_{a}_m_s2": f"a{a}" for a in "xyz"}
    units = {f"g{a}": "deg/s" for a in "xyz"} | {f"a{a}": "g" for a in "xyz"}
    options = LogOptions(columns, units, counts, 100.0, 4)
    channels = api.allan(STATIC, log=options).to_dict()["channels"]
    assert len(channels) == 6
    for channel in channels:
        found = {c["symbol"]: c for c in channel["coefficients"]}
        assert found["N"]["value"] > 50.0 * found["N"]["sigma"]
        assert all(c["value"] is not None or c["reason"] for c in channel["coefficients"])
        if channel["name"] == "gyr_y_rad_s":
            assert {found["B"]["reason"], found["K"]["reason"]} == {"not_separable"}


def test_flicker_made_of_a_spectrum_has_the_coefficient_of_one_made_of_a_filter() -> None:
    """Both are flicker; towards half the rate the first falls off as 1/f, the second less.

    Fitted up to half the rate the first gave a coefficient 6.6 % too small at a sigma of 1 %.
    """
    n, b, found = 20_000, 3.0, []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        frequency = np.fft.rfftfreq(4 * n, 0.1)
        power = np.zeros(frequency.size)
        power[1:] = b**2 / (2.0 * np.pi * frequency[1:])
        shape = rng.normal(size=(2, frequency.size)) * np.sqrt(power * 2.0 * n / 0.1)
        series = np.fft.irfft(shape[0] + 1j * shape[1], 4 * n)[:n]
        coefficient = coefficients_of(series, interval=0.1)[2]
        assert coefficient.value is not None
        assert coefficient.sigma is not None
        assert abs(coefficient.value - b) < 4.0 * coefficient.sigma
        found.append(coefficient.value)
    assert np.mean(found) == pytest.approx(b, rel=0.03)
