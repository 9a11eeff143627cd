"""An unnamed shape is saved, tried on another run, and told as not explained but recurrent."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from surveyapp.cli.main import main
from surveyapp.diagnosis.candidates import single_effects
from surveyapp.diagnosis.case import Case
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.fits import Member, fit_members
from surveyapp.diagnosis.plain_words import words_of
from surveyapp.diagnosis.run_value import value_of
from surveyapp.diagnosis.subjects.reversal_run import TurningPoints, reversal_run
from surveyapp.errors import SurveyError
from surveyapp.io.user_effects.loading import load_effects
from surveyapp.workflows.saving_shape import shape_text
from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.effect import Effect
from surveyapp_models.effects.recurrent import recurrent_course


def run(seed: int, *, size: float = 1.0, points: int = 20, extra: tuple[Effect, ...] = ()) -> Case:
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
    assert case.identity == "run 2"
    clean = diagnose(run(3, size=0.0, extra=extra), draws=500, advise=False)
    assert clean.adopted == ()


def test_what_has_a_name_or_nothing_is_not_saved() -> None:
    with pytest.raises(SurveyError, match="no unnamed shape"):
        shape_text(run(4, size=0.0), draws=300)


def with_course(book: Path, size: float) -> float:
    """Add the course to a simulated book; its mean over the run [arcsec]."""
    rows = list(csv.reader(book.read_text(encoding="utf-8").splitlines()))
    places = [i for i, row in enumerate(rows) if row[3] == "reversal"]
    x = 2.0 * np.arange(len(places)) / (len(places) - 1) - 1.0
    course = size * (60.0 * x**3 - 38.0 * x + 12.0 * x**2)
    for i, shift in zip(places, course.tolist(), strict=True):
        d, m, s = rows[i][4].split("-")
        seconds = 3600.0 * int(d) + 60.0 * int(m) + float(s) + shift
        rows[i][4] = f"{int(seconds // 3600)}-{int(seconds % 3600 // 60):02d}-{seconds % 60:04.1f}"
    with book.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)
    return float(course.mean())


def oriented(folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[dict[str, Any], list[str]]:
    """Session run-2 as orient tells it, and the codes of all warnings."""
    assert main(["orient", str(folder), "--json"]) == 1  # run-1 keeps its bends
    told = json.loads(capsys.readouterr().out)
    return (
        next(item for item in told["sessions"] if item["id"] == "run-2"),
        [item["code"] for item in told["warnings"]],
    )


def test_saved_tried_adopted_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, file = tmp_path / "p", tmp_path / "course.py"
    assert main(["simulate", "reversal-run", str(folder), "--seed", "4"]) == 0
    with_course(folder / "observations/run-1.csv", 2.0)
    moved = with_course(folder / "observations/run-2.csv", 2.5)
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))["sessions"]["run-2"]
    north = 3600.0 * truth["run_mean_north_deg"] + moved
    capsys.readouterr()
    before, _ = oriented(folder, capsys)
    save = ["diagnose", str(folder), "--session", "run-1", "--save-shape", str(file)]
    assert main(save) == 0
    adopt = ["diagnose", str(folder), "--session", "run-2", "--effects", str(file), "--adopt"]
    assert main(adopt) == 0
    assert "Not explained, recurrent" in capsys.readouterr().out
    after, codes = oriented(folder, capsys)
    assert after["estimator"] == "least-squares with recurrent_run_1"
    assert "course_not_explained" in codes
    halves = [item["gyro_north"]["interval95_arcsec"] for item in (before, after)]
    errors = [abs(3600.0 * item["gyro_north"]["deg"] - north) for item in (before, after)]
    assert halves[1] < 0.4 * halves[0]
    assert errors[1] < halves[1]
    # without the file: the project carries the course
    assert main(["diagnose", str(folder), "--session", "run-2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [item["effect"] for item in found["adopted"]] == ["recurrent_run_1"]
    place = folder / "project.toml"
    text = place.read_text(encoding="utf-8")
    place.write_text(text.replace("course = [[0.0,", "course = [[9.0,"), encoding="utf-8")
    assert main(["orient", str(folder)]) == 2
    assert "half swings that do not increase" in capsys.readouterr().err


def test_north_of_a_part_of_the_run_errs_less_with_the_course() -> None:
    time = np.arange(20.0)
    x = 2.0 * time / 19.0 - 1.0
    north = 60.0 * x**3 - 38.0 * x + 12.0 * x**2
    course = north - north.mean()
    rows = list(zip(time.tolist(), (course / np.abs(course).max()).tolist(), strict=True))
    effect = recurrent_course("recurrent_x", rows, run="x")
    errors = []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        k = time[:12]
        side = np.where(k % 2 == 0, 1.0, -1.0)
        swing = side * 3600.0 * np.exp(-0.016 * k) + 4.0 * rng.standard_normal(12)
        readings = 1.0 + ARCSEC * (2.0 * north[:12] + swing)
        points = TurningPoints(readings.tolist(), right=(side > 0).tolist(), identity="part")
        case = reversal_run(points, (effect,))
        base = fit_members(case, ())
        known = next(c for c in single_effects(case, base.theta) if c.id == "recurrent_x")
        fits = (base, fit_members(case, [Member(known, 0)], base.theta))
        values = [value_of(case, fit).value + case.offset - 1.0 for fit in fits]
        errors.append([value / ARCSEC - 2.0 * north[:12].mean() for value in values])
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    # 1.3 and 1.0 of 300 runs, and 4 / sqrt(12) = 1.15 if nothing but the mean were estimated
    assert rms[1] < 0.9 * rms[0]
    assert rms[1] < 1.15 * np.sqrt(chi2.ppf(0.999, 30) / 30)


def test_the_command_saves_and_refuses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, file = tmp_path / "p", tmp_path / "s.py"
    assert main(["simulate", "reversal-run", str(folder), "--seed", "3"]) == 0
    options = ["diagnose", str(folder), "--session", "run-1", "--save-shape", str(file)]
    assert main(options) == 2
    assert "no unnamed shape" in capsys.readouterr().err
    assert not file.exists()
    assert main(["diagnose", str(folder), "--save-shape", str(file)]) == 2
