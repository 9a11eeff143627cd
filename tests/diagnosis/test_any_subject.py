"""A subject that the program has never heard of goes through the same engine."""

import dataclasses
import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from surveyapp.diagnosis.next_rows import rows_advice
from surveyapp.diagnosis.subject import DiagnosedSubject, Record, case_of
from surveyapp.errors import SurveyError

PAGE = Path(__file__).parents[2] / "docs/how-to/add-a-subject.md"


@pytest.fixture(scope="module")
def toy(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the page's own script leaves behind."""
    found = re.search(r"^```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.M | re.S)
    assert found is not None
    path = tmp_path_factory.mktemp("toy") / "tape.py"
    path.write_text(found.group(1), encoding="utf-8")
    assert len([line for line in found.group(1).splitlines() if line.strip()]) <= 60
    return runpy.run_path(str(path))


def test_the_toy_subject_finds_the_expansion_of_steel(toy: dict[str, Any]) -> None:
    result = toy["result"]
    assert [item.effect for item in result.adopted] == ["expansion"]
    found = result.adopted[0].coefficients[0]
    # 30 m of steel expand by 30e3 mm x 11.5e-6/K
    assert abs(found.value + 30.0e3 * 11.5e-6) < 4.0 * found.sigma
    assert result.heading == "tape 7"
    assert result.value_name == "the length"


def test_what_the_toy_offers_to_do_next_is_weighed(toy: dict[str, Any]) -> None:
    """Nothing warmer was measured: the one action tells most of what is open."""
    rng = np.random.default_rng(1)
    lengths = 30.0 + 2e-4 * rng.standard_normal(20)
    record = Record(lengths, {"temperature_c": rng.uniform(15.0, 17.0, 20)}, identity="tape 7")
    found = rows_advice(case_of(toy["TAPE"], record), rng)
    assert found is not None
    assert [item.action for item in found.actions] == ["warmer"]
    assert found.actions[0].separation > found.now
    assert toy["result"].actions[0].action == "warmer"
    assert any("15 K warmer" in text for text in toy["result"].advice)


def test_wrong_records_are_told_together(toy: dict[str, Any]) -> None:
    subject: DiagnosedSubject = toy["TAPE"]
    record = Record([1.0, np.nan], {"temperature_c": [1.0]}, sigma=[1.0, 0.0])
    with pytest.raises(SurveyError) as caught:
        case_of(subject, record)
    assert len(caught.value.problems) == 3


def test_a_subject_holds_together(toy: dict[str, Any]) -> None:
    subject: DiagnosedSubject = toy["TAPE"]
    with pytest.raises(ValueError, match="another subject"):
        dataclasses.replace(subject, id="chain")
    with pytest.raises(ValueError, match="each base parameter"):
        dataclasses.replace(subject, value=())
