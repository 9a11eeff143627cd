"""The loop, end to end: an undeclared effect in the data, found, adopted, used by orient."""

import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.errors import SurveyError

ROOT = Path(__file__).resolve().parents[2]


def later_error(folder: Path) -> tuple[float, float]:
    """Error and sigma of the line that no determination of the campaign has seen [arcsec]."""
    truth = json.loads((folder / "truth.json").read_text())["sessions"]
    line = api.orient(folder).lines[0].to_dict()
    error = line["true_azimuth"]["deg"] - truth["later-01"]["azimuth_deg"]
    return (error + 180.0) % 360.0 * 3600.0 - 648000.0, line["true_azimuth"]["sigma_arcsec"]


def pooled_copy(folder: Path) -> Path:
    """The same project with the mean of the determinations as its constant."""
    copy = shutil.copytree(folder, folder.with_name(f"{folder.name}-pooled"))
    path = copy / "project.toml"
    text = path.read_text(encoding="utf-8")
    assert 'serial = "' in text
    path.write_text(text.replace('serial = "', 'constant_choice = "pooled"\nserial = "', 1))
    return copy


@pytest.mark.statistical
def test_undeclared_temperature_effect_is_found_adopted_and_used(tmp_path: Path) -> None:
    before, average, after = [], [], []
    for seed in range(1, 6):
        folder = tmp_path / str(seed)
        api.simulate("campaign", folder, effects=["temperature=1.5"], seed=seed)
        before.append(later_error(pooled_copy(folder)))
        average.append(later_error(folder))
        found = api.diagnose(folder, campaign="G1", adopt=True)
        assert found.diagnosis is not None
        assert [item.effect for item in found.diagnosis.adopted] == ["temperature"]
        assert found.written == ("project.toml, instrument G1, effect temperature",)
        coefficient = found.diagnosis.adopted[0].coefficients[0]
        assert coefficient.sigma is not None
        assert abs(coefficient.value - 1.5) < 4.0 * coefficient.sigma
        after.append(later_error(folder))
    rms_before = math.sqrt(np.mean([error**2 for error, _ in before]))
    rms_after = math.sqrt(np.mean([error**2 for error, _ in after]))
    assert rms_after < 0.5 * rms_before
    # honest after: sum of (error/sigma)^2 of five lines within the 99.9 % of chi-square(5)
    assert sum((error / sigma) ** 2 for error, sigma in after) < 20.5
    assert np.mean([sigma for _, sigma in after]) < 0.6 * np.mean([sigma for _, sigma in before])
    # nothing adopted: the average over what may be at work predicts well, a name sharpens it
    rms_average = math.sqrt(np.mean([error**2 for error, _ in average]))
    assert rms_average < 0.5 * rms_before
    assert sum((error / sigma) ** 2 for error, sigma in average) < 20.5
    assert np.mean([s for _, s in after]) < 0.9 * np.mean([s for _, s in average])


def test_outside_its_range_an_adopted_effect_is_held_and_the_sigma_enlarged(tmp_path: Path) -> None:
    folder = tmp_path / "campaign"
    api.simulate("campaign", folder, effects=["temperature=1.5"], seed=3)
    api.diagnose(folder, campaign="G1", adopt=True)
    inside = api.orient(folder).lines[0].to_dict()
    # the mine is as hot as it never was during the campaign
    for book in (folder / "observations").glob("later-*.csv"):
        lines = book.read_text().splitlines()
        place = lines[0].split(",").index("temperature_c")
        rows = [line.split(",") for line in lines[1:]]
        for row in rows:
            row[place] = "45.0"
        book.write_text("\n".join([lines[0], *(",".join(row) for row in rows)]) + "\n")
    result = api.orient(folder)
    outside = result.lines[0].to_dict()
    assert any(warning.code == "effect_outside_range" for warning in result.warnings)
    high = next(e for e in api.open_project(folder).instruments[0].effects).valid[0][2]
    excess = 1.5 * (45.0 - high)
    # four sessions share the line, and the excess: it does not average out
    assert outside["true_azimuth"]["sigma_arcsec"] > inside["true_azimuth"]["sigma_arcsec"]
    assert outside["true_azimuth"]["sigma_arcsec"] > 0.9 * excess


def test_quiet_campaign_adopts_nothing_and_writes_nothing(tmp_path: Path) -> None:
    adopted = 0
    for seed in range(20, 25):
        folder = tmp_path / str(seed)
        api.simulate("campaign", folder, seed=seed)
        text = (folder / "project.toml").read_bytes()
        found = api.diagnose(folder, campaign="G1", adopt=True)
        adopted += bool(found.written)
        if not found.written:
            assert (folder / "project.toml").read_bytes() == text
    # family level 5 %: 3 or more of 5 have probability 0.0012
    assert adopted <= 2


def test_adopted_step_of_a_run_changes_its_north_and_its_sigma(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    api.simulate("reversal-run", folder, effects=["midpoint_step=40,at=0.5"], seed=6)
    truth = json.loads((folder / "truth.json").read_text())["sessions"]["run-1"]
    before = api.orient(folder, session="run-1").sessions[0]
    found = api.diagnose(folder, session="run-1", confirm="run-2", adopt=True)
    assert found.diagnosis is not None
    assert [item.effect for item in found.diagnosis.adopted] == ["midpoint_step"]
    after = api.orient(folder, session="run-1").sessions[0]
    assert after.estimator == "least-squares with midpoint_step"
    assert before.gyro_north is not None
    assert after.gyro_north is not None
    assert after.gyro_north.sigma < 0.6 * before.gyro_north.sigma
    kinds = [
        json.loads(line)["kind"] for line in (folder / "ledger.jsonl").read_text().splitlines()
    ]
    assert kinds == ["diagnosis", "adoption"]
    again = api.diagnose(folder, session="run-1", adopt=True)
    assert again.written == ()
    assert len(api.open_project(folder).session("run-1").effects) == 1
    error = (math.degrees(after.gyro_north.value) - truth["run_mean_north_deg"]) * 3600.0
    assert abs(error) < 4.0 * math.degrees(after.gyro_north.sigma) * 3600.0


def test_without_a_selector_the_subjects_are_listed(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    api.simulate("reversal-run", folder, seed=1)
    listed = api.diagnose(folder).to_dict()
    assert listed["schema"] == "surveyapp.diagnose/1"
    kinds = {(item["option"], item["id"]) for item in listed["subjects"]}
    assert {("--session", "run-1"), ("--session", "cal-2"), ("--campaign", "G1")} <= kinds
    with pytest.raises(SurveyError, match="one subject"):
        api.diagnose(folder, adopt=True)
    with pytest.raises(SurveyError, match="run-1"):
        api.diagnose(folder, session="run1")


def test_samples_get_their_honest_verdicts(tmp_path: Path) -> None:
    for name in ("johannesburg-1966", "gi-b1-1966", "tongjin-2015"):
        shutil.copytree(ROOT / "projects" / name, tmp_path / name)
    johannesburg = api.diagnose(tmp_path / "johannesburg-1966").to_dict()
    # diagnosis.md, the measured case
    assert [item["effect"] for item in johannesburg["adopted"]] == ["damping_break"]
    assert johannesburg["verdict"] == "not_separable"
    assert johannesburg["before"]["rms"] == pytest.approx(119.7, abs=0.05)
    assert johannesburg["after"]["rms"] == pytest.approx(28.1, abs=0.05)
    assert johannesburg["after_best"]["rms"] == pytest.approx(16.4, abs=0.05)
    rivals = set(johannesburg["ambiguous"][0]["any_of"])
    assert {"midpoint_step", "warm_up"} <= rivals
    tongjin = api.diagnose(tmp_path / "tongjin-2015").to_dict()
    assert tongjin["verdict"] == "not_separable"
    rivals = set(tongjin["ambiguous"][0]["any_of"])
    assert {"line_offset", "transport_step", "time_drift"} <= rivals
    assert tongjin["ambiguous"][0]["separate_by"]
    assert api.diagnose(tmp_path / "gi-b1-1966").to_dict()["verdict"] == "adequate"
