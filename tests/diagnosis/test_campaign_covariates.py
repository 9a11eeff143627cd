"""Observer, pressure, humidity, supply voltage and transport as causes of a campaign."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from surveyapp import api
from surveyapp.cli.main import main
from surveyapp.core.orientation.campaign_columns import SETTLED_H
from surveyapp.core.orientation.circumstances import facts_of
from surveyapp.core.prediction.average import Determinations, predict
from surveyapp.diagnosis.engine import diagnose
from surveyapp.diagnosis.subjects.campaign import CampaignDetermination, campaign
from surveyapp.domain.priors import DEFAULT_PRIORS
from surveyapp_models.angles import ARCSEC
from surveyapp_models.arrays import Floats

N = 45
SIGMA = 5.0


def extra(column: str, value: object) -> dict[str, Any]:
    """One circumstance by its column."""
    return {column: value if isinstance(value, str) else float(cast("float", value))}


def told(column: str, values: Floats | list[str], shift: Floats, seed: int = 1) -> set[str]:
    """Names in a campaign of 45 determinations whose constant moves by ``shift`` [arcsec]."""
    rng = np.random.default_rng(seed)
    y = shift + SIGMA * rng.standard_normal(N)
    items = [
        CampaignDetermination.at(
            float(y[i]) * ARCSEC,
            sigma=SIGMA * ARCSEC,
            elapsed_days=20000.0 + 3.0 * (i // 3) + 0.05 * (i % 3),
            temperature_c=float(12.0 + 5.0 * rng.standard_normal()),
            **extra(column, values[i]),
        )
        for i in range(N)
    ]
    result = diagnose(campaign(items, instrument="G"), draws=1000)
    return {item.effect for item in result.adopted}


@pytest.mark.parametrize(
    ("column", "effect", "low", "high", "rate"),
    [
        ("pressure_hpa", "pressure", 960.0, 1030.0, 0.4),
        ("humidity_percent", "humidity", 30.0, 95.0, 0.4),
        ("supply_v", "supply_voltage", 22.0, 28.0, 5.0),
    ],
)
def test_what_the_project_tells_is_named(
    column: str, effect: str, low: float, high: float, *, rate: float
) -> None:
    values = np.random.default_rng(2).uniform(low, high, N)
    assert told(column, values, rate * (values - values.mean())) == {effect}
    assert told(column, values, np.zeros(N)) == set()


def test_another_observer_and_settling_after_transport_are_named() -> None:
    rng = np.random.default_rng(3)
    names = [str(v) for v in rng.choice(["Ana", "Ben"], N)]
    off = np.array([15.0 if name == "Ben" else 0.0 for name in names])
    assert told("observer", names, off) == {"observer"}
    hours = rng.uniform(0.5, 60.0, N)
    assert told("transport_h", hours, 40.0 * np.exp(-hours / 6.0)) == {"after_transport"}


def test_a_recorded_pressure_makes_the_next_azimuth_better() -> None:
    """Ten campaigns: predicted with the pressure and without it, at a visit of high pressure."""
    errors: dict[bool, list[float]] = {True: [], False: []}
    for seed in range(10):
        rng = np.random.default_rng(seed)
        n = 20
        pressure = np.append(rng.uniform(970.0, 1010.0, n), 1025.0)
        truth = 0.5 * (pressure - 990.0)
        y = truth[:n] + SIGMA * rng.standard_normal(n)
        days = np.append(np.arange(n) * 4.0, 4.0 * n + 10.0)
        for known in (True, False):
            columns = {"elapsed_days": days, "block": np.arange(n + 1.0)}
            if known:
                columns["pressure_hpa"] = pressure
            targets = np.eye(1, n + 1, n)
            data = Determinations(y, np.full(n, SIGMA), columns, targets, np.zeros((n, 0)))
            errors[known].append(float(predict(data, DEFAULT_PRIORS).values[0] - truth[n]))
    rms = {known: float(np.sqrt(np.mean(np.square(e)))) for known, e in errors.items()}
    assert rms[True] < 0.6 * rms[False]


def test_the_project_hands_them_over(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    assert main(["simulate", "campaign", str(folder), "--seed", "3"]) == 0
    file = folder / "project.toml"
    more = "\npressure_hpa = 981.5\nhumidity_percent = 71\nhours_since_transport = 4\n"
    text = file.read_text(encoding="utf-8")
    text = re.sub(r"(\[\[orientation\]\]\n)", r"\1" + more.lstrip("\n"), text)
    file.write_text(text, encoding="utf-8")
    orientation = api.compute(folder).orientation
    instrument = orientation.constants[0].instrument.id
    facts = facts_of(orientation.sessions, instrument, orientation.positions)
    assert {f.number("pressure_hpa") for f in facts.values()} == {981.5}
    assert {f.number("humidity_percent") for f in facts.values()} == {71.0}
    assert {f.number("transport_h") for f in facts.values()} == {4.0}
    file.write_text(text.replace("pressure_hpa = 981.5", "pressure_hpa = 98150"), encoding="utf-8")
    assert main(["orient", str(folder)]) == 2


def test_hours_since_transport_follow_from_the_stations(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    assert main(["simulate", "campaign", str(folder), "--seed", "3"]) == 0
    orientation = api.compute(folder).orientation
    instrument = orientation.constants[0].instrument.id
    facts = facts_of(orientation.sessions, instrument, orientation.positions)
    station = {item.session.id: item.session.station for item in orientation.sessions}
    days = {key: f.number("elapsed_days") or 0.0 for key, f in facts.items()}
    checked = 0
    for key, fact in facts.items():
        hours = fact.number("transport_h")
        elsewhere = [
            d for k, d in days.items() if d < days[key] and station[k[0]] != station[key[0]]
        ]
        if elsewhere:
            assert hours == pytest.approx(24.0 * (days[key] - max(elsewhere)))
            checked += 1
        else:
            assert hours == SETTLED_H
    assert checked > 5
