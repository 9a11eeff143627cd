"""The entry line never guesses: pending text keeps its kind, doubtful moments and values are asked.

The cases were seen on 2026-11-28: a forgotten sight became a supply voltage, a stated moment before
the last row stood in the book with an elapsed time that did not increase.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.widgets import Static

from surveyapp import api
from surveyapp.core.observing.doubts import Doubt
from surveyapp.core.observing.steps import Step
from surveyapp.core.observing.typed_rows import EntryError
from surveyapp.domain.readings import ReadingKind
from surveyapp.errors import SurveyError
from surveyapp.observation.entry import expected, understand
from surveyapp.observation.session import NewRow, SessionDesk, progress
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.entry_desk import Desk, NotWrittenError
from surveyapp.tui.screens.session import SessionScreen
from surveyapp.tui.views.progress import countdown_text, forecast_text
from surveyapp.tui.widgets.entry import EntryLine
from tests.tui.helpers_tui import SMALL, Clock, make_project, open_session, rows_on_disk

POINTS = ("102-00-14", "98-01-04", "101-59-08", "98-02-30")
HALF_SWING_S = 212.7


def desk_at(
    tmp_path: Path, step: Step = Step.SWING, method: str = "tracking"
) -> tuple[Desk, Clock, Path]:
    folder, clock = make_project(tmp_path / "p", method), Clock()
    observation = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
    observation.go_to(step)
    return Desk(observation), clock, folder


def type_points(desk: Desk, clock: Clock, texts: tuple[str, ...] = POINTS) -> None:
    for text in texts:
        desk.typing(text)
        assert desk.enter(text).startswith("on disk")
        clock.pass_by(HALF_SWING_S)


def doubts(desk: Desk, text: str, kind: ReadingKind | None = None) -> list[Doubt]:
    seen = desk.observation
    what = expected(seen, seen.step, None, kind)
    found = understand(seen, text, what, progress=None, stamp=seen.clock.stamp())
    return [item.doubt for item in found.questions]


def told(screen: SessionScreen) -> str:
    return str(screen.query_one("#message", Static).content)


async def test_a_forgotten_sight_never_becomes_a_supply(tmp_path: Path) -> None:
    """As in sight-became-supply-g1.csv: back at the sights after the swing has begun, then F8."""
    desk, clock, folder = desk_at(tmp_path)
    type_points(desk, clock, POINTS[:1])
    desk.observation.close()
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await pilot.press("f7", "f7", "f7", *"175-00-09", "enter")
        await pilot.pause()
        assert told(screen).startswith("not written: the swing has begun")
        for key in ("f8", "f8", "f7", "f2", "f5", "enter", "f8"):
            await pilot.press(key)
            await pilot.pause()
            assert told(screen).startswith("not written"), key
            assert screen.desk.step is Step.SIGHTS_BEFORE
            assert screen.query_one(EntryLine).text == "175-00-09"
        assert "Ctrl+Z clears" in told(screen)
        assert "Enter writes" not in told(screen)
        await pilot.press("ctrl+z")
        await pilot.pause()
        assert screen.query_one(EntryLine).text == ""
        assert not screen.observation.book.struck, "the first Ctrl+Z clears the line alone"
        await pilot.press("f8")
        await pilot.pause()
        assert screen.desk.step is Step.ZERO_BEFORE
    assert [row["value"] for row in rows_on_disk(folder) if row["value"]] == ["102-00-14"]


async def test_a_text_left_half_typed_comes_back_for_what_it_was_typed_for(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=SMALL) as pilot:
        screen = await open_session(pilot)
        await pilot.press("f8", *"179-01-56", "escape", "escape")
        await pilot.pause()
        other = SessionDesk(folder, "r1")
        other.go_to(Step.RUN_UP)
        other.close()
        screen = await open_session(pilot)
        assert screen.query_one(EntryLine).text == "179-01-56"
        await pilot.press("enter")
        await pilot.pause()
        assert "typed as sight, and supply is asked for" in told(screen)
    assert not [row for row in rows_on_disk(folder) if row["value"]]


def test_a_moment_before_the_point_above_is_refused_and_elapsed_follows(tmp_path: Path) -> None:
    """As in time-backwards-r2.csv."""
    desk, clock, folder = desk_at(tmp_path)
    type_points(desk, clock, POINTS[:3])
    text = "98-02-30@08:02:00"
    desk.typing(text)
    for _ in range(2):
        with pytest.raises(NotWrittenError, match="does not lie behind"):
            desk.enter(text)
    assert len(desk.observation.book.of_kind(ReadingKind.REVERSAL)) == 3
    clock.pass_by(30.0)
    desk.typing("98-02-30@-30")
    assert desk.enter("98-02-30@-30").startswith("on disk")
    row = rows_on_disk(folder)[-1]
    assert float(row["elapsed_s"]) == pytest.approx(3 * HALF_SWING_S, abs=0.002)


def test_a_row_without_a_moment_between_hides_no_moment_that_goes_back(tmp_path: Path) -> None:
    desk, clock, _ = desk_at(tmp_path)
    type_points(desk, clock, POINTS[:1])
    clock.pass_by(1.0 - HALF_SWING_S)
    desk.typing(POINTS[1])
    assert "without a moment" in desk.enter(POINTS[1])
    for text in ("101-59-08@-20", "101-59-08@07:00:00"):
        desk.typing(text)
        for _ in range(2):
            with pytest.raises(NotWrittenError, match="does not lie behind"):
                desk.enter(text)


def test_another_reading_of_an_earlier_moment_is_asked_about(tmp_path: Path) -> None:
    desk, clock, folder = desk_at(tmp_path, Step.RUN_UP)
    desk.typing("12.4")
    desk.enter("12.4")
    clock.pass_by(600.0)
    text = "12.3@08:00:00"
    clock.pass_by(600.0)
    desk.observation.record(NewRow(ReadingKind.TEMPERATURE, "18", "C"))
    desk.typing(text)
    with pytest.raises(NotWrittenError, match="1200 s before the last row"):
        desk.enter(text)
    assert desk.enter(text).startswith("on disk")
    row = rows_on_disk(folder)[-1]
    assert row["time"].startswith("2026-03-02T08:00:00")
    assert row["elapsed_s"] == "", "elapsed seconds never go back in a book"
    api.open_project(folder)


def test_a_text_keeps_its_moment_only_until_it_is_changed(tmp_path: Path) -> None:
    desk, clock, _ = desk_at(tmp_path)
    desk.typing("4")
    begun = desk.pending
    assert begun is not None
    clock.pass_by(8.0)
    for text in ("40", "400-00-00", "400-00-0", "400-00-00"):
        desk.typing(text)
    assert desk.pending is not None
    assert desk.pending.stamp == begun.stamp, "typing on is the same reading"
    with pytest.raises(NotWrittenError):
        desk.enter("400-00-00")
    clock.pass_by(50.0)
    desk.typing("100-00-00")
    assert desk.pending.stamp.elapsed_s == pytest.approx(begun.stamp.elapsed_s + 58.0)


@pytest.mark.parametrize(
    ("step", "kind", "good", "odd", "doubt"),
    [
        (Step.RUN_UP, ReadingKind.SUPPLY, "12.4", "163.7040", Doubt.OUTSIDE_RANGE),
        (Step.RUN_UP, ReadingKind.SUPPLY, "400 Hz", "20 Hz", Doubt.OUTSIDE_RANGE),
        (Step.RUN_UP, ReadingKind.TEMPERATURE, "-12", "-40", Doubt.OUTSIDE_RANGE),
        (Step.SETUP, ReadingKind.LEVEL_ALONG, "-12", "1200", Doubt.OUTSIDE_RANGE),
        (Step.SIGHTS_BEFORE, ReadingKind.ZENITH, "88-10-00", "271-50-00", Doubt.ZENITH_FACE),
        (Step.SIGHTS_BEFORE, ReadingKind.ZENITH, "88-10-00", "8-10-00", Doubt.OUTSIDE_RANGE),
    ],
)
def test_what_the_instrument_cannot_have_is_asked_about(
    tmp_path: Path, step: Step, kind: ReadingKind, good: str, *, odd: str, doubt: Doubt
) -> None:
    desk, _, _ = desk_at(tmp_path, step)
    assert doubts(desk, good, kind) == []
    assert doubts(desk, odd, kind) == [doubt]


def test_the_range_of_the_card_wins(tmp_path: Path) -> None:
    folder = make_project(tmp_path / "p")
    path = folder / "project.toml"
    text = path.read_text("utf-8")
    ranges = "scale_value_arcsec = 600.0\nrange = { supply_v = [11.0, 13.0], level_arcsec = 20.0 }"
    path.write_text(text.replace("scale_value_arcsec = 600.0", ranges), "utf-8")
    desk = Desk(SessionDesk(folder, "r1"))
    assert doubts(desk, "30", ReadingKind.LEVEL_ALONG) == [Doubt.OUTSIDE_RANGE]
    desk.observation.go_to(Step.RUN_UP)
    assert doubts(desk, "12") == []
    assert doubts(desk, "14") == [Doubt.OUTSIDE_RANGE]


def test_moments_are_compared_with_the_half_swing_of_the_card(tmp_path: Path) -> None:
    desk, clock, _ = desk_at(tmp_path)
    type_points(desk, clock, POINTS[:2])
    assert doubts(desk, POINTS[2]) == []
    clock.pass_by(-HALF_SWING_S + 19.0)
    assert doubts(desk, POINTS[2]) == [Doubt.HALF_SWING]  # as in run-of-38s
    clock.pass_by(2.0 * HALF_SWING_S - 19.0)
    assert doubts(desk, "98-02-30") == [Doubt.HALF_SWING], "one point was missed"
    desk.missed()
    assert doubts(desk, "98-02-30") == []


def test_points_typed_in_one_go_have_no_moment_and_say_so(tmp_path: Path) -> None:
    desk, clock, folder = desk_at(tmp_path)
    for number, text in enumerate(POINTS):
        desk.typing(text)
        said = desk.enter(text)
        assert ("without a moment" in said) == (number > 0)
        clock.pass_by(1.0)
    rows = [row for row in rows_on_disk(folder) if row["kind"] == "reversal"]
    assert [bool(row["elapsed_s"]) for row in rows] == [True, False, False, False]
    api.open_project(folder)


def test_after_one_turning_point_no_side_is_announced(tmp_path: Path) -> None:
    for method, first in (("tracking", "102-00-14"), ("amplitude", "6.5")):
        folder, clock = make_project(tmp_path / method, method), Clock()
        seen = SessionDesk(folder, "r1", now=clock.now, steady=clock.steady)
        seen.go_to(Step.SWING)
        desk = Desk(seen)
        if method == "amplitude":
            seen.record(NewRow(ReadingKind.CLAMP, "100-00-00", "dms"))
            desk.kind = ReadingKind.SCALE_REVERSAL
        desk.typing(first)
        desk.enter(first)
        assert desk.what().side is None, method
        assert " R" not in desk.prompt()
        assert " L" not in desk.prompt()
        judged = progress(seen.project, "r1")
        assert countdown_text(judged, 100.0).startswith("next point in 1:40")
        assert countdown_text(judged, None) == "next point overdue (F5: missed)"
        assert forecast_text(judged, desk.unit) == ""


def test_a_key_asks_about_a_doubtful_text_and_enter_keeps_it_as_is_said(tmp_path: Path) -> None:
    desk, _, folder = desk_at(tmp_path, Step.RUN_UP)
    desk.kind = ReadingKind.SUPPLY
    desk.typing("163")
    said = desk.obstacle("F8")
    assert "outside of 1 V to 130 V. Enter keeps it, Ctrl+Z clears it, then F8" in said
    assert desk.enter("163").startswith("on disk")
    assert rows_on_disk(folder)[-1]["kind"] == "supply"


def test_a_sight_read_as_the_other_face_is_asked_about_as_such(tmp_path: Path) -> None:
    desk, clock, _ = desk_at(tmp_path, Step.SIGHTS_BEFORE)
    assert doubts(desk, "179-01-56") == []
    type_points(desk, clock, ("179-01-56",))
    assert doubts(desk, "179-01-57") == [Doubt.SIGHT_FACE]
    type_points(desk, clock, ("359-02-12",))
    assert doubts(desk, "359-02-12") == [Doubt.SIGHT_FACE]
    assert doubts(desk, "179-21-56") == [Doubt.SIGHT_MOVED]


def test_a_strike_is_taken_back_and_both_stay_in_the_book(tmp_path: Path) -> None:
    desk, clock, folder = desk_at(tmp_path)
    type_points(desk, clock)
    desk.undo()
    assert len(desk.observation.book.of_kind(ReadingKind.REVERSAL)) == 3
    (struck,) = desk.struck()
    assert "counts again" in desk.unstrike(struck.seq, "it was right")
    assert [row.text for row in desk.observation.book.of_kind(ReadingKind.REVERSAL)] == list(POINTS)
    kinds = [row["kind"] for row in rows_on_disk(folder)]
    assert kinds[-2:] == ["strike", "unstrike"]
    with pytest.raises(NotWrittenError, match="not struck"):
        desk.unstrike(struck.seq, "again")
    desk.strike(struck.seq, "no, it was wrong")
    assert len(desk.observation.book.of_kind(ReadingKind.REVERSAL)) == 3
    assert len(api.open_project(folder).sessions[0].book.struck) == 1


def test_a_struck_point_is_accepted_on_its_own_side_with_its_own_moment(tmp_path: Path) -> None:
    desk, clock, folder = desk_at(tmp_path)
    type_points(desk, clock, (*POINTS, "101-58-02"))
    read_at = desk.observation.book.of_kind(ReadingKind.REVERSAL)[3].time
    desk.strike(desk.observation.book.of_kind(ReadingKind.REVERSAL)[3].seq, "typing error")
    desk.typing("98-02-20")
    assert desk.enter("98-02-20").startswith("on disk"), "no doubt about its side"
    points = desk.observation.book.of_kind(ReadingKind.REVERSAL)
    assert [row.text for row in points][3] == "98-02-20"
    assert points[3].time == read_at
    api.diagnose(folder, session="r1", log=False)  # moments in order: no command refuses it


def test_a_point_typed_anew_at_once_keeps_the_moment_of_the_first(tmp_path: Path) -> None:
    desk, clock, _ = desk_at(tmp_path)
    type_points(desk, clock, POINTS[:3])
    clock.pass_by(-HALF_SWING_S + 15.0)
    desk.undo()
    assert desk.what().number == 3
    desk.typing("101-59-18")
    assert desk.enter("101-59-18").startswith("on disk")
    row = desk.observation.book.of_kind(ReadingKind.REVERSAL)[2]
    assert row.elapsed_s == pytest.approx(2 * HALF_SWING_S, abs=0.002)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("179-01-56,5", "179-01-56.5"),
        ("179-01-56,5@-0,5", "179-01-56.5"),
        ("1,25", "1.25"),
        ("-,5", "-.5"),
    ],
)
def test_a_comma_is_a_decimal_sign_in_the_line(tmp_path: Path, text: str, value: str) -> None:
    step = Step.SIGHTS_BEFORE if "-01-" in text else Step.ZERO_BEFORE
    desk, clock, folder = desk_at(tmp_path, step)
    clock.pass_by(2.0)
    desk.typing(text)
    desk.enter(text)
    row = rows_on_disk(folder)[-1]
    assert row["value"] == value
    assert row["elapsed_s"] == ("1.500" if "@" in text else "2.000")


@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [
        ("24,1 \u0412", "24.1", "V"),
        ("400 \u0413\u0446", "400", "Hz"),
        ("\uff12\uff14\uff0c\uff11", "24.1", "V"),
        ("\u0662\u0664", "24", "V"),  # stood in the book as it was typed
    ],
)
def test_a_supply_typed_on_any_keyboard_stands_in_the_book_as_numbers(
    tmp_path: Path, text: str, value: str, unit: str
) -> None:
    desk, _, folder = desk_at(tmp_path, Step.RUN_UP)
    desk.kind = ReadingKind.SUPPLY
    desk.typing(text)
    assert desk.enter(text).startswith("on disk")
    row = rows_on_disk(folder)[-1]
    assert (row["value"], row["unit"]) == (value, unit)


def test_two_commas_are_no_number(tmp_path: Path) -> None:
    desk, _, _ = desk_at(tmp_path, Step.ZERO_BEFORE)
    with pytest.raises(EntryError):
        doubts(desk, "1,234,5")
    with pytest.raises(EntryError):
        doubts(desk, "1.234,5")


def test_a_passage_struck_before_others_is_not_replaced_by_a_later_one(tmp_path: Path) -> None:
    desk, clock, folder = desk_at(tmp_path, method="transit")
    seen = desk.observation
    seen.record(NewRow(ReadingKind.CLAMP, "100-00-00", "dms"))
    seqs = []
    for _ in range(3):
        clock.pass_by(200.0)
        seqs.append(seen.record(NewRow(ReadingKind.TRANSIT, "0", "div")))
    seen.strike(seqs[1], "mistimed")
    clock.pass_by(200.0)
    last = seen.record(NewRow(ReadingKind.TRANSIT, "0", "div"))
    live = [row.seq for row in seen.book.of_kind(ReadingKind.TRANSIT)]
    assert live == [seqs[0], seqs[2], last]
    with pytest.raises(SurveyError, match="does not lie behind"):
        seen.record(NewRow(ReadingKind.TRANSIT, "0", "div"))
    assert api.open_project(folder).sessions[0].book.of_kind(ReadingKind.TRANSIT)[-1].seq == last


def test_the_axis_not_yet_read_is_proposed(tmp_path: Path) -> None:
    desk, _, folder = desk_at(tmp_path, Step.SETUP)
    for value in ("3", "-2", "4"):
        desk.typing(value)
        assert desk.enter(value).startswith("on disk")
    assert desk.what().kind is ReadingKind.LEVEL_ACROSS
    kinds = [row["kind"] for row in rows_on_disk(folder) if row["kind"].startswith("level")]
    assert kinds == ["level_along", "level_across", "level_along"]
