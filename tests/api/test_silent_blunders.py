"""Blunders that once gave a wrong azimuth with a small sigma and no word."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from tests.api.projects import TM, rows, session, station, write

AUTOMATIC = """
[[instrument]]
id = "G"
card = "hgg05"
constant = { arcsec = 0.0, sigma_arcsec = 2.0 }
"""
PLACE = "[[station]]\nname = 'A'\nlat = 47.0\nlon = 8.0\n[[station]]\nname = 'B'\n"


def line(more: str = "", method: str = "automatic") -> str:
    return (
        f'[[orientation]]\nid = "s"\nstation = "A"\ntarget = "B"\ninstrument = "G"\n'
        f'method = "{method}"\npurpose = "survey"\n{more}\nbook = "observations/s.csv"\n'
    )


def failed(folder: Path) -> set[str]:
    return {c.rule for c in api.check(folder) if c.confirmed and c.passed is False}


@pytest.mark.parametrize("wild", ["225-00-00", "45-10-00", "46-00-00"])
def test_rounds_that_do_not_belong_together(tmp_path: Path, wild: str) -> None:
    good = ["45-00-00", "45-00-06", "45-00-03"]
    toml = AUTOMATIC + PLACE + line()
    books = {"s": rows(*(f"azimuth,{value}" for value in good))}
    assert failed(write(tmp_path / "good", toml, books)) == set()
    books = {"s": rows(*(f"azimuth,{value}" for value in [*good[:2], wild]))}
    assert failed(write(tmp_path / "bad", toml, books)) == {"rounds.scatter"}


def test_two_sights_of_unknown_face_half_a_circle_apart_are_refused(tmp_path: Path) -> None:
    book = rows("backsight,0-00-02", "backsight,180-00-06", "north,0-00-00", "north,0-00-04")
    with pytest.raises(SurveyError, match="do not belong to one direction") as caught:
        api.orient(write(tmp_path, AUTOMATIC + PLACE + line(), {"s": book}))
    assert "L or R" in caught.value.problems[0].hint


def test_an_azimuth_against_fixed_coordinates(tmp_path: Path) -> None:
    # 200 m due north; 10' off is 0.6 m at the target
    fixed = "fixed = true\nsigma_m = 0.005"
    n0 = 5_300_000.0
    toml = station("A", e=0.0, n=n0, more=fixed) + station("B", e=0.0, n=n0 + 200.0, more=fixed)
    toml += AUTOMATIC + line()
    for name, text, wanted in (
        ("good", "0-00-05", set()),
        ("bad", "0-10-00", {"coordinates.line"}),
    ):
        books = {"s": rows(*[f"azimuth,{text}"] * 3)}
        assert failed(write(tmp_path / name, toml, books, head=TM)) == wanted


@pytest.mark.parametrize(
    ("text", "told"), [("0-00-05", False), ("3-00-00", True), ("40-00-00", True)]
)
def test_an_azimuth_that_is_not_that_of_the_line_in_the_plan(
    tmp_path: Path, text: str, told: bool
) -> None:
    """Coordinates that are not fixed may be those of an old plan: told, and not failed."""
    n0 = 5_300_000.0
    toml = station("A", e=0.0, n=n0) + station("B", e=0.0, n=n0 + 200.0) + AUTOMATIC + line()
    folder = write(tmp_path, toml, {"s": rows(*[f"azimuth,{text}"] * 3)}, head=TM)
    assert failed(folder) == set()
    check = next(c for c in api.check(folder) if c.rule == "coordinates.line")
    assert (check.confirmed, check.passed) == (False, not told)


@pytest.mark.parametrize(("longitude", "told"), [(8.6, False), (9.0, True)])
def test_a_line_far_from_its_calibration_is_asked_about(
    tmp_path: Path, longitude: float, told: bool
) -> None:
    # at 47 degrees .6 degrees of longitude are 45.6 km, a degree 75.9 km
    toml = AUTOMATIC + PLACE
    toml += f"[[station]]\nname = 'C'\nlat = 47.0\nlon = {longitude}\n[[station]]\nname = 'D'\n"
    known = line('azimuth_known = "45-00-00"').replace('"survey"', '"calibration"')
    sought = line().replace('"A"', '"C"').replace('"B"', '"D"')
    toml += known.replace('id = "s"', 'id = "k"') + sought
    found = api.orient(write(tmp_path, toml, {"s": rows("azimuth,45-00-00")}))
    assert ("constant_far" in {warning.code for warning in found.warnings}) is told


def test_two_known_azimuths_of_one_line(tmp_path: Path) -> None:
    toml = AUTOMATIC + PLACE
    for number, azimuth in enumerate(("45-00-00", "45-01-00")):
        toml += (
            line(f'azimuth_known = "{azimuth}"')
            .replace('"survey"', '"calibration"')
            .replace('id = "s"', f'id = "s{number}"')
        )
    folder = write(tmp_path, toml, {"s": rows("azimuth,45-00-00")})
    assert "known_azimuth.same_line" in failed(folder)


GAK = """
[[instrument]]
id = "G"
card = "wild-gak1"
scale_value_arcsec = 600.0
constant = { arcsec = 0.0, sigma_arcsec = 2.0 }
"""


def turning(slip: float = 0.0) -> list[str]:
    """Nine turning points about 100 degrees, the fifth off by a slip [degree]."""
    found = []
    for k in range(9):
        value = 100.0 + (-1) ** k * (2.0 - 0.014 * k) + (slip if k == 4 else 0.0)
        minutes = round(value * 3600.0, 1)
        degrees, rest = divmod(minutes, 3600.0)
        whole, seconds = divmod(rest, 60.0)
        found.append(f"reversal,{int(degrees)}-{int(whole):02d}-{seconds:04.1f}")
    return found


def test_one_degree_in_a_turning_point_is_told_by_its_number(tmp_path: Path) -> None:
    toml = GAK + PLACE + line(method="tracking")
    sights = ["backsight,45-00-00,L", "backsight,225-00-00,R"]
    book = rows(*sights, *turning(1.0))
    checks = api.check(write(tmp_path, toml, {"s": book}))
    told = {c.rule: c for c in checks if c.passed is False}
    assert {"fit", "fit.size", "fit.largest_residual"} <= set(told)
    assert "turning point 5" in told["fit.largest_residual"].text
    # the limit does not grow with the misfit
    assert told["fit"].limit is not None
    assert told["fit"].limit < 120.0


TRANSIT = """
[[instrument]]
id = "T"
card = "jt-15"
[instrument.period]
latitude_deg = 45.0
[instrument.transit]
c_arcsec_per_div_s = {c}
{more}
[[station]]
name = "A"
lat = {latitude}
lon = 20.0
[[orientation]]
id = "run"
station = "A"
instrument = "T"
method = "transit"
purpose = "survey"
book = "observations/run.csv"
"""


def transit_book(east: float, west: float, amplitude: float) -> str:
    text, t = ["seq,elapsed_s,kind,value,side", "1,,clamp,359-58-00,"], 0.0
    for k in range(5):
        text.append(f"{2 * k + 2},{t:.2f},transit,0,{'RL'[k % 2]}")
        if k < 4:
            value = amplitude if k % 2 == 0 else -amplitude
            text.append(f"{2 * k + 3},,scale_reversal,{value:.2f},{'RL'[k % 2]}")
        t += east if k % 2 == 0 else west
    return "\n".join(text) + "\n"


@pytest.mark.parametrize(("c", "dt", "a"), [(3.0, 6.0, 8.0), (2.5, -4.0, 10.0)])
def test_transit_by_the_constant_alone(tmp_path: Path, c: float, dt: float, a: float) -> None:
    toml = "format = 1\nname = 'x'\n" + TRANSIT.format(c=c, more="", latitude=45.0)
    (tmp_path / "observations").mkdir()
    (tmp_path / "project.toml").write_text(toml)
    book = transit_book(220.0 + dt / 2.0, 220.0 - dt / 2.0, a)
    (tmp_path / "observations/run.csv").write_text(book)
    north = api.orient(tmp_path).sessions[0].gyro_north
    assert north is not None
    # N = N' + C a dt; N' = 359-58-00
    expected = math.radians(-120.0 / 3600.0 + c * a * dt / 3600.0) % (2.0 * math.pi)
    assert math.remainder(north.value - expected, 2.0 * math.pi) * 206264.806 == pytest.approx(
        0.0, abs=0.01
    )


def test_repeated_calibrations_without_a_sigma_have_that_of_their_scatter(tmp_path: Path) -> None:
    values = [0.0, 20.0, -20.0, 30.0, -30.0, 10.0]
    toml = station("A", e=0.0, n=5_300_000.0, more="sigma_m = 0.0\n" + NO_DEFLECTION)
    toml += station("B", e=0.0, n=5_302_000.0, more="sigma_m = 0.0")
    toml += '\n[[instrument]]\nid = "G1"\ncard = "mvt-2"\nconstant_choice = "pooled"\n'
    books = {}
    for number, value in enumerate(values):
        toml += session(f"c{number}", "A", "B", more=['purpose = "calibration"'])
        whole, left = divmod(60.0 + value, 60.0)
        books[f"c{number}"] = rows(f"azimuth,10-{int(whole):02d}-{left:04.1f}")
    constant = api.orient(write(tmp_path, toml, books, head=TM)).constants[0]
    one = math.sqrt(sum(v * v for v in values) / 5.0 - (sum(values) ** 2 / 6.0) / 5.0)
    assert constant.sigma is not None
    # centring of 2 km: 0.15"
    assert constant.sigma * 206264.806 == pytest.approx(one / math.sqrt(6.0), rel=1e-3)


NO_DEFLECTION = "deflection = { xi_arcsec = 0.0, eta_arcsec = 0.0, sigma_arcsec = 0.0 }"


@pytest.mark.parametrize(
    ("day", "told"), [("2026-05-22", False), ("2026-05-21", False), ("2031-05-22", True)]
)
def test_a_date_beside_other_times_in_the_book(tmp_path: Path, day: str, told: bool) -> None:
    book = "seq,time,kind,value\n" + "".join(
        f"{k},2026-05-22T07:0{k}:00+00:00,azimuth,45-00-0{k}\n" for k in (1, 2, 3)
    )
    toml = AUTOMATIC + PLACE + line(f"date = {day}")
    found = api.orient(write(tmp_path, toml, {"s": book})).to_dict()["warnings"]
    dates = [item for item in found if item["code"] == "session_date_differs"]
    assert len(dates) == told
    if told:
        assert (dates[0]["subject"]["kind"], dates[0]["subject"]["id"]) == ("session", "s")
