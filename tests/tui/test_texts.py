"""The text catalogue holds what is shown and nothing else, and F1 fits the smallest screen."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from surveyapp.core.observing.doubts import Doubt
from surveyapp.core.observing.run_alert import Trouble
from surveyapp.core.observing.steps import State, Step, steps_of
from surveyapp.domain.project import Method
from surveyapp.domain.readings import ReadingKind
from surveyapp.tui import texts
from surveyapp.tui.texts import help_texts

CATALOGUE = Path(texts.__file__).parent
TUI = CATALOGUE.parent
HELP = "help_texts.py"
METHODS: tuple[Method, ...] = ("tracking", "amplitude", "transit", "automatic")


def test_every_text_is_shown_somewhere() -> None:
    catalogue = "\n".join(
        path.read_text("utf-8") for path in CATALOGUE.glob("*.py") if path.name != HELP
    )
    names = re.findall(r"^([A-Z][A-Z0-9_]*): Final", catalogue, re.M)
    sources = [p.read_text("utf-8") for p in TUI.rglob("*.py") if p.parent != CATALOGUE]
    source = "\n".join(sources)
    assert len(names) > 100
    assert len(set(names)) == len(names)  # no module hides a text of another
    assert [name for name in names if not re.search(rf"\btexts\.{name}\b", source)] == []


def test_whatever_comes_in_kinds_has_a_text_for_each() -> None:
    assert set(texts.STEP_NAMES) == set(Step)
    assert set(texts.STEP_HINTS) == set(Step)
    assert max(len(line) for text in texts.STEP_HINTS.values() for line in text.split("\n")) <= 55
    assert set(texts.STEP_MARKS) == set(State)
    assert set(texts.KIND_NAMES) == set(ReadingKind)
    assert set(texts.QUESTIONS) == set(Doubt)
    assert set(texts.ALERTS) == set(Trouble)
    assert set(texts.SWING_NAMES) == set(texts.METHODS) == set(METHODS)


@pytest.mark.parametrize("method", METHODS)
def test_help_explains_every_step_and_fits_80_columns(method: Method) -> None:
    for step in steps_of(method):
        lines = help_texts.help_of(step, method).splitlines()
        assert len(lines) > 2
        assert max(map(len, lines)) <= 74, step
        assert len(lines) <= 18, step
