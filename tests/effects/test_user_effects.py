"""A user's own effects: named explicitly, checked, and diagnosed like the catalogue's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.diagnosis import TurningPoints, diagnose
from surveyapp.diagnosis.candidates import all_candidates
from surveyapp.diagnosis.subjects.reversal_run import reversal_run
from surveyapp.errors import SurveyError
from surveyapp.io.user_effects.form import form_problems
from surveyapp.io.user_effects.loading import load_effects
from surveyapp.io.user_effects.probe import probe_problems
from surveyapp_models.effects import CATALOGUE

OWN = """
import numpy as np
from surveyapp_models.angles import ARCSEC
from surveyapp_models.effects.effect import Coefficient, Column, Effect


def basis(columns, /, **grid):
    return columns["pump"][:, None]


EFFECTS = (
    Effect(
        id="pump",
        title="Pump running",
        subject="reversal_run",
        needs=(Column("pump", "0 or 1"),),
        coefficients=(Coefficient("shift", "arcsec", ARCSEC, -300.0, 300.0, "while it runs"),),
        basis=basis,
        datum="north over the run",
        source="the mine's own log",
        remedy="Switch the pump off.",
        symptom="north moved while the pump ran",
        separate_by="a run with the pump off",
    ),
)
"""


def test_an_own_effect_is_found_in_the_data(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(OWN, encoding="utf-8")
    effects = load_effects(path)
    generator = np.random.default_rng(3)
    k = np.arange(20.0)
    pump = np.isin(k, (2, 3, 7, 8, 9, 13, 16, 17)).astype(float)
    arcsec = np.pi / 648000.0
    readings = 3.1 + 0.02 * (-1.0) ** k * np.exp(-0.01 * k)
    readings += arcsec * (40.0 * pump + 4.0 * generator.standard_normal(20))
    points = TurningPoints(list(readings), covariates={"pump": list(pump)})
    result = diagnose(reversal_run(points, effects), draws=1000)
    assert [item.effect for item in result.adopted] == ["pump"]
    coefficient = result.adopted[0].coefficients[0]
    assert coefficient.sigma is not None
    assert abs(coefficient.value - 40.0) < 4.0 * coefficient.sigma
    assert not (tmp_path / "__pycache__").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("raise RuntimeError('no')", "cannot be run"),
        ("x = 1", "holds no effects"),
        (OWN.replace('id="pump"', 'id="warm_up"'), "already in the catalogue"),
    ],
)
def test_a_bad_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.py"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SurveyError, match=message):
        load_effects(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SurveyError, match="no such file"):
        load_effects(tmp_path / "none.py")


RUN = OWN.replace('columns["pump"][:, None]', 'columns["half_swing"][:, None] ** 2').replace(
    'Column("pump", "0 or 1")', 'Column("half_swing", "half swings")'
)
BASIS = 'columns["half_swing"][:, None] ** 2'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import sys; sys.exit(0)", "SystemExit: 0"),
        ("EFFECTS = 5", "EFFECTS is int"),
        ("EFFECTS = (1, 2)", "holds no effects"),
        (RUN + "EFFECTS = (*EFFECTS, 'more')", "something else among EFFECTS"),
        (RUN.replace(BASIS, 'columns["nope"]'), "basis.*KeyError: 'nope'"),
        (RUN.replace(BASIS, "1 / 0"), "basis.*ZeroDivisionError"),
        (RUN.replace(BASIS, "exit(0)"), "basis.*SystemExit"),
        (RUN.replace(BASIS, f"{BASIS} * float('nan')"), "not finite"),
        (RUN.replace(BASIS, f"{BASIS} * 1j"), "complex"),
        (RUN.replace(BASIS, '"a"'), "values of type <U1"),
        (RUN.replace(BASIS, "None"), "values of type object"),
        (RUN.replace(BASIS, 'columns["half_swing"]'), r"shape \(24,\).*shape \(24, 1\)"),
        (RUN.replace(BASIS, f"{BASIS} * np.ones(2)"), r"shape \(24, 2\).*\(24, 1\)"),
        (RUN.replace(BASIS, f"({BASIS})[:5]"), r"shape \(5, 1\).*\(24, 1\)"),
        (RUN.replace(BASIS, f"np.ones_like({BASIS})"), "does not vary"),
        (RUN.replace(BASIS, f"{BASIS} + np.random.random()"), "another result"),
        (
            RUN.replace("    return", "    columns['half_swing'][:] = 0\n    return"),
            "may not write",
        ),
        (RUN.replace("    return", "    columns['x'] = 0\n    return"), "does not support item"),
        (RUN.replace("-300.0, 300.0", "300.0, -300.0"), "plausible range of coefficient shift"),
        (RUN.replace("-300.0, 300.0", "1.0, 300.0"), "holds 0"),
        (RUN.replace("ARCSEC, -300.0", "float('nan'), -300.0"), "scale of coefficient shift"),
        (RUN.replace("ARCSEC, -300.0", "0.0, -300.0"), "scale of coefficient shift"),
        (RUN.replace('id="pump"', 'id="a/b"'), "no id of an effect"),
        (RUN.replace('id="pump"', "id=7"), "id is no text"),
        (RUN.replace('id="pump"', 'id="latitude"'), "already in the catalogue"),
        (RUN.replace('id="pump"', 'id="random_walk"'), "already in the catalogue"),
        (RUN + "EFFECTS = EFFECTS * 2", "already in the catalogue"),
        (RUN.replace('title="Pump running"', 'title=" "'), "title is no text"),
        (RUN.replace("basis=basis", "basis=3"), "basis is no function"),
        (OWN, "needs a column that no project has.*found pump"),
    ],
)
def test_what_is_wrong_with_an_own_effect_is_said(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "own.py"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SurveyError, match=message) as caught:
        load_effects(path, only_known_columns=True)
    assert "own.py" in str(caught.value)


def test_every_effect_of_the_catalogue_would_be_accepted() -> None:
    for effect in CATALOGUE:
        assert [*form_problems(effect, "file"), *probe_problems(effect, "file")] == []


def test_an_own_effect_that_fails_on_real_data_is_bad_input(tmp_path: Path) -> None:
    # fine on the record of the trial, which has 24 points
    faulty = RUN.replace(BASIS, f"{BASIS} if len(columns['half_swing']) == 24 else 1 / 0")
    path = tmp_path / "own.py"
    path.write_text(faulty, encoding="utf-8")
    api.simulate("reversal-run", tmp_path / "run", seed=1)
    with pytest.raises(SurveyError, match=r"own\.py, effect pump, basis.*ZeroDivisionError"):
        api.diagnose(tmp_path / "run", session="run-1", effects=path)


def test_what_an_own_effect_prints_stays_out_of_the_result(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "own.py"
    path.write_text("print('hello')\n" + RUN.replace("    return", "    print('x')\n    return"))
    load_effects(path)
    assert capsys.readouterr().out == ""


def test_columns_of_a_problem_cannot_be_written() -> None:
    k = np.arange(20.0)
    theta = np.sin(k)
    readings = 3.1 + 0.02 * (-1.0) ** k * np.exp(-0.01 * k)
    problem = reversal_run(TurningPoints(list(readings), covariates={"temperature_c": list(theta)}))
    assert problem.half_swing is not None
    for values in (*problem.columns.values(), problem.half_swing, problem.side):
        with pytest.raises(ValueError, match="read-only"):
            values[:] = 0.0  # type: ignore[index]
    theta[0] = 1.0  # the caller's own array stays writable


def test_every_generic_shape_has_its_id_for_itself(tmp_path: Path) -> None:
    k = np.arange(45.0)
    readings = 3.1 + 0.02 * (-1.0) ** k * np.exp(-0.01 * k)
    run = reversal_run(TurningPoints(list(readings)))
    shapes = {c.id for c in all_candidates(run, np.array([0.02, 0.01, 0.0])) if c.kind == "shape"}
    assert len(shapes) >= 4
    path = tmp_path / "own.py"
    for name in sorted(shapes):
        path.write_text(RUN.replace('id="pump"', f'id="{name}"'), encoding="utf-8")
        with pytest.raises(SurveyError, match="already in the catalogue"):
            load_effects(path)
