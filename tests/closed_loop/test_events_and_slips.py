"""What happens once is not refused by a clean second run; shifts are not called slips."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench._records import Truth, problems
from surveyapp.diagnosis import TurningPoints, diagnose, reversal_run
from surveyapp.diagnosis.fits import fit_members
from surveyapp.diagnosis.run_average import run_average, short_average
from surveyapp.diagnosis.run_value import value_of
from surveyapp_models.angles import ARCSEC, wrap_pi

SHARED = Path(__file__).resolve().parents[3] / "shared/cases"


def test_a_step_is_not_refused_by_a_clean_second_run() -> None:
    made, _ = problems(Truth("step", 20, step=40.0), 4, 5)
    clean, _ = problems(Truth("clean", 20), 4, 6)
    named = 0
    for number, (case, second) in enumerate(zip(made, clean, strict=True)):
        first = replace(case, identity=f"a{number}")
        alone = diagnose(first, draws=500, advise=False)
        other = replace(second, identity=f"b{number}")
        found = diagnose(first, confirm=other, draws=500, advise=False)
        names = [item.effect for item in found.adopted]
        if "midpoint_step" in [item.effect for item in alone.adopted]:
            assert "midpoint_step" in names
            assert {w.code for w in found.warnings} & {"event_unconfirmed", "event_confirmed"}
            named += 1
    assert named >= 2  # of four, where .96 are named


def test_a_drift_with_another_coefficient_is_refused() -> None:
    made, _ = problems(Truth("drift", 20, drift=4.0, one_sign=True), 2, 5)
    other, _ = problems(Truth("drift", 20, drift=12.0, one_sign=True), 2, 6)
    for case, second in zip(made, other, strict=True):
        found = diagnose(
            replace(case, identity="a"),
            confirm=replace(second, identity="b"),
            draws=500,
            advise=False,
        )
        assert "midpoint_drift" not in [item.effect for item in found.adopted]
        assert any("another one" in w.text for w in found.warnings)


@pytest.mark.shared_data
@pytest.mark.parametrize("path", sorted(SHARED.glob("worst-*.csv")), ids=lambda path: path.stem)
def test_the_worst_runs_are_not_named_or_their_interval_holds(path: Path) -> None:
    rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    points = TurningPoints(
        [float(np.radians(float(row["reading_deg"]))) for row in rows],
        count=[float(row["count"]) for row in rows],
        elapsed_s=[float(row["elapsed_s"]) for row in rows],
        resolution=5.0 * ARCSEC,
        sigma=5.0 * ARCSEC,
        identity=path.stem,
    )
    found = diagnose(reversal_run(points))
    truth = float(np.radians(float(rows[0]["true_mean_north_deg"])))
    assert found.averaged.interval95 is not None
    holds = abs(wrap_pi(found.averaged.value - truth)) <= found.averaged.interval95
    assert holds or not found.adopted
    assert holds


@pytest.mark.statistical
@pytest.mark.parametrize(
    ("name", "sizes"),
    [
        ("clean", {}),
        ("drift", {"drift": 3.0}),
        ("slip", {"gross": (60.0,)}),
        ("step", {"step": 25.0}),
    ],
)
def test_north_of_short_runs_lies_in_its_interval(name: str, sizes: dict[str, float]) -> None:
    inside = count = 0
    for n in (8, 12):
        made, north = problems(Truth(name, n, **sizes), 25, 300 + n)  # type: ignore[arg-type]
        for case, truth in zip(made, north.tolist(), strict=True):
            case = replace(case, sigma=np.full(n, 4.0 * ARCSEC))
            value = short_average(case, fit_members(case, ()), named=False)
            inside += abs(wrap_pi(value.value + case.offset - truth)) <= value.interval95
            count += 1
    # .93 is claimed; 50 runs hold 41 and fewer once in a thousand times
    assert inside > 41


def test_without_rivals_the_average_of_a_run_is_that_of_the_base() -> None:
    (case,), _ = problems(Truth("clean", 10), 1, 4)
    case = replace(case, sigma=np.full(10, 4.0 * ARCSEC), effects=())
    base = fit_members(case, ())
    found, mixture = run_average(case, base)
    central = value_of(case, base)
    assert abs(found.value - central.value) < central.sigma
    assert mixture.half_width() >= 0.5 * central.interval95
