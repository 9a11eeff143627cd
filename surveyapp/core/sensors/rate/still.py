"""Stationary or not: two detectors with thresholds from the record's own noise.

The noise is taken where the record is quietest, the threshold follows from a stated rate of false
alarms. First the likelihood ratio of rest against motion over a short window; beside it the older
rule of norm and rate, against which it is compared.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surveyapp.core.statistics.distributions import chi_square_quantile, normal_quantile
from surveyapp_models.arrays import Floats

Mask = NDArray[np.bool_]
QUIET_S = 0.5
"""Length of the pieces among which the quiet ones are looked for."""
QUIET_SHARE = 0.10
"""Of the pieces that are taken for rest at first."""
QUIET_FACTOR = 1.6
"""Standard deviations up to this multiple of the quiet ones belong to the same rest."""
BIAS_SIGMAS = 5.0
"""Spreads of the mean rates of quiet pieces that belong to a rest still."""
LEAST_TURNED = math.radians(0.1)
"""A unit in a hand that turns this slowly lies on something [rad/s]."""
WINDOW_S = 0.15
"""Of the likelihood ratio."""
FALSE_ALARM = 0.01
CLEARLY_TWO = 4.0
"""Ashman's D from which a cluster is split again. By simulation (bench rate_motion): of one cluster
of any of seven shapes, skewed and correlated ones among them, none in 420 records of 400 values is
split; of 100 values up to .08."""
LEAST_STOP_S = 0.3
"""A shorter rest is a turning point of a vibration."""
BRIDGED_S = 0.1
"""A shorter interruption does not end a rest."""


@dataclass(frozen=True, slots=True)
class RestNoise:
    """Noise of the record where it is quietest.

    Parameters
    ----------
    force, rate : ndarray, shape (3,)
        Standard deviations of a sample [m/s2], [rad/s].
    bias : ndarray, shape (3,)
        Mean rate there [rad/s].
    gravity : float
        Mean size of the force there [m/s2].
    share : float
        Of the pieces that are quiet.
    """

    force: Floats
    rate: Floats
    bias: Floats
    gravity: float
    share: float


def rest_noise(force: Floats, rate: Floats, *, rate_hz: float) -> RestNoise:
    """Find the quiet pieces and their noise.

    Parameters
    ----------
    force, rate : ndarray, shape (n, 3)
        [m/s2], [rad/s]
    rate_hz : float
    """
    size = max(round(QUIET_S * rate_hz), 5)
    count = max(force.shape[0] // size, 1)
    if force.shape[0] < size:
        size = force.shape[0]
    f = force[: count * size].reshape(count, size, 3)
    w = rate[: count * size].reshape(count, size, 3)
    sd_f, sd_w = f.std(axis=1, ddof=1), w.std(axis=1, ddof=1)
    scale_f, scale_w = (np.maximum(np.median(s, axis=0), 1e-12) for s in (sd_f, sd_w))
    score = np.log(np.maximum(sd_f / scale_f, 1e-9)).sum(axis=1)
    score = score + np.log(np.maximum(sd_w / scale_w, 1e-9)).sum(axis=1)
    free = ~_stuck(f, w)
    if not free.any():
        free[:] = True
    quiet = free & (score <= np.quantile(score[free], QUIET_SHARE))
    for _ in range(4):
        limit_f = QUIET_FACTOR * np.median(sd_f[quiet], axis=0)
        limit_w = QUIET_FACTOR * np.median(sd_w[quiet], axis=0)
        wider = free & np.all(sd_f <= limit_f, axis=1) & np.all(sd_w <= limit_w, axis=1)
        if not wider.any() or np.array_equal(wider, quiet):
            break
        quiet = wider
    noise_f = np.sqrt(np.median(sd_f[quiet] ** 2, axis=0))
    noise_w = np.sqrt(np.median(sd_w[quiet] ** 2, axis=0))
    return RestNoise(
        np.maximum(noise_f, 1e-9),
        np.maximum(noise_w, 1e-12),
        np.median(w[quiet].mean(axis=1), axis=0),
        float(np.median(np.linalg.norm(f[quiet].mean(axis=1), axis=1))),
        float(np.mean(quiet)),
    )


def _stuck(force: Floats, rate: Floats) -> Mask:
    """Pieces throughout which a channel stands at an end of its range: no noise, and no rest."""
    found = np.zeros(force.shape[0], dtype=bool)
    for values in (force, rate):
        low, high = values.min(axis=1), values.max(axis=1)
        ends = (high == values.max(axis=(0, 1))) | (low == values.min(axis=(0, 1)))
        stands = (low == high) & ends
        # a channel that stands everywhere else, too, has coarse digits
        found |= np.any(stands & (np.mean(low == high, axis=0) < 0.5), axis=1)
    return found


@dataclass(frozen=True, slots=True)
class Gate:
    """Threshold of the likelihood ratio.

    Parameters
    ----------
    threshold : float
        Of the statistic, a mean of squares per degree of freedom.
    window : int
        Samples.
    false_alarm : float
        Stated probability that a window at rest exceeds it.
    inflation : float
        Factor because the noise at rest is not white; 1 = none.
    """

    threshold: float
    window: int
    false_alarm: float
    inflation: float


def bias_tolerance(
    rate: Floats, noise: RestNoise, *, rate_hz: float, least: float = LEAST_TURNED
) -> Floats:
    """By how much the mean rate of a rest may differ from that of all rests, shape (3,) [rad/s].

    Gravity, temperature and time move a bias by more than the noise of a good gyro's samples: what
    the quiet pieces show, and no less than ``least`` [rad/s].
    """
    size = max(round(QUIET_S * rate_hz), 5)
    count = max(rate.shape[0] // size, 1)
    pieces = rate[: count * size].reshape(count, -1, 3)
    quiet = np.all(pieces.std(axis=1) <= QUIET_FACTOR * noise.rate, axis=1)
    if not quiet.any():
        return np.full(3, least)
    off = np.abs(pieces[quiet].mean(axis=1) - noise.bias)
    spread = 1.4826 * np.median(off, axis=0)
    return np.asarray(np.maximum(BIAS_SIGMAS * spread, least))


def statistic(
    force: Floats, rate: Floats, noise: RestNoise, *, window: int, tolerance: Floats
) -> Floats:
    """Likelihood-ratio statistic of each sample's window, shape (n,).

    Mean square of force and rate about their window's mean, each in units of its noise, over
    6 - 6/window degrees of freedom a sample (Skog et al. 2010 with unknown direction and unknown
    biases); of the rate's mean counts what lies beyond ``tolerance`` [rad/s], shape (3,).
    """
    f, w = force / noise.force, (rate - noise.bias) / noise.rate
    square = np.sum(f**2, axis=1) + np.sum(w**2, axis=1)
    total = window * _windowed(square, window)
    for i in range(3):
        mean = _windowed(w[:, i], window)
        beyond = np.maximum(np.abs(mean) - tolerance[i] / noise.rate[i], 0.0)
        total += window * (beyond**2 - mean**2 - _windowed(f[:, i], window) ** 2)
    return np.asarray(total / (6.0 * (window - 1)))


def _windowed(values: Floats, window: int) -> Floats:
    """Centred running mean, the ends with what there is of their nearest whole window."""
    if values.size <= window:
        return np.full(values.size, float(values.mean()))
    offset = float(values[0])
    total = np.concatenate([[0.0], np.cumsum(values - offset)])
    means = (total[window:] - total[:-window]) / window + offset
    left = window // 2
    right = values.size - means.size - left
    return np.concatenate([np.full(left, means[0]), means, np.full(right, means[-1])])


def gate_of(
    values: Floats, *, window: int, false_alarm: float, factor: float = 1.0, own_means: int = 3
) -> Gate:
    """Threshold from a stated false-alarm rate and the quiet part of the statistic itself.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of ``statistic``.
    window : int
    false_alarm : float
    factor : float
        Multiplies the threshold.
    own_means : int
        Channels that are taken about their window's mean.
    """
    dof = 6.0 * window - own_means
    middle = chi_square_quantile(0.5, dof) / dof
    low = np.sort(values)[: max(values.size // 2, 1)]
    quiet = low[low < 4.0 * max(float(np.quantile(values, 0.05)), middle)]
    seen = float(np.median(quiet)) if quiet.size else middle
    inflation = min(max(seen / middle, 1.0), 4.0)
    threshold = chi_square_quantile(1.0 - false_alarm, dof) / dof
    spread = (threshold / middle) ** 1.5  # noise that is not white scatters more
    return Gate(factor * middle * spread * inflation, window, false_alarm, inflation)


def motion_gate(
    values: Floats, *, window: int, false_alarm: float, factor: float = 1.0, own_means: int = 3
) -> Gate:
    """Threshold between rest as it is in this record and motion.

    A vehicle at rest shakes: its engine runs, hands lie on it. The logarithm of the statistic is
    taken for two clusters, rest and motion; the threshold is the stated quantile of the lower one.
    Where there are not two, everything is rest and the noise alone decides.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of ``statistic``.
    window : int
    false_alarm : float
    factor : float
        Multiplies the threshold.
    own_means : int
        As of ``gate_of``.
    """
    plain = gate_of(values, window=window, false_alarm=false_alarm, own_means=own_means)
    logs = np.log(np.maximum(values[:: max(window // 2, 1)], 1e-6))
    lower = _lower_cluster(logs)
    if lower is None:
        return Gate(factor * plain.threshold, window, false_alarm, plain.inflation)
    mean, spread = lower
    threshold = math.exp(mean + normal_quantile(1.0 - false_alarm) * spread)
    return Gate(factor * max(threshold, plain.threshold), window, false_alarm, plain.inflation)


def _lower_cluster(logs: Floats, *, clearness: float = 2.0) -> tuple[float, float] | None:
    """Mean and standard deviation of the lower of two normal clusters; None if there are not two.

    Expectation and maximisation from the ends of the range; each cluster must hold a fiftieth of
    the record. The lower one is split again where it clearly is two: rest, steady driving and
    turning are three.
    """
    low, high = np.quantile(logs, [0.02, 0.98])
    if logs.size < 40 or high - low < 0.5:
        return None
    means, spreads = np.array([low, high]), np.full(2, 0.25 * (high - low))
    weights = np.full(2, 0.5)
    for _ in range(100):
        z = (logs[:, None] - means) / spreads
        density = weights / spreads * np.exp(-0.5 * z**2)
        share = density / np.maximum(density.sum(axis=1, keepdims=True), 1e-300)
        total = np.maximum(share.sum(axis=0), 1e-9)
        moved = (share * logs[:, None]).sum(axis=0) / total
        spreads = np.sqrt((share * (logs[:, None] - moved) ** 2).sum(axis=0) / total)
        spreads, weights = np.maximum(spreads, 0.02), total / logs.size
        if float(np.abs(moved - means).max()) < 1e-4:
            means = moved
            break
        means = moved
    first = int(np.argmin(means))
    apart = float(means[1 - first] - means[first])
    clear = math.sqrt(2.0) * apart / math.hypot(*spreads.tolist())  # Ashman, Bird and Zepf 1994
    if weights.min() < 0.02 or clear < clearness or apart < 0.7:
        return None
    between = 0.5 * (means[first] + spreads[first] + means[1 - first] - spreads[1 - first])
    deeper = _lower_cluster(logs[logs < between], clearness=CLEARLY_TWO)
    return deeper or (float(means[first]), float(spreads[first]))


def bridged(mask: Mask, *, rate_hz: float, least_s: float = LEAST_STOP_S) -> Mask:
    """Rests without short interruptions, and without rests that are too short themselves."""
    found = _without_short(mask, max(round(BRIDGED_S * rate_hz), 1), value=False)
    return _without_short(found, max(round(least_s * rate_hz), 1), value=True)


def _without_short(mask: Mask, least: int, *, value: bool) -> Mask:
    """Turn runs of ``value`` that are shorter than ``least`` into the other value."""
    found = mask.copy()
    edges = np.flatnonzero(np.diff(found.astype(np.int8))) + 1
    bounds = np.concatenate([[0], edges, [found.size]])
    for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        inner = first > 0 and last < found.size
        if bool(found[first]) == value and last - first < least and (inner or value):
            found[first:last] = not value
    return found


def norm_and_rate(force: Floats, rate: Floats, noise: RestNoise, *, false_alarm: float) -> Mask:
    """The older rule: size of the force and size of the rate both near what they are at rest."""
    z = normal_quantile(1.0 - 0.25 * false_alarm)
    size = np.linalg.norm(force, axis=1)
    along = math.sqrt(float(np.mean(noise.force**2)))
    turning = np.linalg.norm((rate - noise.bias) / noise.rate, axis=1)
    limit = math.sqrt(chi_square_quantile(1.0 - 0.5 * false_alarm, 3.0))
    window = 15
    calm = np.abs(_windowed(size, window) - noise.gravity) <= 0.05 + z * along
    slow = _windowed(turning**2, window) <= 2.0 * limit**2
    return np.asarray(calm & slow)


def kappa(one: Mask, other: Mask) -> float | None:
    """Cohen's agreement of two detectors beyond chance; None where one of them never changes."""
    p, q = float(np.mean(one)), float(np.mean(other))
    chance = p * q + (1.0 - p) * (1.0 - q)
    if chance >= 1.0 - 1e-12:
        return None
    return (float(np.mean(one == other)) - chance) / (1.0 - chance)


def runs_of(mask: Mask) -> list[tuple[int, int]]:
    """First and last (exclusive) row of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
