"""Everyday .gkf files: what programs and people write into them, against hand computations."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.network.variance_components import variance_components
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.errors import SurveyError
from surveyapp.io.importers.gkf import read_gkf
from tests.cli.command import run

HEAD = '<gama-local xmlns="http://www.gnu.org/software/gama/gama-local">'
DEFAULTS = 'distance-stdev="3" direction-stdev="15" zenith-angle-stdev="20" angle-stdev="15"'
AB = '<point id="A" x="0" y="0" z="0" fix="xyz"/><point id="B" x="100" y="0" z="0" fix="xyz"/>'
FLAT = '<point id="A" x="0" y="0" fix="xy"/><point id="B" x="100" y="0" fix="xy"/>'


def written(
    tmp_path: Path, body: str, *, parameters: str = "", before: str = "", hand: str = "left-handed"
) -> Path:
    path = tmp_path / "net.gkf"
    text = (
        f'<?xml version="1.0"?>{before}{HEAD}<network axes-xy="ne" angles="{hand}">'
        f'<parameters sigma-apr="1" sigma-act="apriori" {parameters}/>'
        f"<points-observations {DEFAULTS}>{body}</points-observations></network></gama-local>"
    )
    path.write_text(text, encoding="utf-8")
    return path


def codes(result: AdjustmentResult) -> set[str]:
    return {item.code for item in result.warnings}


@pytest.mark.parametrize("left", [35.0, 80.0, 100.0, 145.0])
def test_zenith_angles_above_180_are_face_right(tmp_path: Path, left: float) -> None:
    gon = left / 0.9
    right = 400.0 - gon
    body = (
        f'{AB}<point id="C" adj="xyz"/><obs from="A"><direction to="B" val="0"/>'
        f'<direction to="C" val="50"/><s-distance to="C" val="50"/>'
        f'<z-angle to="C" val="{gon}"/><z-angle to="C" val="{right}"/></obs>'
    )
    result = api.adjust(written(tmp_path, body))
    flat = 50.0 * math.sin(math.radians(left)) * math.sqrt(0.5)
    point = result.point("C")
    assert (point.e, point.n) == pytest.approx((flat, flat), abs=1e-6)
    assert point.h == pytest.approx(50.0 * math.cos(math.radians(left)), abs=1e-6)
    assert "face_right" in codes(result)


def test_slope_and_zenith_without_heights_are_a_horizontal_distance(tmp_path: Path) -> None:
    body = (
        f'{FLAT}<point id="C" adj="xy"/><obs from="A"><direction to="B" val="0"/>'
        '<direction to="C" val="50"/><s-distance to="C" val="50"/>'
        '<z-angle to="C" val="311.108642"/></obs>'
    )
    result = api.adjust(written(tmp_path, body))
    steep = math.radians((400.0 - 311.108642) * 0.9)
    row = next(item for item in result.observations if item.kind == "distance")
    assert row.observed == pytest.approx(50.0 * math.sin(steep), abs=1e-9)
    cc = math.pi / 2e6
    expected = math.hypot(math.sin(steep) * 0.003, 50.0 * math.cos(steep) * 20.0 * cc)
    assert row.sigma == pytest.approx(expected, rel=1e-9)
    assert "level_distances" in codes(result)
    assert "observations_not_used" not in codes(result)


def test_a_plain_document_type_is_passed_over_and_never_opened(tmp_path: Path) -> None:
    body = (
        f'{FLAT}<point id="C" adj="xy"/><obs from="A"><direction to="B" val="0"/>'
        '<direction to="C" val="50"/><distance to="C" val="70"/></obs>'
    )
    trap = tmp_path / "trap.dtd"
    trap.write_text('<!ENTITY x "100">')
    for system in ("gama-xml.dtd", str(trap), "http://localhost:1/none.dtd"):
        path = written(tmp_path, body, before=f'<!DOCTYPE gama-xml SYSTEM "{system}">')
        assert api.adjust(path).point("C").e == pytest.approx(70.0 * math.sqrt(0.5))
    spoiled = body.replace("<obs", "<description>&x;</description><obs")
    path = written(tmp_path, spoiled, before=f'<!DOCTYPE gama-xml SYSTEM "{trap}">')
    with pytest.raises(SurveyError, match="entity"):
        api.adjust(path)


def test_sixty_seconds_are_carried_over_and_told(tmp_path: Path) -> None:
    body = (
        f'{FLAT}<point id="C" adj="xy"/><obs from="A"><direction to="B" val="0-00-00"/>'
        '<direction to="C" val="44-59-60"/><distance to="C" val="70"/></obs>'
    )
    result = api.adjust(written(tmp_path, body))
    assert result.point("C").e == pytest.approx(70.0 * math.sqrt(0.5))
    assert "sixty_carried" in codes(result)
    with pytest.raises(SurveyError, match="cannot be read"):
        api.adjust(written(tmp_path, body.replace("44-59-60", "44-59-61")))


def test_observations_to_undeclared_points_are_left_out_with_their_covariances(
    tmp_path: Path,
) -> None:
    body = (
        f'{FLAT}<point id="C" adj="xy"/><obs from="A"><direction to="B" val="0"/>'
        '<direction to="lost" val="20"/><direction to="C" val="50"/><distance to="C" val="70"/>'
        '<cov-mat dim="4" band="1">100 10 100 10 100 0 9</cov-mat></obs>'
    )
    result = api.adjust(written(tmp_path, body))
    assert len(result.observations) == 3
    told = next(item for item in result.warnings if item.code == "undeclared_points")
    assert "lost" in told.text
    assert result.point("C").n == pytest.approx(70.0 * math.sqrt(0.5))


def test_a_mirror_image_is_told_and_a_third_distance_decides(tmp_path: Path) -> None:
    two = (
        f'{FLAT}<point id="C" adj="xy"/><obs from="C"><distance to="A" val="80"/>'
        '<distance to="B" val="70"/>{}</obs>'
    )
    result = api.adjust(written(tmp_path, two.format("")))
    told = next(item for item in result.warnings if item.code == "mirror_solution")
    n = (80.0**2 - 70.0**2 + 100.0**2) / 200.0
    e = math.sqrt(80.0**2 - n**2)
    point = result.point("C")
    assert (abs(point.e or 0.0), point.n) == pytest.approx((e, n))
    assert f"e {-(point.e or 0.0):.3f}, n {n:.3f}" in told.text
    for side in (1.0, -1.0):
        third = math.hypot(n - 50.0, e * side - 30.0)
        body = two.format(f'<distance to="D" val="{third:.4f}"/>')
        body = '<point id="D" x="50" y="30" fix="xy"/>' + body
        found = api.adjust(written(tmp_path, body))
        assert found.point("C").e == pytest.approx(side * e, abs=1e-3)
        assert "mirror_solution" not in codes(found)


def test_given_coordinates_decide_a_mirror_image(tmp_path: Path) -> None:
    for side in (1.0, -1.0):
        body = (
            f'{FLAT}<point id="C" x="60" y="{50 * side}" adj="xy"/><obs from="C">'
            '<distance to="A" val="80"/><distance to="B" val="70"/></obs>'
        )
        result = api.adjust(written(tmp_path, body))
        assert (result.point("C").e or 0.0) * side > 0.0
        assert "mirror_solution" not in codes(result)


def test_the_smaller_sum_of_squares_chooses(tmp_path: Path) -> None:
    """Two distances and a weak azimuth: one side fits, the other misses by far."""
    n = (80.0**2 - 70.0**2 + 100.0**2) / 200.0
    for side in (1.0, -1.0):
        bearing = math.atan2(math.sqrt(80.0**2 - n**2) * side, n) / math.pi * 200.0 % 400.0
        body = (
            f'{FLAT}<point id="C" adj="xy"/><obs from="C"><distance to="A" val="80"/>'
            '<distance to="B" val="70"/></obs><obs from="A">'
            f'<azimuth to="C" val="{bearing:.5f}" stdev="100"/></obs>'
        )
        result = api.adjust(written(tmp_path, body))
        assert (result.point("C").e or 0.0) * side > 50.0
        assert "mirror_solution" not in codes(result)


def test_three_slope_distances_leave_above_and_below(tmp_path: Path) -> None:
    c = (30.0, 40.0, 20.0)
    points = {"A": (0.0, 0.0, 0.0), "B": (100.0, 0.0, 0.0), "D": (0.0, 90.0, 0.0)}
    body = "".join(
        f'<point id="{k}" x="{p[0]}" y="{p[1]}" z="0" fix="xyz"/>' for k, p in points.items()
    )
    body += '<point id="C" adj="xyz"/><obs from="C">'
    body += "".join(
        f'<s-distance to="{k}" val="{math.dist(p, c):.5f}"/>' for k, p in points.items()
    )
    result = api.adjust(written(tmp_path, body + "</obs>"))
    told = next(item for item in result.warnings if item.code == "mirror_solution")
    assert abs(result.point("C").h or 0.0) == pytest.approx(20.0, abs=1e-3)
    assert "h -20.0" in told.text or "h 20.0" in told.text


def test_two_stations_at_one_place_are_refused(tmp_path: Path) -> None:
    body = (
        f'{FLAT}<point id="A2" x="0" y="0" fix="xy"/><point id="C" adj="xy"/><obs from="A">'
        '<azimuth to="A2" val="50" stdev="10"/><azimuth to="C" val="50" stdev="10"/>'
        '<distance to="C" val="70"/></obs>'
    )
    with pytest.raises(SurveyError, match="one place"):
        api.adjust(written(tmp_path, body))


def test_names_are_composed(tmp_path: Path) -> None:
    body = (
        f'{FLAT}<point id="O\u03081" adj="xy"/><obs from="A"><direction to="B" val="0"/>'
        '<direction to="\u00d61" val="50"/><distance to="\u00d61" val="70"/></obs>'
    )
    assert api.adjust(written(tmp_path, body)).point("\u00d61").e == pytest.approx(49.497, abs=1e-3)


def _gross(tmp_path: Path) -> Path:
    flat = 70.0015 * math.sqrt(0.5)
    seen = (math.atan2(flat, flat - 100.0) / math.pi * 200.0 - 200.0) % 400.0
    body = (
        f'{FLAT}<point id="C" adj="xy"/><obs from="A"><direction to="B" val="0"/>'
        '<direction to="C" val="50"/><distance to="C" val="70"/><distance to="C" val="70.003"/>'
        '<distance to="C" val="75"/></obs><obs from="B"><direction to="A" val="0"/>'
        f'<direction to="C" val="{seen:.4f}"/></obs>'
    )
    return written(tmp_path, body, parameters='tol-abs="1000"')


def test_what_is_left_out_as_gross_stands_in_the_observations_and_is_a_check(
    tmp_path: Path,
) -> None:
    path = _gross(tmp_path)
    answer = run("adjust", str(path), "--json")
    assert answer.code == 1
    document = json.loads(answer.out)
    out = [item for item in document["observations"] if item["left_out"]]
    assert [(item["observed"], item["kind"]) for item in out] == [(75.0, "distance")]
    assert out[0]["residual"] == pytest.approx(-5.0, abs=0.01)
    assert len(document["observations"]) == len(read_gkf(path).observations)
    check = document["checks"][0]
    assert check["pass"] is False
    assert check["confirmed"] is True
    assert check["value"] == pytest.approx(5.0, abs=0.01)
    assert check["limit"] == pytest.approx(1.0)


def test_the_removal_that_helps_most_is_named_first(tmp_path: Path) -> None:
    places = {"A": (0.0, 0.0), "B": (100.0, 0.0), "D": (100.0, 100.0), "E": (0.0, 100.0)}
    c = (40.0, 30.0)
    body = "".join(f'<point id="{k}" x="{p[0]}" y="{p[1]}" fix="xy"/>' for k, p in places.items())
    body += '<point id="C" adj="xy"/><obs from="C">'
    for k, p in places.items():
        length = math.dist(p, c) + (0.05 if k == "D" else 0.0)
        body += f'<distance to="{k}" val="{length:.4f}"/>'
    path = written(tmp_path, body + "</obs>")
    result = api.adjust(path)
    assert result.removals
    document = json.loads(run("adjust", str(path), "--snoop", "--json").out)
    assert ["C-D" in item["observation"] for item in document["snooped"]["removed"]] == [True]
    assert document["snooped"]["adjustment"]["global_test"]["sum_of_squares"] < 0.01
    assert "C-D" in result.removals[0].description
    assert result.removals[0].sum_of_squares == pytest.approx(0.0, abs=1e-2)
    sums = [item.sum_of_squares for item in result.removals]
    assert sums == sorted(sums)
    before = result.global_test.sum_of_squares
    for item in result.removals:  # independent observations: v'Pv falls by the square of v/sigma
        assert before - item.sum_of_squares == pytest.approx(item.standardized**2, rel=0.02)


def test_a_component_that_goes_to_zero_does_not_hold_up_the_rest(tmp_path: Path) -> None:
    """Distances that fit exactly, angles with scatter: the angles get their factor."""
    body = f'{FLAT}<point id="C" adj="xy"/>'
    body += '<obs from="A">' + '<distance to="C" val="70.7107"/>' * 4 + "</obs>"
    for i, off in enumerate((40, -35, 20, -25, 10)):
        body += (
            f'<obs from="A"><angle bs="B" fs="C" val="{50.0 + off * 1e-4 + i * 0:.6f}" '
            'stdev="15"/></obs>'
        )
    network = read_gkf(written(tmp_path, body))
    components, _ = variance_components(network)
    found = {item.group: item for item in components}
    offs = (40, -35, 20, -25, 10)
    mean = sum(offs) / 5
    expected = math.sqrt(sum((x - mean) ** 2 for x in offs) / 4) / 15
    assert found["angle"].factor == pytest.approx(expected, rel=1e-3)
    assert not found["angle"].vanishing
    assert found["distance"].vanishing
    assert found["distance"].factor == 1.0
