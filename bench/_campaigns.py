"""Campaigns of determinations with later visits whose truth is known: declared simulation.

Used to judge the prediction of the constant, and (with other seeds and a mixture of causes of its
own, ``ARCHIVE``) to learn the default priors. Sizes are in standard deviations of a determination;
a campaign lasts some months, one to three determinations a day, later visits follow within it or
up to a season afterwards, at other lines and temperatures.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from surveyapp.core.prediction.average import Determinations
from surveyapp_models.arrays import Floats

LATER = 4
SIGMAS = (4.0, 5.0, 7.0)
"""Stated sigmas of a determination [arcsec]."""
LINE_SIGMA = 2.6
"""Standard deviation of a later line's own gyro azimuth [arcsec]."""


@dataclass(frozen=True)
class Scene:
    """Everything that may act on the constant, n determinations first and then the later visits."""

    n: int
    u: Floats
    columns: Mapping[str, Floats]
    humidity: Floats
    pressure: Floats
    rock: Floats
    observer: Floats
    season: Floats


Cause = Callable[[Scene, np.random.Generator], Floats]


def scene(g: np.random.Generator, n: int) -> Scene:
    """Draw the circumstances."""
    total = n + LATER
    sizes = g.integers(1, 4, n)
    block = np.repeat(np.arange(n), sizes)[:n].astype(np.float64)
    count = int(block[-1]) + 1
    span = g.uniform(4.0, 12.0) * count
    dates = np.sort(g.uniform(0.0, span, count))
    last = dates[-1]
    later = np.sort(last + g.uniform(1.0, 0.6 * max(span, 20.0), LATER))
    if g.random() < 0.3:
        later[0] = g.uniform(dates[0], last)
        later = np.sort(later)
    days = np.concatenate([dates[block.astype(int)] + 0.05 * g.uniform(0.0, 5.0, n), later])
    order = np.argsort(days[:n], kind="stable")
    days[:n], block = days[:n][order], block[order]
    season = np.sin(2.0 * np.pi * (days / 365.25) + g.uniform(0.0, 6.28))
    daily = g.standard_normal(count + LATER)
    own = np.concatenate([block, count + np.arange(LATER)]).astype(int)
    theta = 12.0 + 7.0 * season + 3.0 * daily[own] + 0.5 * g.standard_normal(total)
    line = np.concatenate([g.integers(0, 3, n), g.integers(2, 5, LATER)]).astype(np.float64)
    latitudes = np.radians(g.uniform(25.0, 58.0, 5) if g.random() < 0.4 else np.full(5, 45.0))
    columns = {
        "elapsed_days": days,
        "block": own.astype(np.float64),
        "temperature_c": theta,
        "line": line,
        "latitude": latitudes[line.astype(int)],
        "line_reading": g.uniform(0.0, 2.0 * np.pi, total),
        "north_reading": g.uniform(0.0, 2.0 * np.pi, total),
        "running_s": g.uniform(200.0, 3000.0, total),
    }
    first, length = days[:n].min(), max(np.ptp(days[:n]), 1e-3)
    rock = np.sin(2.0 * np.pi * (days - 60.0) / 365.25 + g.uniform(0.0, 6.28))
    return Scene(
        n,
        (days - first) / length,
        columns,
        0.6 * season + 0.8 * g.standard_normal(count + LATER)[own],
        g.standard_normal(count + LATER)[own],
        rock,
        (g.random(count + LATER) < 0.5)[own].astype(np.float64),
        season,
    )


def _centred(x: Floats, n: int) -> Floats:
    return np.asarray(x - x[:n].mean())


def _clean(s: Scene, g: np.random.Generator) -> Floats:
    return np.zeros(s.u.size)


def _drift(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(_centred(2.0 * s.u, s.n) * g.choice([-1.0, 1.0]))


def _temperature(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(_centred(s.columns["temperature_c"], s.n) / 8.0 * g.choice([-1.0, 1.0]))


def _latitude(s: Scene, g: np.random.Generator) -> Floats:
    x = _centred(8.0 / np.cos(s.columns["latitude"]), s.n)
    return np.asarray(x * g.choice([-1.0, 1.0]))


def _warm_up(s: Scene, g: np.random.Generator) -> Floats:
    tau = g.uniform(300.0, 1500.0)
    return np.asarray(2.0 * np.exp(-s.columns["running_s"] / tau) * g.choice([-1.0, 1.0]))


def _circle(s: Scene, g: np.random.Generator) -> Floats:
    phase = g.uniform(0.0, 2.0 * np.pi)
    north, target = s.columns["north_reading"], s.columns["line_reading"]
    return np.asarray(np.sin(north + phase) - np.sin(target + phase))


def _line(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(1.5 * (s.columns["line"] == g.integers(0, 3)) * g.choice([-1.0, 1.0]))


def _block(s: Scene, g: np.random.Generator) -> Floats:
    own = s.columns["block"]
    chosen = g.choice(own[: s.n])
    return np.asarray(2.0 * (own == chosen) * g.choice([-1.0, 1.0]))


def _step(s: Scene, g: np.random.Generator) -> Floats:
    days = s.columns["elapsed_days"]
    when = np.quantile(days[: s.n], g.uniform(0.25, 0.75))
    return np.asarray(1.5 * (days > when) * g.choice([-1.0, 1.0]))


def _gross(s: Scene, g: np.random.Generator) -> Floats:
    found = np.zeros(s.u.size)
    found[g.integers(0, s.n)] = 3.0 * g.choice([-1.0, 1.0])
    return found


def _temperature_and_drift(s: Scene, g: np.random.Generator) -> Floats:
    return _temperature(s, g) + _drift(s, g)


def _collinear(cause: Cause) -> Cause:
    """A cause in a campaign in which the temperature ran with the time."""

    def acting(s: Scene, g: np.random.Generator) -> Floats:
        theta = s.columns["temperature_c"]
        theta[:] = 4.0 + 16.0 * s.u + 0.8 * g.standard_normal(s.u.size)
        theta[s.n :] = g.uniform(4.0, 24.0, theta.size - s.n)
        return cause(s, g)

    return acting


def _beyond(cause: Cause) -> Cause:
    """A cause in a campaign whose later visits are 8 to 20 K warmer than any determination."""

    def acting(s: Scene, g: np.random.Generator) -> Floats:
        theta = s.columns["temperature_c"]
        theta[s.n :] = theta[: s.n].max() + g.uniform(8.0, 20.0, theta.size - s.n)
        return cause(s, g)

    return acting


def _walk(s: Scene, g: np.random.Generator) -> Floats:
    order = np.argsort(s.u)
    gaps = np.diff(np.concatenate([[0.0], np.maximum(s.u[order], 0.0)]))
    path = np.empty(s.u.size)
    path[order] = np.cumsum(np.sqrt(np.maximum(gaps, 0.0)) * g.standard_normal(gaps.size))
    return np.asarray(1.5 * path)


def _ageing(s: Scene, g: np.random.Generator) -> Floats:
    tau = g.uniform(0.2, 1.0)
    return np.asarray(2.5 * np.exp(-np.maximum(s.u, 0.0) / tau) * g.choice([-1.0, 1.0]))


def _days(s: Scene, g: np.random.Generator) -> Floats:
    own = s.columns["block"].astype(int)
    return np.asarray(g.standard_normal(own.max() + 1)[own])


def _square(s: Scene, g: np.random.Generator) -> Floats:
    x = _centred(s.columns["temperature_c"], s.n) / 8.0
    return np.asarray(1.2 * x * x * g.choice([-1.0, 1.0]))


def _humidity(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(s.humidity * g.choice([-1.0, 1.0]))


def _pressure(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(s.pressure * g.choice([-1.0, 1.0]))


def _rock(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(1.3 * s.rock * g.choice([-1.0, 1.0]))


def _observers(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(1.5 * s.observer * g.choice([-1.0, 1.0]))


def _cycle(s: Scene, g: np.random.Generator) -> Floats:
    return np.asarray(np.sin(2.0 * np.pi * s.u * g.uniform(1.0, 4.0) + g.uniform(0.0, 6.28)))


CLEAN: dict[str, Cause] = {"clean": _clean}
CATALOGUE: dict[str, Cause] = {
    "drift": _drift,
    "temperature": _temperature,
    "latitude": _latitude,
    "warm-up": _warm_up,
    "circle": _circle,
    "line": _line,
    "block": _block,
    "step": _step,
    "gross error": _gross,
    "temperature and drift": _temperature_and_drift,
    "collinear drift": _collinear(_drift),
    "collinear temperature": _collinear(_temperature),
}
WANDERING: dict[str, Cause] = {"walk": _walk, "ageing": _ageing, "day offsets": _days}
ABSENT: dict[str, Cause] = {
    "square of temperature": _square,
    "humidity": _humidity,
    "rock temperature": _rock,
    "two observers": _observers,
}
BEYOND: dict[str, Cause] = {
    "warmer visits, clean": _beyond(_clean),
    "warmer visits, temperature": _beyond(_temperature),
}
"""Later visits far outside of the temperatures of the determinations."""
ARCHIVE: tuple[tuple[float, dict[str, Cause]], ...] = (
    (0.5, CLEAN),
    (0.25, CATALOGUE),
    (0.25, {**WANDERING, "pressure": _pressure, "cycle": _cycle}),
)
"""The archive of the default priors: shares of groups; ``ABSENT`` is not in it."""


@dataclass(frozen=True)
class Drawn:
    """A campaign with the true constant at its later visits [arcsec]."""

    data: Determinations
    truth: Floats
    errors: Floats


def draw(
    cause: Cause,
    n: int,
    g: np.random.Generator,
    *,
    sizes: tuple[float, float] = (0.4, 5.0),
) -> Drawn:
    """Simulate one campaign; the size of the cause is log-uniform [sigmas of a determination]."""
    s = scene(g, n)
    size = float(np.exp(g.uniform(*np.log(sizes))))
    sigma = g.choice(SIGMAS, n)
    truth = -12.0 + size * 5.0 * cause(s, g)
    values = truth[:n] + sigma * g.standard_normal(n)
    targets = np.zeros((LATER, n + LATER))
    targets[np.arange(LATER), n + np.arange(LATER)] = 1.0
    data = Determinations(values, sigma, s.columns, targets, np.zeros((n, 0)))
    return Drawn(data, truth[n:], LINE_SIGMA * g.standard_normal(LATER))


def archive(count: int, seed: int) -> list[Drawn]:
    """An archive of campaigns of 8 to 45 determinations with every cause of ``ARCHIVE``."""
    g = np.random.default_rng(seed)
    shares = np.array([share for share, _ in ARCHIVE])
    found = []
    for _ in range(count):
        group = ARCHIVE[int(g.choice(len(ARCHIVE), p=shares))][1]
        cause = list(group.values())[int(g.integers(len(group)))]
        found.append(draw(cause, int(g.choice([8, 12, 20, 45])), g))
    return found
