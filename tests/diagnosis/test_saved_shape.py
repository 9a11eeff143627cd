"""An unnamed shape is saved, tried on another run, and told as not explained but recurrent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveyapp.cli.main import main
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.subjects.reversal_run import TurningPoints, reversal_run
from surveyapp.errors import SurveyError
from surveyapp.io.user_effects.loading import load_effects
from surveyapp.workflows.saving_shape import shape_text
from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.effect import Effect


def run(seed: int, *, size: float = 1.0, points: int = 45, extra: tuple[Effect, ...] = ()) -> Case:
    """A run whose north takes a course of three bends that no effect of the catalogue has."""
    rng = np.random.default_rng(seed)
    k = np.arange(float(points))
    side = np.where(k % 2 == 0, 1.0, -1.0)
    x = 2.0 * k / (points - 1) - 1.0
    north = size * (60.0 * x**3 - 38.0 * x + 12.0 * x**2)
    readings = 1.0 + ARCSEC * (
        north + side * 3600.0 * np.exp(-0.016 * k) + 4.0 * rng.standard_normal(points)
    )
    return reversal_run(
        TurningPoints(readings.tolist(), right=(side > 0).tolist(), identity=f"run {seed}"), extra
    )


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("shape") / "shape.py"
    file.write_text(shape_text(run(1), draws=500), encoding="utf-8")
    return file


def test_it_is_a_file_of_effects_like_any_other(saved: Path) -> None:
    (effect,) = load_effects(saved, only_known_columns=True)
    assert effect.id == "recurrent_run_1"
    assert effect.title.startswith("Not explained, recurrent")


def test_it_is_named_where_it_recurs_and_nowhere_else(saved: Path) -> None:
    extra = load_effects(saved, only_known_columns=True)
    case = run(2, size=-1.5, extra=extra)
    result = diagnose(case, draws=500, advise=False)
    assert [item.effect for item in result.adopted] == ["recurrent_run_1"]
    (size,) = result.adopted[0].coefficients
    course = 60.0 - 38.0 + 12.0  # at the end, where it is largest
    assert abs(abs(size.value) - 1.5 * course) < 0.35 * 1.5 * course
    assert any("Not explained, recurrent" in text for text in words_of(result, case))
    clean = diagnose(run(3, size=0.0, extra=extra), draws=500, advise=False)
    assert clean.adopted == ()


def test_what_has_a_name_or_nothing_is_not_saved() -> None:
    for case in (run(4, size=0.0),):
        with pytest.raises(SurveyError, match="no unnamed shape"):
            shape_text(case, draws=300)


def test_the_command_saves_and_refuses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, file = tmp_path / "p", tmp_path / "s.py"
    assert main(["simulate", "reversal-run", str(folder), "--seed", "3"]) == 0
    options = ["diagnose", str(folder), "--session", "run-1", "--save-shape", str(file)]
    assert main(options) == 2
    assert "no unnamed shape" in capsys.readouterr().err
    assert not file.exists()
    assert main(["diagnose", str(folder), "--save-shape", str(file)]) == 2
