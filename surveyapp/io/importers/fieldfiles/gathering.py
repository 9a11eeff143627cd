"""What a reader of a field file has gathered so far: pointings, points, damage, what is ignored.

Every reader fills one of these. Damage is noted with its line and never guessed over: what depends
on a damaged line is left out with it. What is kept is bounded, however large the file is.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from surveyapp.domain.fieldfile import FieldFile, KnownPoint, Pointing, SkippedLine
from surveyapp.domain.warning import ResultWarning
from surveyapp.errors import Problem, SurveyError
from surveyapp.io.files import shown
from surveyapp.io.importers.fieldfiles.damage import Damage
from surveyapp.io.importers.fieldfiles.lines import Cut, FieldText
from surveyapp.io.importers.fieldfiles.parts import Parts
from surveyapp.io.importers.fieldfiles.units import FootChoice
from surveyapp.languages import counted, said

DAMAGED: Final = "damaged"
DEPENDENT: Final = "depends_on_damaged"
_SAME_M: Final = 1e-3
_SHOWN: Final = 8
_MOST_POINTS: Final = 300_000
_MOST_KINDS: Final = 1000


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
    lines : tuple of int or None
        First and last line whose readings are taken; what stands before them is read all the same.
    """

    skip_damaged: bool = False
    station_code: str | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    progress: Callable[[float], None] | None = None
    lines: tuple[int, int] | None = None

    def wants(self, line: int) -> bool:
        """Whether readings and damage of a line count."""
        return self.lines is None or self.lines[0] <= line <= self.lines[1]


@dataclass(slots=True)
class Gathering:
    """Mutable, private to one reading."""

    name: str
    options: ReadOptions
    foot: FootChoice = field(default_factory=FootChoice)
    pointings: list[Pointing] = field(default_factory=list)
    points: dict[str, KnownPoint] = field(default_factory=dict)
    skipped: list[SkippedLine] = field(default_factory=list)
    damage: Damage = field(default_factory=Damage)
    warnings: list[ResultWarning] = field(default_factory=list)
    ignored: Counter[str] = field(default_factory=Counter)
    parts: Parts = field(default_factory=Parts)
    carried: list[int] = field(default_factory=list)
    feet: bool = False
    open_end: bool = False

    def lines(self, text: FieldText, *, cut: Cut | None = None) -> Iterator[tuple[int, str]]:
        """Lines with their numbers; tells the progress on the way."""
        self.open_end = not text.ended
        return text.lines(progress=self.options.progress, cut=cut)

    def ignore(self, kind: str, count: int = 1) -> None:
        """Note that something is not used; of kinds without end the first."""
        if kind in self.ignored or len(self.ignored) < _MOST_KINDS:
            self.ignored[kind] += count
        else:
            self.ignored["others"] += count

    def add(self, pointing: Pointing) -> None:
        """Take a pointing whose vertical reading agrees with its face."""
        v = pointing.v
        if v is not None and pointing.face and (v > math.pi) != (pointing.face == "R"):
            what = said(
                "the vertical reading is none of face {value}",
                value="II" if pointing.face == "R" else "I",
            )
            self.damaged(pointing.line, what, f"{math.degrees(v):.5f} degrees from the zenith")
            return
        if self.options.wants(pointing.line) and self.parts.takes(pointing.line, pointing.setup):
            self.pointings.append(pointing)

    def damaged(self, line: int, what: str, found: str, expected: str = "") -> None:
        """Note a damaged line."""
        if self.options.wants(line):
            self.damage.add(
                line,
                Problem(
                    what,
                    said("{name}, line {line}", name=self.name, line=line),
                    shown(found),
                    expected,
                ),
            )
            self.skip(line, DAMAGED, what)

    def dependent(self, line: int, text: str) -> None:
        """Note a line that is sound but means nothing without a damaged one."""
        self.skip(line, DEPENDENT, text)

    def skip(self, line: int, code: str, text: str) -> None:
        """Note a line that is left out for another reason."""
        if self.options.wants(line):
            self.skipped.append(SkippedLine(line, code, text))
            self.damage.refuse_flood(len(self.skipped), self.name)

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

    def carry(self, line: int) -> None:
        """Note 60 seconds that were carried over to the next minute."""
        if len(self.carried) < _SHOWN:
            self.carried.append(line)

    def point(self, point: KnownPoint) -> None:
        """Take coordinates; a second, different statement about a point is told."""
        if point.e is None and point.n is None and point.h is None:
            return
        old = self.points.setdefault(point.name, point)
        if len(self.points) > _MOST_POINTS:
            found, expected = (
                said("more than {most_points}", most_points=_MOST_POINTS),
                "the points of a survey",
            )
            raise SurveyError(Problem("the file holds too many points", self.name, found, expected))
        pairs = ((old.e, point.e), (old.n, point.n), (old.h, point.h))
        if any(a is not None and b is not None and abs(a - b) > _SAME_M for a, b in pairs):
            text = said(
                "line {line} has other coordinates of {name} than line {first}: the first count",
                line=point.line,
                name=point.name,
                first=old.line,
            )
            self.warn("coordinates_differ", text)

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
            raise SurveyError(self.damage.problems(self.name))
        if self.parts.left_out:
            raise SurveyError(self.parts.problem(self.name))
        if not self.pointings:
            raise SurveyError(
                Problem(
                    said("there is no reading in the file ({form})", form=form[0]),
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
            parts=self.parts.found(),
        )

    def _tell(self, form: str) -> None:
        if self.feet:
            self.warn("foot", self.foot.text)
        if self.open_end:
            self.warn("open_end", "the last line has no line end: is the file whole?")
        if self.carried:
            lines = ", ".join(str(line) for line in self.carried)
            self.warn("sixty_carried", said("60 seconds carried over: lines {lines}", lines=lines))
        if self.ignored:
            parts = [f"{kind} ({count})" for kind, count in self.ignored.most_common(_SHOWN)]
            more = len(self.ignored) - _SHOWN
            rest = counted(
                " and {count} further kind", " and {count} further kinds", count=max(more, 1)
            )
            self.warn(
                "ignored_records",
                said(
                    "not used: {names}{rest}", names=", ".join(parts), rest=rest if more > 0 else ""
                ),
            )
        prisms = sorted({p.prism_m for p in self.pointings if p.prism_m is not None})
        if len(prisms) > 1:
            shown_mm = ", ".join(f"{value * 1000.0:g}" for value in prisms[:_SHOWN])
            self.warn(
                "prism_changes",
                said("the prism constant changes: {shown_mm} mm", shown_mm=shown_mm),
            )
        ppms = {p.ppm for p in self.pointings if p.sd is not None}
        if ppms == {0.0}:
            text = "ppm is 0 in the whole file: was the atmosphere entered in the instrument?"
            self.warn("ppm_zero", text)


def gathering(path: Path, options: ReadOptions) -> Gathering:
    """An empty gathering for a file, with the foot that was told."""
    from surveyapp.errors import nearest_names
    from surveyapp.io.importers.fieldfiles.units import FOOT, US_FOOT

    kinds = {"us": US_FOOT, "international": FOOT}
    told = options.units.get("foot")
    if told is not None and told not in kinds:
        hint = nearest_names(told, kinds)
        raise SurveyError(Problem("there is no such foot", "`units` foot", told, "", hint))
    foot = FootChoice() if told is None else FootChoice(kinds[told], told=True)
    return Gathering(path.name, options, foot)
