"""Which face draws which character: pure text work, no page and no font file is touched here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

MISSING: Final = "\N{REPLACEMENT CHARACTER}"
"""Stands for a character that no face at hand has."""

_HANGUL: Final = ((0x1100, 0x11FF), (0x3130, 0x318F), (0xAC00, 0xD7AF))
_KANA: Final = ((0x3040, 0x30FF), (0x31F0, 0x31FF), (0xFF66, 0xFF9D))
_WIDE: Final = (
    *_HANGUL,
    *_KANA,
    (0x2E80, 0x303F),
    (0x3400, 0x4DBF),
    (0x4E00, 0x9FFF),
    (0xF900, 0xFAFF),
    (0xFF00, 0xFFEF),
)


@dataclass(frozen=True, slots=True)
class Face:
    """A face by its registered name and what it has.

    Parameters
    ----------
    name : str
    has : callable
        Tells of a code point whether the face draws it.
    """

    name: str
    has: Callable[[int], bool]


def _within(code: int, ranges: Sequence[tuple[int, int]]) -> bool:
    return any(low <= code <= high for low, high in ranges)


def is_wide(code: int) -> bool:
    """Whether a code point is Chinese, Japanese or Korean."""
    return _within(code, _WIDE)


def language_of(text: str) -> str:
    """``ko`` or ``ja`` where Hangul or kana occur, else ``zh``."""
    if any(_within(ord(c), _HANGUL) for c in text):
        return "ko"
    return "ja" if any(_within(ord(c), _KANA) for c in text) else "zh"


def runs(text: str, faces: Sequence[Face]) -> list[tuple[str, str]]:
    """Split a text into runs of one face.

    Parameters
    ----------
    text : str
        Control characters are shown as spaces.
    faces : sequence of Face
        In order of preference, at least one.

    Returns
    -------
    list of (face name, text)
        A character that no face has is shown as the replacement character.
    """
    result: list[tuple[str, str]] = []
    for character in text:
        shown = character if character.isprintable() else " "
        name = next((face.name for face in faces if face.has(ord(shown))), None)
        if name is None:
            name, shown = faces[0].name, MISSING
        if result and (result[-1][0] == name or (shown == " " and len(result) > 0)):
            result[-1] = (result[-1][0], result[-1][1] + shown)
        else:
            result.append((name, shown))
    return result
