"""The latitude of the deflections: stated, from the CRS, or from the mine's own grid."""

import math
from pathlib import Path

import pytest

from surveyapp import api
from tests.penetration.mines import mine_folder, mine_toml

FIELD = "[penetration.deflection]\nsigma_arcsec = 5.0\ncorrelation_length_m = 3000.0\n"
OWN = 'grid = { origin = { lat = 45.0, lon = 110.0, e = 0.0, n = 0.0 }, rotation = "0-00-00" }'
ON_BASE = (
    'grid = { base = "EPSG:32649", origin = { lat = 45.0, lon = 110.0, e = 0.0, n = 0.0 }, '
    'rotation = "0-00-00" }'
)


def deflection_m(path: Path, *, top: str = "", stated: str = "") -> float:
    table = FIELD + stated + 'calibrated_at = "P0"\n'
    text = mine_toml(gyro=(0, 10, 19), top=top, more=table)
    found = api.predict(mine_folder(path, text), monte_carlo=False)
    (row,) = [row for row in found.budget if row.source == "deflection"]
    assert row.lateral_m is not None
    return row.lateral_m


@pytest.mark.parametrize("grid", [OWN, ON_BASE])
def test_a_mines_own_grid_gives_the_latitude(tmp_path: Path, grid: str) -> None:
    """Printed for 45 degrees, 3 km, sides 0, 10 and 19 of 20: .0259 m."""
    by_grid = deflection_m(tmp_path / "grid", top=grid)
    stated = deflection_m(tmp_path / "stated", stated="latitude_deg = 45.0\n")
    assert stated == pytest.approx(0.0259, abs=0.5e-4)
    # the meeting point lies 2 km north of the origin: 2 / 6367 of a radian
    ratio = math.tan(math.radians(45.0) + 2000.0 / 6.3677e6) / math.tan(math.radians(45.0))
    assert by_grid / stated == pytest.approx(ratio, abs=2e-6)
