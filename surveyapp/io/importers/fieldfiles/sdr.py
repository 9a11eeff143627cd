"""Sokkia SDR33 and SDR20 field books: fixed columns of bytes to pointings.

The header says units, names and values are as wide as the version demands, the target height holds
until the next one. Mean readings (09MC) are kept only where a sight has no face readings.

Sources: Nikon and Spectra Precision manuals, SDR record formats; MicroSurvey, SDR format.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import Face, FieldFile, KnownPoint, Pointing
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.importers.fieldfiles.gathering import (
    ReadOptions,
    gathering,
)
from surveyapp.io.importers.fieldfiles.lines import look_through
from surveyapp.io.importers.fieldfiles.sdr_layout import (
    KINDS,
    RecordError,
    header_digits,
    may_have_been,
    shape_of,
)
from surveyapp.io.importers.fieldfiles.sdr_state import (
    State,
    blanked,
    constant_applied,
    lose,
    swallowed,
)
from surveyapp.io.importers.fieldfiles.units import DEGREE, GON, MIL
from surveyapp.languages import said

_ANGLES: Final = {"1": DEGREE, "2": GON, "4": MIL}
_LENGTHS: Final = {"1": 1.0, "2": None}
_ORDERS: Final = {"1": "NEZ", "2": "ENZ"}
_FACES: Final[dict[str, Face]] = {"F1": "L", "F2": "R"}
_FRAME: Final = "\x02\x03\x1a\x00"
_MARK: Final = "\xef\xbb\xbf"
_TWO_PI: Final = 2.0 * math.pi
_SHOWN: Final = 6
_LEAST_RECORD: Final = 4
_NEGATIVE: Final = 3
"""So many negative zenith angles are no damage but a convention that record 01 does not tell."""


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
    shape = shape_of((_bare(line) for _, line in text.lines()), path.name)
    state = State(gathering(path, options), shape)
    blank = 0
    for number, line in state.gathered.lines(text):
        record = _bare(line)
        if not record.strip():
            blank = number if len(record) >= _LEAST_RECORD else blank
            continue
        if blank:
            blanked(state, blank)
            blank = 0
        _record(state, number, record)
    if text.encoding != "ascii":
        state.gathered.warn("code_page", "names that are no ASCII were read as Latin-1")
    _keep_means(state)
    _tell_places(state)
    if len(state.negative) >= _NEGATIVE:
        raise SurveyError(_from_horizon(state))
    applied = constant_applied(state)
    state.gathered.warn(
        "atmosphere_unknown",
        "SDR files do not say whether distances hold the atmospheric correction: enter "
        "atmosphere_applied in [[traverse]]",
    )
    return state.gathered.finish(form=("sdr", shape.version), applied=(None, applied))


def _from_horizon(state: State) -> Problem:
    lines = ", ".join(str(line) for line in state.negative[:_SHOWN])
    return Problem(
        "vertical readings are negative, and zenith angles never are",
        said("{name}, lines {lines}", name=state.gathered.name, lines=lines),
        "no record 01 that says so",
        "a 2 in column 51 of record 01 for angles from the horizon",
        "Is the record 01 damaged?",
    )


def _bare(line: str) -> str:
    """A line without what frames a transmission, or marks a text as UTF-8."""
    return line.removeprefix(_MARK).strip(_FRAME)


def _record(state: State, number: int, line: str) -> None:
    kind = line[:2]
    actions = {"00": _header, "01": _instrument, "02": _station, "03": _target_height}
    actions |= {"08": _point, "09": _observation, "12": _set, "13": _note}
    if not (kind.isdigit() and len(line) >= 4):
        state.gathered.damaged(number, "this is no record", line, "two digits, two letters, fields")
        kinds = may_have_been(line)
        lose(state, number, kinds or frozenset(("01", "03")))
        state.doubt = 0 if kinds else number
        return
    action = actions.get(kind, _other)
    try:
        if kind in KINDS:
            state.shape.check(kind, line)
        elif kind == "07" and len(line.rstrip()) > state.shape.full(kind):
            raise RecordError("the record 07 is too long")
        elif line[:4] != "13NM":
            state.shape.alone(kind, line)
        action(state, number, line)
    except RecordError as error:
        state.gathered.damaged(number, error.args[0], line)
        taken = swallowed(state, line, kind) if kind in (*KINDS, "07") else frozenset()
        lose(state, number, may_have_been(line) | {kind} | taken)
        state.doubt = number if taken else state.doubt


def _other(state: State, number: int, line: str) -> None:
    if line[:2] not in ("06", "10", "07"):
        state.gathered.ignore(f"record {line[:4].strip()}")


def _metres(state: State, value: float | None) -> float | None:
    return None if value is None else value * state.gathered.length(state.length)


def _header(state: State, number: int, line: str) -> None:
    digits = header_digits(line).ljust(5)
    tables = (("angles", digits[0], _ANGLES), ("lengths", digits[1], _LENGTHS))
    for what, digit, known in tables:
        if digit not in known:
            raise SurveyError(
                Problem(
                    said("the header names no unit of {what}", what=what),
                    said("{name}, line {number}", name=state.gathered.name, number=number),
                    digit.strip() or "nothing",
                    ", ".join(known),
                )
            )
    if digits[4] not in _ORDERS:
        raise SurveyError(
            Problem(
                "the header names no order of coordinates",
                said("{name}, line {number}", name=state.gathered.name, number=number),
                digits[4].strip() or "nothing",
                "1 (north, east) or 2 (east, north) in column 45",
            )
        )
    state.angle, state.length = _ANGLES[digits[0]], _LENGTHS[digits[1]]
    state.order = _ORDERS[digits[4]]


def _instrument(state: State, number: int, line: str) -> None:
    state.horizon = line[50:51] == "2"


def _known_point(state: State, number: int, line: str) -> KnownPoint:
    name = state.shape.names(line, 1)[0]
    if not name:
        raise RecordError("a point has no name")
    first, second, height = (
        _metres(state, state.shape.number(line, line[:2], i, what))
        for i, what in enumerate(("a coordinate", "a coordinate", "a height"))
    )
    n, e = (first, second) if state.order == "NEZ" else (second, first)
    return KnownPoint(name, e, n, height, number)


def _station(state: State, number: int, line: str) -> None:
    point = _known_point(state, number, line)
    hi = _metres(state, state.shape.number(line, "02", 3, "the instrument height"))
    state.setup += 1
    state.station, state.hi, state.lost, state.doubt = point.name, hi, "", 0
    if not (point.e == point.n == 0.0 and not point.h):
        state.gathered.point(point)


def _target_height(state: State, number: int, line: str) -> None:
    value = state.shape.number(line, "03", 0, "the target height")
    if value is None:
        raise RecordError("the target height is missing")
    state.ht, state.ht_lost = _metres(state, value), ""


def _point(state: State, number: int, line: str) -> None:
    if line[2:4] in ("KI", "TP", "  ", "NM"):
        state.gathered.point(_known_point(state, number, line))
    else:
        state.gathered.ignore(f"record 08{line[2:4].strip()}")


def _set(state: State, number: int, line: str) -> None:
    state.gathered.ignore("record 12")


def _note(state: State, number: int, line: str) -> None:
    origin, text = line[2:4], line[4:].strip()
    if origin == "PC":
        state.applied = "applied" in text.lower() and "not applied" not in text.lower()
        _, sign, tail = text.rpartition(":")
        try:
            state.prism = float(tail) * 1e-3 if sign else None
        except ValueError:
            text = said("the prism constant is no number: {value}", value=tail.strip())
            raise RecordError(text) from None
    elif origin == "TS":
        state.time = text
    else:
        state.gathered.ignore(f"note 13{origin.strip()}")


def _circle(state: State, value: float | None, what: str) -> float | None:
    if value is None:
        return None
    reading = value * state.angle
    if not -1e-9 <= reading <= _TWO_PI + 1e-9:
        raise RecordError(said("{what} is beyond the circle: {value:g}", what=what, value=value))
    return 0.0 if reading >= _TWO_PI else max(reading, 0.0)


def _zenith(state: State, number: int, value: float | None) -> float | None:
    if value is None:
        return None
    if state.horizon:
        return math.fmod(0.5 * math.pi - value * state.angle + 2.0 * _TWO_PI, _TWO_PI)
    if value < 0.0:
        state.negative.append(number)
    return _circle(state, value, "the vertical reading") or None


def _observation(state: State, number: int, line: str) -> None:
    origin = line[2:4]
    if origin not in ("F1", "F2", "MC"):
        if origin[0] == "F" or origin[1] in "12" or not origin.strip():
            raise RecordError(said("the record 09 has no face: {origin!r}", origin=origin))
        state.gathered.ignore(f"record 09{origin.strip()}")
        return
    at, to = state.shape.names(line, 2)
    if not at or not to or at == to:
        text = said("a sight needs a station and another point: {at!r} to {to!r}", at=at, to=to)
        raise RecordError(text)
    sd, v, hz = (
        state.shape.number(line, "09", i, what)
        for i, what in enumerate(("the distance", "the vertical reading", "the circle reading"))
    )
    if hz is None:
        raise RecordError("the sight has no circle reading")
    if sd is not None and sd < 0.0:
        raise RecordError(said("a distance is negative: {sd:g}", sd=sd))
    horizontal, zenith = _circle(state, hz, "the circle reading"), _zenith(state, number, v)
    state.begun = True
    lost = (state.lost if state.station is None else "") or state.ht_lost or state.circle_lost
    if lost:
        state.gathered.dependent(number, lost)
        return
    if at != state.station and not _stands(state, number, at):
        return
    raw = state.applied is False and state.prism is not None
    if sd:
        state.said.add(state.applied or (False if raw else None))
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
        code=line[state.shape.full("09") :].strip(),
        raw=raw,
    )
    _keep(state, pointing, mean=origin == "MC")


def _stands(state: State, number: int, at: str) -> bool:
    """Take a station that a sight names and no record before it; whether that can be done."""
    if state.doubt:
        lose(state, state.doubt, frozenset(("02",)))
        state.gathered.dependent(number, state.lost)
        return False
    if state.station is not None:
        if state.shape.stations[at] == 1:
            text = said("station {at} has no record: {now} is occupied", at=at, now=state.station)
            raise RecordError(text)
        state.differs.append(f"line {number} names {at}, the record before it {state.station}")
        del state.differs[_SHOWN:]
    state.setup += 1
    state.station, state.hi = at, None
    return True


def _keep(state: State, pointing: Pointing, *, mean: bool) -> None:
    if pointing.setup != state.opened:
        _keep_means(state)
        state.opened = pointing.setup
    if mean:
        state.means.append(pointing)
    else:
        state.faces.add(pointing.to)
        state.gathered.add(pointing)


def _keep_means(state: State) -> None:
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


def _tell_places(state: State) -> None:
    if state.differs:
        state.gathered.warn("station_differs", "; ".join(state.differs))
    if state.mean_only:
        text = said(
            "only the mean of a sight is stored, its faces are gone: {names}",
            names=", ".join(state.mean_only),
        )
        state.gathered.warn("mean_only", text)
        state.gathered.pointings.sort(key=lambda p: p.line)
