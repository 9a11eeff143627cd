"""Three filters on one description of a state: Kalman, Sage-Husa adaptive Kalman, particles.

State: x[k+1] = x[k] + w, w ~ (0, q); reading y[k] = x[k] + v, v ~ (0, r), variances in the unit of
the readings squared, per sample. The Kalman filter keeps its variance by the Joseph form; the
adaptive one estimates r from its innovations and keeps it positive; the particle filter resamples
when its weights degenerate. A filter that lost the series says so.

Sources: Kalman 1960; Joseph form, Bucy and Joseph 1968; Sage and Husa 1969; Gordon, Salmond and
Smith 1993.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from surveyapp.domain.advance import PartDone
from surveyapp.domain.columns import Room, in_memory, let_go, pieces
from surveyapp_models.arrays import Floats

FilterName = Literal["kalman", "sage-husa", "particle"]
FILTERS: Final[tuple[FilterName, ...]] = ("kalman", "sage-husa", "particle")

FORGETTING: Final = 0.99
"""Forgetting factor b of the adaptive filter; d_k = (1 - b) / (1 - b^(k+1))."""

LEAST_SHARE: Final = 0.01
"""The adaptive r never falls below this share of the stated one: it stays positive."""

PARTICLES: Final = 300
RESAMPLE_BELOW: Final = 0.5
"""Share of the particles that the effective number may fall to before they are drawn anew."""

LOST: Final = 6.0
"""Innovations beyond so many sigma, sustained, are divergence."""

LOST_FOR: Final = 20
"""Samples in a row."""

BLOCK: Final = 1 << 16
"""Samples that are taken at once, so that nothing but the result has the length of a series."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class LocalLevel:
    """The state-space description that all three filters work on.

    Parameters
    ----------
    q : float
        Variance of the step of the state per sample [unit^2].
    r : float
        Variance of a reading [unit^2].
    """

    q: float
    r: float

    @property
    def steady_variance(self) -> float:
        """Variance of the estimate in the steady state [unit^2]: P^2 + q P - q r = 0."""
        return 0.5 * (-self.q + math.sqrt(self.q**2 + 4.0 * self.q * self.r))

    @property
    def steady_gain(self) -> float:
        """Gain of the steady state: P / r."""
        return self.steady_variance / self.r


@dataclass(frozen=True, slots=True)
class Filtered:
    """A filtered series.

    Parameters
    ----------
    estimate, variance : ndarray, shape (n,)
    lost_at : int or None
        First sample of sustained innovations beyond ``LOST`` sigma.
    lost : int
        Samples of which that is true.
    resamplings : int or None
        Of the particle filter.
    degenerate : int or None
        Samples at which every weight vanished.
    """

    estimate: Floats
    variance: Floats
    lost_at: int | None = None
    lost: int = 0
    resamplings: int | None = None
    degenerate: int | None = None


def run_filter(
    name: FilterName,
    series: Floats,
    model: LocalLevel,
    rng: np.random.Generator,
    *,
    room: Room = in_memory,
    progress: PartDone | None = None,
) -> Filtered:
    """Filter a series from its first reading on.

    Parameters
    ----------
    name : str
        One of ``FILTERS``.
    series : ndarray, shape (n,)
    model : LocalLevel
    rng : numpy.random.Generator
        Of the particle filter.
    room : callable
        Where estimates and their variances lie.
    progress : callable, optional
    """
    if name == "kalman":
        return kalman(series, model, room=room, progress=progress)
    if name == "sage-husa":
        return sage_husa(series, model, room=room, progress=progress)
    return particles(series, model, rng, room=room, progress=progress)


@dataclass(frozen=True, slots=True)
class _Output:
    """What a filter fills: estimates, variances, and where an innovation was beyond ``LOST``."""

    estimate: Floats
    variance: Floats
    beyond: Mask

    def blocks(self, series: Floats, first: int) -> Iterator[tuple[Floats, _Output]]:
        """Readings from ``first`` on, and their places, a block at a time; mapped ones let go."""
        estimate, variance = np.asarray(self.estimate), np.asarray(self.variance)
        start = first
        for piece in pieces(series[first:], BLOCK):
            places = slice(start, start + piece.size)
            yield piece, _Output(estimate[places], variance[places], self.beyond[places])
            start += piece.size
            let_go(self.estimate)
            let_go(self.variance)

    def readings(
        self, series: Floats, progress: PartDone | None
    ) -> Iterator[tuple[_Output, int, float]]:
        """Every reading after the first as a plain number, with its block and place there."""
        done = 1
        for piece, here in self.blocks(series, 1):
            for place, value in enumerate(piece.tolist()):
                yield here, place, value
            done += piece.size
            if progress is not None:
                progress(done / series.size)


def _output(size: int, room: Room) -> _Output:
    return _Output(room(size), room(size), np.zeros(size, dtype=bool))


def kalman(
    series: Floats,
    model: LocalLevel,
    *,
    room: Room = in_memory,
    progress: PartDone | None = None,
) -> Filtered:
    """Kalman filter; the gains are those of the exact recursion until they stand still.

    In the steady state the estimate is an exponential mean, computed for the whole rest at once.
    """
    n = series.size
    output = _output(n, room)
    estimate, variance, beyond = output.estimate, output.variance, output.beyond
    x, p, q, r = float(series[0]), model.r, model.q, model.r
    estimate[0], variance[0] = x, p
    steady = model.steady_variance
    k = 1
    while k < n and abs(p - steady) > 1e-14 * steady:
        p += q
        gain = p / (p + r)
        nu = float(series[k]) - x
        beyond[k] = abs(nu) > LOST * math.sqrt(p + r)
        x += gain * nu
        p = (1.0 - gain) ** 2 * p + gain**2 * r  # Joseph form
        estimate[k], variance[k] = x, p
        k += 1
    if k < n:
        _steady(series, output, k, (x, p, q, r), progress=progress)
    return _checked(output)


def _steady(
    series: Floats,
    output: _Output,
    first: int,
    state: tuple[float, float, float, float],
    *,
    progress: PartDone | None,
) -> None:
    """The steady state from estimate, variance, q and r on, block by block."""
    from scipy.signal import lfilter

    x, p, q, r = state
    predicted = p + q
    gain = predicted / (predicted + r)
    limit = LOST * math.sqrt(predicted + r)
    done = first
    for piece, here in output.blocks(series, first):
        made, _ = lfilter([gain], [1.0, gain - 1.0], piece, zi=np.array([(1.0 - gain) * x]))
        here.estimate[:] = made
        here.variance[:] = p
        here.beyond[:] = np.abs(piece - np.concatenate([[x], made[:-1]])) > limit
        x = float(made[-1])
        done += piece.size
        if progress is not None:
            progress(done / series.size)


def sage_husa(
    series: Floats,
    model: LocalLevel,
    *,
    room: Room = in_memory,
    progress: PartDone | None = None,
) -> Filtered:
    """Adaptive Kalman filter: r follows the innovations, guarded so that it stays positive.

    R_k = (1 - d) R + d max(nu^2 - P, share R_0), d = (1 - b) / (1 - b^(k+1)).
    """
    output = _output(series.size, room)
    x, p, q, r = float(series[0]), model.r, model.q, model.r
    output.estimate[0], output.variance[0] = x, p
    least, power = LEAST_SHARE * model.r, FORGETTING
    for here, k, value in output.readings(series, progress):
        p += q
        nu = value - x
        power *= FORGETTING
        d = (1.0 - FORGETTING) / (1.0 - power)
        r = (1.0 - d) * r + d * max(nu * nu - p, least)
        total = p + r
        if nu * nu > LOST**2 * total:
            here.beyond[k] = True
        gain = p / total
        x += gain * nu
        p = (1.0 - gain) ** 2 * p + gain * gain * r
        here.estimate[k], here.variance[k] = x, p
    return _checked(output)


def particles(
    series: Floats,
    model: LocalLevel,
    rng: np.random.Generator,
    *,
    count: int = PARTICLES,
    room: Room = in_memory,
    progress: PartDone | None = None,
) -> Filtered:
    """Bootstrap particle filter with systematic resampling.

    Where every weight vanishes the particles are drawn anew about the reading, which is counted.
    """
    output = _output(series.size, room)
    step, scale = math.sqrt(model.q), -0.5 / model.r
    cloud = float(series[0]) + math.sqrt(model.r) * rng.standard_normal(count)
    log_weight = np.zeros(count)
    weight = np.full(count, 1.0 / count)
    noise = np.empty(count)
    ladder = np.arange(count) / count
    resamplings = degenerate = 0
    spread = model.r
    output.estimate[0], output.variance[0] = float(cloud.mean()), spread
    for here, k, value in output.readings(series, progress):
        rng.standard_normal(out=noise)
        noise *= step
        cloud += noise
        limit = LOST * math.sqrt(spread + model.q + model.r)
        here.beyond[k] = abs(value - float(weight @ cloud)) > limit
        np.subtract(cloud, value, out=noise)
        np.multiply(noise, noise, out=noise)
        noise *= scale
        log_weight += noise
        largest = float(log_weight.max())
        if largest < -700.0:
            degenerate += 1
            cloud = value + math.sqrt(model.r) * rng.standard_normal(count)
            log_weight[:] = 0.0
            largest = 0.0
        np.subtract(log_weight, largest, out=log_weight)
        np.exp(log_weight, out=weight)
        weight /= float(weight.sum())
        mean = float(weight @ cloud)
        np.subtract(cloud, mean, out=noise)
        np.multiply(noise, noise, out=noise)
        spread = float(weight @ noise)
        here.estimate[k], here.variance[k] = mean, spread
        if 1.0 / float(weight @ weight) < RESAMPLE_BELOW * count:
            resamplings += 1
            total = np.cumsum(weight)
            total[-1] = 1.0
            cloud = cloud[np.searchsorted(total, ladder + rng.random() / count)]
            log_weight[:] = 0.0
            weight[:] = 1.0 / count
    return replace(_checked(output), resamplings=resamplings, degenerate=degenerate)


def _checked(output: _Output) -> Filtered:
    """Find sustained innovations that the filter cannot explain."""
    beyond = output.beyond
    first = None
    for start in range(0, beyond.size, BLOCK):
        places = np.flatnonzero(beyond[start : start + BLOCK + LOST_FOR - 1])
        last = places[LOST_FOR - 1 :]
        runs = last - places[: last.size] == LOST_FOR - 1
        if runs.any():
            first = start + int(places[np.argmax(runs)])
            break
    return Filtered(output.estimate, output.variance, first, int(np.count_nonzero(beyond)))


def step_lag(
    name: FilterName,
    model: LocalLevel,
    *,
    sigmas: float,
    rng: np.random.Generator,
    longest: int = 20_000,
) -> float | None:
    """Samples until a filter has followed 90 % of a step of so many sqrt(r), in noise.

    Returns
    -------
    float or None
        Median of three noises (the Kalman filter is linear: of none); None = not within
        ``longest``.
    """
    length = min(max(int(8.0 / model.steady_gain), 100), longest)
    settle = min(length, 4000)
    while True:
        lags = [
            _one_lag(name, model, sigmas * math.sqrt(model.r), (settle, length, rng))
            for _ in range(1 if name == "kalman" else 3)
        ]
        median = float(np.median(lags))
        if math.isfinite(median):
            return median
        if length >= longest:
            return None
        length = min(4 * length, longest)


def _one_lag(
    name: FilterName,
    model: LocalLevel,
    height: float,
    trial: tuple[int, int, np.random.Generator],
) -> float:
    settle, length, rng = trial
    series = np.zeros(settle + length)
    if name != "kalman":
        series = math.sqrt(model.r) * rng.standard_normal(settle + length)
    series[settle:] += height
    estimate = run_filter(name, series, model, rng).estimate
    reached = np.flatnonzero(estimate[settle:] >= 0.9 * height)
    return float(reached[0] + 1) if reached.size else math.inf
