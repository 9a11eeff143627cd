import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from tests.api.projects import CARD, GYRO, TM, azimuths, rows, session, station, write

CAL, SURVEY = 'purpose = "calibration"', 'purpose = "survey"'
N0 = 5_300_000.0  # about latitude 47.8


def four_stations(offset: float = 0.0) -> str:
    return (
        station("A", e=offset, n=N0)
        + station("B", e=offset, n=N0 + 200.0)
        + station("C", e=offset + 100.0, n=N0 + 50.0)
        + station("D", e=offset + 400.0, n=N0 + 50.0)
    )


def test_signs_on_the_central_meridian_by_hand(tmp_path: Path) -> None:
    # A-B runs true north on the central meridian; the gyro shows 359-59-50: constant +10".
    # C-D runs east (grid azimuth 90); 100 m east of the meridian the convergence is +3.6"
    toml = four_stations() + GYRO
    toml += session("cal", "A", "B", more=[CAL]) + session("run", "C", "D", more=[SURVEY])
    folder = write(
        tmp_path,
        toml,
        {"cal": azimuths("359-59-50", "359-59-50"), "run": azimuths("90-00-00", "90-00-00")},
        head=TM,
    )
    result = api.orient(folder)
    constant, line = result.constants[0].to_dict(), result.lines[0].to_dict()
    assert constant["arcsec"] == pytest.approx(10.0, abs=1e-3)
    assert line["true_azimuth"]["deg"] == pytest.approx(90.0 + 10.0 / 3600.0, abs=1e-8)
    gamma = 100.0 * math.tan(math.radians(47.82)) / 6.385e6 * 206264.8
    assert line["convergence_arcsec"] == pytest.approx(gamma, abs=0.05)
    expected = 90.0 + (10.0 - line["convergence_arcsec"]) / 3600.0
    assert line["grid_azimuth"]["deg"] == pytest.approx(expected, abs=1e-6)


def test_shared_deflection_cancels_and_an_own_one_does_not(tmp_path: Path) -> None:
    deflected = "deflection = { xi_arcsec = 0.0, eta_arcsec = 8.0, sigma_arcsec = 1.0 }"
    toml = station("A", e=0.0, n=N0, more=deflected)
    toml += station("B", e=0.0, n=N0 + 200.0) + station("D", e=300.0, n=N0) + GYRO
    toml += session("cal", "A", "B", more=[CAL]) + session("run", "A", "D", more=[SURVEY])
    books = {"cal": azimuths("0-00-00"), "run": azimuths("90-00-00")}
    line = api.orient(write(tmp_path, toml, books, head=TM)).lines[0]
    # the constant takes up eta tan(phi), the line gives it back: grid azimuth 90
    assert math.degrees(line.deflection) * 3600 == pytest.approx(
        8 * math.tan(math.radians(47.82)), abs=0.01
    )
    assert line.grid_azimuth is not None
    assert math.degrees(line.grid_azimuth.value) == pytest.approx(90.0, abs=1e-6)
    assert [item.sigma for item in line.budget if item.source == "deflection"] == [0.0]


def test_budget_is_computed_from_the_parts(tmp_path: Path) -> None:
    toml = four_stations() + GYRO
    toml += session("cal", "A", "B", more=[CAL]) + session("run", "C", "D", more=[SURVEY])
    books = {"cal": azimuths("0-00-00", "0-00-02"), "run": azimuths("90-00-00")}
    independent = TM + "deflection = { correlation_km = 0.0 }\n"
    line = api.orient(write(tmp_path, toml, books, head=independent)).lines[0].to_dict()
    budget = {row["source"]: row["sigma_arcsec"] for row in line["budget"]}
    rho = 206264.806
    assert budget["rounds"] == pytest.approx(4.0)  # the card's, one round
    assert budget["constant: rounds"] == pytest.approx(4.0 / math.sqrt(2.0))
    both = math.hypot(math.sqrt(2) * 1e-3 / 300.0, math.sqrt(2) * 1e-3 / 200.0) * rho
    centring = math.hypot(budget["centring"], budget.get("constant: centring", 0.0))
    assert centring == pytest.approx(both, rel=1e-6)
    tangent = math.tan(math.radians(47.825))
    assert budget["deflection"] == pytest.approx(5.0 * tangent * math.sqrt(2.0), rel=1e-3)
    total = math.sqrt(sum(value**2 for value in budget.values()))
    assert line["grid_azimuth"]["sigma_arcsec"] == pytest.approx(total, rel=1e-9)
    assert sum(row["share"] for row in line["budget"]) == pytest.approx(1.0)


def test_near_stations_have_nearly_the_same_deflection(tmp_path: Path) -> None:
    # 3 km apart: the difference has sqrt(2 (1 - exp(-3/20))) of the 5" at each, not sqrt(2)
    toml = station("A", e=0.0, n=N0) + station("B", e=0.0, n=N0 + 200.0)
    toml += station("C", e=3000.0, n=N0) + station("D", e=3300.0, n=N0) + GYRO
    toml += session("cal", "A", "B", more=[CAL]) + session("run", "C", "D", more=[SURVEY])
    books = {"cal": azimuths("0-00-00", "0-00-02"), "run": azimuths("90-00-00")}
    tangent = math.tan(math.radians(47.825))
    region = "deflection = {{ sigma_arcsec = {}, correlation_km = {} }}\n"
    for number, (sigma, length) in enumerate([(5.0, 20.0), (3.0, 5.0), (5.0, 1e-3)]):
        head = TM + region.format(sigma, length)
        line = api.orient(write(tmp_path / str(number), toml, books, head=head)).lines[0]
        found = {row.source: row.sigma for row in line.budget}["deflection"]
        expected = sigma * tangent * math.sqrt(2.0 * (1.0 - math.exp(-3.0 / length)))
        assert found * 206264.806 == pytest.approx(expected, rel=5e-3)


def test_forward_and_back_share_the_deflection_of_near_stations(tmp_path: Path) -> None:
    # 300 m apart: the difference has 1 - exp(-0.3/5) of the variance of two that are independent
    toml = station("A", e=0.0, n=N0) + station("B", e=0.0, n=N0 + 200.0)
    toml += station("C", e=3000.0, n=N0) + station("D", e=3300.0, n=N0) + GYRO
    toml += session("cal", "A", "B", more=[CAL])
    toml += session("run", "C", "D", more=[SURVEY]) + session("back", "D", "C", more=[SURVEY])
    books = {"cal": azimuths("0-00-00", "0-00-02"), "run": azimuths("90-00-00")}
    books["back"] = azimuths("270-00-00")
    limits = {}
    for sigma, length in ((0.001, 20.0), (10.0, 5.0), (10.0, 1e-3)):
        head = TM + f"deflection = {{ sigma_arcsec = {sigma}, correlation_km = {length} }}\n"
        folder = write(tmp_path / f"{sigma} {length}", toml, books, head=head)
        (found,) = [c for c in api.check(folder) if c.rule == "line.forward_back"]
        assert found.limit is not None
        limits[sigma, length] = found.limit
    plain = limits[0.001, 20.0]
    apart = limits[10.0, 1e-3] ** 2 - plain**2
    near = limits[10.0, 5.0] ** 2 - plain**2
    assert apart > 0.0
    assert near / apart == pytest.approx(1.0 - math.exp(-0.3 / 5.0), rel=2e-2)


def test_levelling_is_paid_for_by_steep_sights(tmp_path: Path) -> None:
    # physics.md 3.8: v cot z, not cancelled by two faces
    toml = station("A", e=0.0, n=N0) + station("B", e=0.0, n=N0 + 200.0) + GYRO
    toml += session("run", "A", "B", more=[SURVEY])
    book = rows("azimuth,0-00-00", "zenith,30-00-00")
    plain = api.orient(write(tmp_path / "a", toml, {"run": azimuths("0-00-00")}, head=TM)).lines[0]
    assert {row.source: row.sigma for row in plain.budget}["levelling"] == pytest.approx(0.0)
    steep = api.orient(write(tmp_path / "b", toml, {"run": book}, head=TM)).lines[0]
    levelling = {row.source: row.sigma for row in steep.budget}["levelling"]
    assert levelling * 206264.806 == pytest.approx(10.0 / math.tan(math.radians(30.0)), rel=1e-6)


def test_every_term_stands_on_the_budget_with_its_source(tmp_path: Path) -> None:
    toml = four_stations() + GYRO
    toml += session("cal", "A", "B", more=[CAL]) + session("run", "C", "D", more=[SURVEY])
    books = {"cal": azimuths("0-00-00", "0-00-02"), "run": azimuths("90-00-00")}
    line = api.orient(write(tmp_path, toml, books, head=TM)).lines[0]
    names = {row.source.removeprefix("constant: ") for row in line.budget}
    assert {"levelling", "graduation", "twist", "lateral refraction", "observer"} <= names
    assert all(row.origin for row in line.budget)


def test_centring_anew_averages_out(tmp_path: Path) -> None:
    toml = station("A", e=0.0, n=N0) + station("B", e=0.0, n=N0 + 100.0) + GYRO
    sigmas = {}
    for key in ("false", "true"):
        own = f"recentred = {key}"
        text = toml + "".join(session(f"run{i}", "A", "B", more=[SURVEY, own]) for i in range(4))
        books = {f"run{i}": azimuths("0-00-00") for i in range(4)}
        line = api.orient(write(tmp_path / key, text, books, head=TM)).lines[0]
        sigmas[key] = {row.source: row.sigma for row in line.budget}["centring"]
    assert sigmas["true"] == pytest.approx(0.5 * sigmas["false"], rel=1e-9)


def test_short_sight_is_paid_for(tmp_path: Path) -> None:
    # physics.md section 4: 1 mm on 50 m is 4.1"
    toml = station("A", e=0.0, n=N0) + station("B", e=0.0, n=N0 + 50.0) + GYRO
    toml += session("run", "A", "B", more=[SURVEY])
    head = TM + "centring_mm = { instrument = 1.0, target = 0.0 }\n"
    folder = write(tmp_path, toml, {"run": azimuths("0-00-00")}, head=head)
    line = api.orient(folder).lines[0].to_dict()
    budget = {row["source"]: row["sigma_arcsec"] for row in line["budget"]}
    assert budget["centring"] == pytest.approx(4.125, abs=0.01)
    assert line["true_azimuth"] is None
    assert line["grid_azimuth"] is None


def before_and_after(values: tuple[str, str], choice: str) -> tuple[str, dict[str, str]]:
    toml = four_stations() + GYRO + f'constant_choice = "{choice}"\n'
    toml += session("cal-1", "A", "B", more=[CAL, "date = 2026-03-01"])
    toml += session("run", "C", "D", more=[SURVEY, "date = 2026-03-02"])
    toml += session("cal-2", "A", "B", more=[CAL, "date = 2026-03-05"])
    books = {
        "cal-1": azimuths(*[values[0]] * 3),
        "run": azimuths("90-00-00"),
        "cal-2": azimuths(*[values[1]] * 3),
    }
    return toml, books


def test_interpolated_constant_follows_time(tmp_path: Path) -> None:
    # constants 0" before and -20" after, four days apart, the survey on the first: -5"
    toml, books = before_and_after(("0-00-00", "0-00-20"), "interpolated")
    line = api.orient(write(tmp_path, toml, books, head=TM)).lines[0].to_dict()
    assert line["constant"]["arcsec"] == pytest.approx(-5.0, abs=0.05)
    assert line["constant"]["choice"] == "interpolated"
    # physics.md 3.2: var = m^2 ((1-f)^2/n_b + f^2/n_a)
    own = 4.0 * math.sqrt(0.75**2 / 3 + 0.25**2 / 3)
    budget = {row["source"]: row["sigma_arcsec"] for row in line["budget"]}
    assert budget["constant: rounds"] == pytest.approx(own, rel=1e-6)


def test_a_constant_that_moved_is_never_averaged_silently(tmp_path: Path) -> None:
    toml, books = before_and_after(("0-00-00", "0-00-40"), "pooled")
    result = api.orient(write(tmp_path, toml, books, head=TM))
    constant = result.constants[0].to_dict()
    assert constant["stable"] is False
    assert not result.passed
    assert any(w.code == "constant_unstable" for w in result.warnings)
    # the two epochs scatter by 20" about their mean; the sigma says so
    assert constant["sigma_arcsec"] > 19.0
    quiet_toml, quiet_books = before_and_after(("0-00-00", "0-00-02"), "pooled")
    quiet = api.orient(write(tmp_path / "quiet", quiet_toml, quiet_books, head=TM))
    assert quiet.constants[0].stable is True
    assert quiet.passed


def test_nearest_and_named_lines(tmp_path: Path) -> None:
    toml = four_stations() + station("P", e=5000.0, n=N0) + station("Q", e=5000.0, n=N0 + 300.0)
    toml += GYRO + 'constant_choice = "nearest"\n'
    toml += session("far", "P", "Q", more=[CAL]) + session("near", "A", "B", more=[CAL])
    toml += session("run", "C", "D", more=[SURVEY])
    toml += session("named", "D", "C", more=[SURVEY, 'constant_choice = "line:P-Q"'])
    books = {
        "far": azimuths("0-02-30"),
        "near": azimuths("0-00-05"),
        "run": azimuths("90-00-00"),
        "named": azimuths("270-00-00"),
    }
    result = api.orient(write(tmp_path, toml, books, head=TM)).to_dict()
    near, named = result["lines"]
    assert near["constant"]["choice"] == "nearest (line:A-B)"
    assert near["constant"]["arcsec"] == pytest.approx(-5.0, abs=0.01)
    assert named["constant"]["choice"] == "line:P-Q"
    assert named["constant"]["arcsec"] == pytest.approx(
        result["constants"][0]["by_line"][0]["arcsec"]
    )


def test_unknown_line_names_the_known_ones(tmp_path: Path) -> None:
    toml = four_stations() + GYRO + session("cal", "A", "B", more=[CAL])
    toml += session("run", "C", "D", more=[SURVEY, 'constant_choice = "line:B-A"'])
    books = {"cal": azimuths("0-00-00"), "run": azimuths("90-00-00")}
    with pytest.raises(SurveyError, match="line:A-B"):
        api.orient(write(tmp_path, toml, books, head=TM))


def test_known_constant_alone_and_as_a_check(tmp_path: Path) -> None:
    known = "constant = { arcsec = -9.7, sigma_arcsec = 3.0 }\n"
    toml = four_stations() + GYRO + known + session("run", "C", "D", more=[SURVEY])
    alone = api.orient(write(tmp_path, toml, {"run": azimuths("90-00-00")}, head=TM)).to_dict()
    assert alone["lines"][0]["constant"] == {
        "arcsec": pytest.approx(-9.7),
        "sigma_arcsec": pytest.approx(3.0),
        "choice": "known",
        "if_drifting_interval95_arcsec": None,
    }
    toml += session("cal", "A", "B", more=[CAL])
    books = {"run": azimuths("90-00-00"), "cal": azimuths("0-01-00")}
    both = api.orient(write(tmp_path / "both", toml, books, head=TM))
    assert both.constants[0].to_dict()["arcsec"] == pytest.approx(-60.0, abs=0.01)
    check = next(check for check in both.checks if check.rule == "constant.known")
    assert check.passed is False


def test_forward_and_back_are_compared(tmp_path: Path) -> None:
    toml = four_stations() + GYRO + session("cal", "A", "B", more=[CAL])
    toml += session("fore", "C", "D", more=[SURVEY]) + session("back", "D", "C", more=[SURVEY])
    books = {
        "cal": azimuths("0-00-00"),
        "fore": azimuths("90-00-00"),
        "back": azimuths("270-00-00"),
    }
    result = api.orient(write(tmp_path, toml, books, head=TM))
    assert len(result.lines) == 2
    check = next(check for check in result.checks if check.rule == "line.forward_back")
    # the meridians of C and D, 300 m apart, differ by 10.7" at this latitude: convergence does it
    assert check.passed is True
    assert check.value == pytest.approx(
        300 * math.tan(math.radians(47.82)) / 6.385e6 * 206264.8, abs=0.1
    )


def test_sessions_of_one_line_are_combined_and_their_scatter_counts(tmp_path: Path) -> None:
    toml = four_stations() + GYRO
    toml += "".join(session(f"r{i}", "C", "D", more=[SURVEY]) for i in range(4))
    books = {
        f"r{i}": azimuths(v) for i, v in enumerate(["90-00-00", "90-01-00", "90-00-10", "89-59-20"])
    }
    result = api.orient(write(tmp_path, toml, books, head=TM))
    line = result.lines[0]
    assert line.rounds == 4
    assert math.degrees(line.gyro_azimuth.value) == pytest.approx(90.0 + 7.5 / 3600, abs=1e-6)
    # scatter of the four about their mean, divided by two
    values = [0.0, 60.0, 10.0, -40.0]
    spread = math.sqrt(sum((v - 7.5) ** 2 for v in values) / 3) / 2
    assert line.gyro_azimuth.sigma * 206264.806 == pytest.approx(spread, rel=0.02)
    assert not result.passed


def test_grid_with_axes_west_and_south_gives_directions_from_south(tmp_path: Path) -> None:
    toml = (
        '[[station]]\nname = "A"\ny_west = -20000.0\nx_south = 2900000.0\n'
        '[[station]]\nname = "B"\ny_west = -20000.0\nx_south = 2900200.0\n'
    )
    toml += GYRO + "constant = { arcsec = 0.0, sigma_arcsec = 1.0 }\n"
    toml += session("run", "A", "B", more=[SURVEY])
    head = 'crs = "EPSG:2053"\n'
    folder = write(tmp_path, toml, {"run": azimuths("179-54-00")}, head=head)
    line = api.orient(folder).lines[0].to_dict()
    # 20 km east of the central meridian in the south: convergence negative
    assert line["convergence_arcsec"] < -300.0
    assert line["direction_from_south"] == pytest.approx((line["grid_azimuth"]["deg"] + 180) % 360)
    assert (
        abs(line["direction_from_south"] - (360 if line["direction_from_south"] > 180 else 0)) < 0.1
    )


def test_without_crs_and_constant_the_rest_still_works(tmp_path: Path) -> None:
    toml = '[[station]]\nname = "A"\n[[station]]\nname = "B"\n' + GYRO
    toml += session("run", "A", "B", more=[SURVEY])
    result = api.orient(write(tmp_path, toml, {"run": azimuths("10-00-00")}))
    line = result.lines[0].to_dict()
    assert line["gyro_azimuth"]["deg"] == pytest.approx(10.0)
    assert line["true_azimuth"] is None
    assert line["convergence_arcsec"] is None
    codes = {warning.code for warning in result.warnings}
    assert {"no_constant", "no_grid", "latitude_unknown", "centring_unknown"} <= codes
    with pytest.raises(SurveyError, match="A-B"):
        api.orient(tmp_path, line="A-B")


def test_latitude_82_is_refused_and_72_warns(tmp_path: Path) -> None:
    for latitude, ok in ((82.0, False), (72.0, True), (-72.0, True)):
        toml = f'[[station]]\nname = "A"\nlat = {latitude}\nlon = 20.0\n[[station]]\nname = "B"\n'
        toml += GYRO + session("run", "A", "B", more=[SURVEY])
        folder = write(tmp_path / str(latitude), toml, {"run": azimuths("10-00-00")})
        if ok:
            codes = {warning.code for warning in api.orient(folder).warnings}
            assert "latitude_high" in codes
        else:
            with pytest.raises(SurveyError, match="75 degrees"):
                api.orient(folder)


def test_three_points_take_the_sigma_of_the_card(tmp_path: Path) -> None:
    toml = '[[station]]\nname = "A"\nlat = 47.0\nlon = 9.0\n' + GYRO
    toml += (
        '[[orientation]]\nid = "run"\nstation = "A"\ninstrument = "G1"\nmethod = "tracking"\n'
        'purpose = "survey"\nbook = "observations/run.csv"\n'
    )
    book = rows("reversal,359-30-00", "reversal,0-31-00", "reversal,359-30-20")
    session_result = api.orient(write(tmp_path, toml, {"run": book})).sessions[0].to_dict()
    # (u1 + 2 u2 + u3) / 4 across 0/360, sigma sqrt(6)/4 of the card's 5"
    assert session_result["gyro_north"]["deg"] == pytest.approx(
        (30 + 5 / 60) / 60 * 0 + 35 / 3600, abs=1e-9
    )
    assert session_result["sigma_source"] == "card"
    assert session_result["gyro_north"]["sigma_arcsec"] == pytest.approx(5 * 6**0.5 / 4, rel=1e-4)
    assert session_result["interval95_arcsec"] == pytest.approx(1.96 * 5 * 6**0.5 / 4, rel=1e-3)


def test_tape_zero_moves_north_by_minus_lambda_mu_d_at_the_stations_latitude(
    tmp_path: Path,
) -> None:
    toml = '[[station]]\nname = "A"\nlat = 60.0\nlon = 9.0\n' + GYRO
    toml += (
        '[[orientation]]\nid = "run"\nstation = "A"\ninstrument = "G1"\nmethod = "tracking"\n'
        'purpose = "survey"\nbook = "observations/run.csv"\n'
    )
    zeros = ["tape_zero,5.5", "tape_zero,-4.5", "tape_zero,5.5"]
    swing = [f"reversal,{v}" for v in ("99-00-00", "101-00-00", "99-00-00")]
    result = api.orient(write(tmp_path, toml, {"run": rows(*zeros, *swing, *zeros)}))
    item = result.sessions[0].to_dict()
    # physics.md 1.3: lambda(47) = (425.4/388.3)^2 - 1 = 0.2002, at 60 degrees times 0.682/0.5
    ratio = ((425.4 / 388.3) ** 2 - 1) * math.cos(math.radians(47)) / 0.5
    assert item["tape_zero_correction_arcsec"] == pytest.approx(-ratio * 600.0 * 0.5, abs=1e-6)
    north = 100.0 + item["tape_zero_correction_arcsec"] / 3600.0
    assert item["gyro_north"]["deg"] == pytest.approx(north, abs=1e-9)
    check = next(check for check in result.checks if check.rule == "tape_zero.limit")
    assert check.passed is True


def test_the_cards_own_coefficient_wins_and_follows_the_latitude(tmp_path: Path) -> None:
    card = CARD + "correction_arcsec_per_div = -130.0\nlatitude_deg = 47.0\n"
    toml = '[[station]]\nname = "A"\nlat = 60.0\nlon = 9.0\n' + GYRO
    toml += (
        '[[orientation]]\nid = "run"\nstation = "A"\ninstrument = "G1"\nmethod = "tracking"\n'
        'purpose = "survey"\nbook = "observations/run.csv"\n'
    )
    zeros = ["tape_zero,5.5", "tape_zero,-4.5", "tape_zero,5.5"]
    swing = [f"reversal,{v}" for v in ("99-00-00", "101-00-00", "99-00-00")]
    folder = write(tmp_path, toml, {"run": rows(*zeros, *swing)}, card=card)
    item = api.orient(folder).sessions[0].to_dict()
    expected = -130.0 * 0.5 * math.cos(math.radians(47)) / 0.5
    assert item["tape_zero_correction_arcsec"] == pytest.approx(expected, abs=1e-6)
