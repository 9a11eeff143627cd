"""The traverse book: columns, units, sigmas, centring, gyro rows, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.network import adjust
from surveyapp.core.network.centring import angle_centring, direction_centring
from surveyapp.core.network.traverse_network import network_of
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import GyroConstant, OrientedLine, Status
from surveyapp.errors import SurveyError

K = ObservationKind
ARC = math.pi / 648000.0

STATIONS = """
[[station]]
name = "A"
e = 1000.0
n = 2000.0
h = 10.0
fixed = true

[[station]]
name = "B"
e = 1000.0
n = 2100.0
h = 11.0
fixed = true

[[station]]
name = "C"

[[station]]
name = "D"
"""
TRAVERSE = """
[[traverse]]
name = "main"
book = "observations/main.csv"
class = "15sec"
sigma_angle_arcsec = 7.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
centring_mm = { instrument = 1.0, target = 1.0 }
atmosphere_applied = true
constant_applied = true
"""
BOOK = """kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note
angle,B,A,C,90-00-00,dms,,,,,,
distance,B,,C,50.000,m,,,,,,
angle,C,B,D,200.0,gon,2,mgon,,,,straight on
distance,C,,D,80.000,,3,mm,,,,
distance,D,,C,80.001,,1+5,mm+ppm,,,,
"""


def project(tmp_path: Path, book: str = BOOK, header: str = TRAVERSE) -> Path:
    (tmp_path / "observations").mkdir(exist_ok=True)
    (tmp_path / "observations" / "main.csv").write_text(book, encoding="utf-8")
    head = 'format = 1\nname = "T"\nangle_unit = "dms"\n'
    (tmp_path / "project.toml").write_text(head + STATIONS + header, encoding="utf-8")
    return tmp_path


def test_values_sigmas_and_centring(tmp_path: Path) -> None:
    network = network_of(api.open_project(project(tmp_path)), "main")
    first, length, straight, plain, ppm = network.observations
    assert first.value == pytest.approx(math.pi / 2)
    centring = angle_centring(100.0, 50.0, math.pi / 2, instrument_m=1e-3, target_m=1e-3)
    assert first.sigma == pytest.approx(math.sqrt((7 * ARC) ** 2 + centring))
    # 2 mm and 2 ppm of 50 m in quadrature, both ends centred within 1 mm
    assert length.sigma == pytest.approx(math.sqrt(2e-3**2 + 1e-4**2 + 2 * 1e-3**2))
    assert straight.sigma == pytest.approx(2 * math.pi / 200_000)
    assert plain.sigma == pytest.approx(3e-3)
    assert ppm.sigma == pytest.approx(math.hypot(1e-3, 5e-6 * 80.001))
    assert {p.name: p.status_e for p in network.points} == {
        "A": Status.FIXED,
        "B": Status.FIXED,
        "C": Status.FREE,
        "D": Status.FREE,
    }


def test_a_fifty_metre_sight_with_a_millimetre_is_four_arcsec() -> None:
    variance = direction_centring(50.0, instrument_m=0.0, target_m=1e-3)
    assert math.sqrt(variance) / ARC == pytest.approx(4.1, abs=0.05)
    # a straight angle between two 50 m sides: the instrument's millimetre counts twice
    both = angle_centring(50.0, 50.0, math.pi, instrument_m=1e-3, target_m=0.0)
    assert math.sqrt(both) / ARC == pytest.approx(2 * 4.125, abs=0.05)


def test_the_whole_way_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = project(tmp_path)
    result = api.adjust(folder)
    c = result.point("C")
    assert (c.e, c.n) == pytest.approx((950.0, 2100.0), abs=1e-3)  # clockwise 90 from south
    assert result.dof == 1
    assert main(["adjust", str(folder)]) == 0
    assert "Points" in capsys.readouterr().out
    assert main(["adjust", str(folder), "--json", "--traverse", "main"]) == 0
    out = capsys.readouterr().out
    assert '"schema": "surveyapp.adjust/1"' in out
    assert "NaN" not in out
    assert main(["adjust", str(folder), "--traverse", "mian"]) == 2
    assert "main" in capsys.readouterr().err


def test_check_answers_what_the_rule_book_asks_of_traverses(tmp_path: Path) -> None:
    book = BOOK + "angle,B,A,C,90-00-25,dms,,,,,,last angle again\n"
    folder = project(tmp_path, book)
    text = (folder / "project.toml").read_text(encoding="utf-8")
    text = text.replace('name = "T"', 'name = "T"\nrule_book = "cn-coal-15"', 1)
    (folder / "project.toml").write_text(text, encoding="utf-8")
    checks = {check.rule: check for check in api.check(folder)}
    again = [c for c in checks.values() if c.unit == "arcsec" and c.where == "A-B-C"]
    assert [round(c.value or 0.0) for c in again] == [25]
    assert again[0].limit == 40.0  # the 15" class
    assert again[0].passed is True
    assert checks["traverse.forward_back"].where == "C-D"
    assert checks["traverse.forward_back"].value == pytest.approx(1.0)


GYRO = BOOK + "gyro,C,,D,,,,,,,,\n"


def test_gyro_rows_take_their_value_from_the_sessions(tmp_path: Path) -> None:
    opened = api.open_project(project(tmp_path, GYRO))
    lines = (
        OrientedLine("C", "D", 4.70, 15 * ARC, "G1", 0.01, ((1, 20 * ARC**2),)),
        OrientedLine("C", "D", 4.7001, 15 * ARC, "G1", 0.01, ((0, 20 * ARC**2),)),
    )
    network = network_of(opened, "main", lines, (GyroConstant("G1", 5 * ARC, 3 * ARC),))
    sides = [obs for obs in network.observations if obs.kind is K.GYRO]
    assert [obs.value for obs in sides] == [4.70, 4.7001]
    assert sides[0].convergence == 0.01
    assert network.constants == (GyroConstant("G1", 5 * ARC, 3 * ARC),)
    assert network.blocks[0].covariance[0][1] == pytest.approx(20 * ARC**2)
    assert adjust(network).dof == 1 + 2


def test_a_gyro_row_without_a_session_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="no session has oriented"):
        network_of(api.open_project(project(tmp_path, GYRO)), "main")


def test_space_traverses_reduce_by_their_zenith_angles(tmp_path: Path) -> None:
    book = """kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note
direction,B,,A,0-00-00,dms,5,arcsec,1,1.5,1.3,
direction,B,,C,90-00-00,dms,5,arcsec,1,1.5,1.3,
slope_distance,B,,C,100.000,,2,mm,,1.5,1.3,
zenith,B,,C,60-00-00,dms,5,arcsec,,1.5,1.3,
slope_distance,C,,B,100.230,,2,mm,,1.6,1.4,
zenith,C,,B,120-00-00,dms,5,arcsec,,1.6,1.4,
"""
    result = api.adjust(project(tmp_path, book))
    c = result.point("C")
    assert c.h == pytest.approx(11.0 + 50.0 + 1.5 - 1.3, abs=0.2)
    assert c.sigma_h is not None
    assert c.n == pytest.approx(2100.0, abs=1e-6)


def test_heights_without_a_fixed_one_are_relative_and_say_so(tmp_path: Path) -> None:
    book = (
        "kind,at,to,value,sigma,sigma_unit\nheight_difference,C,D,1.5,1,mm\n"
        "height_difference,D,C,-1.502,1,mm\n"
    )
    network = network_of(api.open_project(project(tmp_path, book)), None)
    assert [warning.code for warning in network.warnings] == ["heights_relative"]
    assert adjust(network).point("D").h == pytest.approx(1.501)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("angle,B,A,X,90-00-00,dms,,,,,,", "no station"),
        ("angle,B,A,A,90-00-00,dms,,,,,,", "same"),
        ("angle,B,A,C,90-00-00,gon,,,,,,", "no angle"),
        ("angle,B,A,C,90-00-00,mm,,,,,,", "wrong unit"),
        ("distance,B,,C,50,ft,,,,,,", "wrong unit"),
        ("distance,B,,C,0,m,,,,,,", "no length"),
        ("distance,B,,B,10,m,,,,,,", "itself"),
        ("distance,B,,C,10,m,3,arcsec,,,,", "wrong unit"),
        ("distance,B,,C,10,m,-3,mm,,,,", "not positive"),
        ("distance,B,,C,10,m,3,mm+ppm,,,,", "mm+ppm"),
        ("distanz,B,,C,10,m,,,,,,", "not known"),
        ("zenith,B,,C,270-00-00,dms,,,,,,", "zenith"),
        ("height_difference,B,,C,1.0,m,,,,,,", "standard deviation"),
        ("distance,B,,C,,m,,,,,,", "missing"),
        ("distance,B,,C,1,5,m,,,,,,,", "more values"),
    ],
)
def test_bad_rows_are_refused_with_their_line(row: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(SurveyError) as refused:
        api.adjust(project(tmp_path, BOOK + row + "\n"))
    assert words in str(refused.value)
    assert "line 7" in str(refused.value)


def test_all_problems_of_a_book_come_together(tmp_path: Path) -> None:
    rows = "distance,B,,C,0,m,,,,,,\nangle,B,A,A,90-00-00,dms,,,,,,\n"
    with pytest.raises(SurveyError) as refused:
        api.adjust(project(tmp_path, BOOK + rows))
    assert len(refused.value.problems) == 2


def test_header_problems(tmp_path: Path) -> None:
    bad = TRAVERSE.replace("sigma_angle_arcsec = 7.0", 'sigma_angle_arcsec = "x"')
    with pytest.raises(SurveyError, match="sigma_angle_arcsec"):
        api.adjust(project(tmp_path, BOOK, bad))
    with pytest.raises(SurveyError, match="no column"):
        api.adjust(project(tmp_path, "kind,at,to\n"))
    with pytest.raises(SurveyError, match="semicolons"):
        api.adjust(project(tmp_path, "kind;at;to;value\n"))
