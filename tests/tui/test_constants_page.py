"""The instrument constant through time is drawn: bars, mean, days or order; tests in words."""

from __future__ import annotations

import math
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from textual.widgets import Static

from surveyapp import api
from surveyapp.core.improvement import most_helpful
from surveyapp.core.observing.clamped_outlook import SWING_SOURCES
from surveyapp.core.orientation.adopted import SOURCE as ADOPTED
from surveyapp.core.orientation.constant_axis import EPOCH, calendar_moment, constant_axis
from surveyapp.core.orientation.predicted_constant import CAUSE, SCATTER
from surveyapp.core.orientation.terms import TERMS
from surveyapp.domain.results import BudgetLine, ConstantResult, Determination
from surveyapp.report.sections.improvement import ADVICE
from surveyapp.tui import texts
from surveyapp.tui.app import SurveyApp
from surveyapp.tui.widgets.constants import ConstantCanvas, ConstantPlot, draw_constant
from surveyapp_models.angles import ARCSEC
from tests.tui.helpers_tui import LARGE, SMALL

PROJECTS = Path(__file__).resolve().parents[2] / "projects"
CORE = Path(api.__file__).parents[1] / "core"
MARCH_2 = 1772409600.0  # 2026-03-02 00:00 UTC
DAY = 86400.0


def determination(value: float, moment_s: float | None, target: str = "B") -> Determination:
    return Determination(
        session=f"s{moment_s}",
        station="A",
        target=target,
        value=value * ARCSEC,
        sigma=5.0 * ARCSEC,
        moment_s=moment_s,
        phase="before",
        known_azimuth=0.0,
        from_coordinates=None,
    )


def constant(*items: Determination, value: float = 0.0) -> ConstantResult:
    return ConstantResult(
        instrument="G1",
        value=value * ARCSEC,
        sigma=3.0 * ARCSEC,
        interval95=6.0 * ARCSEC,
        count=len(items),
        stable=True,
        choice="pooled",
        by_line=(),
        determinations=items,
    )


def where(drawing: str, sign: str) -> list[tuple[int, int]]:
    rows = drawing.split("\n")[:-2]
    return [
        (row, column) for row, line in enumerate(rows) for column, c in enumerate(line) if c == sign
    ]


def test_days_are_to_scale_and_larger_constants_stand_higher() -> None:
    items = (
        determination(-20.0, MARCH_2),
        determination(0.0, MARCH_2 + DAY),
        determination(20.0, MARCH_2 + 10 * DAY),
    )
    drawing = draw_constant(constant(*items), 78, 14).plain
    points = sorted(where(drawing, "●"), key=lambda place: place[1])
    (low, first), (middle, second), (high, third) = points
    assert low > middle > high
    assert (third - first) == pytest.approx(10 * (second - first), abs=6)
    assert "2026-03-08" in drawing
    assert texts.CONSTANT_DAYS in drawing
    assert max(map(len, drawing.split("\n"))) <= 78


def test_bars_reach_one_sigma_and_no_further() -> None:
    items = (determination(-5.0, 1.0), determination(5.0, 2.0, "C"))
    drawing = draw_constant(constant(*items), 60, 23).plain
    rows = drawing.split("\n")[:20]
    (_, column), *_ = where(drawing, "●")
    filled = [row for row, line in enumerate(rows) if line[column] not in " ⠀"]
    span = max(filled) - min(filled)
    whole = 20.0 * 1.16  # both bars from -10 to +10, and the margins
    assert span == pytest.approx(10.0 / whole * 20, abs=1.6)
    assert where(drawing, "○")


def test_without_days_the_order_is_the_axis() -> None:
    axis = constant_axis((determination(1.0, None), determination(2.0, None)), most_ticks=5)
    assert not axis.dated
    assert axis.places == (1.0, 2.0)
    assert [label for _, label in axis.ticks] == ["1", "2"]
    stated = constant_axis((determination(1.0, 3.0), determination(2.0, 7.0)), most_ticks=5)
    assert not stated.dated
    assert stated.places == (3.0, 7.0)


def test_dates_and_moments_mean_the_same_day() -> None:
    by_date = calendar_moment(MARCH_2 + EPOCH)
    by_time = calendar_moment(MARCH_2)
    assert by_date is not None
    assert by_date == by_time
    assert by_date.isoformat().startswith("2026-03-02")
    assert calendar_moment(5.0) is None


def test_a_span_without_a_round_day_is_labelled_at_its_ends() -> None:
    items = (determination(1.0, MARCH_2 + 100.0), determination(2.0, MARCH_2 + 700.0))
    axis = constant_axis(items, most_ticks=5)
    assert [place for place, _ in axis.ticks] == [MARCH_2 + 100.0, MARCH_2 + 700.0]


def test_an_unknown_sigma_and_equal_values_can_be_drawn() -> None:
    bare = replace(determination(3.0, None), sigma=math.inf)
    drawing = draw_constant(constant(bare, bare, value=3.0), 60, 12).plain
    assert len(where(drawing, "●")) == 2
    assert draw_constant(constant(), 60, 12).plain == ""
    assert draw_constant(constant(bare), 20, 4).plain == ""


@pytest.mark.parametrize("size", [SMALL, LARGE])
async def test_the_page_draws_and_says_how_it_was_tested(
    tmp_path: Path, size: tuple[int, int]
) -> None:
    folder = shutil.copytree(PROJECTS / "tongjin-2015", tmp_path / "p")
    app = SurveyApp(str(folder))
    async with app.run_test(size=size) as pilot:
        await app.workers.wait_for_complete()
        await pilot.press("3")
        await pilot.pause()
        plot = app.screen.query_one(ConstantPlot)
        told = str(plot.query_one("#constant-told", Static).content)
        canvas = plot.query_one(ConstantCanvas)
        assert canvas.size.height >= 9
        drawing = canvas.render().plain
    assert "NOT MET" in told
    assert '14.59" apart' in told
    assert "●" in drawing
    assert "○" in drawing
    assert "G3024-G3022" in drawing


def test_what_helps_most_is_the_largest_part_and_the_rest_is_what_remains() -> None:
    budget = (
        BudgetLine("rounds", 3.0, 0.2, name="rounds"),
        BudgetLine("constant: sights", 6.0, 0.7, name="sights", at_calibration=True),
        BudgetLine("centring", 2.0, 0.1, name="centring"),
    )
    found = most_helpful(budget)
    assert found is not None
    assert (found.source, found.at_calibration) == ("sights", True)
    assert found.sigma == pytest.approx(7.0)
    assert found.without == pytest.approx(math.sqrt(13.0))
    assert most_helpful(()) is None


def test_every_source_of_error_has_an_advice() -> None:
    import re

    sources = "\n".join(path.read_text("utf-8") for path in CORE.rglob("*.py"))
    names = set(re.findall(r'\bSource\(\s*"([^"]+)"', sources))
    assert len(names) > 10
    adopted = {ADOPTED, f"{ADOPTED} outside its range"}
    told = names | set(SWING_SOURCES) | adopted | set(TERMS) | {CAUSE, SCATTER}
    assert told <= set(ADVICE)
