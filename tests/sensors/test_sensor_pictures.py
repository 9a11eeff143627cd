"""What is drawn of a sensor result, and a log that is taken into a project."""

from __future__ import annotations

import itertools
import math
import shutil
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from surveyapp import api
from surveyapp.core.sensors.charts.results import allan_charts, motion_charts
from surveyapp.domain.chart import Chart, Coverage, Series
from surveyapp.domain.motion import Motion, MotionSegment
from surveyapp.domain.motion import Path as DrivenPath
from surveyapp.errors import SurveyError
from surveyapp.report.blocks import Figure
from surveyapp.report.sections.pictures import chart_figure, picture_blocks
from surveyapp.tui.widgets.chart import chart_text, coverage_text

PROJECTS = Path(__file__).resolve().parents[2] / "projects"


def white_log(path: Path, n: int = 4096) -> Path:
    rng = np.random.default_rng(7)
    rows = "\n".join(f"{k * 0.01:.2f},{v:.6f}" for k, v in enumerate(rng.standard_normal(n)))
    path.write_text(f"t,rate_deg_s\n{rows}\n", encoding="utf-8")
    return path


LOG = api.LogOptions({"time_s": "t", "gyr_x_rad_s": "rate_deg_s"}, {"rate_deg_s": "deg/s"})


def test_the_slope_of_white_noise_is_minus_a_half_in_the_picture(tmp_path: Path) -> None:
    result = api.allan(white_log(tmp_path / "white.csv"), log=LOG)
    (chart,) = allan_charts(result)
    assert isinstance(chart, Chart)
    assert (chart.log_x, chart.log_y) == (True, True)
    (guide,) = (s for s in chart.series if s.name == "slope of N")
    (x0, y0), (x1, y1) = guide.points
    assert math.log(y1 / y0) / math.log(x1 / x0) == pytest.approx(-0.5)
    bounds = [s for s in chart.series if s.style == "bound"]
    middle = chart.series[0].points
    for (_, low), (_, value), (_, high) in zip(
        bounds[0].points, middle, bounds[1].points, strict=True
    ):
        assert low < value < high


def test_a_compass_is_drawn_before_and_after(tmp_path: Path) -> None:
    api.simulate("compass", tmp_path / "c", effects=["hard_iron=12"], seed=3)
    entry = api.open_project(tmp_path / "c").sensor_logs[0]
    result = api.calibrate("compass", tmp_path / "c", sensor=entry.id)
    size, coverage = api.sensor_pictures(result, tmp_path / "c", sensor=entry.id).pictures
    assert isinstance(size, Chart)
    assert isinstance(coverage, Coverage)
    measured, calibrated = size.series
    spread = [float(np.std([y for _, y in s.points])) for s in (measured, calibrated)]
    assert spread[1] < 0.2 * spread[0]  # 12 uT of iron against the noise of a reading
    told = result.geometry.coverage
    cells = np.array(coverage.cells)
    assert told == pytest.approx(np.count_nonzero(cells) / cells.size)
    assert cells.sum() == result.n


def test_an_axis_without_a_number_has_words_and_a_path_one_scale() -> None:
    states = tuple(MotionSegment(k, k + 1.0, "turning") for k in (0.0, 1.0))
    square = (
        (0, 0, 0, 0, 0, 0),
        (1, 1, 0, 0.1, 0.1, 0),
        (2, 1, 1, 0.1, 0.1, 0),
        (3, 0, 1, 0.2, 0.1, 0.02),
    )
    path = DrivenPath("inertial", 0.5, (0.0, 1.0), (1.0,), np.array(square), 3.0)
    drawn = motion_charts(Motion("log", 9, 10.0, states, 0.01, {}, {}, path=path))
    first, way, sigma = drawn
    assert isinstance(first, Chart)
    assert first.y_names[int(first.series[0].points[0][1])] == "turning"
    assert isinstance(way, Chart)
    assert way.square
    assert "0.500" in way.note
    ellipses = [s for s in way.series if s.style == "bound"]
    assert len(ellipses) == 3
    reach = [math.hypot(x - 1.0, y) for x, y in ellipses[0].points]
    assert reach == pytest.approx([0.2447747] * len(reach))  # a circle: 0.1 by sqrt(chi-square)
    # fully correlated: nothing across the line of 0.2 east to 0.1 north
    assert all(abs((y - 1.0) - 0.5 * x) < 1e-6 for x, y in ellipses[-1].points)
    assert isinstance(sigma, Chart)
    assert sigma.series[0].points[1][1] == pytest.approx(math.hypot(0.1, 0.1))
    frame = chart_figure(way)
    assert isinstance(frame, Figure)
    assert len([b for b in picture_blocks(drawn) if isinstance(b, Figure)]) == 3
    for width, height in ((60, 14), (34, 9), (118, 34)):
        for picture in drawn:
            text = chart_text(picture, width=width, height=height).plain  # type: ignore[arg-type]
            assert max(map(len, text.splitlines())) <= width
            assert len(text.splitlines()) <= height


def test_a_straight_line_goes_from_corner_to_corner() -> None:
    chart = Chart("line", "x", "y", (Series("a", ((0.0, 0.0), (10.0, 10.0))),))
    rows = chart_text(chart, width=42, height=16).plain.splitlines()[1:-2]
    drawn = [[i for i, c in enumerate(row) if 0x2800 < ord(c) < 0x2900] for row in rows]
    places = [row for row in drawn if row]
    assert places[0][0] > places[-1][-1]  # top right to bottom left
    assert all(a[0] >= b[0] for a, b in itertools.pairwise(places))


def test_an_unvisited_cell_is_blank() -> None:
    coverage = Coverage("sphere", ((0, 3), (200, 1)))
    text = coverage_text(coverage, width=40).plain
    assert max(map(len, text.splitlines())) <= 40
    upper, lower = (line for line in text.splitlines() if "|" in line)
    assert set(upper.split("|")[1]) == {" "}
    assert set(upper.split("|")[2]) != {" "}
    assert set(lower.split("|")[1]) == {"#"}
    assert any(isinstance(block, Figure) for block in picture_blocks([coverage]))


def test_a_preview_says_what_was_understood_and_what_is_wrong(tmp_path: Path) -> None:
    path = white_log(tmp_path / "white.csv", 50)
    plain = api.preview_sensor_log(path)
    assert any("map.CANON=COLUMN" in text for text in plain.problems)
    good = api.preview_sensor_log(path, log=LOG)
    assert good.problems == ()
    rate = next(c for c in good.columns if c.name == "rate_deg_s")
    assert (rate.canonical, rate.unit, rate.stated) == ("gyr_x_rad_s", "rad/s", True)
    assert rate.factor == pytest.approx(math.pi / 180.0)
    assert good.rate_hz == pytest.approx(100.0)
    text = path.read_text(encoding="utf-8").replace("0.30,", "0.10,")
    path.write_text(text, encoding="utf-8")
    (wrong,) = api.preview_sensor_log(path, log=LOG).problems
    assert "time_s" in wrong


def test_a_log_is_copied_pinned_and_entered_once(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    api.new_project(folder)
    source = white_log(tmp_path / "white noise.csv", 50)
    added = api.add_sensor_log(
        folder,
        source,
        identity="white",
        kind="rate",
        log=LOG,
        latitude_deg=47.0,
        calibrated_on=date(2026, 3, 1),
    )
    assert added.written == "sensors/white.csv"
    (entry,) = api.open_project(folder).sensor_logs
    assert (entry.id, entry.kind, entry.latitude_deg) == ("white", "rate", 47.0)
    assert entry.calibrated_on == date(2026, 3, 1)
    assert api.allan(folder, sensor="white").channels[0].unit == "rad/s"
    (folder / "sensors" / "white.csv").write_text("t,rate_deg_s\n0,1\n", encoding="utf-8")
    with pytest.raises(SurveyError, match="pinned"):
        api.allan(folder, sensor="white")
    with pytest.raises(SurveyError) as caught:
        api.add_sensor_log(folder, source, identity="white", kind="sextant", log=LOG)
    assert len(caught.value.problems) == 2
    assert len(api.open_project(folder).sensor_logs) == 1


def test_a_log_of_the_folder_stays_where_it_is(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    api.new_project(folder)
    (folder / "sensors").mkdir()
    source = white_log(folder / "sensors" / "w.csv", 50)
    assert api.add_sensor_log(folder, source, log=LOG).written == "sensors/w.csv"
    assert [p.name for p in (folder / "sensors").iterdir()] == ["w.csv"]


def test_the_stops_of_the_measured_sample_are_drawn(tmp_path: Path) -> None:
    folder = shutil.copytree(PROJECTS / "xsens-multi-position", tmp_path / "xsens")
    result = api.calibrate("rate", folder, sensor="multi-position")
    made = api.sensor_pictures(result, folder, sensor="multi-position")
    assert set(made.to_dict()) == {"schema", "source", "charts", "coverages"}
    raw, after, attitudes = made.pictures
    assert isinstance(raw, Chart)
    assert isinstance(after, Chart)
    assert isinstance(attitudes, Coverage)
    assert len(raw.series[0].points) == len(after.series[0].points) == len(result.extra["stops"])
    assert sum(map(sum, attitudes.cells)) == len(result.extra["stops"])
    rms = [float(np.sqrt(np.mean([y**2 for _, y in c.series[0].points]))) for c in (raw, after)]
    assert rms == pytest.approx([result.before.rms, result.after.rms], rel=1e-6)
