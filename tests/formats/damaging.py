"""Damage to field files, and what an importer makes of it: named, harmless, or a silent error."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from surveyapp.domain.fieldfile import FieldFile, Pointing
from surveyapp.errors import SurveyError
from surveyapp.io.importers.fieldfiles.gathering import ReadOptions
from surveyapp.io.importing.traverse import read_traverse_file
from tests.formats.dialects import Written

KINDS = ("cut", "garble", "torn", "join", "drop", "double", "blank")
FREE_COLUMNS = ("csv", "jobxml")
"""Formats in which a digit that is lost or doubled inside a number cannot be seen."""

Reading = tuple[str | float | None, ...]


def reading(p: Pointing) -> Reading:
    """What must not change: everything that enters the book."""
    numbers = (p.hz, p.v, p.sd, p.hi, p.ht)
    return (p.at, p.to, p.face, *(None if x is None else round(x, 9) for x in numbers))


def read(file: Path, written: Written, lines: Sequence[str], *, skip: bool = False) -> FieldFile:
    """Read lines of a written file."""
    file.write_bytes((written.end.join(lines) + written.end).encode("latin-1"))
    options: Mapping[str, Any] = written.options
    told = ReadOptions(
        skip,
        options.get("station_code"),
        options.get("columns", {}),
        options.get("units", {}),
    )
    return read_traverse_file(written.form, file, told)


def damaged(lines: Sequence[str], kind: str, r: random.Random) -> tuple[list[str], int] | None:
    """Damaged lines and the place of the damage; None where there is nothing to damage."""
    i = r.randrange(len(lines))
    line, made = lines[i], list(lines)
    if len(line) < 2 or (kind == "join" and i + 1 == len(lines)):
        return None
    c = r.randrange(1, len(line))
    if kind == "join":
        made[i : i + 2] = [line + lines[i + 1]]
    elif kind == "torn":
        made = [*lines[:i], line[:c]]
    else:
        made[i] = {
            "cut": line[:c],
            "garble": line[:c] + r.choice("#?O~ ") + line[c + 1 :],
            "drop": line[:c] + line[c + 1 :],
            "double": line[:c] + line[c] + line[c:],
            "blank": line[:c] + " " * min(6, len(line) - c) + line[c + 6 :],
        }[kind]
    return made, i


def outcome(
    file: Path, written: Written, truth: Counter[Reading], made: tuple[list[str], int], *, kind: str
) -> str:
    """``named``, ``refused``, ``harmless``, ``missing`` or ``silent``; ``wrong`` with skip."""
    lines, place = made
    try:
        got = Counter(reading(p) for p in read(file, written, lines).pointings)
    except SurveyError as error:
        where = {problem.where for problem in error.problems}
        named = where == {f"{file.name}, line {place + 1}"}
        try:
            rest = read(file, written, lines, skip=True).pointings
        except SurveyError:
            rest = ()
        if Counter(reading(p) for p in rest) - truth:
            return "wrong"
        return "named" if named else "refused"
    if got - truth:
        return "silent"
    return "harmless" if got == truth or kind == "torn" else "missing"
