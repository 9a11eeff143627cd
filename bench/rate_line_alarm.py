"""False alarms of interference lines in the samples of a rate sensor's log.

Stops of every kind of log that the loop knows, filled with noise alone: white, of a low-pass
filter, and white with a random walk. ``SURVEYAPP_BENCH_RUNS`` records a cell (1000); finished cells
are kept in ``SURVEYAPP_BENCH_STORE``. ``LINE_ALARM`` of ``surveyapp/diagnosis/rate_lines.py`` is to
hold in each.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from bench._stored import stored
from surveyapp.diagnosis.rate_lines import LINE_ALARM, Stretch, judge_lines
from surveyapp_models.arrays import Floats

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "1000"))
THRESHOLDS = (0.05, LINE_ALARM)


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the stops of a log lie.

    Parameters
    ----------
    rate_hz : float
    stops : int
    turning_s, pause_s : float
    table_deg_s : float
        0 = at rest.
    gyros : int
    """

    rate_hz: float
    stops: int
    turning_s: float
    pause_s: float
    table_deg_s: float
    gyros: int

    def log(self) -> tuple[Floats, list[Stretch]]:
        """Times of all samples, and the rows of the stops."""
        held = round(self.turning_s * self.rate_hz)
        whole = held + round(self.pause_s * self.rate_hz)
        rate = math.radians(self.table_deg_s)
        time = np.arange(self.stops * whole) / self.rate_hz
        return time, [Stretch(k * whole, k * whole + held, rate) for k in range(self.stops)]


LAYOUTS: Mapping[str, Layout] = {
    "six positions": Layout(10.0, 12, 72.0, 5.0, 20.0, 3),
    "chamber": Layout(10.0, 60, 36.0, 2.0, 20.0, 3),
    "total station": Layout(20.0, 20, 12.0, 5.0, 60.0, 1),
    "at rest": Layout(10.0, 40, 45.0, 0.0, 0.0, 3),
    "held by hand": Layout(100.0, 18, 10.0, 5.0, 0.0, 3),
}


def _white(size: int, rng: np.random.Generator) -> Floats:
    return rng.standard_normal(size)


def _filtered(size: int, rng: np.random.Generator) -> Floats:
    """White noise through a low-pass of first order, time constant two samples."""
    from scipy.signal import lfilter

    keep = math.exp(-0.5)
    return np.asarray(lfilter([1.0 - keep], [1.0, -keep], rng.standard_normal(size)))


def _red(size: int, rng: np.random.Generator) -> Floats:
    """A walk that has grown to the scatter of the samples after a thousand of them."""
    walk = np.cumsum(rng.standard_normal(size)) / math.sqrt(1000.0)
    return np.asarray(rng.standard_normal(size) + walk)


NOISES: Mapping[str, Callable[[int, np.random.Generator], Floats]] = {
    "white": _white,
    "low-pass": _filtered,
    "with a walk": _red,
}


def smallest(layout: Layout, noise: str, seed: int) -> float:
    """Smallest probability of a false alarm in one record of noise."""
    rng = np.random.default_rng([seed, list(NOISES).index(noise)])
    time, stretches = layout.log()
    values = [NOISES[noise](time.size, rng) for _ in range(layout.gyros)]
    found = judge_lines(time, values, stretches, tuple("xyz"[: layout.gyros]))
    return 1.0 if found.p is None else found.p


def cell(layout: Layout, noise: str) -> list[float]:
    """Share of records with a line at each threshold."""
    every = np.array([smallest(layout, noise, seed) for seed in range(RUNS)])
    return [float(np.mean(every <= p)) for p in THRESHOLDS]


def run() -> Iterator[str]:
    """Every cell."""
    thresholds = " / ".join(f"{p:g}" for p in THRESHOLDS)
    yield f"{RUNS} records of noise a cell: share with a line at {thresholds}"
    for name, layout in LAYOUTS.items():
        for noise in NOISES:
            shares = stored(
                f"rate_line_alarm {name} {noise}",
                RUNS,
                lambda layout=layout, noise=noise: cell(layout, noise),  # type: ignore[misc]
            )
            yield f"  {name}, {noise}: {' / '.join(f'{s:.3f}' for s in shares)}"
