"""Synthetic networks of every observation kind, and an independent adjustment to compare with.

The independent route shares nothing with the program: plain formulas, central differences, dense
QR of whitened equations, inner constraints by a bordered system.
"""

from __future__ import annotations

import math

import numpy as np

from surveyapp.domain.observations import CorrelatedBlock, Observation, ObservationKind
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, Status

K = ObservationKind
ARC = math.pi / 648000.0
Truth = dict[str, tuple[float, float, float]]

PLANE = ("angle", "direction", "distance", "azimuth", "gyro", "coordinate", "vector")
SPACE = ("slope_distance", "zenith", "height_difference")


def truth(rng: np.random.Generator, count: int) -> Truth:
    """Points on a jittered grid, 60 to 150 m apart, in hilly ground."""
    side = math.ceil(math.sqrt(count))
    spots = [(i // side, i % side) for i in range(count)]
    return {
        f"P{i}": (
            1000.0 + 100.0 * c + rng.uniform(-20, 20),
            2000.0 + 100.0 * r + rng.uniform(-20, 20),
            300.0 + rng.uniform(-25, 25),
        )
        for i, (r, c) in enumerate(spots)
    }


def model_value(obs: Observation, at: Truth, extra: dict[tuple[str, str], float]) -> float:
    """Computed value of an observation: the plain formula, once more and independently."""
    a = at.get(obs.at, (0.0, 0.0, 0.0))
    b = at.get(obs.to, (0.0, 0.0, 0.0))
    de, dn, dh = b[0] - a[0], b[1] - a[1], b[2] + obs.ht - a[2] - obs.hi
    level = math.sqrt(de * de + dn * dn)
    bearing = math.atan2(de, dn)
    if obs.kind is K.ANGLE:
        c = at[obs.back]
        return bearing - math.atan2(c[0] - a[0], c[1] - a[1])
    if obs.kind is K.DIRECTION:
        return bearing - extra[obs.at, obs.set]
    if obs.kind is K.GYRO:
        return bearing + obs.convergence - extra["", obs.constant]
    simple = {
        K.DISTANCE: level,
        K.SLOPE_DISTANCE: math.sqrt(level * level + dh * dh),
        K.ZENITH: math.pi / 2.0 - math.atan(dh / level) if level else 0.0,
        K.HEIGHT_DIFFERENCE: dh,
        K.AZIMUTH: bearing,
        K.GYRO_CONSTANT: extra.get(("", obs.at), 0.0),
        K.COORDINATE_E: a[0],
        K.COORDINATE_N: a[1],
        K.COORDINATE_H: a[2],
        K.VECTOR_E: de,
        K.VECTOR_N: dn,
        K.VECTOR_H: dh,
    }
    return simple[obs.kind]


SIGMA = {
    "angle": 8 * ARC,
    "direction": 5 * ARC,
    "distance": 0.003,
    "azimuth": 20 * ARC,
    "gyro": 15 * ARC,
    "slope_distance": 0.003,
    "zenith": 8 * ARC,
    "height_difference": 0.002,
    "coordinate": 0.01,
    "vector": 0.005,
}


def _sights(rng: np.random.Generator, at: Truth, reach: float) -> list[tuple[str, str]]:
    names = list(at)
    pairs = [
        (a, b)
        for a in names
        for b in names
        if a != b and math.hypot(at[a][0] - at[b][0], at[a][1] - at[b][1]) < reach
    ]
    rng.shuffle(pairs)
    return [(str(a), str(b)) for a, b in pairs]


def raw_observations(
    rng: np.random.Generator, at: Truth, kinds: tuple[str, ...], reach: float
) -> list[Observation]:
    """Observations without noise; value 0 (or 1 m) is filled in afterwards."""
    found: list[Observation] = []
    sights = _sights(rng, at, reach)
    by_station: dict[str, list[str]] = {}
    for a, b in sights:
        by_station.setdefault(a, []).append(b)
    for kind in kinds:
        sigma = SIGMA[kind]
        if kind == "direction":
            for a, targets in by_station.items():
                found += [Observation(K.DIRECTION, a, t, 0.0, sigma, set="1") for t in targets]
        elif kind == "angle":
            for a, t in by_station.items():
                found += [
                    Observation(K.ANGLE, a, t[i + 1], 0.0, sigma, back=t[i])
                    for i in range(len(t) - 1)
                ]
        elif kind == "coordinate":
            for name in list(at)[::3]:
                for k in (K.COORDINATE_E, K.COORDINATE_N):
                    found.append(Observation(k, name, "", 0.0, sigma))
        elif kind == "vector":
            for a, b in sights[::2]:
                for k in (K.VECTOR_E, K.VECTOR_N):
                    found.append(Observation(k, a, b, 0.0, sigma))
        elif kind == "gyro":
            for a, b in sights[::5]:
                found.append(
                    Observation(
                        K.GYRO, a, b, 0.0, sigma, constant="G", convergence=rng.uniform(-0.01, 0.01)
                    )
                )
        else:
            step = 5 if kind == "azimuth" else 1
            for a, b in sights[::step]:
                tall = kind in SPACE
                found.append(
                    Observation(
                        ObservationKind(kind),
                        a,
                        b,
                        1.0,
                        sigma,
                        hi=1.5 if tall else 0.0,
                        ht=1.3 if tall else 0.0,
                    )
                )
    return found


def make(
    seed: int,
    kinds: tuple[str, ...],
    *,
    points: int = 7,
    datum: str = "fixed",
    correlated: bool = False,
    reach: float = 190.0,
    noise: bool = True,
) -> tuple[Network, Truth]:
    """A synthetic network and the truth behind it."""
    from dataclasses import replace

    rng = np.random.default_rng(seed)
    at = truth(rng, points)
    raw = raw_observations(rng, at, kinds, reach)
    extra = {(o.at, o.set): rng.uniform(0, 6.0) for o in raw if o.kind is K.DIRECTION}
    extra["", "G"] = 25 * ARC
    shift = rng.normal(size=len(raw)) * (1.0 if noise else 0.0)
    blocks: list[CorrelatedBlock] = []
    sigma = np.array([o.sigma for o in raw])
    error = shift * sigma
    if correlated:
        for start in range(0, len(raw) - 4, 9):
            members = tuple(range(start, start + 4))
            mixing = rng.normal(size=(4, 4)) * 0.4 + np.eye(4)
            matrix = (mixing @ mixing.T) * np.outer(sigma[list(members)], sigma[list(members)])
            blocks.append(CorrelatedBlock(members, tuple(map(tuple, matrix.tolist()))))
            error[list(members)] = np.linalg.cholesky(matrix) @ shift[list(members)]
            for i in members:
                sigma[i] = math.sqrt(matrix[i - start, i - start])
    observations = tuple(
        replace(o, value=model_value(o, at, extra) + float(e), sigma=float(s))
        for o, e, s in zip(raw, error, sigma, strict=True)
    )
    plane = any(k in PLANE or k in ("slope_distance", "zenith") for k in kinds)
    space = any(k in SPACE for k in kinds)
    names = list(at)
    held = {names[0], names[-1]} if datum == "fixed" else set()

    def point(name: str) -> NetworkPoint:
        e, n, h = at[name]
        status = Status.FIXED if name in held else Status.FREE
        if datum == "free":
            status = Status.CONSTRAINED if names.index(name) % 2 == 0 else Status.FREE
        near = rng.normal(0, 0.05, 3) if status is not Status.FIXED else np.zeros(3)
        return NetworkPoint(
            name,
            e + float(near[0]),
            n + float(near[1]),
            h + float(near[2]),
            status if plane else Status.UNUSED,
            status if plane else Status.UNUSED,
            status if space else Status.UNUSED,
        )

    constants = (GyroConstant("G", 20 * ARC, 10 * ARC),) if "gyro" in kinds else ()
    return (
        Network(tuple(point(n) for n in names), observations, tuple(blocks), constants),
        at,
    )


class Independent:
    """The independent adjustment."""

    def __init__(self, network: Network) -> None:
        self.observations = list(network.observations)
        for item in network.constants:
            if item.sigma is not None:
                self.observations.append(
                    Observation(K.GYRO_CONSTANT, item.name, "", item.value, item.sigma)
                )
        self.network = network
        self.keys: list[tuple[str, str, int]] = []
        self.start: list[float] = []
        self.fixed: Truth = {}
        self.datum: list[int] = []
        for p in network.points:
            self.fixed[p.name] = (p.e or 0.0, p.n or 0.0, p.h or 0.0)
            for i, (_, value, status) in enumerate(p.components()):
                if status in (Status.FREE, Status.CONSTRAINED):
                    if status is Status.CONSTRAINED:
                        self.datum.append(len(self.keys))
                    self.keys.append(("point", p.name, i))
                    self.start.append(float(value or 0.0))
        shared: dict[tuple[str, str], float] = {}
        for o in self.observations:
            if o.kind is K.DIRECTION and (o.at, o.set) not in shared:
                a, b = self.fixed[o.at], self.fixed[o.to]
                shared[o.at, o.set] = math.atan2(b[0] - a[0], b[1] - a[1]) - o.value
        for item in network.constants:
            shared["", item.name] = item.value
        for key, value in shared.items():
            self.keys.append((*key, 0))
            self.start.append(value)
        self.covariance = np.diag([o.sigma**2 for o in self.observations])
        for block in network.blocks:
            self.covariance[np.ix_(block.members, block.members)] = np.array(block.covariance)
        self.white = np.linalg.inv(np.linalg.cholesky(self.covariance))

    def values(self, x: np.ndarray) -> np.ndarray:
        at = {name: list(value) for name, value in self.fixed.items()}
        extra: dict[tuple[str, str], float] = {}
        for key, value in zip(self.keys, x, strict=True):
            if key[0] == "point":
                at[key[1]][key[2]] = value
            else:
                extra[key[0], key[1]] = value
        known = {name: (v[0], v[1], v[2]) for name, v in at.items()}
        return np.array([model_value(o, known, extra) for o in self.observations])

    def misclosure(self, x: np.ndarray) -> np.ndarray:
        observed = np.array([o.value for o in self.observations])
        gap = observed - self.values(x)
        angular = [
            o.kind in (K.ANGLE, K.DIRECTION, K.AZIMUTH, K.GYRO, K.ZENITH) for o in self.observations
        ]
        gap[angular] = np.angle(np.exp(1j * gap[angular]))
        return np.asarray(gap)

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        columns = []
        for i in range(len(x)):
            step = np.zeros(len(x))
            step[i] = 1e-3 if self.keys[i][0] == "point" else 1e-5
            columns.append((self.misclosure(x - step) - self.misclosure(x + step)) / (2 * step[i]))
        return np.array(columns).T

    def solve(self, defect: int) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Unknowns, cofactors, sum of squares, redundancies."""
        x0 = np.array(self.start)
        x = x0.copy()
        for _ in range(12):
            a = self.white @ self.jacobian(x)
            right = self.white @ self.misclosure(x)
            if defect:
                scale = np.linalg.norm(a, axis=0)
                basis = np.linalg.svd(a / scale)[2][-defect:].T / scale[:, None]
                held = np.zeros_like(basis)
                held[self.datum] = basis[self.datum]
                border = held.T * 1e4
                full = np.vstack((a, border))
                rhs = np.concatenate((right, -border @ (x - x0)))
            else:
                full, rhs = a, right
            q, r = np.linalg.qr(full)
            x = x + np.linalg.solve(r, q.T @ rhs)
        inverse = np.linalg.solve(r, np.eye(len(x)))
        cofactor = inverse @ inverse.T
        if defect:
            s = np.eye(len(x)) - basis @ np.linalg.solve(held.T @ basis, held.T)
            cofactor = s @ cofactor @ s.T
        v = self.white @ self.misclosure(x)
        hat = a @ cofactor @ a.T
        lower = np.linalg.inv(self.white)
        redundancy = np.diag(lower @ (np.eye(len(v)) - hat) @ self.white)
        return x, cofactor, float(v @ v), redundancy
