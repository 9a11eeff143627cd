"""The diagnosis in words says what the result says, also when nothing could be told apart."""

from __future__ import annotations

from surveyapp.diagnosis import diagnose, plain_words
from surveyapp.diagnosis.subjects.reversal_run import reversal_run
from tests.diagnosis.measured_runs import gi_b1, johannesburg


def test_the_measured_run_is_told_with_its_figures() -> None:
    problem = reversal_run(johannesburg())
    text = " ".join(plain_words(diagnose(problem), problem.effects))
    for figure in ('119.7"', '16.4"', '251.1"', '47.0"'):
        assert figure in text
    assert "cannot be told apart" in text
    assert "To decide, observe" in text
    assert "best member of what cannot be told apart" in text
    assert "North over the run" in text
    assert "No times" in text


def test_a_quiet_run_is_told_as_plainly() -> None:
    problem = reversal_run(gi_b1())
    words = plain_words(diagnose(problem), problem.effects)
    assert words
    assert all(sentence.endswith(".") for sentence in words)
