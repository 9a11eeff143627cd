"""Catalogues as translators write them (.po), read at run time by the standard ``gettext``.

No compiled file has to be made or shipped: the few hundred entries become the binary form of
``gettext`` in memory, which brings the plural rules of each language.
"""

from __future__ import annotations

import ast
import gettext
import io
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

_MAGIC: Final = 0x950412DE
Catalogue = Mapping[tuple[str, str | None], tuple[str, ...]]
"""Translations (one, or one a plural form) by English text and its plural or None."""


@dataclass(slots=True)
class _Entry:
    msgid: str = ""
    plural: str | None = None
    texts: dict[int, str] = field(default_factory=dict)
    fuzzy: bool = False


def read_po(text: str) -> dict[tuple[str, str | None], tuple[str, ...]]:
    """Entries of a .po file; the header stands under the empty text.

    Entries that are marked ``fuzzy`` are left out: nobody has confirmed them.

    Raises
    ------
    ValueError
        If a line is no line of a .po file.
    """
    entries: list[_Entry] = []
    entry, place, fuzzy = _Entry(), "", False
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.strip()
        if not line or line.startswith("#"):
            fuzzy = fuzzy or (line.startswith("#,") and "fuzzy" in line)
            continue
        keyword, _, rest = line.partition(" ")
        if line.startswith('"'):
            rest = line
        elif keyword == "msgid":
            entry, fuzzy = _Entry(fuzzy=fuzzy), False
            entries.append(entry)
            place = "msgid"
        elif keyword in ("msgid_plural", "msgstr") or keyword.startswith("msgstr["):
            place = keyword
        else:
            raise ValueError(f"line {number}: {raw}")
        _put(entry, place, str(ast.literal_eval(rest)))
    return {
        (entry.msgid, entry.plural): tuple(entry.texts[form] for form in sorted(entry.texts))
        for entry in entries
        if not entry.fuzzy
    }


def _put(entry: _Entry, place: str, text: str) -> None:
    if place == "msgid":
        entry.msgid += text
    elif place == "msgid_plural":
        entry.plural = (entry.plural or "") + text
    else:
        form = int(place[7:-1]) if place.startswith("msgstr[") else 0
        entry.texts[form] = entry.texts.get(form, "") + text


def translations(catalogue: Catalogue) -> gettext.GNUTranslations:
    """The standard translator of a catalogue; what is not translated yet stays English."""
    pairs = {
        (msgid if plural is None else f"{msgid}\0{plural}"): "\0".join(texts)
        for (msgid, plural), texts in catalogue.items()
        if all(texts)
    }
    originals = sorted((key.encode(), value.encode()) for key, value in pairs.items())
    count = len(originals)
    table, start = b"", 28 + 16 * count
    data = b""
    for column in (0, 1):
        for pair in originals:
            table += struct.pack("<II", len(pair[column]), start + len(data))
            data += pair[column] + b"\0"
    head = struct.pack("<7I", _MAGIC, 0, count, 28, 28 + 8 * count, 0, start)
    return gettext.GNUTranslations(io.BytesIO(head + table + data))
