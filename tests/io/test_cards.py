"""Instrument cards: units, overrides, contradictions."""

import math
from pathlib import Path

import pytest

from surveyapp.domain.instrument import InstrumentCard
from surveyapp.errors import SurveyError
from surveyapp.io.cards import installed_card_ids, load_card, read_card
from surveyapp.io.findings import Findings
from surveyapp_models.angles import ARCSEC

HERE = Path()
FULL = """
id = "own"
title = "Own gyro"
kind = "suspended"
source = "measured by ourselves"
scale_value_arcsec = 600.0
resolution_arcsec = 1.0
calibration_due = 2027-01-31
[period]
latitude_deg = 47.0
tracking_s = 425.4
clamped_s = 388.3
unspun_s = 146.0
sigma_s = 0.2
[torsion]
lambda = 0.20
[transit]
c_arcsec_per_div_s = 2.91
[sigma]
reversal_arcsec = 10.0
azimuth_arcsec = 20.0
scale_div = 0.1
time_s = 0.2
[tape_zero]
limit_div = 0.5
div_per_arcsec_tilt = 0.001
correction_arcsec_per_div = -120.0
latitude_deg = 47.0
[range]
latitude_max_deg = 75.0
temperature_c = [-20.0, 50.0]
[notes]
maker = "nobody"
"""


def own(folder: Path, text: str = FULL, **override: object) -> InstrumentCard:
    (folder / "own.toml").write_text(text, encoding="utf-8")
    return read_card("own.toml", base=folder, override=override)


def test_every_key_is_read_in_radians_and_seconds(tmp_path: Path) -> None:
    card = own(tmp_path)
    assert card.scale_value == pytest.approx(600 * ARCSEC)
    assert card.periods is not None
    assert card.periods.latitude == pytest.approx(math.radians(47))
    assert (card.periods.tracking_s, card.periods.clamped_s) == (425.4, 388.3)
    assert card.transit_c == pytest.approx(2.91 * ARCSEC)
    assert card.sigma.reversal == pytest.approx(10 * ARCSEC)
    assert card.tape_zero.correction_per_div == pytest.approx(-120 * ARCSEC)
    assert card.tape_zero.div_per_tilt == pytest.approx(0.001 / ARCSEC)
    assert card.valid.temperature_c == (-20.0, 50.0)
    assert card.valid.latitude_max == pytest.approx(math.radians(75))
    assert card.calibration_due == "2027-01-31"
    assert card.notes == (("maker", "nobody"),)


def test_overrides_merge_key_by_key(tmp_path: Path) -> None:
    card = own(tmp_path, scale_value_arcsec=590, sigma={"azimuth_arcsec": 4.0}, transit={})
    assert card.scale_value == pytest.approx(590 * ARCSEC)
    assert card.sigma.azimuth == pytest.approx(4 * ARCSEC)
    assert card.sigma.reversal == pytest.approx(10 * ARCSEC)


@pytest.mark.parametrize("name", installed_card_ids())
def test_installed_cards_read_without_findings(name: str) -> None:
    findings = Findings()
    card = load_card(name, base=HERE, override={}, findings=findings)
    assert card is not None
    assert (findings.problems, findings.warnings) == ([], [])
    assert card.id == name


def test_the_printed_accuracies_stand_in_the_cards() -> None:
    assert {"hgg05", "mom-gi-b1", "wild-gak1"} <= set(installed_card_ids())
    hgg05 = read_card("hgg05", base=HERE, override={})
    assert hgg05.sigma.azimuth == pytest.approx(5 * ARCSEC)
    assert "<= 5" in hgg05.source
    gib1 = read_card("mom-gi-b1", base=HERE, override={})
    assert gib1.tape_zero.correction_per_div is None
    assert any("-7.12" in text for _, text in gib1.notes)


def test_an_unknown_card_names_the_nearest() -> None:
    with pytest.raises(SurveyError, match="Did you mean wild-gak1"):
        read_card("wild-gak", base=HERE, override={})


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('source = "measured by ourselves"\n', "", ["source is missing"]),
        ("clamped_s = 388.3", "clamped_s = 430.0", ["425.4", "430"]),
        ("lambda = 0.20", "lambda = 0.22", ["0.22", "0.2002"]),
        ("lambda = 0.20", "lambda = -0.2", ["lambda", "more than 0"]),
        ("c_arcsec_per_div_s = 2.91", "c_arcsec_per_div_s = 0.0485", ["0.0485", "2.913"]),
        ("c_arcsec_per_div_s = 2.91", "c_arcsec_per_div_s = -2.91", ["-2.91", "2.913"]),
        ("latitude_deg = 47.0\ntracking", "tracking", ["latitude_deg is missing"]),
        ('kind = "suspended"', 'kind = "suspendet"', ["Did you mean suspended"]),
        ("[-20.0, 50.0]", "[50.0, -20.0]", ["no range"]),
        ("scale_value_arcsec = 600.0", "scale_value_arcsec = nan", ["no number"]),
        ("scale_value_arcsec = 600.0", "scale_value_arcsec = 0", ["not 0"]),
        ("scale_value_arcsec = 600.0", "scale_value_arcsec = 1e-300", ["at least 0.1"]),
        ("time_s = 0.2", "time_s = 0.0", ["more than 0"]),
    ],
)
def test_a_card_that_cannot_be_true_is_refused(
    tmp_path: Path, old: str, new: str, words: list[str]
) -> None:
    assert old in FULL
    with pytest.raises(SurveyError) as caught:
        own(tmp_path, FULL.replace(old, new))
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(("value", "fits"), [(0.1902, False), (0.1908, True), (0.21, True)])
def test_five_percent_is_the_border(tmp_path: Path, value: float, fits: bool) -> None:
    text = FULL.replace("lambda = 0.20", f"lambda = {value}")
    if fits:
        assert own(tmp_path, text).torsion_lambda == value
    else:
        with pytest.raises(SurveyError, match="contradicts"):
            own(tmp_path, text)


def test_unknown_card_keys_are_warnings(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(FULL.replace("time_s", "tme_s"), encoding="utf-8")
    findings = Findings()
    assert load_card("own.toml", base=tmp_path, override={}, findings=findings) is not None
    assert [w.code for w in findings.told()] == ["unknown_key"]
    assert "time_s" in findings.told()[0].text


def test_a_missing_own_card_is_a_problem(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="does not exist"):
        read_card("cards/own.toml", base=tmp_path, override={})
