"""Texts written from right to left, in the order in which a page is drawn.

The order is that of the Unicode bidirectional algorithm (UAX 9, by python-bidi), the letters take
their joined forms (by arabic-reshaper). Both come with the extra ``glyphs``; without them such a
text cannot be drawn, which is told: letters in the wrong order would be another name.
"""

from __future__ import annotations

import re
import unicodedata
from functools import cache
from itertools import groupby
from typing import Final

LINE: Final = 40
"""Letters of right-to-left writing that are kept on one line; longer ones are parted at blanks."""
_RIGHT: Final = ("R", "AL")
_ARABIC: Final = re.compile(r"[\u0600-\u06ff\u0750-\u077f\u08a0-\u08ff]")
_NUMBER: Final = re.compile(r"\d[\d.,:/]*")
_IGNORED: Final = re.compile(r"[\u200c-\u200f\u061c\ufe00-\ufe0f]")
"""Marks that say how to write and are not drawn: joiners, directions, selectors of variants."""


def is_right_to_left(letter: str) -> bool:
    """Whether a letter belongs to a writing from right to left."""
    return unicodedata.bidirectional(letter) in _RIGHT


@cache
def can_order() -> bool:
    """Whether the libraries for it are installed."""
    from importlib.util import find_spec

    return all(find_spec(name) is not None for name in ("bidi", "arabic_reshaper"))


def drawn_order(text: str) -> str:
    """A text as it is drawn from left to right; one without right-to-left letters as it is.

    What is written from right to left is held together by blanks that do not break, so that no
    line ends inside of it: the end of it would stand above its beginning.
    """
    if not any(map(is_right_to_left, text)) or not can_order():
        return _IGNORED.sub("", text)
    from arabic_reshaper import reshape
    from bidi.algorithm import get_display

    parts = []
    for right, piece in _pieces(text):
        if not right or not piece.strip():
            parts.append(piece)
            continue
        joined = reshape(piece) if _ARABIC.search(piece) else piece
        shown = str(get_display(_IGNORED.sub("", str(joined)), base_dir="R"))
        parts.append(shown.replace(" ", "\u00a0"))
    return "".join(parts)


def _pieces(text: str) -> list[tuple[bool, str]]:
    """Stretches of one direction: a number goes with the right-to-left word before it.

    A dash between two names parts them, so that a line from A to B keeps A at its left.
    """
    words = re.split(r"(\s+)", text)
    flags = [any(map(is_right_to_left, word)) for word in words]
    for index in range(2, len(words), 2):
        flags[index] |= flags[index - 2] and _NUMBER.fullmatch(words[index]) is not None
    for index in range(1, len(words) - 1, 2):
        flags[index] = flags[index - 1] and flags[index + 1]
    pieces = []
    for right, group in groupby(zip(flags, words, strict=True), key=lambda item: item[0]):
        piece = "".join(word for _, word in group)
        pieces += [(right, part) for part in (_parted(piece) if right else [piece])]
    return pieces


def _parted(piece: str) -> list[str]:
    """Pieces of at most ``LINE`` letters, parted at blanks."""
    parts, line = [], ""
    for word in piece.split(" "):
        if line and len(line) + len(word) >= LINE:
            parts += [line, " "]
            line = word
        else:
            line = f"{line} {word}" if line else word
    return [*parts, line]
