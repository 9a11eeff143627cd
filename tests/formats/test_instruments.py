"""Total stations on the cable: a simulated one on a pseudo-terminal, and everything that fails."""

from __future__ import annotations

import json
import math
import sys
import time

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.observing.followed_turn import followed_turn
from surveyapp.errors import SurveyError
from tests.cli.command import run

if sys.platform == "win32":
    pytest.skip("pseudo-terminals", allow_module_level=True)
from tests.formats import simulated_station as s


def test_geocom_reads_angles_and_distance() -> None:
    with s.Station(s.geocom(lambda: 1.25, 1.5, 87.6543)) as station:
        reading = api.read_instrument(f"geocom:{station.port}", distance=True)
    assert (reading.hz, reading.v, reading.slope_distance) == (1.25, 1.5, 87.6543)
    assert reading.face == "L"


def test_geocom_without_a_prism_gives_the_angles() -> None:
    with s.Station(s.geocom(lambda: 1.25, 4.7, None)) as station:
        reading = api.read_instrument(f"geocom:{station.port}", distance=True)
    assert reading.slope_distance is None
    assert reading.face == "R"


@pytest.mark.parametrize("unit", ["2", "3"])
def test_gsi_online_takes_the_unit_from_the_word(unit: str) -> None:
    with s.Station(s.gsi(123.456, 91.5, 45.678, unit=unit)) as station:
        reading = api.read_instrument(f"gsi:{station.port}@19200", distance=True)
    assert math.degrees(reading.hz) == pytest.approx(123.456, abs=1e-5)
    assert math.degrees(reading.v or 0.0) == pytest.approx(91.5, abs=1e-5)
    assert reading.slope_distance == pytest.approx(45.678)


def test_sokkia_asks_for_the_units_first() -> None:
    with s.Station(s.sokkia("1234530", "0915959", 45678)) as station:
        reading = api.read_instrument(f"sokkia:{station.port}", distance=True)
        assert station.requests == [b"B", b"\x11"]
    assert math.degrees(reading.hz) == pytest.approx(123 + 45 / 60 + 30 / 3600)
    assert math.degrees(reading.v or 0.0) == pytest.approx(91 + 59 / 60 + 59 / 3600)
    assert reading.slope_distance == pytest.approx(45.678)
    feet = s.sokkia("1", "1", 1, settings="1,0,0,-30,1,0,0,0,0,0,0")
    with s.Station(feet) as station, pytest.raises(SurveyError, match="metres, degrees"):
        api.read_instrument(f"sokkia:{station.port}")


@pytest.mark.parametrize(
    ("protocol", "reply", "said"),
    [
        ("geocom", b"%R1P,0,0:1286\r\n", "cannot be measured"),
        ("geocom", b"%R1P,0,0:0,70.5,99.0\r\n", "no radians"),
        ("geocom", b"%R1P,0,0:0,abc,1\r\n", "no reading"),
        ("geocom", b"hello\r\n", "no answer of GeoCOM"),
        ("geocom", b"%R1P,0,0:0,1.2", "cut short"),
        ("gsi", b"@W427\r\n", "refuses"),
        ("gsi", b"*21.322+0000 \r\n", "no answer of GSI"),
        ("gsi", b"*21.329+0000000012345678 \r\n", "no unit"),
        ("gsi", b"x" * 1000, "cut short"),
        ("sokkia", b"E200\r\n", "no answer of the settings"),
    ],
)
def test_what_an_instrument_may_answer(protocol: str, reply: bytes, said: str) -> None:
    with s.Station(lambda _: reply) as station, pytest.raises(SurveyError, match=said):
        api.read_instrument(f"{protocol}:{station.port}", timeout_s=0.4)


def test_silence_is_told_in_time() -> None:
    with s.Station(lambda _: None) as station:
        start = time.monotonic()
        with pytest.raises(SurveyError, match=r"no answer within 0\.3 s"):
            api.read_instrument(f"geocom:{station.port}", timeout_s=0.3)
        assert time.monotonic() - start < 3.0


def test_a_cable_that_is_pulled_out() -> None:
    station: s.Station

    def answer(_: bytes) -> None:
        station.pull_cable()

    with s.Station(answer) as station, pytest.raises(SurveyError, match=r"cable|answer"):
        api.read_instrument(f"geocom:{station.port}", timeout_s=2.0)
    with pytest.raises(SurveyError, match="cannot be opened"):
        api.read_instrument("geocom:/dev/no-such-port")


@pytest.mark.parametrize("text", ["geocom", "leica:COM1", "gsi:", "gsi:COM1@fast", ""])
def test_what_names_no_instrument(text: str) -> None:
    result = run("instrument", text, "--json")
    assert result.code == 2
    assert json.loads(result.out)["schema"] == "surveyapp.error/1"


def test_a_turning_point_is_followed() -> None:
    start = time.monotonic()

    def hz() -> float:
        t = time.monotonic() - start - 1.2
        return 1.0 + math.radians(1.5) * math.cos(2.0 * math.pi / 60.0 * t)

    with s.Station(s.geocom(hz, 1.5, None)) as station:
        result = run("instrument", f"geocom:{station.port}", "--follow", "2.4", "--json")
    assert result.code == 0, result.err
    turn = json.loads(result.out)["turning_point"]
    assert turn["value_deg"] == pytest.approx(math.degrees(1.0) + 1.5, abs=2e-4)
    assert turn["side"] == "R"
    assert turn["readings"] >= 15


def _followed(g: np.random.Generator, half: float, hand: tuple[float, float], deg: float) -> float:
    """Error over sigma of one turn of a damped swing of 400 s, read ten times a second.

    y = A exp(-d t) cos(w t) turns at tan(w t) = -d / w; ``hand``: seconds of arc, correlation from
    one reading to the next.
    """
    arc, w, d = math.pi / 648000.0, 2.0 * math.pi / 400.0, 0.02 / 400.0
    top = math.atan2(-d, w) / w
    truth = math.radians(deg) * math.exp(-d * top) * math.cos(w * top)
    moment = g.uniform(0.7, 1.3) * half
    t = np.arange(0.0, 2.0 * half, 0.1)
    noise = g.normal(size=len(t))
    for i in range(1, len(t)):
        noise[i] = hand[1] * noise[i - 1] + math.sqrt(1.0 - hand[1] ** 2) * noise[i]
    since = t - moment + top
    swing = math.radians(deg) * np.exp(-d * since) * np.cos(w * since)
    turn = followed_turn(t.tolist(), (3.0 + swing + hand[0] * arc * noise).tolist())
    assert abs(turn.moment_s - moment) < 6.0 * turn.moment_sigma_s
    return (turn.value - 3.0 - truth) / turn.sigma


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("half", "hand", "deg"),
    [(15.0, (6.0, 0.6), 3.0), (20.0, (6.0, 0.0), 0.5), (60.0, (6.0, 0.6), 3.0)],
)
def test_the_sigma_of_a_followed_turn_holds(
    half: float, hand: tuple[float, float], deg: float
) -> None:
    """A swing is no parabola: 60 s to either side of a turn of 3 degrees bend by 30" more."""
    g = np.random.default_rng(11)
    scores = np.array([_followed(g, half, hand, deg) for _ in range(120)])
    # binomial(120, 0.95): 99.9 % from 105 on; chi-square with 120 degrees of freedom: 1 +- 0.13
    assert int((np.abs(scores) < 1.96).sum()) >= 105
    assert 0.5 < float(np.mean(scores**2)) < 1.45


def test_a_straight_line_is_no_turn() -> None:
    t = [0.1 * i for i in range(100)]
    with pytest.raises(SurveyError, match="bend"):
        followed_turn(t, [1.0 + 1e-5 * x + 1e-7 * math.sin(7 * x) for x in t])
    with pytest.raises(SurveyError, match="outside"):
        followed_turn(t, [1.0 + 1e-5 * (x + 20.0) ** 2 for x in t])
    with pytest.raises(SurveyError, match="too few"):
        followed_turn(t[:5], t[:5])
