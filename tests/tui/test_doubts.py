"""What is asked about before it is written: tape zeros, clamp readings, zenith angles, rounds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveyapp.core.observing.doubts import Doubt, doubt_round
from surveyapp.core.observing.steps import Step
from surveyapp.core.observing.zero_forecast import forecast_zero
from surveyapp.core.simulate.session import simulate_sessions
from surveyapp.core.simulate.specification import SessionSpec
from surveyapp.domain.project import Method
from surveyapp.domain.readings import Face, Reading, ReadingKind, Side
from surveyapp.observation.entry import expected, understand
from surveyapp.observation.session import NewRow, SessionDesk
from surveyapp_models.angles import ARCSEC
from tests.tui.helpers_tui import Clock, make_project


def observation(folder: Path, method: Method = "tracking") -> SessionDesk:
    clock = Clock()
    return SessionDesk(make_project(folder, method), "r1", now=clock.now, steady=clock.steady)


def asked(seen: SessionDesk, step: Step, text: str, kind: ReadingKind | None = None) -> list[Doubt]:
    what = expected(seen, step, None, kind)
    found = understand(seen, text, what, progress=None, stamp=seen.clock.stamp())
    return [question.doubt for question in found.questions]


@pytest.mark.parametrize("step", [Step.ZERO_BEFORE, Step.ZERO_AFTER])
def test_tape_zeros_are_compared_with_the_swing_of_the_mark(tmp_path: Path, step: Step) -> None:
    """The numbers are those of a record of 1966: +11.4 -7.4 +10.9 -7.1 +10.4 -6.8."""
    seen = observation(tmp_path / "p")
    if step is Step.ZERO_AFTER:
        for value in ("102-00-14", "98-01-04", "101-59-08"):
            seen.record(NewRow(ReadingKind.REVERSAL, value, "dms"))
    seen.go_to(step)
    assert asked(seen, step, "114") == [Doubt.OFF_SCALE]
    for value in ("11.4", "-7.4"):
        assert asked(seen, step, value) == []
        seen.record(NewRow(ReadingKind.TAPE_ZERO, value, "div"))
    assert asked(seen, step, "-7.2") == [Doubt.WRONG_SIDE]
    assert asked(seen, step, "1.09") == [Doubt.WRONG_SIDE]
    assert asked(seen, step, "9.4") == [Doubt.OUTSIDE_FORECAST]
    for value in ("10.9", "-7.1", "10.4", "-6.8"):
        assert asked(seen, step, value) == []
        seen.record(NewRow(ReadingKind.TAPE_ZERO, value, "div"))


def test_a_mark_at_rest_has_no_sides(tmp_path: Path) -> None:
    seen = observation(tmp_path / "p")
    for value in ("0.20", "0.25"):
        seen.record(NewRow(ReadingKind.TAPE_ZERO, value, "div"))
    assert asked(seen, Step.ZERO_BEFORE, "0.25") == []
    assert asked(seen, Step.ZERO_BEFORE, "2.5") == [Doubt.OUTSIDE_FORECAST]


def zero(seq: int, value: float) -> Reading:
    return Reading(seq, ReadingKind.TAPE_ZERO, value, f"{value:.2f}", "div")


def test_two_readings_of_one_side_left_one_out_between() -> None:
    found = forecast_zero([zero(1, 10.0), zero(2, -8.0), zero(3, -7.8)], card_sigma=0.1)
    assert found is not None
    assert found.side is Side.RIGHT
    assert found.reading is not None
    assert found.reading == pytest.approx(9.7, abs=0.3)
    assert forecast_zero([zero(1, 10.0)], card_sigma=0.1) is None


@pytest.mark.statistical
def test_clean_tape_zeros_are_asked_about_as_rarely_as_they_should() -> None:
    questions = 0
    spec = SessionSpec(tape_zero_div=(0.3, 0.5))
    for run in simulate_sessions(spec, 60, np.random.default_rng(4)):
        values = [float(row["value"]) for row in run.rows if row["kind"] == "tape_zero"][:5]
        rows = [zero(i, value) for i, value in enumerate(values)]
        for count in (2, 3, 4):
            found = forecast_zero(rows[:count], card_sigma=spec.noise.scale_div)
            assert found is not None
            assert found.reading is not None
            assert found.half_width is not None
            right = values[count] > found.middle
            questions += found.side is not None and right is not (found.side is Side.RIGHT)
            questions += abs(values[count] - found.reading) > found.half_width
    # 180 draws at 1 %: 1.8 expected, standard deviation 1.3
    assert questions <= 6


def test_a_clamp_read_again_elsewhere_is_asked_about(tmp_path: Path) -> None:
    seen = observation(tmp_path / "p", "amplitude")
    clamp = ReadingKind.CLAMP
    assert asked(seen, Step.SWING, "100-08-00", clamp) == []
    seen.record(NewRow(clamp, "100-08-00", "dms"))
    assert asked(seen, Step.SWING, "100-08-06", clamp) == []
    assert asked(seen, Step.SWING, "100-18-00", clamp) == [Doubt.CLAMP_MOVED]


def test_zenith_angles_of_two_faces_make_a_circle(tmp_path: Path) -> None:
    seen = observation(tmp_path / "p")
    step, zenith = Step.SIGHTS_BEFORE, ReadingKind.ZENITH
    assert asked(seen, step, "88-10-00", zenith) == []
    seen.record(NewRow(zenith, "88-10-00", "dms", face=str(Face.LEFT)))
    assert asked(seen, step, "271-50-20", zenith) == []
    assert asked(seen, step, "271-05-20", zenith) == [Doubt.ZENITHS_CONTRADICT]
    assert asked(seen, step, "88-10-00", zenith) == [Doubt.ZENITHS_CONTRADICT]


def test_a_round_away_from_the_others_is_asked_about(tmp_path: Path) -> None:
    """The project's card states 15 arc-seconds for a round: 2.58 x 15 x sqrt(2) after the first."""
    seen = observation(tmp_path / "p", "automatic")
    assert asked(seen, Step.SWING, "321-53-09") == []
    seen.record(NewRow(ReadingKind.AZIMUTH, "321-53-09", "dms"))
    assert asked(seen, Step.SWING, "321-54-03") == []
    assert asked(seen, Step.SWING, "321-54-05") == [Doubt.OUTSIDE_ROUNDS]


def test_rounds_without_a_sigma_are_judged_by_their_scatter_from_three_on() -> None:
    first = [0.0, 10.0 * ARCSEC]
    assert doubt_round(500.0 * ARCSEC, first, card_sigma=None) == ()
    assert doubt_round(700.0 * ARCSEC, first, card_sigma=None)[0].doubt is Doubt.OUTSIDE_ROUNDS
    # mean 5", s 5", t(0.995, 2) 9.925: 5 x 9.925 x sqrt(4/3) = 57.3
    three = [*first, 5.0 * ARCSEC]
    assert doubt_round(62.0 * ARCSEC, three, card_sigma=None) == ()
    assert doubt_round(63.0 * ARCSEC, three, card_sigma=None) != ()


def test_a_reading_of_the_scale_typed_for_a_passage_is_asked_about(tmp_path: Path) -> None:
    seen = observation(tmp_path / "p", "transit")
    passage = ReadingKind.TRANSIT
    assert asked(seen, Step.SWING, "0", passage) == []
    assert asked(seen, Step.SWING, "-7.41", passage) == [Doubt.OTHER_DIVISION]
    seen.record(NewRow(passage, "5", "div"))
    assert asked(seen, Step.SWING, "5", passage) == []
