"""Observing without a screen: rows, steps, clock, locks, and what a full disk does."""

from __future__ import annotations

import errno
import os
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.observing.doubts import Doubt
from surveyapp.core.observing.steps import State, Step
from surveyapp.core.observing.typed_rows import EntryError
from surveyapp.domain.readings import Face, ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.observation import session as api_session
from surveyapp.observation.entry import expected, understand
from surveyapp.observation.session import NewRow, SessionDesk
from tests.tui.helpers_tui import Clock, make_project, readings, rows_on_disk


def observation(folder: Path, clock: Clock | None = None) -> SessionDesk:
    clock = clock or Clock()
    return SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)


def point(value: str) -> NewRow:
    return NewRow(ReadingKind.REVERSAL, value, "dms")


def test_the_step_follows_from_the_book_alone(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    first = observation(folder)
    assert first.step is Step.SETUP
    first.go_to(Step.SIGHTS_BEFORE)
    first.record(NewRow(ReadingKind.BACKSIGHT, "175-00-09.0", "dms", face="L"))
    first.go_to(Step.SWING)
    for value in ("102-00-14", "98-01-04", "101-59-08"):
        first.record(point(value))
    first.strike(rows_last(first), "followed too late")
    first.close()
    again = observation(folder)
    assert again.step is Step.SWING
    states = {item.step: item for item in again.steps()}
    assert states[Step.SIGHTS_BEFORE].state is State.BEGUN
    assert states[Step.SWING].count == 2
    again.go_to(Step.ZERO_AFTER)
    again.close()
    assert observation(folder).step is Step.ZERO_AFTER


def rows_last(item: SessionDesk) -> int:
    return item.book.rows[-1].seq


def test_sights_go_through_targets_and_faces(tmp_path: Path) -> None:
    seen = observation(make_project(tmp_path / "p"))
    seen.go_to(Step.SIGHTS_BEFORE)
    what = expected(seen, Step.SIGHTS_BEFORE, None)
    assert (what.target, what.face, what.near) == ("3082", Face.LEFT, None)
    seen.record(NewRow(ReadingKind.BACKSIGHT, "175-00-09.0", "dms", face="L"))
    what = expected(seen, Step.SIGHTS_BEFORE, None)
    assert what.face is Face.RIGHT
    found = understand(seen, "59 48", what, progress=None, stamp=seen.clock.stamp())
    assert found.row.value == "354-59-48"
    assert found.questions == ()


def test_implausible_readings_are_asked_about_and_impossible_ones_refused(tmp_path: Path) -> None:
    seen = observation(make_project(tmp_path / "p"))
    seen.go_to(Step.SIGHTS_BEFORE)
    seen.record(NewRow(ReadingKind.BACKSIGHT, "175-00-09.0", "dms", face="L"))
    what = expected(seen, Step.SIGHTS_BEFORE, None)
    stamp = seen.clock.stamp()
    found = understand(seen, "355-59-48", what, progress=None, stamp=stamp)
    assert [q.doubt for q in found.questions] == [Doubt.FACES_CONTRADICT]
    with pytest.raises(EntryError):
        understand(seen, "361-00-00", what, progress=None, stamp=stamp)
    seen.go_to(Step.SWING)
    for value in ("102-00-14", "98-01-04", "101-59-08", "98-02-30", "101-58-02"):
        seen.record(point(value))
    progress = api_session.progress(seen.project, "r1")
    what = expected(seen, Step.SWING, progress)
    for text, doubt in (("101-57-00", Doubt.WRONG_SIDE), ("98-13-26", Doubt.OUTSIDE_FORECAST)):
        found = understand(seen, text, what, progress=progress, stamp=stamp)
        assert [q.doubt for q in found.questions] == [doubt]
    assert understand(seen, "03 27", what, progress=progress, stamp=stamp).row.value == "98-03-27"


def test_progress_is_what_orient_gives_for_the_same_book(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    seen = observation(folder)
    values = ("102-00-14", "98-01-04", "101-59-08", "98-02-30", "101-58-02", "98-03-27", "101-57-0")
    for count, value in enumerate(values, start=1):
        seen.record(point(value))
        if count >= 3:
            progress = api_session.progress(seen.project, "r1")
            north = api.orient(folder).sessions[0].gyro_north
            assert north is not None
            assert progress.north == north.value
            assert progress.interval95 == north.interval95


def test_the_forecast_after_two_more_points_comes_true_on_average(tmp_path: Path) -> None:
    seen = observation(make_project(tmp_path / "p"))
    for value in ("102-00-14", "98-01-04", "101-59-08", "98-02-30"):
        seen.record(point(value))
    before = api_session.progress(seen.project, "r1")
    for value in ("101-58-02", "98-03-27"):
        seen.record(point(value))
    after = api_session.progress(seen.project, "r1")
    assert before.interval95_two_more is not None
    assert before.interval95 is not None
    assert after.interval95 is not None
    assert before.interval95_two_more < before.interval95
    assert not before.enough(None)
    assert after.enough(after.interval95)


def test_a_clock_set_back_changes_no_elapsed_time(tmp_path: Path) -> None:
    folder, clock = make_project(tmp_path / "p"), Clock()
    seen = observation(folder, clock)
    seen.record(point("102-00-14"))
    clock.pass_by(212.0)
    clock.wall -= timedelta(hours=1)
    assert seen.clock.wall_clock_off_s() == pytest.approx(-3600.0)
    seen.record(point("98-01-04"))
    seen.close()
    rows = rows_on_disk(folder)
    assert float(rows[1]["elapsed_s"]) - float(rows[0]["elapsed_s"]) == pytest.approx(212.0)
    moments = [datetime.fromisoformat(row["time"]) for row in rows]
    assert (moments[1] - moments[0]).total_seconds() == pytest.approx(212.0)
    again = observation(folder, clock)
    assert again.clock.set_back_s == pytest.approx(3600.0)
    clock.pass_by(10.0)
    again.record(NewRow(ReadingKind.REVERSAL, "101-59-08", "dms"))
    assert float(rows_on_disk(folder)[2]["elapsed_s"]) == pytest.approx(222.0)


def test_midnight_and_the_change_of_daylight_saving_are_one_unbroken_time(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    clock = Clock(datetime(2026, 10, 24, 23, 58, tzinfo=timezone(timedelta(hours=2))))
    seen = observation(folder, clock)
    seen.record(point("102-00-14"))
    clock.pass_by(240.0)
    seen.record(point("98-01-04"))
    clock.pass_by(3 * 3600.0)
    clock.wall = clock.wall.astimezone(timezone(timedelta(hours=1)))
    seen.record(point("101-59-08"))
    seen.close()
    times = [datetime.fromisoformat(row["time"]) for row in rows_on_disk(folder)]
    assert times[1].date() > times[0].date()
    assert times[2].utcoffset() == timedelta(hours=1)
    assert (times[2] - times[0]).total_seconds() == pytest.approx(240.0 + 3 * 3600.0)
    assert api.open_project(folder).sessions[0].book.rows[2].elapsed_s == pytest.approx(11040.0)


def test_the_moment_can_be_corrected_across_midnight(tmp_path: Path) -> None:
    clock = Clock(datetime(2026, 3, 2, 0, 0, 20, tzinfo=UTC))
    seen = observation(make_project(tmp_path / "p"), clock)
    seen.go_to(Step.SWING)
    what = expected(seen, Step.SWING, None)
    stamp = seen.clock.stamp()
    found = understand(seen, "102-00-14 @23:59:50", what, progress=None, stamp=stamp)
    assert found.stamp.time == clock.wall - timedelta(seconds=30)
    ago = understand(seen, "102-00-14 @-15", what, progress=None, stamp=stamp)
    assert ago.stamp.time == clock.wall - timedelta(seconds=15)
    with pytest.raises(EntryError, match="future"):
        understand(seen, "102-00-14 @00:10:00", what, progress=None, stamp=stamp)


def test_the_second_opener_reads_and_is_told(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    first, second = observation(folder), observation(folder)
    assert (first.writable, second.writable) == (True, False)
    first.record(point("102-00-14"))
    with pytest.raises(SurveyError, match="open in another program"):
        second.record(point("98-01-04"))
    assert readings(rows_on_disk(folder)) == [("reversal", "102-00-14")]


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_a_read_only_folder_is_read(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    folder.chmod(0o555)
    try:
        assert not observation(folder).writable
    finally:
        folder.chmod(0o755)


@pytest.mark.parametrize("where", ["write", "fsync"])
def test_a_full_disk_loses_nothing_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    folder = make_project(tmp_path / "p")
    seen = observation(folder)
    seen.record(point("102-00-14"))
    whole = (folder / "observations" / "r1.csv").read_bytes()

    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(os, where, full)
        with pytest.raises(SurveyError, match="could not be written"):
            seen.record(point("98-01-04"))
    assert (folder / "observations" / "r1.csv").read_bytes() == whole
    seen.record(point("98-01-04"))
    values = [value for _, value in readings(rows_on_disk(folder))]
    assert values == ["102-00-14", "98-01-04"]


def test_an_older_book_without_moments_and_notes_can_be_observed(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    book = folder / "observations" / "r1.csv"
    book.write_text("seq,kind,value,side\n1,reversal,102-00-14,R\n", encoding="utf-8")
    seen = observation(folder)
    seen.record(NewRow(ReadingKind.REVERSAL, "98-01-04", ""))
    seen.go_to(Step.ZERO_AFTER)
    assert seen.step is Step.ZERO_AFTER
    seen.record(NewRow(ReadingKind.TAPE_ZERO, "3.9", ""))
    assert seen.step is Step.ZERO_AFTER
    assert book.read_text(encoding="utf-8").endswith("2,reversal,98-01-04,\n3,tape_zero,3.9,\n")


def test_the_session_to_go_on_with_is_the_latest_that_was_begun(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    assert api_session.unfinished_session(api.open_project(folder)) is None
    seen = observation(folder)
    seen.go_to(Step.SWING)
    assert api_session.unfinished_session(seen.project) == "r1"
    seen.go_to(Step.RESULT)
    assert api_session.unfinished_session(seen.project) is None
