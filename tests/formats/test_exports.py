"""Every export is read back by somebody else's reader, or by one written from the format alone."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from datetime import UTC, datetime
from pathlib import Path

import ezdxf
import pytest

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.io.importers.gkf import read_gkf
from tests.cli.command import run
from tests.formats.importing import project
from tests.formats.landxml_schema import faults

MORE = """
crs = "EPSG:4546"
[[station]]
name = "A"
e = 431630.663
n = 3811452.311
h = 812.4
fixed = true
[[station]]
name = "B 1"
e = 431634.860
n = 3811581.143
h = 810.1
fixed = true
[[station]]
name = "C-1"
e = 431700.0
n = 3811600.0
[[station]]
name = "somewhere"
[[traverse]]
name = "main"
book = "observations/main.csv"
sigma_angle_arcsec = 5.0
sigma_distance = { mm = 2.0, ppm = 2.0 }
"""
BOOK = """kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht
angle,B 1,A,C-1,250-00-00,dms,,,,,
direction,A,,B 1,10-00-00,dms,,,1,,
direction,A,,C-1,34-00-10,dms,,,1,,
slope_distance,B 1,,C-1,80.1234,m,,,,1.512,1.402
zenith,B 1,,C-1,91-02-03,dms,,,,1.512,1.402
azimuth,B 1,,C-1,71-52-00,dms,20,arcsec,,,
height_difference,A,,C-1,-3.5412,m,3,mm,,,
"""


@pytest.fixture
def survey(tmp_path: Path) -> Path:
    folder = project(tmp_path / "p", MORE)
    (folder / "observations").mkdir()
    (folder / "observations" / "main.csv").write_text(BOOK, encoding="utf-8")
    return folder


def coordinates(folder: Path) -> dict[str, tuple[float, float, float]]:
    return {p.name: (p.e or 0.0, p.n or 0.0, p.h or 0.0) for p in api.adjust(folder).points}


def exported(folder: Path, form: str) -> str:
    path = folder.parent / f"out.{form}"
    result = run("export", form, str(folder), str(path), "--json")
    assert result.code == 0, result.err
    document = json.loads(result.out)
    codes = {item["code"] for item in document["warnings"]}
    assert "station_left_out" in codes
    return path.read_text(encoding="utf-8")


def test_dxf_is_read_by_ezdxf(survey: Path) -> None:
    exported(survey, "dxf")
    document = ezdxf.readfile(survey.parent / "out.dxf")  # type: ignore[attr-defined]
    assert document.dxfversion == "AC1009"
    assert not document.audit().has_errors
    space = document.modelspace()
    places = coordinates(survey)
    points = {tuple(round(x, 4) for x in entity.dxf.location) for entity in space.query("POINT")}
    assert points == {tuple(round(x, 4) for x in place) for place in places.values()}
    assert {entity.dxf.text for entity in space.query('TEXT[layer=="NAMES"]')} == set(places)
    layers = {layer.dxf.name for layer in document.layers}
    assert {"STATIONS", "NAMES", "SIDES", "ELLIPSES", "GYRO"} <= layers
    scale = space.query('TEXT[layer=="ELLIPSES"]').first.dxf.text
    factor = float(re.findall(r"enlarged (\d+) times", scale)[0])
    ring = space.query("POLYLINE").first
    assert ring.is_closed
    point = api.adjust(survey).point("C-1")
    assert point.ellipse is not None
    reach = [
        math.hypot(v.dxf.location.x - (point.e or 0.0), v.dxf.location.y - (point.n or 0.0))
        for v in ring.vertices
    ]
    assert max(reach) == pytest.approx(point.ellipse.a_m * factor, rel=0.01)
    assert min(reach) == pytest.approx(point.ellipse.b_m * factor, rel=0.01)
    assert (survey.parent / "out.dxf").read_bytes().isascii()


def test_dxf_opens_in_the_drawing_add_on_of_ezdxf(survey: Path) -> None:
    """The add-on draws every name and every mark: a picture of more than its frame."""
    from ezdxf.addons.drawing import config, layout
    from ezdxf.addons.drawing.frontend import Frontend
    from ezdxf.addons.drawing.properties import RenderContext
    from ezdxf.addons.drawing.svg import SVGBackend

    exported(survey, "dxf")
    document = ezdxf.readfile(survey.parent / "out.dxf")  # type: ignore[attr-defined]
    backend = SVGBackend()
    shown = config.Configuration(background_policy=config.BackgroundPolicy.WHITE)
    Frontend(RenderContext(document), backend, config=shown).draw_layout(document.modelspace())
    page = layout.Page(0, 0, layout.Units.mm, max_width=200, max_height=200)
    picture = backend.get_string(page)
    assert picture.startswith("<?xml") or "<svg" in picture
    assert picture.count("<path") > 2 * len(coordinates(survey))
    assert document.header["$PDMODE"] == 34


def test_landxml_has_what_the_schema_demands(survey: Path) -> None:
    text = exported(survey, "landxml")
    root = ET.fromstring(text)
    space = "{http://www.landxml.org/schema/LandXML-1.2}"
    assert root.tag == f"{space}LandXML"
    assert root.attrib["version"] == "1.2"
    datetime.strptime(root.attrib["date"], "%Y-%m-%d").replace(tzinfo=UTC)
    datetime.strptime(root.attrib["time"], "%H:%M:%S").replace(tzinfo=UTC)
    order = [child.tag.removeprefix(space) for child in root]
    assert order == ["Units", "CoordinateSystem", "Project", "Application", "CgPoints"]
    metric = root.find(f"{space}Units/{space}Metric")
    assert metric is not None
    demanded = ("areaUnit", "linearUnit", "volumeUnit", "temperatureUnit", "pressureUnit")
    assert all(name in metric.attrib for name in demanded)
    assert metric.attrib["linearUnit"] == "meter"
    assert faults(root) == []
    places = coordinates(survey)
    found = {
        point.attrib["name"]: [float(x) for x in (point.text or "").split()]
        for point in root.iter(f"{space}CgPoint")
    }
    for name, (e, n, h) in places.items():
        assert found[name] == pytest.approx([n, e, h], abs=5.1e-5)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('linearUnit="meter"', 'linearUnit="metre"'),
        (' pressureUnit="HPA"', ""),
        ("<CgPoints>", '<CgPoints colour="red">'),
        (' date="', ' day="'),
        ("</CgPoint>", " 1.0 2.0</CgPoint>"),
        ("<Project ", "<Projekt "),
    ],
)
def test_the_check_of_the_schema_finds_what_is_wrong(survey: Path, old: str, new: str) -> None:
    text = exported(survey, "landxml")
    assert old in text
    assert faults(ET.fromstring(text.replace(old, new)))


def test_gsi_by_the_layout_of_the_words(survey: Path) -> None:
    exported(survey, "gsi")
    data = (survey.parent / "out.gsi").read_bytes()
    places = coordinates(survey)
    lines = data.decode().split("\r\n")
    assert lines.pop() == ""
    for line, (name, place) in zip(lines, places.items(), strict=True):
        assert line[0] == "*"
        words = [line[1 + 24 * i : 24 + 24 * i] for i in range(4)]
        assert [word[:2] for word in words] == ["11", "81", "82", "83"]
        assert words[0][7:].lstrip("0") == name
        for word, value in zip(words[1:], place, strict=True):
            assert word[5] == "6"  # 1/10 mm
            assert int(word[6:]) / 1e4 == pytest.approx(value, abs=5.1e-5)


def test_sdr_by_the_layout_of_its_columns(survey: Path) -> None:
    exported(survey, "sdr")
    lines = (survey.parent / "out.sdr").read_bytes().decode().split("\r\n")
    assert lines[0][:20].rstrip() == "00NMSDR33 V04-04.02"
    assert lines[0][40:46] == "111111"
    places = coordinates(survey)
    for line in (x for x in lines if x.startswith("08")):
        e, n, h = places[line[4:20].strip()]
        values = [float(line[20 + 16 * i : 36 + 16 * i]) for i in range(3)]
        assert values == pytest.approx([n, e, h], abs=5.1e-5)


def _seconds(text: str) -> float:
    degrees, minutes, seconds = text.split("-")
    return float(degrees) + float(minutes) / 60 + float(seconds) / 3600


def test_starnet_is_the_same_network(survey: Path) -> None:
    """An own reader of the manual's codes: every observation with value, sigma and heights."""
    lines = exported(survey, "starnet").splitlines()
    assert lines[1:5] == [".3D", ".UNITS METERS DMS", ".ORDER EN ATFROMTO", ".DELTA OFF"]
    codes: dict[str, list[list[str]]] = {}
    delta = "OFF"
    for line in lines:
        parts = line.split()
        if parts[0] == ".DELTA":
            delta = parts[1]
        codes.setdefault(parts[0], []).append([*parts[1:], delta])
    fixed = {row[0]: row for row in codes["C"]}
    assert fixed["A"][1:7] == ["431630.6630", "3811452.3110", "812.4000", "!", "!", "!"]
    assert "!" not in fixed["C_1"]
    network = {obs.kind: obs for obs in api.network(survey).observations}
    arc = 180.0 / math.pi * 3600
    row = codes["A"][0]
    assert row[0] == "B_1-A-C_1"
    assert _seconds(row[1]) == pytest.approx(250.0)
    assert float(row[2]) == pytest.approx(network["angle"].sigma * arc, abs=1e-3)  # type: ignore[index]
    row = codes["D"][0]
    assert (row[0], row[1], row[3], row[-1]) == ("B_1-C_1", "80.12340", "1.5120/1.4020", "OFF")
    row = codes["V"][0]
    assert _seconds(row[1]) == pytest.approx(91 + 2 / 60 + 3 / 3600)
    row = codes["L"][0]
    assert (row[0], row[1], row[2], row[-1]) == ("A-C_1", "-3.54120", "0.00300", "ON")
    assert codes["DB"][0][0] == "A"
    assert [row[0] for row in codes["DM"]] == ["B_1", "C_1"]
    assert len(codes["DE"]) == 1
    assert codes["B"][0][0] == "B_1-C_1"
    assert float(codes["B"][0][2]) == pytest.approx(20.0)


def test_maps_have_longitude_first_and_the_grids_own_inverse(survey: Path) -> None:
    from pyproj import Transformer

    document = json.loads(exported(survey, "geojson"))
    back = Transformer.from_crs("EPSG:4490", "EPSG:4546", always_xy=True)
    places = coordinates(survey)
    points = [x for x in document["features"] if x["geometry"]["type"] == "Point"]
    assert {x["properties"]["name"] for x in points} == set(places)
    for item in points:
        e, n = back.transform(*item["geometry"]["coordinates"])
        assert (e, n) == pytest.approx(places[item["properties"]["name"]][:2], abs=1e-3)
    root = ET.fromstring(exported(survey, "kml"))
    space = "{http://www.opengis.net/kml/2.2}"
    marks = [m for m in root.iter(f"{space}Placemark") if m.find(f"{space}Point") is not None]
    texts = {
        m.findtext(f"{space}name"): m.findtext(f"{space}Point/{space}coordinates") for m in marks
    }
    for item in points:
        longitude, latitude = (texts[item["properties"]["name"]] or "").split(",")
        assert [float(longitude), float(latitude)] == item["geometry"]["coordinates"]


def test_a_map_needs_a_place_on_the_earth(tmp_path: Path) -> None:
    folder = project(tmp_path / "p", '[[station]]\nname = "A"\ne = 1.0\nn = 2.0\n')
    result = run("export", "kml", str(folder), str(tmp_path / "o.kml"), "--json")
    assert result.code == 2
    assert not (tmp_path / "o.kml").exists()


@pytest.mark.parametrize("form", ["gsi", "sdr"])
def test_names_are_never_cut(tmp_path: Path, form: str) -> None:
    folder = project(tmp_path / "p", '[[station]]\nname = "a name beyond 16"\ne = 1.0\nn = 2.0\n')
    assert run("export", form, str(folder), str(tmp_path / "o")).code == 0
    folder = project(tmp_path / "q", '[[station]]\nname = "a name beyond 16x"\ne = 1.0\nn = 2.0\n')
    assert run("export", form, str(folder), str(tmp_path / "o")).code == 2


def test_names_that_gsi_cannot_tell_apart_are_refused(tmp_path: Path) -> None:
    more = "".join(f'[[station]]\nname = "{name}"\ne = 1.0\nn = 2.0\n' for name in ("7", "007"))
    folder = project(tmp_path / "p", more)
    result = run("export", "gsi", str(folder), str(tmp_path / "o"), "--json")
    assert result.code == 2
    assert "7, 007" in result.out
    assert not (tmp_path / "o").exists()
    assert run("export", "sdr", str(folder), str(tmp_path / "o")).code == 0


def test_letters_beyond_the_first_plane_keep_their_number(tmp_path: Path) -> None:
    """U+20BB7, a name of Japan, in UTF-16: D842 DFB7 (Unicode standard, table 3-5)."""
    folder = project(tmp_path / "p", '[[station]]\nname = "\U00020bb7"\ne = 1.0\nn = 2.0\n')
    assert run("export", "dxf", str(folder), str(tmp_path / "o")).code == 0
    assert "\\U+D842\\U+DFB7" in (tmp_path / "o").read_text(encoding="ascii")


def test_names_of_starnet_stay_apart(tmp_path: Path) -> None:
    more = "".join(
        f'[[station]]\nname = "{name}"\ne = 1.0\nn = 2.0\n' for name in ("A 1", "A-1", "a_1", "Ö")
    )
    folder = project(tmp_path / "p", more)
    result = api.export_survey("starnet", folder, tmp_path / "o")
    names = [
        line.split()[1]
        for line in (tmp_path / "o").read_text().splitlines()
        if line.startswith("C ")
    ]
    assert len({name.upper() for name in names}) == 4
    assert "names_replaced" in {item.code for item in result.warnings}


def test_gkf_to_gkf_changes_nothing(survey: Path, tmp_path: Path) -> None:
    first, second = tmp_path / "1.gkf", tmp_path / "2.gkf"
    assert run("export", "gkf", str(survey), str(first)).code == 0
    from surveyapp.io.exporters.gkf import write_gkf

    write_gkf(read_gkf(first), second)
    assert first.read_bytes() == second.read_bytes()
    for point in api.adjust(second).points:
        place = (point.e or 0.0, point.n or 0.0, point.h or 0.0)
        assert coordinates(survey)[point.name] == pytest.approx(place, abs=1e-6)


@pytest.mark.skipif(shutil.which("gama-local") is None, reason="gama-local is not on the PATH")
def test_gama_reads_the_gkf(survey: Path, tmp_path: Path) -> None:
    path = tmp_path / "n.gkf"
    run("export", "gkf", str(survey), str(path))
    out = tmp_path / "o.xml"
    subprocess.run(["gama-local", str(path), "--xml", str(out)], check=True)
    assert "adjusted" in out.read_text()


def test_an_unknown_format_is_refused(survey: Path, tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="no such format"):
        api.export_survey("dwg", survey, tmp_path / "x")
