"""A text that can be said in another language later: its English template and what stands in it.

Core forms texts with values inside; they are plain English for JSON, files and comparison, and the
screens and the record say them again in the reader's language. Nothing here reads a catalogue.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Self

Translate = Callable[[str, str | None, int], str]
"""From an English template, its plural (or None) and a count to the template of a language."""


class Said(str):
    """English text that knows its template and fields.

    Equal to, and hashed as, its English; what is made of it by other means than ``said`` and ``+``
    (an f-string, ``join``) is plain English again and is no longer translated.

    Parameters
    ----------
    template : str
        Text as in the catalogue; with fields it is filled by ``str.format``.
    fields : dict
        By name; a field that is itself ``Said`` is translated too.
    plural : str or None
        Template for other counts than one; the field ``count`` decides.
    """

    __slots__ = ("fields", "plural", "template")
    template: str
    plural: str | None
    fields: dict[str, Any]

    def __new__(cls, template: str, fields: dict[str, Any], plural: str | None = None) -> Self:
        """English text by filling the template."""
        chosen = template if plural is None or fields.get("count") == 1 else plural
        text = super().__new__(cls, chosen.format(**fields) if fields else chosen)
        text.template, text.fields, text.plural = template, fields, plural
        return text

    def __getnewargs__(self) -> tuple[str, dict[str, Any], str | None]:  # type: ignore[override]
        return self.template, self.fields, self.plural

    def __deepcopy__(self, memo: object) -> Self:
        return self

    def __add__(self, other: str) -> str:
        return joined("", (self, other))

    def __radd__(self, other: str) -> str:
        return joined("", (other, self))

    def told(self, translate: Translate) -> str:
        """The text in the language of ``translate``; English where its template does not fit."""
        count = self.fields.get("count", 0) if self.plural is not None else 0
        template = translate(self.template, self.plural, count)
        if not self.fields:
            return template
        fields = {
            name: value.told(translate) if isinstance(value, Said) else value
            for name, value in self.fields.items()
        }
        try:
            return template.format(**fields)
        except (KeyError, IndexError, ValueError):
            return str(self)


def said(template: str, /, **fields: Any) -> str:
    """A text: its template is a literal, so that ``scripts/extract_texts.py`` finds it."""
    return Said(template, fields)


def counted(one: str, many: str, /, *, count: int, **fields: Any) -> str:
    """A text with a count: English has two forms, Russian three, Chinese one."""
    return Said(one, {"count": count, **fields}, many)


def said_each(*templates: str) -> tuple[str, ...]:
    """Several texts without fields: the heads of a table."""
    return tuple(Said(template, {}) for template in templates)


def joined(separator: str, parts: Iterable[str]) -> str:
    """Texts behind one another; the separator has no words, so that it is no text itself."""
    fields = {f"part{index}": part for index, part in enumerate(parts)}
    if not fields:
        return Said("", {})
    literal = separator.replace("{", "{{").replace("}", "}}")
    return Said(literal.join(f"{{{name}}}" for name in fields), fields)


def listed(parts: Iterable[str]) -> str:
    """Texts in a row as in running text: ``a and b``."""
    whole = ""
    for part in parts:
        whole = said("{before} and {last}", before=whole, last=part) if whole else part
    return whole


def some(parts: Sequence[str], most: int) -> str:
    """The first of many, and how many more there are: ``1, 2, 3 and 4 more``."""
    first = joined(", ", parts[:most])
    rest = len(parts) - most
    if rest <= 0:
        return first
    return counted("{first} and {count} more", "{first} and {count} more", count=rest, first=first)


def term(text: str) -> str:
    """A name from a table of the program (a source of error, a method) as a text.

    What is a text already stays the one that it is.
    """
    return text if isinstance(text, Said) else Said(text, {})


def either(parts: Iterable[str]) -> str:
    """Texts of which one is meant: ``a, b or c``."""
    *before, last = parts
    return said("{before} or {last}", before=joined(", ", before), last=last) if before else last


class _Sentence(Said):
    """A text with a capital letter at its beginning."""

    __slots__ = ()

    def __new__(cls, template: str, fields: dict[str, Any], plural: str | None = None) -> Self:
        """The English with a capital letter."""
        made = super().__new__(cls, template, fields, plural)
        capital = str.__new__(cls, made[:1].upper() + made[1:])
        capital.template, capital.fields, capital.plural = template, fields, plural
        return capital

    def told(self, translate: Translate) -> str:
        """The text in a language, with a capital letter."""
        text = super().told(translate)
        return text[:1].upper() + text[1:]


def sentence(text: str) -> str:
    """A text as a sentence of its own: a capital letter, and a full stop where it has none."""
    if text.endswith("."):
        return _Sentence("{text}", {"text": text})
    return _Sentence("{text}.", {"text": text})
