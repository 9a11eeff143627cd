"""The elements of a .gkf file in their order, checked and converted one by one.

Turns text into numbers with the right unit and collects every problem with its line; what the
elements mean together is ``gkf_network``.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Callable
from dataclasses import dataclass, field

from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.errors import Problem, SurveyError, nearest_names
from surveyapp.languages import joined, said

GON = math.pi / 200.0
CC = GON * 1e-4
ARCSEC = math.pi / 648000.0
MM = 1e-3
NEVER_MM = 1e9
"""``tol-abs`` of a network in which nothing is left out, however far it misses."""
AXES = ("ne", "sw", "es", "wn", "en", "nw", "se", "ws")
LARGEST_NUMBER = 1e10
"""A grid coordinate with its zone's number in front has eight digits before the point."""
SMALLEST_NUMBER = 1e-12
LARGEST_ANGLE = 1e6
MOST_ELEMENTS = 150_000
DEEPEST = 16
MOST_PROBLEMS = 200
"""Beyond these a file is read no further."""
KINDS = {
    "direction": ObservationKind.DIRECTION,
    "distance": ObservationKind.DISTANCE,
    "angle": ObservationKind.ANGLE,
    "s-distance": ObservationKind.SLOPE_DISTANCE,
    "z-angle": ObservationKind.ZENITH,
    "azimuth": ObservationKind.AZIMUTH,
    "dh": ObservationKind.HEIGHT_DIFFERENCE,
}
DEFAULTS = {
    ObservationKind.DIRECTION: "direction-stdev",
    ObservationKind.ANGLE: "angle-stdev",
    ObservationKind.ZENITH: "zenith-angle-stdev",
    ObservationKind.AZIMUTH: "azimuth-stdev",
}
ATTRIBUTES: dict[str, frozenset[str]] = {
    "gama-local": frozenset({"xmlns", "version"}),
    "gama-xml": frozenset({"xmlns", "version"}),
    "network": frozenset({"axes-xy", "angles", "epoch"}),
    "description": frozenset(),
    "parameters": frozenset(
        {"sigma-apr", "conf-pr", "tol-abs", "sigma-act", "algorithm", "language", "encoding"}
        | {"angles", "angular", "latitude", "ellipsoid", "cov-band", "iterations"}
        | {"update-constrained-coordinates"}
    ),
    "points-observations": frozenset({"distance-stdev", *DEFAULTS.values()}),
    "point": frozenset({"id", "x", "y", "z", "fix", "adj"}),
    "obs": frozenset({"from", "orientation", "from_dh", "station"}),
    "cov-mat": frozenset({"dim", "band"}),
    "height-differences": frozenset(),
    "coordinates": frozenset({"extern"}),
    "vectors": frozenset(),
    "dh": frozenset({"from", "to", "val", "stdev", "dist", "extern"}),
    "vec": frozenset({"from", "to", "dx", "dy", "dz", "from_dh", "to_dh", "extern"}),
    "angle": frozenset({"from", "bs", "fs", "val", "stdev", "from_dh", "bs_dh", "fs_dh", "extern"}),
    **{
        name: frozenset({"from", "to", "val", "stdev", "from_dh", "to_dh", "extern"})
        for name in ("direction", "distance", "s-distance", "z-angle", "azimuth")
    },
}
_DMS = re.compile(r"([+-]?)(\d+)-(\d+)-(\d+(?:\.\d*)?)")


@dataclass(slots=True)
class PointEntry:
    """What the file says about a point; filled up as elements come."""

    name: str
    line: int
    x: float | None = None
    y: float | None = None
    z: float | None = None
    fix: str = ""
    adj: str = ""


@dataclass(frozen=True, slots=True)
class Axes:
    """How x and y and the angles of the file turn into east, north and clockwise."""

    xy: str = "ne"
    left_handed: bool = True

    def component(self, axis: int) -> tuple[str, float]:
        """``e`` or ``n`` and the sign of x (0) or y (1)."""
        letter = self.xy[axis]
        return ("e" if letter in "ew" else "n"), (1.0 if letter in "en" else -1.0)

    @property
    def turn(self) -> float:
        """Sign of a horizontal angle."""
        return 1.0 if self.left_handed else -1.0


@dataclass(slots=True)
class Cluster:
    """Observations of one <obs>, <height-differences>, <coordinates> or <vectors>."""

    element: str
    station: str = ""
    from_dh: float = 0.0
    extern: str = ""
    set: str = ""
    line: int = 0
    members: list[int] = field(default_factory=list)
    units: list[float] = field(default_factory=list)
    entries: list[tuple[str, dict[str, str], int]] = field(default_factory=list)
    dim: int | None = None
    band: int = 0
    numbers: list[str] = field(default_factory=list)


class GkfDocument:
    """Everything read so far; mutable, private to one reading."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.problems: list[Problem] = []
        self.unknown_attributes: dict[str, int] = {}
        self.carried: list[int] = []
        self.axes = Axes()
        self.parameters: dict[str, str] = {}
        self.defaults: dict[str, str] = {}
        self.points: dict[str, PointEntry] = {}
        self.clusters: list[Cluster] = []
        self.description: list[str] = []
        self._path: list[str] = []
        self._cluster: Cluster | None = None
        self._line = 0
        self._elements = 0
        self._actions: dict[str, Callable[[dict[str, str]], None]] = {
            "network": self._network,
            "parameters": self._parameters,
            "points-observations": self._points_observations,
            "point": self._point,
            "obs": self._open,
            "height-differences": self._open,
            "coordinates": self._open,
            "vectors": self._open,
            "cov-mat": self._covariance,
        }

    def where(self, line: int) -> str:
        """Place in the file for messages."""
        return f"{self.name}, line {line}"

    def problem(self, what: str, line: int, found: str, *, expected: str, hint: str = "") -> None:
        """Note a problem."""
        self.problems.append(Problem(what, self.where(line), found, expected, hint))

    def start(self, name: str, attributes: dict[str, str], line: int) -> None:
        """Take the start of an element."""
        self._path.append(name)
        self._line = line
        self._elements += 1
        if self._elements > MOST_ELEMENTS or len(self._path) > DEEPEST:
            self.problem(
                "The file is no network of this size",
                line,
                said(
                    "{elements} elements, {size} deep",
                    elements=self._elements,
                    size=len(self._path),
                ),
                expected=said(
                    "at most {most_elements} elements, {deepest} deep",
                    most_elements=MOST_ELEMENTS,
                    deepest=DEEPEST,
                ),
            )
            raise SurveyError(self.problems)
        if len(self.problems) > MOST_PROBLEMS:
            raise SurveyError(self.problems)
        if not all(value.isascii() for value in attributes.values()):
            attributes = {k: unicodedata.normalize("NFC", v) for k, v in attributes.items()}
        known = ATTRIBUTES.get(name)
        if known is None:
            hint = nearest_names(name, ATTRIBUTES)
            self.problem(
                "Unknown element", line, f"<{name}>", expected="a gama-local element", hint=hint
            )
            return
        if not known.issuperset(attributes):
            for attribute in attributes:
                if attribute not in known and not attribute.startswith("xmlns"):
                    self.unknown_attributes.setdefault(f"{name} {attribute}", line)
        if name in KINDS or name == "vec":
            self._observation(name, attributes)
        elif name in self._actions:
            self._actions[name](attributes)

    def end(self, name: str) -> None:
        """Take the end of an element."""
        self._path.pop()
        if self._cluster is not None and name == self._cluster.element:
            self.clusters.append(self._cluster)
            self._cluster = None

    def text(self, content: str) -> None:
        """Take text between tags."""
        if not self._path:
            return
        if self._path[-1] == "description":
            self.description.append(content)
        elif self._path[-1] == "cov-mat" and self._cluster is not None:
            self._cluster.numbers.append(content)

    def number(self, text: str, line: int, what: str) -> float | None:
        """A finite number, else a problem and None."""
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if abs(value) <= LARGEST_NUMBER and (value == 0.0 or abs(value) >= SMALLEST_NUMBER):
            return value
        if math.isfinite(value):
            expected = said(
                "{smallest_number:g} to {largest_number:g}, or 0",
                smallest_number=SMALLEST_NUMBER,
                largest_number=LARGEST_NUMBER,
            )
            self.problem(
                said("{what} is beyond all measures", what=what),
                line,
                repr(text[:40]),
                expected=expected,
            )
            return None
        hint = "Use a decimal point." if "," in text else ""
        self.problem(
            said("{what} is no number", what=what), line, repr(text), expected="a number", hint=hint
        )
        return None

    def angle(self, text: str, line: int) -> tuple[float, float] | None:
        """Value [rad] and unit of its standard deviation [rad], gon or degrees-minutes-seconds."""
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if abs(value) <= LARGEST_ANGLE:
            return value * GON, CC
        match = _DMS.fullmatch(text.strip())
        if match is None or float(match[3]) > 60.0 or float(match[4]) > 60.0:
            self.problem(
                "An angle cannot be read",
                line,
                repr(text),
                expected="gon like 63.9347 or degrees like 57-32-28.4",
                hint="Is it in another unit?",
            )
            return None
        if float(match[3]) == 60.0 or float(match[4]) == 60.0:
            self.carried.append(line)
        seconds = (float(match[2]) * 60.0 + float(match[3])) * 60.0 + float(match[4])
        return (-seconds if match[1] == "-" else seconds) * ARCSEC, ARCSEC

    def _network(self, attributes: dict[str, str]) -> None:
        axes = attributes.get("axes-xy", "ne").strip()
        hand = attributes.get("angles", "left-handed").strip()
        if axes not in AXES:
            self.problem("Unknown axes", self._line, axes, expected=", ".join(AXES))
            axes = "ne"
        if hand not in ("left-handed", "right-handed"):
            expected = "left-handed or right-handed"
            self.problem("Unknown direction of angles", self._line, hand, expected=expected)
        self.axes = Axes(axes, hand != "right-handed")

    def _parameters(self, attributes: dict[str, str]) -> None:
        self.parameters.update(attributes)

    def _points_observations(self, attributes: dict[str, str]) -> None:
        self.defaults.update(attributes)

    def _open(self, attributes: dict[str, str]) -> None:
        station = (attributes.get("from") or attributes.get("station") or "").strip()
        height = self.number(attributes.get("from_dh", "0"), self._line, "from_dh") or 0.0
        self._cluster = Cluster(
            self._path[-1], station, height, attributes.get("extern", ""), line=self._line
        )

    def _covariance(self, attributes: dict[str, str]) -> None:
        if self._cluster is None:
            self.problem(
                "A covariance matrix stands alone", self._line, "<cov-mat>", expected="in <obs>"
            )
            return
        try:
            self._cluster.dim = int(attributes["dim"])
            self._cluster.band = int(attributes["band"])
        except (KeyError, ValueError):
            found = said(
                "dim={value}, band={value2}",
                value=attributes.get("dim"),
                value2=attributes.get("band"),
            )
            self.problem(
                "Size of a covariance matrix", self._line, found, expected="two whole numbers"
            )
            self._cluster.dim = -1

    def _point(self, attributes: dict[str, str]) -> None:
        name = attributes.get("id", "").strip()
        if not name:
            self.problem("A point has no id", self._line, "nothing", expected="an id")
            return
        observed = self._cluster is not None and self._cluster.element == "coordinates"
        if observed and self._cluster is not None:
            self._cluster.entries.append(("point", attributes, self._line))
        entry = self.points.setdefault(name, PointEntry(name, self._line))
        if not observed:
            self._coordinates(entry, attributes)
        for key, allowed in (("fix", "xyz"), ("adj", "xyz")):
            text = attributes.get(key, "").strip()
            if text.lower() not in ("", "xy", "z", allowed) or (
                text[:2].lower() == "xy" and text[:2] not in ("xy", "XY")
            ):
                expected = "xy, XY, z, Z, xyz, XYZ, XYz or xyZ"
                self.problem(
                    said("Unknown value of {key}", key=key), self._line, text, expected=expected
                )
            elif text and key == "fix":
                entry.fix += text
            elif text:
                entry.adj += text

    def _coordinates(self, entry: PointEntry, attributes: dict[str, str]) -> None:
        for axis in ("x", "y", "z"):
            if axis not in attributes:
                continue
            value = self.number(attributes[axis], self._line, f"Coordinate {axis} of {entry.name}")
            old = getattr(entry, axis)
            if old is not None and value is not None and old != value:
                self.problem(
                    "Two points have one name",
                    self._line,
                    said("{name} with {axis} = {value:g}", name=entry.name, axis=axis, value=value),
                    expected=said(
                        "{axis} = {old:g} as in line {line}, or another name",
                        axis=axis,
                        old=old,
                        line=entry.line,
                    ),
                    hint="Rename one of them.",
                )
            elif value is not None:
                setattr(entry, axis, value)

    def _observation(self, name: str, attributes: dict[str, str]) -> None:
        if self._cluster is None:
            expected = "inside <obs>, <height-differences> or <vectors>"
            self.problem("An observation stands alone", self._line, f"<{name}>", expected=expected)
            return
        self._cluster.entries.append((name, attributes, self._line))

    def build(self, values: Observation | Callable[[], Observation]) -> Observation | None:
        """Build an observation; what it refuses becomes problems of this file."""
        try:
            return values() if callable(values) else values
        except SurveyError as refused:
            self.problems += [
                Problem(p.what, joined(", ", (self.name, p.where)), p.found, p.expected, p.hint)
                for p in refused.problems
            ]
            return None
