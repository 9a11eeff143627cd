"""The tail of the field book through the whole program: what a surveyor can check by hand."""

import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp_models.angles import AngleUnit, format_angle
from tests.api.projects import CARD, GYRO, HEAD, rows, session, station, write

NORTH = math.radians(100.0)


def azimuth(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Bearing of a line between two points (e, n)."""
    return math.atan2(end[0] - start[0], end[1] - start[1])


def reading(start: tuple[float, float], end: tuple[float, float], turned: float = 0.0) -> str:
    """Circle reading of a direction, the circle reading 100 degrees at north."""
    value = (azimuth(start, end) + NORTH + turned) % (2.0 * math.pi)
    return format_angle(value, AngleUnit.DMS, 3)


S, T, U = (1000.0, 5_300_000.0), (1080.0, 5_300_060.0), (900.0, 5_300_200.0)
STATIONS = station("S", e=S[0], n=S[1]) + station("T", e=T[0], n=T[1])


@pytest.mark.parametrize("theta", [10.0, 130.0, 250.0, 310.0])
@pytest.mark.parametrize("at", ["station", "target"])
def test_eccentric_set_up_is_carried_to_the_marks(tmp_path: Path, at: str, theta: float) -> None:
    # 0.5 m on 100 m: up to 17 minutes of arc
    away = (0.5 * math.sin(math.radians(theta)), 0.5 * math.cos(math.radians(theta)))
    mark = S if at == "station" else T
    stood = (mark[0] + away[0], mark[1] + away[1])
    instrument, prism = (stood, T) if at == "station" else (S, stood)
    more = [
        'purpose = "survey"',
        f'eccentric = {{ distance_m = 0.5, direction = "{reading(stood, mark)}", at = "{at}" }}',
    ]
    toml = STATIONS + GYRO + session("run", "S", "T", more=more)
    book = rows(
        f"backsight,{reading(instrument, prism)},L,,T",
        "north,100-00-00",
        f"backsight,{reading(instrument, prism, math.pi)},R,,T",
    )
    item = api.orient(write(tmp_path, toml, {"run": book})).sessions[0].to_dict()
    expected = math.degrees(azimuth(S, T)) % 360.0
    # the correction is asin(e sin(angle) / D) with the marks' distance: exact at the station,
    # good to (e/D)^2 radian at the target
    assert item["gyro_azimuth"]["deg"] == pytest.approx(expected, abs=2e-5)
    correction = item["targets"][0]["eccentric_correction_arcsec"]
    crude = math.degrees(azimuth(instrument, prism)) % 360.0
    assert correction / 3600.0 == pytest.approx(expected - crude, abs=2e-5)


def test_several_targets_share_one_north(tmp_path: Path) -> None:
    toml = STATIONS + station("U", e=U[0], n=U[1]) + GYRO
    toml += session("run", "S", "T", more=['purpose = "survey"'])
    sights = [
        f"backsight,{reading(S, end, turn)},{face},,{name}"
        for name, end in (("T", T), ("U", U))
        for face, turn in (("L", 0.0), ("R", math.pi))
    ]
    result = api.orient(write(tmp_path, toml, {"run": rows(*sights, "north,100-00-00")}))
    lines = {line.target: line.to_dict() for line in result.lines}
    assert set(lines) == {"T", "U"}
    for name, end in (("T", T), ("U", U)):
        expected = math.degrees(azimuth(S, end)) % 360.0
        assert lines[name]["gyro_azimuth"]["deg"] == pytest.approx(expected, abs=1e-6)


def test_collimation_falls_out_of_two_faces_and_is_shown(tmp_path: Path) -> None:
    c = math.radians(30.0 / 3600.0)
    toml = STATIONS + GYRO + session("run", "S", "T", more=['purpose = "survey"'])
    book = rows(
        f"backsight,{reading(S, T, c)},L,,T",
        f"backsight,{reading(S, T, math.pi - c)},R,,T",
        "north,100-00-00",
    )
    item = api.orient(write(tmp_path, toml, {"run": book})).sessions[0].to_dict()
    assert item["targets"][0]["collimation_arcsec"] == pytest.approx(30.0, abs=0.01)
    assert item["gyro_azimuth"]["deg"] == pytest.approx(math.degrees(azimuth(S, T)), abs=1e-6)


TRACKED = """
[[orientation]]
id = "run"
station = "A"
instrument = "G1"
method = "tracking"
purpose = "survey"
book = "observations/run.csv"
"""
AT_47 = '[[station]]\nname = "A"\nlat = 47.0\nlon = 9.0\n'


def timed(*entries: tuple[float, str, str]) -> str:
    lines = [HEAD]
    for seq, (elapsed, kind, value) in enumerate(entries, 1):
        lines.append(f"{seq},,{elapsed},{kind},{value},,,,,,")
    return "\n".join(lines) + "\n"


def test_tape_zero_is_interpolated_in_time(tmp_path: Path) -> None:
    # rest reading 0.0 at 60 s, +1.0 at 1260 s; the run's middle at 360 s: a quarter of the way
    before = [(0.0, "5.0"), (60.0, "-5.0"), (120.0, "5.0")]
    after = [(1200.0, "5.0"), (1260.0, "-3.0"), (1320.0, "5.0")]
    swing = [(160.0, "99-00-00"), (360.0, "101-00-00"), (560.0, "99-00-00")]
    book = timed(
        *((t, "tape_zero", v) for t, v in before),
        *((t, "reversal", v) for t, v in swing),
        *((t, "tape_zero", v) for t, v in after),
    )
    item = api.orient(write(tmp_path, AT_47 + GYRO + TRACKED, {"run": book})).sessions[0].to_dict()
    zero = item["tape_zero"]
    assert zero["interpolation"] == "time"
    assert (zero["before_div"], zero["after_div"]) == (pytest.approx(0.0), pytest.approx(1.0))
    assert zero["value_div"] == pytest.approx(0.25)
    ratio = (425.4 / 388.3) ** 2 - 1.0
    assert item["tape_zero_correction_arcsec"] == pytest.approx(-ratio * 600.0 * 0.25)


def test_a_strike_and_its_successor_make_the_same_result_as_a_clean_book(tmp_path: Path) -> None:
    points = ["99-00-00", "101-00-00", "99-00-40", "100-59-20", "99-01-20", "100-58-40"]
    clean = [f"reversal,{value}" for value in points]
    wrong = [*clean[:2], "reversal,99-40-00", "strike,3", *clean[2:]]
    norths = []
    for name, lines in (("clean", clean), ("struck", wrong)):
        folder = write(tmp_path / name, AT_47 + GYRO + TRACKED, {"run": rows(*lines)})
        found = api.orient(folder).sessions[0]
        assert found.points_used == 6
        norths.append(found.to_dict()["gyro_north"])
    assert norths[0] == norths[1]


def test_a_missed_point_keeps_the_count(tmp_path: Path) -> None:
    # undamped: 99 and 101 degrees in turn; without the count the sides would be exchanged
    values = ["99-00-00", "101-00-00", "", "101-00-00", "99-00-00", "101-00-00", "99-00-00"]
    lines = [f"reversal,{value}" if value else "missed," for value in values]
    folder = write(tmp_path, AT_47 + GYRO + TRACKED, {"run": rows(*lines)})
    item = api.orient(folder).sessions[0].to_dict()
    assert item["gyro_north"]["deg"] == pytest.approx(100.0, abs=1e-9)
    assert item["points_used"] == 6
    assert item["damping_per_half_swing"] == pytest.approx(1.0)


def test_a_run_across_zero_is_the_same_run_turned(tmp_path: Path) -> None:
    points = [-1.0, 1.02, -0.97, 0.99, -0.96, 0.96, -0.93]
    found = []
    for name, north in (("across", 0.0), ("plain", 100.0)):
        lines = [
            f"reversal,{format_angle(math.radians((north + p) % 360.0), AngleUnit.DMS, 1)}"
            for p in points
        ]
        folder = write(tmp_path / name, AT_47 + GYRO + TRACKED, {"run": rows(*lines)})
        found.append(api.orient(folder).sessions[0].to_dict())
    across, plain = found
    turned = (across["gyro_north"]["deg"] + 100.0) % 360.0
    assert turned == pytest.approx(plain["gyro_north"]["deg"], abs=1e-9)
    for key in ("amplitude_arcsec", "damping_per_half_swing", "residual_rms_arcsec"):
        assert across[key] == pytest.approx(plain[key], rel=1e-6)


def test_card_values_may_be_overridden_in_the_project(tmp_path: Path) -> None:
    zeros = ["tape_zero,5.5", "tape_zero,-4.5", "tape_zero,5.5"]
    lines = [*zeros, "reversal,99-00-00", "reversal,101-00-00", "reversal,99-00-00", *zeros]
    own = GYRO + "scale_value_arcsec = -300.0\n"
    folder = write(tmp_path, AT_47 + own + TRACKED, {"run": rows(*lines)}, card=CARD)
    item = api.orient(folder).sessions[0].to_dict()
    ratio = (425.4 / 388.3) ** 2 - 1.0
    assert item["tape_zero_correction_arcsec"] == pytest.approx(+ratio * 300.0 * 0.5)
