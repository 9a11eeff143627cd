"""Acts of the office and of the screens, killed at any moment: old or new, repaired by itself.

Each act is run in a forked process on a copy of a prepared folder. It is ended at a line of the
writing code, in the middle of a write, or by SIGKILL at a moment of the clock; then the state is
judged by the program itself, and the act is done again where nothing stands yet.
"""

from __future__ import annotations

import errno
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Literal, cast

import numpy as np

from surveyapp import api
from surveyapp.core.checks.filing_checks import filing_checks
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.filing.ledger import append_entry, read_ledger
from surveyapp.io.filing.lock import ProjectLock
from surveyapp.observation import home, practice
from surveyapp.observation.station_lines import NewStation
from surveyapp.workflows import adopting
from tests.closing.killed import run_killed, state_of
from tests.tui.helpers_tui import make_calibrations, make_project

State = Literal["old", "new"]
EFFECT = {"id": "dry_friction", "sessions": ["r1"], "unit": "arcsec"}
LEFT = (".surveyapp.lock",)


@dataclass(frozen=True, slots=True)
class Action:
    """One act: what it begins with, what it does, and how its state is told.

    ``state`` asserts that everything is whole; ``strict`` says that no other file may stay.
    """

    name: str
    prepare: Callable[[Path], Path]
    act: Callable[[Path], object]
    state: Callable[[Path], State]


def _adopt_base(folder: Path) -> Path:
    make_project(folder)
    append_entry(folder, "diagnosis", {"p": 0.5}, at="2026-01-01", software="s")
    return folder


def _adopt(folder: Path) -> None:
    project = api.open_project(folder)
    if project.session("r1").effects:  # as tables_to_adopt: nothing is adopted twice
        raise SurveyError(Problem("already adopted", "r1"))
    found = SimpleNamespace(subject="reversal_run", identity="r1", instrument="G1", ledger={"p": 1})
    adopting.record(project, cast("Any", found), [EFFECT], moment="2026-01-02", software="s")


def _adopted(folder: Path) -> State:
    with ProjectLock(folder) as lock:  # the next writer repairs
        assert lock.writable
    project, ledger = api.open_project(folder), read_ledger(folder)
    assert not ledger.faults
    assert not ledger.tail
    kinds = [entry.kind for entry in ledger.entries]
    assert kinds in (["diagnosis"], ["diagnosis", "diagnosis", "adoption"]), kinds
    effects = project.session("r1").effects
    assert len(effects) == kinds.count("adoption")
    return "new" if effects else "old"


def _calibrations(folder: Path) -> Path:
    return make_calibrations(folder)


def _closed_base(folder: Path) -> Path:
    api.close(make_calibrations(folder), session="k1", by="Li")
    return folder


def _is_closed(folder: Path) -> bool:
    filing = api.open_project(folder).filing
    failed = [c for c in filing_checks(filing) if c.confirmed and c.passed is False]
    assert failed == []
    return filing.is_closed("k1")


def _own(name: str) -> Callable[[Path], Path]:
    """An empty folder in which the act makes something of this name."""

    def prepare(folder: Path) -> Path:
        folder.mkdir(parents=True)
        return folder

    assert name
    return prepare


def _new(folder: Path) -> None:
    stations = (NewStation("A", e=1.0, n=2.0), NewStation("B", e=1.0, n=90.0))
    instruments = (("G1", "wild-gak1", "7"),)
    home.create_project(
        home.NewProject(
            str(folder / "mine"),
            "Mine",
            angle_typing="packed",
            stations=stations,
            instruments=instruments,
        )
    )


def _made(folder: Path) -> State:
    place = folder / "mine"
    if not (place / "project.toml").exists():
        return "old"
    project = api.open_project(place)
    assert (len(project.stations), len(project.instruments)) == (2, 1)
    return "new"


def _session(folder: Path) -> None:
    home.create_session(folder, home.NewSession("r2", "3083", "3082", "G1", "tracking", "survey"))


def _has_session(folder: Path) -> State:
    project = api.open_project(folder)
    names = [item.id for item in project.sessions]
    assert names in (["r1"], ["r1", "r2"])
    return "new" if "r2" in names else "old"


def _report_base(folder: Path) -> Path:
    make_calibrations(folder)
    (folder / "results").mkdir()
    (folder / "results" / "record.pdf").write_bytes(b"%PDF the record before")
    return folder


def _report(folder: Path) -> None:
    from surveyapp.observation.record import write_record

    write_record(folder)


def _reported(folder: Path) -> State:
    data = (folder / "results" / "record.pdf").read_bytes()
    if data == b"%PDF the record before":
        return "old"
    assert data.startswith(b"%PDF-")
    assert data.rstrip().endswith(b"%%EOF")
    return "new"


def _simulate(folder: Path) -> None:
    api.simulate("reversal-run", folder / "run", seed=4)


def _simulated(folder: Path) -> State:
    place = folder / "run"
    if not place.exists():
        return "old"
    api.open_project(place)
    assert (place / "truth.json").is_file()
    return "new"


def _practise(folder: Path) -> None:
    practice.begin(folder / "practice", seed=5)


def _practised(folder: Path) -> State:
    place = folder / "practice"
    if not (place / "project.toml").exists():
        shutil.rmtree(place, ignore_errors=True)  # the screen takes the next free name
        return "old"
    assert [item.id for item in api.open_project(place).sessions] == ["practice"]
    return "new"


ACTIONS: tuple[Action, ...] = (
    Action("adopt", _adopt_base, _adopt, _adopted),
    Action(
        "close",
        _calibrations,
        lambda folder: api.close(folder, session="k1", by="Li"),
        lambda folder: "new" if _is_closed(folder) else "old",
    ),
    Action(
        "reopen",
        _closed_base,
        lambda folder: api.reopen(folder, session="k1", reason="a slip"),
        lambda folder: "old" if _is_closed(folder) else "new",
    ),
    Action("new", _own("mine"), _new, _made),
    Action("new session", make_project, _session, _has_session),
    Action("report", _report_base, _report, _reported),
    Action("simulate", _own("run"), _simulate, _simulated),
    Action("practice", _own("practice"), _practise, _practised),
)
WRITING = ("/surveyapp/io/", "/surveyapp/workflows/adopting", "/surveyapp/observation/")


def killed_by_clock(act: Callable[[], object], seconds: float) -> None:
    """Run an act in a fork and kill it after some seconds."""
    child = os.fork()
    if child == 0:
        code = 0
        try:
            act()
        except BaseException:
            code = 1
        os._exit(code)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


def campaign(
    action: Action, place: Path, moments: int, *, seed: int, part: Iterable[int] | None = None
) -> dict[str, int]:
    """Kill an act at many moments, or a part of them; how often old and new stood afterwards.

    Half of the moments are lines of the writing code, a tenth are inside of a write, the rest are
    moments of the clock. After each the act is done again, and what it makes must stand then.
    """
    base = action.prepare(place / "base")
    trial = shutil.copytree(base, place / "trial")
    lines = run_killed(lambda: action.act(trial), 10**9, watched=WRITING)
    assert action.state(trial) == "new", f"{action.name} itself does not work"
    took = _seconds(action, base, place)
    rng = np.random.default_rng(seed)
    halves = max(moments // 10, 1)
    clocks = max((4 * moments) // 10, 1)
    tried: list[tuple[str, float]] = [("half", float(k)) for k in rng.integers(1, lines, halves)]
    tried += [("clock", float(s)) for s in rng.uniform(0.0, 1.1 * took, clocks)]
    tried += [("line", float(k)) for k in _spread(lines, moments - len(tried), rng)]
    found = {"old": 0, "new": 0}
    for number in range(moments) if part is None else part:
        how, at = tried[number]
        folder = place / f"k{number}"
        shutil.copytree(base, folder)

        def act(folder: Path = folder) -> object:
            return action.act(folder)

        if how == "clock":
            killed_by_clock(act, at)
        else:
            run_killed(act, int(at), half_write=how == "half", watched=WRITING)
        state = action.state(folder)
        found[state] += 1
        if state == "old":
            action.act(folder)
            assert action.state(folder) == "new", (action.name, how, at)
        left = [p.name for p in folder.rglob("*") if p.name.startswith(".") and p.name not in LEFT]
        assert not left or action.name == "report", (action.name, how, at, left)
        shutil.rmtree(folder)
    return found


def _spread(lines: int, count: int, rng: np.random.Generator) -> list[int]:
    """Lines of an act: its last ones, in which it writes, twice as dense as the others."""
    late = rng.integers(max(lines - 400, 1), lines, (2 * count) // 3)
    return [*late.tolist(), *rng.integers(1, lines, count - late.size).tolist()]


def _seconds(action: Action, base: Path, place: Path) -> float:
    folder = shutil.copytree(base, place / "timed")
    begun = time.perf_counter()
    child = os.fork()
    if child == 0:
        action.act(folder)
        os._exit(0)
    os.waitpid(child, 0)
    return time.perf_counter() - begun


def two_at_once(action: Action, place: Path, times: Iterable[int], *, seed: int) -> int:
    """Two processes do the same act at the same time; how often one of them came second.

    The state must be the new one, whole, and nothing in it doubled.
    """
    base = action.prepare(place / "base")
    refused = 0
    for number in times:
        folder = shutil.copytree(base, place / f"t{number}")
        delays = np.random.default_rng((seed, number)).uniform(0.0, 0.004, 2)
        children = [_started(action, folder, float(delay)) for delay in delays]
        codes = [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children]
        assert set(codes) <= {0, 2}, codes
        assert 0 in codes
        refused += codes.count(2)
        assert action.state(folder) == "new"
        shutil.rmtree(folder)
    return refused


def _started(action: Action, folder: Path, delay: float) -> int:
    child = os.fork()
    if child:
        return child
    code = 3
    try:
        time.sleep(delay)
        action.act(folder)
        code = 0
    except SurveyError:
        code = 2
    finally:
        os._exit(code)


def on_a_full_disk(action: Action, place: Path, call: str, most: int = 60) -> int:
    """Refuse the n-th and every later call of a kind for want of room; how many were refused so.

    The state is the old one with every file as it was, or the new one; never between.
    """
    base = action.prepare(place / "base")
    before = state_of(base)
    owner: Any = Path if call == "replace" else os
    real = getattr(owner, call)
    for good in range(most):
        folder = shutil.copytree(base, place / f"d{good}")
        left = [good]

        def refuse(*arguments: Any, left: list[int] = left) -> Any:
            left[0] -= 1
            if left[0] < 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return real(*arguments)

        done = True
        setattr(owner, call, refuse)
        try:
            action.act(folder)
        except SurveyError:
            done = False
        finally:
            setattr(owner, call, real)
        state = action.state(folder)
        if not done:
            assert state == "old"
            assert state_of(folder) == before, (action.name, call, good)
        elif left[0] >= 0:
            assert state == "new"
            return good
        shutil.rmtree(folder)
    raise AssertionError(f"{action.name} never came to its end")
