"""Field files drawn at random in every dialect: the rows are those of the truth, damaged or not."""

from __future__ import annotations

import math
import random
import re
from collections import Counter
from pathlib import Path

import pytest

from surveyapp.core.fieldfile.reduction import corrected_slope, reduce_file
from surveyapp.errors import SurveyError
from tests.formats.damaging import FREE_COLUMNS, KINDS, damaged, outcome, read, reading
from tests.formats.dialects import DIALECTS, Shot


def _near(found: float | None, wanted: float | None, tolerance: float) -> bool:
    if found is None or wanted is None:
        return found is wanted
    return abs(found - wanted) < tolerance


@pytest.mark.parametrize("form", list(DIALECTS))
def test_every_pointing_is_that_of_the_truth(tmp_path: Path, form: str) -> None:
    """80 surveys: names, faces, angles, lengths, heights, coordinates, and which rows are a set."""
    for seed in range(60):
        written = DIALECTS[form](random.Random(f"{form}{seed}"))
        file = read(tmp_path / "f", written, written.lines)
        assert len(file.pointings) == len(written.shots), written.dialect
        for found, wanted in zip(file.pointings, written.shots, strict=True):
            told = (found.at, found.to, found.face)
            assert told == (wanted.at, wanted.to, wanted.face), written.dialect
            assert found.hz is not None
            assert found.v is not None
            turn = math.remainder(math.degrees(found.hz) - wanted.hz, 360.0)
            assert abs(turn) < 1e-7, written.dialect
            assert abs(math.degrees(found.v) - wanted.v) < 1e-7, written.dialect
            slope = corrected_slope(found, corrected=file.corrected)
            assert _near(slope, wanted.sd, 2e-6), written.dialect
            assert _near(found.hi, wanted.hi, 1e-6), written.dialect
            assert _near(found.ht, wanted.ht, 1e-6), written.dialect
        places = {point.name: point for point in file.points}
        for stand in written.stands:
            if stand.place is not None:
                point = places[stand.name]
                assert (point.e, point.n, point.h) == pytest.approx(stand.place, abs=1e-5)
        if len({p.line for p in file.pointings}) == len(written.shots):
            _check_sets(file.pointings, written.shots, reduce_file(file)[0])


def _check_sets(pointings: tuple, shots: list[Shot], sets: tuple) -> None:  # type: ignore[type-arg]
    """Rows of one round of one set-up, and only those, share a set."""
    named = {line: made.name for made in sets for sight in made.sights for line in sight.lines}
    groups: dict[tuple[int, int], set[str]] = {}
    for pointing, shot in zip(pointings, shots, strict=True):
        groups.setdefault(shot.set, set()).add(named[pointing.line])
    assert all(len(group) == 1 for group in groups.values())
    assert len({min(group) for group in groups.values()}) == len(groups)


def test_tables_without_idle_zeros_are_no_damage(tmp_path: Path) -> None:
    """Spreadsheets drop them: of 100 such tables hardly one looks like one with a short number."""
    refused = 0
    for seed in range(100):
        written = DIALECTS["csv"](random.Random(f"z{seed}"))
        if "dms" in written.dialect:
            continue
        end = r"(?=,|$)" if "','" in written.dialect else r"(?=$|[^0-9.,])"
        lines = [
            re.sub(rf"(\d+[.,]\d*?)0+{end}", lambda found: found[1].rstrip(".,"), line)
            for line in written.lines[1:]
        ]
        try:
            read(tmp_path / "f", written, [written.lines[0], *lines])
        except SurveyError:
            refused += 1
    assert refused <= 5  # binomial, 2 %: 99 %


SILENT = {"gsi": 0.02, "sdr": 0.04, "jobxml": 0.0, "csv": 0.05}
"""Share of cuts, torn ends and joined lines that nothing shows: an end of a name, a whole record
that is gone, a file of two readings. ``python -m bench field_damage`` draws 2000."""


@pytest.mark.parametrize("form", list(DIALECTS))
def test_damage_is_named_or_does_no_harm(tmp_path: Path, form: str) -> None:
    r = random.Random(form)
    found: Counter[str] = Counter()
    for seed in range(40 if form == "csv" else 20):
        written = DIALECTS[form](random.Random(f"d{form}{seed}"))
        if len(written.lines) < 5:
            continue
        file = read(tmp_path / "f", written, written.lines)
        truth = Counter(reading(p) for p in file.pointings)
        for kind in KINDS:
            if form in FREE_COLUMNS and kind in ("drop", "double"):
                continue
            made = damaged(written.lines, kind, r)
            if made is None:
                continue
            what = outcome(tmp_path / "f", written, truth, made, kind=kind)
            assert what != "wrong", (written.dialect, kind, made[1])
            if kind in ("cut", "torn", "join"):
                found[what] += 1
    assert found["silent"] <= SILENT[form] * found.total()
    assert found["named"] > 0.5 * found.total() or form == "jobxml"
