"""A document in the reader's language: every text of its blocks said again, numbers as they are."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar

from surveyapp.languages import current, shown
from surveyapp.report.blocks import Figure, Label

T = TypeVar("T")


def in_words(value: T) -> T:
    """A block, a document or a tuple of them with every text in the language in use.

    Parameters
    ----------
    value : str, tuple or frozen dataclass of blocks

    Returns
    -------
    the same kind
        What holds no text is returned as it is; in English so is everything.
    """
    return value if current() == "en" else _told(value)


def _told(value: Any) -> Any:
    if isinstance(value, str):
        return shown(value)
    if isinstance(value, tuple):
        return tuple(_told(item) for item in value)
    if isinstance(value, Figure):
        items = (_told(p) if isinstance(p, Label) else p for p in value.primitives)
        return replace(value, title=shown(value.title), primitives=tuple(items))
    if is_dataclass(value) and not isinstance(value, type):
        told = {item.name: _told(getattr(value, item.name)) for item in fields(value)}
        return type(value)(**told)
    return value
