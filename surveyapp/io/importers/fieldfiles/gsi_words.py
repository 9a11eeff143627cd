"""Words of a Leica GSI block: index, information, sign and 8 or 16 characters, by their place.

Knows how a word is cut and what unit its digits have; what a block means is ``gsi``.

Sources: Leica TPS1100 reference manual, GSI format; totalopenstation, input format Leica GSI.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Final, NamedTuple

from surveyapp.io.importers.fieldfiles.units import DEGREE, GON, MIL
from surveyapp.languages import said

RARE: Final = 9
"""A layout that stands in less than a tenth of the blocks is rare."""
ONCE: Final = 4
"""One that stands but once is rare beside so many."""
_MEASURED: Final = frozenset({"21", "22", "31", "32"})
HEAD: Final = 7
"""Index, information and sign."""
_OPENING = re.compile(r"(?<!\S)\*?(?:11|41)[\d.?]{4}[+-]")
_HEAD = re.compile(r"\d\d[\d.?]{4}[+-]")
_PLACES: Final = {"0": 1e-3, "6": 1e-4, "8": 1e-5}
_FEET: Final = {"1": 1e-3, "7": 1e-4}
_CIRCLE: Final = {"2": (GON, 1e-5), "3": (DEGREE, 1e-5), "5": (MIL, 1e-4)}
_TORN_NAME = re.compile(r"0+ |[^0-9A-Za-z ]000")
"""Blanks behind the zeros that pad a name, or something strange in front of them."""
_NOTHING = re.compile(r"0*-+")


class WordError(ValueError):
    """A word that cannot be read: what is wrong with it."""


class Word(NamedTuple):
    """One word of a block.

    Parameters
    ----------
    word_index : str
        Two or three digits.
    info : str
        Positions 3 to 6, dots included.
    sign : str
    data : str
        8 or 16 characters.
    """

    word_index: str
    info: str
    sign: str
    data: str

    @property
    def empty(self) -> bool:
        """Whether dashes say that there is no value."""
        return "-" in self.data and _NOTHING.fullmatch(self.data.strip()) is not None

    @property
    def name(self) -> str:
        """The data as a name: without the zeros that pad it; of zeros only, ``0``."""
        text = self.data.strip()
        name = text.lstrip("0")
        if not name and text and self.data[-1] != " ":
            return "0"
        if not name[:1].isalnum() and _TORN_NAME.match(self.data) is not None:
            raise WordError(
                said(
                    "word {word_index} holds a torn name: {value}",
                    word_index=self.word_index,
                    value=self.data.rstrip(),
                )
            )
        return name

    @property
    def sixty(self) -> bool:
        """Whether an angle has 60 seconds."""
        return self.info[-1] == "4" and self.data.endswith("600")

    def integer(self) -> int:
        """The digits with their sign."""
        if not (self.data.isascii() and self.data.isdigit()):
            raise WordError(
                said(
                    "word {word_index} holds no number: {value}",
                    word_index=self.word_index,
                    value=self.data.strip(),
                )
            )
        value = int(self.data)
        return -value if self.sign == "-" else value

    def angle(self) -> float:
        """A circle reading [rad]."""
        unit, digits = self.info[-1], self.integer()
        if unit == "4":
            seconds10, rest = digits % 1000, digits // 1000
            minutes, degrees = rest % 100, rest // 100
            if minutes > 59 or seconds10 > 600 or digits < 0:
                raise WordError(
                    said(
                        "word {word_index} is no DDDMMSSs: {data}",
                        word_index=self.word_index,
                        data=self.data,
                    )
                )
            return (degrees + minutes / 60.0 + seconds10 / 36000.0) * DEGREE
        if unit not in _CIRCLE:
            raise WordError(
                said(
                    "word {word_index} has no unit of angles: {unit}",
                    word_index=self.word_index,
                    unit=unit,
                )
            )
        factor, place = _CIRCLE[unit]
        return digits * place * factor

    def length(self, foot: float) -> tuple[float, bool]:
        """A length [m] and whether it was written in feet."""
        unit = self.info[-1]
        if unit in _PLACES:
            return round(self.integer() * _PLACES[unit], 6), False
        if unit in _FEET:
            return self.integer() * _FEET[unit] * foot, True
        raise WordError(
            said(
                "word {word_index} has no unit of lengths: {unit}",
                word_index=self.word_index,
                unit=unit,
            )
        )

    def pair(self) -> tuple[int, int]:
        """Two signed numbers in one word (51: ppm and prism), split at the second sign."""
        found = _two_numbers(self.data.strip())
        if found is None:
            raise WordError(
                said(
                    "word {word_index} holds no two signed numbers: {value}",
                    word_index=self.word_index,
                    value=self.data.strip(),
                )
            )
        return found[0] * (-1 if self.sign == "-" else 1), found[1]


@lru_cache(maxsize=1 << 10)
def _two_numbers(text: str) -> tuple[int, int] | None:
    match = re.fullmatch(r"(\d+)([+-])(\d+)", text)
    return None if match is None else (int(match[1]), int(match[2] + match[3]))


def blocks(line: str) -> Iterator[str]:
    """Blocks of a line: each word 11 or 41 opens one."""
    if line.count("11") + line.count("41") > 1:
        places = [match.start() for match in _OPENING.finditer(line)]
        if len(places) > 1:
            if line[: places[0]].strip():
                yield line[: places[0]]
            for start, end in zip(places, [*places[1:], len(line)], strict=True):
                yield line[start:end]
            return
    yield line


def last_opening(text: str) -> int:
    """Place of the last block of a piece of a line, which goes on behind it; 0 without one."""
    return max((match.start() for match in _OPENING.finditer(text)), default=0)


def block_width(block: str) -> int:
    """Characters of each datum: 16 behind a star, else as the first word shows."""
    if block.startswith("*"):
        return 16
    first = block.split(" ", 1)[0]
    return 16 if len(first) == HEAD + 16 else 8


def words(block: str) -> list[Word]:
    """Words of a block, cut by their place.

    Raises
    ------
    WordError
        If the block is cut short, or a word is none.
    """
    width = block_width(block)
    text = block.removeprefix("*").rstrip()
    stride = HEAD + width + 1
    if (len(text) + 1) % stride == 0 and not text[HEAD + width :: stride].strip(" "):
        starts = range(0, len(text), stride)
        kinds = [_kind(text[start : start + HEAD]) for start in starts]
        if None not in kinds:
            return [
                Word(*kind, text[start + HEAD : start + HEAD + width])
                for kind, start in zip(kinds, starts, strict=True)
                if kind is not None
            ]
    return _words_one_by_one(block, text, width)


@lru_cache(maxsize=1 << 14)
def _kind(head: str) -> tuple[str, str, str] | None:
    """Index, information and sign of a word; None for what begins no word."""
    if _HEAD.fullmatch(head) is None:
        return None
    return (*_index(head[:6]), head[6])


def _words_one_by_one(block: str, text: str, width: int) -> list[Word]:
    """Words of a block that is not whole at first sight: trimmed blanks, or damage to be named."""
    found: list[Word] = []
    place = 0
    while place < len(text):
        piece = text[place : place + HEAD + width]
        if len(piece) < HEAD + width and not _blank_tail(piece, block, place, width):
            raise WordError(
                said(
                    "the line is cut short behind {size} words: {piece}",
                    size=len(found),
                    piece=piece,
                )
            )
        piece = piece.ljust(HEAD + width)
        if _HEAD.fullmatch(piece[:HEAD]) is None:
            raise WordError(said("this is no word: {value}", value=piece.strip()))
        index, info = _index(piece[:6])
        found.append(Word(index, info, piece[6], piece[HEAD:]))
        place += HEAD + width
        if place < len(text) and text[place] != " ":
            raise WordError(
                said(
                    "word {index} is too long: {value}",
                    index=index,
                    value=text[place - HEAD - width :][:30],
                )
            )
        while place < len(text) and text[place] == " ":
            place += 1
    if not found:
        raise WordError("the block holds no word")
    return found


Layout = tuple[str, str, bool]
"""First and second digits of the indices of a block's words, and whether a blank ends it."""


def layout(block: str) -> Layout:
    """Indices of a block's words by their places; nothing is checked."""
    text = block.removeprefix("*").rstrip()
    stride = HEAD + block_width(block) + 1
    return text[::stride], text[1::stride], block[-1:] == " "


def cut_layouts(counts: Mapping[Layout, int], last: Layout | None = None) -> frozenset[Layout]:
    """Layouts that are the beginning of another that the file holds far more often.

    An instrument writes every block of a kind with the same words, and a distance that was not
    measured as 0: a rare block with fewer words was cut between two of them. So was one that ends
    otherwise than those that are whole, and the last one of a file that is torn. Code blocks are
    as the office made them.

    Parameters
    ----------
    counts : mapping
        How often each layout stands in the file.
    last : tuple or None
        Layout of the last block.
    """
    return frozenset(
        short
        for short, count in counts.items()
        if (short[0][:1], short[1][:1]) != ("4", "1")
        and any(
            whole[0].startswith(short[0])
            and whole[1].startswith(short[1])
            and len(whole[0]) > len(short[0])
            and number > count * _rarity(short, count, other_end=short[2] != whole[2], last=last)
            for whole, number in counts.items()
        )
    )


def lacking(counts: Mapping[Layout, int]) -> list[tuple[Layout, tuple[str, ...]]]:
    """Layouts of readings that lack words inside of one that the file holds far more often.

    Nothing proves that they were damaged, for a surveyor may change the mask: it is only told.
    """
    usual = max(counts, key=lambda kind: counts[kind], default=None)
    if usual is None:
        return []
    whole = _indices(usual)
    found = []
    for kind, count in counts.items():
        own = _indices(kind)
        rest = iter(whole)
        inside = len(own) < len(whole) and all(index in rest for index in own)
        if inside and counts[usual] >= count * RARE and own.keys() & _MEASURED:
            found.append((kind, tuple(index for index in whole if index not in own)))
    return found


def _indices(kind: Layout) -> dict[str, None]:
    """Two digits of each word in order."""
    return dict.fromkeys(a + b for a, b in zip(kind[0], kind[1], strict=False))


def _rarity(short: Layout, count: int, *, other_end: bool, last: Layout | None) -> int:
    """How many whole blocks to each short one prove that it was cut."""
    if other_end or _names_station(short):
        return 1
    if count == 1:
        return 1 if short == last else ONCE
    return RARE


def _names_station(indices: Layout) -> bool:
    return "84" in {a + b for a, b in zip(indices[0], indices[1], strict=False)}


def _blank_tail(piece: str, block: str, place: int, width: int) -> bool:
    """Whether only blanks of a text were trimmed: the untrimmed block reaches the word's end."""
    start = place + (1 if block.startswith("*") else 0)
    return len(piece) > HEAD and len(block) >= start + HEAD + width


def _index(head: str) -> tuple[str, str]:
    """Index and information: two digits, three where the third position is a digit as well."""
    size = 2 if head[:2] in ("11", "41") or not head[2].isdigit() else 3
    return head[:size], head[size:].rjust(4, ".")
