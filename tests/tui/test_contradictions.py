"""What every command would refuse is not written; a book that came so may still be written on."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.observation.session import NewRow, SessionDesk
from tests.tui.helpers_tui import HEADER, Clock, make_project


def sight(reading: str, face: str) -> NewRow:
    return NewRow(ReadingKind.BACKSIGHT, reading, "dms", face=face)


def point(reading: str) -> NewRow:
    return NewRow(ReadingKind.REVERSAL, reading, "dms")


TRUE_RUN = [point(v) for v in ("102-00-00", "98-00-00", "101-58-00", "98-02-00", "101-56-00")]
CONTRADICTIONS: dict[str, tuple[str, list[NewRow], NewRow, NewRow, str]] = {
    "faces": (
        "tracking",
        [sight("175-00-09", "L")],
        sight("75-00-11", "R"),
        sight("355-00-11", "R"),
        "half a circle apart",
    ),
    "another direction": (
        "tracking",
        [sight("175-00-09", "L")],
        sight("178-00-11", "L"),
        sight("175-00-11", "L"),
        "one direction",
    ),
    "straight up": (
        "tracking",
        [sight("175-00-09", "L")],
        NewRow(ReadingKind.ZENITH, "0-10-00", "dms", face="L"),
        NewRow(ReadingKind.ZENITH, "88-10-00", "dms", face="L"),
        "straight up",
    ),
    "both kinds of rounds": (
        "automatic",
        [NewRow(ReadingKind.AZIMUTH, "45-00-00", "dms")],
        NewRow(ReadingKind.NORTH, "12-00-00", "dms"),
        NewRow(ReadingKind.AZIMUTH, "45-00-20", "dms"),
        "azimuths of the line or readings of north",
    ),
    "two clampings": (
        "amplitude",
        [NewRow(ReadingKind.CLAMP, "100-00-00", "dms")],
        NewRow(ReadingKind.CLAMP, "104-00-00", "dms"),
        NewRow(ReadingKind.CLAMP, "100-00-10", "dms"),
        "clamped at different readings",
    ),
    "no swing": (
        "tracking",
        TRUE_RUN,
        point("90-00-00"),
        point("98-04-00"),
        "do not swing about one middle",
    ),
}


@pytest.mark.parametrize("case", CONTRADICTIONS)
def test_a_contradiction_is_not_written_and_the_right_row_is(tmp_path: Path, case: str) -> None:
    method, before, wrong, right, words = CONTRADICTIONS[case]
    folder = make_project(tmp_path / "p", method)
    clock = Clock()
    desk = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    for row in before:
        clock.pass_by(212.0)
        desk.record(row)
    standing = desk.path.read_bytes()
    clock.pass_by(212.0)
    with pytest.raises(SurveyError, match=words):
        desk.record(wrong)
    assert desk.path.read_bytes() == standing
    desk.record(right)
    assert len(desk.book.rows) == len(before) + 1
    desk.close()


def test_who_finds_the_earlier_row_wrong_strikes_it_and_goes_on(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    clock = Clock()
    desk = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    mistyped = desk.record(sight("75-00-09", "L"))
    with pytest.raises(SurveyError):
        desk.record(sight("355-00-11", "R"))
    desk.strike(mistyped, "digit left out")
    desk.record(sight("355-00-11", "R"))
    with pytest.raises(SurveyError, match="half a circle apart"):
        desk.unstrike(mistyped, "right after all")
    desk.close()


def test_a_book_that_was_wrong_before_is_written_on(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    wrong = "1,,,backsight,175-00-09,dms,L,,,,\n2,,,backsight,75-00-11,dms,R,,,,\n"
    (folder / "observations" / "r1.csv").write_text(HEADER + wrong, encoding="utf-8")
    with pytest.raises(SurveyError, match="half a circle apart"):
        api.orient(folder, session="r1")
    clock = Clock()
    desk = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    desk.record(NewRow(ReadingKind.LEVEL_ALONG, "3", "arcsec"))
    desk.close()
