"""What a diagnosis named and a person adopted is taken out of the log by the commands after it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api


def test_a_compass_with_a_switch_is_refused_diagnosed_adopted_and_then_calibrated(
    tmp_path: Path,
) -> None:
    effects = ["interference_step=15", "gross_error=10", "hard_iron=8"]
    made = api.simulate("compass", tmp_path / "c", seed=4, effects=effects)
    truth = json.loads(Path(made.truth).read_text())["effects"]
    assert api.calibrate("compass", made.folder, sensor="compass").geometry.verdict == "refused"
    api.diagnose_log(made.folder, sensor="compass", adopt=True)
    found = api.calibrate("compass", made.folder, sensor="compass")
    assert found.geometry.verdict == "good"
    # one of the eight rows beside another is told by its neighbours only
    assert found.n >= 2400 - 8
    for axis, value in zip("xyz", truth[2]["uT"], strict=True):
        item = found.parameter(f"hard_iron_{axis}")
        assert item.value is not None
        assert item.sigma is not None
        assert abs(item.value - value) < 4.0 * item.sigma
    codes = [warning.code for warning in found.warnings]
    assert codes.count("adopted_applied") == 2
    assert codes.count("adopted_not_applied") == 1  # the iron is the calibration's own


def test_a_warm_up_is_taken_out_and_a_changed_log_is_left_alone(tmp_path: Path) -> None:
    made = api.simulate("tilt", tmp_path / "t", seed=2, effects=["warm_up=30"])
    folder = Path(made.folder)
    before = api.calibrate("tilt", folder, sensor="tilt")
    api.diagnose_log(folder, sensor="tilt", adopt=True)
    after = api.calibrate("tilt", folder, sensor="tilt")
    assert before.after.rms is not None
    assert after.after.rms == pytest.approx(1.0, rel=0.15)  # 1" of noise, 336 readings
    assert before.after.rms > 2.0
    zero = after.parameter("zero_along")
    assert zero.value is not None
    assert abs(zero.value - 15.0) < 1.0
    log = folder / "sensors/tilt.csv"
    lines = log.read_text().splitlines()
    log.write_text("\n".join(lines[:-1]) + "\n")
    changed = api.calibrate("tilt", folder, sensor="tilt")
    assert "adopted_not_applied" in [w.code for w in changed.warnings]
    assert changed.after.rms is not None
    assert np.isclose(changed.after.rms, before.after.rms, rtol=0.05)


def test_a_long_log_is_thinned_and_its_gross_errors_keep_their_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = api.simulate("compass", tmp_path / "c", seed=4, effects=["hard_iron=8"])
    whole = api.calibrate("compass", made.folder, sensor="compass")
    monkeypatch.setattr("surveyapp.workflows.calibrating.request.MOST_ROWS", 700)
    monkeypatch.setattr("surveyapp.workflows.diagnosing_log.MOST_ROWS", 700)
    thin = api.calibrate("compass", made.folder, sensor="compass")
    assert (whole.n, thin.n) == (2400, 600)
    assert "one in 4 is used" in next(w.text for w in thin.warnings if w.code == "thinned")
    for a, b in zip(whole.parameters[:3], thin.parameters[:3], strict=True):
        assert a.sigma is not None
        assert b.sigma is not None
        assert b.sigma == pytest.approx(2.0 * a.sigma, rel=0.2)  # a quarter of the rows
    log = Path(made.folder) / "sensors/compass.csv"
    lines = log.read_text().splitlines()
    cells = lines[1 + 1200].split(",")
    cells[1] = "500"
    lines[1 + 1200] = ",".join(cells)
    log.write_text("\n".join(lines) + "\n")
    document = api.diagnose_log(made.folder).to_dict()
    (gross,) = [a for a in document["adopted"] if a["effect"] == "gross_error"]
    assert [c["name"] for c in gross["coefficients"]] == ["row 1201"]


def test_blocks_of_any_size_are_corrected_alike(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = api.simulate("compass", tmp_path / "c", seed=4, effects=["hard_iron=8"])
    card, log = tmp_path / "c.toml", Path(made.folder) / "sensors/compass.csv"
    api.calibrate("compass", made.folder, sensor="compass", card=card)
    api.compensate("compass", log, card=card, out=tmp_path / "a.csv")
    monkeypatch.setattr("surveyapp.workflows.compensating.BLOCK_ROWS", 7)
    monkeypatch.setattr("surveyapp.io.sensor_logs.writing.BLOCK_ROWS", 3)
    again = api.compensate("compass", log, card=card, out=tmp_path / "b.csv")
    assert again.rows == 2400
    one, other = ((tmp_path / f"{n}.csv").read_text().splitlines() for n in "ab")
    assert one[0] == other[0]
    for a, b in zip(one[1:], other[1:], strict=True):  # products of blocks round differently
        assert a.split(",")[-1] == b.split(",")[-1] == "MAGNETIC"
        numbers = [[float(v) for v in line.split(",")[:-1]] for line in (a, b)]
        assert np.allclose(numbers[0], numbers[1], rtol=1e-9)
