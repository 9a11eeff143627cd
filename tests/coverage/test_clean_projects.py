"""Clean projects stay quiet where the instrument is far from its card's latitude."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.special import bdtrik

from bench._coverage_lines import alone, base, files_of
from bench.coverage import write_files
from surveyapp import api

PROJECTS = 80


@pytest.mark.statistical
@pytest.mark.parametrize(("passages", "seed"), [(3, 5), (5, 6)])
def test_clamped_period_at_johannesburg(passages: int, seed: int, tmp_path: Path) -> None:
    # 16 of 80 clean projects at -26 degrees once failed: the moments scatter more than a card says;
    # the check has a level of 1 %, and the bound is that of the binomial distribution at 99.9 %
    rng = np.random.default_rng(seed)
    told, made = 0, 0
    for _ in range(4):
        spec = base(rng, latitude_deg=-26.0, method="transit", points=passages)
        card = dataclasses.replace(spec, latitude=math.radians(47.0))
        for books, text in alone(spec, card).runs(PROJECTS // 4, rng):
            write_files(tmp_path, files_of(books, text))
            found = [c for c in api.orient(tmp_path).checks if c.rule == "period.clamped"]
            assert len(found) == 1
            told += found[0].passed is False
            made += 1
    assert made == PROJECTS
    assert told <= bdtrik(0.999, PROJECTS, 0.01)
