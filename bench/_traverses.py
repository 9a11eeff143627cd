"""Traverses between two fixed ends, observed with effects that nobody declared.

Plain formulas from true coordinates; nothing of the program computes here.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, Status

K = ObservationKind
ARC = math.pi / 648000.0
ANGLE, LENGTH, GYRO = 7.0 * ARC, 0.002, 12.0 * ARC


@dataclass(frozen=True)
class Undeclared:
    """What is wrong: ppm, mm, arcsec, arcsec, arcsec per 100 m."""

    scale: float = 0.0
    constant: float = 0.0
    shift: float = 0.0
    bias: float = 0.0
    bending: float = 0.0


def _places(rng: np.random.Generator, lengths: np.ndarray) -> dict[str, tuple[float, float]]:
    turn = rng.uniform(-0.6, 0.6, lengths.size)
    turn[::2] *= -1.0
    azimuth = 0.3 + np.cumsum(turn) / 2.0
    e = 1000.0 + np.concatenate([[0.0], np.cumsum(lengths * np.sin(azimuth))])
    n = 2000.0 + np.concatenate([[0.0], np.cumsum(lengths * np.cos(azimuth))])
    return {f"P{i}": (float(x), float(y)) for i, (x, y) in enumerate(zip(e, n, strict=True))}


@dataclass(frozen=True)
class Truth:
    """Where the points are and what is wrong: what any observation reads but for its noise.

    ``side`` is -1 or 1 for the sides of a zig-zag (where a wall stands), 0 outside.
    """

    at: dict[str, tuple[float, float]]
    side: dict[tuple[str, str], float]
    wrong: Undeclared

    def azimuth(self, a: str, b: str) -> float:
        """From true coordinates [rad]."""
        (x, y), (u, v) = self.at[a], self.at[b]
        return math.atan2(u - x, v - y)

    def length(self, a: str, b: str) -> float:
        """From true coordinates [m]."""
        (x, y), (u, v) = self.at[a], self.at[b]
        return math.hypot(u - x, v - y)

    def bent(self, a: str, b: str) -> float:
        """What the air along a wall does to a direction [rad]."""
        sign = self.side[a, b] if (a, b) in self.side else -self.side[b, a]
        return sign * self.wrong.bending * ARC * self.length(a, b) / 100.0

    def reads(self, obs: Observation, *, other: bool = False) -> float:
        """What it would read; ``other``: by another instrument, without the errors of this one."""
        own, wrong = 0.0 if other else 1.0, self.wrong
        if obs.kind is K.ANGLE:
            bias = own * wrong.bias * ARC
            value = self.azimuth(obs.at, obs.to) - self.azimuth(obs.at, obs.back) + bias
            return value + self.bent(obs.at, obs.to) - self.bent(obs.at, obs.back)
        if obs.kind is K.DISTANCE:
            scale, constant = own * wrong.scale * 1e-6, own * wrong.constant * 1e-3
            return self.length(obs.at, obs.to) * (1.0 + scale) + constant
        if obs.kind is K.GYRO_CONSTANT:
            return (100.0 - wrong.shift) * ARC
        shift = (wrong.shift - 100.0) * ARC if obs.kind is K.GYRO else 0.0
        return self.azimuth(obs.at, obs.to) + self.bent(obs.at, obs.to) + shift


def simulated(
    rng: np.random.Generator, wrong: Undeclared, lengths: np.ndarray, **how: Any
) -> Network:
    """One traverse; see ``simulated_with_truth``."""
    return simulated_with_truth(rng, wrong, lengths, **how)[0]


def simulated_with_truth(
    rng: np.random.Generator,
    wrong: Undeclared,
    lengths: np.ndarray,
    *,
    gyro_every: int = 3,
    zig_zag: bool = True,
    walls: bool = False,
    gross: tuple[int, float] | None = None,
    overlaps: bool = False,
) -> tuple[Network, Truth]:
    """One traverse; the first and the last side are fixed, the gyro's constant is known to 5"."""
    at = _places(rng, lengths)
    names = list(at)
    fixed = {*names[:2], *names[-2:]}
    side = {
        (names[k], names[k + 1]): -1.0 if zig_zag and k % 2 else 1.0 for k in range(len(names) - 1)
    }
    side[names[0], names[1]] = 0.0  # outside, where the traverse begins
    truth = Truth(at, side, wrong)

    def note(a: str, b: str) -> str:
        return f"wall={'right' if side[a, b] > 0 else 'left'}" if walls else ""

    found = []
    for a, b, c in zip(names, names[1:], names[2:], strict=False):
        made = Observation(K.ANGLE, b, c, 0.0, ANGLE, back=a, note=note(b, c))
        value = truth.reads(made) + ANGLE * rng.normal()
        found.append(dataclasses.replace(made, value=value % math.tau))
    inner = list(itertools.pairwise(names[1:-1]))
    past = list(zip(names[1:-1], names[3:-1], strict=False)) if overlaps else []
    for a, b in (*inner, *past):
        for x, y in ((a, b), (b, a)):
            made = Observation(K.DISTANCE, x, y, 1.0, LENGTH)
            value = truth.reads(made) + LENGTH * rng.normal()
            found.append(dataclasses.replace(made, value=value))
    for a, b in inner[1::gyro_every]:
        made = Observation(K.GYRO, a, b, 0.0, GYRO, constant="G", note=note(a, b))
        value = truth.reads(made) + GYRO * rng.normal()
        found.append(dataclasses.replace(made, value=value))
    if gross is not None:
        old = found[gross[0]]
        found[gross[0]] = dataclasses.replace(old, value=old.value + gross[1] * old.sigma)
    status = {True: Status.FIXED, False: Status.FREE}
    points = [
        NetworkPoint(p, at[p][0], at[p][1], status_e=status[True])
        if p in fixed
        else NetworkPoint(p, status_e=status[False])
        for p in names
    ]
    points = [dataclasses.replace(p, status_n=p.status_e) for p in points]
    known = GyroConstant("G", (100.0 + 5.0 * rng.normal()) * ARC, 5.0 * ARC)
    return Network(tuple(points), tuple(found), constants=(known,)), truth


def folder_text(network: Network) -> tuple[str, str]:
    """project.toml and book of a simulated traverse; gyro sides stay away."""
    stations = []
    for p in network.points:
        stations.append(f'[[station]]\nname = "{p.name}"')
        if p.status_e is Status.FIXED:
            stations.append(f"e = {p.e!r}\nn = {p.n!r}\nfixed = true")
    header = (
        '[[traverse]]\nname = "main"\nbook = "observations/main.csv"\nsigma_angle_arcsec = 7.0\n'
        "sigma_distance = { mm = 2.0, ppm = 0.0 }\natmosphere_applied = true\n"
    )
    rows = ["kind,at,from,to,value,unit,sigma,sigma_unit,set,hi,ht,note"]
    for o in network.observations:
        if o.kind is K.ANGLE:
            rows.append(
                f"angle,{o.at},{o.back},{o.to},{math.degrees(o.value):.8f},deg,,,,,,{o.note}"
            )
        elif o.kind is K.DISTANCE:
            rows.append(f"distance,{o.at},,{o.to},{o.value:.5f},m,,,,,,")
    head = 'format = 1\nname = "T"\nangle_unit = "dms"\n'
    return head + "\n".join(stations) + "\n" + header, "\n".join(rows) + "\n"
