"""The number keys of a screen with pages: one shown in the footer, all of them in the palette."""

from __future__ import annotations

from collections.abc import Mapping

from textual.binding import Binding

from surveyapp.tui import texts


def page_bindings(pages: Mapping[str, str]) -> list[Binding]:
    """A number key for each page.

    Parameters
    ----------
    pages : mapping
        Tab as shown by the id of its page.
    """
    return [
        Binding(
            str(number),
            f"page('{page}')",
            texts.KEY_TABS,
            show=number == 1,
            key_display=f"1-{len(pages)}" if number == 1 else None,
            tooltip=texts.LONG_PAGE.format(tab=tab),
        )
        for number, (page, tab) in enumerate(pages.items(), 1)
    ]
