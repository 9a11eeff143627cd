"""The form for a practice session: method, speed, and whether something is hidden."""

from __future__ import annotations

from typing import ClassVar, cast

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import Screen
from textual.widgets import Footer

from surveyapp.domain.project import Method
from surveyapp.observation.practice import PracticeWish
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft, keep, put_back
from surveyapp.tui.widgets.field import ChoiceField, chosen
from surveyapp.tui.widgets.titlebar import TitleBar

HIDDEN: dict[str, bool | None] = {"nothing": False, "something": True, "lot": None}


class PractiseScreen(Screen[PracticeWish | None]):
    """Returns what is to be practised, or None."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "app.focus_next", texts.KEY_FIELD),
        Binding("f8", "begin", texts.KEY_BEGIN),
        Binding("escape", "leave", texts.KEY_LEAVE),
    ]

    def __init__(self, draft: Draft) -> None:
        super().__init__()
        self.draft = draft

    def compose(self) -> ComposeResult:
        """Three choices."""
        yield TitleBar(texts.PRACTISE_TITLE)
        with VerticalScroll(can_focus=False, classes="form"):
            yield ChoiceField(texts.F_METHOD, "method", texts.METHODS)
            yield ChoiceField(texts.F_SPEED, "speed", texts.SPEEDS)
            yield ChoiceField(texts.F_HIDDEN, "hidden", texts.HIDDEN)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin at the method."""
        self.query_one(TitleBar).state = texts.PRACTISE_STATE
        put_back(self, self.draft)
        self.query_one("#method").focus()

    def action_begin(self) -> None:
        """Begin; the next time the same choices stand here."""
        keep(self, self.draft)
        self.dismiss(
            PracticeWish(
                method=cast("Method", chosen(self, "method")),
                speed=float(chosen(self, "speed")),
                disturbed=HIDDEN[chosen(self, "hidden")],
            )
        )

    def action_leave(self) -> None:
        """Begin nothing."""
        keep(self, self.draft)
        self.dismiss(None)
