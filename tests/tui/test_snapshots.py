"""Every screen as a picture, small and large; each was looked at before it became a reference."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from textual.pilot import Pilot

from surveyapp.core.observing.steps import Step
from surveyapp.core.simulate.session import book_text, simulate_session
from surveyapp.core.simulate.specification import SessionSpec, SwingMethod
from surveyapp.domain.project import Method
from surveyapp.domain.readings import ReadingKind
from surveyapp.observation import practice as api_practice
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.confirm import ConfirmScreen
from surveyapp.tui.widgets.instrument import InstrumentPane
from tests.tui.helpers_tui import (
    LARGE,
    SMALL,
    Clock,
    make_calibrations,
    make_network,
    make_project,
    simulated,
)

PROJECTS = Path(__file__).resolve().parents[2] / "projects"
Snap = Callable[..., bool]
sizes = pytest.mark.parametrize("size", [SMALL, LARGE], ids=["80x24", "120x40"])


def keys(*names: str) -> Callable[[Pilot[int]], Awaitable[None]]:
    """Press keys, each after the last computation has been shown."""

    async def press(pilot: Pilot[int]) -> None:
        for name in ("", *names):
            await pilot.app.workers.wait_for_complete()
            await pilot.pause()
            if name:
                await pilot.press(name)
        for _ in range(2):
            await pilot.app.workers.wait_for_complete()
            await pilot.pause()

    return press


def app_on(folder: Path | None, seconds: float = 0.0) -> SurveyApp:
    """The screens with a clock that stands still."""
    clock = Clock()
    clock.pass_by(seconds)
    return SurveyApp(None if folder is None else str(folder), now=clock.now, steady=clock.steady)


def sample(tmp_path: Path, name: str) -> Path:
    return Path(shutil.copytree(PROJECTS / name, tmp_path / name))


def observed(tmp_path: Path, rows: int) -> Path:
    """A session of which some rows are written; it stands at its turning points."""
    folder = make_project(tmp_path / "ramp-3")
    text = book_text(simulated(points=12).rows[:rows])
    (folder / "observations" / "r1.csv").write_text(text, encoding="utf-8")
    return folder


@sizes
def test_home(snap_compare: Snap, size: tuple[int, int]) -> None:
    assert snap_compare(app_on(None), terminal_size=size, run_before=keys())


@sizes
@pytest.mark.parametrize(
    "page", list("12345"), ids=["sessions", "lines", "constants", "checks", "warnings"]
)
def test_project(snap_compare: Snap, tmp_path: Path, page: str, size: tuple[int, int]) -> None:
    folder = sample(tmp_path, "tongjin-2015")
    assert snap_compare(app_on(folder), terminal_size=size, run_before=keys(page))


def test_broken_project(snap_compare: Snap, tmp_path: Path) -> None:
    folder = sample(tmp_path, "gi-b1-1966")
    book = folder / "observations" / "round-3.csv"
    text = book.read_text(encoding="utf-8").replace("107-57-34", "365-57-34")
    book.write_text(text, encoding="utf-8")
    assert snap_compare(app_on(folder), terminal_size=SMALL, run_before=keys())


@sizes
@pytest.mark.parametrize("form", ["new-project", "new-session", "practice", "folder"])
def test_forms(snap_compare: Snap, tmp_path: Path, form: str, size: tuple[int, int]) -> None:
    folder = sample(tmp_path, "tongjin-2015") if form == "new-session" else None
    key = {"practice": "p", "folder": "o"}.get(form, "n")
    assert snap_compare(app_on(folder), terminal_size=size, run_before=keys(key))


@sizes
def test_constant_through_days(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    folder = make_calibrations(tmp_path / "calibrations")
    assert snap_compare(app_on(folder), terminal_size=size, run_before=keys("3"))


@sizes
def test_traverse(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    app = app_on(make_network(tmp_path / "network"))
    assert snap_compare(app, terminal_size=size, run_before=keys("t"))


@sizes
@pytest.mark.parametrize("rows", [0, 6, 9, 17])
def test_session(snap_compare: Snap, tmp_path: Path, rows: int, size: tuple[int, int]) -> None:
    """At the start, at the sights, after two turning points, after ten."""
    folder = observed(tmp_path, rows)
    app = app_on(folder, seconds=2980.0)
    assert snap_compare(app, terminal_size=size, run_before=keys("enter"))


@sizes
def test_alarm(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    folder = observed(tmp_path, 17)
    book = folder / "observations" / "r1.csv"
    text = book.read_text(encoding="utf-8").replace("101-58-01.5", "101-59-31.5")
    book.write_text(text, encoding="utf-8")
    app = app_on(folder, seconds=2980.0)
    assert snap_compare(app, terminal_size=size, run_before=keys("enter"))


def clamped(tmp_path: Path, method: SwingMethod, kind: str, count: int) -> tuple[Path, float]:
    """A clamped session of the 15" class after so many rows of a kind, and 100 s later."""
    folder = make_project(tmp_path / "ramp-3", method)
    text = (folder / "project.toml").read_text(encoding="utf-8")
    text = text.replace("wanted_interval_arcsec = 8.0\n", "")
    text = text.replace("format = 1\n", 'format = 1\nrule_book = "cn-coal-15"\n')
    (folder / "project.toml").write_text(text, encoding="utf-8")
    spec = SessionSpec(method=method, points=8, tape_zero_div=(0.2, 0.25))
    rows = simulate_session(spec, np.random.default_rng(5)).rows
    places = [i for i, row in enumerate(rows) if row["kind"] == kind]
    rows = rows[: places[count - 1] + 1]
    (folder / "observations" / "r1.csv").write_text(book_text(rows), encoding="utf-8")
    return folder, float(rows[-1]["elapsed_s"]) + 100.0


@sizes
@pytest.mark.parametrize(
    ("method", "kind"), [("amplitude", "scale_reversal"), ("transit", "transit")]
)
def test_clamped_session(
    snap_compare: Snap, tmp_path: Path, method: SwingMethod, kind: str, *, size: tuple[int, int]
) -> None:
    """After six points or passages, with the target of the rule book."""
    folder, seconds = clamped(tmp_path, method, kind, 6)
    assert snap_compare(app_on(folder, seconds), terminal_size=size, run_before=keys("enter"))


def test_passage_pressed_late(snap_compare: Snap, tmp_path: Path) -> None:
    folder, seconds = clamped(tmp_path, "transit", "transit", 5)
    book = folder / "observations" / "r1.csv"
    rows = list(csv.DictReader(book.read_text(encoding="utf-8").splitlines()))
    rows[-1]["elapsed_s"] = f"{float(rows[-1]['elapsed_s']) + 5.0:.3f}"
    book.write_text(book_text(tuple(rows)), encoding="utf-8")
    assert snap_compare(app_on(folder, seconds), terminal_size=SMALL, run_before=keys("enter"))


@sizes
def test_automatic_session(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    folder = make_project(tmp_path / "ramp-3", "automatic")
    text = (folder / "project.toml").read_text(encoding="utf-8").replace("wild-gak1", "hgg05")
    (folder / "project.toml").write_text(text, encoding="utf-8")
    clock = Clock()
    seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    for value in ("321-53-09", "321-53-15", "321-53-14", "321-54-12", "321-53-11", "321-53-12"):
        clock.pass_by(300.0)
        seen.record(NewRow(ReadingKind.AZIMUTH, value, "dms"))
    seen.close()
    assert snap_compare(app_on(folder, 2000.0), terminal_size=size, run_before=keys("enter"))


@sizes
def test_question(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    folder = observed(tmp_path, 17)
    app = app_on(folder, seconds=2980.0)
    typed = keys("enter", *"101-48-00", "enter")
    assert snap_compare(app, terminal_size=size, run_before=typed)


@sizes
@pytest.mark.parametrize("key", ["f1", "f6"])
def test_help_and_strike(
    snap_compare: Snap, tmp_path: Path, key: str, size: tuple[int, int]
) -> None:
    folder = observed(tmp_path, 17)
    app = app_on(folder, seconds=2980.0)
    assert snap_compare(app, terminal_size=size, run_before=keys("enter", key))


def test_a_struck_reading(snap_compare: Snap, tmp_path: Path) -> None:
    app = app_on(observed(tmp_path, 17), seconds=2980.0)
    typed = keys("enter", "f6", "down", *"jerk", "enter")
    assert snap_compare(app, terminal_size=SMALL, run_before=typed)


def test_a_narrow_window(snap_compare: Snap, tmp_path: Path) -> None:
    app = app_on(observed(tmp_path, 17), seconds=2980.0)
    assert snap_compare(app, terminal_size=(40, 12), run_before=keys("enter"))


def at_result(tmp_path: Path) -> SurveyApp:
    """A session that stands at its result."""
    folder = observed(tmp_path, 26)
    clock = Clock()
    clock.pass_by(4200.0)
    seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    seen.record(NewRow(ReadingKind.NOTE, note="quiet, dry"))
    seen.go_to(Step.RESULT)
    seen.close()
    return app_on(folder, seconds=4210.0)


@sizes
def test_result(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    app = at_result(tmp_path)
    assert snap_compare(app, terminal_size=size, run_before=keys("enter", "f8"))


@sizes
def test_signing(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    app = at_result(tmp_path)
    press = keys("enter", "f8", "f6", *"A. Mu")
    assert snap_compare(app, terminal_size=size, run_before=press)


@sizes
def test_diagnosis(snap_compare: Snap, tmp_path: Path, size: tuple[int, int]) -> None:
    """What is missing in the model of a run of 1966."""
    folder = sample(tmp_path, "johannesburg-1966")
    assert snap_compare(app_on(folder), terminal_size=size, run_before=keys("d"))


@sizes
@pytest.mark.parametrize("page", ["logs", "result", "picture"])
def test_sensors(snap_compare: Snap, tmp_path: Path, page: str, size: tuple[int, int]) -> None:
    """The measured Allan deviation of a gyro at rest."""
    folder = sample(tmp_path, "mpu6050-static")
    press = {"logs": ("l",), "result": ("l", "enter", "l"), "picture": ("l", "enter", "l", "v")}
    assert snap_compare(app_on(folder), terminal_size=size, run_before=keys(*press[page]))


@sizes
@pytest.mark.parametrize("page", ["list", "begun"])
def test_programme(snap_compare: Snap, tmp_path: Path, page: str, size: tuple[int, int]) -> None:
    """The guided programmes, and the static test of a tilt sensor after its first reading."""
    folder = sample(tmp_path, "mpu6050-static")
    press = ("l", "3") if page == "list" else ("l", "3", *["enter"] * 4, "1", "7", "enter")
    assert snap_compare(app_on(folder), terminal_size=size, run_before=keys(*press))


@sizes
def test_a_question_before_something_is_written(snap_compare: Snap, size: tuple[int, int]) -> None:
    async def ask(pilot: Pilot[int]) -> None:
        await keys()(pilot)
        question = texts.ADOPT_ASK.format(names="Change of damping during the run")
        pilot.app.push_screen(ConfirmScreen(question))
        await pilot.pause()

    assert snap_compare(app_on(None), terminal_size=size, run_before=ask)


@pytest.mark.parametrize("times", [1, 2], ids=["light", "contrast"])
def test_themes(snap_compare: Snap, tmp_path: Path, times: int) -> None:
    folder = observed(tmp_path, 17)
    app = app_on(folder, seconds=2980.0)
    assert snap_compare(app, terminal_size=SMALL, run_before=keys("enter", *["f9"] * times))


def test_no_colour(snap_compare: Snap, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    folder = observed(tmp_path, 17)
    app = app_on(folder, seconds=2980.0)
    assert snap_compare(app, terminal_size=SMALL, run_before=keys("enter"))


@sizes
@pytest.mark.parametrize("method", ["tracking", "transit", "automatic"])
def test_practice(
    snap_compare: Snap, tmp_path: Path, method: Method, size: tuple[int, int]
) -> None:
    clock = Clock()
    begun = api_practice.begin(tmp_path / "p", method=method, seed=11, speed=10.0, disturbed=True)
    practice = replace(begun, now=clock.now, steady=clock.steady)
    app = SurveyApp(None, practice=practice)

    async def swing(pilot: Pilot[int]) -> None:
        await keys(*["f8"] * (2 if method == "automatic" else 4))(pilot)
        clock.pass_by(250.0)
        app.screen.query_one(InstrumentPane).look()
        await pilot.pause()

    assert snap_compare(app, terminal_size=size, run_before=swing)
