"""Repeated azimuths of an instrument without a constant are told as what they are."""

import json
import re
from collections import Counter
from pathlib import Path

import pytest

from surveyapp import api


def test_a_campaign_without_known_azimuths_says_that_it_compares_azimuths(tmp_path: Path) -> None:
    folder = tmp_path / "campaign"
    api.simulate("campaign", folder, seed=3)
    project = folder / "project.toml"
    text = re.sub(r"^azimuth_known.*\n", "", project.read_text(), flags=re.MULTILINE)
    project.write_text(text.replace('purpose = "calibration"', 'purpose = "survey"'))
    found = api.diagnose(folder, campaign="G1", log=False).to_dict()
    codes = [item["code"] for item in found["warnings"]]
    assert "azimuths_for_constants" in codes
    # the truth: what the gyro reads of a line is its azimuth less the constant
    truth = json.loads((folder / "truth.json").read_text())
    lines = Counter(one["azimuth_deg"] for one in truth["sessions"].values())
    azimuth = lines.most_common(1)[0][0] - truth["constant_arcsec"] / 3600.0
    value = found["averaged"]
    gap = (value["arcsec"] / 3600.0 + azimuth + 180.0) % 360.0 - 180.0
    assert gap == pytest.approx(0.0, abs=4.0 * value["sigma_arcsec"] / 3600.0)
    assert "inus the gyro azimuth" in json.dumps(found["words"])
