"""A heading with a traverse: the prediction is the covariance that ``adjust`` gives its end."""

import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.domain.adjustment import AdjustmentResult
from surveyapp.domain.penetration_result import Prediction

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "projects" / "synthetic-breakthrough"
AXIS = math.radians(62.0)
ALONE = ("start_position", "distance_scale", "height_transfer", "deflection")


def one_end(tmp_path: Path, letter: str) -> Path:
    """The sample with one heading and without what an adjustment does not know.

    It has no deflections: an adjustment shares them by the field of the project, a prediction by
    [penetration.deflection], which it lacks here.
    """
    folder = Path(shutil.copytree(SAMPLE, tmp_path / letter))
    text = (folder / "project.toml").read_text(encoding="utf-8")
    head, tail = text.split("[penetration]\n", 1)
    headings = re.findall(r"\[\[penetration\.heading\]\]\n.*?\n\n", tail, re.DOTALL)
    own = next(item for item in headings if f'name = "{letter}"' in item)
    own = re.sub(r"(shaft|start) = .*\n", "", own)
    plain = "\n".join(
        line
        for line in tail.split("[penetration.deflection]")[0].splitlines()
        if not line.startswith(("case", "sigma_scale"))
    )
    table = f'[penetration]\ncase = "one_end"\n{plain}\n{own}'
    head = head.replace("format = 1\n", "format = 1\ndeflection = { sigma_arcsec = 0.001 }\n", 1)
    (folder / "project.toml").write_text(head + table, encoding="utf-8")
    return folder


def lateral_and_along(result: AdjustmentResult, name: str) -> tuple[float, float]:
    """1 sigma across and along the axis from the ellipse of a point."""
    ellipse = result.point(name).ellipse
    assert ellipse is not None
    turn = ellipse.azimuth - AXIS
    across = math.hypot(ellipse.a_m * math.sin(turn), ellipse.b_m * math.cos(turn))
    return across, math.hypot(ellipse.a_m * math.cos(turn), ellipse.b_m * math.sin(turn))


@pytest.mark.parametrize("letter", ["A", "B"])
def test_prediction_and_adjustment_agree(tmp_path: Path, letter: str) -> None:
    folder = one_end(tmp_path, letter)
    predicted = api.predict(folder, monte_carlo=False)
    assert not {row.source for row in predicted.budget} & set(ALONE)
    adjusted = api.adjust(folder, traverse=letter)
    across, along = lateral_and_along(adjusted, f"{letter}20")
    # an adjustment knows what the sides share besides the constant, a prediction counts it as own:
    # it may promise a little less, never more
    lateral = predicted.sigma.lateral_m
    assert lateral is not None
    assert 0.995 * across <= lateral <= 1.03 * across
    assert predicted.sigma.longitudinal_m == pytest.approx(along, rel=2e-2)
    assert predicted.sigma.vertical_m == pytest.approx(
        adjusted.point(f"{letter}20").sigma_h, rel=1e-6
    )


def test_measured_rows_replace_the_assumed_ones(tmp_path: Path) -> None:
    """Better angles in the table change nothing once the traverse is named."""
    folder = one_end(tmp_path, "A")
    before = api.predict(folder, monte_carlo=False)
    text = (folder / "project.toml").read_text(encoding="utf-8")
    better = text.replace("axis_azimuth = 62.0", "axis_azimuth = 62.0\nsigma_angle_arcsec = 0.1")
    (folder / "project.toml").write_text(better, encoding="utf-8")
    after = api.predict(folder, monte_carlo=False)
    assert after.sigma.lateral_m == before.sigma.lateral_m
    unnamed = better.replace('traverse = "A"', "start = { azimuth_sigma_arcsec = 9.0 }")
    (folder / "project.toml").write_text(unnamed, encoding="utf-8")
    rows = {row.source: row.lateral_m for row in api.predict(folder, monte_carlo=False).budget}
    measured = {row.source: row.lateral_m for row in before.budget}
    assert rows["angles"] < 0.1 * measured["angles"]


def test_the_generator_writes_the_committed_books(tmp_path: Path) -> None:
    from scripts.make_breakthrough_mine import write

    write(tmp_path / "again")
    for path in sorted((SAMPLE / "observations").iterdir()):
        if path.name != "A.csv":  # holds the azimuth that the shaft has given
            again = tmp_path / "again" / "observations" / path.name
            assert again.read_text() == path.read_text(), path.name


def test_the_record_has_both_sections(tmp_path: Path) -> None:
    from pypdf import PdfReader

    written = api.report(SAMPLE, tmp_path / "r.pdf")
    assert {"shafts", "breakthrough"} <= set(written.sections)
    text = "\n".join(page.extract_text() for page in PdfReader(tmp_path / "r.pdf").pages)
    result: Prediction = api.predict(SAMPLE, monte_carlo=False)
    assert f"{result.sigma.lateral_m:.4f}" in text
    for words in ("not separable", "second centring", "centre line +4.0 mm", "63-10-38.7"):
        assert words in text
    assert np.isfinite(result.ellipse.a_m)
