"""Guided programmes: what is still undetermined agrees with the estimators on the same rows."""

from __future__ import annotations

import csv
import math
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.core.sensors.programmes.catalogue import (
    COMPASS_SWING,
    FOG_STATION,
    MULTI_POSITION,
    PROGRAMMES,
    SIX_POSITION,
    TEMPERATURE,
    TILT_REVERSAL,
    TILT_STATIC,
    TILT_TRANSVERSE,
    TILT_ZERO,
)
from surveyapp.core.sensors.programmes.design import DESIGNS, known_of
from surveyapp.core.sensors.programmes.seen import NEEDED, SEEN, rows_of_log
from surveyapp.core.sensors.programmes.state import state_of, typed_rows
from surveyapp.domain.programme import BEGIN, STRIKE, Programme, ProgrammeEntry, ProgrammeRun, Row
from surveyapp.io.sensor_logs.reading import LogRequest, Need, read_log

START = datetime(2026, 3, 1, 8, 0, tzinfo=UTC)


def run_of(programme: Programme, values: dict[str, str], minutes: float = 0.5) -> ProgrammeRun:
    entries = [ProgrammeEntry(1, START, BEGIN, programme.id)]
    for k, (step, value) in enumerate(values.items(), start=1):
        moment = START + timedelta(minutes=minutes * k)
        entries.append(ProgrammeEntry(k + 1, moment, step, value))
    return ProgrammeRun("r", programme.id, tuple(entries))


def readings(programme: Programme, *parts: str) -> list[Row]:
    steps = [s for s in programme.steps if s.kind == "read" and s.id.startswith(parts)]
    return typed_rows(
        programme, run_of(programme, {s.id: "1 2 3"[: 2 * len(s.asks) - 1] for s in steps})
    )


def test_every_programme_has_a_design_and_every_log_programme_is_looked_for() -> None:
    assert set(DESIGNS) == {p.id for p in PROGRAMMES}
    assert set(SEEN) == set(NEEDED) == {p.id for p in PROGRAMMES if not p.typed}
    for programme in PROGRAMMES:
        ids = [step.id for step in programme.steps]
        assert len(set(ids)) == len(ids)
        assert known_of(programme, []).determined == ()
        for step in programme.steps:
            assert len(step.title) <= 72, step.title
            assert (step.kind == "read") == bool(step.asks)


def test_the_static_test_has_13_points_in_each_of_three_ranges() -> None:
    rows = readings(TILT_STATIC, "static")
    angles = {n: sorted(float(r["angle_deg"]) for r in rows if r["set"] == n) for n in (1, 2, 3)}
    assert {n: len(a) for n, a in angles.items()} == {1: 13, 2: 13, 3: 13}
    assert [a[1] - a[0] for a in angles.values()] == [15.0, 5.0, 2.5]
    assert [(a[0], a[-1]) for a in angles.values()] == [(-90, 90), (-30, 30), (-15, 15)]


LINEARITY = {f"linearity_{span}" for span in (90, 30, 15)}
STABILITY = {"zero_stability", "zero_stability_detrended"}


@pytest.mark.parametrize(
    ("programme", "parts", "missing"),
    [
        (TILT_STATIC, ("static-1-01",), {"zero", "sensitivity", "tilt_reversal", *LINEARITY}),
        (TILT_STATIC, ("static-1-01", "static-1-05"), {"tilt_reversal", *LINEARITY}),
        (TILT_STATIC, ("static-1", "static-2", "static-3", "zero"), set()),
        (TILT_TRANSVERSE, ("static-1", "transverse"), {"tilt_reversal"}),
        (TILT_ZERO, ("static-1", "rest-01", "rest-02", "zero"), STABILITY),
        (TILT_ZERO, ("static-1", "rest", "zero"), set()),
        (TILT_REVERSAL, ("static-1", "reversal-0"), {"tilt_reversal"}),
        (TILT_REVERSAL, ("static-1", "reversal"), set()),
    ],
)
def test_what_a_tilt_test_still_lacks(
    programme: Programme, parts: tuple[str, ...], missing: set[str]
) -> None:
    assert set(known_of(programme, readings(programme, *parts)).undetermined) == missing


def test_nothing_has_a_scale_without_the_static_test() -> None:
    rows = readings(TILT_TRANSVERSE, "transverse", "zero")
    assert known_of(TILT_TRANSVERSE, rows).determined == ()


def test_five_headings_determine_a_to_e_and_four_do_not() -> None:
    rows = readings(COMPASS_SWING, "heading")
    assert known_of(COMPASS_SWING, rows).undetermined == ()
    spread = [rows[k] for k in (0, 2, 5, 7, 10)]
    assert known_of(COMPASS_SWING, spread).undetermined == ()
    quarters = [rows[k] for k in (0, 3, 6, 9)]  # sin 2psi is zero at each of them
    assert known_of(COMPASS_SWING, quarters).undetermined == ("deviation_D",)
    assert known_of(COMPASS_SWING, quarters).rank == 4


def six_position_log(folder: Path) -> tuple[list[str], list[list[str]]]:
    api.simulate("rate", folder, seed=4)
    path = next((folder / "sensors").glob("*.csv"))
    with path.open(encoding="utf-8", newline="") as stream:
        head, *rows = csv.reader(stream)
    return head, rows


@pytest.mark.parametrize(
    "left_out", [(), ("x+", "x-"), ("x-",), ("z+", "y-"), ("x+", "x-", "y+", "y-")]
)
def test_six_positions_lack_what_the_estimator_lacks(
    left_out: tuple[str, ...], tmp_path: Path
) -> None:
    head, rows = six_position_log(tmp_path / "sim")
    place = head.index("position")
    kept = [row for row in rows if row[place] not in left_out]
    path = tmp_path / "part.csv"
    path.write_text("\n".join(",".join(r) for r in (head, *kept)) + "\n", encoding="utf-8")
    columns, optional = NEEDED["six-position"]
    log = read_log(LogRequest(path, "part.csv"), Need(columns=columns, optional=optional))
    found = known_of(SIX_POSITION, rows_of_log("six-position", log))
    result = api.calibrate("rate", path, options={"programme": "six-position"})
    assert set(found.undetermined) == set(result.geometry.undetermined)
    assert set(found.determined) == {p.name for p in result.parameters if p.value is not None}


def test_one_sense_or_part_of_a_turn_determines_nothing() -> None:
    one: dict[str, float | str] = {"position": "z+", "sense": 1.0, "turns": 9.0}
    part: dict[str, float | str] = {"position": "z+", "sense": -1.0, "turns": 0.9}
    assert known_of(SIX_POSITION, [one, part]).determined == ()
    whole = {**part, "turns": 1.0}
    determined = known_of(SIX_POSITION, [one, whole]).determined
    assert set(determined) == {"scale_factor_z", "misalignment_xz", "misalignment_yz"}


def test_the_second_pass_gives_the_scale_factor() -> None:
    first: list[Row] = [{"pass": 1.0, "sense": s, "turns": 3.0, "circle": 1.0} for s in (1.0, -1.0)]
    one = known_of(FOG_STATION, first)
    assert set(one.undetermined) == {"scale_factor"}
    second: list[Row] = [{**row, "pass": 2.0} for row in first]
    assert known_of(FOG_STATION, [*first, *second]).undetermined == ()
    untold = known_of(FOG_STATION, [{**row, "circle": 0.0} for row in first])
    assert set(untold.undetermined) == {"scale_factor", "instrument_constant"}


def test_a_node_lacks_the_axis_that_was_not_turned() -> None:
    rows: list[Row] = [
        {"position": f"{a}+", "temperature_c": node, "sense": s, "turns": 2.0}
        for node in (-10.0, 5.0, 20.0, 30.0, 40.0)
        for a in "xyz"
        for s in (1.0, -1.0)
        if (node, a) != (30.0, "y")
    ]
    assert set(known_of(TEMPERATURE, rows).undetermined) == {"column_y at 30 C", "bias_y at 30 C"}


def stops(count: int) -> list[Row]:
    """Stops on the six faces, then on edges, each turned to from the one before."""
    faces = [(0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, -1), (-1, 0, 0), (0, -1, 0)]
    edges = [(1, 1, 0), (1, 0, 1), (0, 1, 1), (-1, 1, 0), (0, -1, 1), (-1, 0, 1)]
    rows: list[Row] = []
    for k, up in enumerate([*faces, *edges][:count]):
        size = math.sqrt(sum(c * c for c in up))
        row: dict[str, float | str] = {a: c / size for a, c in zip("xyz", up, strict=True)}
        if k:
            row |= {f"turn_{a}": 1.5 if a == "xyz"[k % 3] else 0.1 for a in "xyz"}
        rows.append(row)
    return rows


def test_faces_alone_leave_the_misalignments_of_accelerometers_open() -> None:
    faces = known_of(MULTI_POSITION, stops(6))
    missing = {n for n in faces.undetermined if n.startswith("accelerometer")}
    assert missing == {f"accelerometer_misalignment_{pair}" for pair in ("yx", "zx", "zy")}
    assert not [n for n in known_of(MULTI_POSITION, stops(12)).undetermined if "acc" in n]


def test_the_measured_hand_held_sample_determines_everything() -> None:
    folder = Path(__file__).resolve().parents[2] / "projects" / "xsens-multi-position"
    opened = api.open_sensor_log(folder, sensor="multi-position")
    columns, optional = NEEDED["multi-position"]
    log = opened.file.read(Need(columns=columns, optional=optional, biased=True))
    rows = rows_of_log("multi-position", log)
    result = api.calibrate("rate", folder, sensor="multi-position")
    assert len(rows) == len(result.extra["stops"])
    assert known_of(MULTI_POSITION, rows).undetermined == result.geometry.undetermined == ()
    assert known_of(MULTI_POSITION, rows[:4]).undetermined != ()


def test_a_short_warm_up_is_told_and_the_next_step_is_the_first_open_one() -> None:
    run = run_of(TILT_STATIC, {"mount": "done", "power": "done", "warm-up": "done"}, minutes=4.0)
    state = state_of(TILT_STATIC, run, now=START)
    assert [s.status for s in state.steps[:4]] == ["done", "done", "short", "here"]
    assert state.warnings == ("Warm up 10 min: 4.0 of 10 min",)
    assert state.here is not None
    assert state.here.id == "zero-0"
    waiting = run_of(TILT_STATIC, {"mount": "done", "power": "done"}, minutes=1.0)
    open_wait = state_of(TILT_STATIC, waiting, now=START + timedelta(minutes=5.0))
    assert open_wait.waits_min == pytest.approx(7.0)


def test_a_struck_reading_is_open_again() -> None:
    run = run_of(COMPASS_SWING, {"heading-000": "20 0 -40"})
    struck = ProgrammeEntry(9, START, STRIKE, "2")
    after = ProgrammeRun("r", run.programme, (*run.entries, struck))
    assert len(typed_rows(COMPASS_SWING, run)) == 1
    assert typed_rows(COMPASS_SWING, after) == []


def test_the_example_of_the_page_prints_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    page = Path(__file__).resolve().parents[2] / "docs/how-to/follow-a-guided-programme.md"
    block = page.read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    exec(compile(block, page.name, "exec"), {})
    assert capsys.readouterr().out.strip() == block.rpartition("# ")[2].strip()


def test_the_page_lists_every_programme() -> None:
    page = Path(__file__).resolve().parents[2] / "docs/how-to/follow-a-guided-programme.md"
    text = page.read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line.startswith("| `")]
    assert [row.split("`")[1] for row in rows] == [programme.id for programme in PROGRAMMES]
