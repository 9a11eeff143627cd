"""Global test at 95 % after import: clean simulated closed traverses with fixed seeds.

Readings, centring and heights are normal; centring and heights have the 1 mm that import assumes.
The sigmas of readings are estimated from the file itself, with few degrees of freedom where there
are few rounds: the test knows it. The bounds are those of the binomial distribution at 99 %.
"""

from __future__ import annotations

import math
import random
import tempfile
from collections.abc import Iterator
from pathlib import Path

from surveyapp import api
from tests.formats.field_writers import Setup, Sight, gsi

TRAVERSES = 200
SHAPES = ((4, 1), (4, 3), (8, 1), (8, 2), (20, 2))
"""Stations and rounds."""
MEAN_ARCSEC = 2.0
"""Standard deviation of a direction, mean of two faces."""
MEAN_M = 1e-3
CENTRING_M = 1e-3


def _traverse(seed: int, stations: int, rounds: int) -> tuple[list[Setup], list[Sight]]:
    draw = random.Random(seed)
    corners = [2.0 * math.pi * i / stations for i in range(stations)]
    places = [
        (
            1000 + 150 * math.cos(a) * draw.uniform(0.8, 1.2),
            2000 + 150 * math.sin(a) * draw.uniform(0.8, 1.2),
            -300 + draw.uniform(-5, 5),
        )
        for a in corners
    ]
    setups, sights = [], []
    for i, place in enumerate(places):
        setups.append(Setup(str(101 + i), *place, round(draw.uniform(1.3, 1.7), 3)))
        sights += _set_up(draw, places, i, (setups[-1].hi, rounds))
    return setups, sights


def _set_up(
    draw: random.Random,
    places: list[tuple[float, float, float]],
    i: int,
    made: tuple[float, int],
) -> list[Sight]:
    """Pointings of one set-up; centring and heights are off once for all its rounds."""
    hi, rounds = made
    stand = [x + draw.gauss(0.0, CENTRING_M) for x in places[i]]
    targets = {
        j: ([x + draw.gauss(0.0, CENTRING_M) for x in places[j]], round(draw.uniform(1.3, 1.7), 3))
        for j in ((i - 1) % len(places), (i + 1) % len(places))
    }
    sights = []
    noise = math.sqrt(2.0) * MEAN_ARCSEC / 3600.0
    for k in range(rounds):
        turn = draw.uniform(0.0, 360.0)
        for face, order in (("L", list(targets)), ("R", list(targets)[::-1])):
            for j in order:
                there, ht = targets[j]
                e, n, h = (b - a for a, b in zip(stand, there, strict=True))
                length = math.hypot(e, n, h + ht - hi)
                v = math.degrees(math.acos((h + ht - hi) / length))
                hz = math.degrees(math.atan2(e, n)) + turn + (0.0 if face == "L" else 180.0)
                hz = (hz + draw.gauss(0.0, noise)) % 360.0
                v = (v if face == "L" else 360.0 - v) + draw.gauss(0.0, noise)
                sd = length + draw.gauss(0.0, math.sqrt(2.0) * MEAN_M)
                sights.append(Sight(i, k, str(101 + i), str(101 + j), face, hz, v, sd, hi, ht))
    return sights


def _binomial_99() -> tuple[int, int]:
    """Of so many tests at 95 % that hold, the least and the most to be expected.

    The centring of an import is assumed, so that hardly any fails from below: up to 97.5 % hold.
    """
    sigmas = [math.sqrt(p * (1.0 - p) * TRAVERSES) for p in (0.95, 0.975)]
    least = math.floor(0.95 * TRAVERSES - 2.58 * sigmas[0])
    return least, min(TRAVERSES, math.ceil(0.975 * TRAVERSES + 2.58 * sigmas[1]))


def _adjusted(seed: int, stations: int, rounds: int) -> tuple[bool, float]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file, project = folder / "f.gsi", folder / "p"
        lines = gsi(*_traverse(seed, stations, rounds), width=16, length="m5")
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        project.mkdir()
        (project / "project.toml").write_text('format = 1\nname = "t"\n', encoding="utf-8")
        api.import_file("gsi", str(file), str(project), fixed=("101", "102"))
        result = api.adjust(project)
    return result.global_test.passed is True, result.sigma0 or 0.0


def run() -> Iterator[str]:
    """A line for each shape of traverse."""
    least, most = _binomial_99()
    for stations, rounds in SHAPES:
        found = [_adjusted(seed, stations, rounds) for seed in range(TRAVERSES)]
        passed = sum(good for good, _ in found)
        ratios = sorted(ratio for _, ratio in found)
        verdict = "met" if least <= passed <= most else "NOT MET"
        yield (
            f"{stations:2d} stations, {rounds} rounds: global test met in {passed} of {TRAVERSES} "
            f"({least} to {most}: {verdict}); sigma0 {ratios[0]:.2f} to {ratios[-1]:.2f}, median "
            f"{ratios[len(ratios) // 2]:.2f}"
        )
