"""The columns of a campaign are one tuple: all that reads columns reads every entry of it."""

from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.orientation.campaign_columns import BY_NAME, COLUMNS, LABELLED, CampaignColumn
from surveyapp.core.orientation.circumstances import Circumstances, columns_of
from surveyapp.core.prediction.kernels import COLUMNS_READ
from surveyapp.diagnosis.subjects.campaign import CampaignDetermination, campaign
from surveyapp.errors import SurveyError
from surveyapp.io.user_effects.probe import COLUMNS as PROBED
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect

ROOT = Path(__file__).parents[2]


def test_names_are_unique_identifiers() -> None:
    assert len(BY_NAME) == len(COLUMNS)
    assert all(column.name.isidentifier() for column in COLUMNS)


@pytest.mark.parametrize("effect", of_subject("campaign"), ids=lambda effect: effect.id)
def test_an_effect_reads_columns_that_are_there_in_their_unit(effect: Effect) -> None:
    assert {n.name: n.unit for n in effect.needs} == {
        n.name: BY_NAME[n.name].unit for n in effect.needs
    }


@pytest.mark.parametrize("column", COLUMNS, ids=lambda column: column.name)
def test_a_column_reaches_the_diagnosis_the_orientation_and_the_trial(
    column: CampaignColumn,
) -> None:
    made = column.example(np.random.default_rng(1), 24)
    assert made.shape == (24,)
    assert np.isfinite(made).all()
    assert np.ptp(made) > 0.0
    told: list[float | str] = [f"n{v:g}" if column.named else float(v) for v in made]
    facts = [Circumstances.of({column.name: value}) for value in told]
    handed = columns_of(facts)[column.name]
    case = campaign([CampaignDetermination(1e-5 * i, 1e-5, fact) for i, fact in enumerate(facts)])
    if column.named:
        assert len(np.unique(handed)) == len(set(told))
        assert {case.grid_labels[column.name][v] for v in case.columns[column.name]} == set(told)
    else:
        assert handed.tolist() == case.columns[column.name].tolist() == told
    assert column.name in PROBED["campaign"]
    assert f"`{column.name}`" in (ROOT / "docs/reference/campaign-columns.md").read_text("utf-8")


def test_what_the_project_does_not_tell_is_a_gap() -> None:
    columns = columns_of([Circumstances.of({"line": "A-B"}), Circumstances.of({"line": "A-C"})])
    assert set(columns) == set(BY_NAME)
    for name in set(BY_NAME) - LABELLED:
        assert np.isnan(columns[name]).all()


def test_an_unknown_column_and_a_name_for_a_number_are_refused() -> None:
    with pytest.raises(SurveyError) as refused:
        Circumstances.of({"temperature": 12.0, "latitude": "south", "line": 3.0})
    assert len(refused.value.problems) == 3
    assert "temperature_c" in str(refused.value)


def test_the_prediction_reads_columns_that_exist_or_that_the_engine_adds() -> None:
    assert set(COLUMNS_READ) - set(BY_NAME) <= {"observer"}
