"""Where one begins: recent projects, samples, a folder, a new project, practice."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.message import Message
from textual.screen import Screen
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from surveyapp.errors import SurveyError
from surveyapp.observation import home as api_home
from surveyapp.observation.practice import PracticeWish
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.folder import FolderScreen
from surveyapp.tui.screens.new_project import NewProjectScreen
from surveyapp.tui.screens.practise import PractiseScreen
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar


class HomeScreen(Screen[None]):
    """The first screen without a project."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "choose", texts.KEY_OPEN, priority=True),
        Binding("n", "new", texts.KEY_NEW_PROJECT),
        Binding("o", "folder", texts.KEY_FOLDER),
        Binding("p", "practise", texts.KEY_PRACTISE),
        Binding("l", "app.language", texts.KEY_LANGUAGE, show=False),
        Binding("q", "app.quit", texts.KEY_QUIT),
    ]

    class FolderChosen(Message):
        """A project is to be opened; ``importing``: at the files that may be imported."""

        def __init__(self, folder: str, *, importing: bool = False) -> None:
            super().__init__()
            self.folder = folder
            self.importing = importing

    class PracticeChosen(Message):
        """A practice session is to begin."""

        def __init__(self, wish: PracticeWish) -> None:
            super().__init__()
            self.wish = wish

    def __init__(self) -> None:
        super().__init__()
        self.recent = api_home.recent_projects()
        self.samples = api_home.samples()
        self.drafts: dict[str, Draft] = {"project": {}, "folder": {}, "practice": {}}

    def compose(self) -> ComposeResult:
        """Title and what can be opened."""
        yield TitleBar(texts.HOME_TITLE)
        yield OptionList(id="places")
        yield Static(id="trouble", markup=False)
        yield KeyBar(palette=True)

    def on_mount(self) -> None:
        """Fill the list."""
        self.fill()

    def on_screen_resume(self) -> None:
        """A project may have been opened meanwhile."""
        recent = api_home.recent_projects()
        if recent != self.recent:
            self.recent = recent
            self.fill()

    def fill(self) -> None:
        """Show every place to begin."""
        places = self.query_one("#places", OptionList)
        places.clear_options()
        options = [_heading(texts.HOME_RECENT)]
        options += [Option(_place(path), id=f"recent:{path}") for path in self.recent]
        if not self.recent:
            options.append(_heading(texts.HOME_NO_RECENT))
        options += [_heading(""), _heading(texts.HOME_SAMPLES)]
        options += [Option(f"  {name}", id=f"sample:{name}") for name in self.samples]
        options += [_heading(""), _heading(texts.HOME_MORE)]
        options.append(Option(f"  {texts.HOME_NEW}", id="new:"))
        options.append(Option(f"  {texts.HOME_OPEN}", id="folder:"))
        options.append(Option(f"  {texts.HOME_PRACTISE}", id="practise:"))
        options.append(Option(f"  {texts.HOME_LANGUAGE}", id="language:"))
        places.add_options(options)
        places.focus()
        places.action_first()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Open what was chosen."""
        kind, _, value = (event.option_id or "").partition(":")
        if kind == "new":
            self.action_new()
        elif kind == "folder":
            self.action_folder()
        elif kind == "practise":
            self.action_practise()
        elif kind == "language":
            self.app.action_language()  # type: ignore[attr-defined]
        elif kind == "sample":
            try:
                self.post_message(self.FolderChosen(api_home.sample_copy(value)))
            except SurveyError as error:
                self.query_one("#trouble", Static).update(problems_text(error))
        else:
            self.post_message(self.FolderChosen(value))

    def action_choose(self) -> None:
        """Open what is under the cursor."""
        self.query_one("#places", OptionList).action_select()

    def action_new(self) -> None:
        """Make a new project."""
        form = NewProjectScreen(self.drafts["project"])

        def made(folder: str | None) -> None:
            if folder:
                self.post_message(self.FolderChosen(folder, importing=form.importing))

        self.app.push_screen(form, made)

    def action_folder(self) -> None:
        """Type a folder."""
        self.app.push_screen(FolderScreen(self.drafts["folder"]), self._opened)

    def action_practise(self) -> None:
        """Choose what to practise."""
        self.app.push_screen(PractiseScreen(self.drafts["practice"]), self._practise)

    def _practise(self, wish: PracticeWish | None) -> None:
        if wish is not None:
            self.post_message(self.PracticeChosen(wish))

    def _opened(self, folder: str | None) -> None:
        if folder:
            self.post_message(self.FolderChosen(folder))


def _heading(text: str) -> Option:
    return Option(text, disabled=True)


def _place(path: str) -> str:
    return f"  {Path(path).name}  ({Path(path).parent})"
