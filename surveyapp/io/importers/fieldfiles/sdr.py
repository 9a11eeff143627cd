"""Sokkia SDR33 and SDR20 field books: fixed columns of bytes to pointings.

The header says units, names and values are as wide as the version demands, the target height holds
until the next one. Mean readings (09MC) are kept only where a sight has no face readings.

Sources: Nikon and Spectra Precision manuals, SDR record formats; MicroSurvey, SDR format.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import Face, FieldFile, KnownPoint, Pointing
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.importers.fieldfiles.gathering import (
    Gathering,
    ReadOptions,
    gathering,
)
from surveyapp.io.importers.fieldfiles.lines import FieldText, look_through
from surveyapp.io.importers.fieldfiles.units import DEGREE, GON, MIL

_ANGLES: Final = {"1": DEGREE, "2": GON, "4": MIL}
_LENGTHS: Final = {"1": 1.0, "2": None}
_ORDERS: Final = {"1": "NEZ", "2": "ENZ"}
_FACES: Final[dict[str, Face]] = {"F1": "L", "F2": "R"}
_FRAME: Final = "\x02\x03\x1a\x00"
_MARK: Final = "\xef\xbb\xbf"
_LAYOUT: Final = {"02": 5, "08": 4, "03": 1, "09": 3}
"""Values behind the names of a record, its text not counted."""
_TWO_PI: Final = 2.0 * math.pi
_SHOWN: Final = 6


class RecordError(ValueError):
    """A record that cannot be read: what is wrong with it."""


@dataclass(slots=True)
class _State:
    """Units of the header and what holds until it is changed."""

    gathered: Gathering
    widths: tuple[int, int] = (0, 0)
    version: str = ""
    angle: float = DEGREE
    length: float | None = 1.0
    order: str = "NEZ"
    horizon: bool = False
    station: str | None = None
    hi: float | None = None
    setup: int = 0
    lost: str = ""
    ht: float | None = None
    ht_lost: str = ""
    prism: float | None = None
    applied: bool | None = None
    time: str = ""
    padded: frozenset[str] = frozenset()
    decimals: dict[str, int] = field(default_factory=dict)
    opened: str = ""
    faces: set[str] = field(default_factory=set)
    means: list[Pointing] = field(default_factory=list)
    mean_only: list[str] = field(default_factory=list)


def read_sdr(path: Path, options: ReadOptions) -> FieldFile:
    """Read an SDR33 or SDR20 file.

    Returns
    -------
    FieldFile

    Raises
    ------
    SurveyError
        Every damaged line; a file without a header 00, or with units that are not known.
    """
    text = look_through(path, single_byte=True)
    state = _State(gathering(path, options))
    _begin(state, text)
    for number, line in state.gathered.lines(text):
        record = _bare(line)
        if record.strip():
            _record(state, number, record)
    if text.encoding != "ascii":
        state.gathered.warn("code_page", "names that are no ASCII were read as Latin-1")
    _keep_means(state)
    _tell_means(state)
    if state.applied is None:
        told = (
            "no note says whether the prism constant is in the distances: enter it in [[traverse]]"
        )
        state.gathered.warn("constant_unknown", told)
    state.gathered.warn(
        "atmosphere_unknown",
        "SDR files do not say whether distances hold the atmospheric correction: enter "
        "atmosphere_applied in [[traverse]]",
    )
    return state.gathered.finish(form=("sdr", state.version), applied=(None, state.applied))


def _bare(line: str) -> str:
    """A line without what frames a transmission, or marks a text as UTF-8."""
    return line.removeprefix(_MARK).strip(_FRAME)


def _begin(state: _State, text: FieldText) -> None:
    """Version from the header; how complete lines look, so that a cut one is found."""
    header = next((line for _, raw in text.lines() if (line := _bare(raw))[:2] == "00"), "")
    version = header[4:20].upper()
    if version.startswith("SDR33"):
        state.widths, state.version = (16, 16), "SDR33"
    elif version.startswith("SDR2"):
        state.widths, state.version = (4, 10), "SDR20"
    else:
        raise SurveyError(
            Problem(
                "the file has no header of SDR33 or SDR20",
                state.gathered.name,
                header.strip()[:40] or "no record 00",
                "a record 00 with the version SDR33 or SDR20",
            )
        )
    full: set[str] = set()
    places: dict[str, Counter[int]] = {}
    for _, raw in text.lines():
        line = _bare(raw)
        kind = line[:2]
        if kind not in _LAYOUT:
            continue
        if len(line) >= _full_length(state, kind):
            full.add(kind)
        tail = line.rstrip().rpartition(".")
        if tail[1] and tail[2].isdigit():
            places.setdefault(kind, Counter())[len(tail[2])] += 1
    state.padded = frozenset(full)
    state.decimals = {kind: count.most_common(1)[0][0] for kind, count in places.items()}


def _full_length(state: _State, kind: str) -> int:
    """Bytes of a record up to the end of its last value."""
    name, value = state.widths
    names = {"02": 1, "08": 1, "03": 0, "09": 2}[kind]
    values = {"02": 4, "08": 3, "03": 1, "09": 3}[kind]
    return 4 + names * name + values * value


def _record(state: _State, number: int, line: str) -> None:
    kind, origin = line[:2], line[2:4]
    actions = {"00": _header, "01": _instrument, "02": _station, "03": _target_height}
    actions |= {"08": _point, "09": _observation, "12": _set, "13": _note}
    if not (kind.isdigit() and len(line) >= 4):
        state.gathered.damaged(number, "this is no record", line, "two digits, two letters, fields")
        return
    action = actions.get(kind)
    if action is None:
        if kind not in ("06", "10", "07"):
            state.gathered.ignore(f"record {kind}{origin.strip()}")
        return
    try:
        if kind in _LAYOUT:
            _check_whole(state, kind, line)
        action(state, number, line)
    except RecordError as error:
        state.gathered.damaged(number, str(error), line)
        if kind == "02":
            state.station, state.hi = None, None
            state.lost = f"the station record of line {number} cannot be read"
        elif kind == "03":
            state.ht, state.ht_lost = None, f"the target height of line {number} cannot be read"


def _check_whole(state: _State, kind: str, line: str) -> None:
    """A line that others of its kind are longer than, or with fewer decimals, was cut."""
    if len(line) >= _full_length(state, kind):
        return
    if kind in state.padded:
        raise RecordError(f"the record {kind} is cut short")
    tail = line.rstrip().rpartition(".")[2]
    if tail.isdigit() and kind in state.decimals and len(tail) < state.decimals[kind]:
        raise RecordError(f"the last value of record {kind} is cut short")


def _names(state: _State, line: str, count: int) -> list[str]:
    width = state.widths[0]
    return [line[4 + i * width : 4 + (i + 1) * width].strip() for i in range(count)]


def _value(state: _State, line: str, names: int, place: int, what: str) -> float | None:
    name, width = state.widths
    start = 4 + names * name + place * width
    text = line[start : start + width].strip()
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        raise RecordError(f"{what} is no number: {text}") from None
    if not math.isfinite(value):
        raise RecordError(f"{what} is no number: {text}")
    return value


def _metres(state: _State, value: float | None) -> float | None:
    return None if value is None else value * state.gathered.length(state.length)


def _header(state: _State, number: int, line: str) -> None:
    digits = line[40:45].ljust(5)
    tables = (("angles", digits[0], _ANGLES), ("lengths", digits[1], _LENGTHS))
    for what, digit, known in tables:
        if digit not in known:
            raise SurveyError(
                Problem(
                    f"the header names no unit of {what}",
                    f"{state.gathered.name}, line {number}",
                    digit.strip() or "nothing",
                    ", ".join(known),
                )
            )
    if digits[4] not in _ORDERS:
        raise SurveyError(
            Problem(
                "the header names no order of coordinates",
                f"{state.gathered.name}, line {number}",
                digits[4].strip() or "nothing",
                "1 (north, east) or 2 (east, north) in column 45",
            )
        )
    state.angle, state.length = _ANGLES[digits[0]], _LENGTHS[digits[1]]
    state.order = _ORDERS[digits[4]]


def _instrument(state: _State, number: int, line: str) -> None:
    state.horizon = line[50:51] == "2"


def _known_point(state: _State, number: int, line: str) -> KnownPoint:
    name = _names(state, line, 1)[0]
    if not name:
        raise RecordError("a point has no name")
    first, second, height = (
        _metres(state, _value(state, line, 1, i, what))
        for i, what in enumerate(("a coordinate", "a coordinate", "a height"))
    )
    n, e = (first, second) if state.order == "NEZ" else (second, first)
    return KnownPoint(name, e, n, height, number)


def _station(state: _State, number: int, line: str) -> None:
    point = _known_point(state, number, line)
    hi = _metres(state, _value(state, line, 1, 3, "the instrument height"))
    state.setup += 1
    state.station, state.hi, state.lost = point.name, hi, ""
    if not (point.e == point.n == 0.0 and not point.h):
        state.gathered.point(point)


def _target_height(state: _State, number: int, line: str) -> None:
    value = _value(state, line, 0, 0, "the target height")
    if value is None:
        raise RecordError("the target height is missing")
    state.ht, state.ht_lost = _metres(state, value), ""


def _point(state: _State, number: int, line: str) -> None:
    if line[2:4] in ("KI", "TP", "  ", "NM"):
        state.gathered.point(_known_point(state, number, line))
    else:
        state.gathered.ignore(f"record 08{line[2:4].strip()}")


def _set(state: _State, number: int, line: str) -> None:
    state.gathered.ignore("record 12")


def _note(state: _State, number: int, line: str) -> None:
    origin, text = line[2:4], line[4:].strip()
    if origin == "PC":
        state.applied = "applied" in text.lower()
        tail = text.rpartition(":")[2].strip()
        try:
            state.prism = float(tail) * 1e-3
        except ValueError:
            state.prism = None
    elif origin == "TS":
        state.time = text
    else:
        state.gathered.ignore(f"note 13{origin.strip()}")


def _circle(state: _State, value: float | None, what: str) -> float | None:
    if value is None:
        return None
    reading = value * state.angle
    if not -1e-9 <= reading <= _TWO_PI + 1e-9:
        raise RecordError(f"{what} is beyond the circle: {value:g}")
    return 0.0 if reading >= _TWO_PI else max(reading, 0.0)


def _zenith(state: _State, value: float | None) -> float | None:
    if value is None:
        return None
    if state.horizon:
        return math.fmod(0.5 * math.pi - value * state.angle + 2.0 * _TWO_PI, _TWO_PI)
    return _circle(state, value, "the vertical reading") or None


def _observation(state: _State, number: int, line: str) -> None:
    origin = line[2:4]
    if origin not in ("F1", "F2", "MC"):
        state.gathered.ignore(f"record 09{origin.strip()}")
        return
    at, to = _names(state, line, 2)
    if not at or not to or at == to:
        raise RecordError(f"a sight needs a station and another point: {at!r} to {to!r}")
    sd, v, hz = (
        _value(state, line, 2, i, what)
        for i, what in enumerate(("the distance", "the vertical reading", "the circle reading"))
    )
    if hz is None and v is None:
        raise RecordError("the sight has neither a circle nor a vertical reading")
    if sd is not None and sd < 0.0:
        raise RecordError(f"a distance is negative: {sd:g}")
    horizontal, zenith = _circle(state, hz, "the circle reading"), _zenith(state, v)
    if state.station is None and state.lost:
        state.gathered.dependent(number, state.lost)
        return
    if state.ht_lost:
        state.gathered.dependent(number, state.ht_lost)
        return
    if at != state.station:
        if state.station is not None:
            text = f"line {number} names station {at}, the record before it {state.station}"
            state.gathered.warn("station_differs", text)
        state.setup += 1
        state.station, state.hi = at, None
    name, width = state.widths
    pointing = Pointing(
        line=number,
        at=at,
        to=to,
        setup=str(state.setup),
        face=_FACES.get(origin, ""),
        hz=horizontal,
        v=zenith,
        sd=_metres(state, sd) or None,
        hd=None,
        hi=state.hi,
        ht=state.ht,
        prism_m=state.prism,
        time=state.time,
        code=line[4 + 2 * name + 3 * width :].strip(),
    )
    if pointing.setup != state.opened:
        _keep_means(state)
        state.opened = pointing.setup
    if origin == "MC":
        state.means.append(pointing)
    else:
        state.faces.add(pointing.to)
        state.gathered.add(pointing)


def _keep_means(state: _State) -> None:
    """Mean readings of a set-up count only for sights of which it has no face readings."""
    kept = [p for p in state.means if p.to not in state.faces]
    left = len(state.means) - len(kept)
    if left:
        state.gathered.ignore("record 09MC beside face readings", left)
    for pointing in kept:
        state.mean_only.append(f"{pointing.at}-{pointing.to} (line {pointing.line})")
        state.gathered.add(pointing)
    del state.mean_only[_SHOWN:]
    state.means.clear()
    state.faces.clear()


def _tell_means(state: _State) -> None:
    if state.mean_only:
        text = (
            f"only the mean of a sight is stored, its faces are gone: {', '.join(state.mean_only)}"
        )
        state.gathered.warn("mean_only", text)
        state.gathered.pointings.sort(key=lambda p: p.line)
