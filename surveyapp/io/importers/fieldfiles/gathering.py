"""What a reader of a field file has gathered so far: pointings, points, damage, what is ignored.

Every reader fills one of these. Damage is noted with its line and never guessed over: what depends
on a damaged line is left out with it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import FieldFile, KnownPoint, Pointing, SkippedLine
from surveyapp.domain.project import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import decode, read_bytes, shown
from surveyapp.io.importers.fieldfiles.units import FootChoice

DAMAGED: Final = "damaged"
DEPENDENT: Final = "depends_on_damaged"
_SAME_M: Final = 1e-3
_SHOWN: Final = 8
_TOLD_EVERY: Final = 5000


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """What the caller tells about a file.

    Parameters
    ----------
    skip_damaged : bool
        Leave damaged lines out instead of refusing the file.
    station_code : str or None
        GSI: the office's code of a station block.
    columns, units : mapping
        CSV: columns and units by quantity; ``foot`` tells which foot.
    progress : callable or None
        Told from time to time which part of the file has been read, 0 to 1.
    """

    skip_damaged: bool = False
    station_code: str | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    progress: Callable[[float], None] | None = None


@dataclass(slots=True)
class Gathering:
    """Mutable, private to one reading."""

    name: str
    options: ReadOptions
    foot: FootChoice = field(default_factory=FootChoice)
    pointings: list[Pointing] = field(default_factory=list)
    points: dict[str, KnownPoint] = field(default_factory=dict)
    skipped: list[SkippedLine] = field(default_factory=list)
    damage: list[Problem] = field(default_factory=list)
    warnings: list[ResultWarning] = field(default_factory=list)
    ignored: Counter[str] = field(default_factory=Counter)
    feet: bool = False

    def numbered(self, lines: Sequence[str], start: int = 1) -> Iterator[tuple[int, str]]:
        """Lines with their numbers; tells the progress on the way."""
        tell = self.options.progress
        for number, line in enumerate(lines, start=start):
            if tell is not None and number % _TOLD_EVERY == 0:
                tell((number - start) / len(lines))
            yield number, line

    def add(self, pointing: Pointing) -> None:
        """Take a pointing whose vertical reading agrees with its face."""
        v = pointing.v
        if v is not None and pointing.face and (v > math.pi) != (pointing.face == "R"):
            what = f"the vertical reading is none of face {'II' if pointing.face == 'R' else 'I'}"
            self.damaged(pointing.line, what, f"{math.degrees(v):.5f} degrees from the zenith")
            return
        self.pointings.append(pointing)

    def damaged(self, line: int, what: str, found: str, expected: str = "") -> None:
        """Note a damaged line."""
        self.damage.append(Problem(what, f"{self.name}, line {line}", shown(found), expected))
        self.skipped.append(SkippedLine(line, DAMAGED, what))

    def dependent(self, line: int, text: str) -> None:
        """Note a line that is sound but means nothing without a damaged one."""
        self.skipped.append(SkippedLine(line, DEPENDENT, text))

    def skip(self, line: int, code: str, text: str) -> None:
        """Note a line that is left out for another reason."""
        self.skipped.append(SkippedLine(line, code, text))

    def warn(self, code: str, text: str) -> None:
        """Note something that the surveyor must know, once."""
        warning = ResultWarning(code, text)
        if warning not in self.warnings:
            self.warnings.append(warning)

    def length(self, factor: float | None) -> float:
        """Factor of a length; None = feet of the kind that was told."""
        if factor is None:
            self.feet = True
            return self.foot.metres
        return factor

    def point(self, point: KnownPoint) -> None:
        """Take coordinates; a second, different statement about a point is told."""
        if point.e is None and point.n is None and point.h is None:
            return
        old = self.points.setdefault(point.name, point)
        pairs = ((old.e, point.e), (old.n, point.n), (old.h, point.h))
        if any(a is not None and b is not None and abs(a - b) > _SAME_M for a, b in pairs):
            text = f"line {point.line} has other coordinates of {point.name} than line {old.line}"
            self.warn("coordinates_differ", f"{text}: the first count")

    def finish(
        self,
        *,
        form: tuple[str, str],
        applied: tuple[bool | None, bool | None],
        corrected: bool = False,
    ) -> FieldFile:
        """The file as read.

        Parameters
        ----------
        form : tuple of str
            Format and variant.
        applied : tuple of (bool or None)
            Whether atmosphere and constant are in the distances after the reduction.
        corrected : bool
            Whether the reduction adds them.

        Raises
        ------
        SurveyError
            With every damaged line, unless they are to be left out; without any pointing.
        """
        if self.damage and not self.options.skip_damaged:
            raise SurveyError([_with_hint(problem) for problem in self.damage])
        if not self.pointings:
            raise SurveyError(
                Problem(
                    f"there is no reading in the file ({form[0]})",
                    self.name,
                    "no pointing that can be used",
                    "pointings with a target and a circle reading",
                    "Is it a file of this format?",
                )
            )
        self._tell(form[0])
        return FieldFile(
            format=form[0],
            variant=form[1],
            pointings=tuple(self.pointings),
            points=tuple(self.points.values()),
            atmosphere_applied=applied[0],
            constant_applied=applied[1],
            corrected=corrected,
            skipped=tuple(sorted(self.skipped, key=lambda item: item.line)),
            warnings=tuple(self.warnings),
        )

    def _tell(self, form: str) -> None:
        if self.feet:
            self.warn("foot", self.foot.text)
        if self.ignored:
            parts = [f"{kind} ({count})" for kind, count in self.ignored.most_common(_SHOWN)]
            more = len(self.ignored) - _SHOWN
            rest = f" and {more} further kinds" if more > 0 else ""
            self.warn("ignored_records", f"not used: {', '.join(parts)}{rest}")
        prisms = sorted({p.prism_m for p in self.pointings if p.prism_m is not None})
        if len(prisms) > 1:
            shown_mm = ", ".join(f"{value * 1000.0:g}" for value in prisms[:_SHOWN])
            self.warn("prism_changes", f"the prism constant changes: {shown_mm} mm")
        ppms = {p.ppm for p in self.pointings if p.sd is not None}
        if ppms == {0.0}:
            text = "ppm is 0 in the whole file: was the atmosphere entered in the instrument?"
            self.warn("ppm_zero", text)


def _with_hint(problem: Problem) -> Problem:
    hint = "--skip-damaged leaves such lines out and lists them"
    return Problem(problem.what, problem.where, problem.found, problem.expected, hint)


def gathering(path: Path, options: ReadOptions) -> Gathering:
    """An empty gathering for a file, with the foot that was told."""
    from surveyapp.errors import nearest_names
    from surveyapp.io.importers.fieldfiles.units import FOOT, US_FOOT

    kinds = {"us": US_FOOT, "international": FOOT}
    told = options.units.get("foot")
    if told is not None and told not in kinds:
        hint = nearest_names(told, kinds)
        raise SurveyError(Problem("there is no such foot", "--unit foot", told, "", hint))
    foot = FootChoice() if told is None else FootChoice(kinds[told], told=True)
    return Gathering(path.name, options, foot)


def file_lines(data: bytes, where: str, *, single_byte: bool = False) -> tuple[list[str], str]:
    """Lines of a file without their ends, and the encoding they were read in.

    Parameters
    ----------
    data : bytes
    where : str
        What messages call the file.
    single_byte : bool
        Columns are counted in bytes: never decode several bytes to one character.

    Raises
    ------
    SurveyError
        For a binary file.
    """
    encoding = "latin-1"
    if single_byte or not data.isascii():
        if b"\x00" in data:
            decode(data, where=where)
        if not single_byte:
            try:
                text, encoding = data.decode("utf-8-sig"), "utf-8"
            except UnicodeDecodeError:
                text = data.decode("latin-1")
        else:
            text = data.decode("latin-1")
    else:
        text = decode(data, where=where)
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    lines = text.split("\n")
    if lines and not lines[-1]:
        lines.pop()
    return lines, encoding


def read_field_file(path: Path) -> bytes:
    """Bytes of a field file; see ``surveyapp.io.files``."""
    return read_bytes(path, where=path.name)
