"""A form: fields below each other, F8 makes what they say, Escape keeps what was filled in."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable
from typing import ClassVar, Generic, TypeVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Static

from surveyapp.errors import SurveyError
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back
from surveyapp.tui.widgets.key_bar import KeyBar
from surveyapp.tui.widgets.problems import problems_text
from surveyapp.tui.widgets.titlebar import TitleBar

Made = TypeVar("Made")


class FormScreen(Screen[Made | None], Generic[Made]):
    """Returns what was made, or None.

    Parameters
    ----------
    title : str
    draft : dict
        What was filled in before; the screen that opens this one owns it.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", texts.KEY_FIELD),
        Binding("f8", "make", texts.KEY_MAKE),
        Binding("escape", "leave", texts.KEY_LEAVE),
    ]
    STATE: ClassVar[str] = texts.NEW_STATE
    """What the title says on the right."""
    FIRST: ClassVar[str] = "id"
    """The field where one begins."""

    STAYS: ClassVar[bool] = False
    """Whether the next opening begins with what was made."""

    def __init__(self, title: str, draft: Draft) -> None:
        super().__init__()
        self.title_text = title
        self.draft = draft

    @abstractmethod
    def fields(self) -> Iterable[Widget]:
        """The fields, from above."""

    @abstractmethod
    def make(self) -> Made:
        """Make what the fields say.

        Raises
        ------
        SurveyError
            If it cannot be made; the form stays open and says why.
        """

    def filled(self) -> Draft:
        """What stands in the fields where nothing was filled in before."""
        return {}

    def compose(self) -> ComposeResult:
        """Title, fields, what is wrong, keys."""
        yield TitleBar(self.title_text)
        with VerticalScroll(can_focus=False, classes="form"):
            yield from self.fields()
        yield Static(id="trouble", markup=False)
        yield KeyBar()

    def on_mount(self) -> None:
        """Begin at the first field, with what was filled in before."""
        self.query_one(TitleBar).state = self.STATE
        put_back(self, self.draft or self.filled())
        for first in self.query(f"#{self.FIRST}"):
            first.focus()

    def action_make(self) -> None:
        """Make it, or say what is wrong."""
        keep(self, self.draft)
        try:
            made = self.make()
        except SurveyError as error:
            self.query_one("#trouble", Static).update(problems_text(error))
            return
        if not self.STAYS:
            self.draft.clear()
        self.dismiss(made)

    def action_leave(self) -> None:
        """Make nothing; what was filled in waits for the next opening."""
        keep(self, self.draft)
        self.dismiss(None)
