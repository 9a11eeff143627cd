"""Textbook networks against the results that GNU Gama stored beside them."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.network import adjust
from surveyapp.core.network.quality import ellipse
from surveyapp.domain.traverse import Status
from surveyapp.io.importers.gkf import read_gkf

SHARED = Path(os.environ.get("SURVEYAPP_DATA", Path(__file__).parents[3] / "shared" / "data"))
FOLDER = SHARED / "networks"
NAMES = sorted(path.stem for path in FOLDER.glob("*.gkf")) if FOLDER.is_dir() else []
NS = "{http://www.gnu.org/software/gama/gama-local-adjustment}"

pytestmark = [
    pytest.mark.shared_data,
    pytest.mark.skipif(not NAMES, reason="the measured networks are not here"),
]


@dataclass(frozen=True)
class Stored:
    dof: int
    defect: int
    sum_of_squares: float
    sigma_apriori: float
    points: dict[str, dict[str, float]]
    covariance: np.ndarray
    order: list[tuple[str, str]]
    observations: list[tuple[float, float, float]]


def child(item: ET.Element, tag: str) -> str:
    return item.findtext(NS + tag) or "nan"


def stored(name: str) -> Stored:
    root = ET.parse(FOLDER / f"{name}.xml").getroot()

    def number(tag: str) -> float:
        return float(next(root.iter(NS + tag)).text or "nan")

    matrix = next(root.iter(NS + "cov-mat"))
    dim, band = (int(child(matrix, tag)) for tag in ("dim", "band"))
    values = iter(float(item.text or "nan") for item in matrix.findall(NS + "flt"))
    covariance = np.zeros((dim, dim))
    for i in range(dim):
        for j in range(i, min(dim, i + band + 1)):
            covariance[i, j] = covariance[j, i] = next(values)
    points: dict[str, dict[str, float]] = {}
    order = []
    for point in next(root.iter(NS + "adjusted")):
        identity = child(point, "id")
        points[identity] = {}
        for item in point:
            tag = item.tag.removeprefix(NS)
            if tag != "id":
                points[identity][tag.lower()] = float(item.text or "nan")
                order.append((identity, tag.lower()))
    observations = [
        (
            float(child(item, "stdev")),
            float(child(item, "f")),
            float(child(item, "std-residual")),
        )
        for item in next(root.iter(NS + "observations"))
    ]
    return Stored(
        int(number("degrees-of-freedom")),
        int(number("defect")),
        number("sum-of-squares"),
        number("apriori"),
        points,
        covariance,
        order,
        observations,
    )


def source(axes: str, tag: str) -> tuple[int, float]:
    """Component (e, n, h) and sign of x, y or z."""
    if tag == "z":
        return 2, 1.0
    letter = axes["xy".index(tag)]
    return (0 if letter in "ew" else 1), (1.0 if letter in "en" else -1.0)


@pytest.mark.parametrize("name", NAMES)
def test_coordinates_agree_to_a_hundredth_of_a_millimetre(name: str) -> None:
    network = read_gkf(FOLDER / f"{name}.gkf")
    result, expected = adjust(network), stored(name)
    for identity, values in expected.points.items():
        point = result.point(identity)
        for tag, value in values.items():
            component, sign = source(network.axes, tag)
            mine = (point.e, point.n, point.h)[component]
            assert mine is not None
            assert sign * mine == pytest.approx(value, abs=1e-5, rel=0)


@pytest.mark.parametrize("name", NAMES)
def test_sums_of_squares_and_degrees_of_freedom_agree(name: str) -> None:
    result, expected = adjust(read_gkf(FOLDER / f"{name}.gkf")), stored(name)
    assert result.dof == expected.dof
    assert result.defect == expected.defect
    # one stored result was computed with another a-priori sigma than its file states
    mine = result.global_test.sum_of_squares / result.global_test.sigma_apriori**2
    assert mine == pytest.approx(expected.sum_of_squares / expected.sigma_apriori**2, rel=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_ellipses_and_sigmas_agree(name: str) -> None:
    network = read_gkf(FOLDER / f"{name}.gkf")
    result, expected = adjust(network), stored(name)
    # Gama mirrors y where axes and angles disagree and leaves its covariances mirrored
    mirrored = network.axes in ("en", "nw", "se", "ws")
    for identity in expected.points:
        rows = [i for i, (owner, tag) in enumerate(expected.order) if owner == identity]
        tags = [expected.order[i][1] for i in rows]
        block = expected.covariance[np.ix_(rows, rows)] * 1e-6
        flip = np.array([-1.0 if tag == "y" and mirrored else 1.0 for tag in tags])
        places = [source(network.axes, tag) for tag in tags]
        signs = flip * np.array([sign for _, sign in places])
        block = block * signs[:, None] * signs[None, :]
        point = result.point(identity)
        components = [component for component, _ in places]
        mine = np.array(point.covariance)[np.ix_(components, components)]
        scale = np.sqrt(np.outer(np.diag(block), np.diag(block)))
        np.testing.assert_allclose(mine / scale, block / scale, atol=2e-3)
        if components[:2] in ([0, 1], [1, 0]):
            order = [components.index(0), components.index(1)]
            theirs = ellipse(block[np.ix_(order, order)])
            assert point.ellipse is not None
            assert point.ellipse.a_m == pytest.approx(theirs.a_m, rel=1e-3)
            assert point.ellipse.b_m == pytest.approx(theirs.b_m, rel=2e-3, abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_residual_tests_agree_observation_by_observation(name: str) -> None:
    network = read_gkf(FOLDER / f"{name}.gkf")
    result, expected = adjust(network), stored(name)
    assert len(result.observations) == len(expected.observations)
    for mine, (_, share, standardized) in zip(
        result.observations, expected.observations, strict=True
    ):
        # f = 100 (1 - sigma adjusted / sigma observed), printed with three decimals
        sigma = mine.sigma * result.sigma_scale
        assert 100.0 * (1.0 - mine.sigma_adjusted / sigma) == pytest.approx(share, abs=2e-3)
        if not np.isnan(standardized):
            assert mine.standardized is not None
            assert abs(mine.standardized) == pytest.approx(standardized, abs=1.1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_no_approximate_coordinates_are_needed(name: str) -> None:
    network = read_gkf(FOLDER / f"{name}.gkf")
    bare = tuple(
        replace(
            point,
            e=point.e if point.status_e is Status.FIXED else None,
            n=point.n if point.status_n is Status.FIXED else None,
            h=point.h if point.status_h is Status.FIXED else None,
        )
        for point in network.points
    )
    result, alone = adjust(network), adjust(replace(network, points=bare))
    assert alone.global_test.sum_of_squares == pytest.approx(
        result.global_test.sum_of_squares, rel=1e-7
    )
    free = any(p.status_e is Status.CONSTRAINED for p in network.points)
    for a, b in zip(result.points, alone.points, strict=True):
        if a.sigma_e is not None and not free:
            assert b.e == pytest.approx(a.e, abs=1e-6)
