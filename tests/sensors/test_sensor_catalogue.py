"""Compass and tilt in the one catalogue: own effects, a second log, adoption."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from surveyapp.io.user_effects.probe import _MAKERS, COLUMNS
from surveyapp_models.effects import of_subject
from surveyapp_models.effects.effect import Effect
from tests.cli.command import run as surveyapp

OWN = """
import numpy as np
from surveyapp_models.effects.effect import Coefficient, Column, Effect

def basis(columns, /, **grid):
    wave = np.sin(columns["time_s"] / 7.0)
    return (wave * (columns["axis"] == 0.0))[:, None]

EFFECTS = (
    Effect(
        id="slow_wave", title="Slow wave", subject="compass",
        needs=(Column("time_s", "s"), Column("axis", "axis")),
        coefficients=(Coefficient("size", "uT", 1.0, -50.0, 50.0, "amplitude on x"),),
        basis=basis, datum="without it", source="of our own", remedy="Stop the pump.",
        symptom="it waved", separate_by="the pump switched off",
    ),
)
"""


def simulated(folder: Path, kind: str, *arguments: str) -> Path:
    assert surveyapp("simulate", kind, folder, *arguments).code == 0
    return folder


@pytest.mark.parametrize(
    "effect",
    [*of_subject("compass"), *of_subject("tilt")],
    ids=lambda e: f"{e.subject}.{e.id}",
)
def test_every_effect_is_pure_and_needs_only_what_it_declares(effect: Effect) -> None:
    columns = _MAKERS[effect.subject](np.random.default_rng(3))
    assert {need.name for need in effect.needs} <= set(COLUMNS[effect.subject])
    only = {need.name: columns[need.name] for need in effect.needs}
    points = effect.grid_points(only)
    for point in points[:: max(1, len(points) // 20)]:
        first = effect.basis(only, **point)
        assert first.shape == (columns["axis"].size, len(effect.coefficients))
        assert np.ptp(first, axis=0).min() > 0.0
        np.testing.assert_array_equal(first, effect.basis(only, **point))


def test_an_effect_of_ones_own_is_named_in_a_compass_log(tmp_path: Path) -> None:
    folder = simulated(tmp_path / "unit", "compass", "--seed", "6")
    path = folder / "sensors" / "compass.csv"
    lines = path.read_text().splitlines()
    names = lines[0].split(",")
    t, x = names.index("time_s"), names.index("mag_x_uT")
    rows = [line.split(",") for line in lines[1:]]
    for row in rows:
        row[x] = f"{float(row[x]) + 4.0 * np.sin(float(row[t]) / 7.0):.6f}"
    path.write_text("\n".join([lines[0], *(",".join(row) for row in rows)]) + "\n")
    own = tmp_path / "own.py"
    own.write_text(OWN)
    found = surveyapp("diagnose", folder, "--sensor", "compass", "--effects", own, "--json").json
    assert "slow_wave" in [item["effect"] for item in found["adopted"]]
    size = next(i for i in found["adopted"] if i["effect"] == "slow_wave")["coefficients"][0]
    assert size["value"] == pytest.approx(4.0, abs=0.2)
    assert "Stop the pump." in found["remedy"]


def test_a_second_log_confirms_its_own_iron_and_refuses_anothers(tmp_path: Path) -> None:
    """The same iron in two records of it; the iron of another carrier."""
    folder = simulated(tmp_path / "unit", "compass", "--effect", "hard_iron=12", "--seed", "4")
    first = (folder / "sensors" / "compass.csv").read_text().splitlines()
    half = len(first) // 2
    other = simulated(tmp_path / "other", "compass", "--effect", "hard_iron=12", "--seed", "5")
    (folder / "sensors" / "compass.csv").write_text("\n".join(first[:half]) + "\n")
    (folder / "sensors" / "again.csv").write_text("\n".join([first[0], *first[half:]]) + "\n")
    strange = (other / "sensors" / "compass.csv").read_text()
    (folder / "sensors" / "other.csv").write_text(strange)
    with (folder / "project.toml").open("a") as file:
        for name in ("again", "other"):
            file.write(f'\n[[sensor_log]]\nid = "{name}"\nkind = "compass"\n')
            file.write(f'file = "sensors/{name}.csv"\n')

    def names(confirm: str) -> tuple[list[str], dict[str, float]]:
        command = ("diagnose", folder, "--sensor", "compass", "--confirm", confirm, "--json")
        found = surveyapp(*command).json
        return [item["effect"] for item in found["adopted"]], found["after"]

    confirmed, after = names("again")
    assert confirmed == ["hard_iron"]
    assert after["confirm_rms"] < 1.0
    assert names("other")[0] == []
    refused = surveyapp("diagnose", folder, "--sensor", "compass", "--confirm", "compass", "--json")
    assert refused.code == 2


def test_what_is_adopted_stands_under_the_log_once(tmp_path: Path) -> None:
    folder = simulated(tmp_path / "unit", "tilt", "--effect", "temperature=1", "--seed", "4")
    command = ("diagnose", folder, "--sensor", "tilt", "--adopt", "--json")
    first = surveyapp(*command).json
    assert first["written"], first["verdict"]
    table = tomllib.loads((folder / "project.toml").read_text())["sensor_log"][0]["effect"]
    assert [one["id"] for one in table] == [item["effect"] for item in first["adopted"]]
    assert surveyapp("check", folder).code in (0, 1)
    again = surveyapp(*command).json
    assert again["written"] == []
    assert again["not_written"][0]["reason"].startswith("already adopted")
    ledger = next(folder.rglob("ledger*")).read_text()
    assert '"adoption"' in ledger


def test_a_rate_log_adopts_too(tmp_path: Path) -> None:
    folder = simulated(
        tmp_path / "unit",
        "rate",
        "--programme",
        "multi-position",
        "--effect",
        "g_sensitivity=0.004",
    )
    found = surveyapp("diagnose", folder, "--sensor", "multi-position", "--adopt", "--json").json
    assert found["written"] == ["project.toml, sensor_log multi-position, effect g_sensitivity"]
    assert found["identity"] == "multi-position"
