"""What the constant of a line far in time may be if its instrument drifts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from bench._campaigns import LINE_SIGMA
from bench._short_campaigns import LATER_DAYS, draw_short
from surveyapp.core.orientation.circumstances import Circumstances
from surveyapp.core.orientation.instrument_constant import Calibration, InstrumentConstant
from surveyapp.core.orientation.predicted_constant import predict_constants
from surveyapp.core.orientation.prediction_notes import Wanted
from surveyapp.core.prediction.average import predict
from surveyapp.core.prediction.drifting import PACES_DAYS, half_width_about, if_it_drifts
from surveyapp.core.uncertain import Source, Uncertain
from surveyapp.domain.instrument import Instrument, InstrumentCard
from surveyapp.domain.priors import AMPLITUDES, DEFAULT_PRIORS, NU0, Priors
from surveyapp.domain.station_line import StationLine
from surveyapp_models.angles import ARCSEC


def test_it_is_generalized_least_squares_with_a_prior_of_the_rate() -> None:
    """One size and many paces against the inverted matrices of y = c + b t + e."""
    g = np.random.default_rng(2)
    days, later = np.sort(g.uniform(0.0, 20.0, 9)), np.array([60.0])
    sigmas = g.uniform(3.0, 7.0, 9)
    y = 0.7 * days + sigmas * g.standard_normal(9)
    sizes = (0.0, 0.0, 1.0, 0.0)
    [found] = if_it_drifts(y, sigmas, days, later, priors=Priors(sizes=sizes))
    unit = float(np.median(sigmas))
    weights, means, variances = [], [], []
    for pace in PACES_DAYS:
        rate = (2.0 * AMPLITUDES[2] / pace) ** 2
        t = days - days[0]
        a = np.diag((sigmas / unit) ** 2) + rate * np.outer(t, t)
        inverse, one, z = np.linalg.inv(a), np.ones(9), y / unit
        k = rate * (later[0] - days[0]) * t
        total = one @ inverse @ one
        c = one @ inverse @ z / total
        rss = (z - c) @ inverse @ (z - c)
        s2 = (NU0 + rss) / (NU0 + 8.0)
        rest = 1.0 - one @ inverse @ k
        end = rate * (later[0] - days[0]) ** 2
        weights.append(
            -0.5 * np.linalg.slogdet(a)[1]
            - 0.5 * math.log(total)
            - 0.5 * (NU0 + 8.0) * math.log(NU0 + rss)
        )
        means.append(unit * (c + k @ inverse @ (z - c)))
        variances.append(unit**2 * s2 * (end - k @ inverse @ k + rest**2 / total))
    expected = np.exp(np.array(weights) - max(weights))
    kept = found.weights > 0.0
    assert found.weights[kept] == pytest.approx(expected / expected.sum(), rel=1e-6)
    assert found.offsets[kept] == pytest.approx(means, rel=1e-6)
    assert found.variances[kept] == pytest.approx(variances, rel=1e-6)


@pytest.mark.parametrize("n", [4, 20])
def test_it_holds_drifts_that_a_day_does_not_show(n: int) -> None:
    """A drift alone: the average holds a third of them at 120 days, this .95 (52 of 60)."""
    inside = averaged = 0
    for i in range(60):
        made = draw_short("drift", n, 1, np.random.default_rng([77, n, i]))
        data, last = made.data, len(LATER_DAYS) - 1
        days = data.columns["elapsed_days"]
        assert data.sigmas is not None
        found = if_it_drifts(data.values, data.sigmas, days[:n], days[n:], priors=DEFAULT_PRIORS)
        value = predict(data, DEFAULT_PRIORS)
        error = abs(float(value.values[last] - made.truth[last]) + made.errors[last])
        averaged += error <= value.half_width(last, LINE_SIGMA**2)
        inside += error <= half_width_about(found[last], value.values[last], LINE_SIGMA**2)
    assert inside >= 52
    assert averaged < 40


def determined(
    days: list[float],
) -> tuple[InstrumentConstant, dict[tuple[str, str], Circumstances]]:
    """Determinations of 5 arc-seconds at the given days."""
    g = np.random.default_rng(3)
    made, facts = [], {}
    for k, day in enumerate(days):
        name = f"cal-{k}"
        value = Uncertain(5.0 * ARCSEC * g.standard_normal(), {Source("run", name): 5.0 * ARCSEC})
        made.append(Calibration(name, "P", "T", value, "before", day, 1, 0.0, None, 200.0))
        facts[name, "T"] = Circumstances.of({"elapsed_days": day, "temperature_c": 10.0})
    card = InstrumentCard("c", "c", "suspended", "test")
    return InstrumentConstant(Instrument("G", card), tuple(made), (), None, None, None, None), facts


@pytest.mark.parametrize(
    ("days", "line", "told"),
    [
        ([0.0, 0.1, 0.2, 0.3], 120.0, True),
        ([0.0, 0.1, 0.2, 0.3], 0.9, False),
        ([0.0, 20.0, 40.0, 60.0], 90.0, False),
        ([0.0, 20.0, 40.0, 60.0], -100.0, True),
    ],
)
def test_it_is_told_of_lines_far_from_the_determinations(
    days: list[float], line: float, told: bool
) -> None:
    constant, facts = determined(days)
    visit = Circumstances.of({"elapsed_days": line, "temperature_c": 10.0})
    wanted = [Wanted(StationLine("A", "B"), ((1.0, visit),))]
    found = predict_constants(constant, facts, wanted)
    notes = [w for w in found.warnings if w.code == "if_it_drifts"]
    assert bool(notes) == told
    [half] = found.drifting
    assert (half is not None) == told
    if half is not None:
        assert half > found.lines[0].interval95
        assert f'{half / ARCSEC:.0f}"' in notes[0].text
        without = predict_constants(
            constant, facts, wanted, DEFAULT_PRIORS.without(frozenset({"drift", "bend"}))
        )
        assert without.drifting == (None,)


def test_a_line_without_a_date_leaves_the_days_to_the_others() -> None:
    """The far line is as if it stood alone; of the others' five states it knows nothing."""
    constant, dated = determined([0.0, 20.0, 40.0, 60.0, 80.0, 100.0])
    facts = {key: replace(item, order=float(k)) for k, (key, item) in enumerate(dated.items())}
    told = {"elapsed_days": 7000.0, "temperature_c": 10.0}
    far = Wanted(StationLine("A", "B"), ((1.0, Circumstances.of(told, order=7.0)),))
    near = Circumstances.of({"temperature_c": 10.0}, order=8.0)
    undated = Wanted(StationLine("C", "D"), ((1.0, near),))
    [alone] = predict_constants(constant, facts, [far]).lines
    found = predict_constants(constant, facts, [far, undated])
    assert found.lines[0].sigma == pytest.approx(alone.sigma, rel=1e-9)
    assert found.lines[0].interval95 == pytest.approx(alone.interval95, rel=1e-9)
    [note] = [w for w in found.warnings if w.code == "covariate_missing"]
    assert "line C-D: elapsed_days not told" in note.text


@pytest.mark.parametrize(("dated", "codes"), [(6, []), (5, ["no_dates"]), (0, ["no_dates"])])
def test_the_order_in_place_of_dates_is_told(dated: int, codes: list[str]) -> None:
    constant, facts = determined([0.0, 20.0, 40.0, 60.0, 80.0, 100.0])
    known = {
        key: replace(item, order=float(k)) if k < dated else item.undated(float(k))
        for k, (key, item) in enumerate(facts.items())
    }
    visit = Circumstances.of({"elapsed_days": 110.0, "temperature_c": 10.0}, order=7.0)
    wanted = [Wanted(StationLine("A", "B"), ((1.0, visit),))]
    found = predict_constants(constant, known, wanted)
    notes = [w for w in found.warnings if w.code == "no_dates"]
    assert [w.code for w in notes] == codes
    assert all(f"{6 - dated} of 6" in w.text for w in notes)


@pytest.mark.parametrize(("without", "said"), [(0, ""), (2, "the mean"), (3, "too many")])
def test_temperatures_missing_at_determinations_are_told(without: int, said: str) -> None:
    constant, facts = determined([0.0, 20.0, 40.0, 60.0, 80.0, 100.0])
    known = {}
    for k, (key, item) in enumerate(facts.items()):
        told = {"elapsed_days": item.number("elapsed_days")}
        warm = told | ({} if k < without else {"temperature_c": 10.0 + k})
        known[key] = Circumstances.of(warm)
    visit = Circumstances.of({"elapsed_days": 110.0, "temperature_c": 12.0})
    found = predict_constants(constant, known, [Wanted(StationLine("A", "B"), ((1.0, visit),))])
    notes = [w.text for w in found.warnings if w.code == "covariate_missing"]
    assert len(notes) == (without > 0)
    assert all(said in text and f"{without} of 6" in text for text in notes)
