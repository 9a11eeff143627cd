"""A slip in one face: told, and kept out of the sigmas that it would enlarge."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.import_sigmas import _traverse
from surveyapp import api
from surveyapp.core.fieldfile.face_pairs import LEVEL, unlike
from tests.formats.field_writers import gsi
from tests.formats.importing import bring

ARC = math.pi / 648000.0


@pytest.mark.statistical
def test_sound_pairs_are_accused_as_rarely_as_stated() -> None:
    g = np.random.default_rng(4)
    draws = ((20 + 6 * g.normal(size=(600, 12))) * ARC).tolist()
    accused = sum(bool(unlike(values)) for values in draws)
    assert accused <= 15  # binomial(600, 0.01): 99.9 %
    assert LEVEL == 0.01


def test_few_pairs_and_small_gaps_are_no_slip() -> None:
    assert unlike([0.0] * 6 + [1.0]) == []
    assert unlike([0.0] * 20 + [4.0 * ARC]) == []
    assert unlike([0.0] * 20 + [6.0 * ARC]) == [20]


@pytest.mark.parametrize(("circle", "what"), [("hz", "collimation"), ("v", "index")])
def test_a_minute_misread_in_one_face(tmp_path: Path, circle: str, what: str) -> None:
    setups, sights = _traverse(0, 5, 2)
    clean = list(sights)
    place = next(i for i, s in enumerate(sights) if (s.at, s.to, s.face) == ("104", "105", "R"))
    value = (getattr(sights[place], circle) + 1.0 / 60.0) % 360.0
    sights[place] = replace(sights[place], **{circle: value})
    found = {}
    for name, readings in (("clean", clean), ("slip", sights)):
        lines = gsi(setups, readings, width=16, length="m5")
        folder, result = bring(tmp_path / name, "gsi", lines, fixed=("101", "102"))
        found[name] = folder, {x.code: x.text for x in result.warnings}
    assert "face_pair_differs" not in found["clean"][1]
    told = found["slip"][1]["face_pair_differs"]
    assert "104-105 (line " in told
    assert what in told
    adjusted = {name: api.adjust(folder) for name, (folder, _) in found.items()}
    assert not adjusted["clean"].snooping.suspects
    kind = "direction 104-10" if circle == "hz" else "zenith 104-105"
    assert kind in adjusted["slip"].removals[0].description
