"""The form for a practice session: method, speed, and whether something is hidden."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar, cast

from textual.binding import Binding, BindingType
from textual.widget import Widget

from surveyapp.domain.project import Method
from surveyapp.observation.practice import PracticeWish
from surveyapp.tui import texts
from surveyapp.tui.drafts import Draft
from surveyapp.tui.screens.form import FormScreen
from surveyapp.tui.widgets.field import ChoiceField, chosen

HIDDEN: dict[str, bool | None] = {"nothing": False, "something": True, "lot": None}


class PractiseScreen(FormScreen[PracticeWish]):
    """Returns what is to be practised, or None; the next time the same choices stand here."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("f8", "make", texts.KEY_BEGIN)]
    STATE = texts.PRACTISE_STATE
    FIRST = "method"
    STAYS = True

    def __init__(self, draft: Draft) -> None:
        super().__init__(texts.PRACTISE_TITLE, draft)

    def fields(self) -> Iterable[Widget]:
        """Three choices."""
        yield ChoiceField(texts.F_METHOD, "method", texts.METHODS)
        yield ChoiceField(texts.F_SPEED, "speed", texts.SPEEDS)
        yield ChoiceField(texts.F_HIDDEN, "hidden", texts.HIDDEN)

    def make(self) -> PracticeWish:
        """The wish."""
        return PracticeWish(
            method=cast("Method", chosen(self, "method")),
            speed=float(chosen(self, "speed")),
            disturbed=HIDDEN[chosen(self, "hidden")],
        )
