"""Logs of any length: mapped columns give the numbers of columns in memory, and take no memory."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.sensors.allan import allan_variances
from surveyapp.core.sensors.clipping import without_clipped
from surveyapp.core.sensors.noise_coefficients import coefficients_of
from surveyapp.domain.columns import PIECE, every_kth, let_go, pieces
from surveyapp.domain.sensor_log import SensorLog
from surveyapp.io.sensor_logs import blocks
from surveyapp.io.sensor_logs.checks import gaps_of
from surveyapp_models.arrays import Floats

LONG = 2 * PIECE + 12_345


def mapped(values: Floats) -> Floats:
    """The same numbers in a file without a name."""
    room = blocks.make_room(1, max(values.size, blocks.MAPPED_VALUES + 1))
    store: Floats = room[0, : values.size]
    store[:] = values
    let_go(store)
    return store


def resident_mb() -> float:
    return float(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6


def test_a_mapped_column_is_walked_through_whole_and_in_order() -> None:
    values = np.arange(10_001, dtype=np.float64)
    column = mapped(values)
    assert np.array_equal(np.concatenate(list(pieces(column, 1000))), values)
    steps = np.concatenate([np.diff(piece) for piece in pieces(column, 1000, overlap=1)])
    assert steps.size == 10_000
    assert bool(np.all(steps == 1.0))
    assert np.array_equal(every_kth(column, 7), values[::7])


@pytest.mark.skipif(sys.platform != "linux", reason="the memory is read from /proc")
def test_walking_through_a_mapped_column_holds_a_piece_of_it() -> None:
    store = blocks.make_room(1, 12 * PIECE)[0]  # 100 MB
    before = resident_mb()
    for number, piece in enumerate(pieces(store)):
        piece[:] = float(number)
    most = before
    for number, piece in enumerate(pieces(store)):
        assert piece[0] == float(number)
        assert piece[-1] == float(number)
        most = max(most, resident_mb())
    assert most < before + 20.0


def test_a_sample_of_a_mapped_column_is_a_copy_of_its_own() -> None:
    sample = every_kth(mapped(np.arange(3.0 * PIECE)), 4096)
    assert sample.base is None
    assert np.array_equal(sample, 4096.0 * np.arange(sample.size))


def test_a_long_log_is_thinned_among_the_rows_that_are_within_the_range() -> None:
    rng = np.random.default_rng(1)
    values = np.clip(rng.standard_normal(LONG), -9.0, 2.0)
    number = np.arange(LONG, dtype=np.float64)
    log = SensorLog(
        id="long",
        columns={"output": mapped(values), "time_s": mapped(number)},
        units={"output": "LSB", "time_s": "s"},
        size=LONG,
        rate_hz=1.0,
        clipped={"output": 1},
    )
    found = without_clipped(log, ("output",), most=1000)
    rows = np.flatnonzero(values < 2.0)
    every = -(-rows.size // 1000)
    assert np.array_equal(found.columns["time_s"], rows[::every].astype(np.float64))
    assert np.array_equal(found.columns["output"], values[rows[::every]])
    assert found.rate_hz == pytest.approx(1.0 / every)
    assert [w.code for w in found.warnings] == ["clipped_left_out", "thinned"]
    assert np.array_equal(log.thinned(1000).columns["time_s"], number[:: -(-LONG // 1000)])


def test_gaps_lie_where_they_are_also_between_pieces() -> None:
    time = np.arange(LONG) / 100.0
    for place in (10, PIECE, 2 * PIECE):
        time[place:] += 1.0
    interval, gaps = gaps_of(mapped(time))
    assert interval == pytest.approx(0.01, rel=1e-9)
    assert [round(gap.start_s, 2) for gap in gaps] == [
        0.09,
        round((PIECE - 1) / 100 + 1, 2),
        round((2 * PIECE - 1) / 100 + 2, 2),
    ]


def test_allan_of_a_mapped_series_is_that_of_one_in_memory() -> None:
    series = np.random.default_rng(2).standard_normal(LONG) + 1e-6 * np.arange(LONG)
    column = mapped(series)
    for estimator in ("oadev", "adev"):
        ours = allan_variances(column, (1, 8, 300_000), estimator=estimator, room=blocks.room_for)
        phase = np.concatenate([[0.0], np.cumsum(series - series.mean())])
        for m, variance in zip((1, 8, 300_000), ours, strict=True):
            thin, lag = (phase, m) if estimator == "oadev" else (phase[::m], 1)
            second = thin[2 * lag :] - 2.0 * thin[lag:-lag] + thin[: -2 * lag]
            assert variance == pytest.approx(np.mean(second**2) / (2.0 * m**2), rel=1e-9)
    found = {c.symbol: c for c in coefficients_of(column, interval=0.01)}
    assert found["N"].value == pytest.approx(0.1, rel=0.01)
    assert found["R"].value == pytest.approx(1e-4, rel=0.01)


def test_a_mapped_log_is_filtered_and_compensated_as_one_in_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(3)
    own, other = rng.uniform(-600.0, 600.0, (2, 900))
    noise = rng.standard_normal((2, 900))
    read = [2.0 + 1.01 * own + 0.02 * other + noise[0], 0.99 * other - 1.0 + noise[1]]
    log = tmp_path / "tilt.csv"
    names = ("tilt_along", "tilt_across", "ref_along", "ref_across")
    np.savetxt(
        log,
        np.column_stack([np.arange(900) / 10.0, *read, own, other]),
        delimiter=",",
        header=",".join(["time_s", *(f"{n}_arcsec" for n in names)]),
        comments="",
        fmt="%.6f",
    )

    shares: list[float] = []

    def everything(to: Path) -> tuple[str, str, object]:
        to.mkdir()
        api.calibrate("tilt", log, card=to / "card.toml")
        api.compensate(
            "tilt", log, card=to / "card.toml", out=to / "out.csv", progress=shares.append
        )
        column = "tilt_across_arcsec"
        made = [
            api.filter_log(log, name=name, column=column, out=to / f"{name}.csv").to_dict()
            for name in ("kalman", "sage-husa", "particle")
        ]
        texts = [(to / name).read_text() for name in ("out.csv", "kalman.csv", "particle.csv")]
        return texts[0], "".join(texts[1:]), made

    plain = everything(tmp_path / "memory")
    monkeypatch.setattr(blocks, "MAPPED_VALUES", 100)
    monkeypatch.setattr(blocks, "BLOCK_BYTES", 1000)
    assert everything(tmp_path / "mapped") == plain
    assert shares[-1] == 1.0


def test_a_card_of_a_thinned_log_holds_the_temperatures_of_the_whole() -> None:
    """Of 250,000 rows one in three is used; 35 C stands in one that is not, -5 C in another."""
    temperature = np.full(250_000, 20.0)
    temperature[[100_000, 200_002]] = 35.0, -5.0
    log = SensorLog("a", {"temperature_c": temperature}, {}, 250_000, rate_hz=90.0)
    thin = log.thinned(100_000)
    assert thin.size == 83_334
    assert thin.columns["temperature_c"].max() == 20.0 == thin.columns["temperature_c"].min()
    assert thin.temperature_span_c() == (-5.0, 35.0)
    assert log.chosen(temperature > 0.0, most=100_000).temperature_span_c() == (-5.0, 35.0)
    assert SensorLog("b", {}, {}, 0).temperature_span_c() is None
