"""What each cause may do to the constant: its covariance between any two visits.

In units of the variance of a determination, at amplitude 1; the first rows are determinations, the
others later visits. A cause whose columns the determinations do not have, or do not vary, is not
there. What a later visit does not tell is handled by whoever asks (``average``): here nothing is
missing.

Source: prediction.md A.2 to A.4; Rasmussen & Williams (2006), Gaussian Processes for Machine
Learning, 4.2.1 (Matern 3/2) and 4.3 (integrated random walk).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from surveyapp_models.arrays import Floats

SHORT_SPAN_DAYS = 30.0
"""A change seen within a shorter campaign is not taken to go on at that rate for months."""
ARCHIVE_SPAN_DAYS = 50.0
"""Median span of the campaigns from which the priors were learned: the pace of what a shorter
campaign cannot have seen."""
LEAST_OWN_SHARE = 0.05
"""One in twenty of these campaigns is shorter than 13 days, a quarter than 28: so much of what the
archive has taught has the pace of such a campaign, and the square of its span in theirs between."""
TEMPERATURE_UNIT_K = 8.0
LATITUDE_UNIT = 8.0
"""An effect of the latitude of size 1 changes by 1/8 sigma where its secant changes by 1."""
WARM_UP_UNIT = 4.0
TAUS_S = (350.0, 700.0, 1500.0)
BENDS = (0.5, 2.0)
SLOW_LENGTHS = (0.15, 0.5, 1.5)
ROUGH_LENGTH = 0.2
CURVATURE = 0.7
STEP_PAIRED = ("drift", "temperature", "curve", "latitude", "warm_up", "line", "day", "walk")
COVARIATE_UNITS = {"pressure_hpa": 10.0, "humidity_percent": 15.0}
"""What moves the constant by its size; the supply voltage by a twentieth of itself."""
SUPPLY_SHARE = 0.05
PAIRED = (*STEP_PAIRED, "slow", "excess")
"""Causes that are tried two at a time."""
COLUMNS_READ = (
    "elapsed_days",
    "block",
    "line",
    "observer",
    "temperature_c",
    "latitude",
    "line_reading",
    "north_reading",
    "running_s",
    "pressure_hpa",
    "humidity_percent",
    "supply_v",
)
"""Columns of a campaign that a cause here reads; others change no prediction."""


@dataclass(frozen=True, slots=True)
class Kernel:
    """Covariance of one cause in one of its shapes.

    Parameters
    ----------
    unit : str
    matrix : ndarray, shape (n + q, n + q)
        Between determinations and later visits.
    share : float
        Of its unit's prior, beside the other shapes of the unit.
    """

    unit: str
    matrix: Floats
    share: float = 1.0


def clock(days: Floats, n: int) -> Floats:
    """Time since the first determination in spans of the campaign.

    Beyond a campaign shorter than 30 days it runs on for one more span at its own rate and then
    as in a campaign of 30 days: what was seen within a day tells of the next day, not of a season.
    """
    first, last = float(days[:n].min()), float(days[:n].max())
    span = last - first
    if span <= 0.0:
        return np.asarray((days - first) / SHORT_SPAN_DAYS)
    u = (days - first) / span
    slow = span / max(span, SHORT_SPAN_DAYS)
    over, under = np.maximum(u - 1.0, 0.0), np.maximum(-u, 0.0)
    inside = np.clip(u, 0.0, 1.0)

    def on(beyond: Floats) -> Floats:
        return np.asarray(np.minimum(beyond, 1.0) + slow * np.maximum(beyond - 1.0, 0.0))

    return np.asarray(inside + on(over) - on(under))


def clocks(days: Floats, n: int) -> tuple[tuple[float, Floats], ...]:
    """The clock of the campaign, and beside it for a short one that of the archive's campaigns.

    Each with its share.

    Determinations of a day or two say nothing of what an instrument does in a month or a season.
    That is known from longer campaigns only: it goes at their pace, unseen here.
    """
    first, last = float(days[:n].min()), float(days[:n].max())
    span = last - first
    if span >= SHORT_SPAN_DAYS:
        return ((1.0, clock(days, n)),)
    season = np.asarray((days - first) / ARCHIVE_SPAN_DAYS)
    if span <= 0.0:
        return ((1.0, season),)
    own = max(LEAST_OWN_SHARE, (span / ARCHIVE_SPAN_DAYS) ** 2)
    return (own, clock(days, n)), (1.0 - own, season)


def telling(columns: Mapping[str, Floats]) -> dict[str, Floats]:
    """The columns that vary at all, if only at later visits; those of time and place stay."""
    kept = ("elapsed_days", "block", "line")
    return {k: v for k, v in columns.items() if k in kept or np.unique(v[np.isfinite(v)]).size > 1}


def kernels(columns: Mapping[str, Floats], n: int) -> tuple[Kernel, ...]:
    """Every cause that the columns allow, n determinations first."""
    found = [Kernel("excess", np.eye(columns_size(columns)))]
    found += _of_time(columns, n)
    found += _of_places(columns, n)
    found += _of_temperature(columns, n)
    found += _of_running(columns)
    found += _of_covariates(columns, n)
    return tuple(found)


def columns_size(columns: Mapping[str, Floats]) -> int:
    """Rows of the columns."""
    return int(next(iter(columns.values())).size)


def _varies(values: Floats | None) -> bool:
    """Whether a column is told everywhere; one that says nothing is handed over by nobody."""
    return values is not None and bool(np.isfinite(values).all())


def _outer(x: Floats) -> Floats:
    return np.asarray(x[:, None] * x[None, :])


def _of_time(columns: Mapping[str, Floats], n: int) -> list[Kernel]:
    days = columns.get("elapsed_days")
    if days is None or not np.isfinite(days).all():
        return []
    return [
        replace(kernel, share=share) for share, u in clocks(days, n) for kernel in _of_clock(u, n)
    ]


def _of_clock(u: Floats, n: int) -> list[Kernel]:
    """What changes with time, as a clock tells it."""
    found = [Kernel("walk", _two_sided(u, np.minimum))]
    gaps = np.abs(u[:, None] - u[None, :])
    for length in SLOW_LENGTHS:
        r = np.sqrt(3.0) * gaps / length
        found.append(Kernel("slow", (1.0 + r) * np.exp(-r)))
    found.append(Kernel("slow", np.exp(-gaps / ROUGH_LENGTH)))
    if np.ptp(u[:n]) > 0.0:
        drift = _outer(2.0 * (u - u[:n].mean()))
        found.append(Kernel("drift", drift))
        bent = _two_sided(u, _integrated_walk)
        found += [Kernel("bend", drift + share * bent) for share in BENDS]
    return found


def _two_sided(u: Floats, kernel: object) -> Floats:
    """A kernel of a process that starts at u = 0 in both directions."""
    same = _outer(np.sign(u)) > 0.0
    a, b = np.abs(u)[:, None], np.abs(u)[None, :]
    return np.where(same, kernel(a, b), 0.0)  # type: ignore[operator]


def _integrated_walk(a: Floats, b: Floats) -> Floats:
    """Covariance of an integrated random walk, 1 at a = b = 1."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    return np.asarray(0.5 * low * low * (3.0 * high - low))


def _of_places(columns: Mapping[str, Floats], n: int) -> list[Kernel]:
    found = []
    latitude = columns.get("latitude")
    if latitude is not None and _varies(latitude):
        secant = 1.0 / np.cos(latitude)
        found.append(Kernel("latitude", _outer(LATITUDE_UNIT * (secant - secant[:n].mean()))))
    target, north = columns.get("line_reading"), columns.get("north_reading")
    if target is not None and north is not None and _varies(target) and _varies(north):
        apart = [np.cos(a[:, None] - a[None, :]) for a in (target, north)]
        found.append(Kernel("circle", 0.5 * (apart[0] + apart[1])))
    for unit, name in (("line", "line"), ("day", "block"), ("day", "observer")):
        values = columns.get(name)
        if values is not None and (name != "observer" or np.ptp(values[:n]) > 0.0):
            found.append(Kernel(unit, (values[:, None] == values[None, :]).astype(np.float64)))
    return found


def _of_temperature(columns: Mapping[str, Floats], n: int) -> list[Kernel]:
    theta = columns.get("temperature_c")
    if theta is None or not _varies(theta):
        return []
    x = (theta - theta[:n].mean()) / TEMPERATURE_UNIT_K
    square = x * x - float(np.mean(x[:n] ** 2))
    line = _outer(x)
    return [Kernel("temperature", line), Kernel("curve", line + CURVATURE * _outer(square))]


def _of_running(columns: Mapping[str, Floats]) -> list[Kernel]:
    running = columns.get("running_s")
    if running is None or not _varies(running):
        return []
    return [Kernel("warm_up", WARM_UP_UNIT * _outer(np.exp(-running / tau))) for tau in TAUS_S]


def _of_covariates(columns: Mapping[str, Floats], n: int) -> list[Kernel]:
    found = []
    for name in (*COVARIATE_UNITS, "supply_v"):
        values = columns.get(name)
        if values is None or not _varies(values):
            continue
        mean = float(values[:n].mean())
        size = COVARIATE_UNITS.get(name, SUPPLY_SHARE * max(abs(mean), 1e-9))
        found.append(Kernel("covariate", _outer((values - mean) / size)))
    return found


def step_columns(columns: Mapping[str, Floats], n: int) -> Floats:
    """Steps between two blocks of work, later visits after the last: shape (steps, n + q).

    Without blocks a step may lie between any two determinations.
    """
    days = columns.get("elapsed_days")
    if days is None or not np.isfinite(days).all():
        return np.zeros((0, columns_size(columns)))
    starts = np.unique(days[:n])
    block = columns.get("block")
    if block is not None and np.unique(block[:n]).size > 1:
        starts = np.array([days[:n][block[:n] == b].min() for b in np.unique(block[:n])])
    return np.asarray(
        [(days >= start).astype(np.float64) for start in np.sort(starts)[1:]]
    ).reshape(-1, days.size)
