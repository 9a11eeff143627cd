"""Leica GSI-8 and GSI-16: blocks to pointings, with both ways of naming a station.

Convention 1: a block 11 with 84 85 86 or 88 and no reading is a station. Convention 2: a code block
41 of the office's own code names it in 42 and the instrument height in 43; the code is told by the
surveyor, never guessed. Words 32, 33 and 81-83 beside 31 are the instrument's results: no second
observation. What stands behind a damaged station block is left out with it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import Face, FieldFile, KnownPoint, Pointing
from surveyapp.io.importers.fieldfiles.gathering import (
    ReadOptions,
    gathering,
)
from surveyapp.io.importers.fieldfiles.gsi_state import (
    MOST_LAYOUTS,
    State,
    check_heights,
    check_stations,
    doubt,
    follow_number,
    lose,
    occupy,
)
from surveyapp.io.importers.fieldfiles.gsi_words import (
    Word,
    WordError,
    block_width,
    blocks,
    cut_layouts,
    lacking,
    last_opening,
    layout,
    words,
)
from surveyapp.io.importers.fieldfiles.lines import FieldText, look_through
from surveyapp.languages import joined, said

_READINGS: Final = ("21", "22", "31", "32")
_STATION: Final = frozenset({"84", "85", "86", "88"})
_USED: Final = frozenset(
    {"11", "16", "19", "21", "22", "31", "32", "41", "42", "43", "51", "58", "59", "71"}
    | {str(i) for i in range(71, 80)}
    | {str(i) for i in range(81, 89)}
)
_REMARKS: Final = frozenset(str(i) for i in range(71, 80))
_TWO_PI: Final = 2.0 * math.pi
_SHOWN: Final = 6


def read_gsi(path: Path, options: ReadOptions) -> FieldFile:
    """Read a GSI file.

    Parameters
    ----------
    path : Path
    options : ReadOptions
        ``station_code`` for convention 2.

    Returns
    -------
    FieldFile

    Raises
    ------
    SurveyError
        Every damaged line; no station in either convention (codes are listed).
    """
    if options.station_code is not None:  # blocks pad codes with zeros
        options = replace(options, station_code=options.station_code.lstrip("0") or "0")
    text = look_through(path)
    state = _passed(text, State(gathering(path, options)))
    cut = cut_layouts(state.layouts, state.last)
    if cut:
        state.gathered.pointings.clear()
        state = _passed(text, State(gathering(path, options), cut=cut))
    if text.encoding == "latin-1":
        state.gathered.warn("code_page", "names that are no ASCII were read as Latin-1")
    check_stations(state)
    check_heights(state)
    if state.gaps:
        places = ", ".join(str(line) for line in state.gaps[:_SHOWN])
        told = said(
            "the running block numbers leap {size} times (line {places}): were "
            "blocks deleted? If one named a station, what follows stands on the "
            "wrong one",
            size=len(state.gaps),
            places=places,
        )
        state.gathered.warn("block_numbers", told)
    _tell_unlike(state)
    widths = "/".join(str(width) for width in sorted(state.widths))
    names = " and ".join(sorted(state.conventions))
    return state.gathered.finish(form=("gsi", f"GSI-{widths}, {names}"), applied=(True, True))


def _tell_unlike(state: State) -> None:
    """Blocks without a word that all others have: cut in the middle, or another mask."""
    found = sorted(
        (state.first_of[kind], words)
        for kind, words in lacking(state.layouts)
        if kind not in state.cut
    )
    if found:
        places = joined(
            "; ",
            [
                said("line {line} without {words}", line=line, words=", ".join(words))
                for line, words in found[:_SHOWN]
            ],
        )
        told = said(
            "blocks lack words that all others have ({places}): were they damaged?", places=places
        )
        state.gathered.warn("unlike_blocks", told)


def _passed(text: FieldText, state: State) -> State:
    """Go through the file; which layouts are cut ones is known only behind its end."""
    layouts = state.layouts
    for number, raw in state.gathered.lines(text, cut=last_opening):
        line = raw.strip("\x1a\t").lstrip()
        if not line or line.isspace():
            continue
        for block in blocks(line):
            kind = layout(block)
            if kind in layouts:
                layouts[kind] += 1
            elif len(layouts) < MOST_LAYOUTS:
                layouts[kind] = 1
                state.first_of[kind] = number
            state.last = kind
            _block(state, number, block, cut=kind in state.cut)
    return state


def _block(state: State, line: int, block: str, *, cut: bool) -> None:
    gathered = state.gathered
    try:
        found = words(block)
        if found[0].word_index not in ("11", "41"):
            raise WordError(
                said(
                    "the block does not begin with a word 11 or 41: {word_index}",
                    word_index=found[0].word_index,
                )
            )
        if cut:
            raise WordError(said("the line is cut short behind {size} words", size=len(found)))
    except WordError as error:
        gathered.damaged(
            line, error.args[0], block, "words of 8 or 16 characters, parted by blanks"
        )
        doubt(state, line, block)
        return
    if block.rstrip() == state.previous:
        gathered.skip(line, "duplicate", "the same block as the one before, number included")
        return
    state.previous = block.rstrip()
    follow_number(state, line, found[0])
    state.widths.add(block_width(block))
    try:
        _meaning(state, line, found)
    except WordError as error:
        gathered.damaged(line, error.args[0], block)
        if not any(word.word_index in _READINGS for word in found):
            lose(state, line)


def _meaning(state: State, line: int, found: list[Word]) -> None:
    by_index = {word.word_index: word for word in reversed(found)}
    if not by_index.keys() <= _USED:
        for index in by_index.keys() - _USED:
            state.gathered.ignore(f"word {index}")
    if found[0].word_index == "41":
        _code(state, line, by_index)
    elif _is_read(by_index):
        _pointing(state, line, by_index)
    elif _STATION & by_index.keys():
        _station(state, line, by_index)
    elif {"81", "82", "83"} & by_index.keys():
        state.gathered.point(_coordinates(state, line, by_index, "81"))
    elif len(found) == 1:
        raise WordError("the block holds a name and nothing else")
    else:
        state.gathered.ignore("block without a reading")


def _is_read(by_index: dict[str, Word]) -> bool:
    """Whether a block holds a reading."""
    return any(index in by_index and not by_index[index].empty for index in _READINGS)


def _length(state: State, word: Word | None) -> float | None:
    if word is None or word.empty:
        return None
    value, feet = word.length(state.gathered.foot.metres)
    state.gathered.feet = state.gathered.feet or feet
    return value


def _coordinates(state: State, line: int, found: dict[str, Word], first: str) -> KnownPoint:
    e, n, h = (_length(state, found.get(str(int(first) + i))) for i in range(3))
    if (e is None) != (n is None):
        e = n = None
    return KnownPoint(found["11"].name, e, n, h, line)


def _station(state: State, line: int, found: dict[str, Word]) -> None:
    name, hi = found["11"].name, _length(state, found.get("88"))
    point = _coordinates(state, line, found, "84")
    occupy(state, line, name, hi)
    state.conventions.add("station blocks")
    if not (point.e == point.n == 0.0 and not point.h):  # as delivered: nobody entered them
        state.gathered.point(point)


def _code(state: State, line: int, found: dict[str, Word]) -> None:
    code = found["41"].name
    if _torn_code(found["41"].data.strip(), state.gathered.options.station_code):
        raise WordError(said("word 41 is no code: {value}", value=found["41"].data.strip()))
    if code != state.gathered.options.station_code:
        if code in state.codes or len(state.codes) < MOST_LAYOUTS:
            state.codes[code] += 1
        state.gathered.ignore(f"code {code}")
        return
    if "42" not in found or found["42"].empty:
        raise WordError(said("code {code} names no station in word 42", code=code))
    hi = None
    if "43" in found and not found["43"].empty:
        hi = _code_height(found["43"])
    occupy(state, line, found["42"].name, hi)
    if "43" in found:
        state.heights += 1
    elif len(state.bare) < MOST_LAYOUTS:
        state.bare.append((line, str(state.setup)))
    state.conventions.add(f"code {code}")


def _torn_code(data: str, wanted: str | None) -> bool:
    """Whether a code is that of a station but for one character that no code has there."""
    if wanted is None or len(wanted) > len(data):
        return False
    whole = wanted.rjust(len(data), "0")
    strange = [(a, b) for a, b in zip(data, whole, strict=True) if a != b]
    padding = len(data) - len(wanted)
    return len(strange) == 1 and (
        not strange[0][0].isalnum() or data[: max(padding - 1, 0)] != "0" * max(padding - 1, 0)
    )


def _code_height(word: Word) -> float:
    """Instrument height of word 43 [m]; without a decimal point it is in mm."""
    text = word.data.lstrip()
    if "." in text and not text.endswith(" "):
        try:
            value = float(text)
        except ValueError:
            raise WordError(said("word 43 holds no height: {text}", text=text)) from None
        return -value if word.sign == "-" else value
    return word.integer() * 1e-3


def _reading(word: Word | None) -> float | None:
    if word is None or word.empty:
        return None
    value = word.angle()
    if not 0.0 <= value <= _TWO_PI + 1e-12:
        raise WordError(
            said(
                "word {word_index} is beyond the circle: {sign}{data}",
                word_index=word.word_index,
                sign=word.sign,
                data=word.data,
            )
        )
    return 0.0 if value >= _TWO_PI else value


def _distance(state: State, word: Word | None) -> float | None:
    value = _length(state, word)
    if value is not None and value < 0.0:
        raise WordError(said("a distance is negative: {value:g} m", value=value))
    return value or None


def _corrections(found: dict[str, Word]) -> tuple[float | None, float | None]:
    """Ppm and prism constant [m] of words 51, 58, 59."""
    ppm: float | None = None
    prism: float | None = None
    if "51" in found and not found["51"].empty:
        first, second = found["51"].pair()
        ppm, prism = float(first), second * 1e-3
    if "58" in found and not found["58"].empty:
        prism = found["58"].integer() * 1e-4
    if "59" in found and not found["59"].empty:
        ppm = found["59"].integer() * 1e-4
    return ppm, prism


def _note(found: dict[str, Word]) -> str:
    if _REMARKS.isdisjoint(found):
        return ""
    texts = [found[key].name for key in sorted(found) if key[:1] == "7" and not found[key].empty]
    return " ".join(text for text in texts if text != "0")


def _time(word: Word | None) -> str:
    digits = "" if word is None else word.data[-8:]
    if len(digits) != 8 or not digits.isdigit() or digits == "00000000":
        return ""
    return f"{digits[:2]}-{digits[2:4]}T{digits[4:6]}:{digits[6:]}"


def _pointing(state: State, line: int, found: dict[str, Word]) -> None:
    hz, v = _reading(found.get("21")), _reading(found.get("22"))
    v = v or None
    if any(found[index].sixty for index in ("21", "22") if index in found):
        state.gathered.carry(line)
    sd = _distance(state, found.get("31"))
    hd = None if "31" in found else _distance(state, found.get("32"))
    hi = _length(state, found.get("88"))
    ht = _length(state, found.get("87"))
    ppm, prism = _corrections(found)
    if "16" in found and not found["16"].empty and found["16"].name != state.station:
        occupy(state, line, found["16"].name, None)
        state.conventions.add("word 16")
    if state.station is None:
        if state.lost:
            state.gathered.dependent(line, state.lost)
        else:
            state.homeless.append(line)
        return
    to = found["11"].name
    if to == state.station:
        if state.gaps and state.gaps[-1] > state.occupied:  # a block is missing: that of a station
            lose(state, state.gaps[-1])
        raise WordError(said("point {to} is sighted from itself", to=to))
    face: Face = "" if v is None else "R" if v > math.pi else "L"
    pointing = Pointing(
        line=line,
        at=state.station,
        to=to,
        setup=str(state.setup),
        face=face,
        hz=hz,
        v=v,
        sd=sd,
        hd=hd,
        hi=state.hi if hi is None else hi,
        ht=ht,
        ppm=ppm,
        prism_m=prism,
        time=_time(found.get("19")),
        note=_note(found),
    )
    state.gathered.add(pointing)
