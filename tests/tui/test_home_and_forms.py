"""A project and a session made on the screen stand in project.toml and can be observed."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from textual.widgets import Input, OptionList, Select, Static, TextArea

from surveyapp import api
from surveyapp.errors import SurveyError
from surveyapp.io.decimals import typed_number, typed_words
from surveyapp.observation import home as api_home
from surveyapp.observation.owner_entries import OwnerEntries
from surveyapp.observation.station_lines import NewStation, read_stations
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.screens.home import HomeScreen
from surveyapp.tui.screens.new_project import NewProjectScreen
from surveyapp.tui.screens.project import ProjectScreen
from surveyapp.tui.screens.session import SessionScreen
from tests.tui.helpers_tui import (
    SMALL,
    settle,
)


async def test_a_project_and_a_session_made_on_the_screen(tmp_path: Path) -> None:
    folder = tmp_path / "ramp 3"
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        assert isinstance(app.screen, HomeScreen)
        await pilot.press("n")
        await settle(pilot)
        form = app.screen
        assert isinstance(form, NewProjectScreen)
        await pilot.press(*"Ramp 3", "tab")
        form.query_one("#folder", Input).value = str(folder)
        form.query_one("#typing", Select).value = "packed"
        form.query_one(
            "#stations", TextArea
        ).text = "name;lat;lon;h\n3083;34.4;110.3;812.4\n3082;34.41;110.31;"
        form.query_one("#grid").focus()
        await pilot.press(*"cm 111")
        await settle(pilot)
        grids = form.query_one("#grids", OptionList)
        codes = [grids.get_option_at_index(i).id for i in range(grids.option_count)]
        assert "EPSG:4546" in codes
        form.query_one("#grid", Input).value = "EPSG:4546"
        form.query_one("#card", Select).value = "wild-gak1"
        await settle(pilot)
        assert "32.4" in str(form.query_one("#card-told", Static).content)
        await pilot.press("f8")
        await settle(pilot)
        assert isinstance(app.screen, ProjectScreen)
        await pilot.press("n")
        await settle(pilot)
        app.screen.query_one("#id", Input).value = "r1"
        app.screen.query_one("#target", Select).value = "3082"
        app.screen.query_one("#wanted", Input).value = "15"
        await pilot.press("f8")
        await settle(pilot)
        assert isinstance(app.screen, SessionScreen)
        app.screen.query_one("#reading", Input).value = "5"
        await pilot.press("enter")
        await settle(pilot)
    written = tomllib.loads((folder / "project.toml").read_text(encoding="utf-8"))
    assert written["name"] == "Ramp 3"
    assert written["crs"] == "EPSG:4546"
    assert written["angle_typing"] == "packed"
    assert [s["name"] for s in written["station"]] == ["3083", "3082"]
    assert written["instrument"] == [{"id": "G1", "card": "wild-gak1"}]
    assert written["orientation"][0]["wanted_interval_arcsec"] == 15.0
    project = api.open_project(folder)
    assert project.sessions[0].target == "3082"
    assert [row.text for row in project.sessions[0].book.rows] == ["5"]
    assert not project.warnings, project.warnings
    assert api_home.recent_projects() == (str(folder.resolve()),)


async def test_a_form_with_faults_makes_nothing_and_says_why(tmp_path: Path) -> None:
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("n", "f8")
        await settle(pilot)
        form = app.screen
        assert isinstance(form, NewProjectScreen)
        form.query_one("#name", Input).value = "x"
        form.query_one("#folder", Input).value = str(tmp_path / "x")
        form.query_one("#stations", TextArea).text = "A 1\nA 1 2"
        await pilot.press("f8")
        await settle(pilot)
        assert "line 1" in str(form.query_one("#trouble", Static).content)
        await pilot.press("escape")
        await settle(pilot)
        assert isinstance(app.screen, HomeScreen)
    assert not (tmp_path / "x").exists()


def test_stations_are_read_as_surveyors_write_them(tmp_path: Path) -> None:
    expected = (NewStation("A", e=1.5, n=2.5, h=3.0), NewStation("B"))
    assert read_stations("A 1.5 2.5 3\nB") == expected
    assert read_stations("A,1.5,2.5,3\nB,,,") == expected
    assert read_stations("Name;N;E;H\nA;2.5;1.5;3\nB;;;") == expected
    file = tmp_path / "points.csv"
    file.write_text("A,1.5,2.5,3\nB\n", encoding="utf-8")
    assert read_stations(str(file)) == expected
    with pytest.raises(SurveyError, match="twice"):
        read_stations("A 1 2\nA 1 2")


def test_a_decimal_comma_in_a_form_is_one_and_never_another_column() -> None:
    expected = (NewStation("A", e=1.5, n=2.5, h=3.0),)
    for line in ("A; 1,5; 2,5; 3", "A\t1,5\t2,5\t3", "A 1,5 2,5 3,0", "A, 1.5, 2.5, 3"):
        assert read_stations(line) == expected
    with pytest.raises(SurveyError, match="more values than its 4 columns"):
        read_stations("3083,431630,663,3811452,311")  # east and north 431630 and 663 before
    with pytest.raises(SurveyError, match="east is no number"):
        read_stations("A east north")
    owner = OwnerEntries("600,5", "425,4 388,3 47,0", "0,2").overrides()
    period = {"latitude_deg": 47.0, "tracking_s": 425.4, "clamped_s": 388.3}
    assert owner == {
        "scale_value_arcsec": 600.5,
        "period": period,
        "torsion": {"lambda": 0.2},
    }
    words = ["12-00-00", "1000", "2000", "47.0", "8.0"]
    assert typed_words("12-00-00, 1000, 2000, 47.0, 8.0") == words
    assert typed_words("12-00-00,1000,2000,47.0,8.0") == words
    assert typed_words("12-00-00 1000,5 2000,5") == ["12-00-00", "1000.5", "2000.5"]
    for text in ("nan", "inf", "1_000", "1,2,3", "1.2,3", "", "1e999"):
        with pytest.raises(ValueError, match="is no number"):
            typed_number(text)
    assert [typed_number(text) for text in ("-9,7", "\u22129.7", ",5", "1e3")] == [
        -9.7,
        -9.7,
        0.5,
        1e3,
    ]


def test_a_session_that_cannot_stand_leaves_the_project_as_it_was(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    api_home.create_project(api_home.NewProject(folder=str(folder), name="p"))
    before = (folder / "project.toml").read_bytes()
    form = api_home.NewSession("r1", "X", "", "G1", "tracking", "survey")
    with pytest.raises(SurveyError):
        api_home.create_session(folder, form)
    assert (folder / "project.toml").read_bytes() == before
    assert list((folder / "observations").iterdir()) == []


async def test_a_sample_is_opened_as_the_users_own_copy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from surveyapp.io import locations

    monkeypatch.setattr(locations, "user_documents_folder", lambda: tmp_path / "documents")
    app = SurveyApp(None)
    async with app.run_test(size=SMALL) as pilot:
        await settle(pilot)
        await pilot.press("enter")
        await settle(pilot)
        assert isinstance(app.screen, ProjectScreen)
    copies = [p.name for p in (tmp_path / "documents").iterdir()]
    assert copies == [api_home.samples()[0]]


def test_a_long_list_of_stations_is_no_burden(tmp_path: Path) -> None:
    """Stations are written in one go: as many writings as before the list, not one for each."""
    from surveyapp.io import writing

    text = "name,e,n\n" + "\n".join(f"P{k},{431000 + k},{3811000 + k}" for k in range(2000))
    stations = read_stations(text)
    assert len(stations) == 2000
    written: list[int] = []
    real = writing.atomic_write

    def counted(path: Path, data: bytes) -> None:
        written.append(len(data))
        real(path, data)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            writing,
            "atomic_write",
            counted,
        )
        form = api_home.NewProject(folder=str(tmp_path / "p"), name="p", stations=stations)
        folder = api_home.create_project(form)
    assert len(written) == 1
    project = api.open_project(folder)
    assert [s.name for s in project.stations] == [f"P{k}" for k in range(2000)]
    twice = text + "\nP7,1,2"
    with pytest.raises(SurveyError, match="P7"):
        read_stations(twice)


@pytest.mark.parametrize("identity", ["../x", "a/b", "/x", "..", ".x", "con:", "a\nb", "x" * 300])
def test_an_id_that_names_no_file_is_refused_and_nothing_is_made(
    tmp_path: Path, identity: str
) -> None:
    folder = tmp_path / "p"
    stations = (NewStation("测站"), NewStation("B"))
    form = api_home.NewProject(
        folder=str(folder), name="p", stations=stations, instruments=(("G1", "wild-gak1", ""),)
    )
    api_home.create_project(form)
    before = {path for path in tmp_path.rglob("*") if path.is_file() and path.suffix != ".lock"}
    with pytest.raises(SurveyError, match="field book"):
        api_home.create_session(
            folder, api_home.NewSession(identity, "测站", "B", "G1", "tracking", "survey")
        )
    after = {path for path in tmp_path.rglob("*") if path.is_file() and path.suffix != ".lock"}
    assert after == before
    good = api_home.NewSession("测站-1", "测站", "B", "G1", "tracking", "survey")
    api_home.create_session(folder, good)
    assert api.open_project(folder).sessions[0].book_path == "observations/测站-1.csv"
