"""Traverses between two fixed ends, observed with effects that nobody declared.

Plain formulas from true coordinates; nothing of the program computes here.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from dataclasses import dataclass

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


def simulated(
    rng: np.random.Generator,
    wrong: Undeclared,
    lengths: np.ndarray,
    *,
    gyro_every: int = 3,
    zig_zag: bool = True,
    walls: bool = False,
    gross: tuple[int, float] | None = None,
    overlaps: bool = False,
) -> Network:
    """One traverse; the first and the last side are fixed, the gyro's constant is known to 5"."""
    at = _places(rng, lengths)
    names = list(at)
    fixed = {*names[:2], *names[-2:]}

    def azimuth(a: str, b: str) -> float:
        return math.atan2(at[b][0] - at[a][0], at[b][1] - at[a][1])

    def length(a: str, b: str) -> float:
        return math.hypot(at[b][0] - at[a][0], at[b][1] - at[a][1])

    side = {
        (names[k], names[k + 1]): -1.0 if zig_zag and k % 2 else 1.0 for k in range(len(names) - 1)
    }
    side[names[0], names[1]] = 0.0  # outside, where the traverse begins

    def bent(a: str, b: str) -> float:
        sign = side[a, b] if (a, b) in side else -side[b, a]
        return sign * wrong.bending * ARC * length(a, b) / 100.0

    def note(a: str, b: str) -> str:
        return f"wall={'right' if side[a, b] > 0 else 'left'}" if walls else ""

    found = []
    for a, b, c in zip(names, names[1:], names[2:], strict=False):
        value = azimuth(b, c) - azimuth(b, a) + wrong.bias * ARC + bent(b, c) - bent(b, a)
        value += ANGLE * rng.normal()
        found.append(Observation(K.ANGLE, b, c, value % math.tau, ANGLE, back=a, note=note(b, c)))
    inner = list(itertools.pairwise(names[1:-1]))
    past = list(zip(names[1:-1], names[3:-1], strict=False)) if overlaps else []
    for a, b in (*inner, *past):
        for x, y in ((a, b), (b, a)):
            value = length(x, y) * (1.0 + wrong.scale * 1e-6) + wrong.constant * 1e-3
            found.append(Observation(K.DISTANCE, x, y, value + LENGTH * rng.normal(), LENGTH))
    for a, b in inner[1::gyro_every]:
        value = azimuth(a, b) + bent(a, b) + (wrong.shift - 100.0) * ARC + GYRO * rng.normal()
        found.append(Observation(K.GYRO, a, b, value, GYRO, constant="G", note=note(a, b)))
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
    return Network(tuple(points), tuple(found), constants=(known,))


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
