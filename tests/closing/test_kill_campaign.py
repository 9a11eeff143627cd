"""Every act that writes, killed: a seeded part of ``python -m bench kill_actions``."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.checks.filing_checks import filing_checks
from surveyapp.observation.record import write_record
from tests.closing.campaign import ACTIONS, Action, campaign, on_a_full_disk, two_at_once
from tests.tui.helpers_tui import make_calibrations

MOMENTS = 6
FEW = {"report": 2, "simulate": 2, "practice": 3}
"""Acts that take long for themselves."""


@pytest.mark.parametrize("action", ACTIONS, ids=[item.name for item in ACTIONS])
def test_an_act_that_is_killed_is_done_or_not(action: Action, tmp_path: Path) -> None:
    moments = FEW.get(action.name, MOMENTS)
    found = campaign(action, tmp_path, moments, seed=13)
    assert sum(found.values()) == moments


def test_an_interrupted_record_leaves_nothing_for_long(tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    (folder / "results").mkdir()
    old, young = (folder / "results" / f".record.pdf.{name}.tmp" for name in ("old", "young"))
    for path in (old, young):
        path.write_bytes(b"%PDF-")
    os.utime(old, (1.0, 1.0))
    write_record(folder)
    assert (old.exists(), young.exists()) == (False, True)


BY_NAME = {item.name: item for item in ACTIONS}


@pytest.mark.parametrize("name", ["adopt", "close", "reopen", "new session"])
def test_two_who_do_the_same_at_once_do_it_once(name: str, tmp_path: Path) -> None:
    two_at_once(BY_NAME[name], tmp_path, range(6), seed=3)


@pytest.mark.parametrize("call", ["write", "fsync", "replace"])
@pytest.mark.parametrize("name", ["adopt", "close", "reopen", "new session"])
def test_a_full_disk_leaves_the_old_state(name: str, call: str, tmp_path: Path) -> None:
    refused = on_a_full_disk(BY_NAME[name], tmp_path, call)
    unused = {("close", "replace"), ("reopen", "replace"), ("new session", "write")}
    assert (refused > 0) is ((name, call) not in unused)


def test_a_line_of_the_closings_that_was_torn_is_no_false_alarm(tmp_path: Path) -> None:
    folder = make_calibrations(tmp_path / "p")
    api.close(folder, session="k1", by="Li")
    path = folder / "closings.txt"
    whole = path.read_bytes()
    path.write_bytes(whole + b"ABCDE-FGH")  # the power failed while a line was written
    assert all(c.passed for c in filing_checks(api.open_project(folder).filing) if c.confirmed)
    api.close(folder, session="k2", by="Li")
    assert path.read_bytes().startswith(whole)
    assert path.read_bytes().count(b"\n") == whole.count(b"\n") + 1
    assert all(c.passed for c in filing_checks(api.open_project(folder).filing) if c.confirmed)
