"""Trimble JobXML: the field book in its order to pointings.

Values are degrees, metres, hPa and Celsius whatever the display settings say. ``EDMDistance`` is
raw: the reduction adds prism constant and ppm, as Trimble's own style sheets do. Mean turned angles
and reductions are results; deleted records are left out and told.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import Face, FieldFile, KnownPoint, Pointing
from surveyapp.io.importers.fieldfiles.gathering import (
    Gathering,
    ReadOptions,
    gathering,
)
from surveyapp.io.importers.fieldfiles.jobxml_records import Record, read_records
from surveyapp.languages import said

_FACES: Final[dict[str, Face]] = {"Face1": "L", "Face2": "R", "FaceNull": "", "": ""}
_KNOWN_COORDINATES: Final = ("Coordinates", "KeyedIn", "Import", "Copied")


class RecordError(ValueError):
    """A record that cannot be read: what is wrong with it."""


@dataclass(frozen=True, slots=True)
class _Station:
    name: str
    hi: float | None
    setup: str
    atmosphere: str


@dataclass(frozen=True, slots=True)
class _Target:
    ht: float | None
    prism: float | None


@dataclass(frozen=True, slots=True)
class _Atmosphere:
    ppm: float | None = None
    temperature: float | None = None
    pressure: float | None = None


@dataclass(slots=True)
class _State:
    gathered: Gathering
    stations: dict[str, _Station] = field(default_factory=dict)
    targets: dict[str, _Target] = field(default_factory=dict)
    atmospheres: dict[str, _Atmosphere] = field(default_factory=dict)
    station: str = ""
    target: str = ""
    atmosphere: str = ""
    broken: dict[str, str] = field(default_factory=dict)
    setups: int = 0
    raw: int = 0
    without_ppm: int = 0
    without_prism: int = 0


def read_jobxml(path: Path, options: ReadOptions) -> FieldFile:
    """Read a JobXML file.

    Returns
    -------
    FieldFile

    Raises
    ------
    SurveyError
        Every damaged record with its line; entities, document types, a torn file.
    """
    state = _State(gathering(path, options))
    records = read_records(path, partial(_record, state), progress=options.progress)
    for kind, count in records.others.items():
        state.gathered.ignore(kind, count)
    if records.torn is not None:
        line, why = records.torn
        state.gathered.damaged(line, said("the XML is torn: {why}", why=why), f"line {line}")
    _tell_corrections(state)
    every_ppm = state.raw > 0 and not state.without_ppm
    every_prism = state.raw > 0 and not state.without_prism
    version = f"JobXML {records.version}".strip()
    return state.gathered.finish(
        form=("jobxml", version), applied=(every_ppm, every_prism), corrected=True
    )


def _record(state: _State, record: Record) -> None:
    action = _ACTIONS.get(record.kind)
    if action is None:
        state.gathered.ignore(record.kind)
        return
    try:
        action(state, record)
    except RecordError as error:
        state.gathered.damaged(record.line, error.args[0], record.kind)
        state.broken[record.attributes.get("ID", "")] = f"line {record.line}: {error}"


def _tell_corrections(state: _State) -> None:
    if state.raw:
        text = "distances are stored raw: prism constant and ppm of the file were added"
        state.gathered.warn("raw_distances", text)
    if state.without_ppm:
        text = said(
            "{without_ppm} distances have no ppm in the file: no atmosphere was applied",
            without_ppm=state.without_ppm,
        )
        state.gathered.warn("ppm_missing", text)
    if state.without_prism:
        text = said(
            "{without_prism} distances have no prism constant in the file: none was added",
            without_prism=state.without_prism,
        )
        state.gathered.warn("prism_missing", text)


def _number(record: Record, path: str) -> float | None:
    text = record.text(path)
    if not text or text == "?":
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise RecordError(said("{path} is no number: {text}", path=path, text=text[:40]))
    return value


def _deleted(record: Record) -> bool:
    text = record.text("Deleted").lower()
    if text not in ("", "true", "false"):
        raise RecordError(said("Deleted is neither true nor false: {text}", text=text[:40]))
    return text == "true"


def _station(state: _State, record: Record) -> None:
    identity = record.attributes.get("ID", "")
    state.setups += 1
    state.station = identity
    name = record.text("StationName")
    if not name:
        raise RecordError("a station has no name")
    atmosphere = record.text("AtmosphereID") or state.atmosphere
    hi = _number(record, "TheodoliteHeight")
    state.stations[identity] = _Station(name, hi, str(state.setups), atmosphere)


def _target(state: _State, record: Record) -> None:
    identity = record.attributes.get("ID", "")
    state.target = identity
    state.targets[identity] = _Target(
        _number(record, "TargetHeight"), _number(record, "PrismConstant")
    )


def _atmosphere(state: _State, record: Record) -> None:
    identity = record.attributes.get("ID", "")
    state.atmosphere = identity
    state.atmospheres[identity] = _Atmosphere(
        _number(record, "PPM"), _number(record, "Temperature"), _number(record, "Pressure")
    )


def _point(state: _State, record: Record) -> None:
    name, method = record.text("Name"), record.text("Method")
    if _deleted(record):
        text = f"deleted in the instrument: {name}"
        state.gathered.skip(record.line, "deleted", text)
        return
    if method in _KNOWN_COORDINATES and not record.text("Circle/HorizontalCircle"):
        if not name:
            raise RecordError("a point has no name")
        e, n, h = (_number(record, f"Grid/{axis}") for axis in ("East", "North", "Elevation"))
        if (e is None) != (n is None):
            raise RecordError("a point has only one plane coordinate")
        state.gathered.point(KnownPoint(name, e, n, h, record.line))
        return
    if method == "MeanTurnedAngle" or not any(path.startswith("Circle/") for path in record.texts):
        state.gathered.ignore(f"PointRecord {method or 'without readings'}")
        return
    _pointing(state, record, name)


def _owner(state: _State, record: Record) -> tuple[_Station, _Target] | None:
    """Station and target that a pointing names; None where one of them is damaged."""
    station_id = record.text("StationID") or state.station
    target_id = record.text("TargetID") or state.target
    for identity in (station_id, target_id):
        if identity and identity in state.broken:
            state.gathered.dependent(
                record.line, f"it needs the record of {state.broken[identity]}"
            )
            return None
    station = state.stations.get(station_id)
    if station is None:
        raise RecordError(
            said("there is no station record {station_id}", station_id=station_id or "before it")
        )
    if target_id and target_id not in state.targets:
        raise RecordError(said("there is no target record {target_id}", target_id=target_id))
    return station, state.targets.get(target_id, _Target(None, None))


def _circle(record: Record, path: str) -> float | None:
    value = _number(record, path)
    if value is None:
        return None
    if not 0.0 <= value <= 360.0:
        raise RecordError(
            said("{path} is beyond the circle: {value:g} degrees", path=path, value=value)
        )
    return math.radians(value % 360.0)


def _pointing(state: _State, record: Record, name: str) -> None:
    face = record.text("Circle/Face")
    if face not in _FACES:
        raise RecordError(said("the face is not known: {face}", face=face[:20]))
    hz, v = _circle(record, "Circle/HorizontalCircle"), _circle(record, "Circle/VerticalCircle")
    sd = _number(record, "Circle/EDMDistance")
    if not name:
        raise RecordError("a point has no name")
    if hz is None and v is None:
        raise RecordError("a pointing has neither a circle nor a vertical reading")
    if sd is not None and sd < 0.0:
        raise RecordError(said("a distance is negative: {sd:g}", sd=sd))
    owner = _owner(state, record)
    if owner is None:
        return
    station, target = owner
    if name == station.name:
        raise RecordError(said("point {name} is sighted from itself", name=name))
    air = state.atmospheres.get(station.atmosphere, _Atmosphere())
    if sd:
        state.raw += 1
        state.without_ppm += air.ppm is None
        state.without_prism += target.prism is None
    state.gathered.add(
        Pointing(
            line=record.line,
            at=station.name,
            to=name,
            setup=station.setup,
            face=_FACES[face] or _face_of(v),
            hz=hz,
            v=v or None,
            sd=sd or None,
            hd=None,
            hi=station.hi,
            ht=target.ht,
            ppm=air.ppm,
            prism_m=target.prism,
            temperature_c=air.temperature,
            pressure_hpa=air.pressure,
            time=record.attributes.get("TimeStamp", ""),
            code=record.text("Code"),
        )
    )


def _face_of(v: float | None) -> Face:
    if v is None:
        return ""
    return "R" if v > math.pi else "L"


_ACTIONS: Final[dict[str, Callable[[_State, Record], None]]] = {
    "PointRecord": _point,
    "StationRecord": _station,
    "TargetRecord": _target,
    "AtmosphereRecord": _atmosphere,
}
