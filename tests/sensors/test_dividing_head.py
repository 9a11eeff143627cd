"""A tilt sensor on a dividing head: the checkable numbers of source 000, and what is not there."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.api.sensors import LogOptions
from surveyapp.cli.main import main
from surveyapp.domain.calibration import Calibration
from surveyapp.errors import SurveyError

K1 = 477716.0
HEAD = "test,set,angle_deg,flip,output,frequency_hz,impedance_ohm,time_s"
COUNTS = LogOptions(units={"output": "LSB"})


def alternating(angles: np.ndarray, size: float) -> np.ndarray:
    """Deviations with no part in a line through the sine, the largest of ``size``."""
    sine = np.sin(np.radians(angles))
    design = np.column_stack([np.ones(angles.size), sine])
    shape = np.cos(np.arange(angles.size) * np.pi)
    shape = shape - design @ np.linalg.lstsq(design, shape, rcond=None)[0]
    return np.asarray(size * shape / np.abs(shape).max())


def static_rows(shares: dict[int, float]) -> list[str]:
    rows = []
    for number, span in ((1, 90.0), (2, 30.0), (3, 15.0)):
        angles = np.linspace(-span, span, 13)
        full = K1 * 2.0 * math.sin(math.radians(span))
        output = -1200.0 + K1 * np.sin(np.radians(angles))
        output += alternating(angles, shares.get(number, 0.0) / 100.0 * full)
        rows += [f"static,{number},{a:g},,{e:.6f},,," for a, e in zip(angles, output, strict=True)]
    return rows


def calibrated(tmp_path: Path, rows: list[str], options: LogOptions = COUNTS) -> Calibration:
    path = tmp_path / "head.csv"
    path.write_text("\n".join([HEAD, *rows]) + "\n")
    return api.calibrate("tilt", path, log=options)


def test_the_three_pairs_of_linearity_of_the_source(tmp_path: Path) -> None:
    result = calibrated(tmp_path, static_rows({1: 0.19, 2: 0.11, 3: 0.06}))
    assert result.value("sensitivity") == pytest.approx(K1)
    assert result.value("zero") == pytest.approx(-1200.0)
    for span, share, small in ((90, 0.19, 0.2177), (30, 0.11, 0.0630), (15, 0.06, 0.0178)):
        assert result.value(f"linearity_{span}") == pytest.approx(share, rel=1e-6)
        assert result.value(f"linearity_{span}_small_angle") == pytest.approx(small, abs=6e-5)
    arcsine = result.value("linearity_90_arcsine")
    assert arcsine is not None
    assert 3.0 < arcsine < 6.0  # 3.8 mg at the end of +-90 degrees is about 5 degrees
    assert result.value("transverse_sinusoid") is None
    assert result.geometry.undetermined == ()
    assert result.met


def with_output(row: str, output: float) -> str:
    cells = row.split(",")
    return ",".join([*cells[:4], f"{output:.0f}", *cells[5:]])


def test_outputs_that_do_not_follow_the_tilt_are_refused(tmp_path: Path) -> None:
    """Readings at the wrong angles were "good", with a sensitivity of less than a sigma."""
    rng = np.random.default_rng(1)
    rows = [with_output(row, rng.normal(0.0, K1)) for row in static_rows({})[:13]]
    result = calibrated(tmp_path, [*rows, "reversal,,,0,10,,,", "reversal,,,1,20,,,"])
    assert result.geometry.verdict == "refused"
    assert not result.met
    lost = {"sensitivity", "zero", "linearity_90", "tilt_reversal"}
    assert lost <= set(result.geometry.undetermined)
    assert all(result.value(name) is None for name in result.geometry.undetermined)


def test_a_single_row_off_the_line_is_told(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    rows = [with_output(r, float(r.split(",")[4]) + rng.normal(0, 300)) for r in static_rows({})]
    assert "outlying_row" not in {w.code for w in calibrated(tmp_path, rows).warnings}
    rows[7] = with_output(rows[7], float(rows[7].split(",")[4]) + 9000.0)
    texts = [w.text for w in calibrated(tmp_path, rows).warnings]
    assert any("at 15 degrees is off the line" in text for text in texts)


def test_transverse_by_seven_positions_misses_the_peak_and_the_sinusoid_does_not(
    tmp_path: Path,
) -> None:
    rows = static_rows({})
    for angle in range(0, 181, 30):
        for flip in (0, 1):
            output = -1200.0 + 0.052 * K1 * math.cos(math.radians(angle + 180 * flip - 45.0))
            rows.append(f"transverse,,{angle},{flip},{output:.6f},,,")
    result = calibrated(tmp_path, rows)
    assert result.value("transverse_sinusoid") == pytest.approx(5.2, rel=1e-6)
    assert result.value("transverse_direction") == pytest.approx(45.0, abs=1e-4)
    seven = 5.2 * math.cos(math.radians(15.0))
    assert result.value("transverse_seven_position") == pytest.approx(seven, rel=1e-6)
    assert math.degrees(0.052) == pytest.approx(2.98, abs=0.001)


def test_zero_stability_with_and_without_warm_up(tmp_path: Path) -> None:
    noise = np.random.default_rng(4).normal(size=720)
    noise = (noise - noise.mean()) / noise.std(ddof=1) * 81.3e-6 * K1
    quiet = calibrated(tmp_path, static_rows({}) + [f"zero,,,,{v:.6f},,," for v in noise])
    assert pytest.approx(38.8, abs=0.05) == 81.3e-6 * K1
    assert quiet.value("zero_stability") == pytest.approx(16.77, abs=0.005)
    ramp = noise + np.linspace(0.0, 200.0, noise.size)
    warm = calibrated(tmp_path, static_rows({}) + [f"zero,,,,{v:.6f},,," for v in ramp])
    assert warm.value("zero_stability") == pytest.approx(144e-6 * 206264.8, rel=0.03)
    assert warm.value("zero_stability_detrended") == pytest.approx(16.8, abs=0.1)
    assert "warm_up" in [w.code for w in warm.warnings]
    assert "warm_up" not in [w.code for w in quiet.warnings]


def test_reversal_and_capacitance(tmp_path: Path) -> None:
    tilt = math.radians(300.0 / 3600.0)
    rows = static_rows({})
    rows += [
        f"reversal,,,{f},{-500.0 + s * K1 * math.sin(tilt):.6f},,," for f, s in ((0, 1), (1, -1))
    ]
    for number, farad in ((1, 5.24e-12), (2, 5.16e-12)):
        for frequency in np.linspace(2000.0, 3000.0, 11):
            impedance = 1.0 / (2.0 * math.pi * frequency * farad)
            rows.append(f"capacitance,{number},,,,{frequency:g},{impedance:.3f},")
    assert 1.0 / (2.0 * math.pi * 2000.0 * 5.24e-12) == pytest.approx(15.19e6, rel=1e-3)
    result = calibrated(tmp_path, rows)
    assert result.value("tilt_reversal") == pytest.approx(300.0, abs=1e-3)
    assert result.value("capacitance_upper") == pytest.approx(5.24, abs=1e-6)
    assert result.value("capacitance_difference_over_mean") == pytest.approx(1.54, abs=0.005)
    assert result.value("capacitance_difference_over_sum") == pytest.approx(0.77, abs=0.005)


@pytest.mark.parametrize("kind", ["sweep", "step"])
def test_bandwidth_is_recovered_within_its_sigma(tmp_path: Path, kind: str) -> None:
    rng = np.random.default_rng(7)
    rows = static_rows({})
    if kind == "sweep":
        for frequency in np.geomspace(0.5, 50.0, 30):
            gain = 1.0 / math.sqrt(1.0 + (frequency / 8.0) ** 2)
            rows.append(f"dynamic,,,,{1000.0 * gain + rng.normal(0, 3.0):.4f},{frequency:.6f},,")
    else:
        for time in np.arange(0.0, 1.0, 0.002):
            value = 1000.0 * -math.expm1(-max(time - 0.2, 0.0) * 2.0 * math.pi * 8.0)
            rows.append(f"dynamic,,,,{value + rng.normal(0, 3.0):.4f},,,{time:.4f}")
    item = calibrated(tmp_path, rows).parameter("bandwidth")
    assert item.value is not None
    assert item.sigma is not None
    assert abs(item.value - 8.0) < 4.0 * item.sigma
    assert item.sigma < 0.2


def test_what_is_wrong_on_a_dividing_head_is_told(tmp_path: Path) -> None:
    rows = static_rows({})
    with pytest.raises(SurveyError, match="output has no unit"):
        calibrated(tmp_path, rows, LogOptions())
    with pytest.raises(SurveyError) as caught:
        calibrated(tmp_path, [*rows, "statik,1,0,,5,,,", "zero,,,,nan,,,"])
    told = [p.what for p in caught.value.problems]
    assert told == ["there is no such test", "output is not a number in 1 row of the test zero"]
    assert caught.value.problems[1].where.endswith("line 42")
    with pytest.raises(SurveyError, match="constant in the test static"):
        calibrated(tmp_path, [f"static,1,{a},,5,,," for a in range(-90, 91, 15)])
    short = calibrated(tmp_path, ["static,1,0,,5,,,", "static,1,10,,9,,,"])
    assert not short.met
    assert short.geometry.undetermined == ("sensitivity", "zero")


def test_a_log_without_a_test_ends_with_0_and_null(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "head.csv"
    path.write_text("\n".join([HEAD, *static_rows({})]) + "\n")
    assert main(["calibrate", "tilt", str(path), "--unit", "output=LSB", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    values = {p["name"]: p["value"] for p in result["parameters"]}
    assert values["zero_stability"] is None
    assert values["bandwidth"] is None
    assert result["geometry"] == {
        "verdict": "good", "condition": pytest.approx(1.0), "heading_sigma_deg": None,
        "coverage": None, "undetermined": [],
    }  # fmt: skip
    assert pytest.approx(K1, rel=1e-3) == 16777216.0 / 8.0 * 0.2278  # LSB/pF x pF/g


@pytest.mark.statistical
def test_the_sigma_of_linearity_is_the_scatter_of_repeated_tests(tmp_path: Path) -> None:
    """A cubic of 0.2 %FS under 100 LSB of noise, 40 times; chi-square: within a third of 40."""
    rng = np.random.default_rng(12)
    angles = np.linspace(-30.0, 30.0, 13)
    bend = 0.004 * K1 * (angles / 30.0) ** 3
    values, sigmas = [], []
    for _ in range(40):
        output = K1 * np.sin(np.radians(angles)) + bend + rng.normal(0.0, 100.0, 13)
        rows = [f"static,2,{a:g},,{e:.6f},,," for a, e in zip(angles, output, strict=True)]
        found = {p.name: p for p in calibrated(tmp_path, [*static_rows({})[:13], *rows]).parameters}
        item = found["linearity_30"]
        assert item.value is not None
        assert item.sigma is not None
        values.append(item.value)
        sigmas.append(item.sigma)
    assert np.sqrt(np.mean(np.square(sigmas))) == pytest.approx(np.std(values, ddof=1), rel=0.4)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("static,1,", "static,4,", "set of the test static is unknown"),
        ("reversal,,,1,", "reversal,,,180,", "flip of the test reversal is unknown"),
        ("static,3,15,", "static,3,0.2618,", ""),
        ("static,3,", "static,1,", ""),
    ],
)
def test_sets_and_flips_that_mean_nothing_are_refused(
    tmp_path: Path, old: str, new: str, what: str
) -> None:
    rows = [
        f"static,{number},{half * k / 6:g},,{1000.0 * math.sin(math.radians(half * k / 6))}"
        for number, half in ((1, 90), (3, 15))
        for k in range(-6, 7)
    ]
    rows += ["reversal,,,0,20", "reversal,,,1,-20"]
    path = tmp_path / "head.csv"
    text = "\n".join(["test,set,angle_deg,flip,output", *rows]) + "\n"
    path.write_text(text.replace(old, new))
    units = LogOptions(units={"output": "LSB"})
    if what:
        with pytest.raises(SurveyError, match=what):
            api.calibrate("tilt", path, log=units)
    else:
        assert api.calibrate("tilt", path, log=units).met


def test_angles_in_radians_are_refused(tmp_path: Path) -> None:
    angles = [math.radians(15.0 * k) for k in range(-6, 7)]
    rows = [f"static,1,{angle},,{1000.0 * math.sin(angle)}" for angle in angles]
    path = tmp_path / "head.csv"
    path.write_text("\n".join(["test,set,angle_deg,flip,output", *rows]) + "\n")
    with pytest.raises(SurveyError, match="not those of"):
        api.calibrate("tilt", path, log=LogOptions(units={"output": "LSB"}))
    units = LogOptions(units={"output": "LSB", "angle_deg": "rad"})
    assert api.calibrate("tilt", path, log=units).value("sensitivity") == pytest.approx(1000.0)
