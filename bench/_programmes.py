"""Campaigns of another make, with which the clean share of the priors is calibrated.

Not the generator of ``bench/_campaigns.py``, which judges: here the instrument goes down the mine
on trips, is determined on the surface before and after each, sees the warm rock only at the later
visits, has noise with heavier tails whose stated sigma is a little wrong, and causes of other forms
whose sizes are half-normal instead of log-uniform.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench._campaigns import LATER, LINE_SIGMA, Drawn
from surveyapp.core.prediction.average import Determinations
from surveyapp_models.arrays import Floats

TAIL_DOF = 7
"""Degrees of freedom of the Student noise of a determination."""
SIZE = 2.5
"""Standard deviation of the half-normal sizes [sigmas of a determination]."""


@dataclass(frozen=True)
class Programme:
    """Trips down the mine: determinations first, later visits last.

    Parameters
    ----------
    n : int
    days, trip, theta, line, latitude, north, target, running, observer, damp : ndarray, (n + q,)
        Days since the first, number of the trip, degrees Celsius, number, rad, rad, rad, seconds,
        0 or 1, standard scores of the humidity.
    """

    n: int
    days: Floats
    trip: Floats
    theta: Floats
    line: Floats
    latitude: Floats
    north: Floats
    target: Floats
    running: Floats
    observer: Floats
    damp: Floats

    @property
    def span(self) -> float:
        """Of the determinations [d]."""
        return max(float(np.ptp(self.days[: self.n])), 1.0)


Form = Callable[[Programme, np.random.Generator], Floats]


def programme(g: np.random.Generator, n: int) -> Programme:
    """Draw trips until there are n determinations, and the visits of the trips after them."""
    trip: list[float] = []
    while len(trip) < n:
        trip += [float(len(set(trip)))] * int(g.integers(2, 6))
    trips = np.array(trip[:n])
    last = trips[-1]
    later = last + np.sort(g.integers(0, 4, LATER)).astype(np.float64)
    own = np.concatenate([trips, later]).astype(int)
    starts = np.cumsum(g.exponential(20.0, own.max() + 1) + 2.0)
    hours = np.concatenate([np.sort(g.uniform(0.0, 10.0, n)), g.uniform(10.0, 20.0, LATER)])
    days = starts[own] + hours / 24.0
    order = np.argsort(days[:n], kind="stable")
    days[:n] = days[:n][order]
    weather = 4.0 * g.standard_normal(own.max() + 1)
    theta = 9.0 - 10.0 * np.cos(2.0 * np.pi * days / 365.25) + weather[own] + g.normal(0, 1, n + 4)
    theta[n:] = g.uniform(14.0, 26.0) + g.normal(0.0, 1.0, LATER)
    places = np.radians(g.uniform(30.0, 62.0, 6)) if g.random() < 0.3 else np.full(6, 0.8)
    line = np.concatenate([g.integers(0, 2, n), g.integers(2, 6, LATER)]).astype(np.float64)
    return Programme(
        n=n,
        days=days - days[0],
        trip=own.astype(np.float64),
        theta=theta,
        line=line,
        latitude=places[line.astype(int)],
        north=g.uniform(0.0, 2.0 * np.pi, n + LATER),
        target=g.uniform(0.0, 2.0 * np.pi, n + LATER),
        running=g.exponential(900.0, n + LATER) + 120.0,
        observer=g.integers(0, 2, own.max() + 1)[own].astype(np.float64),
        damp=g.standard_normal(own.max() + 1)[own],
    )


def _unit(p: Programme, x: Floats) -> Floats:
    """Centred on the determinations, and of unit scatter among them."""
    spread = float(np.std(x[: p.n]))
    return np.asarray((x - x[: p.n].mean()) / (spread if spread > 1e-9 else 1.0))


def _nothing(p: Programme, g: np.random.Generator) -> Floats:
    return np.zeros(p.days.size)


def _rate(p: Programme, g: np.random.Generator) -> Floats:
    """A drift whose rate changes by a third somewhere."""
    knee = g.uniform(0.0, p.span)
    bent = p.days + g.normal(0.0, 0.3) * np.maximum(p.days - knee, 0.0)
    return _unit(p, bent)


def _temperature(p: Programme, g: np.random.Generator) -> Floats:
    x = p.theta - 20.0
    return np.asarray((x + 0.01 * g.standard_normal() * x * x) / 8.0)


def _latitude(p: Programme, g: np.random.Generator) -> Floats:
    x = np.tan(p.latitude)
    return np.asarray(5.0 * (x - x[: p.n].mean()))


def _warm_up(p: Programme, g: np.random.Generator) -> Floats:
    return np.asarray(2.0 * np.exp(-p.running / g.uniform(200.0, 2500.0)))


def _circle(p: Programme, g: np.random.Generator) -> Floats:
    phase = g.uniform(0.0, 2.0 * np.pi)
    return np.asarray(np.cos(p.north - phase) - np.cos(p.target - phase))


def _line(p: Programme, g: np.random.Generator) -> Floats:
    return np.asarray(1.5 * (p.line == 0.0))


def _trip(p: Programme, g: np.random.Generator) -> Floats:
    return np.asarray(2.0 * (p.trip == g.choice(p.trip[: p.n])))


def _transport(p: Programme, g: np.random.Generator) -> Floats:
    return np.asarray(1.5 * (p.trip > g.uniform(0.0, max(p.trip[p.n - 1], 1.0))))


def _slip(p: Programme, g: np.random.Generator) -> Floats:
    x = np.zeros(p.days.size)
    x[g.integers(p.n)] = 3.0
    return x


def _both(p: Programme, g: np.random.Generator) -> Floats:
    return np.asarray(_rate(p, g) + g.choice([-1.0, 1.0]) * _temperature(p, g))


def _wander(p: Programme, g: np.random.Generator) -> Floats:
    """A mean-reverting walk of a season."""
    order = np.argsort(p.days)
    x = np.empty(p.days.size)
    now = g.standard_normal()
    last = 0.0
    for k in order:
        keep = np.exp(-max(p.days[k] - last, 0.0) / 90.0)
        now = keep * now + np.sqrt(1.0 - keep**2) * g.standard_normal()
        x[k], last = now, p.days[k]
    return 1.5 * x


def _settling(p: Programme, g: np.random.Generator) -> Floats:
    return _unit(p, np.log1p(np.maximum(p.days, 0.0) / g.uniform(2.0, 20.0)))


def _trips(p: Programme, g: np.random.Generator) -> Floats:
    return np.asarray(g.standard_normal(int(p.trip.max()) + 1)[p.trip.astype(int)])


def _observers(p: Programme, g: np.random.Generator) -> Floats:
    return 1.5 * p.observer


def _damp(p: Programme, g: np.random.Generator) -> Floats:
    return p.damp


def _square(p: Programme, g: np.random.Generator) -> Floats:
    return np.asarray(1.2 * ((p.theta - 12.0) / 8.0) ** 2)


GROUPS: dict[str, dict[str, Form]] = {
    "clean": {"clean": _nothing},
    "catalogue": {
        "drift": _rate,
        "temperature": _temperature,
        "latitude": _latitude,
        "warm-up": _warm_up,
        "circle": _circle,
        "line": _line,
        "trip": _trip,
        "transport": _transport,
        "slip": _slip,
        "temperature and drift": _both,
    },
    "walk-like": {"wander": _wander, "settling": _settling, "trips": _trips},
    "absent": {"square": _square, "observers": _observers, "humidity": _damp},
}


def draw_programme(form: Form, n: int, g: np.random.Generator) -> Drawn:
    """Simulate one programme with its later visits [arcsec]."""
    p = programme(g, n)
    sigma = np.exp(g.normal(np.log(5.0), 0.25, n))
    wrong = np.exp(g.normal(0.0, 0.15))
    noise = g.standard_t(TAIL_DOF, n) * np.sqrt((TAIL_DOF - 2) / TAIL_DOF)
    truth = 40.0 + g.normal(0.0, SIZE) * 5.0 * form(p, g)
    columns = {
        "elapsed_days": p.days,
        "block": p.trip,
        "temperature_c": p.theta,
        "line": p.line,
        "latitude": p.latitude,
        "line_reading": p.target,
        "north_reading": p.north,
        "running_s": p.running,
    }
    targets = np.zeros((LATER, n + LATER))
    targets[np.arange(LATER), n + np.arange(LATER)] = 1.0
    values = truth[:n] + wrong * sigma * noise
    data = Determinations(values, sigma, columns, targets, np.zeros((n, 0)))
    return Drawn(data, truth[n:], LINE_SIGMA * g.standard_normal(LATER))
