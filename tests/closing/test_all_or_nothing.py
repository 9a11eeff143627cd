"""Adopt, close, new and simulate killed at any moment: old or new, repaired by the next opening."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.checks.filing_checks import filing_checks
from surveyapp.errors import SurveyError
from surveyapp.io.filing.journal import JOURNAL_FILE, write_together
from surveyapp.io.filing.ledger import LEDGER_FILE, append_entry, read_ledger
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.io.simulated import write_simulated
from surveyapp.io.template import create_project
from surveyapp.io.tomltext import atomic_write
from surveyapp.io.writing import with_subtables
from tests.closing.killed import run_killed, state_of
from tests.tui.helpers_tui import make_project

MOMENTS = 25
EFFECT = {"id": "dry_friction", "sessions": ["r1"], "unit": "arcsec"}


def adopt(folder: Path) -> None:
    """What adopting does once the diagnosis is there."""
    with ProjectLock(folder) as lock:
        assert lock.writable
        after = with_subtables(folder / "project.toml", ("orientation", "r1"), "effect", [EFFECT])
        write_together(
            folder,
            after,
            lambda: append_entry(folder, "adoption", dict(EFFECT), at="2026-01-02", software="s"),
        )


def settled(folder: Path) -> tuple[bool, bool]:
    """Whether the effect is in the project and in the ledger, after the next opening."""
    project = api.open_project(folder)
    ledger = read_ledger(folder)
    assert not ledger.faults
    assert not ledger.tail
    assert not (folder / JOURNAL_FILE).exists()
    assert not [p.name for p in folder.rglob("*.tmp")], "temporary files stay"
    adopted = any(entry.kind == "adoption" for entry in ledger.entries)
    return bool(project.session("r1").effects), adopted


def moments_of(act: Callable[[], object], seed: int) -> list[int]:
    """Moments spread over an act, the same for one seed."""
    count = run_killed(act, 10**9)
    assert count > 50
    rng = np.random.default_rng(seed)
    return sorted(int(k) for k in rng.choice(np.arange(1, count), MOMENTS, replace=False))


@pytest.mark.parametrize("with_ledger", [False, True])
def test_adopting_that_is_killed_leaves_project_and_ledger_together(
    tmp_path: Path, *, with_ledger: bool
) -> None:
    seen = set()
    base = make_project(tmp_path / "base")
    if with_ledger:
        append_entry(base, "diagnosis", {"p": 0.5}, at="2026-01-01", software="s")
    trial = shutil.copytree(base, tmp_path / "trial")
    for half, moments in ((False, moments_of(lambda: adopt(trial), 5)), (True, [1, 300, 600])):
        for at in moments:
            folder = tmp_path / f"k{at}{half}"
            shutil.copytree(base, folder)
            run_killed(lambda folder=folder: adopt(folder), at, half_write=half)  # type: ignore[misc]
            both = settled(folder)
            assert both[0] == both[1], (at, half)
            seen.add(both[0])
            if not both[0]:
                adopt(folder)
                assert settled(folder) == (True, True)
    assert seen == {False, True}


@pytest.mark.parametrize("call", ["write", "fsync", "replace"])
def test_a_full_disk_leaves_both_as_they_were(
    call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = make_project(tmp_path / "p")
    append_entry(folder, "diagnosis", {"p": 0.5}, at="2026-01-01", software="s")
    before = state_of(folder)
    place = os if call != "replace" else Path
    real = getattr(place, call)
    for good in range(8):
        left = good

        def refuse(*arguments: object) -> object:
            nonlocal left
            left -= 1
            if left < 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return real(*arguments)

        with monkeypatch.context() as patch:
            patch.setattr(place, call, refuse)
            try:
                adopt(folder)
            except SurveyError:
                pass
            else:
                break
        assert settled(folder) == (False, False)
        assert state_of(folder) == before
    assert settled(folder) == (True, True)


def test_a_closing_that_is_killed_is_there_or_not(tmp_path: Path) -> None:
    base = make_project(tmp_path / "base")
    trial = shutil.copytree(base, tmp_path / "trial")
    seen = set()
    for at in moments_of(lambda: api.close(trial, session="r1"), 6):
        folder = shutil.copytree(base, tmp_path / f"k{at}")
        run_killed(lambda folder=folder: api.close(folder, session="r1"), at)  # type: ignore[misc]
        checks = filing_checks(api.open_project(folder).filing)
        assert all(check.passed for check in checks if check.confirmed)
        seen.add(api.open_project(folder).filing.is_closed("r1"))
        if not api.open_project(folder).filing.is_closed("r1"):
            api.close(folder, session="r1")
    assert seen == {False, True}


def test_new_and_simulate_that_are_killed_can_be_done_again(tmp_path: Path) -> None:
    trial = tmp_path / "trial"
    for number, at in enumerate(moments_of(lambda: create_project(trial, name="n"), 7)):
        folder = tmp_path / f"n{number}"
        run_killed(lambda folder=folder: create_project(folder, name="n"), at)  # type: ignore[misc]
        if not (folder / "project.toml").exists():
            create_project(folder, name="n")
        assert {p.name for p in folder.iterdir()} == {"project.toml", "observations"}
    files = {"project.toml": "format = 1\n", "observations/a.csv": "seq,kind,value\n"}
    trial = tmp_path / "simulated"
    for number, at in enumerate(moments_of(lambda: write_simulated(trial, files, {"a": 1}), 8)):
        folder = tmp_path / f"s{number}"
        run_killed(lambda folder=folder: write_simulated(folder, files, {"a": 1}), at)  # type: ignore[misc]
        if not folder.exists():
            write_simulated(folder, files, {"a": 1})
        assert len(state_of(folder)) == 3
        assert not list(tmp_path.glob(f".s{number}.part"))


def test_of_two_writers_one_is_refused_and_nothing_is_doubled(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    first = ProjectLock(folder)
    assert not ProjectLock(folder).writable
    first.release()
    children = []
    for _ in range(6):
        child = os.fork()
        if child == 0:
            try:
                with ProjectLock(folder) as lock:
                    if lock.writable and not api.open_project(folder).session("r1").effects:
                        lock.release()
                        adopt(folder)
            finally:
                os._exit(0)
        children.append(child)
    for child in children:
        os.waitpid(child, 0)
    adopted, entered = settled(folder)
    assert adopted == entered


def test_a_file_held_by_another_program_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Path.replace
    denied: list[int] = []

    def replace(self: Path, target: Path) -> Path:
        if len(denied) < 2:
            denied.append(1)
            raise PermissionError(errno.EACCES, "held by another program")
        return real(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    atomic_write(tmp_path / "a", b"new")
    assert (tmp_path / "a").read_bytes() == b"new"
    assert len(denied) == 2


def test_the_screens_need_a_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = make_project(tmp_path / "p")
    for arguments in ([], ["open", str(folder)], ["practise"]):
        assert main(arguments) == 2
        assert "need a terminal" in capsys.readouterr().err


def test_nothing_is_adopted_in_a_closed_session(tmp_path: Path) -> None:
    from surveyapp.workflows.adopting import _need_unchanged

    folder = make_project(tmp_path / "p")
    project = api.open_project(folder)
    _need_unchanged(project, ("orientation", "r1"))
    api.close(folder, session="r1")
    for parent in (("orientation", "r1"), ("instrument", "G1")):
        with pytest.raises(SurveyError, match="closed session"):
            _need_unchanged(api.open_project(folder), parent)
    api.reopen(folder, session="r1", reason="x")
    (folder / "observations" / "r1.csv").write_text("seq,kind,value\n1,note,\n", encoding="utf-8")
    with pytest.raises(SurveyError, match="while it was diagnosed"):
        _need_unchanged(project, ("orientation", "r1"))
    assert (folder / LEDGER_FILE).exists()
