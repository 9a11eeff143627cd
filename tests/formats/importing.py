"""A project folder, an import into it, and what must come out of simulated pointings."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest

from surveyapp import api
from surveyapp.domain.fieldfile import ImportResult
from tests.formats.field_writers import Sight, mean_direction


def project(folder: Path, more: str = "") -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "project.toml").write_text(f'format = 1\nname = "t"\n{more}', encoding="utf-8")
    return folder


def field_file(folder: Path, name: str, lines: list[str], end: str = "\n") -> Path:
    path = folder / name
    path.write_bytes((end.join(lines) + end).encode("utf-8"))
    return path


def bring(
    tmp_path: Path, form: str, lines: list[str], *, more: str = "", **options: Any
) -> tuple[Path, ImportResult]:
    """Write a field file and import it into a new project as traverse main."""
    tmp_path.mkdir(exist_ok=True)
    folder = project(tmp_path / "p", more)
    path = field_file(tmp_path, f"field.{form}", lines)
    return folder, api.import_file(form, path, folder, traverse="main", **options)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def tree(folder: Path) -> dict[str, bytes]:
    """Every file of a folder, the lock left out."""
    return {
        p.relative_to(folder).as_posix(): p.read_bytes()
        for p in sorted(folder.rglob("*"))
        if p.is_file() and not p.name.startswith(".")
    }


def check_rows(folder: Path, sights: list[Sight], angle: float, length: float) -> None:
    """Book against the mean of the faces of the truth, within what the format rounds away."""
    found: dict[tuple[str, str, str], list[dict[str, str]]] = {}
    for row in rows(folder / "observations" / "main.csv"):
        found.setdefault((row["kind"], row["at"], row["to"]), []).append(row)
    pairs: dict[tuple[int, int, str], dict[str, Sight]] = {}
    for s in sights:
        pairs.setdefault((s.setup, s.round, s.to), {})[s.face] = s
    sets: dict[tuple[int, int], set[str]] = {}
    for (setup, number, to), faces in pairs.items():
        left, right = faces["L"], faces["R"]
        wanted = (
            ("direction", mean_direction(left.hz, right.hz), angle),
            ("zenith", (left.v + 360 - right.v) / 2, angle),
            ("slope_distance", (left.sd + right.sd) / 2, length),
        )
        for kind, value, tolerance in wanted:
            row = found[kind, left.at, to][number]
            assert float(row["value"]) == pytest.approx(value, abs=tolerance)
            assert float(row["hi"]) == pytest.approx(left.hi, abs=5e-4)
            assert float(row["ht"]) == pytest.approx(left.ht, abs=5e-4)
            sets.setdefault((setup, number), set()).add(row["set"])
    names = [name for group in sets.values() for name in group]
    assert len(names) == len(set(names)) == len(sets)
    assert sum(len(group) for group in found.values()) == 3 * len(pairs)
