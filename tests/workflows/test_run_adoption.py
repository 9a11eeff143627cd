"""A run after its effect was adopted: it is shown and judged by the model that stands."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.io.locations import copy_sample


@pytest.fixture
def adopted(tmp_path: Path) -> Path:
    folder = copy_sample("johannesburg-1966", tmp_path / "johannesburg")
    assert len(api.diagnose(folder, adopt=True).written) == 1
    return folder


def test_residuals_and_tests_are_those_of_the_adopted_model(adopted: Path) -> None:
    # 28.1 arcsec and north at 10.1 +- 7 arcsec: the table of the specification.
    session = api.orient(adopted).to_dict()["sessions"][0]
    assert session["residual_rms_arcsec"] == pytest.approx(28.1, abs=0.06)
    north = (session["gyro_north"]["deg"] - 180.0 - 10.0 / 60.0) * 3600.0
    assert north == pytest.approx(10.1, abs=0.06)
    assert session["gyro_north"]["sigma_arcsec"] == pytest.approx(7.0, abs=1.0)
    assert session["dof"] == 15
    checks = {check.rule: check for check in api.check(adopted)}
    assert checks["fit"].value == pytest.approx(28.1, abs=0.06)
    assert checks["fit.lag1_correlation"].passed


@pytest.mark.parametrize("seed", [3, 4])
def test_a_twist_of_the_tripod_that_the_sights_tell_is_no_drift_of_north(
    tmp_path: Path, seed: int
) -> None:
    folder = tmp_path / "twist"
    api.simulate("reversal-run", folder, effects=["tripod_twist=60"], seed=seed)
    found = api.diagnose(folder, session="run-1").to_dict()
    oriented = api.orient(folder, session="run-1").to_dict()["sessions"][0]
    assert "midpoint_drift" not in {a["effect"] for a in found["adopted"]}
    assert found["verdict"] == "adequate"
    assert found["before"]["rms"] == pytest.approx(oriented["residual_rms_arcsec"], rel=1e-9)
    assert math.isfinite(found["averaged"]["sigma_arcsec"])
