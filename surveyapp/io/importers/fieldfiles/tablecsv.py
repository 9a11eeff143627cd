"""A table of pointings (CSV of a total station or a spreadsheet) by a map of its columns.

Units are mandatory for every mapped angle and length. Whether distances hold prism constant and
ppm is not guessed: nothing in a table says so, and the traverse is written without a statement.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import Face, FieldFile, Pointing
from surveyapp.io.importers.fieldfiles.columns import (
    CellError,
    Columns,
    Quantities,
    Style,
    cells_of,
    check_style,
    find_columns,
    style_of,
)
from surveyapp.io.importers.fieldfiles.gathering import (
    Gathering,
    ReadOptions,
    gathering,
)
from surveyapp.io.importers.fieldfiles.lines import look_through
from surveyapp.io.importers.fieldfiles.units import US_FOOT
from surveyapp.languages import said

QUANTITIES: Final = Quantities(
    names=(
        *("at", "to", "set", "face", "hz", "v", "sd", "hd", "hi", "ht", "ppm", "prism"),
        *("temperature", "pressure", "time", "code", "note"),
    ),
    required=("at", "to"),
    angles=frozenset({"hz", "v"}),
    lengths=frozenset({"sd", "hd", "hi", "ht", "prism"}),
)
_FACES: Final[dict[str, Face]] = {
    **dict.fromkeys(("i", "l", "1", "f1", "face1", "left", "kl", "cl"), "L"),
    **dict.fromkeys(("ii", "r", "2", "f2", "face2", "right", "kr", "cr"), "R"),
    "": "",
}
_TWO_PI: Final = 2.0 * math.pi


def read_csv(path: Path, options: ReadOptions) -> FieldFile:
    """Read a table of pointings.

    Parameters
    ----------
    path : Path
    options : ReadOptions
        ``columns`` and ``units`` by quantity.

    Raises
    ------
    SurveyError
        Everything wrong with map and units; every damaged row.
    """
    gathered = gathering(path, options)
    table = look_through(path)
    units = {name: unit for name, unit in options.units.items() if name != "foot"}
    if gathered.foot.metres == US_FOOT:
        units = {name: "usft" if unit == "ft" else unit for name, unit in units.items()}
    columns = find_columns(table, QUANTITIES, (options.columns, units))
    gathered.feet = not {"ft", "usft"}.isdisjoint(columns.units.values())
    rows = _Rows(gathered, columns, style_of(table, columns))
    for number, line in gathered.lines(table):
        if (
            number <= columns.header_line
            or not line.strip(" \t,;|")
            or line.lstrip().startswith("#")
        ):
            continue
        rows.take(number, line)
    gathered.warn("table_layout", columns.told)
    if table.encoding == "latin-1":
        gathered.warn("code_page", "the table is no UTF-8: names were read as Latin-1")
    text = (
        "a table does not say whether distances hold prism constant and ppm: enter "
        "atmosphere_applied and constant_applied in [[traverse]]"
    )
    gathered.warn("corrections_unknown", text)
    variant = f"table, {columns.told}"
    return gathered.finish(form=("csv", variant), applied=(None, None))


class _Rows:
    """Rows to pointings; follows the set-ups."""

    def __init__(self, gathered: Gathering, columns: Columns, style: Style) -> None:
        self.gathered, self.columns, self.style = gathered, columns, style
        self.setups: dict[tuple[str, str], str] = {}
        self.current = ""
        self.stated_sets = "set" in columns.places

    def take(self, number: int, line: str) -> None:
        try:
            cells = cells_of(line, self.columns)
            check_style(cells, self.style, self.columns)
            self.gathered.add(self._pointing(number, cells))
        except CellError as error:
            self.gathered.damaged(number, error.args[0], line)

    def _setup(self, at: str, stated: str) -> str:
        """Stated sets belong together wherever they stand; else a run of rows is a set-up."""
        if self.stated_sets and stated:
            key = (at, "")
            return self.setups.setdefault(key, str(len(self.setups) + 1))
        if at != self.current:
            self.current = at
            self.setups[at, str(len(self.setups))] = str(len(self.setups) + 1)
        return str(len(self.setups))

    def _pointing(self, number: int, cells: list[str]) -> Pointing:
        columns = self.columns
        at, to = columns.text(cells, "at"), columns.text(cells, "to")
        if not at or not to or at == to:
            raise CellError(
                said("a sight needs a station and another point: {at!r} to {to!r}", at=at, to=to)
            )
        hz, v = self._circle(cells, "hz"), self._circle(cells, "v")
        if columns.carries(cells, "hz") or columns.carries(cells, "v"):
            self.gathered.carry(number)
        sd, hd = self._distance(cells, "sd"), self._distance(cells, "hd")
        if hz is None and v is None and sd is None and hd is None:
            raise CellError("there is no reading in this row")
        face_text = columns.text(cells, "face").lower()
        if face_text not in _FACES:
            raise CellError(
                said("the face is none of I, II, L, R, 1, 2: {face_text}", face_text=face_text[:20])
            )
        face: Face = _FACES[face_text]
        if not face and v is not None:
            face = "R" if v > math.pi else "L"
        stated = columns.text(cells, "set")
        return Pointing(
            line=number,
            at=at,
            to=to,
            setup=self._setup(at, stated),
            face=face,
            hz=hz,
            v=v or None,
            sd=sd,
            hd=hd if sd is None else None,
            hi=columns.length(cells, "hi"),
            ht=columns.length(cells, "ht"),
            set=stated,
            ppm=columns.number(cells, "ppm"),
            prism_m=columns.length(cells, "prism"),
            temperature_c=columns.temperature(cells),
            pressure_hpa=columns.pressure(cells),
            time=columns.text(cells, "time"),
            code=columns.text(cells, "code"),
            note=columns.text(cells, "note"),
        )

    def _circle(self, cells: list[str], quantity: str) -> float | None:
        if quantity not in self.columns.places:
            return None
        value = self.columns.angle(cells, quantity)
        if value is None:
            return None
        if not 0.0 <= value <= _TWO_PI + 1e-9:
            raise CellError(
                said(
                    "{quantity} is beyond the circle: {value} {value2}",
                    quantity=quantity,
                    value=self.columns.text(cells, quantity),
                    value2=self.columns.units[quantity],
                )
            )
        return 0.0 if value >= _TWO_PI else value

    def _distance(self, cells: list[str], quantity: str) -> float | None:
        if quantity not in self.columns.places:
            return None
        value = self.columns.length(cells, quantity)
        if value is not None and value < 0.0:
            raise CellError(
                said(
                    "{quantity} is negative: {value}",
                    quantity=quantity,
                    value=self.columns.text(cells, quantity),
                )
            )
        return value or None
