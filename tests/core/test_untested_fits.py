"""What nobody judges is not tested, and nothing else changes by it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from surveyapp import api
from surveyapp.workflows.computing import oriented

PROJECTS = Path(__file__).resolve().parents[2] / "projects"


def test_without_a_judge_everything_but_the_tests_is_the_same() -> None:
    project = api.open_project(PROJECTS / "johannesburg-1966")
    [whole] = oriented(project).orientation.sessions
    [bare] = oriented(project, judged=False).orientation.sessions
    assert len(whole.reduction.tests) > 3
    assert bare.reduction.tests == ()
    assert repr(replace(whole.reduction, tests=())) == repr(bare.reduction)
    assert whole.warnings == bare.warnings


def test_a_result_is_judged_as_ever() -> None:
    checks = api.check(PROJECTS / "johannesburg-1966")
    assert [check.rule for check in checks if check.passed is False][:1] == ["fit"]
