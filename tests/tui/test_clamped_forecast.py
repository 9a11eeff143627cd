"""Clamped swings from the integrated equation of motion: forecasts hold, alarms ring rarely."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom

from surveyapp.core.observing.by_method import progress_of
from surveyapp.core.observing.clamped_progress import standing_of, time_differences
from surveyapp.core.observing.passage_forecast import fit_passages, forecast_passage
from surveyapp.core.observing.progress import Progress
from surveyapp.core.observing.run_alert import Trouble
from surveyapp.core.simulate.session import SimulatedSession, book_text, simulate_sessions
from surveyapp.core.simulate.specification import Effect, SessionSpec, SwingMethod
from surveyapp.core.swing.swingfit import ClampedSwing
from surveyapp.domain.instrument import InstrumentCard
from surveyapp.domain.project import Method, OrientationSession
from surveyapp.io.cards import read_card
from surveyapp.io.fieldbook.reading import interpret
from surveyapp_models.angles import ARCSEC, RHO_ARCSEC, AngleUnit

LATITUDE = math.radians(60.0)
RUNS = 60
KINDS = ("clamp", "scale_reversal", "transit", "missed")
Row = dict[str, str]


def least(draws: int, probability: float) -> int:
    """Fewer hits than this come once in a thousand times from binomial draws."""
    return int(binom.ppf(1e-3, draws, probability))


def most(draws: int, probability: float) -> int:
    """More hits than this come once in a thousand times from binomial draws."""
    return int(binom.ppf(1.0 - 1e-3, draws, probability))


@cache
def card() -> InstrumentCard:
    """The simulator's instrument as its card would state it, at 47 degrees."""
    override = {
        "scale_value_arcsec": 600.0,
        "period": {
            "latitude_deg": 47.0,
            "tracking_s": 425.4,
            "clamped_s": 388.3,
            "unspun_s": 146.0,
        },
        "sigma": {"scale_div": 0.02, "time_s": 0.1},
    }
    return read_card("wild-gak1", base=Path(), override=override)


@cache
def runs(
    method: SwingMethod, offset_arcmin: float, points: int = 8
) -> tuple[SimulatedSession, ...]:
    """Sessions 13 degrees north of where the periods of the card were measured."""
    spec = SessionSpec(
        method=method,
        latitude=LATITUDE,
        points=points,
        clamp_offset=60.0 * offset_arcmin * ARCSEC,
        tape_zero_points=0,
    )
    return simulate_sessions(spec, RUNS, np.random.default_rng(int(7 + offset_arcmin)))


def swing_rows(run: SimulatedSession) -> list[Row]:
    return [dict(row) for row in run.rows if row["kind"] in KINDS]


def session(rows: Sequence[Row], method: Method) -> OrientationSession:
    book, _ = interpret(book_text(tuple(rows)), angle_unit=AngleUnit.DMS, where="book")
    return OrientationSession(
        id="r", station="A", instrument="G1", method=method, purpose="survey", book=book
    )


def judged(
    rows: Sequence[Row], method: Method, *, latitude: float | None = LATITUDE, seed: int = 1
) -> Progress:
    rng = np.random.default_rng(seed)
    return progress_of(session(rows, method), card(), rng, latitude=latitude)


def beginnings(method: SwingMethod, kind: str, count: int, offset: float) -> Iterator[list[Row]]:
    """Rows up to and with the one after ``count`` rows of a kind: what is to be forecast."""
    for run in runs(method, offset):
        rows = swing_rows(run)
        places = [i for i, row in enumerate(rows) if row["kind"] == kind]
        yield rows[: places[count] + 1]


@pytest.mark.statistical
@pytest.mark.parametrize("offset", [0.0, 20.0])
@pytest.mark.parametrize("passages", [1, 2, 3, 5, 7])
def test_the_next_passage_lies_in_its_interval_in_95_percent(passages: int, offset: float) -> None:
    inside, widths = 0, []
    for rows in beginnings("transit", "transit", passages, offset):
        standing = standing_of(session(rows[:-1], "transit"), card(), LATITUDE)
        fit = fit_passages(standing.swing, standing.known)
        assert fit is not None
        found = forecast_passage(fit, standing.next_after, 0.0)
        inside += abs(float(rows[-1]["elapsed_s"]) - found.moment_s) <= found.half_width_s
        widths.append(found.half_width_s)
    # after one passage the interval leans on the card's period, which is exact here: it may only
    # be too wide
    assert inside >= least(RUNS, 0.95)
    if passages > 2:
        assert float(np.median(widths)) < 1.0


@pytest.mark.statistical
@pytest.mark.parametrize("method", ["amplitude", "transit"])
@pytest.mark.parametrize("points", [3, 5, 7])
def test_the_next_scale_reading_lies_in_its_interval_in_99_percent(
    method: SwingMethod, points: int
) -> None:
    inside, moments = 0, 0
    for rows in beginnings(method, "scale_reversal", points, 8.0):
        found = judged(rows[:-1], method, latitude=LATITUDE)  # type: ignore[arg-type]
        assert found.next is not None
        assert found.next.reading is not None
        assert found.next.half_width is not None
        assert found.next.moment_s is not None
        assert found.next.moment_half_width_s is not None
        assert found.next.side == rows[-1]["side"]
        inside += abs(float(rows[-1]["value"]) - found.next.reading) <= found.next.half_width
        late = float(rows[-1]["elapsed_s"]) - found.next.moment_s
        moments += abs(late) <= found.next.moment_half_width_s
    assert inside >= least(RUNS, 0.99)
    assert moments >= least(RUNS, 0.95)


@pytest.mark.statistical
@pytest.mark.parametrize("method", ["amplitude", "transit"])
def test_clean_observations_alarm_as_rarely_as_they_should(method: SwingMethod) -> None:
    alarms = sum(
        judged(swing_rows(run), method, seed=i).alert is not None  # type: ignore[arg-type]
        for i, run in enumerate(runs(method, 8.0))
    )
    # at 1 %, and 0.2 % for the passage
    assert alarms <= most(RUNS, 0.012)


@pytest.mark.statistical
def test_no_passage_of_a_clean_observation_is_called_mistimed() -> None:
    alarms = 0
    for passages in range(1, 8):
        for rows in beginnings("transit", "transit", passages, 8.0):
            standing = standing_of(session(rows, "transit"), card(), LATITUDE)
            last = standing.swing.passages_s.size - 1
            before = standing_of(session(rows[:-1], "transit"), card(), LATITUDE)
            fit = fit_passages(before.swing, before.known)
            assert fit is not None
            moment, sigma = fit.passage(int(standing.swing.after[last]), 0.0)
            alarms += abs(float(standing.swing.passages_s[last]) - moment) > 3.09 * sigma * (
                1.0 if math.isinf(fit.dof) else 3.0
            )
    assert alarms <= most(7 * RUNS, 0.002)


def test_a_passage_pressed_late_is_told_by_its_number() -> None:
    rows = next(beginnings("transit", "transit", 4, 8.0))
    rows[-1] |= {"elapsed_s": f"{float(rows[-1]['elapsed_s']) + 6.0:.2f}"}
    alert = judged(rows, "transit").alert
    assert alert is not None
    assert (alert.trouble, alert.index) == (Trouble.MISTIMED, 4)
    assert str(alert.seq) == rows[-1]["seq"]


def test_a_passage_pressed_twice_is_mistimed_and_needs_no_more_than_a_strike() -> None:
    rows = next(beginnings("transit", "transit", 4, 8.0))
    again = dict(rows[-1], seq="900", elapsed_s=f"{float(rows[-1]['elapsed_s']) + 0.8:.2f}")
    alert = judged([*rows, again], "transit").alert
    assert alert is not None
    assert (alert.trouble, alert.index, alert.seq) == (Trouble.MISTIMED, 5, 900)
    strike = dict.fromkeys(rows[0], "") | {"kind": "strike", "value": "900", "seq": "901"}
    clean, found = judged(rows, "transit"), judged([*rows, again, strike], "transit")
    assert found.alert is None
    assert found.passage == clean.passage


@pytest.mark.statistical
def test_passages_alone_are_forecast_once_both_sides_were_read() -> None:
    """Two scale readings at the beginning, then nothing but Space."""
    inside = 0
    for run in runs("transit", 8.0):
        rows = swing_rows(run)
        scale = [i for i, row in enumerate(rows) if row["kind"] == "scale_reversal"]
        rows = [row for i, row in enumerate(rows) if i not in scale[2:]]
        places = [i for i, row in enumerate(rows) if row["kind"] == "transit"]
        found = judged(rows[: places[5]], "transit").passage
        assert found is not None
        inside += abs(float(rows[places[5]]["elapsed_s"]) - found.moment_s) <= found.half_width_s
    assert inside >= least(RUNS, 0.95)


def test_a_passage_and_its_points_left_out_are_told_as_a_gap_in_the_count() -> None:
    rows = next(beginnings("transit", "transit", 4, 8.0))
    places = [i for i, row in enumerate(rows) if row["kind"] == "transit"]
    rows = rows[: places[2] + 1] + rows[places[4] :]
    alert = judged(rows, "transit").alert
    assert alert is not None
    assert alert.trouble is Trouble.MISSED
    # with the turning points noted as missed the count is right again
    noted = dict.fromkeys(rows[0], "") | {"kind": "missed"}
    rows = [*rows[:-1], noted, dict(noted), rows[-1]]
    for number, row in enumerate(rows, start=1):
        row["seq"] = str(number)
    found = judged(rows, "transit")
    assert found.alert is None
    assert len(found.time_differences) == 1


@pytest.mark.parametrize(
    ("trouble", "effect"),
    [
        (Trouble.STEP, Effect("midpoint_step", 240.0 * ARCSEC, (("at", 0.5),))),
        (Trouble.DAMPING, Effect("damping_break", 0.04, (("at", 0.5),))),
    ],
)
@pytest.mark.parametrize("method", ["amplitude", "transit"])
def test_a_disturbed_swing_is_told_by_its_cause(
    method: SwingMethod, trouble: Trouble, effect: Effect
) -> None:
    spec = SessionSpec(method=method, points=14, effects=(effect,), tape_zero_points=0)
    called = []
    for run in simulate_sessions(spec, 8, np.random.default_rng(3)):
        alert = judged(swing_rows(run), method, latitude=math.radians(47.0)).alert  # type: ignore[arg-type]
        assert alert is not None
        called.append(alert.trouble)
    assert called.count(trouble) >= 7


@pytest.mark.parametrize("method", ["amplitude", "transit"])
def test_a_misread_point_on_the_scale_is_told_by_its_row(method: SwingMethod) -> None:
    rows = swing_rows(runs(method, 8.0)[3])
    places = [i for i, row in enumerate(rows) if row["kind"] == "scale_reversal"]
    wrong = rows[places[3]]
    wrong["value"] = f"{float(wrong['value']) + 0.5:.3f}"
    alert = judged(rows, method).alert  # type: ignore[arg-type]
    assert alert is not None
    assert alert.trouble is Trouble.GROSS_ERROR
    assert str(alert.seq) == wrong["seq"]


def test_time_differences_by_hand() -> None:
    # right turning point 0, passages at 100, 290, 500, 690: west half 190 s, east half 210 s
    swing = ClampedSwing(
        readings=np.array([8.0, -7.0]),
        index=np.array([0.0, 1.0]),
        sides=np.array([1.0, -1.0]),
        passages_s=np.array([100.0, 290.0, 500.0, 690.0]),
        divisions=np.zeros(4),
        after=np.arange(4.0),
        sigma_div=0.1,
        sigma_s=0.2,
    )
    assert time_differences(swing) == pytest.approx((20.0, 20.0))
    nothing = replace(swing, readings=np.empty(0), index=np.empty(0), sides=np.empty(0))
    assert time_differences(nothing) == ()


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("method", "kind"), [("amplitude", "scale_reversal"), ("transit", "transit")]
)
def test_the_interval_after_two_more_comes_true(method: SwingMethod, kind: str) -> None:
    ratios = []
    for run in runs(method, 8.0)[:40]:
        rows = swing_rows(run)
        places = [i for i, row in enumerate(rows) if row["kind"] == kind]
        now = judged(rows[: places[5] + 1], method)  # type: ignore[arg-type]
        later = judged(rows[: places[7] + 1], method)  # type: ignore[arg-type]
        assert now.interval95_two_more is not None
        assert later.interval95 is not None
        ratios.append(later.interval95 / now.interval95_two_more)
    # each interval leans on a residual sigma of few degrees of freedom (5 then, 3 before): the
    # median of 40 such ratios stays within a fifth of one
    assert 0.8 < float(np.median(ratios)) < 1.25


@pytest.mark.statistical
@pytest.mark.parametrize("method", ["amplitude", "transit"])
def test_north_now_lies_in_its_interval(method: SwingMethod) -> None:
    inside = 0
    for run in runs(method, 8.0):
        found = judged(swing_rows(run), method)  # type: ignore[arg-type]
        truth = run.truth["gyro_north_deg"]
        assert isinstance(truth, float)
        assert found.north is not None
        assert found.interval95 is not None
        off = math.remainder(found.north - math.radians(truth), 2.0 * math.pi)
        inside += abs(off) <= found.interval95
    assert inside >= least(RUNS, 0.95)


def test_without_times_readings_are_forecast_and_moments_are_not() -> None:
    rows = next(beginnings("amplitude", "scale_reversal", 5, 8.0))
    for row in rows:
        row |= {"time": "", "elapsed_s": ""}
    found = judged(rows, "amplitude")
    assert found.next is not None
    assert found.next.reading is not None
    assert found.next.moment_s is None
    assert found.due_s is None


def test_passages_timed_by_the_clock_alone_are_forecast_on_that_clock() -> None:
    rows = next(beginnings("transit", "transit", 3, 8.0))
    with_seconds = judged(rows, "transit")
    for row in rows:
        row["elapsed_s"] = ""
    found = judged(rows, "transit")
    assert found.time_differences == pytest.approx(with_seconds.time_differences, abs=2e-3)
    assert found.passage is not None
    assert with_seconds.passage is not None
    assert found.passage.half_width_s == pytest.approx(with_seconds.passage.half_width_s, rel=0.02)


def test_a_card_that_knows_nothing_still_forecasts_from_the_points() -> None:
    bare = replace(card(), periods=None, scale_value=None, torsion_lambda=None, transit_c=None)
    rows = next(beginnings("transit", "transit", 3, 8.0))
    found = progress_of(session(rows, "transit"), bare, np.random.default_rng(1), latitude=LATITUDE)
    assert found.passage is not None
    assert found.north is None
    assert "torsion ratio" in found.missing
    two = next(beginnings("transit", "transit", 1, 8.0))
    early = progress_of(session(two, "transit"), bare, np.random.default_rng(1), latitude=None)
    assert early.passage is None  # two passages are half a period apart, give or take the offset


def test_without_a_latitude_the_card_s_period_is_doubted_more() -> None:
    rows = next(beginnings("transit", "transit", 1, 8.0))[:-1]
    here, anywhere = judged(rows, "transit"), judged(rows, "transit", latitude=None)
    assert here.passage is not None
    assert anywhere.passage is not None
    assert anywhere.passage.half_width_s > 2.0 * here.passage.half_width_s


def test_a_struck_passage_leaves_the_count_of_the_others_alone() -> None:
    rows = next(beginnings("transit", "transit", 5, 8.0))
    places = [i for i, row in enumerate(rows) if row["kind"] == "transit"]
    struck = rows[places[3]]
    strike = dict.fromkeys(rows[0], "") | {"kind": "strike", "value": struck["seq"], "seq": "500"}
    later = [dict(row, seq=str(1000 + i)) for i, row in enumerate(rows[places[3] + 1 :])]
    rows = [*rows[: places[3] + 1], strike, *later]
    swing = standing_of(session(rows, "transit"), card(), LATITUDE).swing
    assert swing.after.tolist() == pytest.approx(
        (swing.after[0] + np.array([0, 1, 2, 4, 5])).tolist()
    )
    assert judged(rows, "transit").alert is None


def test_a_struck_and_a_missed_point_keep_the_count_of_the_scale() -> None:
    rows = next(beginnings("amplitude", "scale_reversal", 7, 8.0))
    rows[3] |= {"kind": "missed", "value": "", "unit": "", "side": ""}
    found = judged(rows[:-1], "amplitude")
    assert found.next is not None
    assert found.next.reading is not None
    assert found.next.half_width is not None
    assert abs(float(rows[-1]["value"]) - found.next.reading) <= found.next.half_width
    assert [point.index for point in found.points] == [0, 1, 3, 4, 5, 6]


def azimuths(*seconds: float) -> list[Row]:
    """Rounds of an automatic gyro."""
    names = ("seq", "time", "elapsed_s", "kind", "value", "unit", "face", "side", "target")
    blank = dict.fromkeys((*names, "temperature_c", "note"), "")
    return [
        blank | {"seq": str(i), "kind": "azimuth", "value": f"321-53-{s:04.1f}", "unit": "dms"}
        for i, s in enumerate(seconds, start=1)
    ]


def automatic(*seconds: float) -> Progress:
    item = replace(session(azimuths(*seconds), "automatic"), target="B")
    return progress_of(
        item, read_card("hgg05", base=Path(), override={}), np.random.default_rng(2), latitude=None
    )


def test_rounds_of_an_automatic_gyro_by_hand() -> None:
    assert automatic().north is None
    found = automatic(9.0, 15.0, 14.0, 12.0, 10.0, 12.0)
    assert found.delivered
    assert found.next is None
    assert found.interval95 is not None
    assert found.interval95_two_more is not None
    # mean 12.0", v'v = 24 + ... = 9 + 9 + 4 + 0 + 4 + 0 = 26, s = sqrt(26/5) = 2.280";
    # t(5) = 2.5706: 2.5706 * 2.280 / sqrt 6 = 2.393"; after two more t(7) = 2.3646: 1.906"
    assert found.interval95 * RHO_ARCSEC == pytest.approx(2.393, abs=2e-3)
    assert found.interval95_two_more * RHO_ARCSEC == pytest.approx(1.906, abs=2e-3)
    assert found.alert is None


def test_a_gross_round_is_told_by_its_number() -> None:
    alert = automatic(9.0, 11.0, 10.0, 10.5, 9.5, 49.0, 10.2, 9.9).alert
    assert alert is not None
    assert (alert.trouble, alert.index) == (Trouble.GROSS_ERROR, 5)


@pytest.mark.statistical
def test_clean_rounds_alarm_in_one_percent_of_cases() -> None:
    rng = np.random.default_rng(12)
    alarms = sum(
        automatic(*(20.0 + rng.normal(scale=3.0, size=7)).clip(0.0, 59.9).tolist()).alert
        is not None
        for _ in range(150)
    )
    assert alarms <= most(150, 0.01)
