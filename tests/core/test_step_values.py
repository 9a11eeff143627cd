"""Means, 2c, index and tape zero of a step against values worked by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.observing.step_values import StepValues, step_values
from surveyapp.core.observing.steps import Step
from surveyapp.domain.readings import FieldBook
from surveyapp.io.fieldbook import read_field_book
from surveyapp.tui import texts
from surveyapp.tui.views.step_values import care_text, value_lines
from surveyapp_models.angles import AngleUnit

HEAD = "seq,kind,value,face,side,target\n"
ROWS = """\
1,backsight,359-59-50,L,,
2,backsight,180-00-14,R,,
3,zenith,88-10-10,L,,
4,zenith,271-49-20,R,,
5,backsight,40-00-00,L,,3090
6,tape_zero,-7.4,,,
7,tape_zero,11.4,,,
8,tape_zero,-7.2,,,
9,reversal,101-00-00,,R,
10,reversal,99-00-00,,L,
11,reversal,100-58-00,,R,
12,tape_zero,-5.0,,,
13,tape_zero,9.4,,,
14,tape_zero,-4.8,,,
15,backsight,359-59-58,L,,
16,backsight,180-00-18,R,,
17,backsight,220-00-20,R,,3090
"""


def book(tmp_path: Path, rows: int) -> FieldBook:
    path = tmp_path / "b.csv"
    path.write_text(HEAD + "".join(ROWS.splitlines(keepends=True)[:rows]), encoding="utf-8")
    return read_field_book(path, angle_unit=AngleUnit.DMS, repair=False)


def test_sights_before_across_the_circle_zero(tmp_path: Path) -> None:
    values = step_values(book(tmp_path, 8), Step.SIGHTS_BEFORE, target="3082")
    own, other = values.sights
    assert own.target == "3082"
    # L 359-59-50, R 180-00-14: 2c = L - R + 180 = -24", mean = 0-00-02
    assert own.two_c is not None
    assert np.degrees([own.mean, own.two_c]) * 3600 == pytest.approx([2.0, -24.0], abs=1e-6)
    assert (own.change, other.both_faces, other.two_c) == (None, False, None)
    (zenith,) = values.zeniths
    # 88-10-10 + 271-49-20 = 359-59-30: twice the index error -30", mean 88-10-25
    assert np.degrees(zenith.index) * 3600 == pytest.approx(-30.0, abs=1e-6)
    assert np.degrees(zenith.mean) == pytest.approx(88 + 10 / 60 + 25 / 3600, abs=1e-10)
    assert values.zero is None


def test_tape_zero_and_what_changed_after_the_run(tmp_path: Path) -> None:
    assert step_values(book(tmp_path, 7), Step.ZERO_BEFORE, target=None) == StepValues()
    before = step_values(book(tmp_path, 8), Step.ZERO_BEFORE, target="3082").zero
    assert before is not None
    assert before.mean_div == pytest.approx((-7.4 + 2 * 11.4 - 7.2) / 4)
    whole = book(tmp_path, 17)
    after = step_values(whole, Step.ZERO_AFTER, target="3082").zero
    assert after is not None
    assert after.change_div == pytest.approx(2.25 - 2.05)
    own, other = step_values(whole, Step.SIGHTS_AFTER, target="3082").sights
    # after: 359-59-58 and 180-00-18: mean 0-00-08
    assert own.change is not None
    assert np.degrees(own.change) * 3600 == pytest.approx(6.0, abs=1e-6)
    assert other.change is None  # one face before, the other after: turning or collimation
    result = step_values(whole, Step.RESULT, target="3082")
    assert (result.sights[0], result.zero) == (own, after)
    assert step_values(whole, Step.SWING, target="3082") == StepValues()


def test_the_lines_fit_beside_the_steps(tmp_path: Path) -> None:
    lines = value_lines(step_values(book(tmp_path, 17), Step.RESULT, target="3082"), AngleUnit.DMS)
    assert '3082  mean 0-00-08.0  2c -20.0"' in lines
    assert "tape zero after minus before +0.200 div" in lines
    assert max(map(len, lines)) <= 54
    for method, words in (("tracking", texts.CARE), ("automatic", texts.CARE_AUTOMATIC)):
        for step in words:
            assert len(care_text(Step(step), method, enough=True)) <= 54
    assert "BRAKE" in care_text(Step.SWING, "tracking", enough=True)
