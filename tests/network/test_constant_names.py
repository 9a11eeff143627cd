"""What lines share is told by values: no two constants have one name by accident."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.improvement import most_helpful
from surveyapp.core.network.oriented import oriented_lines
from surveyapp.core.orientation.lines import budget
from surveyapp.core.orientation.predicted_constant import CAUSE, SCATTER
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.report.sections.improvement import ADVICE

SAMPLE = Path(__file__).parents[2] / "projects" / "tongjin-2015"


def test_an_instrument_called_as_another_with_its_choice_keeps_its_own_constant() -> None:
    first, second, third = api.orient(SAMPLE).lines
    lines = [
        replace(first, instrument="G1", constant_choice="pooled", constant=1e-4),
        replace(second, instrument="G1 pooled", constant_choice=None, constant=5e-4),
        replace(third, instrument="G1", constant_choice="pooled", constant=1e-4),
    ]
    sides, constants, _ = oriented_lines(lines)
    assert sides[0].constant == sides[2].constant == "G1 pooled"
    assert sides[1].constant != "G1 pooled"
    assert {item.name: item.value for item in constants} == {
        sides[0].constant: 1e-4,
        sides[1].constant: 5e-4,
    }


@pytest.mark.parametrize("name", [CAUSE, SCATTER, "sights"])
def test_the_advice_is_found_by_the_name_of_the_source(name: str) -> None:
    item = Uncertain(0.0, {Source(name, "G"): 5.0, Source("rounds", "s"): 1.0})
    found = most_helpful(budget(item, frozenset({"cal-1"})))
    assert found is not None
    assert (found.source, found.at_calibration) == (name, False)
    assert found.source in ADVICE
    told = budget(Uncertain(0.0, {Source("sights", "cal-1"): 5.0}), frozenset({"cal-1"}))
    assert (told[0].source, told[0].name) == ("constant: sights", "sights")
    assert told[0].at_calibration
