"""The measured sensor logs among the samples: sizes, sources, and what is known of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveyapp import api

PROJECTS = Path(__file__).resolve().parents[2] / "projects"
SAMPLES = ("broad-attached-magnet", "mpu6050-static", "xsens-multi-position")


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_small_and_names_source_and_licence(name: str) -> None:
    folder = PROJECTS / name
    source = (folder / "SOURCE.md").read_text(encoding="utf-8")
    for word in ("Repository: https://", "commit", "Author", "Licence", "What was changed"):
        assert word in source
    assert (folder / "LICENSE.upstream.txt").stat().st_size > 1000
    assert sum(path.stat().st_size for path in folder.glob("sensors/*")) <= 300_000


def test_the_attached_magnet_is_refused_by_the_calibration_and_named_by_the_diagnosis() -> None:
    """The magnet was on from 42.4 to 98.6 s and made 26.9 uT."""
    folder = PROJECTS / "broad-attached-magnet"
    assert not api.calibrate("compass", folder).met
    document = api.diagnose_log(folder).to_dict()
    adopted = document["adopted"]
    assert [item["effect"] for item in adopted] == ["interference_step"]
    values = {item["name"]: item["value"] for item in adopted[0]["coefficients"]}
    assert values["on_s"] == pytest.approx(42.4, abs=0.5)
    assert values["off_s"] == pytest.approx(98.6, abs=0.5)
    step = sum(values[f"step_{axis}"] ** 2 for axis in "xyz") ** 0.5
    assert step == pytest.approx(26.9, abs=0.5)


def test_the_multi_position_record_needs_misalignments() -> None:
    """.034, .029 and .001 m/s2 with bias and scale, three scales and misalignments."""
    found = api.calibrate("rate", PROJECTS / "xsens-multi-position")
    rms = [model.rms for model in found.models]
    assert rms == pytest.approx([0.034, 0.029, 0.001], abs=0.0006)


def test_the_noise_of_the_gyro_at_rest_stops_to_average_out() -> None:
    """Data sheet of the MPU-6050: .005 deg/s/sqrt(Hz), that is .3 deg/sqrt(h); drift after 30 s."""
    (channel,) = api.allan(PROJECTS / "mpu6050-static").channels
    walk = next(item for item in channel.coefficients if item.symbol == "N")
    assert walk.value is not None
    assert 0.2 < walk.value < 1.0
    lowest = channel.taus_s[channel.deviation.index(min(channel.deviation))]
    assert 20.0 < lowest < 60.0
