"""A user's own effects: named explicitly, checked, and diagnosed like the catalogue's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveyapp.diagnosis import TurningPoints, diagnose, reversal_run
from surveyapp.errors import SurveyError
from surveyapp.io.effects import load_effects

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
