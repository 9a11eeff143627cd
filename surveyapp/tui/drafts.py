"""What stands half typed in a form: kept when it is left with Escape, put back when it opens."""

from __future__ import annotations

from contextlib import suppress

from textual.widget import Widget
from textual.widgets import Input, Select, TextArea
from textual.widgets.select import InvalidSelectValueError

Draft = dict[str, str]
"""Text by the id of its field; the screen that opens a form owns it."""


def keep(form: Widget, draft: Draft) -> None:
    """Take down what stands in the fields of a form."""
    draft.clear()
    for line in form.query(Input):
        draft[line.id or ""] = line.value
    for area in form.query(TextArea):
        draft[area.id or ""] = area.text
    for choice in form.query(Select):
        if isinstance(choice.value, str):
            draft[choice.id or ""] = choice.value


def put_back(form: Widget, draft: Draft) -> None:
    """Fill the fields of a form with what was taken down; a choice that is gone stays away."""
    for line in form.query(Input):
        line.value = draft.get(line.id or "", line.value)
        line.cursor_position = len(line.value)
    for area in form.query(TextArea):
        area.text = draft.get(area.id or "", area.text)
    for choice in form.query(Select):
        with suppress(InvalidSelectValueError):
            choice.value = draft.get(choice.id or "", choice.value)
