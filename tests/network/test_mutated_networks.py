"""Mutated .gkf files end in 0, 1 or 2, and without NaN: 36 of 1500 once ended in a fault."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from surveyapp import api
from surveyapp.cli.main import main
from tests.network.hostile_numbers import mutated
from tests.tui.helpers_tui import make_network


def test_mutated_networks_are_no_fault_of_the_program(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sound = tmp_path / "sound.gkf"
    api.export_gkf(make_network(tmp_path / "p"), sound)
    rng = random.Random(13)
    path = tmp_path / "mutated.gkf"
    for number in range(75):
        path.write_bytes(mutated(sound.read_bytes(), rng))
        code = main(["adjust", str(path), "--json"])
        out = capsys.readouterr().out
        assert code in (0, 1, 2), (number, out)
        assert not re.search(r"\bNaN\b|\bInfinity\b", out), number
