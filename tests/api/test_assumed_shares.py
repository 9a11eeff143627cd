"""What is assumed is asked about, with its share of the variance."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveyapp import api
from tests.api.projects import TM, rows, write

LINE = """
[[instrument]]
id = "G"
card = "hgg05"
constant = { arcsec = 0.0, sigma_arcsec = 3.0 }
[[station]]
name = "A"
lat = 45.0
lon = 8.0
@
[[station]]
name = "B"
[[orientation]]
id = "s"
station = "A"
target = "B"
instrument = "G"
method = "automatic"
purpose = "survey"
sigma_arcsec = SIGMA
book = "observations/s.csv"
"""


@pytest.mark.parametrize(
    ("sigma", "stated", "wanted"),
    [
        # at 45 degrees 5" stay 5": 25 / (25 + 9 + 16) of the variance
        ("4.0", "", "50%"),
        ("12.0", "", None),  # 25 / 178: not worth a question
        ("4.0", "deflection = { xi_arcsec = 0.0, eta_arcsec = 2.0, sigma_arcsec = 5.0 }", None),
    ],
)
def test_an_unknown_deflection_is_asked_about_where_it_matters(
    tmp_path: Path, sigma: str, stated: str, wanted: str | None
) -> None:
    toml = LINE.replace("@", stated).replace("SIGMA", sigma)
    result = api.orient(write(tmp_path, toml, {"s": rows("azimuth,45-00-00")}, head=TM))
    told = [w.text for w in result.warnings if w.code == "deflection_assumed"]
    assert len(told) == (wanted is not None)
    if wanted is not None:
        assert wanted in told[0]
        assert "A-B" in told[0]


def test_the_share_of_an_assumed_known_azimuth_is_that_of_the_budget() -> None:
    result = api.orient(Path(__file__).parents[2] / "projects/tongjin-2015")
    shares = [r.share for line in result.lines for r in line.budget if r.source == "known azimuth"]
    told = [w.text for w in result.warnings if w.code == "known_azimuth_sigma_assumed"]
    assert len(told) == 2
    assert all(f"{max(shares):.0%}" in text for text in told)
