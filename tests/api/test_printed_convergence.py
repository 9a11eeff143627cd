"""A record that prints its convergences and names no CRS, reduced by hand."""

from pathlib import Path

import pytest

from surveyapp import api

SESSION = """
[[orientation]]
id = "{id}"
station = "{at}"
target = "{to}"
instrument = "G"
method = "automatic"
purpose = "{purpose}"
order = {order}
book = "observations/{id}.csv"
"""


def test_constant_and_grid_azimuth_by_the_printed_convergences(tmp_path: Path) -> None:
    """Known side: 40-00-00 + 1-12-00 - 41-30-00; line: 100-00-00 - 0-18-00 - 1-12-45."""
    text = 'format = 1\nname = "printed"\nangle_unit = "dms"\n'
    text += '[[instrument]]\nid = "G"\ncard = "mvt-2"\n'
    for name, more in {
        "K": 'convergence = "1-12-00"',
        "L": "",
        "A": 'convergence = "1-12-45"',
        "B": "",
    }.items():
        text += f'[[station]]\nname = "{name}"\n{more}\n'
    known = SESSION.format(id="known", at="K", to="L", purpose="calibration", order=1)
    text += known + 'azimuth_known = "040-00-00"\n'
    text += SESSION.format(id="ab", at="A", to="B", purpose="survey", order=2)
    (tmp_path / "observations").mkdir()
    (tmp_path / "project.toml").write_text(text, encoding="utf-8")
    for name, azimuth in {"known": "41-30-00", "ab": "100-00-00"}.items():
        book = f"seq,kind,value\n1,azimuth,{azimuth}\n"
        (tmp_path / "observations" / f"{name}.csv").write_text(book, encoding="utf-8")
    found = api.orient(tmp_path).to_dict()
    assert found["constants"][0]["arcsec"] == pytest.approx(-18 * 60.0, abs=1e-6)
    grid = found["lines"][0]["grid_azimuth"]["deg"]
    assert grid == pytest.approx(98 + 29 / 60 + 15 / 3600, abs=1e-9)
