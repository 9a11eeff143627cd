"""What the notch and the image threshold of lines in table logs cost and keep, by simulation.

``NOTCH`` of ``surveyapp/diagnosis/rate_lines.py`` and ``IMAGE`` of
``surveyapp/diagnosis/long_records/spectrum.py`` are varied over records of noise and over records
with a family of three lines. ``SURVEYAPP_BENCH_RUNS`` records a cell (200),
``SURVEYAPP_BENCH_PARTS`` some of the layouts.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from unittest.mock import patch

import numpy as np

from bench.rate_line_alarm import LAYOUTS, NOISES, Layout
from surveyapp.diagnosis import rate_lines
from surveyapp.diagnosis.long_records import spectrum

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "200"))
ALARM = 0.05
NOTCHES = (0.0, 1.0, 4.0, 8.0)
IMAGES = (0.05, 0.15, 0.4, 1.0)
FUNDAMENTAL = 0.13
"""Of the family, as a share of the sampling rate."""
SLOW = 1.5
"""Of the slow line: times the frequency of the turn, or the inverse length of a stop."""
LINES = {"total station": 0.08, "chamber": 0.04}
"""Amplitude of a line in standard deviations of a sample, found in part of the records."""


def _share(layout: Layout, noise: str, lines: tuple[float, ...], *, amplitude: float) -> float:
    """Share of records in which noise, or noise and lines, show a line."""
    found = 0
    for seed in range(RUNS):
        rng = np.random.default_rng([seed, 5])
        time, stretches = layout.log()
        values = [NOISES[noise](time.size, rng) for _ in range(layout.gyros)]
        for hz in lines:
            phase = rng.uniform(0.0, 2.0 * math.pi)
            values[0] = values[0] + amplitude * np.cos(2.0 * math.pi * hz * time + phase)
        judged = rate_lines.judge_lines(time, values, stretches, tuple("xyz"[: layout.gyros]))
        found += (1.0 if judged.p is None else judged.p) <= ALARM
    return found / RUNS


def _row(layout: Layout, amplitude: float) -> str:
    rate = abs(layout.table_deg_s) / 360.0 or 1.0 / layout.turning_s
    family = tuple(FUNDAMENTAL * layout.rate_hz * k for k in (1, 2, 3))
    cells = [
        _share(layout, "white", (), amplitude=0.0),
        _share(layout, "with a walk", (), amplitude=0.0),
        _share(layout, "white", family, amplitude=amplitude),
        _share(layout, "white", (SLOW * rate,), amplitude=2.0 * amplitude),
    ]
    return " / ".join(f"{c:.3f}" for c in cells)


def run() -> Iterator[str]:
    """Both constants over the layouts that have pauses, and one that has none."""
    yield f"{RUNS} records a cell, share with a line at {ALARM:g}: white / with a walk / a family"
    yield "of three lines / a slow line"
    wanted = os.environ.get("SURVEYAPP_BENCH_PARTS", "")
    for name, amplitude in LINES.items():
        if wanted and name not in wanted.split(","):
            continue
        layout = LAYOUTS[name]
        for notch in NOTCHES:
            with patch.object(rate_lines, "NOTCH", notch):
                yield f"  {name}, notch {notch:g}: {_row(layout, amplitude)}"
        for image in IMAGES:
            with patch.object(spectrum, "IMAGE", image):
                yield f"  {name}, image {image:g}: {_row(layout, amplitude)}"
