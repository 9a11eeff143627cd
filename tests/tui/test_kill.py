"""Killed in a real terminal: what the screen confirmed is on the disk, once and unaltered."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.tui_kill import plain, run_once, start, stop
from surveyapp.core.observing.steps import Step
from surveyapp.observation.session import SessionDesk
from surveyapp.tui import texts


@pytest.mark.parametrize("seed", range(4))
def test_sigkill_loses_nothing_that_was_confirmed(tmp_path: Path, seed: int) -> None:
    outcome = run_once(tmp_path / "p", seed)
    assert outcome.faults == ()


def test_after_a_kill_the_screen_opens_where_it_was(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    outcome = run_once(folder, 7)
    assert outcome.faults == ()
    seen = SessionDesk(folder, "r1")
    step = seen.step
    seen.close()
    name = texts.SWING_NAMES["tracking"] if step is Step.SWING else texts.STEP_NAMES[step]
    log = tmp_path / "second.log"
    child = start(folder, log)
    child.expect_exact(f"{texts.STEP_HERE} {name}".encode())
    child.expect_exact(b"Leave")
    stop(child)
    assert "READING ONLY" not in plain(log)
