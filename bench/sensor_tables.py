"""The loop on compass and tilt logs with a planted effect: detected, rightly named, wrongly named.

``SURVEYAPP_BENCH_RUNS`` records a line (48); lines are kept in ``SURVEYAPP_BENCH_STORE``. Detected:
the verdict is not "adequate". Right: every planted effect is named. Wrong: another one is.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from bench._stored import stored
from bench.sensor_loop import Noise, ar1, disturbed, found_in, log_of, walk, white
from surveyapp.core.simulate.specification import Effect

RUNS = int(os.environ.get("SURVEYAPP_BENCH_RUNS", "48"))
Planted = tuple[Effect, ...]

COMPASS: tuple[tuple[str, Planted, Noise], ...] = (
    ("nothing", (), white),
    ("nothing, AR(1)", (), ar1),
    ("nothing, walk of 6 uT", (), walk),
    ("hard iron 12 uT", (Effect("hard_iron", 12.0),), white),
    ("and soft iron 6 %", (Effect("hard_iron", 12.0), Effect("soft_iron", 0.06)), white),
    ("switch 15 on hard iron 10", (Effect("interference_step", 15.0), Effect("hard_iron", 10.0)),
     white),
    ("switch 3", (Effect("interference_step", 3.0),), white),
    ("switched on only, 6", (Effect("interference_step", 6.0, (("off", 1e9),)),), white),
    ("temperature .5 uT/K", (Effect("temperature", 0.5),), white),
    ("gradient 6 uT/m", (Effect("field_gradient", 6.0),), white),
    ("misalignment 2 degrees", (Effect("misalignment", np.radians(2.0)),), white),
    ("8 gross errors of 20 uT", (Effect("gross_error", 20.0),), white),
)  # fmt: skip
TILT: tuple[tuple[str, Planted, Noise], ...] = (
    ("nothing", (), white),
    ("nothing, AR(1)", (), ar1),
    ("nothing, walk of 6 arcsec", (), walk),
    ("cross axis 2 %", (Effect("cross_axis", 0.02),), white),
    ("temperature 1 arcsec/K", (Effect("temperature", 1.0),), white),
    ("both", (Effect("cross_axis", 0.02), Effect("temperature", 1.0)), white),
    ("cubic 4 arcsec", (Effect("scale_nonlinearity", 4.0),), white),
    ("warm-up 6 arcsec", (Effect("warm_up", 6.0),), white),
    ("3 gross errors of 20 arcsec", (Effect("gross_error", 20.0),), white),
)


def judged(planted: Planted, document: dict[str, Any]) -> tuple[bool, bool, bool]:
    """Detected, right, wrong."""
    truth = {effect.id for effect in planted}
    named = {item["effect"] for item in document["adopted"]}
    return document["verdict"] != "adequate", truth <= named, bool(named - truth)


def cell(kind: str, planted: Planted, noise: Noise) -> list[float]:
    """Shares of a line, and the mean rms of held-out blocks before and after."""
    found, held = [], []
    for seed in range(RUNS):
        log, _ = log_of(kind, np.random.default_rng([seed, 21]), *planted)
        log = disturbed(log, noise, np.random.default_rng([seed, 22]))
        document = found_in(log, kind).document
        found.append(judged(planted, document))
        held.append([document["held_out"][key] or np.nan for key in ("before", "after")])
    return [*np.mean(found, axis=0).tolist(), *np.nanmean(held, axis=0).tolist()]


def run() -> Iterator[str]:
    """Every line of both tables."""
    for kind, lines in (("compass", COMPASS), ("tilt", TILT)):
        for title, planted, noise in lines:
            make = partial(cell, kind, planted, noise)
            values = stored(f"sensor tables {kind} {title}", (RUNS,), make)
            seen, right, wrong, before, after = values
            told = f"{right:.2f}" if planted else "-"
            yield (
                f"{kind}, {title}: detected {seen:.2f}, right {told}, wrong {wrong:.2f}; held out "
                f"{before:.2f} -> {after:.2f}, {RUNS} records"
            )
