"""project.toml: every table, every refusal, and all problems together."""

import math
from pathlib import Path

import pytest

from surveyapp.domain.constant_choice import ConstantChoice
from surveyapp.domain.project import Centring, Project
from surveyapp.domain.station_line import StationLine
from surveyapp.errors import SurveyError
from surveyapp.io.files import MAX_BYTES
from surveyapp.io.project import read_project
from surveyapp_models.angles import ARCSEC

BOOK = (
    "seq,kind,value,target\n1,reversal,179-00-00,\n2,reversal,181-00-00,\n3,reversal,179-02-00,\n"
)
TOML = """\
format = 1
name = "Ramp 3"
crs = "EPSG:4546"
angle_unit = "dms"
rule_book = "cn-coal-15"
centring_mm = { instrument = 0.5, target = 2.0 }

[[instrument]]
id = "G1"
card = "wild-gak1"
serial = 3139
scale_value_arcsec = 590
sigma = { reversal_arcsec = 8.0 }
constant = { arcsec = -9.7, sigma_arcsec = 3.0 }
constant_choice = "known"

[[instrument.effect]]
id = "temperature"
coefficients = { a = { value = 1.5, sigma = 0.2, unit = "arcsec/C" } }
grid = { tau_s = 600.0 }
covariance = [[0.04]]
valid = { temperature_c = [5.0, 20.0] }
sha256 = "00ff"
before = 20.0
after = 5.0
confirm = 6.0
adopted_at = 2026-11-22T10:00:00Z
software = "0.1.0"

[[station]]
name = "30-83"
e = 431630.663
n = 3811452.311
h = 812.5
fixed = true
deflection = { xi_arcsec = 1.0, eta_arcsec = -2.0, sigma_arcsec = 0.5 }

[[station]]
name = "3082"
y_west = 100.5
x_south = 200.5

[[station]]
name = "C"
lat = -26.19
lon = 28.03

[[orientation]]
id = "r1"
station = "30-83"
target = "3082"
instrument = "G1"
method = "tracking"
purpose = "calibration"
azimuth_known = "246-52-09"
constant_choice = "line:30-83-3082"
date = 2015-10-26
order = 2
circle_shift = "60-00-00"
observer = "N. N."
reference_temperature_c = 12.5
resolution_arcsec = 2.0
eccentric = { distance_m = 0.5, direction = "10-00-00", at = "target", sigma_m = 0.001 }
centring_mm = { instrument = 1.0, target = 3.0 }
rounds = 3
sigma_arcsec = 4.5
weather = "dry"
book = "observations/r1.csv"

[[orientation.effect]]
id = "midpoint_drift"

[[traverse]]
name = "main"
book = "observations/main.csv"

[[sensor_log]]
id = "far"
file = "../elsewhere/far.csv"
sha256 = "abcd"

[penetration]
case = "opposite"
"""


def make(folder: Path, toml: str = TOML, book: str = BOOK) -> Path:
    (folder / "observations").mkdir(parents=True, exist_ok=True)
    (folder / "project.toml").write_text(toml, encoding="utf-8")
    (folder / "observations" / "r1.csv").write_text(book, encoding="utf-8")
    (folder / "observations" / "main.csv").write_text("kind,at,to,value\n", encoding="utf-8")
    return folder


def changed(folder: Path, old: str, new: str) -> Project:
    assert old in TOML
    return read_project(make(folder, TOML.replace(old, new)))


def refused(folder: Path, old: str, new: str) -> str:
    with pytest.raises(SurveyError) as caught:
        changed(folder, old, new)
    assert len(caught.value.problems) == 1, str(caught.value)
    return str(caught.value)


def test_every_key_arrives_in_si(tmp_path: Path) -> None:
    project = read_project(make(tmp_path))
    assert (project.name, project.crs, project.rule_book) == ("Ramp 3", "EPSG:4546", "cn-coal-15")
    assert project.centring == Centring(0.0005, 0.002, known=True)
    first, second, third = project.stations
    assert (first.e, first.n, first.h, first.fixed) == (431630.663, 3811452.311, 812.5, True)
    assert first.deflection.xi == pytest.approx(ARCSEC)
    assert first.deflection.eta == pytest.approx(-2 * ARCSEC)
    assert first.deflection.sigma == pytest.approx(0.5 * ARCSEC)
    assert first.deflection.known is True
    assert (second.e, second.n) == (-100.5, -200.5)
    assert second.deflection.known is False
    assert (third.latitude, third.longitude) == pytest.approx(
        (math.radians(-26.19), math.radians(28.03))
    )
    assert project.penetration is not None
    assert [item.name for item in project.traverses] == ["main"]
    assert [item.id for item in project.sensor_logs] == ["far"]


def test_the_instrument_holds_card_override_and_effect(tmp_path: Path) -> None:
    instrument = read_project(make(tmp_path)).instrument("G1")
    assert instrument.serial == "3139"
    assert instrument.card.scale_value == pytest.approx(590 * ARCSEC)
    assert instrument.card.sigma.reversal == pytest.approx(8 * ARCSEC)
    assert instrument.card.sigma.azimuth is not None
    assert instrument.known_constant == pytest.approx((-9.7 * ARCSEC, 3 * ARCSEC))
    (effect,) = instrument.effects
    assert effect.coefficients == (("a", 1.5, 0.2, "arcsec/C"),)
    assert effect.grid == (("tau_s", 600.0),)
    assert effect.covariance == ((0.04,),)
    assert effect.valid == (("temperature_c", 5.0, 20.0),)
    assert (effect.before, effect.after, effect.confirm) == (20.0, 5.0, 6.0)


def test_the_session_holds_everything(tmp_path: Path) -> None:
    project = read_project(make(tmp_path))
    session = project.session("r1")
    assert session.azimuth_known == pytest.approx(math.radians(246 + 52 / 60 + 9 / 3600))
    assert session.circle_shift == pytest.approx(math.radians(60))
    assert session.resolution == pytest.approx(2 * ARCSEC)
    assert session.order == 2.0
    assert session.eccentric is not None
    assert (session.eccentric.distance_m, session.eccentric.at) == (0.5, "target")
    assert session.constant_choice == ConstantChoice("line", line=StationLine("30-83", "3082"))
    override = dict(session.override)
    assert (override["rounds"], override["sigma_arcsec"], override["weather"]) == (3, 4.5, "dry")
    assert override["centring"] == Centring(0.001, 0.003, known=True)
    assert [e.id for e in session.effects] == ["midpoint_drift"]
    assert len(session.book.live) == 3
    assert [w.code for w in project.warnings] == ["unknown_key", "empty_book"]
    assert "weather" in project.warnings[0].text


def test_unknown_keys_name_the_nearest_and_do_no_harm(tmp_path: Path) -> None:
    project = changed(tmp_path, "observer =", "obsever =")
    texts = [w.text for w in project.warnings if "obsever" in w.text]
    assert len(texts) == 1
    assert "Did you mean observer" in texts[0]
    project = changed(tmp_path, "[penetration]", "[penetratoin]")
    assert any("Did you mean penetration" in w.text for w in project.warnings)


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("format = 1\n", "", "format is missing"),
        ("format = 1", "format = 2", "newer version"),
        ("format = 1", 'format = "1"', "format is not known"),
        ("format = 1", "format = 0", "format is not known"),
        ("format = 1", "format = true", "format is not known"),
        ('angle_unit = "dms"', 'angle_unit = "grad"', "dms | gon | deg"),
        ("lat = -26.19", "lat = -96.19", "out of range"),
        ("lon = 28.03", "lon = 208.03", "out of range"),
        ("lat = -26.19\n", "", "lon stands without lat"),
        ("x_south = 200.5", "x_south = inf", "no number"),
        ("y_west = 100.5", "e = 1.0\nn = 2.0\ny_west = 100.5", "given twice"),
        ("lat = -26.19", "e = 1.0\nn = 2.0\nlat = -26.19", "given twice"),
        ('name = "C"', 'name = "3082"', "of one name"),
        ('name = "C"', "name = 5", "no text"),
        ('target = "3082"', 'target = "3028"', "no station"),
        ('target = "3082"', 'target = "30-83"', "station itself"),
        ('instrument = "G1"', 'instrument = "G2"', "Did you mean G1"),
        ('card = "wild-gak1"', 'card = "wild-gak2"', "Did you mean wild-gak1"),
        ('card = "wild-gak1"', 'card = "own.toml"', "does not exist"),
        ('method = "tracking"', 'method = "trackng"', "Did you mean tracking"),
        ('method = "tracking"\n', "", "method is missing"),
        ('purpose = "calibration"', 'purpose = "calibrate"', "Did you mean calibration"),
        ('purpose = "calibration"\n', "", "without purpose"),
        ('azimuth_known = "246-52-09"', 'azimuth_known = "north"', "no angle"),
        ('azimuth_known = "246-52-09"', "azimuth_known = 246.5", "no angle"),
        ('azimuth_known = "246-52-09"', 'azimuth_known = "380-00-00"', "gon"),
        ('"line:30-83-3082"', '"line:30-83-3083"', "no line between stations"),
        ('"line:30-83-3082"', '"poold"', "Did you mean pooled"),
        ('constant_choice = "known"', 'constant_choice = "line:A"', "no line"),
        ("constant = { arcsec = -9.7, sigma_arcsec = 3.0 }", "constant = { arcsec = 1 }", "sigma"),
        ("constant = { arcsec = -9.7, sigma_arcsec = 3.0 }\n", "", "has no constant"),
        ("date = 2015-10-26", 'date = "26.10.2015"', "no date"),
        ("distance_m = 0.5, ", "", "distance_m is missing"),
        ('direction = "10-00-00", ', "", "direction is missing"),
        ("rounds = 3", "rounds = 2.5", "whole number"),
        ("covariance = [[0.04]]", "covariance = [[0.04, 1.0]]", "covariance"),
        ("[5.0, 20.0]", "[20.0, 5.0]", "no range"),
        ("fixed = true", 'fixed = "yes"', "true"),
        ("observations/r1.csv", "observations/r2.csv", "does not exist"),
        ("observations/main.csv", "observations/m.csv", "does not exist"),
        ("observations/r1.csv", "../r1.csv", "outside"),
        ("observations/r1.csv", "/etc/passwd", "outside"),
        ("observations/r1.csv", "observations", "folder"),
        ("observations/r1.csv", "a\\u0000b", "no usable text"),
        ('rule_book = "cn-coal-15"', 'rule_book = "own.toml"', "does not exist"),
        ("[[traverse]]", "[traverse]", "two brackets"),
    ],
)
def test_each_wrong_value_is_one_clear_problem(
    tmp_path: Path, old: str, new: str, word: str
) -> None:
    assert word in refused(tmp_path, old, new)


def test_problems_name_table_and_line(tmp_path: Path) -> None:
    line = TOML[: TOML.index("[[orientation]]")].count("\n") + 1
    assert f"project.toml line {line}, [[orientation]] r1" in refused(
        tmp_path, 'method = "tracking"', 'method = "x"'
    )


def test_a_syntax_error_names_its_line(tmp_path: Path) -> None:
    assert "line 2" in refused(tmp_path, 'name = "Ramp 3"', "name = Ramp 3")


def test_all_problems_of_project_and_books_come_together(tmp_path: Path) -> None:
    toml = TOML.replace("lat = -26.19", "lat = -96.19").replace('"tracking"', '"x"')
    book = "seq,kind,value,target\n1,reversal,x,\n2,backsight,10-00-00,3028\n"
    with pytest.raises(SurveyError) as caught:
        read_project(make(tmp_path, toml, book))
    assert len(caught.value.problems) == 3
    assert [p.where.split(",")[0] for p in caught.value.problems][-1] == "observations/r1.csv"


def test_a_target_of_the_book_that_is_no_station_names_the_nearest(tmp_path: Path) -> None:
    book = "seq,kind,value,target\n1,backsight,10-00-00,3028\n2,backsight,11-00-00,3028\n"
    with pytest.raises(SurveyError, match="Did you mean 3082") as caught:
        read_project(make(tmp_path, TOML, book))
    assert len(caught.value.problems) == 1
    assert caught.value.problems[0].where == "observations/r1.csv, line 2 (seq 1)"


def test_folders_that_are_no_project(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="empty"):
        read_project(tmp_path)
    with pytest.raises(SurveyError, match="does not exist"):
        read_project(tmp_path / "none")
    file = tmp_path / "file"
    file.write_text("x", encoding="utf-8")
    with pytest.raises(SurveyError, match="file and no project"):
        read_project(file)
    with pytest.raises(SurveyError, match=r"no project\.toml"):
        read_project(tmp_path)
    with pytest.raises(SurveyError, match=r"does not exist|cannot be read"):
        read_project(Path("a\0b"))


@pytest.mark.parametrize("name", ["project.toml", "observations/r1.csv"])
def test_binary_and_huge_files_are_refused(tmp_path: Path, name: str) -> None:
    make(tmp_path)
    (tmp_path / name).write_bytes(b"\x89PNG\x00\x00")
    with pytest.raises(SurveyError, match="binary"):
        read_project(tmp_path)
    (tmp_path / name).write_bytes("Gel\xe4nde\n".encode("latin-1"))
    with pytest.raises(SurveyError, match="UTF-8"):
        read_project(tmp_path)
    with (tmp_path / name).open("wb") as stream:
        stream.truncate(200_000_000)
    with pytest.raises(SurveyError, match=f"200 MB; expected at most {MAX_BYTES >> 20} MB"):
        read_project(tmp_path)


def test_a_device_is_no_book(tmp_path: Path) -> None:
    make(tmp_path)
    (tmp_path / "observations" / "r1.csv").unlink()
    (tmp_path / "observations" / "r1.csv").symlink_to("/dev/zero")
    with pytest.raises(SurveyError, match="no regular file"):
        read_project(tmp_path)


def test_the_digest_changes_with_every_named_file_and_only_with_those(tmp_path: Path) -> None:
    digest = read_project(make(tmp_path)).digest
    (tmp_path / "observations" / "other.csv").write_text("x", encoding="utf-8")
    assert read_project(tmp_path).digest == digest
    for name in ("observations/r1.csv", "observations/main.csv", "project.toml"):
        path = tmp_path / name
        old = path.read_bytes()
        path.write_bytes(old + b"\n")
        assert read_project(tmp_path).digest != digest
        path.write_bytes(old)
    assert read_project(tmp_path).digest == digest


def test_an_unpinned_sensor_log_is_part_of_the_digest(tmp_path: Path) -> None:
    toml = TOML.replace('file = "../elsewhere/far.csv"\nsha256 = "abcd"', 'file = "far.csv"')
    project = read_project(make(tmp_path, toml))
    assert "missing_file" in [w.code for w in project.warnings]
    (tmp_path / "far.csv").write_text("t\n1\n", encoding="utf-8")
    second = read_project(tmp_path)
    assert second.digest != project.digest
    assert "missing_file" not in [w.code for w in second.warnings]


def test_gon_projects_take_numbers_as_angles(tmp_path: Path) -> None:
    toml = TOML.replace('"dms"', '"gon"').replace('"246-52-09"', "274.2991")
    toml = toml.replace('"60-00-00"', '"66.6667"').replace('"10-00-00"', '"11.1"')
    book = "seq,kind,value\n1,reversal,199\n2,reversal,201\n"
    session = read_project(make(tmp_path, toml, book)).sessions[0]
    assert session.azimuth_known == pytest.approx(274.2991 * math.pi / 200)
    assert session.book.live[1].value == pytest.approx(201 * math.pi / 200)


def test_an_empty_book_is_a_warning(tmp_path: Path) -> None:
    project = read_project(make(tmp_path, book=""))
    assert "empty_book" in [w.code for w in project.warnings]


def test_two_sessions_of_one_book_are_a_warning(tmp_path: Path) -> None:
    second = TOML[TOML.index("[[orientation]]") : TOML.index("[[orientation.effect]]")]
    project = read_project(make(tmp_path, TOML + second.replace('"r1"', '"r2"', 1)))
    assert "shared_book" in [w.code for w in project.warnings]
