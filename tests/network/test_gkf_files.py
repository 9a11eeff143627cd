"""Reading and writing .gkf: the whole vocabulary, round trips, every orientation of axes."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.network import adjust
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.observations import ObservationKind
from surveyapp.domain.traverse import Network, Status
from surveyapp.errors import SurveyError
from surveyapp.io.exporters.gkf import gkf_text, write_gkf
from surveyapp.io.importers.gkf import read_gkf
from tests.network.network_factory import make

SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[3] / "shared" / "data"))
FILES = sorted((SHARED / "networks").glob("*.gkf"))
K = ObservationKind

HEAD = '<?xml version="1.0"?>\n<gama-local>\n<network {network}>\n<parameters {parameters}/>\n'
BODY = "<points-observations {defaults}>\n{body}\n</points-observations>\n"
TAIL = "</network>\n</gama-local>\n"


def read(
    tmp_path: Path, body: str, *, network: str = "", parameters: str = "", defaults: str = ""
) -> Network:
    path = tmp_path / "case.gkf"
    text = HEAD.format(network=network, parameters=parameters)
    path.write_text(text + BODY.format(defaults=defaults, body=body) + TAIL, encoding="utf-8")
    return read_gkf(path)


def same(a: AdjustmentResult, b: AdjustmentResult) -> None:
    assert a.dof == b.dof
    assert a.global_test.sum_of_squares == pytest.approx(b.global_test.sum_of_squares, rel=1e-7)
    for p, q in zip(a.points, b.points, strict=True):
        assert p.name == q.name
        for x, y in ((p.e, q.e), (p.n, q.n), (p.h, q.h)):
            assert x == (None if y is None else pytest.approx(y, abs=1e-7))
        np.testing.assert_allclose(p.covariance, q.covariance, rtol=1e-5, atol=1e-15)


@pytest.mark.shared_data
@pytest.mark.skipif(not FILES, reason="the measured networks are not here")
@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_out_and_back_changes_nothing(path: Path, tmp_path: Path) -> None:
    network = read_gkf(path)
    write_gkf(network, tmp_path / "copy.gkf")
    back = read_gkf(tmp_path / "copy.gkf")
    assert back.axes == network.axes
    assert len(back.observations) == len(network.observations)
    same(adjust(network), adjust(back))


@pytest.mark.parametrize("axes", ["ne", "sw", "es", "wn", "en", "nw", "se", "ws"])
@pytest.mark.parametrize("left", [True, False])
def test_every_orientation_of_axes_and_angles(axes: str, left: bool, tmp_path: Path) -> None:
    kinds = ("direction", "distance", "angle", "azimuth", "coordinate", "slope_distance", "zenith")
    network, _ = make(5, kinds, correlated=False)
    turned = replace(network, axes=axes, left_handed=left)
    write_gkf(turned, tmp_path / "turned.gkf")
    same(adjust(network), adjust(read_gkf(tmp_path / "turned.gkf")))


def test_gyro_sides_become_azimuths_with_the_variance_of_their_constant(tmp_path: Path) -> None:
    network, _ = make(8, ("direction", "distance", "gyro"), datum="free")
    write_gkf(network, tmp_path / "gyro.gkf")
    back = read_gkf(tmp_path / "gyro.gkf")
    assert not any(obs.kind is K.GYRO for obs in back.observations)
    a, b = adjust(network), adjust(back)
    # the constant and its own observation have gone together
    assert a.dof == b.dof
    assert a.global_test.sum_of_squares == pytest.approx(b.global_test.sum_of_squares, rel=1e-7)
    for p, q in zip(a.points, b.points, strict=True):
        np.testing.assert_allclose(p.covariance, q.covariance, rtol=1e-5, atol=1e-15)


def test_vectors_and_correlated_heights_survive(tmp_path: Path) -> None:
    body = """
    <point id="A" x="0" y="0" z="10" fix="xyz"/> <point id="B" adj="xyz"/> <point id="C" adj="xyz"/>
    <vectors>
      <vec from="A" to="B" dx="100.001" dy="20.002" dz="3.003" from_dh="1.5" to_dh="1.2"/>
      <vec from="B" to="C" dx="-40.0" dy="70.0" dz="1.0"/>
      <cov-mat dim="6" band="2"> 4 1 0.5  4 1 0  9 0 0  4 1 0.5  4 1  9 </cov-mat>
    </vectors>
    <height-differences>
      <dh from="A" to="C" val="4.3" /> <dh from="B" to="C" val="1.004"/>
      <cov-mat dim="2" band="1"> 1.0 0.3 2.0 </cov-mat>
    </height-differences>
    <coordinates extern="k7">
      <point id="C" x="60.0" y="90.0"/>
      <cov-mat dim="2" band="1"> 100 20 64 </cov-mat>
    </coordinates>"""
    network = read(tmp_path, body, network='axes-xy="sw"', parameters='sigma-apr="1"')
    assert [len(block.members) for block in network.blocks] == [6, 2, 2]
    first = network.observations[0]
    assert first.kind is K.VECTOR_N  # x points south
    assert first.value == pytest.approx(-100.001)
    assert network.observations[-1].extern == "k7"
    write_gkf(network, tmp_path / "copy.gkf")
    back = read_gkf(tmp_path / "copy.gkf")
    for a, b in zip(back.blocks, network.blocks, strict=True):
        assert a.members == b.members
        np.testing.assert_allclose(a.covariance, b.covariance, rtol=1e-12, atol=0)
    same(adjust(network), adjust(back))


def test_defaults_units_and_inherited_heights(tmp_path: Path) -> None:
    body = """
    <point id="A" x="0" y="0" z="0" fix="xyz"/> <point id="B" x="0" y="2000" z="0" fix="xyz"/>
    <point id="C" adj="xyz"/>
    <obs from="A" from_dh="1.6">
      <direction to="B" val="100"/> <direction to="C" val="45-00-00"/>
      <s-distance to="C" val="1414.0" to_dh="1.1"/> <distance to="C" val="1414.2" stdev="7"/>
      <z-angle to="C" val="99-59-00"/> <azimuth to="C" val="50.0"/>
      <angle bs="C" fs="B" val="50.0"/>
    </obs>
    <height-differences><dh from="A" to="C" val="0.1" dist="4"/></height-differences>"""
    defaults = (
        'direction-stdev="10" angle-stdev="14" zenith-angle-stdev="20" azimuth-stdev="30" '
        'distance-stdev="5 3 0.5"'
    )
    network = read(tmp_path, body, defaults=defaults, parameters='sigma-apr="2"')
    sigma = [obs.sigma for obs in network.observations]
    cc, arc = math.pi / 2e6, math.pi / 648000
    expected = [
        10 * cc,
        10 * arc,  # a value in degrees carries its standard deviation in arc-seconds
        (5 + 3 * math.sqrt(1.414)) * 1e-3,
        7e-3,
        20 * arc,
        30 * cc,
        14 * cc,
        2e-3 * 2.0,  # m0 sqrt(D km)
    ]
    assert sigma == pytest.approx(expected, rel=1e-12)
    slope = network.observations[2]
    assert (slope.hi, slope.ht) == (1.6, 1.1)
    assert network.sigma_apriori == 2.0


def test_two_sets_of_one_station_have_two_orientations(tmp_path: Path) -> None:
    body = """
    <point id="A" x="0" y="0" fix="xy"/> <point id="B" x="0" y="1000" fix="xy"/>
    <point id="C" x="700" y="700" adj="xy"/>
    <obs from="C"><direction to="A" val="0" stdev="5"/>
    <direction to="B" val="324.2" stdev="5"/></obs>
    <obs from="C"><direction to="A" val="17" stdev="5"/>
    <direction to="B" val="341.2" stdev="5"/></obs>
    <obs from="A"><distance to="C" val="989.9" stdev="5"/><distance from="B" to="C" val="761.6"
    stdev="5"/></obs>"""
    result = adjust(read(tmp_path, body))
    assert len([item for item in result.shared if item.kind == "orientation"]) == 2
    assert result.dof == 6 - 4


def test_a_point_without_any_observation_is_left_out_and_named(tmp_path: Path) -> None:
    body = """
    <point id="A" z="0" fix="z"/> <point id="B" adj="z"/> <point id="LOST" z="3" adj="xyz"/>
    <height-differences><dh from="A" to="B" val="1.0" stdev="2"/></height-differences>"""
    network = read(tmp_path, body)
    assert network.points[2].status_h is Status.UNUSED
    assert any("LOST" in warning.text for warning in network.warnings)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ('<point id="A" x="1" y="1" fix="xy"/><point id="A" x="2" y="1" adj="xy"/>', "one name"),
        ('<point id="A" x="a" y="1" fix="xy"/>', "no number"),
        ('<point id="A" fix="q"/>', "fix"),
        ('<point id="A" fix="xy"/>', "fixed coordinate has no value"),
        ('<obs from="A"><distance to="Z" val="5" stdev="1"/></obs>', "Unknown point"),
        ('<obs from="A"><distance to="B" val="0" stdev="1"/></obs>', "no length"),
        ('<obs from="A"><angle bs="B" fs="B" val="3" stdev="1"/></obs>', "same"),
        ('<obs from="A"><distance to="A" val="3" stdev="1"/></obs>', "itself"),
        ('<obs from="A"><distance to="B" val="3"/></obs>', "no standard deviation"),
        ('<obs from="A"><distance to="B" val="3" stdev="-1"/></obs>', "not positive"),
        ('<obs from="A"><direction to="B" val="57d32" stdev="1"/></obs>', "angle cannot be read"),
        ('<obs from="A"><distanz to="B" val="3" stdev="1"/></obs>', "Unknown element"),
        ('<obs from="A"><distance val="3" stdev="1"/></obs>', "incomplete"),
        (
            '<obs from="A"><distance to="B" val="3"/><cov-mat dim="2" band="0">1 1</cov-mat></obs>',
            "wrong size",
        ),
        (
            '<obs from="A"><distance to="B" val="3"/><distance to="B" val="3"/>'
            '<cov-mat dim="2" band="1">1 2 1</cov-mat></obs>',
            "positive definite",
        ),
        ('<obs from="A"><distance to="B" val="3" stdev="1"/></obs', "well-formed"),
    ],
)
def test_bad_files_are_refused_with_words(body: str, words: str, tmp_path: Path) -> None:
    points = '<point id="A" x="0" y="0" fix="xy"/><point id="B" x="9" y="9" adj="xy"/>'
    if body.startswith("<point"):
        points = ""
    with pytest.raises(SurveyError) as refused:
        read(tmp_path, points + body)
    assert words.lower() in str(refused.value).lower()


def test_all_problems_of_a_file_come_together(tmp_path: Path) -> None:
    body = """<point id="A" x="0" y="0" fix="xy"/>
    <obs from="A"><distance to="A" val="3" stdev="1"/><distance to="B" val="x" stdev="1"/>
    <angle bs="B" fs="B" val="1" stdev="1"/></obs>"""
    with pytest.raises(SurveyError) as refused:
        read(tmp_path, body)
    assert len(refused.value.problems) >= 3
    assert all("line" in problem.where for problem in refused.value.problems)


def test_entities_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "evil.gkf"
    path.write_text(
        '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>'
        "<gama-local>&a;</gama-local>",
        encoding="utf-8",
    )
    with pytest.raises(SurveyError, match="entities"):
        read_gkf(path)


def test_what_is_not_applied_is_said(tmp_path: Path) -> None:
    body = """<point id="A" z="0" fix="z"/> <point id="B" adj="z"/>
    <height-differences><dh from="A" to="B" val="1.0" stdev="2"/></height-differences>"""
    network = read(tmp_path, body, parameters='ellipsoid="grs80" colour="red"')
    assert {warning.code for warning in network.warnings} == {
        "reductions_not_applied",
        "unknown_attribute",
    }


def test_a_missing_file_is_said(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="cannot be read"):
        read_gkf(tmp_path / "none.gkf")


def test_what_the_format_cannot_say_is_refused() -> None:
    network, _ = make(8, ("direction", "distance", "gyro"))
    free = replace(network, constants=(replace(network.constants[0], sigma=None),))
    with pytest.raises(SurveyError, match="constant"):
        gkf_text(free)
