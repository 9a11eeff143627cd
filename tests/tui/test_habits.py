"""Habits of the hand: values of a step, own editor, corrections, what a new session begins with."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from textual.app import App
from textual.pilot import Pilot
from textual.widgets import DataTable, Input, OptionList, Static

from surveyapp import api
from surveyapp.errors import Problem, SurveyError
from surveyapp.observation import by_hand
from surveyapp.observation import home as api_home
from surveyapp.observation.corrections import TableName, correct, fields_of, table_names
from surveyapp.observation.proposal import propose_session
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.correct import CorrectScreen
from surveyapp.tui.screens.new_project import NewProjectScreen
from surveyapp.tui.screens.new_session import NewSessionScreen
from surveyapp.tui.screens.project import ProjectScreen
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.widgets.entry import EntryLine
from surveyapp.tui.widgets.problems import Problems
from tests.tui.helpers_tui import (
    SMALL,
    Clock,
    make_network,
    make_project,
    settle,
)


async def test_values_and_care_stand_at_their_steps(tmp_path: Path) -> None:
    clock = Clock()
    app = SurveyApp(str(make_project(tmp_path / "p")), now=clock.now, steady=clock.steady)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("enter")
        await settle(pilot)
        assert isinstance(app.screen, SessionScreen)
        assert "CLAMPED" in str(app.screen.query_one("#care", Static).content)
        await pilot.press("f8")
        for text in ("179-01-56", "359-02-12"):
            app.screen.query_one(EntryLine).text = text
            await pilot.press("enter")
        await settle(pilot)
        # (179-01-56 + 179-02-12) / 2, and 179-01-56 - 359-02-12 + 180
        shown = str(app.screen.query_one("#values", Static).content)
        assert shown == '3082  mean 179-02-04.0  2c -16.0"'
        await pilot.press("f8", "f8")
        await settle(pilot)
        assert "UNCLAMP" in str(app.screen.query_one("#care", Static).content)


def editor(tmp_path: Path, code: str) -> str:
    """A command that does something with the file that it is given."""
    script = tmp_path / "editor.py"
    script.write_text(f"import pathlib, sys\np = pathlib.Path(sys.argv[-1])\n{code}\n", "utf-8")
    return f'"{sys.executable}" "{script}"'


@contextlib.contextmanager
def nothing(_: object) -> Iterator[None]:
    yield


async def edited(app: SurveyApp, pilot: Pilot[int], key: str) -> str:
    """Press a key on the project screen, and what was told then."""
    await settle(pilot)
    await pilot.press(key)
    await settle(pilot)
    return "\n".join(str(item.message) for item in app._notifications)


async def test_the_own_editor_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(App, "suspend", nothing)
    folder = make_project(tmp_path / "p")
    book = folder / "observations" / "r1.csv"
    header = book.read_text("utf-8")
    rows = header + "1,,,backsight,179-01-56,,L,,,,\n2,,,backsight,359-02-12,,R,,,,\n"
    book.write_text(rows, "utf-8")
    monkeypatch.setenv("VISUAL", editor(tmp_path, "p.write_text(p.read_text().replace('56','86'))"))
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        told = await edited(app, pilot, "e")
        assert "observations/.r1.csv.before-edit-1" in told
        assert (book.parent / ".r1.csv.before-edit-1").read_text("utf-8") == rows
        # the seconds are impossible now: told, and the same key opens the file that has them
        assert isinstance(app.screen, ProjectScreen)
        assert app.screen.query(Problems)
        mend = "p.write_text(p.read_text().replace('86','57'))"
        monkeypatch.setenv("VISUAL", editor(tmp_path, mend))
        await edited(app, pilot, "e")
        assert not app.screen.query(Problems)
        assert "179-01-57" in book.read_text("utf-8")
        mend = "p.open('a').write('# a remark\\n')"
        monkeypatch.setenv("VISUAL", editor(tmp_path, mend))
        assert "project.toml: lines were added" in await edited(app, pilot, "E")
    assert (folder / "project.toml").read_text("utf-8").endswith("# a remark\n")
    assert len(list(folder.rglob("*before-edit*"))) == 2


async def test_what_may_not_be_edited_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(App, "suspend", nothing)
    folder = make_project(tmp_path / "p")
    rows = [
        f"{k},,,reversal,{179 + 2 * (k % 2)}-00-{10 + k},,,{'LR'[k % 2]},,,\n" for k in range(1, 6)
    ]
    with (folder / "observations" / "r1.csv").open("a", encoding="utf-8") as stream:
        stream.writelines(rows)
    monkeypatch.setenv("VISUAL", "no-such-editor-here")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        assert "could not be started" in await edited(app, pilot, "e")
        api.close(folder, session="r1")
        monkeypatch.setenv("VISUAL", editor(tmp_path, "p.write_text('gone')"))
        assert "it is closed" in await edited(app, pilot, "e")
        assert "gone" not in (folder / "observations" / "r1.csv").read_text("utf-8")
        await pilot.press("f5")
        await settle(pilot)
        table = app.screen.query_one("#sessions DataTable", DataTable)
        assert str(table.get_row_at(0)[0]) == "r1 (closed)"
    outside = tmp_path / "secret"
    outside.write_text("x", "utf-8")
    (folder / "link.csv").symlink_to(outside)
    with pytest.raises(SurveyError):
        by_hand.begin_edit(folder, "link.csv")
    with pytest.raises(SurveyError):
        by_hand.begin_edit(folder, "../secret")


def test_which_editor_and_which_file() -> None:
    assert by_hand.editor_command({"EDITOR": "vim -n"}) == ("vim", "-n")
    assert by_hand.editor_command({"VISUAL": "code --wait", "EDITOR": "vi"}) == ("code", "--wait")
    assert by_hand.editor_command({}, which=lambda name: name if name == "vi" else None) == ("vi",)
    with pytest.raises(SurveyError, match="no editor"):
        by_hand.editor_command({}, which=lambda _: None)
    problems = [Problem("x", "session r1"), Problem("y", "session r1, observations/r1.csv, line 3")]
    error = SurveyError(problems)
    assert by_hand.file_of(None, None, error) == "observations/r1.csv"
    assert by_hand.file_of(None, None, None) == "project.toml"


def test_a_real_editor_ends_with_its_code(tmp_path: Path) -> None:
    command = by_hand.editor_command({"EDITOR": editor(tmp_path, "p.write_text('a'); sys.exit(3)")})
    done = subprocess.run([*command, str(tmp_path / "f")], check=False)
    assert done.returncode == 3
    assert (tmp_path / "f").read_text("utf-8") == "a"


async def test_a_station_corrected_in_a_form(tmp_path: Path) -> None:
    folder = make_network(tmp_path / "p")
    path = folder / "project.toml"
    text = path.read_text("utf-8").replace("n = 2100.0", "n = 2100.0  # from the office's list")
    path.write_text(text, "utf-8")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("c", "down", "enter")
        await settle(pilot)
        form = app.screen
        assert isinstance(form, CorrectScreen)
        form.query_one("#n", Input).value = "2100,5"
        form.query_one("#deflection-xi_arcsec", Input).value = "1.5"
        await pilot.press("f8")
        await settle(pilot)
        trouble = str(form.query_one("#trouble", Static).content)
        assert "eta_arcsec" in trouble  # xi alone is none
        assert path.read_text("utf-8") == text
        await pilot.press("escape")
        assert "Not written" in str(form.query_one("#trouble", Static).content)
        form.query_one("#deflection-eta_arcsec", Input).value = "-2"
        await pilot.press("f8")
        await settle(pilot)
        assert isinstance(app.screen, ProjectScreen)
    new = tomllib.loads(path.read_text("utf-8"))["station"][1]
    assert new["n"] == 2100.5
    assert new["deflection"] == {"xi_arcsec": 1.5, "eta_arcsec": -2.0}
    assert "# from the office's list" in path.read_text("utf-8")


def test_corrections_that_are_refused_change_nothing(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    before = (folder / "project.toml").read_bytes()
    assert TableName("orientation", "r1") in table_names(folder)
    station = TableName("station", "3083")
    lat = next(item for item in fields_of(folder, station) if item.key == "lat")
    assert fields_of(folder, station)[lat] == "47.0"
    assert correct(folder, station, {"lat": "47.0"}) == ()
    for table, values in (
        (station, {"lat": "95"}),
        (station, {"lat": "north"}),
        (station, {"lat": ""}),
        (TableName("instrument", "G1"), {"card": "no-such-card"}),
        (TableName("orientation", "r1"), {"target": "X", "date": "30.2.2026"}),
    ):
        with pytest.raises(SurveyError):
            correct(folder, table, values)
        assert (folder / "project.toml").read_bytes() == before
    api.close(folder, session="r1")
    session = TableName("orientation", "r1")
    for table, values in ((station, {"lat": "46"}), (session, {"observer": "Li"})):
        with pytest.raises(SurveyError, match="closed session"):
            correct(folder, table, values)
    assert correct(folder, TableName("station", "3090"), {"h": "812.4"}) == ("h",)


def test_the_next_session_is_the_last_one_once_more(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p", "transit", name="ramp3-r09")
    proposal = propose_session(api.open_project(folder))
    assert proposal.id == "ramp3-r10"
    found = (proposal.station, proposal.target, proposal.instrument, proposal.method)
    assert found == ("3083", "3082", "G1", "transit")
    (folder / "observations" / "ramp3-r10.csv").write_text("x", "utf-8")
    assert propose_session(api.open_project(folder)).id == "ramp3-r11"
    other = make_project(tmp_path / "q", name="3083-3082")
    assert propose_session(api.open_project(other)).id == "3083-3082-2"
    empty = tmp_path / "e"
    api.new_project(empty, name="e")
    assert propose_session(api.open_project(empty)).id == "r1"


async def test_a_new_session_takes_three_keys(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    (folder / "observations" / "r2.csv").write_text(
        (folder / "observations" / "r1.csv").read_text("utf-8"), "utf-8"
    )  # left by a program that was killed: the header alone
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("n")
        await settle(pilot)
        assert isinstance(app.screen, NewSessionScreen)
        assert app.screen.query_one("#id", Input).value == "r3"
        app.screen.query_one("#id", Input).value = "r2"
        await pilot.press("f8")
        await settle(pilot)
        assert isinstance(app.screen, SessionScreen)
    session = api.open_project(folder).session("r2")
    assert (session.station, session.target, session.instrument) == ("3083", "3082", "G1")
    assert session.book.rows == ()


async def test_down_and_enter_take_a_grid_from_the_field(tmp_path: Path) -> None:
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("n")
        await settle(pilot)
        form = app.screen
        assert isinstance(form, NewProjectScreen)
        form.query_one("#grid").focus()
        await pilot.press(*"CM 111")
        await settle(pilot)
        options = form.query_one("#grids", OptionList)
        second = options.get_option_at_index(1).id
        await pilot.press("down", "down", "up", "down", "enter")
        await settle(pilot)
        assert form.query_one("#grid", Input).value == second
        assert app.focused is not None
        assert app.focused.id == "grid"


def test_every_field_of_a_correction_has_a_label() -> None:
    from surveyapp.observation.corrections import FIELDS

    names = {item.id for fields in FIELDS.values() for item in fields}
    assert names == set(texts.CORRECT_LABELS)
    assert set(FIELDS) == set(texts.TABLE_KINDS)
    assert max(map(len, texts.CORRECT_LABELS.values())) < 15
    assert api_home.OBSERVATIONS == "observations"


def test_a_session_of_the_same_id_is_refused_and_its_empty_book_stays(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    before = (folder / "project.toml").read_bytes()
    form = api_home.NewSession("r1", "3083", "3082", "G1", "tracking", "survey")
    with pytest.raises(SurveyError, match="exists already"):
        api_home.create_session(folder, form)
    assert (folder / "observations" / "r1.csv").exists()
    assert (folder / "project.toml").read_bytes() == before
