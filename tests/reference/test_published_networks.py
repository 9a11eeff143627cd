"""Small networks whose adjusted values others printed, so that a fresh clone compares with them.

Observed values and results are facts transcribed from the sources that each network names.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api

Line = tuple[str, str, float, float]
"""From, to, observed height difference [m], its stated sigma [mm]."""


@dataclass(frozen=True)
class Published:
    """A levelling network: what was observed and what was printed.

    ``heights`` [m] to the last printed digit, ``sigmas`` [mm] with the stated sigma of unit weight,
    ``sum_of_squares`` is v'Pv.
    """

    source: str
    fixed: dict[str, float]
    lines: tuple[Line, ...]
    heights: dict[str, float]
    digits: int
    sum_of_squares: float | None = None
    sigmas: dict[str, float] | None = None


GAMA = Published(
    source="GNU Gama 1.5.09, sample '1D vertical least square adjustment', printed output",
    fixed={"1a": 1000.0},
    lines=tuple(
        (a, b, value, 5.0)
        for a, b, value in (
            ("1a", "4", -1.225),
            ("4", "3", -0.848),
            ("3", "2", 1.342),
            ("2", "1a", 0.720),
            ("1a", "2", -0.724),
            ("2", "3", -1.335),
            ("3", "4", 0.842),
            ("4", "1a", 1.231),
        )
    ),
    heights={"4": 998.77513, "3": 997.93325, "2": 999.27487},
    digits=5,
    sum_of_squares=146.625 / 25.0,
    sigmas={"4": 3.1, "3": 3.5, "2": 3.1},
)

WOLF_GHILANI = Published(
    source="Ghilani & Wolf, Adjustment Computations, level net of chapter 12, equal weights",
    fixed={"X": 100.0, "Y": 107.5},
    lines=tuple(
        (a, b, value, 10.0)
        for a, b, value in (
            ("X", "A", 5.10),
            ("A", "Y", 2.34),
            ("Y", "C", -1.25),
            ("C", "X", -6.13),
            ("A", "B", -0.68),
            ("Y", "B", -3.00),
            ("B", "C", 1.70),
        )
    ),
    heights={"A": 105.141, "B": 104.483, "C": 106.188},
    digits=3,
)

STRANG_BORRE = Published(
    source="Strang & Borre, Linear Algebra, Geodesy and GPS; adjusted with STAR*NET 9.2, which "
    "printed a sum of squares of 4.636 and an error factor of 1.243",
    fixed={"A": 10.021, "B": 10.321, "C": 11.002},
    lines=tuple(
        (a, b, value, 6.0 * (metres / 1000.0) ** 0.5)
        for a, b, value, metres in (
            ("A", "E", 0.732, 970.0),
            ("A", "F", 1.978, 1002.0),
            ("B", "E", 0.420, 1070.0),
            ("C", "F", 0.988, 1110.0),
            ("E", "F", 1.258, 890.0),
        )
    ),
    heights={},
    digits=4,
    sum_of_squares=4.636,
)


def written(network: Published, folder: Path) -> Path:
    points = [f'<point id="{n}" z="{z}" fix="z" />' for n, z in network.fixed.items()]
    ends = {name for a, b, _, _ in network.lines for name in (a, b)} - set(network.fixed)
    points += [f'<point id="{name}" adj="z" />' for name in sorted(ends)]
    lines = [
        f'<dh from="{a}" to="{b}" val="{value}" stdev="{sigma}" />'
        for a, b, value, sigma in network.lines
    ]
    path = folder / "network.gkf"
    path.write_text(
        '<?xml version="1.0" ?>\n<gama-local xmlns="http://www.gnu.org/software/gama/gama-local">'
        '<network><parameters sigma-apr="1" conf-pr="0.95" sigma-act="apriori" />'
        f"<points-observations>{''.join(points)}<height-differences>{''.join(lines)}"
        "</height-differences></points-observations></network></gama-local>\n",
        encoding="utf-8",
    )
    return path


NETWORKS = {"gama": GAMA, "wolf-ghilani": WOLF_GHILANI, "strang-borre": STRANG_BORRE}


@pytest.mark.parametrize("network", NETWORKS.values(), ids=NETWORKS.keys())
def test_adjusted_heights_are_the_printed_ones(network: Published, tmp_path: Path) -> None:
    found: dict[str, Any] = api.adjust(written(network, tmp_path)).to_dict()
    heights = {point["name"]: point["h"] for point in found["points"]}
    for name, printed in network.heights.items():
        assert heights[name] == pytest.approx(printed, abs=0.51 * 10.0**-network.digits), name
    if network.sum_of_squares is not None:
        unit = found["sigma0"] ** 2 * found["dof"]
        assert unit == pytest.approx(network.sum_of_squares, rel=2e-4)
    scale = 1000.0 / found["sigma_scale"]
    for point in found["points"]:
        printed_sigma = (network.sigmas or {}).get(point["name"])
        if printed_sigma is not None:
            assert point["sigma_h_m"] * scale == pytest.approx(printed_sigma, abs=0.051)
