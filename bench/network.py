"""Networks of 1000, 10 000 and 100 000 points: time, memory, and GNU Gama where it is installed.

Every size runs in a process of its own, so that the memory is its own. Timed is the whole way: the
file is read, approximate coordinates are found, everything is solved, and the result with all
covariances, redundancies and standardized residuals is there. Each network is timed without
approximate coordinates and with them (true ones with an error of ``APPROXIMATE_M``); a ratio is
printed only where the peer has adjusted the same network (``_gama``).
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench import _gama
from surveyapp.domain.observations import Observation, ObservationKind
from surveyapp.domain.traverse import GyroConstant, Network, NetworkPoint, Status

K = ObservationKind
ARC = math.pi / 648000.0
LEG_M = 80.0
SIZES = (1000, 10_000, 100_000)
TARGETS = {1000: (0.3, None), 10_000: (2.0, 300.0), 100_000: (25.0, 2048.0)}
"""Seconds and megabytes that the issue asks for."""
GAMA_SIZES = (1000, 3000)
APPROXIMATE_M = 0.5
"""Standard deviation of each approximate coordinate that is given."""


def _ring(count: int, rng: np.random.Generator) -> tuple[np.ndarray, list[tuple[int, int]]]:
    turn = 2.0 * math.pi * np.arange(count) / count
    radius = count * LEG_M / (2.0 * math.pi)
    places = radius * np.stack((np.sin(turn), np.cos(turn)), axis=1)
    return places + rng.normal(0.0, 5.0, places.shape), [(i, (i + 1) % count) for i in range(count)]


def _branched(count: int, rng: np.random.Generator) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """A trunk with side drifts of 5 to 60 legs."""
    trunk = count // 4
    places = np.zeros((count, 2))
    places[:trunk] = np.stack((LEG_M * np.arange(trunk), rng.normal(0.0, 5.0, trunk)), axis=1)
    edges = [(i, i + 1) for i in range(trunk - 1)]
    new = trunk
    while new < count:
        length = min(int(rng.integers(5, 60)), count - new)
        start, side = int(rng.integers(0, trunk)), int(rng.choice((-1, 1)))
        last = start
        for step in range(length):
            sway = rng.normal(0.0, 3.0)
            places[new] = places[start] + (sway, side * (step + 1) * LEG_M)
            edges.append((last, new))
            last, new = new, new + 1
    return places, edges


def network(count: int, *, branched: bool, near: bool = False, seed: int = 1) -> Network:
    """A traverse network with directions, distances and a gyro side every tenth leg.

    ``near``: every new point has approximate coordinates.
    """
    rng = np.random.default_rng(seed)
    places, edges = (_branched if branched else _ring)(count, rng)
    names = [f"P{i}" for i in range(count)]
    sighted: list[list[int]] = [[] for _ in range(count)]
    for a, b in edges:
        sighted[a].append(b)
        sighted[b].append(a)

    def azimuth(a: int, b: int) -> float:
        east, north = places[b] - places[a]
        return math.atan2(east, north)

    observations = []
    for i, targets in enumerate(sighted):
        if len(targets) > 1:
            zero = rng.uniform(0.0, 2.0 * math.pi)
            for j in targets:
                value = (azimuth(i, j) - zero + rng.normal(0.0, 5 * ARC)) % (2 * math.pi)
                observations.append(Observation(K.DIRECTION, names[i], names[j], value, 5 * ARC))
    for number, (a, b) in enumerate(edges):
        if max(a, b) < 2:
            continue
        length = float(np.hypot(*(places[b] - places[a]))) + rng.normal(0.0, 0.002)
        observations.append(Observation(K.DISTANCE, names[a], names[b], length, 0.002))
        if number % 10 == 0:
            value = (azimuth(a, b) - 30 * ARC + rng.normal(0.0, 15 * ARC)) % (2 * math.pi)
            observations.append(
                Observation(K.GYRO, names[a], names[b], value, 15 * ARC, constant="G")
            )
    given = places + rng.normal(0.0, APPROXIMATE_M, places.shape)
    points = tuple(
        NetworkPoint(name, float(true[0]), float(true[1]), None, Status.FIXED, Status.FIXED)
        if i < 2
        else (NetworkPoint(name, float(about[0]), float(about[1])) if near else NetworkPoint(name))
        for i, (name, true, about) in enumerate(zip(names, places, given, strict=True))
    )
    return Network(points, tuple(observations), constants=(GyroConstant("G", 0.0, 20 * ARC),))


def with_plain_azimuths(net: Network) -> Network:
    """Gyro sides as independent azimuths, which a .gkf file of this size can hold."""
    observations = tuple(
        replace(obs, kind=K.AZIMUTH, value=obs.value + 30 * ARC, constant="")
        if obs.kind is K.GYRO
        else obs
        for obs in net.observations
    )
    return replace(net, observations=observations, constants=())


def _measure(count: int, shape: str, path: str) -> None:
    """Run in a process of its own: prints seconds of both ways, memory, and what was found."""
    import resource

    from surveyapp.core.network import adjust
    from surveyapp.io.importers.gkf import read_gkf

    branched = shape == "branched"
    # warm up imports and caches on a small network: a user's second adjustment is meant
    adjust(network(60, branched=branched))
    start = time.perf_counter()
    read = read_gkf(path)
    reading = time.perf_counter() - start
    result = adjust(read)
    file_s = time.perf_counter() - start
    unsound = abs(sum(o.redundancy for o in result.observations) - result.dof)
    if unsound > 1e-4 * result.dof:
        raise RuntimeError(f"redundancies miss the degrees of freedom by {unsound:g}")
    dof, sigma0 = result.dof, result.sigma0 or math.nan
    del read, result
    shared = network(count, branched=branched)
    start = time.perf_counter()
    adjust(shared)
    shared_s = time.perf_counter() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{reading} {file_s} {shared_s} {memory} {dof} {sigma0}")


def _write(count: int, shape: str, path: str) -> None:
    from surveyapp.io.exporters.gkf import write_gkf

    near = Path(path).stem.endswith(NEAR)
    net = network(count, branched=shape == "branched", near=near)
    write_gkf(with_plain_azimuths(net), path)


NEAR = "-near"


def _child(*arguments: str) -> list[float]:
    """Numbers that a process of its own prints.

    This process must stay small: children inherit its peak memory in their statistics.
    """
    run = subprocess.run(
        [sys.executable, "-m", "bench.network", *arguments],
        capture_output=True,
        text=True,
        check=True,
    )
    return [float(item) for item in run.stdout.split()]


def line(count: int, shape: str, folder: Path, *, near: bool = False) -> str:
    """One network: our times and memory, and what the peer answered."""
    path = folder / f"{shape}-{count}{NEAR if near else ''}.gkf"
    _child("write", str(count), shape, str(path))
    reading, file_s, shared_s, memory, dof, sigma0 = _child("measure", str(count), shape, str(path))
    seconds, megabytes = TARGETS.get(count, (None, None))
    text = (
        f"{shape:>8} {count:>7} points{', near' if near else '':6}: {file_s:6.2f} s from file "
        f"(reading {reading:.2f} s), {shared_s:6.2f} s with one gyro constant, {memory:5.0f} MB"
    )
    if seconds is not None:
        limit = "" if megabytes is None else f", {megabytes:.0f} MB"
        text += f" (target {seconds} s{limit})"
    if count in GAMA_SIZES and _gama.there():
        text += _gama.compared(path, file_s, _gama.Expected(round(dof), sigma0))
    return text


def run() -> list[str]:
    """Lines for the benchmark's printout."""
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        for shape in ("closed", "branched"):
            for count in sorted({*SIZES, *(GAMA_SIZES if _gama.there() else ())}):
                both = (False, True)
                lines += [line(count, shape, Path(folder), near=near) for near in both]
    if not _gama.there():
        lines.append(f"{_gama.PROGRAM} is not on the PATH: no ratio")
    return lines


if __name__ == "__main__":
    action = {"write": _write, "measure": _measure}[sys.argv[1]]
    action(int(sys.argv[2]), sys.argv[3], sys.argv[4])
