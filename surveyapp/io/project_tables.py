"""The tables of project.toml, one function each: stations, instruments, sessions.

Each returns a domain object in any case; what is wrong is noted in the table's findings, and the
reader of the project raises before anybody sees the object.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, cast

from surveyapp.domain.constant_choice import CHOICES, FORMS, LINE, ConstantChoice, word_of
from surveyapp.domain.instrument import Instrument, InstrumentCard
from surveyapp.domain.project import (
    DEFAULT_DEFLECTION_SIGMA,
    Centring,
    Deflection,
    Eccentric,
    Method,
    OrientationSession,
    Purpose,
    Station,
)
from surveyapp.domain.readings import FieldBook
from surveyapp.domain.station_line import meanings
from surveyapp.errors import Problem, nearest_names
from surveyapp.io.adopted_effects import read_effect
from surveyapp.io.cards import CARD_KEYS, load_card
from surveyapp.io.files import shown
from surveyapp.io.findings import Findings
from surveyapp.io.grid_tables import read_convergence
from surveyapp.io.tables import Table
from surveyapp.languages import either, said
from surveyapp_models.angles import ARCSEC, AngleUnit

METHODS: Final = ("tracking", "amplitude", "transit", "automatic")
PURPOSES: Final = ("calibration", "survey")

_GRID_LIMIT_M: Final = 1e8
_HEIGHT_LIMITS_M: Final = (-12000.0, 12000.0)


@dataclass(frozen=True, slots=True)
class Names:
    """What sessions may refer to.

    Parameters
    ----------
    stations, instruments : tuple of str
    known_constants : frozenset of str
        Instruments with a constant known beforehand.
    unit : AngleUnit
        The project's unit of angles.
    """

    stations: tuple[str, ...]
    instruments: tuple[str, ...]
    known_constants: frozenset[str]
    unit: AngleUnit

    def check_station(self, table: Table, name: str | None, what: str) -> None:
        """Note a problem for a name that is no declared station."""
        if name and name not in self.stations:
            table.problem(what, name, "a name of a [[station]]", nearest_names(name, self.stations))

    def check_targets(self, table: Table, book: FieldBook, path: str) -> None:
        """Every target in a book is a station."""
        seen: set[str] = set()
        for row in book.rows:
            if row.target and row.target not in self.stations and row.target not in seen:
                seen.add(row.target)
                table.findings.problems.append(
                    Problem(
                        "a sight whose target is no station",
                        said(
                            "{path}, line {line} (seq {seq})", path=path, line=row.line, seq=row.seq
                        ),
                        shown(row.target),
                        "a name of a [[station]]",
                        nearest_names(row.target, self.stations),
                    )
                )

    def read_choice(self, table: Table, instrument: str) -> ConstantChoice | None:
        """The constant choice of a table: a known word, or a line between two stations."""
        text = table.text("constant_choice")
        if not text:
            return None
        if text == "known" and instrument not in self.known_constants:
            table.problem(
                "constant_choice is known, but the instrument has no constant",
                text,
                "constant = { arcsec = ..., sigma_arcsec = ... } in [[instrument]]",
            )
        choice = word_of(text)
        if choice is None and not text.startswith(LINE):
            table.problem("constant_choice is not known", text, FORMS, nearest_names(text, CHOICES))
        elif choice is None:
            choice = self._named_line(table, text)
        return choice

    def _named_line(self, table: Table, text: str) -> ConstantChoice | None:
        name = text.removeprefix(LINE)
        found = meanings(name, self.stations)
        if len(found) == 1:
            return ConstantChoice("line", line=found[0])
        if found:
            table.problem(
                "constant_choice means several lines",
                text,
                either(f"{LINE}{line.unmistakable}" for line in found),
                "Write the station and the target with a comma between them.",
            )
        else:
            hint = nearest_names(name.partition("-")[0], self.stations)
            table.problem("constant_choice names no line between stations", text, FORMS, hint)
        return None


def unique(names: Sequence[str], kind: str, findings: Findings) -> tuple[str, ...]:
    """Note a problem for every name that stands twice; return the names once each."""
    counts = Counter(names)
    for name in sorted(n for n, count in counts.items() if n and count > 1):
        problem = Problem(
            said(
                "there are {counts} tables [[{kind}]] of one name", counts=counts[name], kind=kind
            ),
            "project.toml",
            shown(name),
            "each name once",
        )
        findings.problems.append(problem)
    return tuple(dict.fromkeys(n for n in names if n))


def read_station(table: Table, unit: AngleUnit) -> Station:
    """One [[station]]: positions as e/n, y_west/x_south or lat/lon, all optional."""
    name = table.text("name", required=True) or ""
    e, n = _pair(table, ("e", "n"), (_GRID_LIMIT_M, _GRID_LIMIT_M))
    west, south = _pair(table, ("y_west", "x_south"), (_GRID_LIMIT_M, _GRID_LIMIT_M))
    latitude, longitude = _pair(table, ("lat", "lon"), (90.0, 180.0))
    given = [
        keys
        for keys in (("e", "n"), ("y_west", "x_south"), ("lat", "lon"))
        if any(key in table for key in keys)
    ]
    if len(given) > 1:
        found = " and ".join("/".join(keys) for keys in given)
        table.problem("the position is given twice", found, "e/n, or y_west/x_south, or lat/lon")
    if west is not None and south is not None:
        e, n = -west, -south
    station = Station(
        name=name,
        e=e,
        n=n,
        latitude=None if latitude is None else math.radians(latitude),
        longitude=None if longitude is None else math.radians(longitude),
        h=table.number("h", low=_HEIGHT_LIMITS_M[0], high=_HEIGHT_LIMITS_M[1]),
        fixed=table.boolean("fixed"),
        deflection=_deflection(table),
        sigma_m=table.number("sigma_m", low=0.0, high=1e3),
        convergence=read_convergence(table, unit),
        planned=table.boolean("planned"),
    )
    table.get("note")
    table.warn_unknown()
    return station


def _pair(
    table: Table, keys: tuple[str, str], limits: tuple[float, float]
) -> tuple[float | None, float | None]:
    values = [
        table.number(key, low=-limit, high=limit) for key, limit in zip(keys, limits, strict=True)
    ]
    if (keys[0] in table) != (keys[1] in table):
        given, absent = keys if keys[0] in table else keys[::-1]
        table.problem(
            said("{given} stands without {absent}", given=given, absent=absent), "", "both or none"
        )
    return values[0], values[1]


def _deflection(station: Table) -> Deflection:
    table = station.table("deflection")
    if table is None:
        return Deflection()
    xi, eta = _pair(table, ("xi_arcsec", "eta_arcsec"), (300.0, 300.0))
    sigma = table.number("sigma_arcsec", low=0.0, high=300.0)
    table.warn_unknown()
    return Deflection(
        xi=(xi or 0.0) * ARCSEC,
        eta=(eta or 0.0) * ARCSEC,
        sigma=DEFAULT_DEFLECTION_SIGMA if sigma is None else sigma * ARCSEC,
        known=xi is not None,
    )


def read_centring(table: Table) -> Centring | None:
    """``centring_mm = { instrument, target }`` of the project or of a session."""
    inner = table.table("centring_mm")
    if inner is None:
        return None
    default = Centring()
    values = [inner.number(key, low=0.0, high=1e4) for key in ("instrument", "target")]
    inner.warn_unknown()
    return Centring(
        instrument_m=default.instrument_m if values[0] is None else values[0] / 1000.0,
        target_m=default.target_m if values[1] is None else values[1] / 1000.0,
        known=True,
    )


def read_instrument(table: Table, folder: Path) -> Instrument:
    """One [[instrument]]: its card with what the project overrides, still without its choice."""
    identity = table.text("id", required=True) or ""
    name = table.text("card", required=True)
    override = {key: table.get(key) for key in CARD_KEYS if key in table}
    card: InstrumentCard | None = None
    if name is not None:
        card = load_card(
            name, base=folder, override=override, findings=table.findings, where=table.where
        )
    constant = table.table("constant")
    known = None
    if constant is not None:
        value = constant.number("arcsec", low=-648000.0, high=648000.0, required=True)
        sigma = constant.number("sigma_arcsec", high=36000.0, required=True, positive=True)
        constant.warn_unknown()
        if value is not None and sigma is not None:
            known = (value * ARCSEC, sigma * ARCSEC)
    instrument = Instrument(
        id=identity,
        card=card or InstrumentCard("", "", "suspended", ""),
        serial=_serial(table),
        known_constant=known,
        effects=tuple(read_effect(t) for t in table.tables("effect")),
    )
    for key in ("note", "constant_choice"):  # the choice may name a line between stations
        table.get(key)
    table.warn_unknown(*CARD_KEYS, "priors")
    return instrument


def _serial(table: Table) -> str:
    value = table.get("serial")
    if isinstance(value, int) and not isinstance(value, bool):
        return shown(value)
    return table.text("serial") or ""


def read_session(table: Table, names: Names) -> OrientationSession:
    """One [[orientation]], still without its book."""
    identity = table.text("id", required=True) or ""
    station = table.text("station", required=True) or ""
    target = table.text("target")
    instrument = table.text("instrument", required=True) or ""
    choice = names.read_choice(table, instrument)
    _check_names(table, names, (station, target, instrument))
    method = table.choice("method", METHODS, required=True)
    purpose = table.choice("purpose", PURPOSES)
    azimuth = table.angle("azimuth_known", names.unit)
    if azimuth is not None and purpose is None and "purpose" not in table:
        table.problem("azimuth_known stands without purpose", "", " | ".join(PURPOSES))
    refraction = table.number("refraction_sigma_arcsec", low=0.0, high=36000.0)
    sigma = table.number("azimuth_known_sigma_arcsec", low=0.0, high=36000.0)
    if sigma is not None and azimuth is None and purpose == "survey":
        table.problem("azimuth_known_sigma_arcsec stands in a survey session", "", "a calibration")
    for key in ("levelling", "pre_orientation"):  # io.session_sensors reads them
        table.get(key)
    resolution = table.number("resolution_arcsec", high=36000.0, positive=True)
    session = OrientationSession(
        id=identity,
        station=station,
        instrument=instrument,
        method=cast("Method", method or "tracking"),
        purpose=cast("Purpose", purpose or "survey"),
        book=FieldBook((), ()),
        book_path=table.text("book", required=True) or "",
        target=target or None,
        azimuth_known=azimuth,
        azimuth_known_sigma=None if sigma is None else sigma * ARCSEC,
        constant_choice=choice,
        date=table.date("date"),
        order=table.number("order"),
        circle_shift=table.angle("circle_shift", names.unit),
        observer=table.text("observer") or "",
        reference_temperature_c=table.number("reference_temperature_c", low=-90.0, high=150.0),
        resolution=None if resolution is None else resolution * ARCSEC,
        eccentric=_eccentric(table, names.unit),
        effects=tuple(read_effect(t) for t in table.tables("effect")),
        convergence=read_convergence(table, names.unit),
        recentred=table.boolean("recentred"),
        refraction_sigma=None if refraction is None else refraction * ARCSEC,
        pressure_hpa=table.number("pressure_hpa", low=300.0, high=1200.0),
        humidity_percent=table.number("humidity_percent", low=0.0, high=100.0),
        hours_since_transport=table.number("hours_since_transport", low=0.0, high=1e6),
        override=_session_override(table),
    )
    table.warn_unknown("rounds", "sigma_arcsec", "level_division_arcsec")
    return session


def _check_names(table: Table, names: Names, used: tuple[str, str | None, str]) -> None:
    """Everything that a session refers to is declared."""
    station, target, instrument = used
    names.check_station(table, station, "the session stands on no station")
    names.check_station(table, target, "a sight whose target is no station")
    if target and target == station:
        table.problem("the target is the station itself", target, "another station")
    if instrument and instrument not in names.instruments:
        hint = nearest_names(instrument, names.instruments)
        table.problem("there is no such instrument", instrument, "an id of [[instrument]]", hint)


def _session_override(table: Table) -> tuple[tuple[str, object], ...]:
    """Further keys: what is known of them is checked, the rest is kept as it stands."""
    pairs: list[tuple[str, object]] = []
    rounds = table.number("rounds", low=1.0, high=1000.0)
    if rounds is not None:
        if rounds != int(rounds):
            table.problem("rounds is no whole number", table.get("rounds"), "1, 2, 3 ...")
        pairs.append(("rounds", int(rounds)))
    sigma = table.number("sigma_arcsec", high=36000.0, positive=True)
    if sigma is not None:
        pairs.append(("sigma_arcsec", sigma))
    wanted = table.number("wanted_interval_arcsec", high=36000.0, positive=True)
    if wanted is not None:
        pairs.append(("wanted_interval_arcsec", wanted))
    centring = read_centring(table)
    if centring is not None:
        pairs.append(("centring", centring))
    note = table.text("note", multiline=True)
    if note is not None:
        pairs.append(("note", note))
    pairs += [(key, table.data[key]) for key in table.unread()]
    return tuple(pairs)


def _eccentric(session: Table, unit: AngleUnit) -> Eccentric | None:
    table = session.table("eccentric")
    if table is None:
        return None
    distance = table.number("distance_m", low=0.0, high=1e4, required=True)
    direction = table.angle("direction", unit)
    if direction is None and "direction" not in table and distance != 0.0:
        table.problem("direction is missing", "", "the circle reading towards the mark")
    at = table.choice("at", ("station", "target"))
    sigma = table.number("sigma_m", low=0.0, high=1e3)
    table.warn_unknown()
    where = cast("Literal['station', 'target']", at or "station")
    return Eccentric(distance or 0.0, direction or 0.0, where, sigma)
