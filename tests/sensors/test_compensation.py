"""A card applied to a log: the truth comes back within its sigma, and only where the card holds."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp import api
from surveyapp.api.sensors import LogOptions
from surveyapp.cli.main import main
from surveyapp.errors import SurveyError
from surveyapp_models.arrays import Floats


def simulated(tmp_path: Path, kind: str, *effects: str, seed: int = 1) -> tuple[Path, Any]:
    made = api.simulate(kind, tmp_path / kind, effects=effects, seed=seed)
    return Path(made.folder), json.loads(Path(made.truth).read_text())


def columns(path: Path, *names: str) -> Floats:
    head = path.read_text().split("\n", 1)[0].split(",")
    places = [head.index(name) for name in names]
    return np.loadtxt(path, delimiter=",", skiprows=1, usecols=places, ndmin=2)


def test_a_tilt_log_is_corrected_to_its_reference(tmp_path: Path) -> None:
    folder, truth = simulated(tmp_path, "tilt", "cross_axis=2", "temperature=1")
    card, out = tmp_path / "tilt.toml", tmp_path / "out.csv"
    result = api.calibrate("tilt", folder, card=card)
    assert result.value("cross_along") == pytest.approx(0.02, abs=4e-4)
    assert result.value("temperature_along") == pytest.approx(1.0, abs=0.1)
    made = api.compensate("tilt", folder, card=card, out=out)
    assert made.rows == 168
    true = columns(out, "tilt_along_arcsec", "tilt_across_arcsec")
    reference = columns(folder / "sensors/tilt.csv", "ref_along_arcsec", "ref_across_arcsec")
    sigma = columns(out, "sigma_along_arcsec", "sigma_across_arcsec")
    assert np.std(true - reference) == pytest.approx(truth["sigma_arcsec"], rel=0.15)
    assert 0.9 < np.mean(np.abs(true - reference) < 1.96 * sigma) < 0.99


def test_a_compass_log_is_corrected_to_the_true_heading(tmp_path: Path) -> None:
    folder, _ = simulated(tmp_path, "compass", "hard_iron=12", "soft_iron=6")
    card, out = tmp_path / "c.toml", tmp_path / "out.csv"
    assert api.calibrate("compass", folder, card=card).geometry.verdict == "good"
    result = api.compensate("compass", folder, card=card, out=out, declination="2.0,0.4")
    assert result.reference == "ASTRONOMIC"
    q = columns(folder / "sensors/compass.csv", "ref_qw", "ref_qx", "ref_qy", "ref_qz")
    w, x, y, z = q.T
    north = np.column_stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z)])
    truth = np.degrees(np.arctan2(-north[:, 1], north[:, 0]))
    found = columns(out, "heading_deg", "heading_sigma_deg")
    steep = np.hypot(north[:, 0], north[:, 1]) < 0.5  # the mark far from level
    error = (found[:, 0] - 2.0 - truth + 180.0) % 360.0 - 180.0
    assert np.median(np.abs(error[~steep])) < 1.0
    assert np.all(found[:, 1] >= 0.4)


def test_outside_its_days_temperatures_and_instrument_a_card_is_refused(tmp_path: Path) -> None:
    folder, _ = simulated(tmp_path, "tilt")
    card, out = tmp_path / "tilt.toml", tmp_path / "out.csv"
    project = folder / "project.toml"
    project.write_text(project.read_text() + 'instrument = "A"\ncalibrated_on = 2026-03-01\n')
    api.calibrate("tilt", folder, card=card)
    text = card.read_text()
    assert 'instrument = "A"' in text
    card.write_text(text.replace("temperature_c = [", "temperature_c = [99.0, 100.0] #"))
    project.write_text(project.read_text().replace('"A"', '"B"').replace("2026-03", "2025-03"))
    with pytest.raises(SurveyError) as caught:
        api.compensate("tilt", folder, card=card, out=out)
    told = [p.what for p in caught.value.problems]
    assert told == [
        "the card does not hold on this day",
        "the card does not hold at these temperatures",
        "the card is of another instrument",
    ]
    assert not out.exists()


def test_a_declination_is_added_to_magnetic_headings_only(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, _ = simulated(tmp_path, "tilt")
    card, out = tmp_path / "t.toml", str(tmp_path / "o.csv")
    api.calibrate("tilt", folder, card=card)
    command = ["compensate", "tilt", str(folder), "--card", str(card), "-o", out]
    assert main([*command, "--declination", "2"]) == 2
    assert "magnetic headings only" in capsys.readouterr().err
    assert main(["compensate", "compass", str(folder), "--card", str(card), "-o", out]) == 2
    assert main([*command, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["schema"] == "surveyapp.compensate/1"


def test_a_gyro_card_is_undone(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    true = rng.normal(0.0, 0.2, (50, 3))
    e = np.array([[0.0, 50.0, -30.0], [20.0, 0.0, 10.0], [-40.0, 60.0, 0.0]]) * math.pi / 648000.0
    gain, bias = 1.0 + 1e-6 * np.array([300.0, -200.0, 100.0]), np.radians([5.0, -3.0, 8.0]) / 3600
    rates = (true @ (np.eye(3) + e).T) * gain + bias
    log, card, out = tmp_path / "g.csv", tmp_path / "g.toml", tmp_path / "o.csv"
    names = ["time_s", "gyr_x_rad_s", "gyr_y_rad_s", "gyr_z_rad_s"]
    np.savetxt(log, np.column_stack([np.arange(50), rates]), delimiter=",", header=",".join(names),
               comments="", fmt="%.15g")  # fmt: skip
    lines = ['id = "g"', 'title = "g"', 'kind = "rate"', 'source = "here"']
    for i, a in enumerate("xyz"):
        stated = [("scale_factor", (gain[i] - 1) * 1e6, "ppm"), ("bias", [5, -3, 8][i], "deg/h")]
        stated += [(f"misalignment_{a}{b}", e[i, j] * 648000.0 / math.pi, "arcsec")
                   for j, b in enumerate("xyz") if i != j]  # fmt: skip
        for name, value, unit in stated:
            full = name if name.startswith("mis") else f"{name}_{a}"
            lines += [f"[parameter.{full}]", f"value = {float(value)!r}", f'unit = "{unit}"']
    card.write_text("\n".join(lines) + "\n")
    api.compensate("rate", log, card=card, out=out)
    assert np.allclose(columns(out, *names[1:]), true, atol=1e-10)


def test_simulated_noise_has_the_stated_coefficients(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "n"
    assert (
        main(["simulate", "noise", str(out), "--coefficient", "N=0.3", "B=10", "--seed", "4"]) == 0
    )
    result = api.allan(out, log=LogOptions())
    found = {c.symbol: c for c in result.channels[0].coefficients}
    for symbol, value in (("N", 0.3), ("B", 10.0)):
        item = found[symbol]
        assert item.value is not None
        assert item.sigma is not None
        assert abs(item.value - value) < 4.0 * item.sigma
    assert main(["simulate", "noise", str(tmp_path / "m"), "--coefficient", "X=1", "N=x"]) == 2
    assert capsys.readouterr().err.count("coefficient") >= 2
    assert main(["simulate", "tilt", str(tmp_path / "m"), "--coefficient", "N=1"]) == 2


def test_a_card_of_another_compass_is_told(tmp_path: Path) -> None:
    own = api.simulate("compass", tmp_path / "a", seed=1, effects=["hard_iron=12"])
    other = api.simulate("compass", tmp_path / "b", seed=2, effects=["hard_iron=12"])
    card = tmp_path / "a.toml"
    api.calibrate("compass", own.folder, sensor="compass", card=card)
    card.write_text(re.sub(r"temperature_c = .*", "temperature_c = [-40, 60]", card.read_text()))
    for made, told in ((own, False), (other, True)):
        log = Path(made.folder) / "sensors/compass.csv"
        result = api.compensate("compass", log, card=card, out=tmp_path / "out.csv")
        assert ("field_differs" in [w.code for w in result.warnings]) is told


def swung(path: Path, rng: np.random.Generator, *, rows: int) -> tuple[Path, Floats]:
    """A level swing made by hand: deviation 1.5 - 2 sin psi + 3 cos psi, .3 uT per reading."""
    psi = np.arange(rows) * 2.0 * np.pi / rows
    shown = psi - np.radians(1.5 - 2.0 * np.sin(psi) + 3.0 * np.cos(psi))
    level, down = 50.0 * math.cos(math.radians(65.0)), -50.0 * math.sin(math.radians(65.0))
    field = np.column_stack([level * np.cos(shown), level * np.sin(shown), np.full(rows, down)])
    field += 0.3 * rng.normal(size=field.shape)
    table = np.column_stack([np.arange(rows), field, np.tile([0.0, 0.0, 9.8], (rows, 1))])
    names = "time_s,mag_x_uT,mag_y_uT,mag_z_uT,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,heading_deg"
    table = np.column_stack([table, np.degrees(psi)])
    np.savetxt(path, table, delimiter=",", header=names, comments="")
    return path, np.degrees(psi)


def test_the_sigma_of_a_heading_by_a_swing_holds_the_noise_of_its_reading(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    path, _ = swung(tmp_path / "swing.csv", rng, rows=72)
    card, out = tmp_path / "swing.toml", tmp_path / "out.csv"
    api.calibrate("compass", path, card=card)
    path, truth = swung(tmp_path / "later.csv", rng, rows=200)
    told = api.compensate("compass", path, card=card, out=out, declination="0")
    assert "no_declination_sigma" in [w.code for w in told.warnings]
    of_model = columns(out, "heading_sigma_deg")[:, 0]
    told = api.compensate("compass", path, card=card, out=out, declination="0,0")
    assert "no_declination_sigma" not in [w.code for w in told.warnings]
    found = columns(out, "heading_deg", "heading_sigma_deg")
    added = np.sqrt(of_model**2 - found[:, 1] ** 2)
    assert np.ptp(added) < 1e-4
    assert 0.31 <= added[0] <= 0.5001, "WMM2020 technical report: of a model"
    error = (found[:, 0] - truth + 180.0) % 360.0 - 180.0
    assert 0.90 < np.mean(np.abs(error) < 1.96 * found[:, 1]) < 0.99


def test_what_a_log_does_not_hold_widens_what_is_computed_from_it(tmp_path: Path) -> None:
    folder, _ = simulated(tmp_path, "compass", "hard_iron=12")
    card, out = tmp_path / "c.toml", tmp_path / "out.csv"
    api.calibrate("compass", folder, card=card)
    made = api.compensate("compass", folder, card=card, out=out)
    table = columns(folder / "sensors/compass.csv", "time_s", "mag_x_uT", "mag_y_uT", "mag_z_uT")
    bare = tmp_path / "bare.csv"
    np.savetxt(bare, table, delimiter=",", header="time_s,mag_x_uT,mag_y_uT,mag_z_uT", comments="")
    told = api.compensate("compass", bare, card=card, out=tmp_path / "bare_out.csv")
    assert "not_tilt_compensated" in [w.code for w in told.warnings]
    whole = columns(out, "heading_deg")[:, 0]
    found = columns(tmp_path / "bare_out.csv", "heading_deg", "heading_sigma_deg")
    error = (found[:, 0] - whole + 180.0) % 360.0 - 180.0
    assert np.median(np.abs(error)) < 1.96 * np.median(found[:, 1])
    assert made.heading_sigma_deg is not None

    folder, _ = simulated(tmp_path, "tilt", "temperature=1")
    card = tmp_path / "t.toml"
    api.calibrate("tilt", folder, card=card)
    names = ("time_s", "tilt_along_arcsec", "tilt_across_arcsec", "ref_along_arcsec")
    table = columns(folder / "sensors/tilt.csv", *names)
    np.savetxt(bare, table, delimiter=",", header=",".join(names), comments="")
    api.compensate("tilt", bare, card=card, out=out)
    found = columns(out, "tilt_along_arcsec", "sigma_along_arcsec")
    error = found[:, 0] - table[:, 3]
    assert np.sqrt(np.mean(error**2)) == pytest.approx(np.mean(found[:, 1]), rel=0.35)
