"""``calibrate edm``: a distance meter on a baseline, measured and simulated."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.domain.calibration import Calibration
from surveyapp.errors import SurveyError
from tests.network.test_edm_baseline import FOLDER, STEM, measured, simulated

NAMES = ("from_pillar", "to_pillar", "slope_distance_m", "temperature_c", "pressure_hpa",
         "humidity_percent")  # fmt: skip


def written(path: Path, seed: int, **truth: float | bool) -> Path:
    """A simulated baseline as a table."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        rows.writerow(NAMES)
        for r in simulated(seed, **truth):  # type: ignore[arg-type]
            rows.writerow([r.start, r.end, repr(r.slope_m), r.temperature_c, r.pressure_hpa,
                           r.humidity_percent])  # fmt: skip
    return path


def chosen(result: Calibration) -> str:
    return next(model.id for model in result.models if model.chosen)


class TestCurtin:
    pytestmark = measured

    @pytest.fixture(scope="class")
    def result(self) -> Calibration:
        heights = str(FOLDER / f"{STEM}level_observation.csv")
        return api.calibrate(
            "edm", FOLDER / f"{STEM}edm_observation.csv", options={"heights": heights}
        )

    def test_heights_explain_it_and_no_term_is_adopted(self, result: Calibration) -> None:
        assert chosen(result) == "reduced"
        assert result.before.rms == pytest.approx(1.944, abs=5e-4)
        assert result.after.rms == pytest.approx(0.390, abs=5e-4)
        held = {m.id: m.held_out_rms or 0.0 for m in result.models}
        assert held["reduced"] < min(held[k] for k in ("as_read", "constant", "cyclic"))

    def test_the_atmosphere_is_not_applied_again(self, result: Calibration) -> None:
        assert result.extra["atmosphere"]["verdict"] == "already_applied"
        again = next(m for m in result.models if m.id == "atmosphere")
        assert again.rms == pytest.approx(1.101, abs=5e-4)

    def test_readings_of_one_pointing_count_once(self, result: Calibration) -> None:
        assert (result.n, result.extra["pointings"]) == (457, 108)
        # 0.035 mm if 457 readings counted each for itself (Rueger 1996, 12.2): the pointings say
        sigma = result.parameter("constant_mm").sigma
        assert sigma is not None
        assert sigma > 0.06


def test_a_constant_and_a_cyclic_term_are_adopted(tmp_path: Path) -> None:
    log = written(tmp_path / "line.csv", 3, cyclic_m=1.5e-3, constant_m=2e-3)
    result = api.calibrate("edm", log, options={"unit_length_m": 1.5})
    assert chosen(result) == "cyclic"
    for name, truth in (("constant_mm", 2.0), ("cyclic_sine_mm", 1.5), ("cyclic_cosine_mm", 0.0)):
        found = result.parameter(name)
        assert found.value is not None
        assert found.sigma is not None
        assert abs(found.value - truth) < 4.0 * found.sigma
    free = api.calibrate("edm", log)
    assert free.value("unit_length_m") == 1.5
    # tried are three unit lengths: the probability is three times that of the one that was stated
    assert free.extra["cyclic"]["p"] == pytest.approx(3.0 * result.extra["cyclic"]["p"])


@pytest.mark.parametrize(("applied", "model"), [(True, "as_read"), (False, "atmosphere")])
def test_nothing_is_adopted_where_nothing_is(tmp_path: Path, applied: bool, model: str) -> None:
    result = api.calibrate("edm", written(tmp_path / "line.csv", 5, applied=applied))
    assert chosen(result) == model
    assert {w.code for w in result.warnings} >= {"no_heights"}


def test_a_term_of_more_than_5_mm_is_not_believed(tmp_path: Path) -> None:
    log = written(tmp_path / "line.csv", 2, cyclic_m=8e-3)
    result = api.calibrate("edm", log, options={"unit_length_m": 1.5})
    assert chosen(result) != "cyclic"
    assert "cyclic_implausible" in {w.code for w in result.warnings}


def test_json_and_exit_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, card = written(tmp_path / "line.csv", 1, constant_m=3e-3), tmp_path / "edm.toml"
    assert main(["calibrate", "edm", str(log), "--json", "--card", str(card)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "surveyapp.calibrate/1"
    assert found["kind"] == "edm"
    assert 'kind = "edm"' in card.read_text(encoding="utf-8")
    assert main(["calibrate", "edm", str(log)]) == 0
    assert "constant_mm" in capsys.readouterr().out


def test_what_is_wrong_is_told_together(tmp_path: Path) -> None:
    log = tmp_path / "line.csv"
    rows = ["A,A,20.0,5000", "A,B,1e9,1000", "A,B,20.0,1000"]
    log.write_text("\n".join(["from_pillar,to_pillar,slope_distance_m,pressure_hpa", *rows]))
    with pytest.raises(SurveyError) as caught:
        api.calibrate("edm", log)
    told = " ".join(problem.what for problem in caught.value.problems)
    for words in ("to itself", "slope_distance_m cannot be right", "pressure_hpa cannot be right"):
        assert words in told


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("from_pillar,to_pillar,slope_distance_m\nA,B,10.0\nA,B,10.1\n", "determine no constant"),
        ("a,b,slope_distance_m\nA,B,10.0\nB,C,10.1\n", "from_pillar is missing"),
        ("from_pillar,to_pillar,slope_distance_m\nA,B,x\nB,C,10\n", ""),
    ],
)
def test_refusals(tmp_path: Path, text: str, words: str) -> None:
    log = tmp_path / "line.csv"
    log.write_text(text)
    with pytest.raises(SurveyError) as caught:
        api.calibrate("edm", log)
    assert words in " ".join(problem.what for problem in caught.value.problems)


def test_unit_length_and_heights_are_checked(tmp_path: Path) -> None:
    log = written(tmp_path / "line.csv", 1)
    heights = tmp_path / "h.csv"
    heights.write_text("pillar,height_m\n0,1.0\n1,nan\n1,2\n0,7\n")
    for options, words in (
        ({"unit_length_m": -3.0}, "no unit length"),
        ({"heights": str(heights)}, "two heights"),
        ({"heights": str(tmp_path / "none.csv")}, ""),
    ):
        with pytest.raises(SurveyError) as caught:
            api.calibrate("edm", log, options=options)
        assert words in " ".join(problem.what for problem in caught.value.problems)


def test_the_same_sight_later_is_another_pointing() -> None:
    readings = simulated(1)
    from surveyapp.core.edm import horizontal_lengths, sight_means

    again = [*readings, *readings[:5]]
    first, _ = sight_means(readings, horizontal_lengths(readings))
    second, means = sight_means(again, horizontal_lengths(again))
    assert len(second) == len(first) + 1
    assert np.isfinite(means).all()
